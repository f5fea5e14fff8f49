#define _XOPEN_SOURCE 700 /* realpath() */
#include "outfile.h"

#include "../error.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define BUFFER_SIZE (256 * 1024)
#define TEMPORARY_TRIES 100
#define NAME_KEPT 200 /* bytes of the file's name in the temporary one: leaves room within NAME_MAX */

struct stic_outfile {
  int fd;
  bool owned;      /* fd is ours to close */
  int failure;     /* errno of the first failure, 0: none */
  char *path;      /* as given, for messages */
  char *target;    /* where it goes, NULL if written directly */
  char *temporary; /* where it is until then */
  size_t used;
  char buffer[BUFFER_SIZE];
};

static char *copy_text(const char *text, size_t length)
{
  char *copy = malloc(length + 1);

  if (copy) {
    memcpy(copy, text, length);
    copy[length] = '\0';
  }
  return copy;
}

static void destroy(stic_outfile *out)
{
  if (out->owned && out->fd >= 0)
    close(out->fd);
  free(out->path);
  free(out->target);
  free(out->temporary);
  free(out);
}

/* Makes and opens FOLDER/.NAME.PID-N.tmp beside the target, in the same file system. */
static int open_temporary(stic_outfile *out)
{
  const char *slash = strrchr(out->target, '/');
  const char *name = slash ? slash + 1 : out->target;
  const size_t room = strlen(out->target) + 64;
  int problem = EEXIST;

  out->temporary = malloc(room);
  if (!out->temporary)
    return ENOMEM;
  for (int i = 0; i < TEMPORARY_TRIES && problem == EEXIST; i++) {
    snprintf(out->temporary, room, "%.*s.%.*s.%ld-%d.tmp", (int)(name - out->target), out->target, NAME_KEPT,
             name, (long)getpid(), i);
    out->fd = open(out->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (out->fd >= 0)
      return 0;
    problem = errno;
  }
  free(out->temporary);
  out->temporary = NULL;
  return problem;
}

/* Opens whatever fits the kind of file that `path` is now; returns an errno. */
static int open_place(stic_outfile *out)
{
  struct stat st;
  const bool exists = stat(out->path, &st) == 0;
  int problem = errno;

  /* A link to nothing, or in a circle: the rename would replace the link. */
  if (!exists && (problem != ENOENT || lstat(out->path, &st) == 0))
    return problem;
  if (exists && S_ISDIR(st.st_mode))
    return EISDIR;
  if (exists && !S_ISREG(st.st_mode)) {
    out->fd = open(out->path, O_WRONLY | O_CLOEXEC);
    return out->fd < 0 ? errno : 0;
  }
  /* The rename would get round a file's write protection. */
  if (exists && access(out->path, W_OK) != 0)
    return errno;
  out->target = exists ? realpath(out->path, NULL) : copy_text(out->path, strlen(out->path));
  if (!out->target)
    return errno;
  problem = open_temporary(out);
  if (problem == 0 && exists && fchmod(out->fd, st.st_mode & 0777) != 0)
    problem = errno;
  return problem;
}

static stic_status cannot_write(const char *path, int problem, stic_error *err)
{
  const char *name = strcmp(path, "-") == 0 ? STIC_OUTFILE_STDOUT : path;

  if (!*path)
    return stic_error_set(err, STIC_CANNOT_WRITE, NULL, 0, "cannot write: the output's name is empty");
  if (problem == ENOMEM)
    return stic_error_set(err, STIC_NO_MEMORY, name, 0, "out of memory");
  return stic_error_set(err, STIC_CANNOT_WRITE, name, 0, "cannot write: %s", strerror(problem));
}

stic_status stic_outfile_open(const char *path, stic_outfile **out_file, stic_error *err)
{
  stic_outfile *out = malloc(sizeof *out);
  int problem = 0;

  assert(path && out_file);
  *out_file = NULL;
  if (!out)
    return stic_error_set(err, STIC_NO_MEMORY, path, 0, "out of memory");
  out->fd = -1;
  out->owned = true;
  out->failure = 0;
  out->used = 0;
  out->target = out->temporary = NULL;
  out->path = copy_text(path, strlen(path));
  if (!out->path) {
    destroy(out);
    return stic_error_set(err, STIC_NO_MEMORY, path, 0, "out of memory");
  }
  if (strcmp(path, "-") == 0) {
    out->fd = STDOUT_FILENO;
    out->owned = false;
  } else {
    problem = *path ? open_place(out) : ENOENT;
  }
  if (problem != 0) {
    stic_outfile_abort(out);
    return cannot_write(path, problem, err);
  }
  *out_file = out;
  return STIC_OK;
}

int stic_outfile_flush(stic_outfile *out)
{
  const char *at = out->buffer;

  while (out->used > 0 && out->failure == 0) {
    const ssize_t n = write(out->fd, at, out->used);

    if (n < 0 && errno == EINTR)
      continue;
    if (n <= 0) {
      out->failure = n < 0 ? errno : ENOSPC;
      break;
    }
    at += n;
    out->used -= (size_t)n;
  }
  out->used = 0;
  return out->failure;
}

char *stic_outfile_reserve(stic_outfile *out, size_t length)
{
  assert(length <= STIC_OUTFILE_RESERVE_MAX);
  if (out->used + length > BUFFER_SIZE)
    stic_outfile_flush(out);
  return out->buffer + out->used;
}

void stic_outfile_used(stic_outfile *out, size_t length)
{
  assert(out->used + length <= BUFFER_SIZE);
  out->used += length;
}

void stic_outfile_write(stic_outfile *out, const void *data, size_t length)
{
  const char *at = data;

  while (length > 0) {
    const size_t part = length < STIC_OUTFILE_RESERVE_MAX ? length : STIC_OUTFILE_RESERVE_MAX;

    memcpy(stic_outfile_reserve(out, part), at, part);
    stic_outfile_used(out, part);
    at += part;
    length -= part;
  }
}

void stic_outfile_print(stic_outfile *out, const char *format, ...)
{
  char *place = stic_outfile_reserve(out, STIC_OUTFILE_RESERVE_MAX);
  va_list args;
  int n;

  va_start(args, format);
  n = vsnprintf(place, STIC_OUTFILE_RESERVE_MAX, format, args);
  va_end(args);
  assert(n >= 0 && n < STIC_OUTFILE_RESERVE_MAX);
  if (n > 0)
    stic_outfile_used(out, (size_t)n);
}

int stic_outfile_error(const stic_outfile *out)
{
  return out->failure;
}

static void finish(stic_outfile *out)
{
  stic_outfile_flush(out);
  /* Before the rename, or a power cut could leave an empty file under the final name. */
  if (out->failure == 0 && out->target && fsync(out->fd) != 0)
    out->failure = errno;
  if (out->owned) {
    if (close(out->fd) != 0 && out->failure == 0)
      out->failure = errno;
    out->fd = -1;
  }
  if (out->failure == 0 && out->target && rename(out->temporary, out->target) != 0)
    out->failure = errno;
  if (out->failure != 0 && out->temporary)
    unlink(out->temporary);
}

stic_status stic_outfile_commit(stic_outfile *out, stic_error *err)
{
  stic_status status = STIC_OK;

  if (!out)
    return STIC_OK;
  finish(out);
  if (out->failure != 0)
    status = cannot_write(out->path, out->failure, err);
  destroy(out);
  return status;
}

void stic_outfile_abort(stic_outfile *out)
{
  if (!out)
    return;
  if (out->temporary)
    unlink(out->temporary);
  destroy(out);
}

#define _XOPEN_SOURCE 700 /* mkdtemp(), nftw() */
#include "help.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

const char stic_test_scene[] =
  "stiction: 1\n"
  "name: test\n"
  "object:\n"
  "  size: [0.16, 0.08, 0.10]\n"
  "  pose: {x: 0.30, y: 0.20, z: 0.0, angle_deg: 20.05}\n"
  "hand: {stiffness: 200, rotational_stiffness: 0.5}\n"
  "friction: {static: 0.5, dynamic: 0.3}\n"
  "surfaces:\n"
  "  - {name: floor, point: [0, 0], normal_deg: 90}\n"
  "  - {name: wall, point: [0, 0], normal_deg: 0, friction: {static: 0.4, dynamic: 0.2}}\n";

static char folder[64];

const char *stic_test_folder(void)
{
  if (!folder[0]) {
    snprintf(folder, sizeof folder, "/tmp/stiction-test-XXXXXX");
    assert_non_null(mkdtemp(folder));
  }
  return folder;
}

static int remove_entry(const char *path, const struct stat *st, int kind, struct FTW *where)
{
  (void)st, (void)kind, (void)where;
  return remove(path);
}

int stic_test_clean_up(void **state)
{
  (void)state;
  if (folder[0])
    nftw(folder, remove_entry, 8, FTW_DEPTH | FTW_PHYS);
  folder[0] = '\0';
  return 0;
}

const char *stic_test_path(const char *name)
{
  static char paths[64][256];
  char path[256];
  int i;

  snprintf(path, sizeof path, "%s/%s", stic_test_folder(), name);
  for (i = 0; i < 64 && paths[i][0] && strcmp(paths[i], path) != 0; i++)
    ;
  assert_true(i < 64);
  return strcpy(paths[i], path);
}

const char *stic_test_write_bytes(const char *name, const void *data, size_t length)
{
  const char *path = stic_test_path(name);
  FILE *file = fopen(path, "wb");

  assert_non_null(file);
  assert_int_equal(fwrite(data, 1, length, file), length);
  assert_int_equal(fclose(file), 0);
  return path;
}

const char *stic_test_write(const char *name, const char *text)
{
  return stic_test_write_bytes(name, text, strlen(text));
}

char *stic_test_read(const char *path)
{
  FILE *file = fopen(path, "rb");
  char *text = NULL;
  size_t used = 0, room = 0;

  if (!file)
    return NULL;
  do {
    room += 65536;
    text = realloc(text, room + 1);
    assert_non_null(text);
    used += fread(text + used, 1, room - used, file);
  } while (used == room);
  text[used] = '\0';
  fclose(file);
  return text;
}

const char *stic_test_rows(const char *text)
{
  const char *at = text ? strstr(text, "\nt,") : NULL;

  at = at ? strchr(at + 1, '\n') : NULL;
  return at ? at + 1 : "";
}

int stic_test_count_rows(const char *path)
{
  char *text = stic_test_read(path);
  int count = 0;

  for (const char *c = stic_test_rows(text); *c; c++)
    count += *c == '\n';
  free(text);
  return count;
}

void stic_test_wait_for_rows(pid_t program, const char *path, int count)
{
  while (stic_test_count_rows(path) < count) {
    if (waitpid(program, NULL, WNOHANG) != 0)
      fail_msg("the program has ended: %s", stic_test_read(stic_test_path("err")));
    stic_test_pause(10);
  }
}

void stic_test_pause(int ms)
{
  nanosleep(&(struct timespec){ms / 1000, ms % 1000 * 1000000L}, NULL);
}

int stic_test_count_entries(const char *part)
{
  DIR *dir = opendir(stic_test_folder());
  const struct dirent *entry;
  int count = 0;

  assert_non_null(dir);
  while ((entry = readdir(dir)) != NULL)
    count += strstr(entry->d_name, part) != NULL;
  closedir(dir);
  return count;
}

char *stic_test_trace(int count)
{
  const size_t room = 128 + 64 * (size_t)count;
  char *text = malloc(room);
  size_t used;

  assert_non_null(text);
  used = (size_t)snprintf(text, room, "# stiction-trace 1\nt,x,y,z,qx,qy,qz,qw,buttons\n");
  for (int i = 0; i < count; i++)
    used += (size_t)snprintf(text + used, room - used, "%d.%02d,0.3,%.4f,0,0,0,0.1736,0.9848,0\n", i / 50,
                             i % 50 * 2, 0.2 - 0.0002 * (i % 500));
  return text;
}

static void read_into(const char *name, char *out, size_t out_size)
{
  char *text = stic_test_read(stic_test_path(name));

  snprintf(out, out_size, "%s", text ? text : "");
  free(text);
}

static void redirect(const char *path, int flags, int to)
{
  const int fd = open(path, flags, 0666);

  if (fd < 0 || dup2(fd, to) < 0)
    _exit(99);
  close(fd);
}

pid_t stic_test_start(const char *input, const char *const *arguments)
{
  const char *program = getenv("STICTION");
  char out[256], err[256];
  const char *argv[32];
  int count = 0;
  pid_t child;

  assert_non_null(program);
  argv[count++] = "stiction";
  while (*arguments && count < 31)
    argv[count++] = *arguments++;
  argv[count] = NULL;
  snprintf(out, sizeof out, "%s", stic_test_path("out"));
  snprintf(err, sizeof err, "%s", stic_test_path("err"));
  child = fork();
  assert_true(child >= 0);
  if (child == 0) {
    redirect(input ? input : "/dev/null", O_RDONLY, STDIN_FILENO);
    redirect(out, O_WRONLY | O_CREAT | O_TRUNC, STDOUT_FILENO);
    redirect(err, O_WRONLY | O_CREAT | O_TRUNC, STDERR_FILENO);
    execv(program, (char *const *)(uintptr_t)argv);
    _exit(98);
  }
  return child;
}

int stic_test_wait(pid_t child)
{
  int status;

  while (waitpid(child, &status, 0) < 0)
    assert_int_equal(errno, EINTR);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

const stic_test_run *stic_test_program(const char *first, ...)
{
  static stic_test_run run;
  const char *arguments[32];
  int count = 0;
  va_list args;

  va_start(args, first);
  for (const char *argument = first; argument && count < 31; argument = va_arg(args, const char *))
    arguments[count++] = argument;
  va_end(args);
  arguments[count] = NULL;
  run.code = stic_test_wait(stic_test_start(NULL, arguments));
  read_into("out", run.out, sizeof run.out);
  read_into("err", run.err, sizeof run.err);
  return &run;
}

void stic_test_contains(const char *text, const char *part)
{
  if (!strstr(text, part))
    fail_msg("expected \"%s\" in \"%s\"", part, text);
}

void expect(const stic_test_run *run, int code, const char *words)
{
  if (run->code != code)
    fail_msg("exit code %d, not %d: %s", run->code, code, run->err);
  stic_test_contains(run->err, words);
}

void stic_test_refused(stic_status status, const stic_error *err, const char *path, int line,
                       const char *words)
{
  if (status != STIC_BAD_INPUT || err->status != status || strcmp(err->file, path) != 0 ||
      err->line != line || !strstr(err->message, words))
    fail_msg("expected line %d, \"%s\"; found status %d, line %d, \"%s\" of %s", line, words, (int)status,
             (int)err->line, err->message, err->file);
}

void stic_test_wrong_files(const stic_test_wrong *files, size_t count, stic_test_reader *read)
{
  for (size_t i = 0; i < count; i++) {
    const char *path = stic_test_write("wrong", files[i].text);
    stic_error err = {.message = ""};
    const stic_status status = read(path, &err);

    stic_test_refused(status, &err, path, files[i].line, files[i].words);
  }
}

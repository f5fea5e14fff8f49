#include "trace_csv.h"

#include "../error.h"
#include "../number.h"
#include "format.h"
#include "line_reader.h"
#include "outfile.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define COLUMNS 9
#define NORM_TOLERANCE 0.01
/* Far beyond any tracker, and still exact to 1e-9 m. */
#define POSITION_MAX 1e18

static const char *const column_names[COLUMNS] = {"t", "x", "y", "z", "qx", "qy", "qz", "qw", "buttons"};

struct stic_trace_reader {
  stic_line_reader *lines;
  stic_trace_options options;
  bool format_seen, header_allowed;
  int64_t samples, skipped;
  int64_t last_t_ns; /* of the last sample, if there is one */
};

stic_status stic_trace_open(const char *path, const stic_trace_options *options, stic_trace_reader **reader,
                            stic_error *err)
{
  stic_trace_reader *r = calloc(1, sizeof *r);
  stic_status status;

  *reader = NULL;
  if (!r)
    return stic_error_set(err, STIC_NO_MEMORY, path, 0, "out of memory");
  if (options)
    r->options = *options;
  status = stic_line_reader_open(path, &r->lines, err);
  if (status != STIC_OK) {
    free(r);
    return status;
  }
  *reader = r;
  return STIC_OK;
}

void stic_trace_close(stic_trace_reader *reader)
{
  if (!reader)
    return;
  stic_line_reader_close(reader->lines);
  free(reader);
}

#define BAD(r, err, ...)                                                                                     \
  stic_error_set(err, STIC_BAD_INPUT, stic_line_reader_name((r)->lines),                                     \
                 stic_line_reader_number((r)->lines), __VA_ARGS__)

static bool read_double(const stic_trace_reader *r, const stic_field *field, int column, double *value,
                        stic_error *err)
{
  char text[40];

  switch (stic_number_parse(field->text, field->length, value)) {
  case STIC_NUMBER_OK: return true;
  case STIC_NUMBER_TOO_LARGE:
    BAD(r, err, "%s is '%s'; expected a finite number", column_names[column],
        stic_error_quote(field->text, field->length, text, sizeof text));
    return false;
  case STIC_NUMBER_NOT_PLAIN: break;
  }
  BAD(r, err, "%s is '%s'; expected a plain number", column_names[column],
      stic_error_quote(field->text, field->length, text, sizeof text));
  return false;
}

static bool read_time(const stic_trace_reader *r, const stic_field *field, int64_t *t_ns, stic_error *err)
{
  char text[40], last[40];

  stic_error_quote(field->text, field->length, text, sizeof text);
  switch (stic_number_parse_ns(field->text, field->length, t_ns)) {
  case STIC_NUMBER_NOT_PLAIN:
    BAD(r, err, "t is '%s'; expected seconds as a plain number", text);
    return false;
  case STIC_NUMBER_OK:
    if (*t_ns >= -STIC_TRACE_TIME_MAX_NS && *t_ns <= STIC_TRACE_TIME_MAX_NS)
      break;
    /* fall through */
  case STIC_NUMBER_TOO_LARGE: BAD(r, err, "t is '%s'; expected seconds within +-4e9", text); return false;
  }
  if (r->samples > 0 && *t_ns <= r->last_t_ns) {
    last[stic_format_seconds(r->last_t_ns, last)] = '\0';
    BAD(r, err, "t is '%s' after %s; expected strictly increasing times in whole ns", text, last);
    return false;
  }
  return true;
}

static bool read_pose(const stic_trace_reader *r, const stic_field *fields, stic_sample *sample,
                      stic_error *err)
{
  double norm = 0;

  for (int i = 0; i < 3; i++) {
    if (!read_double(r, &fields[1 + i], 1 + i, &sample->position[i], err))
      return false;
    if (!(fabs(sample->position[i]) <= POSITION_MAX)) {
      BAD(r, err, "%s is %g m; expected within +-%g m", column_names[1 + i], sample->position[i],
          POSITION_MAX);
      return false;
    }
  }
  for (int i = 0; i < 4; i++) {
    if (!read_double(r, &fields[4 + i], 4 + i, &sample->orientation[i], err))
      return false;
    norm += sample->orientation[i] * sample->orientation[i];
  }
  norm = sqrt(norm);
  if (!(fabs(norm - 1) <= NORM_TOLERANCE)) {
    BAD(r, err, "the quaternion's norm is %.6g; expected 1 within 1 %%", norm);
    return false;
  }
  return true;
}

static bool read_sample(const stic_trace_reader *r, const char *text, size_t length, stic_sample *sample,
                        stic_error *err)
{
  stic_field fields[COLUMNS];
  const int count = stic_fields_split(text, length, fields, COLUMNS);
  int64_t buttons;
  char quoted[40];

  if (count != COLUMNS) {
    if (length == 0)
      BAD(r, err, "the line is empty; expected %d fields: " STIC_TRACE_HEADER, COLUMNS);
    else
      BAD(r, err, "found %d field%s; expected %d: " STIC_TRACE_HEADER, count, count == 1 ? "" : "s", COLUMNS);
    return false;
  }
  if (!read_time(r, &fields[0], &sample->t_ns, err) || !read_pose(r, fields, sample, err))
    return false;
  if (stic_number_parse_integer(fields[8].text, fields[8].length, 0, UINT32_MAX, &buttons) !=
      STIC_NUMBER_OK) {
    BAD(r, err, "buttons is '%s'; expected a whole number from 0 to 4294967295",
        stic_error_quote(fields[8].text, fields[8].length, quoted, sizeof quoted));
    return false;
  }
  sample->lost = ((uint32_t)buttons & STIC_TRACE_BUTTON_LOST) != 0;
  sample->buttons = (uint32_t)buttons & ~STIC_TRACE_BUTTON_LOST;
  return true;
}

static void report(const stic_trace_reader *r, bool warning, const stic_error *problem)
{
  if (r->options.report)
    r->options.report(r->options.context, warning, problem);
}

/* The first line must name the format; lenient or not, anything else is no trace. */
static bool read_format(stic_trace_reader *r, const char *text, size_t length, stic_error *err)
{
  const int64_t version = stic_line_format_version(text, length, "trace");
  char quoted[48];

  if (version < 0)
    BAD(r, err, "the first line is '%s'; expected '" STIC_TRACE_FORMAT "'",
        stic_error_quote(text, length, quoted, sizeof quoted));
  else if (version != 1)
    BAD(r, err, "the trace has format version %lld; expected 1, which this program reads",
        (long long)version);
  r->format_seen = r->header_allowed = version == 1;
  return version == 1;
}

static stic_trace_status end_of_trace(stic_trace_reader *r, stic_error *err)
{
  if (r->samples > 0)
    return STIC_TRACE_END;
  if (!r->format_seen)
    BAD(r, err, "the trace is empty; expected '" STIC_TRACE_FORMAT "'");
  else
    BAD(r, err, "the trace has no samples; expected at least one");
  return STIC_TRACE_BAD;
}

/* True if the line was neither comment nor header. */
static bool is_data(stic_trace_reader *r, const char *text, size_t length)
{
  const bool header_allowed = r->header_allowed;

  if (length > 0 && text[0] == '#')
    return false;
  r->header_allowed = false;
  return !(header_allowed && stic_line_is(text, length, STIC_TRACE_HEADER));
}

stic_trace_status stic_trace_next(stic_trace_reader *r, stic_sample *sample, stic_error *err)
{
  stic_error problem;

  for (;;) {
    const char *text = NULL;
    size_t length = 0;
    const stic_line_status line = stic_line_reader_next(r->lines, &text, &length);

    switch (line) {
    case STIC_LINE_END: return end_of_trace(r, err);
    case STIC_LINE_WAIT: return STIC_TRACE_WAIT;
    case STIC_LINE_FAILED:
      stic_error_set(err, STIC_BAD_INPUT, stic_line_reader_name(r->lines), 0, "cannot read: %s",
                     strerror(errno));
      return STIC_TRACE_BAD;
    case STIC_LINE_UNFINISHED:
      if (r->samples == 0) /* an error follows */
        continue;
      BAD(r, &problem, "the last line has no end and is dropped");
      report(r, true, &problem);
      continue;
    case STIC_LINE_READ:
      if (!r->format_seen) {
        if (!read_format(r, text, length, err))
          return STIC_TRACE_BAD;
        continue;
      }
      if (!is_data(r, text, length))
        continue;
      if (read_sample(r, text, length, sample, &problem)) {
        r->samples++;
        r->last_t_ns = sample->t_ns;
        return STIC_TRACE_SAMPLE;
      }
      break;
    case STIC_LINE_TOO_LONG:
      BAD(r, &problem, "the line is longer than %d bytes; expected " STIC_TRACE_HEADER, STIC_LINE_MAX);
      break;
    }
    if (!r->options.lenient || !r->format_seen) {
      if (err)
        *err = problem;
      return STIC_TRACE_BAD;
    }
    r->skipped++;
    report(r, false, &problem);
  }
}

bool stic_trace_ready(const stic_trace_reader *reader)
{
  return stic_line_reader_ready(reader->lines);
}

int stic_trace_fd(const stic_trace_reader *reader)
{
  return stic_line_reader_fd(reader->lines);
}

int64_t stic_trace_skipped(const stic_trace_reader *reader)
{
  return reader->skipped;
}

/* ---- writing ----------------------------------------------------------------------------- */

struct stic_trace_writer {
  int fd;
  bool owned, regular;
  char path[256]; /* for messages */
  char *name;     /* of the file */
  char *head;     /* until the recording has begun, NULL after */
  size_t head_length;
};

size_t stic_trace_line(const stic_sample *sample, char *out)
{
  const uint32_t buttons = sample->buttons | (sample->lost ? STIC_TRACE_BUTTON_LOST : 0);
  char *at = out;

  at += stic_format_seconds(sample->t_ns, at);
  for (int i = 0; i < 3; i++) {
    *at++ = ',';
    at += stic_format_double(sample->position[i], at);
  }
  for (int i = 0; i < 4; i++) {
    *at++ = ',';
    at += stic_format_double(sample->orientation[i], at);
  }
  *at++ = ',';
  at += stic_format_integer(buttons, at);
  *at++ = '\n';
  assert(at - out < STIC_TRACE_LINE_MAX);
  return (size_t)(at - out);
}

/* One write() for a line, so that a reader sees whole lines only. */
static stic_status write_whole(stic_trace_writer *w, const char *text, size_t length, stic_error *err)
{
  while (length > 0) {
    const ssize_t n = write(w->fd, text, length);

    if (n < 0 && errno == EINTR)
      continue;
    if (n <= 0)
      return stic_error_set(err, STIC_CANNOT_WRITE, w->path, 0, "cannot write the recording: %s",
                            strerror(n < 0 ? errno : ENOSPC));
    text += n;
    length -= (size_t)n;
  }
  return STIC_OK;
}

/* A file that no other recorder writes to, with what is in it; -1 and errno. */
static int open_alone(const char *path, bool *regular)
{
  struct flock whole = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
  const int fd = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  struct stat st;
  int problem;

  *regular = fd >= 0 && fstat(fd, &st) == 0 && S_ISREG(st.st_mode);
  if (!*regular || fcntl(fd, F_SETLK, &whole) == 0 || errno == ENOLCK || errno == EINVAL)
    return fd;
  problem = errno == EAGAIN || errno == EACCES ? EBUSY : errno;
  close(fd);
  errno = problem;
  return -1;
}

/* Nothing is added after a lack of memory. */
static void add_to_head(void *context, const char *text)
{
  stic_trace_writer *w = context;
  const size_t length = strlen(text);
  char *longer = w->head ? realloc(w->head, w->head_length + length + 1) : NULL;

  if (!longer) {
    free(w->head);
    w->head = NULL;
    return;
  }
  memcpy(longer + w->head_length, text, length + 1);
  w->head = longer;
  w->head_length += length;
}

/* False without memory. */
static bool make_head(stic_trace_writer *w, const stic_provenance *provenance)
{
  w->head_length = 0;
  w->head = malloc(1);
  add_to_head(w, STIC_TRACE_FORMAT "\n");
  if (provenance)
    stic_provenance_lines(provenance, add_to_head, w);
  add_to_head(w, STIC_TRACE_HEADER "\n");
  return w->head != NULL;
}

/* An older recording is lost only now, when there is something to put in its place. */
static stic_status begin(stic_trace_writer *w, stic_error *err)
{
  char *head = w->head;
  stic_status status = STIC_OK;

  if (!head)
    return STIC_OK;
  w->head = NULL;
  if (w->regular && ftruncate(w->fd, 0) != 0)
    status = stic_error_set(err, STIC_CANNOT_WRITE, w->path, 0, "cannot empty the older recording: %s",
                            strerror(errno));
  if (status == STIC_OK)
    status = write_whole(w, head, w->head_length, err);
  free(head);
  return status;
}

/* What was opened and never begun leaves an older recording, or no file. */
static void leave_untouched(const stic_trace_writer *w)
{
  struct stat st;

  if (w->head && w->regular && w->owned && fstat(w->fd, &st) == 0 && st.st_size == 0)
    unlink(w->name);
}

static void destroy(stic_trace_writer *w)
{
  if (w) {
    free(w->name);
    free(w->head);
  }
  free(w);
}

stic_status stic_trace_create(const char *path, const stic_provenance *provenance, stic_trace_writer **writer,
                              stic_error *err)
{
  const bool standard_output = strcmp(path, "-") == 0;
  stic_trace_writer *w = calloc(1, sizeof *w);
  stic_status status = STIC_OK;

  *writer = NULL;
  if (w)
    w->name = malloc(strlen(path) + 1);
  if (!w || !w->name || !make_head(w, provenance)) {
    destroy(w);
    return stic_error_set(err, STIC_NO_MEMORY, path, 0, "out of memory");
  }
  strcpy(w->name, path);
  w->fd = standard_output ? STDOUT_FILENO : open_alone(path, &w->regular);
  w->owned = !standard_output;
  if (standard_output)
    path = STIC_OUTFILE_STDOUT;
  stic_error_quote(path, strlen(path), w->path, sizeof w->path);
  if (w->fd < 0) {
    status = stic_error_set(err, STIC_CANNOT_WRITE, path, 0, "cannot create the recording: %s",
                            errno == EBUSY ? "another program is recording to it" : strerror(errno));
    destroy(w);
    return status;
  }
  if (!w->regular)
    status = begin(w, err);
  if (status != STIC_OK) {
    stic_trace_finish(w, NULL);
    return status;
  }
  *writer = w;
  return STIC_OK;
}

stic_status stic_trace_write(stic_trace_writer *writer, const stic_sample *sample, stic_error *err)
{
  char line[STIC_TRACE_LINE_MAX];

  const stic_status status = begin(writer, err);

  return status == STIC_OK ? write_whole(writer, line, stic_trace_line(sample, line), err) : status;
}

stic_status stic_trace_finish(stic_trace_writer *writer, stic_error *err)
{
  stic_status status = STIC_OK;

  if (!writer)
    return STIC_OK;
  if (err)
    status = begin(writer, err);
  else
    leave_untouched(writer);
  /* Pipes and the like cannot be synced, which is no fault. */
  if (fsync(writer->fd) != 0 && status == STIC_OK && errno != EINVAL && errno != EROFS && errno != ENOTSUP)
    status = stic_error_set(err, STIC_CANNOT_WRITE, writer->path, 0, "cannot finish the recording: %s",
                            strerror(errno));
  if (writer->owned && close(writer->fd) != 0 && status == STIC_OK)
    status = stic_error_set(err, STIC_CANNOT_WRITE, writer->path, 0, "cannot finish the recording: %s",
                            strerror(errno));
  destroy(writer);
  return status;
}

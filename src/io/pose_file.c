#include "pose_file.h"

#include "../error.h"
#include "../number.h"
#include "line_reader.h"
#include "trace_csv.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COLUMNS 8
#define NORM_TOLERANCE 0.01
#define POSITION_MAX 1e18 /* m, as in a trace */

struct stic_pose_reader {
  stic_line_reader *lines;
  stic_pose_format format;
  stic_pose_options options;
  int64_t poses, last_ns;
};

/* What a format's columns are. */
static const struct {
  const char *columns;
  const char *names[COLUMNS];
  int quaternion[4]; /* columns of x, y, z, w */
} formats[] = {
  [STIC_POSE_TUM] = {"timestamp tx ty tz qx qy qz qw",
                     {"timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw"},
                     {4, 5, 6, 7}},
  [STIC_POSE_EUROC] = {"timestamp,px,py,pz,qw,qx,qy,qz",
                       {"timestamp", "px", "py", "pz", "qw", "qx", "qy", "qz"},
                       {5, 6, 7, 4}},
};

stic_status stic_pose_open(const char *path, stic_pose_format format, const stic_pose_options *options,
                           stic_pose_reader **reader, stic_error *err)
{
  stic_pose_reader *r = calloc(1, sizeof *r);
  stic_status status;

  *reader = NULL;
  if (!r)
    return stic_error_set(err, STIC_NO_MEMORY, path, 0, "out of memory");
  r->format = format;
  if (options)
    r->options = *options;
  status = stic_line_reader_open(path, &r->lines, err);
  if (status != STIC_OK)
    free(r);
  else
    *reader = r;
  return status;
}

void stic_pose_close(stic_pose_reader *reader)
{
  if (!reader)
    return;
  stic_line_reader_close(reader->lines);
  free(reader);
}

/* ---- one line ---------------------------------------------------------------------------- */

#define BAD(r, err, ...)                                                                                     \
  stic_error_set(err, STIC_BAD_INPUT, stic_line_reader_name((r)->lines),                                     \
                 stic_line_reader_number((r)->lines), __VA_ARGS__)

/* As stic_fields_split(), at blanks. */
static int split_at_blanks(const char *text, size_t length, stic_field *fields, int limit)
{
  const char *at = text, *const end = text + length;
  int count = 0;

  for (;;) {
    const char *from;

    while (at < end && (*at == ' ' || *at == '\t'))
      at++;
    if (at == end)
      return count;
    for (from = at; at < end && *at != ' ' && *at != '\t'; at++)
      ;
    if (count < limit) {
      fields[count].text = from;
      fields[count].length = (size_t)(at - from);
    }
    count++;
  }
}

static int split(stic_pose_format format, const char *text, size_t length, stic_field *fields, int limit)
{
  return format == STIC_POSE_TUM ? split_at_blanks(text, length, fields, limit)
                                 : stic_fields_split(text, length, fields, limit);
}

static bool read_time(const stic_pose_reader *r, const stic_field *field, int64_t *t_ns, stic_error *err)
{
  char text[40];
  const bool tum = r->format == STIC_POSE_TUM;
  const stic_number_status status =
    tum ? stic_number_parse_ns(field->text, field->length, t_ns)
        : stic_number_parse_integer(field->text, field->length, 0, STIC_TRACE_TIME_MAX_NS, t_ns);

  stic_error_quote(field->text, field->length, text, sizeof text);
  if (status != STIC_NUMBER_OK || *t_ns > STIC_TRACE_TIME_MAX_NS || *t_ns < -STIC_TRACE_TIME_MAX_NS) {
    BAD(r, err, "timestamp is '%s'; expected %s", text,
        tum ? "seconds as a plain number within +-4e9" : "whole nanoseconds");
    return false;
  }
  if (r->poses > 0 && *t_ns <= r->last_ns) {
    BAD(r, err, "timestamp %s does not come after the last one, by whole ns; expected increasing times",
        text);
    return false;
  }
  return true;
}

static bool read_numbers(const stic_pose_reader *r, const stic_field *fields, double *values, stic_error *err)
{
  char text[40];

  for (int i = 1; i < COLUMNS; i++) {
    if (stic_number_parse(fields[i].text, fields[i].length, &values[i]) != STIC_NUMBER_OK) {
      BAD(r, err, "%s is '%s'; expected a plain number", formats[r->format].names[i],
          stic_error_quote(fields[i].text, fields[i].length, text, sizeof text));
      return false;
    }
    if (i <= 3 && !(fabs(values[i]) <= POSITION_MAX)) {
      BAD(r, err, "%s is %g m; expected within +-%g m", formats[r->format].names[i], values[i], POSITION_MAX);
      return false;
    }
  }
  return true;
}

static bool read_pose(const stic_pose_reader *r, const char *text, size_t length, stic_sample *pose,
                      stic_error *err)
{
  stic_field fields[COLUMNS];
  const int count = split(r->format, text, length, fields, COLUMNS);
  double values[COLUMNS], norm = 0;

  if (count < COLUMNS || (r->format == STIC_POSE_TUM && count > COLUMNS)) {
    BAD(r, err, "found %d field%s; expected %d: %s", length == 0 ? 0 : count, count == 1 ? "" : "s", COLUMNS,
        formats[r->format].columns);
    return false;
  }
  memset(pose, 0, sizeof *pose);
  if (!read_time(r, &fields[0], &pose->t_ns, err) || !read_numbers(r, fields, values, err))
    return false;
  memcpy(pose->position, &values[1], sizeof pose->position);
  for (int i = 0; i < 4; i++) {
    pose->orientation[i] = values[formats[r->format].quaternion[i]];
    norm += pose->orientation[i] * pose->orientation[i];
  }
  norm = sqrt(norm);
  if (!(fabs(norm - 1) <= NORM_TOLERANCE)) {
    BAD(r, err, "the quaternion's norm is %.6g; expected 1 within 1 %%", norm);
    return false;
  }
  for (int i = 0; i < 4; i++)
    pose->orientation[i] /= norm;
  return true;
}

/* ---- the file ---------------------------------------------------------------------------- */

static void report(const stic_pose_reader *r, bool warning, const stic_error *problem)
{
  if (r->options.report)
    r->options.report(r->options.context, warning, problem);
}

stic_pose_status stic_pose_next(stic_pose_reader *r, stic_sample *pose, stic_error *err)
{
  stic_error problem;

  for (;;) {
    const char *text;
    size_t length;

    switch (stic_line_reader_next(r->lines, &text, &length)) {
    case STIC_LINE_READ:
      if (length > 0 && text[0] == '#')
        continue;
      if (read_pose(r, text, length, pose, &problem)) {
        r->poses++;
        r->last_ns = pose->t_ns;
        return STIC_POSE_READ;
      }
      break;
    case STIC_LINE_TOO_LONG: BAD(r, &problem, "the line is longer than %d bytes", STIC_LINE_MAX); break;
    case STIC_LINE_UNFINISHED:
      BAD(r, &problem, "the last line has no end and is dropped");
      report(r, true, &problem);
      continue;
    case STIC_LINE_WAIT: return STIC_POSE_WAIT;
    case STIC_LINE_FAILED: BAD(r, err, "cannot read: %s", strerror(errno)); return STIC_POSE_BAD;
    case STIC_LINE_END:
      if (r->poses > 0)
        return STIC_POSE_END;
      BAD(r, err, "there are no poses; expected lines of %s", formats[r->format].columns);
      return STIC_POSE_BAD;
    }
    if (!r->options.lenient) {
      if (err)
        *err = problem;
      return STIC_POSE_BAD;
    }
    report(r, false, &problem);
  }
}

bool stic_pose_recognize(const char *line, size_t length, stic_pose_format *format)
{
  stic_field fields[COLUMNS];

  *format = memchr(line, ',', length) ? STIC_POSE_EUROC : STIC_POSE_TUM;
  return split(*format, line, length, fields, COLUMNS) >= COLUMNS; /* EuRoC has more, of no concern */
}

#include "line_reader.h"

#include "../error.h"
#include "../number.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define BUFFER_SIZE (2 * STIC_LINE_MAX)

struct stic_line_reader {
  int fd;
  bool owned; /* fd is ours to close */
  bool at_end;
  bool skipping; /* inside a line that was too long and has been told */
  int64_t number;
  size_t start, searched, end; /* in buffer: the unread part, and how far it holds no line end */
  char name[256];
  char buffer[BUFFER_SIZE];
};

stic_status stic_line_reader_open(const char *path, stic_line_reader **reader, stic_error *err)
{
  const bool standard_input = strcmp(path, "-") == 0;
  stic_line_reader *r = malloc(sizeof *r);

  *reader = NULL;
  if (!r)
    return stic_error_set(err, STIC_NO_MEMORY, path, 0, "out of memory");
  r->fd = standard_input ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC);
  if (r->fd < 0) {
    free(r);
    return stic_error_set(err, STIC_BAD_INPUT, path, 0, "cannot open: %s", strerror(errno));
  }
  r->owned = !standard_input;
  r->at_end = r->skipping = false;
  r->number = 0;
  r->start = r->searched = r->end = 0;
  stic_error_quote(standard_input ? "standard input" : path, strlen(standard_input ? "standard input" : path),
                   r->name, sizeof r->name);
  *reader = r;
  return STIC_OK;
}

void stic_line_reader_close(stic_line_reader *reader)
{
  if (!reader)
    return;
  if (reader->owned)
    close(reader->fd);
  free(reader);
}

static bool find_end(const stic_line_reader *r, size_t *at)
{
  const char *found = memchr(r->buffer + r->searched, '\n', r->end - r->searched);

  if (found)
    *at = (size_t)(found - r->buffer);
  return found != NULL;
}

static stic_line_status take_line(stic_line_reader *r, size_t line_end, const char **text, size_t *length)
{
  size_t from = r->start, to = line_end;

  r->start = r->searched = line_end + 1;
  if (++r->number == 1 && to - from >= 3 && memcmp(r->buffer + from, "\xef\xbb\xbf", 3) == 0)
    from += 3;
  if (to > from && r->buffer[to - 1] == '\r')
    to--;
  if (to - from > STIC_LINE_MAX)
    return STIC_LINE_TOO_LONG;
  *text = r->buffer + from;
  *length = to - from;
  return STIC_LINE_READ;
}

static stic_line_status take_rest(stic_line_reader *r, const char **text, size_t *length)
{
  if (r->start == r->end)
    return STIC_LINE_END;
  *text = r->buffer + r->start;
  *length = r->end - r->start;
  r->start = r->searched = r->end;
  r->number++;
  return STIC_LINE_UNFINISHED;
}

/* Told as soon as it is known, as the end of such a line may never come; what is left of it is passed over. */
static stic_line_status refuse_line(stic_line_reader *r)
{
  r->skipping = true;
  r->start = r->searched = r->end = 0;
  r->number++;
  return STIC_LINE_TOO_LONG;
}

/* The rest of a refused line, as far as it has been read. */
static void pass_over(stic_line_reader *r)
{
  size_t line_end = r->end;

  r->skipping = !find_end(r, &line_end);
  r->start = r->searched = r->skipping ? r->end : line_end + 1;
}

static void make_room(stic_line_reader *r)
{
  r->searched = r->end;
  if (r->start > 0 && BUFFER_SIZE - r->end < BUFFER_SIZE / 2) {
    memmove(r->buffer, r->buffer + r->start, r->end - r->start);
    r->end -= r->start;
    r->searched -= r->start;
    r->start = 0;
  }
  assert(r->end < BUFFER_SIZE);
}

stic_line_status stic_line_reader_next(stic_line_reader *r, const char **text, size_t *length)
{
  bool has_read = false;
  size_t line_end;

  for (;;) {
    ssize_t n;

    if (r->skipping)
      pass_over(r);
    if (find_end(r, &line_end))
      return take_line(r, line_end, text, length);
    if (r->at_end)
      return take_rest(r, text, length);
    if (r->end - r->start > STIC_LINE_MAX + 4) /* 4: "\r" and a byte-order mark */
      return refuse_line(r);
    if (has_read)
      return STIC_LINE_WAIT;
    make_room(r);
    n = read(r->fd, r->buffer + r->end, BUFFER_SIZE - r->end);
    if (n < 0)
      return errno == EINTR || errno == EAGAIN ? STIC_LINE_WAIT : STIC_LINE_FAILED;
    r->at_end = n == 0;
    r->end += (size_t)n;
    has_read = true;
  }
}

bool stic_line_reader_ready(const stic_line_reader *reader)
{
  size_t at;

  return reader->at_end || find_end(reader, &at);
}

int64_t stic_line_reader_number(const stic_line_reader *reader)
{
  return reader->number;
}

const char *stic_line_reader_name(const stic_line_reader *reader)
{
  return reader->name;
}

int stic_line_reader_fd(const stic_line_reader *reader)
{
  return reader->fd;
}

static stic_field trimmed(const char *from, const char *to)
{
  stic_field field;

  while (from < to && (*from == ' ' || *from == '\t'))
    from++;
  while (to > from && (to[-1] == ' ' || to[-1] == '\t'))
    to--;
  field.text = from;
  field.length = (size_t)(to - from);
  return field;
}

int stic_fields_split(const char *text, size_t length, stic_field *fields, int limit)
{
  const char *at = text, *const end = text + length;
  int count = 0;

  for (;;) {
    const char *comma = memchr(at, ',', (size_t)(end - at));
    const char *to = comma ? comma : end;

    if (count < limit)
      fields[count] = trimmed(at, to);
    count++;
    if (!comma)
      return count;
    at = comma + 1;
  }
}

bool stic_line_is(const char *line, size_t length, const char *text)
{
  return strlen(text) == length && memcmp(line, text, length) == 0;
}

int64_t stic_line_format_version(const char *line, size_t length, const char *kind)
{
  static const char mark[] = "# stiction-";
  const size_t mark_length = sizeof mark - 1, kind_length = strlen(kind);
  const size_t skip = mark_length + kind_length + 1;
  int64_t version;

  if (length <= skip || memcmp(line, mark, mark_length) != 0 ||
      memcmp(line + mark_length, kind, kind_length) != 0 || line[skip - 1] != ' ')
    return -1;
  if (stic_number_parse_integer(line + skip, length - skip, 0, INT64_MAX, &version) != STIC_NUMBER_OK)
    return -1;
  return version;
}

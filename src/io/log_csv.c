#include "log_csv.h"

#include "../error.h"
#include "../number.h"
#include "format.h"
#include "line_reader.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PLAIN_COLUMNS 18
#define CONTACT_COLUMNS 6
#define COLUMNS (PLAIN_COLUMNS + STIC_LOG_CONTACTS * CONTACT_COLUMNS)

/* ---- writing ----------------------------------------------------------------------------- */

static void print_line(void *out, const char *text)
{
  stic_outfile_print(out, "%s", text);
}

void stic_log_begin(stic_outfile *out, const stic_provenance *p)
{
  stic_outfile_print(out, STIC_LOG_FORMAT "\n");
  stic_provenance_lines(p, print_line, out);
  stic_outfile_print(out, STIC_LOG_HEADER "\n");
}

static char *put_double(char *at, double value)
{
  *at++ = ',';
  return at + stic_format_double(value, at);
}

static char *put_integer(char *at, int64_t value)
{
  *at++ = ',';
  return at + stic_format_integer(value, at);
}

static char *put_contact(char *at, const stic_contact *c)
{
  at = put_integer(at, c->vertex);
  at = put_integer(at, c->surface);
  at = put_double(at, c->x);
  at = put_double(at, c->y);
  at = put_double(at, c->normal);
  return put_double(at, c->friction);
}

size_t stic_log_row_text(const stic_result *r, char *text)
{
  const double numbers[] = {r->x,      r->y,          r->z,       r->theta,   r->hand_x, r->hand_y,
                            r->hand_z, r->hand_theta, r->force_x, r->force_y, r->moment};
  const char *state = stic_state_name(r->state);
  const size_t state_length = strlen(state);
  char *at = text;

  at += stic_format_seconds(r->t_ns, at);
  *at++ = ',';
  memcpy(at, state, state_length);
  at += state_length;
  for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
    at = put_double(at, numbers[i]);
  at = put_integer(at, r->slips);
  at = put_integer(at, r->flags);
  at = put_integer(at, r->iterations);
  at = put_double(at, r->residual);
  at = put_integer(at, r->contact_count);
  for (int i = 0; i < STIC_LOG_CONTACTS; i++) {
    if (i < r->contact_count) {
      at = put_contact(at, &r->contacts[i]);
    } else {
      memset(at, ',', CONTACT_COLUMNS);
      at += CONTACT_COLUMNS;
    }
  }
  *at++ = '\n';
  assert(at - text < STIC_LOG_ROW_MAX);
  return (size_t)(at - text);
}

void stic_log_row(stic_outfile *out, const stic_result *result)
{
  char *text = stic_outfile_reserve(out, STIC_LOG_ROW_MAX);

  stic_outfile_used(out, stic_log_row_text(result, text));
}

/* ---- reading ----------------------------------------------------------------------------- */

typedef struct provenance_entry {
  char key[32];
  char value[1024];
} provenance_entry;

#define PROVENANCE_MAX 64

struct stic_log_reader {
  stic_line_reader *lines;
  int provenance_count;
  provenance_entry provenance[PROVENANCE_MAX];
};

#define BAD(r, err, ...)                                                                                     \
  stic_error_set(err, STIC_BAD_INPUT, stic_line_reader_name((r)->lines),                                     \
                 stic_line_reader_number((r)->lines), __VA_ARGS__)

/* The next whole line; `*more` false at the end. */
static stic_status next_line(stic_log_reader *r, const char **text, size_t *length, bool *more,
                             stic_error *err)
{
  stic_line_status status;

  do {
    errno = 0;
    status = stic_line_reader_next(r->lines, text, length);
  } while (status == STIC_LINE_WAIT && errno != EINTR);
  *more = status == STIC_LINE_READ;
  switch (status) {
  case STIC_LINE_READ:
  case STIC_LINE_END: return STIC_OK;
  case STIC_LINE_TOO_LONG:
    return BAD(r, err, "the line is longer than %d bytes; expected a row of a log", STIC_LINE_MAX);
  case STIC_LINE_UNFINISHED: return BAD(r, err, "the last line has no end; expected a complete log");
  case STIC_LINE_WAIT:
  case STIC_LINE_FAILED: break;
  }
  return stic_error_set(err, STIC_BAD_INPUT, stic_line_reader_name(r->lines), 0, "cannot read: %s",
                        strerror(errno));
}

static void keep_provenance(stic_log_reader *r, const char *text, size_t length)
{
  const char *colon = length > 2 ? memchr(text, ':', length) : NULL;
  provenance_entry *entry = &r->provenance[r->provenance_count];

  if (!colon || r->provenance_count == PROVENANCE_MAX || colon - text < 3)
    return;
  stic_error_quote(text + 2, (size_t)(colon - text) - 2, entry->key, sizeof entry->key);
  colon += colon + 1 < text + length && colon[1] == ' ' ? 2 : 1;
  stic_error_quote(colon, (size_t)(text + length - colon), entry->value, sizeof entry->value);
  r->provenance_count++;
}

static stic_status read_head(stic_log_reader *r, stic_error *err)
{
  const char *text;
  size_t length;
  bool more;
  char quoted[48];
  stic_status status = next_line(r, &text, &length, &more, err);
  int64_t version;

  if (status != STIC_OK)
    return status;
  version = more ? stic_line_format_version(text, length, "log") : -1;
  if (version < 0)
    return BAD(r, err, "the first line is '%s'; expected '" STIC_LOG_FORMAT "'",
               more ? stic_error_quote(text, length, quoted, sizeof quoted) : "");
  if (version != 1)
    return BAD(r, err, "the log has format version %lld; expected 1, which this program reads",
               (long long)version);
  for (;;) {
    status = next_line(r, &text, &length, &more, err);
    if (status != STIC_OK)
      return status;
    if (!more)
      return BAD(r, err, "the log ends before its column header");
    if (length == 0 || text[0] != '#')
      break;
    keep_provenance(r, text, length);
  }
  if (!stic_line_is(text, length, STIC_LOG_HEADER))
    return BAD(r, err, "the columns are '%s'; expected t,state,x,y,z,theta,... of format 1",
               stic_error_quote(text, length, quoted, sizeof quoted));
  return STIC_OK;
}

stic_status stic_log_open(const char *path, stic_log_reader **reader, stic_error *err)
{
  stic_log_reader *r = malloc(sizeof *r);
  stic_status status;

  *reader = NULL;
  if (!r)
    return stic_error_set(err, STIC_NO_MEMORY, path, 0, "out of memory");
  r->provenance_count = 0;
  status = stic_line_reader_open(path, &r->lines, err);
  if (status != STIC_OK) {
    free(r);
    return status;
  }
  status = read_head(r, err);
  if (status != STIC_OK) {
    stic_log_close(r);
    return status;
  }
  *reader = r;
  return STIC_OK;
}

void stic_log_close(stic_log_reader *reader)
{
  if (!reader)
    return;
  stic_line_reader_close(reader->lines);
  free(reader);
}

const char *stic_log_provenance(const stic_log_reader *reader, const char *key, int n)
{
  for (int i = 0; i < reader->provenance_count; i++) {
    if (strcmp(reader->provenance[i].key, key) == 0 && n-- == 0)
      return reader->provenance[i].value;
  }
  return "";
}

/* Fields of one row, taken from left to right; the first that is wrong is remembered. */
typedef struct row_reader {
  const stic_field *next;
  int column; /* of `next`, from 1 */
  int bad;    /* column, 0: none */
} row_reader;

static double take_double(row_reader *row)
{
  double value = 0;

  if (stic_number_parse(row->next->text, row->next->length, &value) != STIC_NUMBER_OK && !row->bad)
    row->bad = row->column;
  row->next++;
  row->column++;
  return value;
}

static int64_t take_integer(row_reader *row, int64_t high)
{
  int64_t value = 0;

  if (stic_number_parse_integer(row->next->text, row->next->length, 0, high, &value) != STIC_NUMBER_OK &&
      !row->bad)
    row->bad = row->column;
  row->next++;
  row->column++;
  return value;
}

static int64_t take_time(row_reader *row)
{
  int64_t t_ns = 0;

  if (stic_number_parse_ns(row->next->text, row->next->length, &t_ns) != STIC_NUMBER_OK)
    row->bad = row->column;
  row->next++;
  row->column++;
  return t_ns;
}

static stic_state take_state(row_reader *row)
{
  const stic_field *field = row->next++;
  const int column = row->column++;

  for (stic_state state = STIC_RELEASED; state <= STIC_MULTI; state++) {
    if (stic_line_is(field->text, field->length, stic_state_name(state)))
      return state;
  }
  if (!row->bad)
    row->bad = column;
  return STIC_RELEASED;
}

static void take_contact(row_reader *row, stic_contact *c)
{
  c->vertex = (int)take_integer(row, STIC_VERTICES_MAX - 1);
  c->surface = (int)take_integer(row, STIC_SURFACES_MAX - 1);
  c->x = take_double(row);
  c->y = take_double(row);
  c->normal = take_double(row);
  c->friction = take_double(row);
}

/* Fields that must be empty. */
static void take_nothing(row_reader *row, int count)
{
  for (; count > 0; count--, row->next++, row->column++) {
    if (row->next->length > 0 && !row->bad)
      row->bad = row->column;
  }
}

static void take_row(row_reader *row, stic_result *r)
{
  memset(r, 0, sizeof *r);
  r->t_ns = take_time(row);
  r->state = take_state(row);
  r->x = take_double(row);
  r->y = take_double(row);
  r->z = take_double(row);
  r->theta = take_double(row);
  r->hand_x = take_double(row);
  r->hand_y = take_double(row);
  r->hand_z = take_double(row);
  r->hand_theta = take_double(row);
  r->force_x = take_double(row);
  r->force_y = take_double(row);
  r->moment = take_double(row);
  r->slips = take_integer(row, INT64_MAX);
  r->flags = (unsigned)take_integer(row, 0xffff);
  r->iterations = (int)take_integer(row, INT32_MAX);
  r->residual = take_double(row);
  r->contact_count = (int)take_integer(row, STIC_CONTACTS_MAX);
  for (int i = 0; i < STIC_LOG_CONTACTS; i++) {
    if (i < r->contact_count)
      take_contact(row, &r->contacts[i]);
    else
      take_nothing(row, CONTACT_COLUMNS);
  }
}

stic_status stic_log_next(stic_log_reader *r, stic_result *result, bool *more, stic_error *err)
{
  stic_field fields[COLUMNS];
  row_reader row = {fields, 1, 0};
  const char *text;
  size_t length;
  char quoted[40];
  int count;

  do {
    const stic_status status = next_line(r, &text, &length, more, err);

    if (status != STIC_OK || !*more)
      return status;
  } while (length > 0 && text[0] == '#');
  count = stic_fields_split(text, length, fields, COLUMNS);
  if (count != COLUMNS)
    return BAD(r, err, "found %d fields; expected %d", count, COLUMNS);
  take_row(&row, result);
  if (row.bad)
    return BAD(r, err, "column %d is '%s'; expected a value as in the column header", row.bad,
               stic_error_quote(fields[row.bad - 1].text, fields[row.bad - 1].length, quoted, sizeof quoted));
  return STIC_OK;
}

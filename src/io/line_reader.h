/* Lines of a text file, one after the other, in constant memory; the base of all CSV readers. */
#ifndef STIC_LINE_READER_H
#define STIC_LINE_READER_H

#include "../stiction.h"

#define STIC_LINE_MAX 65536 /* bytes of a line, without its end */

typedef enum stic_line_status {
  STIC_LINE_READ,       /* a whole line */
  STIC_LINE_TOO_LONG,   /* a line above the limit, told before its end is read; the rest of it is passed over */
  STIC_LINE_UNFINISHED, /* the last line, without its end; then STIC_LINE_END */
  STIC_LINE_END,
  STIC_LINE_WAIT,  /* interrupted by a signal, or nothing there on a non-blocking file; ask again */
  STIC_LINE_FAILED /* errno says why */
} stic_line_status;

typedef struct stic_line_reader stic_line_reader;

/* Opens a file, or standard input for "-". The caller owns `*reader`. Real-time: no. */
stic_status stic_line_reader_open(const char *path, stic_line_reader **reader, stic_error *err);
void stic_line_reader_close(stic_line_reader *reader); /* NULL allowed */

/* The next line without its end ("\n" or "\r\n"), not terminated, valid until the next call. At
 * most one read() in a call. A byte-order mark at the start of the file is passed over. Real-time: no. */
stic_line_status stic_line_reader_next(stic_line_reader *reader, const char **text, size_t *length);

/* Whether the next call returns without reading from the file. */
bool stic_line_reader_ready(const stic_line_reader *reader);

/* Number of the line last returned, from 1. */
int64_t stic_line_reader_number(const stic_line_reader *reader);
/* Path as opened, "standard input" for "-"; lives as long as the reader. */
const char *stic_line_reader_name(const stic_line_reader *reader);
/* For poll(). */
int stic_line_reader_fd(const stic_line_reader *reader);

/* Cuts a line at its commas: at most `limit` fields are stored, the true number is returned. Blanks
 * around a field do not belong to it. */
typedef struct stic_field {
  const char *text;
  size_t length;
} stic_field;
int stic_fields_split(const char *text, size_t length, stic_field *fields, int limit);

/* Whether the line is exactly `text`. */
bool stic_line_is(const char *line, size_t length, const char *text);

/* Reads "# stiction-KIND N": the number, or -1 if the line is something else. */
int64_t stic_line_format_version(const char *line, size_t length, const char *kind);

#endif

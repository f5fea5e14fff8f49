/* Traces: tracker samples as CSV ("# stiction-trace 1"), read and written sample by sample. */
#ifndef STIC_TRACE_CSV_H
#define STIC_TRACE_CSV_H

#include "../stiction.h"
#include "provenance.h"

#define STIC_TRACE_FORMAT "# stiction-trace 1"
#define STIC_TRACE_HEADER "t,x,y,z,qx,qy,qz,qw,buttons"
/* Times lie within +- this, 126 years: differences of two do not overflow. */
#define STIC_TRACE_TIME_MAX_NS INT64_C(4000000000000000000)
/* Bit of the `buttons` column that carries stic_sample.lost, so that a recording holds all that the
 * solver was given. */
#define STIC_TRACE_BUTTON_LOST 0x80000000u

/* ---- reading ----------------------------------------------------------------------------- */

typedef struct stic_trace_reader stic_trace_reader;

typedef struct stic_trace_options {
  bool lenient; /* default false; true: bad lines are passed over and counted */
  /* Told about each line passed over (an error) and about a dropped last line (a warning); may be
   * NULL. */
  void (*report)(void *context, bool warning, const stic_error *problem);
  void *context;
} stic_trace_options;

typedef enum stic_trace_status {
  STIC_TRACE_SAMPLE, /* `*sample` is set */
  STIC_TRACE_END,
  STIC_TRACE_WAIT, /* nothing yet: interrupted by a signal, or a slow pipe; ask again */
  STIC_TRACE_BAD   /* `*err` is set; the reader can only be closed */
} stic_trace_status;

/* Opens a trace, "-" for standard input. `options` may be NULL. The caller owns `*reader`.
 * Errors: STIC_BAD_INPUT, STIC_NO_MEMORY. Real-time: no. */
stic_status stic_trace_open(const char *path, const stic_trace_options *options, stic_trace_reader **reader,
                            stic_error *err);
void stic_trace_close(stic_trace_reader *reader); /* NULL allowed */

/* The next sample, in constant memory however long the trace. All rules are checked: the format
 * line first, an optional column header, nine plain numbers in a line, t (exact in whole ns)
 * increasing, a norm within 1 % of 1. A trace without any sample is bad. At most one read() in a call. */
stic_trace_status stic_trace_next(stic_trace_reader *reader, stic_sample *sample, stic_error *err);

/* Whether the next call needs nothing from the file. */
bool stic_trace_ready(const stic_trace_reader *reader);
/* For poll(). */
int stic_trace_fd(const stic_trace_reader *reader);
/* Lines passed over so far (lenient). */
int64_t stic_trace_skipped(const stic_trace_reader *reader);

/* ---- writing ----------------------------------------------------------------------------- */

typedef struct stic_trace_writer stic_trace_writer;

/* Creates a recording. It is written line by line with one write() each, so that all but the last
 * line survives a crash; an existing file is replaced by the first sample, unless another program is recording to it. `provenance` may be
 * NULL: none. "-" is standard output. Errors: STIC_CANNOT_WRITE, STIC_NO_MEMORY. Real-time: no. */
stic_status stic_trace_create(const char *path, const stic_provenance *provenance, stic_trace_writer **writer,
                              stic_error *err);
/* Appends one sample; reading it back gives the same one, bit for bit. */
stic_status stic_trace_write(stic_trace_writer *writer, const stic_sample *sample, stic_error *err);
/* Ends the recording and frees the writer, also after an error; NULL allowed. Without `err` a recording that has no
 * sample yet is given up: the older file stays, or none. */
stic_status stic_trace_finish(stic_trace_writer *writer, stic_error *err);

/* The text of one sample with its line end; returns its length. `out` needs STIC_TRACE_LINE_MAX. */
#define STIC_TRACE_LINE_MAX 320
size_t stic_trace_line(const stic_sample *sample, char *out);

#endif

/* An output that appears whole or not at all: written beside its place, then renamed. */
#ifndef STIC_OUTFILE_H
#define STIC_OUTFILE_H

#include "../stiction.h"

typedef struct stic_outfile stic_outfile;

/* The file that errors name where the path is "-". */
#define STIC_OUTFILE_STDOUT "standard output"

/* Starts an output for `path`; nothing appears there before stic_outfile_commit(). An existing file
 * keeps its permissions and is replaced only then; a symbolic link's target is meant and has to be there. "-" (standard
 * output) and what is no regular file (a pipe, /dev/null) are written directly. The caller owns
 * `*out`. Errors: STIC_CANNOT_WRITE, STIC_NO_MEMORY. Real-time: no. */
stic_status stic_outfile_open(const char *path, stic_outfile **out, stic_error *err);

/* Appends. Buffered; a failure is remembered and told by stic_outfile_error() and on commit, so that
 * a writer need not check each call. */
void stic_outfile_write(stic_outfile *out, const void *data, size_t length);
void stic_outfile_print(stic_outfile *out, const char *format, ...)
#if defined(__GNUC__)
  __attribute__((format(printf, 2, 3)))
#endif
  ;

/* Direct access for fast writers: room for `length` (<= STIC_OUTFILE_RESERVE_MAX) bytes, never NULL;
 * then say how many were used. */
#define STIC_OUTFILE_RESERVE_MAX 16384
char *stic_outfile_reserve(stic_outfile *out, size_t length);
void stic_outfile_used(stic_outfile *out, size_t length);

/* Writes what is buffered now; returns as stic_outfile_error(). */
int stic_outfile_flush(stic_outfile *out);

/* 0, or the errno of the first failure so far. EPIPE: the reader of the output has gone. */
int stic_outfile_error(const stic_outfile *out);

/* Writes what is buffered, makes the file durable and moves it into place. Frees `out` always; on
 * failure nothing is left. NULL allowed. */
stic_status stic_outfile_commit(stic_outfile *out, stic_error *err);

/* Ends without a trace. NULL allowed. */
void stic_outfile_abort(stic_outfile *out);

#endif

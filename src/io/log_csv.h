/* Logs: one row of CSV per solved sample ("# stiction-log 1"). */
#ifndef STIC_LOG_CSV_H
#define STIC_LOG_CSV_H

#include "../stiction.h"
#include "outfile.h"
#include "provenance.h"

#define STIC_LOG_FORMAT "# stiction-log 1"
#define STIC_LOG_CONTACTS 4 /* listed in a row */
#define STIC_LOG_HEADER                                                                                      \
  "t,state,x,y,z,theta,hand_x,hand_y,hand_z,hand_theta,force_x,force_y,moment,slips,flags,"                  \
  "iterations,residual,contacts,"                                                                            \
  "c1_vertex,c1_surface,c1_x,c1_y,c1_normal,c1_friction,"                                                    \
  "c2_vertex,c2_surface,c2_x,c2_y,c2_normal,c2_friction,"                                                    \
  "c3_vertex,c3_surface,c3_x,c3_y,c3_normal,c3_friction,"                                                    \
  "c4_vertex,c4_surface,c4_x,c4_y,c4_normal,c4_friction"

/* Writes the format line, provenance (no clock values) and column header. */
void stic_log_begin(stic_outfile *out, const stic_provenance *provenance);

/* Appends a row; failures show in the outfile. No allocation. */
void stic_log_row(stic_outfile *out, const stic_result *result);

/* The text of one row with its line end; returns its length. `text` needs STIC_LOG_ROW_MAX. */
#define STIC_LOG_ROW_MAX 1536
size_t stic_log_row_text(const stic_result *result, char *text);

/* ---- reading ----------------------------------------------------------------------------- */

typedef struct stic_log_reader stic_log_reader;

/* Opens a log ("-": standard input) and checks its version and header. The caller owns `*reader`.
 * Errors: STIC_BAD_INPUT, STIC_NO_MEMORY. Real-time: no. */
stic_status stic_log_open(const char *path, stic_log_reader **reader, stic_error *err);
void stic_log_close(stic_log_reader *reader); /* NULL allowed */

/* The next row: `*more` is false at the end. What a log does not hold is 0: the holding point and
 * contacts after the fourth (contact_count stays the true number). A signal while it waits is an error. */
stic_status stic_log_next(stic_log_reader *reader, stic_result *result, bool *more, stic_error *err);

/* Value of the n-th provenance line (from 0) of that key: "set" may occur several times. "" if there is none; lives as
 * long as the reader. */
const char *stic_log_provenance(const stic_log_reader *reader, const char *key, int n);

#endif

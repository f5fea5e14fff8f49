/* What a trace's log must be: its hash where the arithmetic is the same, some of its rows everywhere. */
#ifndef STIC_GOLDEN_H
#define STIC_GOLDEN_H

#include "../../src/stiction.h"
#include "../../src/io/sha256.h"

#define STIC_GOLDEN_LINE 160

/* All samples of a trace. */
typedef struct stic_golden_trace {
  stic_sample *samples;
  size_t count;
} stic_golden_trace;

/* The caller frees `trace->samples`. */
stic_status stic_golden_read_trace(const char *path, stic_golden_trace *trace, stic_error *err);

/* Told about each row; `events` are those of its step. */
typedef void stic_golden_visit(void *user, const stic_result *row, const stic_event *events, int event_count);

/* Replays with the default settings (event, f64). `visit` may be NULL. `hash` is that of the log's
 * column header and rows: `grep -v '^#' log.csv | sha256sum` gives the same. */
stic_status stic_golden_replay(const stic_scene *scene, const stic_settings *settings,
                               const stic_golden_trace *trace, stic_golden_visit *visit, void *user,
                               char hash[STIC_SHA256_TEXT], stic_error *err);

/* expected.hash */
typedef struct stic_golden_expected {
  char log[STIC_SHA256_TEXT];        /* of the log */
  char arithmetic[STIC_SHA256_TEXT]; /* of the C library's functions where it was made */
  char made_on[STIC_GOLDEN_LINE];    /* for people */
} stic_golden_expected;

/* Fills in what holds here, all but `log`. Two machines with the same `arithmetic` give the same logs:
 * it hashes what sin, cos, acos, atan2 and hypot return for a few thousand arguments, as these
 * differ in the last bit between processors with and without FMA and between C libraries. */
void stic_golden_here(stic_golden_expected *here);

stic_status stic_golden_write_expected(const char *path, const stic_golden_expected *expected,
                                       stic_error *err);
stic_status stic_golden_read_expected(const char *path, stic_golden_expected *expected, stic_error *err);

#endif

/* Where the time goes: histograms of high dynamic range per stage, and their summary as JSON. */
#ifndef STIC_TIMING_H
#define STIC_TIMING_H

#include "../clock.h"
#include "../stiction.h"

/* Sleeps until that time. False if a signal came first. Real-time: yes. */
bool stic_clock_sleep_until(int64_t t_ns);

/* ---- histogram --------------------------------------------------------------------------- */

/* Counts of times from 1 ns to above 100 s in bins that double 128 times finer than by two: what it
 * tells is within 0.4 % of what was added, below 256 ns exact. */
#define STIC_HISTOGRAM_STEPS 128
#define STIC_HISTOGRAM_OCTAVES 31 /* beyond the first: 2^(7 + 31) ns = 275 s */
#define STIC_HISTOGRAM_BINS (STIC_HISTOGRAM_STEPS * (STIC_HISTOGRAM_OCTAVES + 1))

typedef struct stic_histogram {
  int64_t count;
  int64_t max_ns; /* exact */
  uint64_t bins[STIC_HISTOGRAM_BINS];
} stic_histogram;

/* All zero is an empty histogram. Negative times count as 0, those beyond the range in the last bin
 * (the maximum stays exact). Real-time: yes. */
void stic_histogram_add(stic_histogram *histogram, int64_t ns);

/* The time that `part` (0..1] of all were no longer than; 0 if there are none. Real-time: yes. */
int64_t stic_histogram_quantile(const stic_histogram *histogram, double part);

/* ---- stages of a run --------------------------------------------------------------------- */

#define STIC_TARGET_HZ 31 /* frames a second that the paper's loop must reach */
#define STIC_FRAME_NS (1000000000 / STIC_TARGET_HZ)

typedef enum stic_stage {
  STIC_STAGE_READ,
  STIC_STAGE_COLLIDE,
  STIC_STAGE_SOLVE,
  STIC_STAGE_RENDER,
  STIC_STAGE_ENCODE,
  STIC_STAGE_WRITE,
  STIC_STAGE_FRAME,  /* one whole turn of the loop, without waiting */
  STIC_STAGE_WAKEUP, /* how late the loop woke; no part of a frame */
  STIC_STAGE_COUNT
} stic_stage;

typedef struct stic_timing {
  int64_t missed; /* frames longer than 1/31 s */
  stic_histogram stages[STIC_STAGE_COUNT];
} stic_timing;

/* NULL if there is no memory. Free with free(). Real-time: no. */
stic_timing *stic_timing_create(void);

/* Adds to a stage; STIC_STAGE_FRAME also counts what missed 1/31 s. `timing` NULL: nothing. Real-time: yes. */
void stic_timing_add(stic_timing *timing, stic_stage stage, int64_t ns);

/* "x86_64, <processor>, Linux 6.1": what the numbers hold for. Returns out. Real-time: no. */
const char *stic_machine_text(char *out, size_t out_size);

/* Writes the summary as JSON to a file ("-": standard output), whole or not at all. `seconds`: how
 * long all took; `scheduling`: what the loop got ("" if it asked for nothing). Real-time: no. */
stic_status stic_timing_write(const stic_timing *timing, double seconds, const char *scheduling,
                              const char *path, stic_error *err);

#endif

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
  STIC_STAGE_FRAME,   /* one whole turn of the loop, without waiting */
  STIC_STAGE_WAKEUP,  /* how late the loop woke; no part of a frame */
  STIC_STAGE_LATENCY, /* from the measurement of a sample to its result */
  STIC_STAGE_COUNT
} stic_stage;

#define STIC_DEVICE_RATES 4 /* 50, 62.5, 125, 250 Hz: those of trackers */
#define STIC_MISSES_MAX 32  /* listed one by one */
#define STIC_COUNTS_MAX 12

/* A deadline of 1/31 s that was missed. */
typedef struct stic_miss {
  int64_t at_ns;   /* since the run's start */
  int64_t ns;      /* how long it took */
  const char *why; /* "computing", "wakeup"; a literal */
} stic_miss;

/* A number of the run's. */
typedef struct stic_count {
  const char *name; /* a literal */
  int64_t value;
} stic_count;

typedef struct stic_timing {
  int64_t missed;                  /* frames longer than 1/31 s */
  int64_t over[STIC_DEVICE_RATES]; /* frames longer than the periods of those rates */
  int miss_count;                  /* of `misses`: the first ones */
  stic_miss misses[STIC_MISSES_MAX];
  int count_count;
  stic_count counts[STIC_COUNTS_MAX];
  stic_histogram stages[STIC_STAGE_COUNT];
} stic_timing;

/* NULL if there is no memory. Free with free(). Real-time: no. */
stic_timing *stic_timing_create(void);

/* Adds to a stage; STIC_STAGE_FRAME also counts what missed 1/31 s. `timing` NULL: nothing. Real-time: yes. */
void stic_timing_add(stic_timing *timing, stic_stage stage, int64_t ns);

/* Adds the simulation's last step to its stages; returns how long it took. Real-time: yes. */
int64_t stic_timing_add_step(stic_timing *timing, const stic_sim *sim);

/* Lists a missed deadline; what is too much for the list is left out. Real-time: yes. */
void stic_timing_list_miss(stic_timing *timing, int64_t at_ns, int64_t ns, const char *why);

/* A number that the summary tells under that name (a literal). At most STIC_COUNTS_MAX. */
void stic_timing_count(stic_timing *timing, const char *name, int64_t value);

/* Adds what another thread has measured; misses stay in order of time. Real-time: no. */
void stic_timing_merge(stic_timing *into, const stic_timing *from);

/* The rate in Hz that over[index] is about. */
double stic_timing_rate(int index);

/* "x86_64, <processor>, Linux 6.1": what the numbers hold for. Returns out. Real-time: no. */
const char *stic_machine_text(char *out, size_t out_size);

/* Writes the summary as JSON to a file ("-": standard output), whole or not at all. `seconds`: how
 * long all took; `scheduling`: what the loop got ("" if it asked for nothing). Real-time: no. */
stic_status stic_timing_write(const stic_timing *timing, double seconds, const char *scheduling,
                              const char *path, stic_error *err);

#endif

#include "timing.h"

#include "../error.h"
#include "json.h"
#include "outfile.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <time.h>

#define NS_PER_S 1000000000

static const struct {
  const char *name;
  double hz;
  int64_t period_ns;
} rates[STIC_DEVICE_RATES] = {
  {"50", 50, 20000000}, {"62.5", 62.5, 16000000}, {"125", 125, 8000000}, {"250", 250, 4000000}};

bool stic_clock_sleep_until(int64_t t_ns)
{
  struct timespec until;

  if (t_ns <= 0)
    return true;
  until.tv_sec = (time_t)(t_ns / NS_PER_S);
  until.tv_nsec = (long)(t_ns % NS_PER_S);
  return clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL) == 0;
}

/* ---- histogram --------------------------------------------------------------------------- */

/* How often a time must be halved to be below 2 STEPS. */
static int halvings(uint64_t ns)
{
  int n = 0;

  while (ns >> n >= 2 * STIC_HISTOGRAM_STEPS)
    n++;
  return n;
}

/* Times below 2 STEPS have a bin each; above, each octave has STEPS bins. */
static size_t bin_of(uint64_t ns)
{
  const int n = halvings(ns);
  const size_t bin = (size_t)n * STIC_HISTOGRAM_STEPS + (size_t)(ns >> n);

  return bin < STIC_HISTOGRAM_BINS ? bin : STIC_HISTOGRAM_BINS - 1;
}

static int64_t middle_of_bin(size_t bin)
{
  const size_t n = bin < 2 * STIC_HISTOGRAM_STEPS ? 0 : bin / STIC_HISTOGRAM_STEPS - 1;
  const int64_t low = (int64_t)(bin - n * STIC_HISTOGRAM_STEPS) << n;

  return low + (((int64_t)1 << n) - 1) / 2;
}

void stic_histogram_add(stic_histogram *histogram, int64_t ns)
{
  const int64_t t = ns > 0 ? ns : 0;

  histogram->bins[bin_of((uint64_t)t)]++;
  histogram->count++;
  if (t > histogram->max_ns)
    histogram->max_ns = t;
}

int64_t stic_histogram_quantile(const stic_histogram *histogram, double part)
{
  const double exact = ceil(part * (double)histogram->count);
  const uint64_t rank = exact >= 1 ? (uint64_t)exact : 1;
  uint64_t sum = 0;

  assert(part > 0 && part <= 1);
  for (size_t bin = 0; bin < STIC_HISTOGRAM_BINS; bin++) {
    sum += histogram->bins[bin];
    if (sum >= rank) {
      const int64_t t = middle_of_bin(bin);

      return t < histogram->max_ns ? t : histogram->max_ns;
    }
  }
  return histogram->max_ns;
}

/* ---- stages ------------------------------------------------------------------------------ */

stic_timing *stic_timing_create(void)
{
  return calloc(1, sizeof(stic_timing));
}

void stic_timing_add(stic_timing *timing, stic_stage stage, int64_t ns)
{
  assert((unsigned)stage < STIC_STAGE_COUNT);
  if (!timing)
    return;
  stic_histogram_add(&timing->stages[stage], ns);
  if (stage != STIC_STAGE_FRAME)
    return;
  timing->missed += ns > STIC_FRAME_NS;
  for (int i = 0; i < STIC_DEVICE_RATES; i++)
    timing->over[i] += ns > rates[i].period_ns;
}

int64_t stic_timing_add_step(stic_timing *timing, const stic_sim *sim)
{
  int64_t collide, total;

  stic_sim_stage_times(sim, &collide, &total);
  stic_timing_add(timing, STIC_STAGE_COLLIDE, collide);
  stic_timing_add(timing, STIC_STAGE_SOLVE, total - collide);
  return total;
}

void stic_timing_list_miss(stic_timing *timing, int64_t at_ns, int64_t ns, const char *why)
{
  if (timing->miss_count < STIC_MISSES_MAX)
    timing->misses[timing->miss_count++] = (stic_miss){at_ns, ns, why};
}

void stic_timing_count(stic_timing *timing, const char *name, int64_t value)
{
  assert(timing->count_count < STIC_COUNTS_MAX);
  timing->counts[timing->count_count++] = (stic_count){name, value};
}

double stic_timing_rate(int index)
{
  assert(index >= 0 && index < STIC_DEVICE_RATES);
  return rates[index].hz;
}

static void merge_histogram(stic_histogram *into, const stic_histogram *from)
{
  into->count += from->count;
  if (from->max_ns > into->max_ns)
    into->max_ns = from->max_ns;
  for (size_t bin = 0; bin < STIC_HISTOGRAM_BINS; bin++)
    into->bins[bin] += from->bins[bin];
}

/* Both lists are in order of time and hold the first ones, so the result holds the first of all. */
static void merge_misses(stic_timing *into, const stic_timing *from)
{
  const stic_timing *const of[2] = {into, from};
  stic_miss merged[STIC_MISSES_MAX];
  int at[2] = {0, 0}, count = 0;

  while (count < STIC_MISSES_MAX && (at[0] < into->miss_count || at[1] < from->miss_count)) {
    const bool first = at[1] == from->miss_count ||
                       (at[0] < into->miss_count && into->misses[at[0]].at_ns <= from->misses[at[1]].at_ns);
    const int which = first ? 0 : 1;

    merged[count++] = of[which]->misses[at[which]++];
  }
  memcpy(into->misses, merged, (size_t)count * sizeof merged[0]);
  into->miss_count = count;
}

void stic_timing_merge(stic_timing *into, const stic_timing *from)
{
  into->missed += from->missed;
  for (int i = 0; i < STIC_DEVICE_RATES; i++)
    into->over[i] += from->over[i];
  merge_misses(into, from);
  for (int i = 0; i < from->count_count; i++)
    stic_timing_count(into, from->counts[i].name, from->counts[i].value);
  for (int i = 0; i < STIC_STAGE_COUNT; i++)
    merge_histogram(&into->stages[i], &from->stages[i]);
}

/* The processor's name as /proc/cpuinfo has it, "" elsewhere. */
static void processor_name(char *out, size_t out_size)
{
  FILE *file = fopen("/proc/cpuinfo", "re");
  char line[256];

  out[0] = '\0';
  while (file && fgets(line, sizeof line, file)) {
    const char *colon = strchr(line, ':');

    if (strncmp(line, "model name", 10) != 0 || !colon)
      continue;
    /* cppcheck-suppress unreadVariable // read through `colon` */
    line[strcspn(line, "\n")] = '\0';
    stic_error_quote(colon + 2, strlen(colon + 2), out, out_size);
    break;
  }
  if (file)
    fclose(file);
}

const char *stic_machine_text(char *out, size_t out_size)
{
  struct utsname system;
  char processor[128];

  processor_name(processor, sizeof processor);
  if (uname(&system) < 0)
    memset(&system, 0, sizeof system);
  snprintf(out, out_size, "%s, %s%s%s %s", system.machine, processor, processor[0] ? ", " : "",
           system.sysname, system.release);
  return out;
}

static json_t *stage_json(const stic_histogram *h)
{
  return json_pack("{s:I, s:I, s:I, s:I, s:I}", "count", (json_int_t)h->count, "p50_ns",
                   (json_int_t)stic_histogram_quantile(h, 0.5), "p99_ns",
                   (json_int_t)stic_histogram_quantile(h, 0.99), "p999_ns",
                   (json_int_t)stic_histogram_quantile(h, 0.999), "max_ns", (json_int_t)h->max_ns);
}

static json_t *misses_json(const stic_timing *timing)
{
  json_t *list = json_array();

  for (int i = 0; i < timing->miss_count; i++) {
    const stic_miss *miss = &timing->misses[i];

    list = stic_json_append(list, json_pack("{s:f, s:I, s:s}", "t", (double)miss->at_ns / NS_PER_S, "ns",
                                            (json_int_t)miss->ns, "why", miss->why));
  }
  return list;
}

static json_t *timing_json(const stic_timing *timing, double seconds, const char *scheduling)
{
  static const char *const names[] = {"read", "collide", "solve", "render", "encode", "write", "frame"};
  json_t *stages = json_object(), *over = json_object(), *counts = json_object();
  char machine[512];

  for (int i = 0; i <= STIC_STAGE_FRAME; i++)
    stages = stic_json_set(stages, names[i], stage_json(&timing->stages[i]));
  for (int i = 0; i < STIC_DEVICE_RATES; i++)
    over = stic_json_set(over, rates[i].name, json_integer(timing->over[i]));
  for (int i = 0; i < timing->count_count; i++)
    counts = stic_json_set(counts, timing->counts[i].name, json_integer(timing->counts[i].value));
  return json_pack("{s:I, s:f, s:i, s:I, s:o, s:o, s:o, s:o, s:o, s:o, s:s, s:s}", "frames",
                   (json_int_t)timing->stages[STIC_STAGE_FRAME].count, "seconds", seconds, "target_hz",
                   STIC_TARGET_HZ, "missed", (json_int_t)timing->missed, "misses", misses_json(timing),
                   "over_hz", over, "counts", counts, "stages", stages, "wakeup",
                   stage_json(&timing->stages[STIC_STAGE_WAKEUP]), "latency",
                   stage_json(&timing->stages[STIC_STAGE_LATENCY]), "machine",
                   stic_machine_text(machine, sizeof machine), "scheduling", scheduling);
}

stic_status stic_timing_write(const stic_timing *timing, double seconds, const char *scheduling,
                              const char *path, stic_error *err)
{
  json_t *json = timing_json(timing, seconds, scheduling);
  char *text = stic_json_text(json, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
  stic_outfile *out = NULL;
  stic_status status;

  json_decref(json);
  if (!text)
    return stic_error_set(err, STIC_NO_MEMORY, path, 0, "out of memory");
  status = stic_outfile_open(path, &out, err);
  if (status == STIC_OK) {
    stic_outfile_write(out, text, strlen(text));
    stic_outfile_write(out, "\n", 1);
    status = stic_outfile_commit(out, err);
  }
  free(text);
  return status;
}

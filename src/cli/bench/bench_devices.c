/* stiction bench devices: from a report's bytes to its result and its line in the recording. */
#define _XOPEN_SOURCE 700 /* mkstemp() */
#include "../../../drivers/gamepad/gamepad_decode.h"
#include "../../../drivers/hydra/hydra_decode.h"
#include "../../../drivers/logitech/logitech_stream.h"
#include "../../../drivers/spacemouse/spacemouse_decode.h"
#include "../../error.h"
#include "../../io/outfile.h"
#include "../../io/trace_csv.h"
#include "../../live/live.h"
#include "bench.h"
#include "bench_unit.h"
#include "../cli.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define TOGETHER 16 /* reports decoded between two looks at the clock, which costs as much as one */
#define OWN_RATE 50.0
#define FAST_RATE 20000.0             /* 80 times the quickest tracker's 250 Hz */
#define START_NS INT64_C(20000000000) /* that the driver's start may take */
#define DRAIN_NS INT64_C(5000000000)  /* that the last report may take to its line */
#define SECONDS_MAX 3600

typedef struct bench {
  bool quick;
  double seconds;
  stic_outfile *csv; /* NULL: not asked for */
  stic_histogram histogram;
} bench;

static void print_head(const char *title, const char *unit)
{
  printf("%s, %s\n  %-28s %9s %9s %9s %9s\n", title, unit, "", "median", "p99", "worst", "count");
}

/* One row, in ns divided by `unit`; the CSV has ns. */
static void print_row(bench *b, const char *what, const char *name, double unit)
{
  const stic_histogram *h = &b->histogram;
  const int64_t p50 = stic_histogram_quantile(h, 0.5), p99 = stic_histogram_quantile(h, 0.99);

  printf("  %-28s %9.1f %9.1f %9.1f %9lld\n", name, (double)p50 / unit, (double)p99 / unit,
         (double)h->max_ns / unit, (long long)h->count);
  if (b->csv)
    stic_outfile_print(b->csv, "%s,%s,%lld,%lld,%lld,%lld\n", what, name, (long long)h->count, (long long)p50,
                       (long long)p99, (long long)h->max_ns);
}

/* ---- decoding ---------------------------------------------------------------------------- */

/* Decodes report number i; how many samples came of it. */
typedef int decode_function(void *state, int64_t i);

typedef struct decoders {
  stic_logitech_stream logitech;
  stic_spacemouse spacemouse;
  stic_hydra_report hydra;
  stic_gamepad pad;
  uint8_t report[128];
} decoders;

static int decode_logitech(void *state, int64_t i)
{
  decoders *d = state;
  uint8_t *bytes = d->report;
  stic_device_sample sample;
  size_t at = 0, used;
  int count = 0;
  bool given;

  memset(bytes, 0, STIC_LOGITECH_RECORD);
  bytes[0] = 0x80;
  bytes[3] = (uint8_t)(i & 0x7f);
  do {
    given = stic_logitech_stream_next(&d->logitech, bytes + at, STIC_LOGITECH_RECORD - at,
                                      i * STIC_LOGITECH_PERIOD_NS, &used, &sample);
    at += used;
    count += given;
  } while (given);
  return count;
}

static int decode_spacemouse(void *state, int64_t i)
{
  decoders *d = state;
  const uint8_t bytes[13] = {1, (uint8_t)i, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6, 0};

  return stic_spacemouse_decode(&d->spacemouse, bytes, sizeof bytes) == STIC_SPACEMOUSE_MOTION;
}

static int decode_hydra(void *state, int64_t i)
{
  decoders *d = state;

  (void)i;
  return stic_hydra_decode(d->report, STIC_HYDRA_REPORT_LENGTH, &d->hydra) == STIC_HYDRA_OK;
}

static int decode_pad(void *state, int64_t i)
{
  decoders *d = state;

  (void)i;
  return stic_gamepad_decode(d->report, 78, &d->pad) == STIC_GAMEPAD_OK;
}

/* A wand that stands at the base, its checksum right. */
static void make_hydra(uint8_t *report)
{
  uint16_t crc;

  memset(report, 0, STIC_HYDRA_REPORT_LENGTH);
  report[0] = 0x01;
  report[2] = 0x34;
  report[4] = 0x02;
  report[15] = report[37] = 0x7f; /* w of the quaternions */
  report[14] = report[36] = 0xff;
  crc = stic_hydra_crc(report, 50);
  report[50] = (uint8_t)crc;
  report[51] = (uint8_t)(crc >> 8);
}

static void make_pad(uint8_t *report)
{
  uint32_t crc;

  memset(report, 0, 78);
  report[0] = 0x31;
  report[9] = 8; /* hat centred */
  crc = stic_gamepad_crc(report, 74);
  for (int i = 0; i < 4; i++)
    report[74 + i] = (uint8_t)(crc >> (8 * i));
}

static stic_status decode_many(bench *b, const char *name, decode_function *decode, decoders *d,
                               stic_error *err)
{
  const int64_t rounds = b->quick ? 1000 : 200000;
  int64_t good = 0, number = 0;

  memset(&b->histogram, 0, sizeof b->histogram);
  for (int64_t round = 0; round < rounds && stic_cli_signal() == 0; round++) {
    const int64_t begin_ns = stic_clock_ns();

    for (int i = 0; i < TOGETHER; i++)
      good += decode(d, number++);
    stic_histogram_add(&b->histogram, (stic_clock_ns() - begin_ns) / TOGETHER);
  }
  print_row(b, "decode", name, 1);
  if (good != number)
    return stic_error_set(err, STIC_FAILED, NULL, 0, "%s: %lld of %lld reports decoded", name,
                          (long long)good, (long long)number);
  return STIC_OK;
}

static stic_status bench_decoders(bench *b, stic_error *err)
{
  decoders d;
  stic_status status;

  memset(&d, 0, sizeof d);
  print_head("Decoding", "ns a report (means of 16 at a time)");
  status = decode_many(b, "logitech", decode_logitech, &d, err);
  if (status == STIC_OK)
    status = decode_many(b, "spacemouse", decode_spacemouse, &d, err);
  make_hydra(d.report);
  if (status == STIC_OK)
    status = decode_many(b, "hydra", decode_hydra, &d, err);
  make_pad(d.report);
  if (status == STIC_OK)
    status = decode_many(b, "gamepad by Bluetooth", decode_pad, &d, err);
  return status;
}

/* ---- through the loop -------------------------------------------------------------------- */

/* What the writer sees. */
typedef struct arrivals {
  const stic_bench_unit *unit;
  stic_trace_writer *recording; /* NULL: none */
  stic_histogram *latency;      /* from a record's last byte to its result */
  int64_t next;                 /* the record that is to come */
  int64_t lost, repeated;
} arrivals;

static stic_status take_row(void *user, const stic_live_row *row, stic_error *err)
{
  arrivals *a = user;
  const int64_t index = stic_bench_unit_index(row->sample.position[2]);

  if (a->recording && stic_trace_write(a->recording, &row->sample, err) != STIC_OK)
    return STIC_CANNOT_WRITE;
  if (index < __atomic_load_n(&a->next, __ATOMIC_RELAXED)) {
    a->repeated++;
    return STIC_OK;
  }
  a->lost += index - a->next;
  if (index > 0) /* the first one waits for the second to confirm it */
    stic_histogram_add(a->latency, row->solved_ns - stic_bench_unit_sent(a->unit, index));
  __atomic_store_n(&a->next, index + 1, __ATOMIC_RELEASE);
  return STIC_OK;
}

static stic_status no_flush(void *user, stic_error *err)
{
  (void)user;
  (void)err;
  return STIC_OK;
}

/* A box above a floor, dragged by a hand on a circle. */
static stic_status make_sim(stic_sim **sim, stic_error *err)
{
  stic_settings settings;
  stic_scene scene;

  stic_scene_init(&scene);
  stic_scene_set_box(&scene, 0.16, 0.08);
  scene.y = 0.06;
  scene.stiffness = 200;
  scene.rotational_stiffness = 0.5;
  scene.surface_count = 1;
  memset(&scene.surfaces[0], 0, sizeof scene.surfaces[0]);
  scene.surfaces[0].normal_deg = 90;
  scene.surfaces[0].friction.mu_static = 0.5;
  scene.surfaces[0].friction.mu_dynamic = 0.3;
  stic_settings_init(&settings);
  return stic_sim_create(&scene, &settings, sim, err);
}

/* Until all records are through, nothing moves on any more, or a signal. */
static void wait_for_all(stic_live *live, const arrivals *a, int64_t count)
{
  int64_t seen = -1, moved_ns = stic_clock_ns();

  while (stic_live_runs(live) && stic_cli_signal() == 0) {
    const int64_t next = __atomic_load_n(&a->next, __ATOMIC_ACQUIRE);
    const int64_t now_ns = stic_clock_ns();

    if (next >= count)
      return;
    if (next != seen)
      moved_ns = now_ns;
    seen = next;
    if (now_ns - moved_ns > (next == 0 ? START_NS : DRAIN_NS))
      return;
    stic_live_wait(live, 100000000);
  }
}

static stic_status run_loop(arrivals *a, int64_t count, stic_live_report *report, stic_error *err)
{
  char spec[100];
  stic_tracker_settings settings;
  stic_tracker tracker;
  stic_live_settings live_settings = {.tracker = &tracker, .output = {a, take_row, no_flush}};
  stic_live *live;
  stic_status status;

  snprintf(spec, sizeof spec, "logitech:port=%.60s", stic_bench_unit_port(a->unit));
  stic_tracker_settings_init(&settings);
  stic_tracker_begin(&tracker, &settings, STIC_DRIVER_POSE);
  status = stic_supervisor_open(spec, NULL, &live_settings.device, err);
  if (status == STIC_OK)
    status = make_sim(&live_settings.sim, err);
  if (status == STIC_OK)
    status = stic_live_start(&live_settings, &live, err);
  if (status == STIC_OK) {
    wait_for_all(live, a, count);
    stic_live_finish(live, NULL, report);
    a->lost += count - a->next;
    if (report->output_error.status != STIC_OK) {
      *err = report->output_error;
      status = err->status;
    }
  }
  stic_sim_destroy(live_settings.sim);
  stic_supervisor_close(live_settings.device);
  return status;
}

static stic_status send_through(bench *b, double rate, int64_t count, stic_trace_writer *recording,
                                arrivals *a, stic_live_report *report, stic_error *err)
{
  stic_bench_unit *unit;
  stic_status status = stic_bench_unit_start(rate, count, &unit, err);

  memset(a, 0, sizeof *a);
  memset(&b->histogram, 0, sizeof b->histogram);
  if (status != STIC_OK)
    return status;
  a->unit = unit;
  a->recording = recording;
  a->latency = &b->histogram;
  status = run_loop(a, count, report, err);
  stic_bench_unit_stop(unit);
  return status;
}

static stic_status bench_latency(bench *b, stic_error *err)
{
  const int64_t count = (int64_t)(b->seconds * OWN_RATE);
  stic_live_report report;
  arrivals a;
  const stic_status status = send_through(b, OWN_RATE, count, NULL, &a, &report, err);

  if (status != STIC_OK)
    return status;
  print_head("\nFrom a record's last byte in a pseudo terminal to its result", "us");
  print_row(b, "latency", "logitech at 50 Hz", 1e3);
  printf("  scheduling: %s\n  repeated frames %lld, lost %lld\n", report.scheduling, (long long)a.repeated,
         (long long)a.lost);
  if (a.lost > 0 && stic_cli_signal() == 0)
    return stic_error_set(err, STIC_FAILED, NULL, 0, "%lld of %lld records lost", (long long)a.lost,
                          (long long)count);
  return STIC_OK;
}

/* ---- none lost --------------------------------------------------------------------------- */

/* Whether the recording holds each record, in order; how many are missing. */
static stic_status count_missing(const char *path, int64_t count, int64_t *missing, stic_error *err)
{
  stic_trace_reader *reader;
  stic_trace_status state = STIC_TRACE_SAMPLE;
  stic_status status = stic_trace_open(path, NULL, &reader, err);
  int64_t next = 0;

  *missing = 0;
  if (status != STIC_OK)
    return status;
  while (state == STIC_TRACE_SAMPLE || state == STIC_TRACE_WAIT) {
    stic_sample sample;

    state = stic_trace_next(reader, &sample, err);
    if (state == STIC_TRACE_SAMPLE) {
      const int64_t index = stic_bench_unit_index(sample.position[2]);

      *missing += index > next ? index - next : 0;
      next = index >= next ? index + 1 : next;
    }
  }
  stic_trace_close(reader);
  *missing += count - next;
  return state == STIC_TRACE_BAD ? STIC_BAD_INPUT : STIC_OK;
}

static stic_status record_all(bench *b, const char *path, int64_t count, stic_error *err)
{
  stic_trace_writer *recording;
  stic_live_report report;
  arrivals a;
  int64_t missing = 0;
  stic_status status = stic_trace_create(path, NULL, &recording, err);

  if (status != STIC_OK)
    return status;
  status = send_through(b, FAST_RATE, count, recording, &a, &report, err);
  if (stic_trace_finish(recording, status == STIC_OK ? err : NULL) != STIC_OK && status == STIC_OK)
    status = STIC_CANNOT_WRITE;
  if (status == STIC_OK && stic_cli_signal() == 0)
    status = count_missing(path, count, &missing, err);
  if (status != STIC_OK || stic_cli_signal() != 0)
    return status;
  print_row(b, "loss", "logitech at 20000 Hz", 1e3);
  printf(
    "  of %lld records lost: %lld on the way, %lld in the recording; the most that waited: %zu samples, %zu rows\n",
    (long long)count, (long long)a.lost, (long long)missing, report.samples_most, report.rows_most);
  if (a.lost > 0 || missing > 0)
    return stic_error_set(err, STIC_FAILED, NULL, 0, "records were lost");
  return STIC_OK;
}

static stic_status bench_loss(bench *b, stic_error *err)
{
  char path[] = "/tmp/stiction-bench-XXXXXX";
  const int file = mkstemp(path);
  stic_status status;

  if (file < 0)
    return stic_error_set(err, STIC_CANNOT_WRITE, "/tmp", 0, "cannot make a file for the bench");
  close(file);
  print_head("\nDriver, queues, solver and recorder as fast as they are sent", "us");
  status = record_all(b, path, b->quick ? 6000 : 600000, err);
  unlink(path);
  return status;
}

/* ---- all of it --------------------------------------------------------------------------- */

static stic_status measure(bench *b, stic_error *err)
{
  stic_status status = bench_decoders(b, err);

  if (status == STIC_OK && stic_cli_signal() == 0)
    status = bench_latency(b, err);
  if (status == STIC_OK && stic_cli_signal() == 0)
    status = bench_loss(b, err);
  return status;
}

int stic_bench_devices(const stic_bench_devices_options *o)
{
  bench *b = calloc(1, sizeof *b);
  stic_status status = STIC_OK;
  stic_error err;
  char machine[200];

  if (!b) {
    stic_cli_say("bench devices: out of memory");
    return STIC_NO_MEMORY;
  }
  if (!(o->seconds >= 0.1 && o->seconds <= SECONDS_MAX)) {
    stic_cli_say("bench devices: --seconds is %g; expected 0.1 to %d", o->seconds, SECONDS_MAX);
    free(b);
    return STIC_USAGE;
  }
  b->quick = o->quick;
  b->seconds = o->seconds;
  if (o->csv)
    status = stic_outfile_open(o->csv, &b->csv, &err);
  if (b->csv)
    stic_outfile_print(b->csv, "what,name,count,p50_ns,p99_ns,worst_ns\n");
  if (status == STIC_OK) {
    printf("%s\n", stic_machine_text(machine, sizeof machine));
    status = measure(b, &err);
  }
  if (status != STIC_OK || stic_cli_signal() != 0)
    stic_outfile_abort(b->csv);
  else
    status = stic_outfile_commit(b->csv, &err);
  free(b);
  if (status != STIC_OK)
    return stic_cli_fail(&err);
  return stic_cli_signal() != 0 ? STIC_EXIT_SIGNAL + stic_cli_signal() : STIC_OK;
}

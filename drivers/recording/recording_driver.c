#include "recording_driver.h"

#include "../../src/error.h"
#include "../../src/io/timing.h"
#include "recorded.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SPEED_MIN 1e-3
#define SPEED_MAX 1e6
#define PATH_ROOM 512
#define LOOP_PAUSE_NS 100000000 /* on the recording's clock, between its last sample and its first again */

typedef struct recording_device {
  stic_device base;
  stic_recorded *recorded;
  double speed;
  bool loop, begun, pending;
  int over;                 /* what ended it, to be told at each call from then on; 0: nothing */
  int64_t start_ns;         /* CLOCK_MONOTONIC of the round's first sample */
  int64_t first_ns;         /* the recording's time of it */
  stic_device_sample next;  /* if `pending`; its times are the recording's */
  stic_device_counters old; /* of the rounds before */
  char path[PATH_ROOM], driver[PATH_ROOM];
} recording_device;

static const stic_driver rate_driver;

static void recording_close(stic_device *device)
{
  recording_device *d = (recording_device *)device;

  stic_recorded_close(d->recorded);
  free(d);
}

static stic_status open_file(recording_device *d, stic_recorded **recorded, stic_error *err)
{
  const stic_recorded_options options = {d->driver[0] ? d->driver : NULL, false, NULL, NULL};

  return stic_recorded_open(d->path, &options, recorded, err);
}

static stic_status read_spec(recording_device *d, const stic_device_spec *spec, stic_error *err)
{
  const char *path = stic_spec_text(spec, "file", NULL);

  if (!path)
    return stic_error_set(err, STIC_USAGE, NULL, 0, "device recording: expected recording:file=FILE");
  if (strcmp(path, "-") == 0 && stic_spec_flag(spec, "loop"))
    return stic_error_set(err, STIC_USAGE, NULL, 0, "device recording: standard input cannot loop");
  snprintf(d->path, sizeof d->path, "%s", path); /* a specification is no longer than this */
  snprintf(d->driver, sizeof d->driver, "%s", stic_spec_text(spec, "driver", ""));
  d->loop = stic_spec_flag(spec, "loop");
  d->speed = 1;
  return stic_spec_number(spec, "speed", SPEED_MIN, SPEED_MAX, &d->speed, err);
}

static stic_status recording_open(const stic_device_spec *spec, stic_device **device, stic_error *err)
{
  recording_device *d = calloc(1, sizeof *d);
  stic_status status;

  if (!d)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  status = read_spec(d, spec, err);
  if (status == STIC_OK)
    status = open_file(d, &d->recorded, err);
  if (status != STIC_OK) {
    recording_close(&d->base);
    return status;
  }
  d->base.driver =
    stic_recorded_driver(d->recorded)->kind == STIC_DRIVER_RATE ? &rate_driver : &stic_recording_driver;
  d->base.state = STIC_CONNECTION_RUNNING;
  *device = &d->base;
  return STIC_OK;
}

/* The file is opened anew, which allocates once in a round. */
static int rewind_recording(recording_device *d)
{
  stic_recorded *again;

  if (open_file(d, &again, &d->base.error) != STIC_OK)
    return STIC_DRIVER_BAD_DATA;
  stic_recorded_close(d->recorded);
  d->recorded = again;
  d->begun = false;
  d->old = d->base.counters;
  return 0;
}

/* The recording's counters; samples are counted as they are given out. */
static void take_counters(recording_device *d)
{
  const stic_device_counters c = stic_recorded_counters(d->recorded);

  d->base.counters.bad_records = d->old.bad_records + c.bad_records;
  d->base.counters.gaps = d->old.gaps + c.gaps;
  d->base.counters.overruns = d->old.overruns + c.overruns;
}

/* Fills `next`: 0, or what poll() returns if there is no more. */
static int read_next(recording_device *d)
{
  while (!d->pending && !d->over) {
    const int count = stic_recorded_next(d->recorded, &d->next, 1);
    int result = count;

    take_counters(d);
    stic_device_show_raw(&d->base, stic_recorded_device(d->recorded)->raw,
                         stic_recorded_device(d->recorded)->raw_length);
    if (count == STIC_DRIVER_END && d->loop && d->begun)
      result = rewind_recording(d);
    if (count == STIC_DRIVER_BAD_DATA)
      d->base.error = *stic_recorded_error(d->recorded);
    d->over = result < 0 ? result : 0;
    d->pending = count > 0;
  }
  return d->over;
}

/* When `next` is due. */
static int64_t due_ns(recording_device *d)
{
  if (!d->begun) {
    d->start_ns = stic_clock_ns() + (d->old.samples > 0 ? (int64_t)(LOOP_PAUSE_NS / d->speed) : 0);
    d->first_ns = d->next.t_ns;
    d->begun = true;
  }
  return d->start_ns + (int64_t)((double)(d->next.t_ns - d->first_ns) / d->speed);
}

static int recording_poll(stic_device *device, int64_t until_ns, stic_device_sample *samples, int capacity)
{
  recording_device *d = (recording_device *)device;
  int count = 0;

  while (count < capacity) {
    const int result = read_next(d);
    int64_t due;

    if (result < 0)
      return count > 0 ? count : result; /* the end is told by the next call */
    due = due_ns(d);
    if (due > stic_clock_ns()) {
      if (count > 0)
        return count;
      stic_clock_sleep_until(due < until_ns ? due : until_ns);
      if (due > stic_clock_ns())
        return 0;
    }
    samples[count] = d->next;
    samples[count].t_ns = samples[count].source_ns = due;
    for (int i = 0; i < 3; i++) { /* the same way in less time */
      samples[count].velocity[i] *= d->speed;
      samples[count].turn_rate[i] *= d->speed;
    }
    d->pending = false;
    count++;
  }
  return count;
}

static void recording_describe(const stic_device *device, char *out, size_t out_size)
{
  const recording_device *d = (const recording_device *)device;
  char what[300];

  stic_recorded_describe(d->recorded, what, sizeof what);
  snprintf(out, out_size, "%s, from %s, speed %g%s", what, d->path, d->speed, d->loop ? ", loop" : "");
}

static const stic_spec_key keys[] = {
  {"file", false, "raw recording, HID or serial, '-' for standard input"},
  {"driver", false, "driver and its keys that decode it, default the one that fits"},
  {"speed", false, "how many times faster than recorded, 0.001 to 1e6, default 1"},
  {"loop", true, "start again at the end"},
  {NULL, false, NULL}};

/* What silence meant is in the samples already. */
#define RECORDING_DRIVER(kind_)                                                                              \
  {                                                                                                          \
    .name = "recording", .about = "a raw recording of a device, decoded again, paced as recorded",           \
    .keys = keys, .kind = (kind_), .silence = STIC_SILENCE_STALE, .silence_ns = 0, .own_time = false,        \
    .match = NULL, .open = recording_open, .poll = recording_poll, .send = NULL, .close = recording_close,   \
    .describe = recording_describe                                                                           \
  }

const stic_driver stic_recording_driver = RECORDING_DRIVER(STIC_DRIVER_POSE);
static const stic_driver rate_driver = RECORDING_DRIVER(STIC_DRIVER_RATE);

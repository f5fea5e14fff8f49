#include "trace_driver.h"

#include "../../src/error.h"
#include "../../src/io/timing.h"
#include "../../src/io/trace_csv.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SPEED_MIN 1e-3
#define SPEED_MAX 1e6
#define PATH_ROOM 512
#define LATEST_NS 4e18 /* a century from now: no overflow */

typedef struct trace_device {
  stic_device base;
  stic_trace_reader *reader;
  double speed;
  bool loop;
  bool begun;          /* the first sample has been given out or is pending */
  int64_t start_ns;    /* CLOCK_MONOTONIC of the trace's first sample */
  int64_t first_ns;    /* the trace's own time of its first sample, */
  int64_t last_ns;     /* of the last one read, */
  int64_t interval_ns; /* and between the last two */
  int64_t shift_ns;    /* added to the trace's times: the rounds before */
  bool pending;        /* `next` waits to be given out */
  int ended;           /* STIC_DRIVER_ that reading ended with; 0: goes on */
  stic_device_sample next;
  uint64_t sequence;
  char path[PATH_ROOM];
} trace_device;

static void trace_close(stic_device *device)
{
  trace_device *d = (trace_device *)device;

  stic_trace_close(d->reader);
  free(d);
}

static stic_status trace_open(const stic_device_spec *spec, stic_device **device, stic_error *err)
{
  const char *path = stic_spec_text(spec, "file", NULL);
  trace_device *d;
  stic_status status;

  if (!path || strlen(path) >= PATH_ROOM)
    return stic_error_set(err, STIC_USAGE, NULL, 0,
                          "device trace: expected trace:file=FILE, '-' for standard input");
  if (strcmp(path, "-") == 0 && stic_spec_flag(spec, "loop"))
    return stic_error_set(err, STIC_USAGE, NULL, 0, "device trace: standard input cannot loop");
  d = calloc(1, sizeof *d);
  if (!d)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  strcpy(d->path, path);
  d->base.driver = &stic_trace_driver;
  d->speed = 1;
  d->loop = stic_spec_flag(spec, "loop");
  status = stic_spec_number(spec, "speed", SPEED_MIN, SPEED_MAX, &d->speed, err);
  if (status == STIC_OK)
    status = stic_trace_open(path, NULL, &d->reader, err);
  if (status != STIC_OK) {
    trace_close(&d->base);
    return status;
  }
  d->base.state = STIC_CONNECTION_RUNNING;
  *device = &d->base;
  return STIC_OK;
}

/* Starts again from the trace's first sample, one interval after its last. The file is opened anew,
 * which costs an allocation once in a round. */
static int rewind_trace(trace_device *d)
{
  stic_trace_reader *again;

  if (stic_trace_open(d->path, NULL, &again, &d->base.error) != STIC_OK)
    return STIC_DRIVER_LOST;
  stic_trace_close(d->reader);
  d->reader = again;
  d->shift_ns += d->last_ns - d->first_ns + (d->interval_ns > 0 ? d->interval_ns : STIC_FRAME_NS);
  return 0;
}

static void take_sample(trace_device *d, const stic_sample *sample)
{
  stic_device_sample *next = &d->next;

  if (!d->begun) {
    d->begun = true;
    d->first_ns = sample->t_ns;
    d->start_ns = stic_clock_ns();
  } else if (sample->t_ns > d->last_ns) {
    d->interval_ns = sample->t_ns - d->last_ns;
  }
  d->last_ns = sample->t_ns;
  memset(next, 0, sizeof *next);
  next->source_ns = sample->t_ns + d->shift_ns;
  next->t_ns = d->start_ns + (int64_t)fmin((double)(next->source_ns - d->first_ns) / d->speed, LATEST_NS);
  next->sequence = d->sequence++;
  memcpy(next->position, sample->position, sizeof next->position);
  memcpy(next->orientation, sample->orientation, sizeof next->orientation);
  next->buttons = sample->buttons;
  next->flags = STIC_SAMPLE_POSITION | STIC_SAMPLE_ORIENTATION | (sample->lost ? 0 : STIC_SAMPLE_TRACKED);
  d->pending = true;
}

/* Waits until the file has something to read; false if not in time. */
static bool wait_for_input(const trace_device *d, int64_t until_ns)
{
  struct pollfd file = {stic_trace_fd(d->reader), POLLIN, 0};
  const int64_t left_ns = until_ns - stic_clock_ns();
  int64_t left_ms = left_ns > 0 ? (left_ns + 999999) / 1000000 : 0;

  if (stic_trace_ready(d->reader))
    return true;
  if (left_ms > 60000)
    left_ms = 60000;
  return poll(&file, 1, (int)left_ms) > 0;
}

/* Reads the next sample into `next`: 1, 0 if there is none in time, or one of STIC_DRIVER_. */
static int read_next(trace_device *d, int64_t until_ns)
{
  stic_sample sample;

  while (wait_for_input(d, until_ns)) {
    switch (stic_trace_next(d->reader, &sample, &d->base.error)) {
    case STIC_TRACE_SAMPLE: take_sample(d, &sample); return 1;
    case STIC_TRACE_WAIT:
      if (stic_clock_ns() >= until_ns)
        return 0;
      break;
    case STIC_TRACE_BAD: d->base.state = STIC_CONNECTION_LOST; return STIC_DRIVER_BAD_DATA;
    case STIC_TRACE_END:
      if (!d->loop) {
        d->base.state = STIC_CONNECTION_CLOSED;
        return STIC_DRIVER_END;
      }
      if (rewind_trace(d) != 0) {
        d->base.state = STIC_CONNECTION_LOST;
        return STIC_DRIVER_LOST;
      }
      break;
    }
  }
  return 0;
}

static int trace_poll(stic_device *device, int64_t until_ns, stic_device_sample *samples, int capacity)
{
  trace_device *d = (trace_device *)device;
  int count = 0;

  while (count < capacity) {
    if (!d->pending) {
      const int result = d->ended ? d->ended : read_next(d, count > 0 ? 0 : until_ns);

      if (result < 0)
        d->ended = result; /* told by the next call if there are samples to give out */
      if (result <= 0)
        return count > 0 ? count : result;
    }
    if (d->next.t_ns > stic_clock_ns()) {
      if (count > 0)
        return count;
      stic_clock_sleep_until(d->next.t_ns < until_ns ? d->next.t_ns : until_ns);
      if (d->next.t_ns > stic_clock_ns())
        return 0;
    }
    samples[count++] = d->next;
    d->pending = false;
  }
  return count;
}

static void trace_describe(const stic_device *device, char *out, size_t out_size)
{
  const trace_device *d = (const trace_device *)device;

  snprintf(out, out_size, "trace %s, speed %g%s", strcmp(d->path, "-") == 0 ? "standard input" : d->path,
           d->speed, d->loop ? ", loop" : "");
}

static const stic_spec_key keys[] = {
  {"file", false, "trace file, '-' for standard input"},
  {"speed", false, "how many times faster than recorded, 0.001 to 1e6, default 1"},
  {"loop", true, "start again at the end"},
  {NULL, false, NULL}};

const stic_driver stic_trace_driver = {
  .name = "trace",
  .about = "a recorded trace or standard input, paced as recorded",
  .keys = keys,
  .kind = STIC_DRIVER_POSE,
  .silence = STIC_SILENCE_STALE,
  .silence_ns = 0, /* pauses of a recording are part of it */
  .own_time = true,
  .in_room = true, /* a trace is a hand in the room already */
  .match = NULL,
  .open = trace_open,
  .poll = trace_poll,
  .send = NULL,
  .close = trace_close,
  .describe = trace_describe,
};

#include "logitech_recording.h"

#include "../../src/error.h"
#include "logitech_driver.h"
#include "logitech_stream.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct recorded_logitech {
  stic_device base;
  stic_raw_reader *reader;
  stic_logitech_stream stream;
  stic_raw_record next; /* if `pending` */
  size_t taken;         /* of its bytes */
  bool pending;
  int64_t clock_ns;
} recorded_logitech;

static void recording_close(stic_device *device)
{
  recorded_logitech *d = (recorded_logitech *)device;

  stic_raw_close(d->reader);
  free(d);
}

/* 0, or what poll() returns if there is no further record. */
static int read_record(recorded_logitech *d)
{
  while (!d->pending) {
    switch (stic_raw_next(d->reader, &d->next, &d->base.error)) {
    case STIC_RAW_RECORD:
      d->pending = true;
      d->taken = 0;
      stic_device_show_raw(&d->base, d->next.bytes, d->next.length);
      break;
    case STIC_RAW_WAIT: break;
    case STIC_RAW_END: d->base.state = STIC_CONNECTION_CLOSED; return STIC_DRIVER_END;
    case STIC_RAW_BAD: d->base.state = STIC_CONNECTION_LOST; return STIC_DRIVER_BAD_DATA;
    }
  }
  return 0;
}

static int give_samples(recorded_logitech *d, stic_device_sample *samples, int capacity)
{
  int count = 0;

  while (d->pending && count < capacity) {
    size_t used;

    if (stic_logitech_stream_next(&d->stream, d->next.bytes + d->taken, d->next.length - d->taken,
                                  d->next.t_ns, &used, &samples[count]))
      count++;
    else
      d->pending = false;
    d->taken += used;
  }
  d->base.counters.bad_records = stic_logitech_stream_bad(&d->stream);
  if (count > 0)
    d->base.state = STIC_CONNECTION_RUNNING;
  return count;
}

static int recording_poll(stic_device *device, int64_t until_ns, stic_device_sample *samples, int capacity)
{
  recorded_logitech *d = (recorded_logitech *)device;

  for (;;) {
    const int result = read_record(d);
    int count;

    if (result < 0)
      return result;
    if (d->next.t_ns > d->clock_ns && d->next.t_ns > until_ns) {
      d->clock_ns = until_ns > d->clock_ns ? until_ns : d->clock_ns;
      return 0;
    }
    d->clock_ns = d->next.t_ns > d->clock_ns ? d->next.t_ns : d->clock_ns;
    count = give_samples(d, samples, capacity);
    if (count > 0)
      return count;
  }
}

static void recording_describe(const stic_device *device, char *out, size_t out_size)
{
  (void)device;
  snprintf(out, out_size, "Logitech ultrasonic tracker, recorded");
}

static const stic_driver recording_driver = {
  .name = "logitech",
  .about = "a recording",
  .kind = STIC_DRIVER_POSE,
  .silence = STIC_SILENCE_STALE,
  .silence_ns = STIC_LOGITECH_SILENCE_NS,
  .poll = recording_poll,
  .close = recording_close,
  .describe = recording_describe,
};

stic_status stic_logitech_recording_begin(stic_raw_reader *reader, stic_device **device, stic_error *err)
{
  recorded_logitech *d = calloc(1, sizeof *d);
  int result;

  *device = NULL;
  if (!d) {
    stic_raw_close(reader);
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  }
  d->base.driver = &recording_driver;
  d->base.state = STIC_CONNECTION_SYNCING;
  d->reader = reader;
  result = read_record(d);
  if (result < 0) {
    if (err)
      *err = d->base.error;
    recording_close(&d->base);
    return STIC_BAD_INPUT;
  }
  d->clock_ns = d->next.t_ns;
  *device = &d->base;
  return STIC_OK;
}

int64_t stic_logitech_recording_now(const stic_device *device)
{
  return ((const recorded_logitech *)device)->clock_ns;
}

/* The smallest whole driver. Its "device" is a clock: a new one replaces due_ns by a file descriptor, and
 * take() by a decoder in a file of its own that knows no I/O. */
#include "sample_driver.h"

#include "../../src/angle.h"
#include "../../src/error.h"
#include "../../src/io/timing.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RADIUS 0.1 /* m */
#define TURN_S 4.0 /* s a circle */

/* `base` comes first, so that a pointer to one is a pointer to the other. All memory is here. */
typedef struct sample_device {
  stic_device base;
  double rate;      /* Hz */
  int64_t start_ns; /* CLOCK_MONOTONIC */
  int64_t due_ns;   /* of the next sample */
  uint64_t sequence;
} sample_device;

static void sample_close(stic_device *device)
{
  free(device);
}

static stic_status sample_open(const stic_device_spec *spec, stic_device **device, stic_error *err)
{
  sample_device *d = calloc(1, sizeof *d);
  stic_status status;

  if (!d)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  d->base.driver = &stic_sample_driver;
  d->rate = 50;
  status = stic_spec_number(spec, "rate", 1, 1000, &d->rate, err);
  if (status != STIC_OK) {
    sample_close(&d->base);
    return status;
  }
  d->start_ns = d->due_ns = stic_clock_ns();
  d->base.state = STIC_CONNECTION_RUNNING;
  *device = &d->base;
  return STIC_OK;
}

static void take(sample_device *d, stic_device_sample *sample)
{
  const double angle = 2 * STIC_PI / TURN_S * ((double)(d->due_ns - d->start_ns) / 1e9);

  memset(sample, 0, sizeof *sample);
  sample->t_ns = sample->source_ns = d->due_ns;
  sample->sequence = d->sequence++;
  sample->position[0] = RADIUS * cos(angle);
  sample->position[1] = RADIUS * sin(angle);
  sample->orientation[3] = 1;
  sample->flags = STIC_SAMPLE_POSITION | STIC_SAMPLE_ORIENTATION | STIC_SAMPLE_TRACKED;
  d->due_ns += (int64_t)(1e9 / d->rate);
}

static int sample_poll(stic_device *device, int64_t until_ns, stic_device_sample *samples, int capacity)
{
  sample_device *d = (sample_device *)device;
  int count = 0;

  if (d->due_ns > stic_clock_ns())
    stic_clock_sleep_until(d->due_ns < until_ns ? d->due_ns : until_ns);
  while (count < capacity && d->due_ns <= stic_clock_ns())
    take(d, &samples[count++]);
  return count;
}

static void sample_describe(const stic_device *device, char *out, size_t out_size)
{
  snprintf(out, out_size, "sample hand on a circle, %g a second", ((const sample_device *)device)->rate);
}

static const stic_spec_key keys[] = {{"rate", false, "samples a second, 1 to 1000, default 50"},
                                     {NULL, false, NULL}};

const stic_driver stic_sample_driver = {
  .name = "sample",
  .about = "no device: a hand on a circle, to try things out and to copy",
  .keys = keys,
  .kind = STIC_DRIVER_POSE,
  .silence = STIC_SILENCE_STALE,
  .silence_ns = 3000000000, /* three periods at the lowest rate */
  .own_time = false,
  .match = NULL,
  .open = sample_open,
  .poll = sample_poll,
  .send = NULL,
  .close = sample_close,
  .describe = sample_describe,
};

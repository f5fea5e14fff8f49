#include "mouse_driver.h"

#include "../../src/error.h"
#include "../../src/io/timing.h"
#include "../../src/live/ring.h"
#include "../../src/live/wake.h"

#include <stdio.h>
#include <stdlib.h>

#define QUEUE 1024 /* samples: a second of the fastest mouse */

typedef struct mouse_device {
  stic_device base;
  stic_ring *samples; /* the window writes, poll() reads */
  stic_wake wake;     /* sent by the window with every sample */
  int64_t last_ns;    /* the window's */
  uint64_t sequence;
  int64_t overruns; /* atomic: counted by the window, told by poll() */
} mouse_device;

static void mouse_close(stic_device *device)
{
  mouse_device *d = (mouse_device *)device;

  stic_wake_destroy(&d->wake);
  stic_ring_destroy(d->samples);
  free(d);
}

static stic_status mouse_open(const stic_device_spec *spec, stic_device **device, stic_error *err)
{
  mouse_device *d = calloc(1, sizeof *d);
  stic_status status;

  (void)spec;
  if (!d)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  d->base.driver = &stic_mouse_driver;
  d->wake.ends[0] = d->wake.ends[1] = -1;
  status = stic_ring_create(sizeof(stic_device_sample), QUEUE, &d->samples, err);
  if (status == STIC_OK)
    status = stic_wake_create(&d->wake, err);
  if (status != STIC_OK) {
    mouse_close(&d->base);
    return status;
  }
  d->base.state = STIC_CONNECTION_RUNNING;
  *device = &d->base;
  return STIC_OK;
}

bool stic_mouse_feed(stic_device *device, const stic_mouse_hand *hand)
{
  mouse_device *d = (mouse_device *)device;
  stic_device_sample *sample = stic_ring_slot(d->samples);
  const int64_t now_ns = stic_clock_ns();

  if (!sample) {
    __atomic_add_fetch(&d->overruns, 1, __ATOMIC_RELAXED);
    return false;
  }
  stic_mouse_hand_sample(hand, sample);
  d->last_ns = now_ns > d->last_ns ? now_ns : d->last_ns + 1;
  sample->t_ns = sample->source_ns = d->last_ns;
  sample->sequence = d->sequence++;
  stic_ring_put(d->samples);
  stic_wake_send(&d->wake);
  return true;
}

static int mouse_poll(stic_device *device, int64_t until_ns, stic_device_sample *samples, int capacity)
{
  mouse_device *d = (mouse_device *)device;
  const stic_device_sample *front;
  int count = 0;

  /* What earlier samples sent is still there and wakes as well: look, and wait again. */
  while (!stic_ring_front(d->samples) && stic_wake_wait(&d->wake, until_ns))
    ;
  while (count < capacity && (front = stic_ring_front(d->samples))) {
    samples[count++] = *front;
    stic_ring_take(d->samples);
  }
  device->counters.overruns = __atomic_load_n(&d->overruns, __ATOMIC_RELAXED);
  return count;
}

static void mouse_describe(const stic_device *device, char *out, size_t out_size)
{
  (void)device;
  snprintf(out, out_size, "mouse in the view");
}

static const stic_spec_key keys[] = {{NULL, false, NULL}};

const stic_driver stic_mouse_driver = {
  .name = "mouse",
  .about = "pointer and wheel in the live view: left button grips, wheel turns, ctrl+wheel moves in depth",
  .keys = keys,
  .kind = STIC_DRIVER_POSE,
  .silence = STIC_SILENCE_REST,
  .silence_ns = 0, /* a still mouse holds what it has */
  .own_time = false,
  .in_room = true,
  .match = NULL,
  .open = mouse_open,
  .poll = mouse_poll,
  .send = NULL,
  .close = mouse_close,
  .describe = mouse_describe,
};

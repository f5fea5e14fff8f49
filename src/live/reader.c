/* The reader: waits for the device, brings its samples into the room and queues all of them. */
#include "parts.h"

#define BATCH 64 /* samples taken at once */

/* The solver's time: since the first sample, or the source's own. */
static void set_time(live_reader *r, const stic_device_sample *from, live_sample *to)
{
  if (!r->begun)
    r->start_ns = from->t_ns;
  r->begun = true;
  to->zero_ns = r->start_ns;
  to->sample.t_ns = r->own_time ? from->source_ns : from->t_ns - r->start_ns;
}

/* A place in the queue; NULL: full. A source that waits for nobody's hand waits for the solver instead. */
static live_sample *place(stic_live *live)
{
  if (live->reader.own_time) {
    while (stic_ring_count(live->samples) >= STIC_LIVE_AHEAD && !live_flag(&live->stopping)) {
      stic_wake_send(&live->to_solver);
      stic_clock_sleep_until(stic_clock_ns() + 1000000);
    }
  }
  return stic_ring_slot(live->samples);
}

static void queue(stic_live *live, stic_device_sample *from, int64_t since_ns)
{
  live_reader *r = &live->reader;
  stic_sample sample;
  live_sample *to;

  if (!stic_supervisor_driver(r->device)->in_room)
    stic_tracker_apply(&r->tracker, from);
  if (!stic_tracker_solvable(from, &sample))
    return; /* nobody knows yet where the hand is */
  to = place(live);
  if (!to) {
    r->lost++;
    return;
  }
  to->sample = sample;
  set_time(r, from, to);
  to->arrived_ns = stic_clock_ns();
  to->read_ns = to->arrived_ns - since_ns;
  stic_timing_add(&r->timing, STIC_STAGE_READ, to->read_ns);
  stic_ring_put(live->samples);
}

static void tell_status(stic_live *live)
{
  live_status *status = stic_latest_slot(live->status);

  status->state = stic_supervisor_state(live->reader.device);
  status->counters = stic_supervisor_counters(live->reader.device);
  stic_latest_publish(live->status);
}

/* One turn; false at the device's end. */
static bool read_some(stic_live *live)
{
  live_reader *r = &live->reader;
  stic_device_sample samples[BATCH];
  const int64_t asleep_ns = stic_clock_ns();
  /* Not longer, so that a stop needs no signal to this thread. */
  const int count = stic_supervisor_poll(r->device, asleep_ns + STIC_FRAME_NS, samples, BATCH);
  const int64_t awake_ns = stic_clock_ns();

  if (count < 0)
    r->result = count;
  /* Late is what the scheduler adds; a sample that waited for us is another matter. */
  if (count > 0 && r->own_time && samples[0].t_ns > asleep_ns)
    stic_timing_add(&r->timing, STIC_STAGE_WAKEUP, awake_ns - samples[0].t_ns);
  for (int i = 0; i < count; i++)
    queue(live, &samples[i], i == 0 ? awake_ns : stic_clock_ns());
  tell_status(live);
  if (count > 0)
    stic_wake_send(&live->to_solver);
  return count >= 0;
}

void *stic_live_reader_main(void *context)
{
  stic_live *live = context;

  while (!live_flag(&live->stopping) && read_some(live))
    ;
  live_raise(&live->reader_done);
  stic_wake_send(&live->to_solver);
  return NULL;
}

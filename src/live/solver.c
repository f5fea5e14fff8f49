/* The solver, which is the loop: every sample in its turn, and a frame at least every 1/31 s. After its start it
 * allocates nothing, takes no lock and touches no file. */
#include <string.h>

#include "parts.h"

static bool has_room(const stic_live *live)
{
  /* How many events there will be is not known beforehand. */
  return stic_ring_slot(live->rows) &&
         (!live->events || STIC_LIVE_EVENTS - stic_ring_count(live->events) >= STIC_EVENTS_MAX);
}

/* A source that waits for nobody's hand waits for the writer; for a hand there is no waiting. */
static bool wait_for_room(stic_live *live)
{
  while (!has_room(live)) {
    if (!live->solver.own_time || live_flag(&live->stopping))
      return false;
    stic_clock_sleep_until(stic_clock_ns() + 1000000);
  }
  return true;
}

static void queue_row(stic_live *live, const stic_sample *sample, const stic_result *result)
{
  const int listed = result->contact_count < STIC_LOG_CONTACTS ? result->contact_count : STIC_LOG_CONTACTS;
  live_row *row = stic_ring_slot(live->rows);

  row->sample = *sample;
  row->solved_ns = stic_clock_ns();
  row->event_count = 0;
  memcpy(row->result, result, offsetof(stic_result, contacts) + (size_t)listed * sizeof(stic_contact));
  if (live->events) {
    const stic_event *events = stic_sim_events(live->solver.sim, &row->event_count);

    for (int i = 0; i < row->event_count; i++) {
      memcpy(stic_ring_slot(live->events), &events[i], sizeof events[i]);
      stic_ring_put(live->events);
    }
  }
  stic_ring_put(live->rows);
}

static void show(stic_live *live, const stic_result *result, int64_t now_ns)
{
  const live_status *status = stic_latest_read(live->status, NULL);
  stic_live_view_item *item = stic_latest_slot(live->view);

  item->result = *result;
  item->state = status ? status->state : STIC_CONNECTION_OPENING;
  if (status)
    item->counters = status->counters;
  else
    memset(&item->counters, 0, sizeof item->counters);
  stic_latest_publish(live->view);
  if (live->pictures) {
    live_picture *picture = stic_ring_slot(live->pictures);

    if (picture) {
      picture->made_ns = now_ns;
      picture->result = *result;
      stic_ring_put(live->pictures);
    } else {
      live->solver.unseen++;
    }
  }
}

static void overflow(stic_live *live)
{
  if (!live_flag(&live->stopping))
    live->solver.overflow = true;
  stic_live_stop(live);
}

/* Solves what `last` has become and hands it on; false: the run is over. */
static bool solve(stic_live *live)
{
  live_solver *s = &live->solver;
  stic_result result;
  int64_t begin_ns, end_ns, frame_ns;

  if (!wait_for_room(live)) {
    overflow(live);
    return false;
  }
  begin_ns = stic_clock_ns();
  stic_sim_step(s->sim, &s->last.sample, &result);
  stic_timing_add_step(&s->timing, s->sim);
  queue_row(live, &s->last.sample, &result);
  show(live, &result, begin_ns);
  end_ns = stic_clock_ns();
  frame_ns = s->last.read_ns + end_ns - begin_ns;
  stic_timing_add(&s->timing, STIC_STAGE_FRAME, frame_ns);
  if (frame_ns > STIC_FRAME_NS)
    stic_timing_list_miss(&s->timing, begin_ns - live->started_ns, frame_ns, "computing");
  s->rows++;
  s->end_ns = end_ns;
  return true;
}

static bool solve_sample(stic_live *live, const live_sample *sample)
{
  live_solver *s = &live->solver;
  const int64_t last_ns = s->last.sample.t_ns;

  s->last = *sample;
  /* It was measured some time before it arrived; a repeat in between has the later time. */
  if (s->begun && s->last.sample.t_ns <= last_ns)
    s->last.sample.t_ns = last_ns + 1;
  if (!s->begun)
    s->first_ns = sample->arrived_ns;
  s->begun = true;
  s->deadline_ns = sample->arrived_ns + STIC_FRAME_NS;
  if (!solve(live))
    return false;
  /* What came while the loop was still being made ready says nothing about the loop. */
  if (!s->own_time && sample->arrived_ns >= s->go_ns)
    stic_timing_add(&s->timing, STIC_STAGE_LATENCY, stic_clock_ns() - sample->zero_ns - sample->sample.t_ns);
  return true;
}

/* The last pose again, at the time of the deadline; those that passed meanwhile are not made up for, and the next
 * one is where it would have been without that. */
static bool repeat(stic_live *live, int64_t now_ns)
{
  live_solver *s = &live->solver;
  const int64_t passed = (now_ns - s->deadline_ns) / STIC_FRAME_NS;
  const int64_t at_ns = s->deadline_ns + passed * STIC_FRAME_NS - s->last.zero_ns;

  s->last.sample.t_ns = at_ns > s->last.sample.t_ns ? at_ns : s->last.sample.t_ns + 1;
  s->last.read_ns = 0;
  s->deadline_ns += (passed + 1) * STIC_FRAME_NS;
  s->repeated++;
  return solve(live);
}

static bool is_due(const live_solver *s, int64_t now_ns)
{
  return s->begun && !s->own_time && now_ns >= s->deadline_ns;
}

static void wait_for_turn(stic_live *live)
{
  live_solver *s = &live->solver;
  const int64_t until_ns = s->begun && !s->own_time ? s->deadline_ns : INT64_MAX;
  const int64_t asleep_ns = stic_clock_ns();
  const live_sample *sample;
  int64_t late_ns = -1, now_ns;

  stic_wake_wait(&live->to_solver, until_ns);
  now_ns = stic_clock_ns();
  sample = stic_ring_front(live->samples);
  if (sample && sample->arrived_ns > asleep_ns)
    late_ns = now_ns - sample->arrived_ns;
  else if (!sample && is_due(s, now_ns))
    late_ns = now_ns - until_ns;
  if (late_ns >= 0)
    stic_timing_add(&s->timing, STIC_STAGE_WAKEUP, late_ns);
  if (late_ns > STIC_FRAME_NS)
    stic_timing_list_miss(&s->timing, now_ns - live->started_ns, late_ns, "wakeup");
}

/* After a stop what was read is still solved, but nobody waits long for it. */
static bool is_over(const stic_live *live, int64_t *stop_ns)
{
  if (!live_flag(&live->stopping))
    return false;
  if (*stop_ns == 0)
    *stop_ns = stic_clock_ns();
  return stic_clock_ns() - *stop_ns > STIC_LIVE_DRAIN_NS;
}

static bool turn(stic_live *live)
{
  /* Asked before the queue: what the reader put before it ended is seen. */
  const bool reader_done = live_flag(&live->reader_done);
  const live_sample *sample = stic_ring_front(live->samples);
  int64_t now_ns;

  if (sample) {
    const bool solved = solve_sample(live, sample);

    if (solved)
      stic_ring_take(live->samples);
    return solved;
  }
  if (reader_done)
    return false;
  now_ns = stic_clock_ns();
  if (is_due(&live->solver, now_ns))
    return repeat(live, now_ns);
  wait_for_turn(live);
  return true;
}

void *stic_live_solver_main(void *context)
{
  stic_live *live = context;
  int64_t stop_ns = 0;

  live_await(&live->go);
  live->solver.go_ns = stic_clock_ns();
  while (!is_over(live, &stop_ns) && turn(live))
    ;
  live_raise(&live->solver_done);
  stic_wake_send(&live->to_caller);
  return NULL;
}

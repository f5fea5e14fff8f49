/* The threads behind the loop: rows to files, results to pictures. Both may be as slow as they like. */
#include <string.h>

#include "../error.h"
#include "parts.h"

#define ROWS_PER_FLUSH 64

/* Until there is something in the queue; false: nothing comes any more. */
static bool wait_for_item(const stic_live *live, stic_ring *ring)
{
  for (;;) {
    /* Asked before the queue: what the solver put before it ended is seen. */
    const bool solver_done = live_flag(&live->solver_done);

    if (stic_ring_front(ring))
      return true;
    if (solver_done)
      return false;
    stic_clock_sleep_until(stic_clock_ns() + STIC_LIVE_LOOK_NS);
  }
}

/* ---- rows ---------------------------------------------------------------------------------- */

static void gather(stic_live *live, const live_row *from)
{
  live_writer *w = &live->writer;

  w->row.sample = from->sample;
  w->row.solved_ns = from->solved_ns;
  memcpy(&w->row.result, from->result, sizeof from->result);
  w->row.events = w->gathered;
  w->row.event_count = from->event_count;
  for (int i = 0; i < from->event_count; i++) {
    memcpy(&w->gathered[i], stic_ring_front(live->events), sizeof w->gathered[i]);
    stic_ring_take(live->events);
  }
}

static stic_status write_next(stic_live *live)
{
  live_writer *w = &live->writer;
  const int64_t start_ns = stic_clock_ns();
  stic_status status;

  gather(live, stic_ring_front(live->rows));
  status = w->output.row(w->output.user, &w->row, &w->error);
  stic_ring_take(live->rows);
  stic_timing_add(&w->timing, STIC_STAGE_WRITE, stic_clock_ns() - start_ns);
  return status;
}

void *stic_live_writer_main(void *context)
{
  stic_live *live = context;
  live_writer *w = &live->writer;
  stic_status status = STIC_OK;

  while (status == STIC_OK && wait_for_item(live, live->rows)) {
    for (int i = 0; i < ROWS_PER_FLUSH && status == STIC_OK && stic_ring_front(live->rows); i++)
      status = write_next(live);
    if (status == STIC_OK)
      status = w->output.flush(w->output.user, &w->error);
  }
  if (status != STIC_OK)
    stic_live_stop(live);
  return NULL;
}

/* ---- pictures ------------------------------------------------------------------------------ */

static stic_status picture_all(stic_live *live)
{
  live_pictures *p = &live->picture_maker;
  stic_status status = STIC_OK;

  while (status == STIC_OK && wait_for_item(live, live->pictures)) {
    const live_picture *picture = stic_ring_front(live->pictures);
    const bool late = stic_clock_ns() - picture->made_ns > STIC_LIVE_PICTURE_LAG;

    status = p->calls.result(p->calls.user, &picture->result, late, &p->error);
    stic_ring_take(live->pictures);
  }
  return status == STIC_OK ? p->calls.finish(p->calls.user, &p->error) : status;
}

void *stic_live_pictures_main(void *context)
{
  stic_live *live = context;
  live_pictures *p = &live->picture_maker;
  stic_status status = p->calls.open(p->calls.user, &p->error);

  p->open_status = status;
  sem_post(&p->opened);
  if (status == STIC_OK)
    status = picture_all(live);
  if (status == STIC_OK)
    p->error.status = STIC_OK;
  p->calls.close(p->calls.user);
  return NULL;
}

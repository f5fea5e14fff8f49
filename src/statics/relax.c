/* RELAX: the one rule that defines the answer. The hand is held still; stages of HOLD and JUDGE follow
 * each other until the object rests (figures 4, 6 and 8 of the paper in one loop). */
#include "statics.h"

static void record(core *c, stic_event_kind kind, int vertex, int surface_index, vec where, real length)
{
  if (c->event_count >= c->event_capacity)
    return;
  double scale = kind == STIC_EVENT_SNAP ? 1 : c->unit;
  stic_event e = {c->event_time, kind, vertex, surface_index, 0, 0, (double)length * scale};
  world_place(c, where, &e.x, &e.y);
  c->events[c->event_count++] = e;
}

/* How much a gap's value may be rounding, at these coordinates. */
static real gap_noise(const core *c)
{
  real extent =
    c->body.world_extent + r_abs(c->p.x) + r_abs(c->p.y) + r_abs(c->hand.h.x) + r_abs(c->hand.h.y);
  return 2 * REAL_EPSILON * (extent + 2 * c->body.size) + 2 * c->body.start_depth;
}

static void relax(core *c, hand target, double t)
{
  c->hand = target;
  c->event_time = t;
  c->full = false;
  c->opened_any = false;
  c->turn_done = false;
  c->happened = false;
  c->sliding = false;
  c->slid_to_zero = false;
  c->longest_slide = 0;
  c->noise = gap_noise(c);
  c->report->relaxations++;
  int stage = 0;
  for (; stage < STAGES_MAX; stage++) {
    if (c->full)
      break;
    if (hold(c))
      continue;
    forget_opened_that_left(c);
    bool after_slide = c->slid_to_zero;
    c->slid_to_zero = false;
    verdict v = judge(c);
    if (v == VERDICT_REST) {
      c->sliding = after_slide && slides_on(c);
      c->sliding_sense = c->slide_sense;
      break;
    }
    if (v == VERDICT_STUCK) {
      c->report->flags |= STIC_FLAG_NO_ANSWER;
      break;
    }
  }
  if (stage == STAGES_MAX)
    c->report->flags |= STIC_FLAG_LIMIT;
  int stages = stage < STAGES_MAX ? stage + 1 : STAGES_MAX;
  c->stages += stages;
  if (stages > c->report->stages_worst)
    c->report->stages_worst = stages;
  forget_opened_that_left(c);
  if (c->longest_slide > 0) {
    c->report->flags |= STIC_FLAG_SLIPPED;
    c->report->slips++;
  }
}

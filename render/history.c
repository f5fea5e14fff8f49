#include "history.h"

#include <math.h>

/* The slot after the newest; the oldest gives way when all are taken. */
static int ring_push(int *first, int *count, int max)
{
  if (*count < max)
    return (*first + (*count)++) % max;
  *first = (*first + 1) % max;
  return (*first + max - 1) % max;
}

static void ring_pop(int *first, int *count, int max)
{
  *first = (*first + 1) % max;
  --*count;
}

const stic_trail_point *stic_history_trail(const stic_history *h, int i)
{
  return &h->trail[(h->trail_first + i) % STIC_TRAIL_MAX];
}

const stic_slip *stic_history_slip(const stic_history *h, int i)
{
  return &h->slips[(h->slip_first + i) % STIC_SLIPS_MAX];
}

const stic_curve_point *stic_history_curve(const stic_history *h, int i)
{
  return &h->curve[(h->curve_first + i) % STIC_CURVE_MAX];
}

static double seconds(const stic_result *r)
{
  return (double)r->t_ns * 1e-9;
}

static void add_trail(stic_history *h, const stic_result *r)
{
  stic_trail_point p = {seconds(r), {r->hand_x, r->hand_y, r->hand_z}, {r->holding_x, r->holding_y, r->z}};

  while (h->trail_count && stic_history_trail(h, 0)->t < p.t - STIC_TRAIL_SECONDS)
    ring_pop(&h->trail_first, &h->trail_count, STIC_TRAIL_MAX);
  if (h->trail_count) {
    const stic_trail_point *last = stic_history_trail(h, h->trail_count - 1);
    double moved = fmax(hypot(p.hand[0] - last->hand[0], p.hand[1] - last->hand[1]),
                        hypot(p.held[0] - last->held[0], p.held[1] - last->held[1]));

    if (moved < 0.012 * h->size && p.t - last->t < 0.25)
      return;
  }
  h->trail[ring_push(&h->trail_first, &h->trail_count, STIC_TRAIL_MAX)] = p;
}

static void add_slips(stic_history *h, const stic_result *r)
{
  const stic_result *last = &h->newest;

  for (int i = 0; i < r->contact_count; i++) {
    const stic_contact *now = &r->contacts[i];

    for (int k = 0; k < last->contact_count; k++) {
      const stic_contact *was = &last->contacts[k];

      if (was->vertex == now->vertex && was->surface == now->surface &&
          hypot(now->x - was->x, now->y - was->y) > 1e-9 * h->size)
        h->slips[ring_push(&h->slip_first, &h->slip_count, STIC_SLIPS_MAX)] =
          (stic_slip){seconds(r), now->vertex, now->surface, {was->x, was->y}, {now->x, now->y}, r->z};
    }
  }
}

static void add_curve(stic_history *h, const stic_result *r)
{
  stic_curve_point p = {.t = seconds(r),
                        .hand = {r->hand_x, r->hand_y, r->hand_theta},
                        .held = {r->holding_x, r->holding_y, r->theta},
                        .slipped = (r->flags & STIC_FLAG_SLIPPED) != 0};

  while (h->curve_count && stic_history_curve(h, 0)->t < p.t - STIC_CURVE_SECONDS)
    ring_pop(&h->curve_first, &h->curve_count, STIC_CURVE_MAX);
  /* Fast devices: no more points than the window can hold. Slips are always kept. */
  if (h->curve_count && !p.slipped &&
      p.t - stic_history_curve(h, h->curve_count - 1)->t < STIC_CURVE_SECONDS / (STIC_CURVE_MAX - 200))
    return;
  for (; p.contacts < r->contact_count && p.contacts < STIC_CURVE_CONTACTS; p.contacts++) {
    p.normal[p.contacts] = r->contacts[p.contacts].normal;
    p.friction[p.contacts] = r->contacts[p.contacts].friction;
  }
  h->curve[ring_push(&h->curve_first, &h->curve_count, STIC_CURVE_MAX)] = p;
}

void stic_history_add(stic_history *h, const stic_result *r)
{
  if (h->any)
    add_slips(h, r);
  add_trail(h, r);
  add_curve(h, r);
  h->newest = *r;
  h->any = true;
}

bool stic_history_slipping(const stic_history *h, int vertex, int surface)
{
  double now = seconds(&h->newest);

  for (int i = h->slip_count - 1; i >= 0; i--) {
    const stic_slip *s = stic_history_slip(h, i);

    if (s->t < now - STIC_SLIP_SHOWN_SECONDS)
      return false;
    if (s->vertex == vertex && s->surface == surface)
      return true;
  }
  return false;
}

/* A frame's result in SI units: pose, contact set by its name, forces, and how well they balance. */
#include "statics.h"

/* Section 3: which of the contact states this set is. */
static stic_state contact_state(const core *c)
{
  int n = c->contact_count;
  if (n == 0)
    return STIC_FREE;
  if (n == 1)
    return STIC_VERTEX;
  if (n == 2) {
    const contact *a = &c->contacts[0], *b = &c->contacts[1];
    if (a->vertex == b->vertex)
      return STIC_CORNER;
    return a->surface == b->surface ? STIC_EDGE : STIC_TWO_VERTEX;
  }
  return STIC_MULTI;
}

/* Indices of the contacts by vertex, then surface. */
static void sort_contacts(const core *c, int *order)
{
  for (int i = 0; i < c->contact_count; i++) {
    int at = i;
    const contact *k = &c->contacts[i];
    for (; at > 0; at--) {
      const contact *before = &c->contacts[order[at - 1]];
      if (before->vertex < k->vertex || (before->vertex == k->vertex && before->surface < k->surface))
        break;
      order[at] = order[at - 1];
    }
    order[at] = i;
  }
}

/* Of eqs (1) and (2), relative to the largest term. */
static double balance_residual(const core *c, const vec *forces)
{
  vec about = c->contact_count ? c->contacts[0].place : holding_point(c);
  wrench load = load_about(c, about);
  vec sum = load.f;
  real moment = load.m;
  real largest = r_max(v_length(load.f), r_abs(c->body.kappa * (c->hand.phi - c->theta)) / c->body.size);
  largest = r_max(largest, r_abs(load.m) / c->body.size);
  for (int i = 0; i < c->contact_count; i++) {
    sum = v_add(sum, forces[i]);
    moment += v_cross(v_sub(c->contacts[i].place, about), forces[i]);
    largest = r_max(largest, v_length(forces[i]));
  }
  if (largest < c->body.size)
    largest = c->body.size; /* small loads: to k_p size */
  if (c->contact_count == 0 && c->body.kappa == 0)
    moment = 0;
  double residual = (double)(r_max(v_length(sum), r_abs(moment) / c->body.size) / largest);
  return residual < 1 ? residual : 1; /* also where single precision overflows: no answer then */
}

static void core_result(void *memory, stic_hand h, bool held, stic_result *r)
{
  core *c = memory;
  int order[CONTACTS_MAX];
  c->hand = hand_in(c, h);
  r->state = held ? contact_state(c) : STIC_RELEASED;
  world_place(c, c->p, &r->x, &r->y);
  r->theta = (double)c->theta;
  r->holding_x = h.x, r->holding_y = h.y;
  r->force_x = r->force_y = r->moment = r->residual = 0;
  if (held) {
    vec f = spring_force(c);
    world_place(c, holding_point(c), &r->holding_x, &r->holding_y);
    r->force_x = (double)f.x * c->force_unit;
    r->force_y = (double)f.y * c->force_unit;
    r->moment = (double)spring_moment(c) * c->force_unit * c->unit;
    r->residual = balance_residual(c, c->forces);
    if (is_wedged(c))
      r->flags |= STIC_FLAG_WEDGED;
  }
  r->contact_count = c->contact_count;
  sort_contacts(c, order);
  for (int i = 0; i < c->contact_count; i++) {
    const contact *k = &c->contacts[order[i]];
    const surface *s = &c->body.surfaces[k->surface];
    stic_contact *to = &r->contacts[i];
    to->vertex = k->vertex;
    to->surface = k->surface;
    world_place(c, k->place, &to->x, &to->y);
    to->normal = held ? (double)r_max(0, v_dot(c->forces[order[i]], s->n)) * c->force_unit : 0;
    to->friction = held ? (double)v_dot(c->forces[order[i]], s->t) * c->force_unit : 0;
  }
}

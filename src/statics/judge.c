/* JUDGE: does the object rest, and if not, what happens next? Each question that sections 3 and 5 of the
 * paper ask in words has its function here; the order is RELAX's. */
#include "statics.h"

enum { CHOICES_MAX = 4096 };

/* 5.1: "If they suffice the equation (5), the configuration is physically stable" - here for every set. */
static bool is_stable(core *c)
{
  return loads_balance(c);
}

/* 5.1: "the sign of the surface normal force; if it is negative, ... the non-contact state". */
static bool single_contact_pulls(const core *c)
{
  return v_dot(spring_force(c), c->body.surfaces[c->contacts[0].surface].n) >= 0;
}

/* Does a gap with this rate and second derivative start to grow? */
static bool starts_to_grow(real rate, real second, real scale)
{
  real still = 64 * REAL_EPSILON * scale;
  return rate > still || (rate >= -still && second > still);
}

/* Gap of an opened contact while the rest turns about `pivot`, whose own place moves with velocity and
 * acceleration (both zero for a stuck vertex). */
static bool gap_grows_in_turn(const core *c, const contact *o, vec pivot, real dir, vec velocity,
                              vec acceleration)
{
  vec n = c->body.surfaces[o->surface].n, e = v_sub(o->place, pivot);
  real rate = v_dot(n, v_add(velocity, turn_of(e, dir))), second = v_dot(n, v_sub(acceleration, e));
  return starts_to_grow(rate, second, c->body.size + v_length(velocity));
}

/* A choice of rule 3: which contacts open. */
typedef struct choice {
  int open[CONTACTS_MAX], open_count; /* indices into the contacts, ascending */
  int rest[CONTACTS_MAX], rest_count;
} choice;

static void open_contacts(core *c, const choice *o)
{
  for (int i = o->open_count - 1; i >= 0; i--)
    remove_contact(c, o->open[i]);
}

static bool all_grow_in_turn(const core *c, const choice *o, vec pivot, real dir, vec velocity,
                             vec acceleration)
{
  for (int i = 0; i < o->open_count; i++)
    if (!gap_grows_in_turn(c, &c->contacts[o->open[i]], pivot, dir, velocity, acceleration))
      return false;
  return true;
}

/* 5.2, 5.3: "if the surface normal forces are negative again, the current state goes to the non-contact". */
static bool becomes_free(core *c, const choice *o)
{
  vec force = spring_force(c);
  vec none = v_make(0, 0);
  if (v_length(force) > TOLERANCE * c->body.size) {
    for (int i = 0; i < o->open_count; i++) {
      real rate = v_dot(c->body.surfaces[c->contacts[o->open[i]].surface].n, force);
      if (!starts_to_grow(rate, 0, v_length(force)))
        return false;
    }
  } else {
    real moment = spring_moment(c);
    if (is_balanced(c, moment))
      return false;
    if (!all_grow_in_turn(c, o, holding_point(c), r_sign(moment), none, none))
      return false;
  }
  c->report->decisions |= STIC_DECISION_OPEN_ALL;
  open_contacts(c, o);
  return true;
}

/* 5.2, 5.3: "the object rotates at the other vertex and the current status goes to the single vertex
 * contact". The turn itself is the next HOLD. */
static bool turns_about_rest(core *c, const choice *o)
{
  vec pivot = c->contacts[o->rest[0]].place, none = v_make(0, 0);
  real moment = spring_moment_about(c, pivot);
  if (is_balanced(c, moment))
    return false;
  if (!all_grow_in_turn(c, o, pivot, r_sign(moment), none, none))
    return false;
  c->report->decisions |= STIC_DECISION_OPEN_TURN;
  open_contacts(c, o);
  return true;
}

/* The one contact left slides while the others part, by the slide or by the turn that follows it. */
static bool slides_on_rest(core *c, const choice *o)
{
  const contact *k = &c->contacts[o->rest[0]];
  const surface *s = &c->body.surfaces[k->surface];
  vec force = spring_force(c);
  real normal = -v_dot(force, s->n), tangential = v_dot(force, s->t);
  /* A slide that was stopped on its way is at mu_d N but for rounding: nothing drives it. */
  real above = balance_slack(c);
  if (normal <= above || r_abs(tangential) <= s->mu_d * normal + above)
    return false;
  real sigma = slip_sense(c, s), shift = tangential - sigma * s->mu_d * normal;
  vec arm = v_sub(holding_point(c), k->place);
  real moment = spring_moment_about(c, k->place) - shift * v_cross(arm, s->t);
  path f = path_sliding(c, k->vertex, k->place, s->t, s->n, sigma * s->mu_d, r_sign(moment));
  vec velocity = v_scale(s->t, f.xi_s), acceleration = v_scale(s->t, -f.xi_c);
  for (int i = 0; i < o->open_count; i++) {
    const contact *other = &c->contacts[o->open[i]];
    real rate = sigma * v_dot(c->body.surfaces[other->surface].n, s->t);
    if (starts_to_grow(rate, 0, 1))
      continue;
    if (starts_to_grow(-rate, 0, 1))
      return false;
    if (is_balanced(c, moment) || !gap_grows_in_turn(c, other, k->place, f.dir, velocity, acceleration))
      return false;
  }
  int vertex = k->vertex, on = k->surface;
  c->report->decisions |= STIC_DECISION_OPEN_SLIDE;
  open_contacts(c, o);
  for (int i = 0; i < c->contact_count; i++)
    if (c->contacts[i].vertex == vertex && c->contacts[i].surface == on)
      slide_vertex(c, i);
  return true;
}

/* The pair that is left slides as it would alone. */
static bool rest_slides_as_pair(core *c, const choice *o)
{
  int first = o->rest[0], second = o->rest[1];
  if (are_parallel(c, first, second)) {
    real sense;
    vec velocity;
    if (!edge_or_slot_starts(c, first, second, &sense, &velocity))
      return false;
    for (int i = 0; i < o->open_count; i++)
      if (!starts_to_grow(v_dot(c->body.surfaces[c->contacts[o->open[i]].surface].n, velocity), 0, 1))
        return false;
    open_contacts(c, o);
    slide_edge_or_slot(c, 0, 1, sense);
  } else {
    real dir;
    if (!trammel_starts(c, first, second, &dir))
      return false;
    trammel m = trammel_path(c, first, second, dir);
    vec velocity = v_scale(m.path.t, m.path.xi_s), acceleration = v_scale(m.path.t, -m.path.xi_c);
    if (!all_grow_in_turn(c, o, c->contacts[first].place, dir, velocity, acceleration))
      return false;
    open_contacts(c, o);
    slide_trammel(c, 0, 1, dir);
  }
  c->report->decisions |= STIC_DECISION_OPEN_PAIR;
  return true;
}

static bool rest_at_one_vertex(const core *c, const choice *o)
{
  for (int i = 1; i < o->rest_count; i++)
    if (c->contacts[o->rest[i]].vertex != c->contacts[o->rest[0]].vertex)
      return false;
  return true;
}

/* Is this choice of rule 3 possible? If so it is done. */
static bool try_choice(core *c, const choice *o)
{
  if (o->rest_count == 0)
    return becomes_free(c, o);
  if (rest_at_one_vertex(c, o)) {
    if (turns_about_rest(c, o))
      return true;
    return o->rest_count == 1 && slides_on_rest(c, o);
  }
  return o->rest_count == 2 && rest_slides_as_pair(c, o);
}

/* Rule 3: opens one contact, in the order in which they touched, then pairs, and so on. */
static bool open_some(core *c)
{
  int n = c->contact_count, tried = 0;
  for (int size = 1; size <= n; size++) {
    int pick[CONTACTS_MAX];
    for (int i = 0; i < size; i++)
      pick[i] = i;
    for (;;) {
      choice o = {.open_count = size};
      for (int i = 0, k = 0; i < n; i++) {
        if (k < size && pick[k] == i)
          o.open[k++] = i;
        else
          o.rest[o.rest_count++] = i;
      }
      if (try_choice(c, &o))
        return true;
      if (++tried == CHOICES_MAX)
        return false;
      int k = size - 1; /* the next combination, in lexicographic order */
      while (k >= 0 && pick[k] == n - size + k)
        k--;
      if (k < 0)
        break;
      pick[k]++;
      for (int i = k + 1; i < size; i++)
        pick[i] = pick[i - 1] + 1;
    }
  }
  return false;
}

/* Rule 2: two contacts at different vertices slide together. */
static bool slide_together(core *c)
{
  if (c->contact_count != 2 || all_at_one_vertex(c))
    return false;
  if (are_parallel(c, 0, 1)) {
    real sense;
    vec velocity;
    if (!edge_or_slot_starts(c, 0, 1, &sense, &velocity))
      return false;
    c->report->decisions |= STIC_DECISION_SLIDE_EDGE;
    slide_edge_or_slot(c, 0, 1, sense);
  } else {
    real dir;
    if (!trammel_starts(c, 0, 1, &dir))
      return false;
    c->report->decisions |= STIC_DECISION_SLIDE_TRAMMEL;
    slide_trammel(c, 0, 1, dir);
  }
  return true;
}

static verdict judge(core *c)
{
  if (is_stable(c)) {
    c->report->decisions |= STIC_DECISION_REST;
    return VERDICT_REST;
  }
  if (c->contact_count == 1) {
    if (single_contact_pulls(c)) {
      c->report->decisions |= STIC_DECISION_OPEN_SINGLE;
      remove_contact(c, 0);
    } else {
      c->report->decisions |= STIC_DECISION_SLIDE_SINGLE;
      slide_vertex(c, 0);
    }
    return VERDICT_ACTED;
  }
  if (slide_together(c) || open_some(c))
    return VERDICT_ACTED;
  c->report->decisions |= STIC_DECISION_FLOW;
  return viscous_flow(c) ? VERDICT_ACTED : VERDICT_STUCK;
}

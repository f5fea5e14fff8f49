/* Is what the sample's last RELAX left an answer? Its row must keep the model's invariants within their rounding. Where
 * RELAX had to stop at a bound (LIMIT), its last pose stands: the object is on its way, the next sample goes on from
 * there. Where it found no rest, or its precision lost it, the object is put back to where it was before the sample. */
#include "statics.h"

/* What is put back. */
typedef struct last_pose {
  double origin[2]; /* of the places here */
  vec p, rot;
  real theta;
  int contact_count, opened_count;
  contact contacts[CONTACTS_MAX];
  pair opened[PAIRS_MAX];
} last_pose;

static void keep(const core *c, last_pose *k)
{
  memcpy(k->origin, c->origin, sizeof k->origin);
  k->p = c->p, k->rot = c->rot, k->theta = c->theta;
  k->contact_count = c->contact_count, k->opened_count = c->opened_count;
  memcpy(k->contacts, c->contacts, (size_t)c->contact_count * sizeof k->contacts[0]);
  memcpy(k->opened, c->opened, (size_t)c->opened_count * sizeof k->opened[0]);
}

static void put_back(core *c, const last_pose *k)
{
  if (k->origin[0] != c->origin[0] || k->origin[1] != c->origin[1])
    set_origin(c, k->origin);
  c->p = k->p, c->rot = k->rot, c->theta = k->theta;
  c->contact_count = k->contact_count, c->opened_count = k->opened_count;
  memcpy(c->contacts, k->contacts, (size_t)k->contact_count * sizeof k->contacts[0]);
  memcpy(c->opened, k->opened, (size_t)k->opened_count * sizeof k->opened[0]);
  c->balance.known = c->near.valid = false;
  c->window_open = c->sliding = false;
}

/* 4 ulp of the largest coordinate, less one for the rounding of what is judged here; the angle rounds too. */
static real coordinates_round(const core *c)
{
  real far = r_abs(c->p.x) + r_abs(c->p.y) + r_abs(c->hand.h.x) + r_abs(c->hand.h.y) +
             c->body.size * (1 + r_abs(c->theta));
  return 3 * REAL_EPSILON * r_max(far, c->body.world_extent) + 2 * c->body.start_depth;
}

/* Invariant 1, and the contacts at their anchors. False for what is not finite. */
static bool is_in_place(core *c, real allowed)
{
  if (!(r_abs(c->p.x) + r_abs(c->p.y) + r_abs(c->theta) < R_HUGE))
    return false;
  near_update(c, 0);
  for (int i = 0; i < c->near.count; i++)
    for (int v = 0; v < c->body.vertex_count; v++)
      if ((c->near.vertices[i] >> v & 1) && !(gap_of(c, world_vertex(c, v), c->near.surfaces[i]) >= -allowed))
        return false;
  for (int i = 0; i < c->contact_count; i++)
    if (!(v_length(v_sub(world_vertex(c, c->contacts[i].vertex), c->contacts[i].place)) <= allowed))
      return false;
  return true;
}

/* Invariants 2 and 3: c->forces are inside the cones; do they balance the load? */
static bool forces_balance(const core *c, real rounding)
{
  vec about = holding_point(c), sum = spring_force(c);
  real moment = spring_moment(c), size = c->body.size, reach = size;
  real largest = r_max(size, r_max(v_length(sum), r_abs(moment) / size));
  for (int i = 0; i < c->contact_count; i++) {
    vec arm = v_sub(c->contacts[i].place, about);
    sum = v_add(sum, c->forces[i]);
    moment += v_cross(arm, c->forces[i]);
    largest = r_max(largest, v_length(c->forces[i]));
    reach = r_max(reach, v_length(arm));
  }
  real allowed = 4096 * REAL_EPSILON * largest + rounding + R(1e-12) * size;
  real turning = c->body.kappa * 8 * REAL_EPSILON * (r_abs(c->theta) + r_abs(c->hand.phi));
  if (c->contact_count == 0 && c->body.kappa == 0)
    moment = 0;
  return largest < R_HUGE && v_length(sum) <= allowed &&
         r_abs(moment) / reach <= allowed + largest * rounding / size + turning / size;
}

/* Ends a sample with the hand at `target`: the forces that are shown, and NO_ANSWER with the object left where it was
 * `before` if they are none. */
static void answer(core *c, hand target, const last_pose *before)
{
  c->hand = target;
  real rounding = coordinates_round(c);
  bool good = is_in_place(c, 4096 * REAL_EPSILON * c->body.size + rounding + R(1e-12) * c->body.size);
  if (good) {
    least_norm_forces(c, c->forces);
    good = (c->report->flags & STIC_FLAG_LIMIT) || forces_balance(c, rounding);
  }
  c->report->flags &= ~(unsigned)STIC_FLAG_NO_ANSWER;
  if (good)
    return;
  c->report->flags |= STIC_FLAG_NO_ANSWER;
  put_back(c, before);
  least_norm_forces(c, c->forces);
}

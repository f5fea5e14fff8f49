/* HOLD: contacts stay where they are, whatever force that takes, and the object goes where the hand
 * leads it ("the configuration of the object is calculated ... under the condition that the vertex is
 * fixed on a surface", 5.1). */
#include "statics.h"

/* Puts the holding point at g with the present angle. */
static void place_holding_point(core *c, vec g)
{
  c->p = v_sub(g, rotate(c->rot, c->b));
}

/* Straight and evenly; true if a touch stopped it on the way. */
static bool move_free(core *c, vec travel, real turn)
{
  touch t = first_touch_moving(c, travel, turn);
  vec g = holding_point(c);
  real part = t.at < R_HUGE ? t.at : 1;
  if (turn != 0)
    set_angle(c, part < 1 ? c->theta + part * turn : c->hand.phi);
  place_holding_point(c, part < 1 ? v_mix(g, part, travel) : v_add(g, travel));
  if (t.at < R_HUGE) {
    /* On a very long way the place of the touch has the rounding of its far end: take that off. */
    real gap = gap_of(c, world_vertex(c, t.vertex), t.surface);
    if (r_abs(gap) > rounding_here(c))
      c->p = v_mix(c->p, -gap, c->body.surfaces[t.surface].n);
    add_contact(c, t.vertex, t.surface);
  }
  return t.at < R_HUGE;
}

/* Free, 3 a): to the hand. After an opening in this RELAX the object first comes, then turns. */
static bool go_to_hand(core *c)
{
  vec travel = spring_force(c);
  real turn = c->body.kappa > 0 ? c->hand.phi - c->theta : 0;
  if (travel.x == 0 && travel.y == 0 && turn == 0)
    return false;
  if (!c->opened_any) {
    if (move_free(c, travel, turn))
      return true;
  } else {
    if (move_free(c, travel, 0))
      return true;
    if (turn != 0 && move_free(c, v_make(0, 0), turn))
      return true;
  }
  place_holding_point(c, c->hand.h); /* exactly, not up to rounding */
  return false;
}

/* 5.1: turns about the stuck vertex the way the moment points, to its first zero. */
static bool turn_about(core *c, int vertex, vec place)
{
  real moment = spring_moment_about(c, place);
  if (is_balanced(c, moment))
    return false;
  path f = path_pinned(c, vertex, place, r_sign(moment));
  real x;
  bool zero = curve_first_zero(&f.drive, 2 * R_PI, &x, &c->report->iterations);
  touch t = path_first_touch(c, &f, x);
  if (!zero && t.at == R_HUGE)
    c->report->flags |= STIC_FLAG_LIMIT;
  if (t.at < R_HUGE)
    x = t.at;
  path_set_pose(c, &f, x);
  if (t.at < R_HUGE)
    add_contact(c, t.vertex, t.surface);
  return t.at < R_HUGE;
}

/* True if another vertex reached a surface on the way. */
static bool hold(core *c)
{
  bool skip_turn = c->turn_done;
  c->turn_done = false;
  if (c->contact_count == 0)
    return go_to_hand(c);
  if (skip_turn || !all_at_one_vertex(c))
    return false;
  return turn_about(c, c->contacts[0].vertex, c->contacts[0].place);
}

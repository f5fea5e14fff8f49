/* Where the core counts places from: near the object, so that a scene far from the world's origin costs no digits. Only
 * a free object changes it (nothing that sticks can move by that): when it has been carried away, and before it goes a
 * long way in one step, as otherwise the rounding of the way's length would be that of where it comes to rest. */
#include "statics.h"

/* In scaled lengths. */
enum {
  ORIGIN_GRID = 16, /* 0 is the origin of what starts within half of that */
  FAR_AWAY = 64,    /* from the origin */
  LONG_WAY = 128,
  SHORT_WAY = 32,
  STRETCHES_MAX = 64
};

static vec local_place(const core *c, double x, double y)
{
  return v_make((real)((wide)(x / c->unit) - c->origin[0]), (real)((wide)(y / c->unit) - c->origin[1]));
}

static void world_place(const core *c, vec place, double *x, double *y)
{
  *x = (double)((wide)place.x + c->origin[0]) * c->unit;
  *y = (double)((wide)place.y + c->origin[1]) * c->unit;
}

/* A point of the surface. One that is given far away is exchanged for the foot of the origin: its way along the surface
 * would cost digits. In long double, as there the products cancel. */
static vec surface_point(const core *c, const double given[2], const double n[2])
{
  const long double x = (long double)(given[0] / c->unit) - c->origin[0],
                    y = (long double)(given[1] / c->unit) - c->origin[1];
  if (fabsl(x) <= ORIGIN_GRID && fabsl(y) <= ORIGIN_GRID)
    return v_make((real)x, (real)y);
  const long double off = (x * n[0] + y * n[1]) / ((long double)n[0] * n[0] + (long double)n[1] * n[1]);
  return v_make((real)(off * n[0]), (real)(off * n[1]));
}

/* The surfaces follow; the pose is the caller's. */
static void set_origin(core *c, const double origin[2])
{
  body *b = &c->body;
  memcpy(c->origin, origin, sizeof c->origin);
  c->near.valid = false;
  b->world_extent = 0;
  for (int i = 0; i < b->surface_count; i++) {
    const stic_surface *from = &c->scene->surfaces[i];
    double n[2];
    stic_normal_from_degrees(from->normal_deg, n);
    b->surfaces[i].point = surface_point(c, from->point, n);
    /* One farther off has no noise but that of a vertex that is there. */
    real extent = r_abs(b->surfaces[i].point.x) + r_abs(b->surfaces[i].point.y);
    if (extent <= 2 * ORIGIN_GRID)
      b->world_extent = r_max(b->world_extent, extent);
  }
}

/* At the multiple of the grid next to a place in scaled lengths; halves away from zero, so that mirrored scenes stay
 * mirrored. */
static void set_origin_near(core *c, double x, double y)
{
  const double origin[2] = {round(x / ORIGIN_GRID) * ORIGIN_GRID, round(y / ORIGIN_GRID) * ORIGIN_GRID};
  set_origin(c, origin);
}

/* How deep the object is in a surface, as far as rounding here does not explain it; 0: it is not. */
static real depth_now(core *c)
{
  real deepest = 0;
  c->hand.h = c->p;
  for (int i = 0; i < c->parts.surface_count; i++)
    for (int v = 0; v < c->body.vertex_count; v++)
      deepest = r_max(deepest, -gap_of(c, world_vertex(c, v), c->parts.surfaces[i]));
  return deepest > TOLERANCE * c->body.size + gap_noise(c) ? deepest : 0;
}

/* Carried far away: counts from where the object is. That is exact. A vertex may hover so low that the surfaces'
 * rounding where they were counted from hid that it is too low: then later. */
static void come_along(core *c)
{
  if (c->contact_count > 0 || r_max(r_abs(c->p.x), r_abs(c->p.y)) <= FAR_AWAY)
    return;
  const double old[2] = {c->origin[0], c->origin[1]};
  const vec p = c->p;
  set_origin_near(c, (double)p.x + old[0], (double)p.y + old[1]);
  c->p = v_make((real)(p.x - (wide)(c->origin[0] - old[0])), (real)(p.y - (wide)(c->origin[1] - old[1])));
  if (depth_now(c) > 0) {
    set_origin(c, old);
    c->p = p;
  }
}

/* A stretch of a long free way: to shortly before its end or the first touch, so that the rounding of its length is small
 * beside what is left. Returns the part gone, 0 for none, and `from` becomes where the hand is then. */
static double skip_stretch(core *c, stic_hand *from, stic_hand to)
{
  const double way[2] = {to.x - from->x, to.y - from->y}, length = hypot(way[0], way[1]) / c->unit;
  if (!(length > LONG_WAY))
    return 0;
  const double old[2] = {c->origin[0], c->origin[1]};
  const vec p = c->p, travel = v_sub(local_place(c, to.x, to.y), holding_point(c));
  const real theta = c->theta, turn = c->body.kappa > 0 ? (real)to.phi - theta : 0;
  c->hand.h = c->p;
  c->noise = gap_noise(c);
  const double open = fmin(1, (double)first_touch_moving(c, travel, turn).at) * length,
               part = (open - fmax(SHORT_WAY, 32 * (double)REAL_EPSILON * open)) / length;
  if (!(part * length > SHORT_WAY))
    return 0;
  const stic_hand at = {from->x + part * way[0], from->y + part * way[1],
                        from->phi + part * (to.phi - from->phi)};
  set_origin_near(c, at.x / c->unit, at.y / c->unit);
  set_angle(c, theta + (real)part * turn);
  place_holding_point(c, local_place(c, at.x, at.y));
  if (depth_now(c) > 0) { /* rounding hid it */
    set_origin(c, old);
    set_angle(c, theta);
    c->p = p;
    return 0;
  }
  *from = at;
  return part;
}

/* The long part of a free way to the hand. Returns what of it is done; `from` is left alone if that is 0. */
static double skip_way(core *c, stic_hand *from, stic_hand to)
{
  if (c->contact_count > 0)
    return 0;
  stic_hand at = *from;
  double done = 0, part = 1;
  world_place(c, holding_point(c), &at.x, &at.y);
  for (int i = 0; i < STRETCHES_MAX && part > 0; i++) {
    part = skip_stretch(c, &at, to);
    done += (1 - done) * part;
  }
  if (done > 0)
    *from = at;
  return done;
}

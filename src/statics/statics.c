/* The statics core as one compilation per precision (STIC_REAL_BITS), and its table of functions. */
#include "statics.h"

#include <assert.h>
#include <string.h>

#include "spring.c"
#include "curve.c"
#include "linear.c"
#include "touch.c"
#include "path.c"
#include "cone.c"
#include "hold.c"
#include "slide.c"
#include "flow.c"
#include "judge.c"
#include "relax.c"
#include "slide_on.c"
#include "follow.c"
#include "answer.c"
#include "row.c"

static vec local_place(const core *c, double x, double y)
{
  return v_make((real)((wide)(x / c->unit) - c->origin[0]), (real)((wide)(y / c->unit) - c->origin[1]));
}

static void world_place(const core *c, vec place, double *x, double *y)
{
  *x = (double)((wide)place.x + c->origin[0]) * c->unit;
  *y = (double)((wide)place.y + c->origin[1]) * c->unit;
}

static hand hand_in(const core *c, stic_hand h)
{
  hand r = {local_place(c, h.x, h.y), (real)h.phi};
  return r;
}

static size_t core_memory_size(void)
{
  return sizeof(core);
}

/* A power of two not below the size: scaling by it is exact. */
static double length_unit(double size)
{
  int exponent;
  frexp(size, &exponent);
  return ldexp(1, exponent);
}

/* Nearest multiple of the grid; halves away from zero, so that mirrored scenes stay mirrored. */
static double grid_origin(double place)
{
  return round(place / ORIGIN_GRID) * ORIGIN_GRID;
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

static void init_surfaces(core *c, const stic_scene *scene)
{
  body *b = &c->body;
  b->surface_count = scene->surface_count;
  for (int i = 0; i < b->surface_count; i++) {
    const stic_surface *from = &scene->surfaces[i];
    surface *to = &b->surfaces[i];
    double normal[2];
    stic_normal_from_degrees(from->normal_deg, normal);
    to->n = v_make((real)normal[0], (real)normal[1]);
    to->t = v_make(to->n.y, -to->n.x);
    to->point = surface_point(c, from->point, normal);
    to->mu_s = (real)from->friction.mu_static;
    to->mu_d = (real)from->friction.mu_dynamic;
    /* One farther off has no noise but that of a vertex that is there. */
    real extent = r_abs(to->point.x) + r_abs(to->point.y);
    if (extent <= 2 * ORIGIN_GRID)
      b->world_extent = r_max(b->world_extent, extent);
  }
}

/* A scene may start in a surface by the rounding of its coordinates, which may be more than that of places here. */
static void allow_start_depth(core *c)
{
  real deepest = 0;
  for (int i = 0; i < c->parts.surface_count; i++)
    for (int v = 0; v < c->body.vertex_count; v++)
      deepest = r_max(deepest, -gap_of(c, world_vertex(c, v), c->parts.surfaces[i]));
  c->body.start_depth = deepest > TOLERANCE * c->body.size + gap_noise(c) ? deepest : 0;
}

static void core_init(void *memory, const stic_scene *scene, const stic_settings *settings,
                      const stic_parts *parts, stic_collider *collider, stic_event *events,
                      int event_capacity)
{
  core *c = memory;
  memset(c, 0, sizeof *c);
  double size = stic_scene_size(scene);
  c->settings = *settings;
  c->unit = length_unit(size);
  c->force_unit = scene->stiffness * c->unit;
  c->parts = *parts;
  c->collider = collider;
  c->events = events;
  c->event_capacity = event_capacity;
  body *b = &c->body;
  b->vertex_count = scene->vertex_count;
  for (int i = 0; i < b->vertex_count; i++) {
    b->vertices[i] = v_make((real)(scene->vertices[i][0] / c->unit), (real)(scene->vertices[i][1] / c->unit));
    b->radius = r_max(b->radius, v_length(b->vertices[i]));
  }
  b->size = (real)(size / c->unit);
  b->kappa = (real)(scene->rotational_stiffness / scene->stiffness / c->unit / c->unit);
  c->origin[0] = grid_origin(scene->x / c->unit);
  c->origin[1] = grid_origin(scene->y / c->unit);
  init_surfaces(c, scene);
  c->p = local_place(c, scene->x, scene->y);
  set_angle(c, (real)scene->angle);
  c->b = v_make((real)(scene->holding_point[0] / c->unit), (real)(scene->holding_point[1] / c->unit));
  /* What starts within tolerance of a surface starts in contact, stuck. */
  stic_core_report report = {0};
  c->report = &report;
  c->hand.h = c->p;
  allow_start_depth(c);
  c->noise = gap_noise(c);
  add_touching(c);
  c->report = NULL;
  c->event_count = 0;
}

static void core_take(void *memory, double body_x, double body_y)
{
  core *c = memory;
  c->b = v_make((real)(body_x / c->unit), (real)(body_y / c->unit));
  c->window_open = false;
  c->sliding = false;
}

static void core_relax(void *memory, stic_hand h, double t, stic_core_report *report)
{
  core *c = memory;
  c->report = report;
  c->flow_steps = c->flow_solves = c->stages = 0;
  c->sliding = false;
  last_pose before;
  keep(c, &before);
  relax(c, hand_in(c, h), t);
  c->window_open = c->happened;
  answer(c, c->hand, &before);
}

static void core_follow(void *memory, stic_hand from, stic_hand to, double t_from, double t_to,
                        stic_core_report *report)
{
  core *c = memory;
  c->report = report;
  c->flow_steps = c->flow_solves = c->stages = 0;
  hand a = hand_in(c, from), b = hand_in(c, to);
  last_pose before;
  keep(c, &before);
  switch (c->settings.level) {
  case STIC_LEVEL_FRAME: relax(c, b, t_to); break;
  case STIC_LEVEL_SUBSTEP: follow_substeps(c, a, b, t_from, t_to); break;
  case STIC_LEVEL_EVENT: follow_event(c, a, b, t_from, t_to); break;
  }
  answer(c, b, &before);
}

static void core_offset(const void *memory, double x, double y, double *dx, double *dy, double *theta)
{
  const core *c = memory;
  *dx = (x / c->unit - c->origin[0] - (double)c->p.x) * c->unit;
  *dy = (y / c->unit - c->origin[1] - (double)c->p.y) * c->unit;
  *theta = (double)c->theta;
}

static int core_event_count(const void *memory)
{
  return ((const core *)memory)->event_count;
}
static void core_clear_events(void *memory)
{
  ((core *)memory)->event_count = 0;
}

static void core_add_event(void *memory, stic_event event)
{
  core *c = memory;
  if (c->event_count < c->event_capacity)
    c->events[c->event_count++] = event;
}

const stic_core STIC_CORE = {
  .memory_size = core_memory_size,
  .init = core_init,
  .take = core_take,
  .relax = core_relax,
  .follow = core_follow,
  .result = core_result,
  .offset = core_offset,
  .event_count = core_event_count,
  .clear_events = core_clear_events,
  .add_event = core_add_event,
};

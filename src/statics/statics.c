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
#include "origin.c"
#include "slide.c"
#include "flow.c"
#include "judge.c"
#include "relax.c"
#include "slide_on.c"
#include "follow.c"
#include "answer.c"
#include "row.c"

static hand hand_in(const core *c, stic_hand h)
{
  hand r = {v_add(local_place(c, h.x, h.y), c->grip.h), (real)h.phi + c->grip.phi};
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

/* But their points: set_origin(). */
static void init_surfaces(body *b, const stic_scene *scene)
{
  b->surface_count = scene->surface_count;
  for (int i = 0; i < b->surface_count; i++) {
    const stic_surface *from = &scene->surfaces[i];
    surface *to = &b->surfaces[i];
    double normal[2];
    stic_normal_from_degrees(from->normal_deg, normal);
    to->n = v_make((real)normal[0], (real)normal[1]);
    to->t = v_make(to->n.y, -to->n.x);
    to->mu_s = (real)from->friction.mu_static;
    to->mu_d = (real)from->friction.mu_dynamic;
  }
}

static void core_init(void *memory, const stic_scene *scene, const stic_settings *settings,
                      const stic_parts *parts, stic_collider *collider, stic_event *events,
                      int event_capacity)
{
  core *c = memory;
  memset(c, 0, sizeof *c);
  double size = stic_scene_size(scene);
  c->scene = scene;
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
  init_surfaces(b, scene);
  set_origin_near(c, scene->x / c->unit, scene->y / c->unit);
  c->p = local_place(c, scene->x, scene->y);
  set_angle(c, (real)scene->angle);
  c->b = v_make((real)(scene->holding_point[0] / c->unit), (real)(scene->holding_point[1] / c->unit));
  /* What starts within tolerance of a surface starts in contact, stuck. */
  stic_core_report report = {0};
  c->report = &report;
  b->start_depth = depth_now(c);
  c->noise = gap_noise(c);
  add_touching(c);
  c->report = NULL;
  c->event_count = 0;
}

static void core_take(void *memory, stic_hand h, const double *holding_point_given)
{
  core *c = memory;
  come_along(c); /* first, as the grip is known to the last bit only from where it was counted */
  if (holding_point_given) {
    c->b = v_make((real)(holding_point_given[0] / c->unit), (real)(holding_point_given[1] / c->unit));
    c->grip = (hand){v_make(0, 0), 0};
  } else {
    vec at = local_place(c, h.x, h.y), arm = v_sub(at, c->p);
    c->b = v_make(v_dot(c->rot, arm), v_cross(c->rot, arm));
    c->grip = (hand){v_sub(holding_point(c), at), c->theta - (real)h.phi};
  }
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
  come_along(c);
  keep(c, &before);
  skip_way(c, &(stic_hand){0}, h);
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
  last_pose before;
  come_along(c);
  keep(c, &before);
  double done = skip_way(c, &from, to);
  hand a = hand_in(c, from), b = hand_in(c, to);
  switch (c->settings.level) {
  case STIC_LEVEL_FRAME: relax(c, b, t_to); break;
  case STIC_LEVEL_SUBSTEP: follow_substeps(c, a, b, t_from, t_to, done); break;
  case STIC_LEVEL_EVENT: follow_event(c, a, b, t_from + done * (t_to - t_from), t_to); break;
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

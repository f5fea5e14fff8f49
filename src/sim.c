/* One simulation: samples in, results out. Precision is chosen here, the grip is taken and let go here
 * ("the hold-release control of a virtual hand", 5); the statics is in statics/. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clock.h"
#include "error.h"
#include "needs.h"
#include "sim.h"
#include "statics/core.h"

struct stic_sim {
  stic_scene scene;
  stic_settings settings;
  const stic_core *core;
  void *state; /* of the core */
  stic_collider *collider;
  stic_event *events;

  bool started;
  bool held;
  bool grip_down;    /* the button at the last sample */
  int64_t t_ns;      /* of the last sample */
  double hand_angle; /* raw, unwrapped */
  double z;          /* object's depth */
  struct { /* as they were at the grip: target angle and depth keep their distance from the hand's */
    double theta, z, hand_angle, hand_z;
  } grip;
  stic_hand hand; /* at the last sample */
  int64_t slips;
  bool timed;
  int64_t collide_ns, total_ns;
  stic_core_report report;
};

static const stic_core *core_of(stic_precision precision)
{
  switch (precision) {
  case STIC_F32: return &stic_core_f32;
  case STIC_F80: return &stic_core_f80;
  case STIC_F64: break;
  }
  return &stic_core_f64;
}

/* Single precision may press a vertex through a surface (rarely, and flagged by no row): there nothing is hidden. */
static stic_parts find_parts(const stic_scene *scene, stic_precision precision, unsigned leave_out)
{
  bool hidden[STIC_SURFACES_MAX] = {false};
  stic_parts parts = {0};

  if ((leave_out & STIC_LEAVE_HIDDEN) && precision != STIC_F32)
    stic_needs_find_hidden(scene, hidden);
  for (int s = 0; s < scene->surface_count; s++)
    if (!hidden[s])
      parts.surfaces[parts.surface_count++] = s;
  return parts;
}

stic_status stic_sim_create(const stic_scene *scene, const stic_settings *settings, stic_sim **out,
                            stic_error *err)
{
  return stic_sim_create_parts(scene, settings, STIC_LEAVE_ALL, out, err);
}

stic_status stic_sim_create_parts(const stic_scene *scene, const stic_settings *settings, unsigned leave_out,
                                  stic_sim **out, stic_error *err)
{
  assert(scene && settings && out);
  *out = NULL;
  stic_status status = stic_scene_validate(scene, err);
  if (status != STIC_OK)
    return status;
  if (settings->level == STIC_LEVEL_SUBSTEP && (settings->substeps < 1 || settings->substeps > 1000000))
    return stic_error_set(err, STIC_USAGE, NULL, 0, "substeps must be from 1 to 1000000, not %d",
                          settings->substeps);
  if (!(settings->h_min > 0 && settings->h_min <= 1))
    return stic_error_set(err, STIC_USAGE, NULL, 0, "h_min must be above 0 and at most 1 object size, not %g",
                          settings->h_min);
  stic_sim *sim = calloc(1, sizeof *sim);
  const stic_parts parts = find_parts(scene, settings->precision, leave_out);
  if (sim) {
    sim->core = core_of(settings->precision);
    sim->state = malloc(sim->core->memory_size());
    sim->events = malloc(STIC_EVENTS_MAX * sizeof *sim->events);
    sim->collider = stic_collider_create(scene, stic_scene_size(scene), parts.surfaces, parts.surface_count,
                                         !(leave_out & STIC_LEAVE_ODE));
  }
  if (!sim || !sim->state || !sim->events || !sim->collider) {
    stic_sim_destroy(sim);
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "not enough memory for a simulation");
  }
  sim->scene = *scene;
  sim->settings = *settings;
  sim->z = scene->z;
  sim->core->init(sim->state, &sim->scene, settings, &parts, sim->collider, sim->events, STIC_EVENTS_MAX);
  *out = sim;
  return STIC_OK;
}

void stic_sim_destroy(stic_sim *sim)
{
  if (!sim)
    return;
  stic_collider_destroy(sim->collider);
  free(sim->events);
  free(sim->state);
  free(sim);
}

/* 2 atan2(qz, qw), unwrapped to the turn nearest to the last angle; a rotation by pi about an axis in the
 * plane has none, and keeps the last. */
static double hand_angle(const stic_sim *sim, const double *q)
{
  const double pi = 3.14159265358979323846;
  if (q[2] == 0 && q[3] == 0)
    return sim->hand_angle;
  double angle = 2 * atan2(q[2], q[3]);
  if (angle > pi)
    angle -= 2 * pi;
  else if (angle <= -pi)
    angle += 2 * pi;
  if (!sim->started)
    return angle;
  return angle + 2 * pi * round((sim->hand_angle - angle) / (2 * pi));
}

/* Distance in the plane to the object's polygon, 0 inside, of a point at (dx, dy) from its origin. */
static double distance_to_object(const stic_scene *scene, double dx, double dy, double theta)
{
  double c = cos(theta), s = sin(theta);
  double bx = c * dx + s * dy, by = c * dy - s * dx, best = INFINITY;
  bool inside = true;
  for (int i = 0; i < scene->vertex_count; i++) {
    const double *a = scene->vertices[i], *b = scene->vertices[(i + 1) % scene->vertex_count];
    double ex = b[0] - a[0], ey = b[1] - a[1], rx = bx - a[0], ry = by - a[1];
    double along = fmax(0, fmin(1, (rx * ex + ry * ey) / (ex * ex + ey * ey)));
    inside = inside && ex * ry - ey * rx >= 0;
    best = fmin(best, hypot(rx - along * ex, ry - along * ey));
  }
  return inside ? 0 : best;
}

static void add_hand_event(stic_sim *sim, stic_event_kind kind, const stic_sample *sample)
{
  stic_event e = {(double)sample->t_ns * 1e-9, kind, -1, -1, sample->position[0], sample->position[1], 0};
  sim->core->add_event(sim->state, e);
}

/* Equation (4)'s target angle. Exactly the object's own angle at the grip. */
static stic_hand hand_of(const stic_sim *sim, const stic_sample *sample)
{
  const double turned = sim->hand_angle - sim->grip.hand_angle;
  return (stic_hand){sample->position[0], sample->position[1],
                     sim->held ? sim->grip.theta + turned : sim->hand_angle};
}

/* The offsets between hand and object stay as they are at this moment. */
static void take(stic_sim *sim, const stic_sample *sample)
{
  const bool from_start = sim->scene.hold == STIC_HOLD_START;
  double dx, dy;
  memset(&sim->grip, 0, sizeof sim->grip);
  if (!from_start) {
    sim->core->offset(sim->state, 0, 0, &dx, &dy, &sim->grip.theta);
    sim->grip.hand_angle = sim->hand_angle;
    sim->grip.z = sim->z;
    sim->grip.hand_z = sample->position[2];
  }
  sim->held = true;
  sim->core->take(sim->state, hand_of(sim, sample), from_start ? sim->scene.holding_point : NULL);
  add_hand_event(sim, STIC_EVENT_TAKE, sample);
}

static bool within_reach(const stic_sim *sim, const stic_sample *sample)
{
  double dx, dy, theta;
  sim->core->offset(sim->state, sample->position[0], sample->position[1], &dx, &dy, &theta);
  return distance_to_object(&sim->scene, dx, dy, theta) <= sim->scene.reach;
}

/* True if the object was taken at this very sample. */
static bool update_grip(stic_sim *sim, const stic_sample *sample)
{
  bool down = (sample->buttons & STIC_BUTTON_GRIP) != 0 && !sample->lost;
  bool pressed = down && !sim->grip_down;
  sim->grip_down = down;
  if (sim->scene.hold == STIC_HOLD_START) {
    if (!sim->held)
      take(sim, sample);
    return !sim->started;
  }
  if (sim->held && !down) {
    sim->held = false;
    add_hand_event(sim, STIC_EVENT_RELEASE, sample);
  }
  if (sim->held || !pressed || !within_reach(sim, sample))
    return false;
  take(sim, sample);
  return true;
}

void stic_sim_step(stic_sim *sim, const stic_sample *sample, stic_result *result)
{
  assert(sim && sample && result);
  assert(!sim->started || sample->t_ns > sim->t_ns);
  int64_t start = sim->timed ? stic_clock_ns() : 0;
  sim->core->clear_events(sim->state);
  memset(&sim->report, 0, sizeof sim->report);
  sim->hand_angle = hand_angle(sim, sample->orientation);
  bool taken = update_grip(sim, sample);
  const stic_hand target = hand_of(sim, sample);
  double t = (double)sample->t_ns * 1e-9;
  if (sim->held) {
    if (taken)
      sim->core->relax(sim->state, target, t, &sim->report);
    else
      sim->core->follow(sim->state, sim->hand, target, (double)sim->t_ns * 1e-9, t, &sim->report);
    sim->z = sim->grip.z + (sample->position[2] - sim->grip.hand_z);
  }
  sim->slips += sim->report.slips;
  sim->hand = target;
  sim->t_ns = sample->t_ns;
  sim->started = true;

  result->t_ns = sample->t_ns;
  result->z = sim->z;
  result->hand_x = sample->position[0];
  result->hand_y = sample->position[1];
  result->hand_z = sample->position[2];
  result->hand_theta = target.phi;
  result->slips = sim->slips;
  result->flags = sim->report.flags | (sample->lost ? STIC_FLAG_LOST : 0u);
  result->iterations = sim->report.iterations;
  sim->core->result(sim->state, target, sim->held, result);
  if (sim->timed) {
    sim->collide_ns = stic_collider_take_ns(sim->collider);
    sim->total_ns = stic_clock_ns() - start;
  }
}

const stic_event *stic_sim_events(const stic_sim *sim, int *count)
{
  *count = sim->core->event_count(sim->state);
  return sim->events;
}

const stic_core_report *stic_sim_report(const stic_sim *sim)
{
  return &sim->report;
}

void stic_sim_time_stages(stic_sim *sim, bool on)
{
  sim->timed = on;
  stic_collider_clock(sim->collider, on);
  sim->collide_ns = sim->total_ns = 0;
}

void stic_sim_stage_times(const stic_sim *sim, int64_t *collide_ns, int64_t *total_ns)
{
  *collide_ns = sim->collide_ns;
  *total_ns = sim->total_ns;
}

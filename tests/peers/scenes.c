/* Six committed traces, and six motions whose answers are known: N = k_p times the depth to which the hand is pressed,
 * and the object holds as long as the hand is not further aside than mu_s times that depth. */
#include "scenes.h"

#include "angle.h"
#include "error.h"
#include "io/timing.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEPTH 0.02 /* m below flush */
#define MU_S 0.5
#define MU_D 0.3
#define LIMIT (MU_S * DEPTH) /* m aside */

/* ---- building ---------------------------------------------------------------------------- */

static void begin(peer_scene *p, double width, double height)
{
  stic_scene *scene = &p->motion.scene;

  stic_scene_init(scene);
  stic_scene_set_box(scene, width, height);
  scene->stiffness = 200;
  scene->rotational_stiffness = 0.5;
  scene->surface_count = 1;
  scene->surfaces[0].normal_deg = 90;
  scene->surfaces[0].friction = (stic_friction){MU_S, MU_D};
}

/* Leads the hand in a straight line to a place, at the angle that the object starts with, 31 samples a second; the
 * first call sets it there. */
static stic_status lead(peer_scene *p, double x, double y, double seconds, stic_error *err)
{
  stic_motion *m = &p->motion;
  const int count = m->count == 0 ? 1 : (int)lround(seconds * STIC_TARGET_HZ);
  stic_sample *more = realloc(m->samples, (size_t)(m->count + count) * sizeof *more);
  double from[2] = {x, y};

  if (!more)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  m->samples = more;
  if (m->count > 0)
    memcpy(from, m->samples[m->count - 1].position, sizeof from);
  for (int i = 1; i <= count; i++, m->count++) {
    const double part = (double)i / count;

    more[m->count] =
      (stic_sample){.t_ns = (int64_t)m->count * STIC_FRAME_NS,
                    .position = {from[0] + (x - from[0]) * part, from[1] + (y - from[1]) * part, 0},
                    .orientation = {0, 0, sin(m->scene.angle / 2), cos(m->scene.angle / 2)}};
  }
  return STIC_OK;
}

/* A box flat on the floor, pressed, the hand then `part` of the limit aside. */
static stic_status press(peer_scene *p, double part, stic_error *err)
{
  stic_status status;

  begin(p, 0.16, 0.08);
  p->motion.scene.y = 0.05;
  status = lead(p, 0, 0.05, 0, err);
  if (status == STIC_OK)
    status = lead(p, 0, 0.04 - DEPTH, 1, err);
  if (status == STIC_OK)
    status = lead(p, part * LIMIT, 0.04 - DEPTH, 1, err);
  if (status == STIC_OK)
    status = lead(p, part * LIMIT, 0.04 - DEPTH, 2, err);
  p->rest_row = p->motion.count - 1;
  return status;
}

static stic_status hold_at(peer_scene *p, double part, double seconds, stic_error *err)
{
  const stic_status status = press(p, part, err);

  return status == STIC_OK ? lead(p, part * LIMIT, 0.04 - DEPTH, seconds, err) : status;
}

static stic_status hold_half(peer_scene *p, double seconds, stic_error *err)
{
  return hold_at(p, 0.5, seconds, err);
}

static stic_status hold_near(peer_scene *p, double seconds, stic_error *err)
{
  return hold_at(p, 0.95, seconds, err);
}

/* The same with a hand that trembles by 0.1 mm, which stays inside the cone. */
static stic_status hold_trembling(peer_scene *p, double seconds, stic_error *err)
{
  const stic_status status = hold_at(p, 0.95, seconds, err);

  for (int i = p->rest_row - 2 * STIC_TARGET_HZ; status == STIC_OK && i < p->motion.count; i++) {
    const double t = (double)p->motion.samples[i].t_ns * 1e-9;

    p->motion.samples[i].position[0] += 1e-4 * sin(2 * STIC_PI * 9.3 * t);
    p->motion.samples[i].position[1] += 1e-4 * sin(2 * STIC_PI * 10.7 * t);
  }
  return status;
}

/* A floor turned to 0.95 of the friction's slope, the hand straight down. */
static stic_status hold_slope(peer_scene *p, double seconds, stic_error *err)
{
  const double angle = atan(0.95 * MU_S), x = -0.04 * sin(angle), y = 0.04 * cos(angle);
  stic_scene *scene = &p->motion.scene;
  stic_status status;

  begin(p, 0.16, 0.08);
  scene->surfaces[0].normal_deg = 90 + angle * STIC_DEG_PER_RAD;
  scene->angle = angle;
  scene->x = x;
  scene->y = y + 0.01;
  status = lead(p, x, y + 0.01, 0, err);
  if (status == STIC_OK)
    status = lead(p, x, y - DEPTH, 1, err);
  if (status == STIC_OK)
    status = lead(p, x, y - DEPTH, 2, err);
  p->rest_row = p->motion.count - 1;
  return status == STIC_OK ? lead(p, x, y - DEPTH, seconds, err) : status;
}

/* Slowly over the limit: 1 mm/s, so that inertia plays no part in when it gives way. */
static stic_status first_slip(peer_scene *p, double seconds, stic_error *err)
{
  const stic_status status = press(p, 0.5, err);

  (void)seconds;
  p->onset = LIMIT;
  return status == STIC_OK ? lead(p, 1.1 * LIMIT, 0.04 - DEPTH, 6, err) : status;
}

/* Pushed above its edge a slim box tips before it slides, and back. */
static stic_status tip(peer_scene *p, double seconds, stic_error *err)
{
  static const double way[][3] = {{0, 0.10, 1}, {0.04, 0.10, 2}, {0, 0.10, 2}, {-0.03, 0.10, 2}};
  stic_status status;

  (void)seconds;
  begin(p, 0.08, 0.16);
  p->motion.scene.holding_point[1] = 0.04;
  p->motion.scene.y = 0.09;
  status = lead(p, 0, 0.13, 0, err);
  for (int i = 0; status == STIC_OK && i < 4; i++)
    status = lead(p, way[i][0], way[i][1], way[i][2], err);
  return status;
}

/* ---- all --------------------------------------------------------------------------------- */

static const struct {
  const char *name, *about;
  stic_status (*make)(peer_scene *p, double seconds, stic_error *err); /* NULL: the trace of that name */
} kinds[PEER_SCENES] = {
  {"hold-50", "held at 50 % of the friction limit", hold_half},
  {"hold-95", "held at 95 % of it", hold_near},
  {"hold-tremor", "the same by a hand that trembles by 0.1 mm", hold_trembling},
  {"hold-slope", "held on a floor at 0.95 of the friction's slope", hold_slope},
  {"first-slip", "pulled over the limit at 1 mm/s", first_slip},
  {"tip", "a slim box pushed over its edge and back", tip},
  {"single-vertex", "trace", NULL},
  {"two-vertex", "trace", NULL},
  {"edge-about-to-slip", "trace", NULL},
  {"push-to-wall", "trace, 50 Hz", NULL},
  {"slope", "trace", NULL},
  {"carry", "trace", NULL},
};

static stic_status find_held(peer_scene *p, stic_error *err)
{
  stic_settings settings;
  stic_result result;
  stic_sim *sim;
  stic_status status;

  p->held = calloc((size_t)p->motion.count, sizeof *p->held);
  if (!p->held)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  stic_settings_init(&settings);
  status = stic_sim_create(&p->motion.scene, &settings, &sim, err);
  for (int i = 0; status == STIC_OK && i < p->motion.count; i++) {
    stic_sim_step(sim, &p->motion.samples[i], &result);
    p->held[i] = result.state != STIC_RELEASED;
  }
  stic_sim_destroy(sim);
  return status;
}

static stic_status make(peer_scene *p, int kind, double hold, stic_error *err)
{
  stic_settings settings;
  stic_status status;

  p->name = kinds[kind].name;
  p->about = kinds[kind].about;
  if (kinds[kind].make) {
    status = kinds[kind].make(p, hold, err);
  } else {
    char scene[512], trace[512];

    snprintf(scene, sizeof scene, "%s/%s/scene.yaml", PEER_TRACES, p->name);
    snprintf(trace, sizeof trace, "%s/%s/hand.csv", PEER_TRACES, p->name);
    status = stic_motion_read(&p->motion, scene, trace, NULL, 0, err);
  }
  stic_settings_init(&settings);
  settings.precision = STIC_F80;
  if (status == STIC_OK)
    status = find_held(p, err);
  return status == STIC_OK ? stic_outcome_run(&p->reference, &p->motion, &settings, 1, err) : status;
}

stic_status peer_scenes_make(peer_scene scenes[PEER_SCENES], double hold, stic_error *err)
{
  stic_status status = STIC_OK;

  memset(scenes, 0, PEER_SCENES * sizeof *scenes);
  for (int i = 0; i < PEER_SCENES && status == STIC_OK; i++)
    status = make(&scenes[i], i, hold, err);
  return status;
}

void peer_scenes_free(peer_scene scenes[PEER_SCENES])
{
  for (int i = 0; i < PEER_SCENES; i++) {
    stic_outcome_free(&scenes[i].reference);
    stic_motion_free(&scenes[i].motion);
    free(scenes[i].held);
  }
}

/* The hand of a dynamics engine is the scene's spring with a damper beside it; its
 * force is given anew before each of the engine's steps, as is the friction of each surface. */
#include "contest.h"

#include "angle.h"
#include "error.h"
#include "io/timing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NEAR 5e-4  /* m: vertices that close to a surface are in contact */
#define FAR 10.0   /* m, and m/s by ten: an object that comes there is lost */
#define SETTLE 2.0 /* s under the first hand pose, before the first row */

/* ---- hand -------------------------------------------------------------------------------- */

typedef struct hand {
  double x, y, raw; /* raw: the tracker's angle, unwrapped */
} hand;

typedef struct run {
  const peer_scene *scene;
  const peer_engine *engine;
  const peer_tuning *tuning;
  void *world;
  peer_motion motion; /* angle unwrapped */
  double damping, angular_damping;
  double hold[2], offset; /* holding point in the body; object's angle over the tracker's */
  double rest_x;          /* where the object was at rest_row */
  bool lost;              /* the engine has thrown the object away */
  double onset;           /* m the hand had gone; NaN: no slip yet */
} run;

static double raw_angle(const stic_sample *s, double last)
{
  return last + remainder(2 * atan2(s->orientation[2], s->orientation[3]) - last, 2 * STIC_PI);
}

/* From the centre to the holding point. */
static void lever(const run *r, double out[2])
{
  const double c = cos(r->motion.angle), s = sin(r->motion.angle);

  out[0] = c * r->hold[0] - s * r->hold[1];
  out[1] = s * r->hold[0] + c * r->hold[1];
}

/* The scene's spring alone, at the holding point. */
static void spring(const run *r, const hand *h, double force[2])
{
  double a[2];

  lever(r, a);
  force[0] = r->scene->motion.scene.stiffness * (h->x - r->motion.x - a[0]);
  force[1] = r->scene->motion.scene.stiffness * (h->y - r->motion.y - a[1]);
}

/* Spring and damper, at the centre. `speed`: the hand's. */
static void load(const run *r, const hand *h, const hand *speed, bool held, double force[2], double *moment)
{
  const peer_motion *m = &r->motion;
  const double follow = held ? r->tuning->hand_damping : 0;
  double a[2] = {0, 0};

  force[0] = force[1] = *moment = 0;
  if (held) {
    lever(r, a);
    spring(r, h, force);
    *moment = r->scene->motion.scene.rotational_stiffness * (h->raw + r->offset - m->angle);
  }
  force[0] -= r->damping * (m->vx - m->turning * a[1] - follow * speed->x);
  force[1] -= r->damping * (m->vy + m->turning * a[0] - follow * speed->y);
  *moment += a[0] * force[1] - a[1] * force[0] - r->angular_damping * (m->turning - follow * speed->raw);
}

/* mu_dynamic on a surface along which a vertex slips, else mu_static. */
static void choose_friction(const run *r, double *mu)
{
  const stic_scene *scene = &r->scene->motion.scene;
  const double c = cos(r->motion.angle), s = sin(r->motion.angle);

  for (int i = 0; i < scene->surface_count; i++) {
    const stic_surface *surface = &scene->surfaces[i];
    double n[2];

    mu[i] = surface->friction.mu_static;
    stic_normal_from_degrees(surface->normal_deg, n);
    for (int k = 0; r->tuning->switch_speed > 0 && k < scene->vertex_count; k++) {
      const double *v = scene->vertices[k], x = c * v[0] - s * v[1], y = s * v[0] + c * v[1];
      const double slip =
        n[1] * (r->motion.vx - r->motion.turning * y) - n[0] * (r->motion.vy + r->motion.turning * x);

      if (n[0] * (r->motion.x + x - surface->point[0]) + n[1] * (r->motion.y + y - surface->point[1]) <
            NEAR &&
          fabs(slip) > r->tuning->switch_speed)
        mu[i] = surface->friction.mu_dynamic;
    }
  }
}

/* ---- engine ------------------------------------------------------------------------------ */

static void look(run *r)
{
  const double last = r->motion.angle;
  const peer_motion *m = &r->motion;

  r->engine->read(r->world, &r->motion);
  r->motion.angle = last + remainder(r->motion.angle - last, 2 * STIC_PI);
  r->lost = !(hypot(m->x, m->y) < FAR && hypot(m->vx, m->vy) < 10 * FAR && fabs(m->turning) < 1000 * FAR);
  if (r->lost)
    r->motion = (peer_motion){NAN, NAN, NAN, NAN, NAN, NAN};
}

static void note_onset(run *r, const hand *h)
{
  if (isnan(r->onset) && fabs(r->motion.x - r->rest_x) > PEER_ONSET_SEEN)
    r->onset = h->x;
}

static void advance(run *r, const hand *from, const hand *to, double seconds, bool held, bool watch)
{
  const int steps = r->tuning->steps;
  const hand speed = {(to->x - from->x) / seconds, (to->y - from->y) / seconds,
                      (to->raw - from->raw) / seconds};
  double mu[STIC_SURFACES_MAX], force[2], moment;

  for (int i = 1; i <= steps && !r->lost; i++) {
    const double part = (double)i / steps;
    const hand h = {from->x + (to->x - from->x) * part, from->y + (to->y - from->y) * part,
                    from->raw + (to->raw - from->raw) * part};

    choose_friction(r, mu);
    load(r, &h, &speed, held, force, &moment);
    r->engine->step(r->world, force, moment, mu, seconds / steps);
    look(r);
    if (watch)
      note_onset(r, &h);
  }
}

/* The hand takes the object where they are. */
static void take(run *r, const hand *h)
{
  const double c = cos(r->motion.angle), s = sin(r->motion.angle), dx = h->x - r->motion.x,
               dy = h->y - r->motion.y;

  r->hold[0] = c * dx + s * dy;
  r->hold[1] = c * dy - s * dx;
  r->offset = r->motion.angle - h->raw;
}

static void keep_row(run *r, const hand *h, bool held, stic_outcome_row *row)
{
  double force[2] = {0, 0};

  if (held)
    spring(r, h, force);
  *row = (stic_outcome_row){r->motion.x, r->motion.y, r->motion.angle, force[0], force[1]};
}

static void solve(run *r, stic_outcome *o)
{
  const peer_scene *p = r->scene;
  const double frame = STIC_FRAME_NS * 1e-9;
  const stic_sample *s = p->motion.samples;
  hand last = {s[0].position[0], s[0].position[1], raw_angle(&s[0], 0)};

  memcpy(r->hold, p->motion.scene.holding_point, sizeof r->hold);
  if (p->held[0] && p->motion.scene.hold == STIC_HOLD_BUTTON)
    take(r, &last);
  for (double t = 0; t < SETTLE; t += frame)
    advance(r, &last, &last, frame, p->held[0], false);
  keep_row(r, &last, p->held[0], &o->rows[0]);
  o->least_ns[0] = 0;
  for (int i = 1; i < p->motion.count; i++) {
    const hand h = {s[i].position[0], s[i].position[1], raw_angle(&s[i], last.raw)};
    const double seconds = (double)(s[i].t_ns - s[i - 1].t_ns) * 1e-9;
    const bool taken = p->held[i] && !p->held[i - 1];
    const int64_t start = stic_clock_ns();
    int64_t ns;

    if (taken)
      take(r, &h);
    advance(r, taken ? &h : &last, &h, seconds, p->held[i], p->onset > 0 && i > p->rest_row);
    ns = stic_clock_ns() - start;
    o->least_ns[i] = ns < o->least_ns[i] ? ns : o->least_ns[i];
    keep_row(r, &h, p->held[i], &o->rows[i]);
    if (i == p->rest_row)
      r->rest_x = r->motion.x;
    last = h;
  }
}

static stic_status run_peer(const peer_contestant *who, const peer_scene *p, stic_outcome *o, double *onset,
                            stic_error *err)
{
  const stic_scene *scene = &p->motion.scene;
  const double *corner = scene->vertices[2];
  const double inertia = who->tuning.mass * (corner[0] * corner[0] + corner[1] * corner[1]) / 3;
  run r = {.scene = p, .engine = who->engine, .tuning = &who->tuning, .onset = NAN};
  const stic_status status = stic_outcome_reserve(o, p->motion.count, err);

  if (status != STIC_OK)
    return status;
  r.damping = who->tuning.damping * 2 * sqrt(scene->stiffness * who->tuning.mass);
  r.angular_damping = who->tuning.damping * 2 * sqrt(scene->rotational_stiffness * inertia);
  r.world = who->engine->create(scene, &who->tuning, inertia);
  if (!r.world)
    return stic_error_set(err, STIC_FAILED, NULL, 0, "%s refuses scene '%s'", who->engine->name, p->name);
  r.motion.angle = scene->angle;
  look(&r);
  solve(&r, o);
  *onset = r.onset;
  who->engine->destroy(r.world);
  return STIC_OK;
}

/* ---- stiction ---------------------------------------------------------------------------- */

/* Level event knows the time of the slip between two samples; the others know the sample that shows it. */
static double hand_at(const peer_scene *p, double t)
{
  const stic_sample *s = p->motion.samples;
  int i = 1;

  while (i + 1 < p->motion.count && (double)s[i].t_ns * 1e-9 < t)
    i++;
  return s[i - 1].position[0] + (s[i].position[0] - s[i - 1].position[0]) *
                                  (t - (double)s[i - 1].t_ns * 1e-9) /
                                  ((double)(s[i].t_ns - s[i - 1].t_ns) * 1e-9);
}

stic_status peer_contest_run(const peer_contestant *who, const peer_scene *scene, stic_outcome *outcome,
                             double *onset, stic_error *err)
{
  stic_status status;

  if (who->engine)
    return run_peer(who, scene, outcome, onset, err);
  status = stic_outcome_run(outcome, &scene->motion, &who->settings, 1, err);
  if (status == STIC_OK && scene->onset > 0)
    *onset = outcome->slip_count > 0 ? hand_at(scene, outcome->slip_times[0]) : NAN;
  return status;
}

void peer_contest_score(const peer_scene *p, const stic_outcome *o, double onset, peer_score *score)
{
  const stic_outcome_row *rest = &o->rows[p->rest_row];
  const int later = p->rest_row + 10 * STIC_TARGET_HZ;

  memset(score, 0, sizeof *score);
  stic_outcome_compare(&p->motion, &p->reference, o, 1, &score->difference);
  if (isnan(o->rows[o->count - 1].x)) /* lost; a maximum would pass over it */
    score->difference = (stic_difference){.position_rms = NAN,
                                          .position_max = NAN,
                                          .angle_rms = NAN,
                                          .angle_max = NAN,
                                          .force_rms = NAN,
                                          .force_max = NAN};
  score->median_ns = stic_outcome_cost(o, 0.5);
  score->worst_ns = stic_outcome_cost(o, 1);
  score->onset = p->onset > 0 ? fabs(onset / p->onset - 1) : NAN;
  score->creep = score->drift = NAN;
  if (p->rest_row > 0 && !(p->onset > 0) && later < o->count) {
    score->creep = hypot(o->rows[later].x - rest->x, o->rows[later].y - rest->y) / 10;
    score->drift = hypot(o->rows[o->count - 1].x - rest->x, o->rows[o->count - 1].y - rest->y);
  }
}

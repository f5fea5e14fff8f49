/* Motions for `stiction bench trade` and `run --accuracy auto`: read, made or resampled; solved; compared. */
#include "../../angle.h"
#include "../../error.h"
#include "../../io/log_csv.h"
#include "../../io/timing.h"
#include "../../io/trace_csv.h"
#include "../../needs.h"
#include "../cli.h"
#include "trade.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HASH_START UINT64_C(14695981039346656037)
#define HASH_STEP UINT64_C(1099511628211)

static stic_status no_memory(stic_error *err)
{
  return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
}

/* ---- motions ----------------------------------------------------------------------------- */

void stic_motion_free(stic_motion *motion)
{
  free(motion->samples);
  motion->samples = NULL;
  motion->count = 0;
}

static stic_status read_samples(stic_motion *motion, const char *trace, stic_error *err)
{
  stic_trace_reader *reader = NULL;
  stic_trace_status got = STIC_TRACE_WAIT;
  int room = 0;
  stic_status status = stic_trace_open(trace, NULL, &reader, err);

  while (status == STIC_OK && got != STIC_TRACE_END && stic_cli_signal() == 0) {
    if (motion->count == room) {
      stic_sample *more = realloc(motion->samples, (size_t)(room = 2 * room + 256) * sizeof *more);

      if (!more) {
        status = no_memory(err);
        break;
      }
      motion->samples = more;
    }
    got = stic_trace_next(reader, &motion->samples[motion->count], err);
    motion->count += got == STIC_TRACE_SAMPLE;
    if (got == STIC_TRACE_BAD)
      status = err->status;
  }
  stic_trace_close(reader);
  return status;
}

stic_status stic_motion_read(stic_motion *motion, const char *scene, const char *trace,
                             const stic_override *overrides, int override_count, stic_error *err)
{
  stic_status status;

  memset(motion, 0, sizeof *motion);
  status = stic_scene_read(scene, overrides, override_count, &motion->scene, err);
  if (status == STIC_OK)
    status = read_samples(motion, trace, err);
  snprintf(motion->name, sizeof motion->name, "%s", motion->scene.name[0] ? motion->scene.name : scene);
  if (status != STIC_OK)
    stic_motion_free(motion);
  return status;
}

stic_status stic_motion_built_in(stic_motion *motion, stic_error *err)
{
  static const double normals[2] = {90, 0};

  memset(motion, 0, sizeof *motion);
  snprintf(motion->name, sizeof motion->name, "built in: a box between floor and wall");
  stic_scene_init(&motion->scene);
  stic_scene_set_box(&motion->scene, 0.16, 0.08);
  motion->scene.x = motion->scene.y = 0.3;
  motion->scene.stiffness = 200;
  motion->scene.rotational_stiffness = 0.5;
  motion->scene.surface_count = 2;
  for (int i = 0; i < 2; i++) {
    motion->scene.surfaces[i].normal_deg = normals[i];
    motion->scene.surfaces[i].friction = (stic_friction){0.5, 0.3};
  }
  motion->samples = calloc(400, sizeof *motion->samples);
  if (!motion->samples)
    return no_memory(err);
  motion->count = 400;
  for (int i = 0; i < 400; i++) {
    const double t = i / 31.0, press = fmin(1, t), angle = 0.35 + 0.3 * sin(2 * STIC_PI * 0.23 * t);
    stic_sample *s = &motion->samples[i];

    s->t_ns = (int64_t)i * STIC_FRAME_NS;
    s->position[0] = 0.3 - press * 0.22 + 0.03 * cos(2 * STIC_PI * 0.31 * t);
    s->position[1] = 0.3 - press * 0.25 + 0.01 * sin(2 * STIC_PI * 0.31 * t);
    s->orientation[2] = sin(angle / 2);
    s->orientation[3] = cos(angle / 2);
  }
  return STIC_OK;
}

/* ---- along the surfaces of any scene ------------------------------------------------------ */

#define LEGS_MAX 16

/* A stretch of the way: home, pressed against one surface or two, along the first, and home again. */
typedef struct leg {
  double away[2], along[2]; /* m, from home */
} leg;

/* Where the hand starts: at the holding point, or in the object's middle. */
static void find_home(const stic_scene *scene, double home[2])
{
  const double c = cos(scene->angle), s = sin(scene->angle);
  double b[2] = {scene->holding_point[0], scene->holding_point[1]};

  if (scene->hold == STIC_HOLD_BUTTON) {
    b[0] = b[1] = 0;
    for (int v = 0; v < scene->vertex_count; v++)
      for (int k = 0; k < 2; k++)
        b[k] += scene->vertices[v][k] / scene->vertex_count;
  }
  home[0] = scene->x + c * b[0] - s * b[1];
  home[1] = scene->y + s * b[0] + c * b[1];
}

/* One per surface and one per corner; surfaces behind others are never touched. */
static int find_legs(const stic_scene *scene, const double home[2], leg *legs)
{
  const double size = stic_scene_size(scene), depth = 0.1 * size;
  bool hidden[STIC_SURFACES_MAX];
  int count = 0, last = -1;

  stic_needs_find_hidden(scene, hidden);
  for (int s = 0; s < scene->surface_count && count + 2 <= LEGS_MAX; s++) {
    const stic_surface *surface = &scene->surfaces[s];
    double n[2], gap;
    leg *l = &legs[count];

    if (hidden[s])
      continue;
    stic_normal_from_degrees(surface->normal_deg, n);
    gap = (home[0] - surface->point[0]) * n[0] + (home[1] - surface->point[1]) * n[1];
    *l = (leg){{-(gap + depth) * n[0], -(gap + depth) * n[1]}, {size * n[1], -size * n[0]}};
    count++;
    if (last >= 0) { /* both at once */
      legs[count] = *l;
      for (int k = 0; k < 2; k++)
        legs[count].away[k] += legs[last].away[k];
      count++;
    }
    last = (int)(l - legs);
  }
  return count;
}

/* Position and turn at part 0..1 of a leg. */
static void leg_at(const leg *l, double part, double place[2], double *turn)
{
  const double in = fmin(1, fmin(part, 1 - part) / 0.15), u = fmax(0, fmin(1, (part - 0.15) / 0.7));
  const double press = in * in * (3 - 2 * in) * (1 + 0.2 * sin(10 * STIC_PI * u)),
               slide = sin(6 * STIC_PI * u);

  for (int k = 0; k < 2; k++)
    place[k] = press * l->away[k] + slide * l->along[k];
  *turn = 0.5 * sin(4 * STIC_PI * u);
}

stic_status stic_motion_along_surfaces(stic_motion *motion, const stic_scene *scene, int count,
                                       stic_error *err)
{
  const double tremor = 0.002 * stic_scene_size(scene);
  leg legs[LEGS_MAX];
  double home[2];
  int leg_count;

  memset(motion, 0, sizeof *motion);
  motion->scene = *scene;
  motion->samples = calloc((size_t)count, sizeof *motion->samples);
  if (!motion->samples)
    return no_memory(err);
  motion->count = count;
  find_home(scene, home);
  leg_count = find_legs(scene, home, legs);
  for (int i = 0; i < count; i++) {
    const double t = i / 31.0, at = (double)i / count * leg_count;
    const int k = (int)at;
    stic_sample *s = &motion->samples[i];
    double place[2], turn;

    leg_at(&legs[k], at - k, place, &turn);
    s->t_ns = (int64_t)i * STIC_FRAME_NS;
    s->position[0] = home[0] + place[0] + tremor * sin(2 * STIC_PI * 9.3 * t);
    s->position[1] = home[1] + place[1] + tremor * sin(2 * STIC_PI * 10.7 * t);
    s->orientation[2] = sin((scene->angle + turn) / 2);
    s->orientation[3] = cos((scene->angle + turn) / 2);
    s->buttons = STIC_BUTTON_GRIP;
  }
  return STIC_OK;
}

/* ---- resampled --------------------------------------------------------------------------- */

static double hand_angle(const stic_sample *sample, double last)
{
  const double *q = sample->orientation;

  return q[2] == 0 && q[3] == 0 ? last : last + remainder(2 * atan2(q[2], q[3]) - last, 2 * STIC_PI);
}

/* x, y, z and the unwrapped angle of each sample. */
typedef struct knot {
  double v[4];
} knot;

/* How fast the hand is at a knot, from its neighbours. */
static double knot_rate(const stic_motion *m, const knot *knots, int i, int k)
{
  const int before = i > 0 ? i - 1 : i, after = i + 1 < m->count ? i + 1 : i;
  const double span = (double)(m->samples[after].t_ns - m->samples[before].t_ns) * 1e-9;

  return span > 0 ? (knots[after].v[k] - knots[before].v[k]) / span : 0;
}

/* Cubic between two knots with the rates above. */
static double between(const stic_motion *m, const knot *knots, int i, int k, double part)
{
  const double span = (double)(m->samples[i + 1].t_ns - m->samples[i].t_ns) * 1e-9, p = part, q = 1 - part;

  return knots[i].v[k] * q * q * (1 + 2 * p) + knots[i + 1].v[k] * p * p * (1 + 2 * q) +
         span * p * q * (q * knot_rate(m, knots, i, k) - p * knot_rate(m, knots, i + 1, k));
}

#define FINE_NS 1000000
#define FINE_MAX 60000

stic_status stic_motion_resample(const stic_motion *from, stic_motion *to, stic_error *err)
{
  const int64_t start = from->samples[0].t_ns,
                length = (from->samples[from->count - 1].t_ns - start) / FINE_NS;
  knot *knots = calloc((size_t)from->count, sizeof *knots);
  double angle = 0;

  memset(to, 0, sizeof *to);
  memcpy(to->name, from->name, sizeof to->name);
  to->scene = from->scene;
  to->count = (int)(length < FINE_MAX ? length : FINE_MAX) + 1;
  to->samples = calloc((size_t)to->count, sizeof *to->samples);
  if (!knots || !to->samples) {
    free(knots);
    stic_motion_free(to);
    return no_memory(err);
  }
  for (int i = 0; i < from->count; i++) {
    memcpy(knots[i].v, from->samples[i].position, sizeof from->samples[i].position);
    knots[i].v[3] = angle = hand_angle(&from->samples[i], angle);
  }
  for (int i = 0, at = 0; i < to->count; i++) {
    stic_sample *s = &to->samples[i];
    double v[4];

    s->t_ns = start + (int64_t)i * FINE_NS;
    while (at + 2 < from->count && from->samples[at + 1].t_ns <= s->t_ns)
      at++;
    for (int k = 0; k < 4; k++) {
      const double span = from->count > 1 ? (double)(from->samples[at + 1].t_ns - from->samples[at].t_ns) : 1;

      v[k] = from->count > 1 ? between(from, knots, at, k, (double)(s->t_ns - from->samples[at].t_ns) / span)
                             : knots[0].v[k];
    }
    memcpy(s->position, v, sizeof s->position);
    s->orientation[2] = sin(v[3] / 2);
    s->orientation[3] = cos(v[3] / 2);
    s->buttons = from->samples[at].buttons;
    s->lost = from->samples[at].lost;
  }
  free(knots);
  return STIC_OK;
}

/* ---- outcomes ---------------------------------------------------------------------------- */

void stic_outcome_free(stic_outcome *o)
{
  free(o->rows);
  free(o->least_ns);
  free(o->sorted);
  free(o->slip_times);
  memset(o, 0, sizeof *o);
}

static void hash_bytes(uint64_t *hash, const void *data, size_t length)
{
  const unsigned char *bytes = data;

  for (size_t i = 0; i < length; i++)
    *hash = (*hash ^ bytes[i]) * HASH_STEP;
}

static void hash_events(uint64_t *hash, const stic_sim *sim)
{
  int count;
  const stic_event *e = stic_sim_events(sim, &count);

  for (int i = 0; i < count; i++) {
    const int what[3] = {(int)e[i].kind, e[i].vertex, e[i].surface};

    hash_bytes(hash, what, sizeof what);
  }
}

static bool keep_slip_times(stic_outcome *o, const stic_sim *sim)
{
  int count;
  const stic_event *e = stic_sim_events(sim, &count);

  for (int i = 0; i < count; i++) {
    /* Contacts that slide together have one time. */
    if (e[i].kind != STIC_EVENT_SLIP || (o->slip_count > 0 && o->slip_times[o->slip_count - 1] == e[i].t))
      continue;
    if (o->slip_count == o->slip_room) {
      double *more = realloc(o->slip_times, (size_t)(o->slip_room = 2 * o->slip_room + 256) * sizeof *more);

      if (!more)
        return false;
      o->slip_times = more;
    }
    o->slip_times[o->slip_count++] = e[i].t;
  }
  return true;
}

static uint64_t hash_contacts(const stic_result *r)
{
  uint64_t hash = HASH_START;

  hash_bytes(&hash, &r->state, sizeof r->state);
  for (int i = 0; i < r->contact_count; i++) {
    const int pair[2] = {r->contacts[i].vertex, r->contacts[i].surface};

    hash_bytes(&hash, pair, sizeof pair);
  }
  return hash;
}

typedef struct run {
  stic_sim *sim;
  uint64_t hash, contacts, last_contacts, events;
} run;

static stic_status keep_row(stic_outcome *o, run *r, int i, const stic_result *result, stic_error *err)
{
  const stic_outcome_row row = {result->x, result->y, result->theta, result->force_x, result->force_y};
  const uint64_t contacts = hash_contacts(result);
  char text[STIC_LOG_ROW_MAX];

  hash_bytes(&r->hash, text, stic_log_row_text(result, text));
  if (contacts != r->last_contacts)
    hash_bytes(&r->contacts, &contacts, sizeof contacts);
  r->last_contacts = contacts;
  hash_events(&r->events, r->sim);
  if (o->hash != 0)
    return STIC_OK;
  o->rows[i] = row;
  o->slips = result->slips;
  o->flagged += (result->flags & (STIC_FLAG_NO_ANSWER | STIC_FLAG_LIMIT)) != 0;
  return keep_slip_times(o, r->sim) ? STIC_OK : no_memory(err);
}

stic_status stic_outcome_reserve(stic_outcome *o, int count, stic_error *err)
{
  if (o->rows)
    return STIC_OK;
  memset(o, 0, sizeof *o);
  o->count = count;
  o->rows = malloc((size_t)count * sizeof *o->rows);
  o->least_ns = malloc((size_t)count * sizeof *o->least_ns);
  o->sorted = malloc((size_t)count * sizeof *o->sorted);
  if (!o->rows || !o->least_ns || !o->sorted) {
    stic_outcome_free(o);
    return no_memory(err);
  }
  for (int i = 0; i < count; i++)
    o->least_ns[i] = INT64_MAX;
  return STIC_OK;
}

stic_status stic_outcome_run(stic_outcome *o, const stic_motion *motion, const stic_settings *settings,
                             int stride, stic_error *err)
{
  run r = {NULL, HASH_START, HASH_START, 0, HASH_START};
  stic_result result;
  stic_status status = stic_outcome_reserve(o, (motion->count + stride - 1) / stride, err);

  if (status == STIC_OK)
    status = stic_sim_create(&motion->scene, settings, &r.sim, err);
  for (int i = 0; status == STIC_OK && i < o->count && stic_cli_signal() == 0; i++) {
    const int64_t start = stic_clock_ns();
    int64_t taken;

    stic_sim_step(r.sim, &motion->samples[i * stride], &result);
    taken = stic_clock_ns() - start;
    o->least_ns[i] = taken < o->least_ns[i] ? taken : o->least_ns[i];
    o->worst_ns = taken > o->worst_ns ? taken : o->worst_ns;
    status = keep_row(o, &r, i, &result, err);
  }
  stic_sim_destroy(r.sim);
  if (status != STIC_OK) {
    stic_outcome_free(o);
    return status;
  }
  if (o->hash != 0 && r.hash != o->hash && stic_cli_signal() == 0)
    return stic_error_set(err, STIC_FAILED, NULL, 0,
                          "bench: two runs of '%s' differ, hash %016llx and %016llx", motion->name,
                          (unsigned long long)o->hash, (unsigned long long)r.hash);
  o->hash = r.hash;
  o->contacts = r.contacts;
  o->events = r.events;
  return STIC_OK;
}

static int compare_ns(const void *a, const void *b)
{
  const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;

  return (x > y) - (x < y);
}

int64_t stic_cost_quantile(int64_t *ns, int count, double part)
{
  qsort(ns, (size_t)count, sizeof *ns, compare_ns);
  return ns[(int)fmin(count - 1, fmax(0, ceil(part * count) - 1))];
}

int64_t stic_outcome_cost(const stic_outcome *o, double part)
{
  memcpy(o->sorted, o->least_ns, (size_t)o->count * sizeof *o->sorted);
  return stic_cost_quantile(o->sorted, o->count, part);
}

/* ---- differences ------------------------------------------------------------------------- */

static double vertex_distance(const stic_scene *scene, const stic_outcome_row *a, const stic_outcome_row *b)
{
  const double dc = cos(a->theta) - cos(b->theta), ds = sin(a->theta) - sin(b->theta);
  double farthest = 0;

  for (int i = 0; i < scene->vertex_count; i++) {
    const double *v = scene->vertices[i];

    farthest =
      fmax(farthest, hypot(a->x - b->x + dc * v[0] - ds * v[1], a->y - b->y + ds * v[0] + dc * v[1]));
  }
  return farthest;
}

/* From each time of `a` to the nearest of `b`; both ascend. */
static void add_times(const stic_outcome *a, const stic_outcome *b, double *sum, double *largest)
{
  for (int i = 0, k = 0; i < a->slip_count; i++) {
    double apart;

    while (k + 1 < b->slip_count &&
           fabs(b->slip_times[k + 1] - a->slip_times[i]) <= fabs(b->slip_times[k] - a->slip_times[i]))
      k++;
    apart = fabs(b->slip_times[k] - a->slip_times[i]);
    *sum += apart;
    *largest = fmax(*largest, apart);
  }
}

static void compare_slips(const stic_outcome *reference, const stic_outcome *got, stic_difference *d)
{
  const int both = reference->slip_count + got->slip_count;

  d->slips = got->slips - reference->slips;
  if (both == 0)
    return;
  if (reference->slip_count == 0 || got->slip_count == 0) {
    d->slip_time = d->slip_time_max = NAN;
    return;
  }
  add_times(reference, got, &d->slip_time, &d->slip_time_max);
  add_times(got, reference, &d->slip_time, &d->slip_time_max);
  d->slip_time /= both;
}

void stic_outcome_compare(const stic_motion *motion, const stic_outcome *reference, const stic_outcome *got,
                          int stride, stic_difference *d)
{
  double largest_force = 0;

  memset(d, 0, sizeof *d);
  for (int i = 0; i < reference->count; i++)
    largest_force = fmax(largest_force, hypot(reference->rows[i].force_x, reference->rows[i].force_y));
  for (int i = 0; i < got->count && i * stride < reference->count; i++) {
    const stic_outcome_row *a = &reference->rows[i * stride], *b = &got->rows[i];
    const double position = vertex_distance(&motion->scene, a, b), angle = fabs(a->theta - b->theta);
    const double force =
      largest_force > 0 ? hypot(a->force_x - b->force_x, a->force_y - b->force_y) / largest_force : 0;

    d->position_max = fmax(d->position_max, position);
    d->angle_max = fmax(d->angle_max, angle);
    d->force_max = fmax(d->force_max, force);
    d->position_rms += position * position;
    d->angle_rms += angle * angle;
    d->force_rms += force * force;
  }
  d->position_rms = sqrt(d->position_rms / got->count);
  d->angle_rms = sqrt(d->angle_rms / got->count);
  d->force_rms = sqrt(d->force_rms / got->count);
  compare_slips(reference, got, d);
}

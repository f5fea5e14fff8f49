/* The invariants of the model on random scenes and adversarial hand paths.
 *   invariants rows|scale|mirror|turn|regrip [--seed S] [--count N] [--frames N] [--level L] [--precision P]
 *              [--break WHAT] [--verbose]
 * Without --level or --precision all of them. A failure prints the seed, the row, and the line that replays it. */
#include <float.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "angle.h"
#include "inside.h"
#include "statics/core.h"
#include "invariants/checker.h"
#include "invariants/wild.h"

inside inside_report;

typedef struct options {
  const char *what, *broken;
  uint64_t seed;
  long count;
  int frames, level, precision; /* -1: all */
  bool verbose;
} options;

static const stic_level LEVELS[] = {STIC_LEVEL_FRAME, STIC_LEVEL_SUBSTEP, STIC_LEVEL_EVENT};
static const char *const LEVEL_NAMES[] = {"frame", "substep", "event"};
static const stic_precision PRECISIONS[] = {STIC_F32, STIC_F64, STIC_F80};
static const char *const PRECISION_NAMES[] = {"f32", "f64", "f80"};

static struct {
  long rows, contacts, flagged, tiny, cases, refused, failures, ties;
  double depth, residual, anchor;
} total;

static stic_settings settings_of(int level, int precision)
{
  stic_settings s;
  stic_settings_init(&s);
  s.level = LEVELS[level], s.precision = PRECISIONS[precision], s.substeps = 3;
  return s;
}

static void say_replay(const options *o, uint64_t seed, int level, int precision, int frame)
{
  printf("  replay: invariants %s --seed %" PRIu64
         " --count 1 --frames %d --level %s --precision %s%s%s --verbose\n",
         o->what, seed, frame + 1, LEVEL_NAMES[level], PRECISION_NAMES[precision],
         o->broken ? " --break " : "", o->broken ? o->broken : "");
  total.failures++;
}

static stic_sim *open_sim(const stic_scene *scene, int level, int precision, uint64_t seed)
{
  stic_sim *sim;
  stic_error err;
  stic_settings settings = settings_of(level, precision);
  if (stic_sim_create(scene, &settings, &sim, &err) == STIC_OK)
    return sim;
  if (getenv("STICTION_TEST_REFUSED"))
    printf("seed %" PRIu64 " is no scene: %s\n", seed, err.message);
  total.refused++;
  return NULL;
}

static void print_row(int frame, const stic_result *r)
{
  printf("  row %d: hand %.17g %.17g %.17g pose %.17g %.17g %.17g %s flags %u slips %" PRId64
         " residual %.2g",
         frame, r->hand_x, r->hand_y, r->hand_theta, r->x, r->y, r->theta, stic_state_name(r->state),
         r->flags, r->slips, r->residual);
  for (int i = 0; i < r->contact_count; i++)
    printf(" [v%d s%d N %.6g T %.6g]", r->contacts[i].vertex, r->contacts[i].surface, r->contacts[i].normal,
           r->contacts[i].friction);
  printf("\n");
}

/* ---- every row ---- */

/* Controls: what a solver with a defect would say. Each must be found. */
static void break_row(const char *how, double size, double ulp, stic_result *r)
{
  if (!how || !r->contact_count)
    return;
  stic_contact *k = &r->contacts[0];
  if (!strcmp(how, "depth"))
    r->x -= 1e5 * ulp * size, r->y -= 1e5 * ulp * size;
  if (!strcmp(how, "creep"))
    k->x = nextafter(k->x, 1e300) + (k->x == 0 ? 1e-300 : 0);
  if (!strcmp(how, "cone"))
    k->friction = copysign(fabs(k->friction) + (1e-9 + 64 * ulp) * k->normal, k->friction) * 1e3;
  if (!strcmp(how, "pull"))
    k->normal = -fabs(k->normal) - 1e-300;
  if (!strcmp(how, "balance"))
    k->normal *= 1 + 1e5 * ulp + 1e-10;
}

static void check_rows(const options *o, uint64_t seed, int level, int precision)
{
  wild_case c;
  stic_checker k;
  wild_init(&c, seed);
  stic_sim *sim = open_sim(&c.scene, level, precision, seed);
  if (!sim)
    return;
  stic_checker_init(&k, &c.scene, PRECISIONS[precision]);
  stic_result r;
  memset(&r, 0, sizeof r);
  total.cases++;
  for (int i = 0; i < o->frames && !k.complaint[0]; i++) {
    if (i)
      wild_move(&c, &r);
    stic_sample sample = wild_sample(&c, i);
    double rise = inside_report.worst_rise;
    inside_report.row_decisions = 0;
    stic_sim_step(sim, &sample, &r);
    stic_result seen = r;
    break_row(o->broken, k.size, k.ulp, &seen);
    int count;
    const stic_event *events = stic_sim_events(sim, &count);
    stic_checker_row(&k, &seen, events, count,
                     (inside_report.row_decisions & ~(unsigned)STIC_DECISION_REST) != 0);
    if (inside_report.worst_rise > 1 && inside_report.worst_rise > rise && !k.complaint[0])
      snprintf(k.complaint, sizeof k.complaint, "5: HOLD raises the energy, %.3g times what rounding allows",
               inside_report.worst_rise);
    if (o->verbose)
      print_row(i, &r);
    if (!k.complaint[0])
      continue;
    printf("seed %" PRIu64 " %s %s row %d: %s\n", seed, LEVEL_NAMES[level], PRECISION_NAMES[precision], i,
           k.complaint);
    say_replay(o, seed, level, precision, i);
  }
  inside_report.worst_rise = fmin(inside_report.worst_rise, 1);
  total.rows += k.rows, total.contacts += k.contacts, total.flagged += k.flagged, total.tiny += k.tiny_slides;
  total.depth = fmax(total.depth, k.worst_depth), total.residual = fmax(total.residual, k.worst_residual);
  total.anchor = fmax(total.anchor, k.worst_anchor);
  stic_sim_destroy(sim);
}

/* ---- powers of two: bit for bit ---- */

static void scale_scene(stic_scene *s, int m, int n)
{
  for (int i = 0; i < s->vertex_count; i++)
    s->vertices[i][0] = ldexp(s->vertices[i][0], m), s->vertices[i][1] = ldexp(s->vertices[i][1], m);
  for (int i = 0; i < s->surface_count; i++)
    s->surfaces[i].point[0] = ldexp(s->surfaces[i].point[0], m),
    s->surfaces[i].point[1] = ldexp(s->surfaces[i].point[1], m);
  s->x = ldexp(s->x, m), s->y = ldexp(s->y, m), s->reach = ldexp(s->reach, m);
  s->holding_point[0] = ldexp(s->holding_point[0], m), s->holding_point[1] = ldexp(s->holding_point[1], m);
  s->stiffness = ldexp(s->stiffness, n - m), s->rotational_stiffness = ldexp(s->rotational_stiffness, n + m);
}

#define SAME(a, b, power)                                                                                    \
  do {                                                                                                       \
    if (ldexp(a, power) != (b) && !different)                                                                \
      different = #a;                                                                                        \
  } while (0)

static const char *scaled_difference(const stic_result *a, const stic_result *b, int m, int n)
{
  const char *different = NULL;
  SAME(a->x, b->x, m);
  SAME(a->y, b->y, m);
  SAME(a->theta, b->theta, 0);
  SAME(a->holding_x, b->holding_x, m);
  SAME(a->holding_y, b->holding_y, m);
  SAME(a->force_x, b->force_x, n);
  SAME(a->force_y, b->force_y, n);
  SAME(a->moment, b->moment, n + m);
  SAME(a->residual, b->residual, 0);
  if (a->state != b->state || a->slips != b->slips || a->flags != b->flags ||
      a->iterations != b->iterations || a->contact_count != b->contact_count)
    return "state, slips, flags, iterations or number of contacts";
  for (int i = 0; i < a->contact_count; i++) {
    const stic_contact *p = &a->contacts[i], *q = &b->contacts[i];
    SAME(p->x, q->x, m);
    SAME(p->y, q->y, m);
    SAME(p->normal, q->normal, n);
    SAME(p->friction, q->friction, n);
    if (!stic_same_contact(p, q))
      return "contacts";
  }
  return different;
}

static void check_scale(const options *o, uint64_t seed, int level, int precision)
{
  wild_case c;
  wild_init(&c, seed);
  rng r = {seed + 5};
  int m = rng_below(&r, 21) - 10, n = rng_below(&r, 41) - 20;
  stic_scene scaled = c.scene;
  scale_scene(&scaled, m, n);
  stic_sim *a = open_sim(&c.scene, level, precision, seed),
           *b = a ? open_sim(&scaled, level, precision, seed) : NULL;
  stic_result ra, rb;
  memset(&ra, 0, sizeof ra);
  for (int i = 0; b && i < o->frames; i++) {
    if (i)
      wild_move(&c, &ra);
    stic_sample sa = wild_sample(&c, i), sb = sa;
    for (int k = 0; k < 3; k++)
      sb.position[k] = ldexp(sa.position[k], m);
    if (o->broken && i == o->frames / 2)
      sb.position[1] = nextafter(sb.position[1], -1e300);
    stic_sim_step(a, &sa, &ra);
    stic_sim_step(b, &sb, &rb);
    total.rows++, total.contacts += ra.contact_count;
    const char *different = scaled_difference(&ra, &rb, m, n);
    if (!different)
      continue;
    printf("seed %" PRIu64 " %s %s row %d: scaled by 2^%d m, 2^%d N, %s differs\n", seed, LEVEL_NAMES[level],
           PRECISION_NAMES[precision], i, m, n, different);
    say_replay(o, seed, level, precision, i);
    break;
  }
  total.cases += b != NULL;
  stic_sim_destroy(a);
  stic_sim_destroy(b);
}

/* ---- mirrored and turned scenes: only rounding differs ---- */

typedef struct image {
  bool mirror; /* x changes sign */
  double turn; /* about the origin */
} image;

static void image_point(const image *g, const double from[2], double to[2])
{
  double c = cos(g->turn), s = sin(g->turn), x = g->mirror ? -from[0] : from[0], y = from[1];
  to[0] = c * x - s * y, to[1] = s * x + c * y;
}

static void image_scene(const image *g, const stic_scene *from, stic_scene *to)
{
  *to = *from;
  for (int i = 0; g->mirror && i < from->vertex_count; i++) { /* still counter-clockwise */
    const double *v = from->vertices[from->vertex_count - 1 - i];
    to->vertices[i][0] = -v[0], to->vertices[i][1] = v[1];
  }
  if (g->mirror)
    to->holding_point[0] = -from->holding_point[0];
  for (int i = 0; i < from->surface_count; i++) {
    double deg = from->surfaces[i].normal_deg;
    image_point(g, from->surfaces[i].point, to->surfaces[i].point);
    to->surfaces[i].normal_deg = (g->mirror ? 180 - deg : deg) + g->turn * 180 / STIC_PI;
  }
  double at[2] = {from->x, from->y}, there[2];
  image_point(g, at, there);
  to->x = there[0], to->y = there[1];
  to->angle = (g->mirror ? -from->angle : from->angle) + g->turn;
}

enum { FRAMES_MAX = 4096 };

typedef struct pose {
  double x, y, theta;
} pose;

/* The poses of a fixed path, its image's poses brought back. With `noise`, the hand is off by some ulp. */
static int run_image(const options *o, uint64_t seed, int level, int precision, const image *g,
                     uint64_t noise, pose *poses)
{
  random_case c;
  random_case_init(&c, seed);
  stic_scene scene;
  image_scene(g, &c.scene, &scene);
  stic_sim *sim = open_sim(&scene, level, precision, seed);
  rng r = {seed + 77}, n = {noise};
  if (!sim)
    return 0;
  for (int i = 0; i < o->frames; i++) {
    if (i)
      random_case_move(&c, &r);
    double at[2] = {c.x, c.y}, there[2], phi = (g->mirror ? -c.phi : c.phi) + g->turn;
    image_point(g, at, there);
    if (noise) {
      there[0] += 2e-16 * (rng_below(&n, 9) - 4), there[1] += 2e-16 * (rng_below(&n, 9) - 4);
      phi += 2e-16 * (rng_below(&n, 9) - 4);
    }
    if (o->broken && i >= o->frames / 2) /* the same in every image */
      phi += 1e-4;
    stic_sample sample = {
      (int64_t)i * 32258065, {there[0], there[1], 0}, {0, 0, sin(phi / 2), cos(phi / 2)}, 1, false};
    stic_result res;
    stic_sim_step(sim, &sample, &res);
    total.rows++, total.contacts += res.contact_count;
    image back = {false, -g->turn};
    double p[2] = {res.x, res.y};
    image_point(&back, p, at);
    poses[i].x = g->mirror ? -at[0] : at[0], poses[i].y = at[1];
    poses[i].theta = g->mirror ? -(res.theta - g->turn) : res.theta - g->turn;
  }
  stic_sim_destroy(sim);
  return o->frames;
}

static double pose_difference(const pose *a, const pose *b, double size)
{
  return (hypot(a->x - b->x, a->y - b->y) + 0.1 * fabs(a->theta - b->theta)) / size;
}

static void check_image(const options *o, uint64_t seed, int level, int precision, bool mirror)
{
  static pose a[FRAMES_MAX], b[FRAMES_MAX], d[FRAMES_MAX];
  random_case c;
  random_case_init(&c, seed);
  double size = stic_scene_size(&c.scene);
  rng r = {seed + 9};
  options whole = *o;
  image same = {false, 0},
        g = {mirror, mirror ? 0 : rng_range(&r, -2, 2) /* the first hand angle lies within half a turn */};
  whole.broken = NULL;
  if (!run_image(&whole, seed, level, precision, &same, 0, a) ||
      !run_image(o, seed, level, precision, &g, 0, b))
    return;
  total.cases++;
  double ulp = precision == 0 ? FLT_EPSILON : DBL_EPSILON, allowed = 1e5 * ulp;
  for (int i = 0; i < o->frames; i++) {
    double off = pose_difference(&a[i], &b[i], size);
    if (off <= allowed)
      continue;
    /* An exact tie, or a path that magnifies rounding? Then a hand that is off by some ulp parts from it as well. */
    double parts = 0;
    for (uint64_t n = 1; n <= 12 && parts * 100 < off; n++) {
      /* Walls at exact right angles and faces exactly flush are ties that only another image breaks. */
      image other = {mirror, g.turn + 0.013 * (double)n};
      if (!run_image(&whole, seed, level, precision, &same, n, d))
        break;
      for (int k = 0; k <= i; k++)
        parts = fmax(parts, pose_difference(&a[k], &d[k], size));
      if (mirror || !run_image(o, seed, level, precision, &other, 0, d))
        continue;
      for (int k = 0; k <= i; k++)
        parts = fmax(parts, pose_difference(&b[k], &d[k], size));
    }
    if (parts * 100 >= off) {
      if (o->verbose)
        printf("seed %" PRIu64 " row %d: a tie, %.3g apart, rounding makes %.3g\n", seed, i, off, parts);
      total.ties++;
      return;
    }
    printf("seed %" PRIu64 " %s %s row %d: %.3g sizes from its image, rounding makes %.3g\n", seed,
           LEVEL_NAMES[level], PRECISION_NAMES[precision], i, off, parts);
    say_replay(o, seed, level, precision, i);
    return;
  }
}

/* ---- let go and taken again without moving ---- */

static void check_regrip(const options *o, uint64_t seed, int level, int precision)
{
  wild_case c;
  wild_init(&c, seed);
  c.scene.hold = STIC_HOLD_BUTTON;
  c.scene.reach = 100 * c.size;
  stic_sim *sim = open_sim(&c.scene, level, precision, seed);
  stic_result r;
  memset(&r, 0, sizeof r);
  if (!sim)
    return;
  total.cases++;
  int t = 0;
  for (int i = 0; i < o->frames; i++) {
    if (i)
      wild_move(&c, &r);
    c.buttons = STIC_BUTTON_GRIP;
    stic_sample sample = wild_sample(&c, t++);
    stic_sim_step(sim, &sample, &r);
    if (i % 5)
      continue;
    stic_result before = r, after = r;
    const char *wrong = NULL;
    /* released, still released, taken, held; the hand stands still */
    for (int k = 0; k < 5 && !wrong; k++) {
      sample.t_ns = (int64_t)t++ * 32258065;
      sample.buttons = k < 2 ? 0 : STIC_BUTTON_GRIP;
      if (o->broken && k == 3)
        sample.position[0] += 1e-3 * c.size;
      stic_sim_step(sim, &sample, &after);
      total.rows++, total.contacts += after.contact_count;
      if (k < 2 && after.state != STIC_RELEASED)
        wrong = "not let go";
      else if (after.x != before.x || after.y != before.y || after.theta != before.theta)
        wrong = "moved";
      else if (after.contact_count != before.contact_count)
        wrong = "contacts changed";
      else if (after.slips != before.slips)
        wrong = "a slip was counted";
      for (int n = 0; n < after.contact_count && !wrong; n++)
        if (!stic_same_contact(&after.contacts[n], &before.contacts[n]) ||
            after.contacts[n].x != before.contacts[n].x || after.contacts[n].y != before.contacts[n].y)
          wrong = "an anchor moved";
    }
    r = after;
    if (!wrong)
      continue;
    printf("seed %" PRIu64 " %s %s row %d: %s\n", seed, LEVEL_NAMES[level], PRECISION_NAMES[precision], i,
           wrong);
    if (o->verbose)
      print_row(i, &before), print_row(i, &after);
    say_replay(o, seed, level, precision, i);
    break;
  }
  stic_sim_destroy(sim);
}

/* ---- program ---- */

static int name_index(const char *name, const char *const *names)
{
  for (int i = 0; i < 3; i++)
    if (!strcmp(name, names[i]))
      return i;
  fprintf(stderr, "unknown: %s\n", name);
  exit(2);
}

int main(int argc, char **argv)
{
  options o = {argc > 1 ? argv[1] : "rows", NULL, 1, 40, 60, -1, -1, false};
  for (int i = 2; i < argc; i++) {
    const char *value = i + 1 < argc ? argv[i + 1] : "";
    if (!strcmp(argv[i], "--verbose"))
      o.verbose = true;
    else if (!strcmp(argv[i], "--seed"))
      o.seed = strtoull(value, NULL, 10), i++;
    else if (!strcmp(argv[i], "--count"))
      o.count = strtol(value, NULL, 10), i++;
    else if (!strcmp(argv[i], "--frames"))
      o.frames = atoi(value), i++;
    else if (!strcmp(argv[i], "--level"))
      o.level = name_index(value, LEVEL_NAMES), i++;
    else if (!strcmp(argv[i], "--precision"))
      o.precision = name_index(value, PRECISION_NAMES), i++;
    else if (!strcmp(argv[i], "--break"))
      o.broken = value, i++;
    else
      return fprintf(stderr, "unknown: %s\n", argv[i]), 2;
  }
  if (o.frames < 1 || o.frames > FRAMES_MAX)
    return fprintf(stderr, "--frames from 1 to %d\n", FRAMES_MAX), 2;
  if (o.broken && !strcmp(o.broken, "energy"))
    inside_report.raise = 1e-3;
  for (uint64_t seed = o.seed; seed < o.seed + (uint64_t)o.count && (total.failures < 20 || o.count > 20000);
       seed++)
    for (int level = 0; level < 3; level++)
      for (int precision = 0; precision < 3; precision++) {
        if ((o.level >= 0 && level != o.level) || (o.precision >= 0 && precision != o.precision))
          continue;
        if (!strcmp(o.what, "rows"))
          check_rows(&o, seed, level, precision);
        else if (!strcmp(o.what, "scale"))
          check_scale(&o, seed, level, precision);
        else if (!strcmp(o.what, "mirror"))
          check_image(&o, seed, level, precision, true);
        else if (!strcmp(o.what, "turn"))
          check_image(&o, seed, level, precision, false);
        else if (!strcmp(o.what, "regrip"))
          check_regrip(&o, seed, level, precision);
        else
          return fprintf(stderr, "unknown: %s\n", o.what), 2;
      }
  printf("%s: seeds %" PRIu64 " to %" PRIu64
         ", %ld cases (%ld refused), %ld rows, %ld contacts, %ld rows flagged, %ld ties, %ld failures\n",
         o.what, o.seed, o.seed + (uint64_t)o.count - 1, total.cases, total.refused, total.rows,
         total.contacts, total.flagged, total.ties, total.failures);
  if (!strcmp(o.what, "rows"))
    printf(
      "  worst of what is allowed: depth %.3g, residual %.3g, anchor %.3g, energy %.3g in %ld HOLDs; %ld slides below 1e-12 size; decisions %x\n",
      total.depth, total.residual, total.anchor, inside_report.worst_rise, inside_report.holds, total.tiny,
      inside_report.decisions);
  return total.failures != 0 || total.rows == 0;
}

/* stiction bench validate: closed forms of friction, as a table that anyone can run. Only the public
 * interface is used; each formula is derived where it stands. N is the normal force, F the hand's pull, h the
 * depth by which the hand is pressed below the height of flush contact, so that N = k_p h. */
#include "../../angle.h"
#include "../../error.h"
#include "../../io/outfile.h"
#include "bench.h"
#include "../cli.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ONSET 1e-9 /* when a slip begins: relative error that is ours to meet */

/* ---- table ------------------------------------------------------------------------------- */

typedef struct table {
  stic_outfile *csv; /* NULL: not asked for */
  double spoil;      /* the solver's friction over the formula's: 1, or the table must fail */
  long frames;       /* of the creep rows */
  stic_precision precision;
  bool silent; /* no table, only the counts */
  int rows, failures;
  double worst;       /* largest error of the rows with an exact formula */
  stic_status status; /* of the solver: a scene refused, or no memory */
  stic_error err;
} table;

static double error_of(double expected, double got)
{
  return fabs(got - expected) / (expected != 0 ? fabs(expected) : 1);
}

static void row(table *t, const char *id, const char *what, double expected, double got, double allowed)
{
  const double error = error_of(expected, got);
  const bool pass = error <= allowed; /* not so for NaN */

  t->rows++;
  t->failures += !pass;
  if (allowed <= ONSET) /* else the formula itself is good to no more than that */
    t->worst = fmax(t->worst, error);
  if (!t->silent)
    printf("%-5s %-58s %-16.12g %-16.12g %8.1e %8.1e  %s\n", id, what, expected, got, error, allowed,
           pass ? "pass" : "FAIL");
  if (t->csv)
    stic_outfile_print(t->csv, "%s,\"%s\",%.17g,%.17g,%.17g,%.17g,%s\n", id, what, expected, got, error,
                       allowed, pass ? "pass" : "fail");
}

/* The one of several measurements that is farthest from what is expected; NaN counts as farthest. */
static void keep_worst(double expected, double got, double *worst)
{
  if (!(error_of(expected, got) <= error_of(expected, *worst)))
    *worst = got;
}

/* ---- stand: one simulation, its hand led from place to place ------------------------------- */

typedef struct stand {
  table *t;
  stic_scene scene;
  stic_sim *sim;
  stic_result r;
  double x, y, phi; /* hand */
  int64_t t_ns;
} stand;

static void stand_init(stand *s, table *t, double k_p, double k_theta)
{
  memset(s, 0, sizeof *s);
  s->t = t;
  stic_scene_init(&s->scene);
  s->scene.stiffness = k_p;
  s->scene.rotational_stiffness = k_theta;
}

static void add_surface(stand *s, double x, double y, double normal_deg, double mu_s, double mu_d)
{
  stic_surface *surface = &s->scene.surfaces[s->scene.surface_count++];

  surface->point[0] = x;
  surface->point[1] = y;
  surface->normal_deg = normal_deg;
  surface->friction.mu_static = mu_s * s->t->spoil;
  surface->friction.mu_dynamic = mu_d * s->t->spoil;
}

static void add_vertex(stand *s, double x, double y)
{
  double *v = s->scene.vertices[s->scene.vertex_count++];

  v[0] = x;
  v[1] = y;
}

static void set_pose(stand *s, double x, double y, double angle)
{
  s->scene.x = x;
  s->scene.y = y;
  s->scene.angle = angle;
}

static void start(stand *s)
{
  stic_settings settings;

  stic_settings_init(&settings);
  settings.precision = s->t->precision;
  if (s->t->status == STIC_OK)
    s->t->status = stic_sim_create(&s->scene, &settings, &s->sim, &s->t->err);
}

static void end(stand *s)
{
  stic_sim_destroy(s->sim);
  s->sim = NULL;
}

/* One sample, a second after the last: the times of events are parts of the hand's way. */
static void lead(stand *s, double x, double y, double phi)
{
  const stic_sample sample = {s->t_ns += 1000000000, {x, y, 0}, {0, 0, sin(phi / 2), cos(phi / 2)}, 0, false};

  if (s->sim)
    stic_sim_step(s->sim, &sample, &s->r);
  s->x = x;
  s->y = y;
  s->phi = phi;
}

/* The first event of a kind in the last sample; NULL: none. `*part`: how far the hand was on its way. */
static const stic_event *find_event(const stand *s, stic_event_kind kind, double *part)
{
  int count = 0;
  const stic_event *e = s->sim ? stic_sim_events(s->sim, &count) : NULL;

  for (int i = 0; i < count; i++) {
    if (e[i].kind != kind)
      continue;
    *part = e[i].t - (double)s->t_ns * 1e-9 + 1;
    return &e[i];
  }
  return NULL;
}

/* The number in [low, high] at which `holds` changes from false to true. */
static double find_limit(table *t, bool (*holds)(table *t, double value), double low, double high)
{
  while (t->status == STIC_OK && high - low > 1e-15 * fabs(high)) {
    const double middle = (low + high) / 2;

    if (!(middle > low && middle < high))
      break;
    if (holds(t, middle))
      high = middle;
    else
      low = middle;
  }
  return (low + high) / 2;
}

/* ---- V1 to V4: a box pressed onto a floor and dragged ------------------------------------- */

/* 0.16 x 0.08 m, flat on a floor that is turned by alpha, held at its centre. */
typedef struct floor_box {
  stand s;
  double c, si;
} floor_box;

/* The hand goes to `along` the floor and `height` over it. */
static void lead_box(floor_box *b, double along, double height, double turn)
{
  lead(&b->s, b->c * along - b->si * height, b->si * along + b->c * height, b->s.scene.angle + turn);
}

static void press_box(floor_box *b, table *t, double degrees, double k_p, double mu_s, double mu_d,
                      double depth)
{
  const double alpha = degrees / 180 * STIC_PI;

  stand_init(&b->s, t, k_p, k_p / 400);
  stic_scene_set_box(&b->s.scene, 0.16, 0.08);
  add_surface(&b->s, 0, 0, 90 + degrees, mu_s, mu_d);
  b->c = cos(alpha);
  b->si = sin(alpha);
  set_pose(&b->s, -b->si * 0.05, b->c * 0.05, alpha);
  start(&b->s);
  lead_box(b, 0, 0.05, 0);
  lead_box(b, 0, 0.04 - depth, 0);
}

/* T = k_p (hand's travel) while it sticks and N = k_p h, so it slips when travel / h = mu_s. */
static void stick_limit_of_edge(table *t)
{
  double worst = 0.5, part;
  int wrong = 0;

  for (int i = 0; i < 36; i++) {
    for (int side = -1; side <= 1; side += 2) {
      floor_box b;

      press_box(&b, t, 10 * i - 170, 200, 0.5, 0.3, 0.01);
      lead_box(&b, side * 0.006, 0.03, 0);
      keep_worst(0.5, find_event(&b.s, STIC_EVENT_SLIP, &part) ? part * 0.006 / 0.01 : NAN, &worst);
      end(&b.s);
      for (int over = -1; over <= 1; over += 2) {
        press_box(&b, t, 10 * i - 170, 200, 0.5, 0.3, 0.01);
        lead_box(&b, side * 0.005 * (1 + over * ONSET), 0.03, 0);
        wrong += (b.s.r.slips > 0) != (over > 0);
        end(&b.s);
      }
    }
  }
  row(t, "V1", "edge, 36 floors, both ways: T/N at onset (worst)", 0.5, worst, ONSET);
  row(t, "V1", "sticks 1e-9 below the limit, slips 1e-9 above: wrong", 0, wrong, 0);
}

/* The holding point on the contact vertex: its force is the hand's, at any angle. */
static void stick_limit_of_vertex(table *t)
{
  double worst = 0.7, part;

  for (int side = -1; side <= 1; side += 2) {
    stand s;

    stand_init(&s, t, 200, 0.5);
    stic_scene_set_box(&s.scene, 0.16, 0.08);
    s.scene.holding_point[0] = -0.08;
    s.scene.holding_point[1] = -0.04;
    add_surface(&s, 0, 0, 90, 0.7, 0.2);
    set_pose(&s, 0.08 * cos(0.3) - 0.04 * sin(0.3), 0.08 * sin(0.3) + 0.04 * cos(0.3) + 0.01, 0.3);
    start(&s);
    lead(&s, 0, 0.01, 0.3);
    lead(&s, 0, -0.01, 0.3);
    lead(&s, side * 0.008, -0.01, 0.3);
    keep_worst(0.7, find_event(&s, STIC_EVENT_SLIP, &part) ? part * 0.008 / 0.01 : NAN, &worst);
    end(&s);
  }
  row(t, "V1", "one vertex, both ways: T/N at onset (worst)", 0.7, worst, ONSET);
}

/* Seen at the slips of one drag. */
typedef struct sawtooth {
  int count;
  double first, lag, spacing, force_before, force_after; /* the worst of each */
} sawtooth;

#define DRAG 0.1234
#define DRAG_H 0.01
#define DRAG_S 0.5
#define DRAG_D 0.3

static void drag(table *t, double k_p, int samples, sawtooth *w)
{
  const double jump = (DRAG_S - DRAG_D) * DRAG_H;
  double last = 0;
  floor_box b;

  press_box(&b, t, 0, k_p, DRAG_S, DRAG_D, DRAG_H);
  w->count = 0;
  for (int i = 1; i <= samples && b.s.sim; i++) {
    int events;
    const stic_event *e;

    lead_box(&b, DRAG * i / samples, 0.04 - DRAG_H, 0);
    e = stic_sim_events(b.s.sim, &events);
    for (int n = 0; n < events; n++) {
      const double hand = DRAG * (i + e[n].t - (double)b.s.t_ns * 1e-9) / samples, object = e[n].x + 0.08;

      if (e[n].kind != STIC_EVENT_SLIP || e[n].vertex != 0)
        continue; /* both vertices tell it */
      if (w->count++ == 0)
        keep_worst(DRAG_S * DRAG_H, hand, &w->first);
      else
        keep_worst(jump, hand - last, &w->spacing);
      last = hand;
      keep_worst(DRAG_D * DRAG_H, hand - object, &w->lag);
      keep_worst(DRAG_S, (hand - object + e[n].length) / DRAG_H, &w->force_before);
      keep_worst(DRAG_D, (hand - object) / DRAG_H, &w->force_after);
    }
  }
  end(&b.s);
}

/* It sticks until T = mu_s N, the hand mu_s h ahead, and slides until T = mu_d N, the hand mu_d h ahead: each
 * slip is (mu_s - mu_d) h long and comes when the hand has gone that far again. An undamped mass would swing
 * on to the mirror image about mu_d N and lose twice the force. */
static void stick_slip(table *t)
{
  static const double stiffnesses[] = {1, 200, 31234.5};
  static const int samples[] = {1, 31, 400};
  const double jump = (DRAG_S - DRAG_D) * DRAG_H, force = 200 * DRAG_H;
  sawtooth w = {0, DRAG_S * DRAG_H, DRAG_D * DRAG_H, jump, DRAG_S, DRAG_D};
  const double count = ceil((DRAG - DRAG_S * DRAG_H) / jump);
  double counted = count;

  for (int i = 0; i < 9; i++) {
    drag(t, stiffnesses[i / 3], samples[i % 3], &w);
    keep_worst(count, w.count, &counted);
  }
  row(t, "V2", "lag after a slip, 3 stiffnesses x 3 speeds (worst), m", DRAG_D * DRAG_H, w.lag, ONSET);
  row(t, "V3", "hand's travel at the first slip, m", DRAG_S * DRAG_H, w.first, ONSET);
  row(t, "V3", "hand's travel from slip to slip (worst), m", jump, w.spacing, ONSET);
  row(t, "V3", "slips on a way of 0.1234 m", count, counted, 0);
  row(t, "V3", "T/N when it slips (worst)", DRAG_S, w.force_before, ONSET);
  row(t, "V3", "T/N after it slipped (worst)", DRAG_D, w.force_after, ONSET);
  row(t, "V4", "T lost by a slip, N (an undamped mass: twice that)", (DRAG_S - DRAG_D) * force,
      (w.force_before - w.force_after) * force, ONSET);
}

/* ---- V5: snap-through of a pinned vertex --------------------------------------------------- */

/* A sliver stands on its tip; the hand holds it at a below the tip and is itself d below it. The moment about
 * the tip, theta = u: k_theta (phi - u) - k_p a d sin u, so at rest u + e sin u = phi, e = k_p a d / k_theta. It
 * stands upright at u = upright, and its sides come down a right angle from there. All is turned by SLIVER_TURN, to
 * keep the hand's first angle below pi, where a tracker's begins again at -pi. */
#define SLIVER_A 0.09
#define SLIVER_D 0.12
#define SLIVER_TURN (-0.4)

static void start_sliver(stand *s, table *t, double e, double upright, double u)
{
  const double up = STIC_PI / 2 - upright - SLIVER_TURN;

  stand_init(s, t, 200, 200 * SLIVER_A * SLIVER_D / e);
  add_vertex(s, 0, 0);
  add_vertex(s, 0.1 * cos(up - 0.01), 0.1 * sin(up - 0.01));
  add_vertex(s, 0.1 * cos(up + 0.01), 0.1 * sin(up + 0.01));
  s->scene.holding_point[1] = -SLIVER_A;
  add_surface(s, 0, 0, 90, 1000, 500); /* never slips */
  set_pose(s, 0, 0, u + SLIVER_TURN);
  start(s);
}

static void lead_sliver(stand *s, double phi)
{
  lead(s, SLIVER_D * sin(SLIVER_TURN), -SLIVER_D * cos(SLIVER_TURN), phi + SLIVER_TURN);
}

static double sliver_rests(table *t, double e, double upright, double u, double phi)
{
  double theta;
  stand s;

  start_sliver(&s, t, e, upright, u);
  lead_sliver(&s, phi);
  theta = s.r.theta - SLIVER_TURN;
  end(&s);
  return theta;
}

#define ROOTS_E 1.5
#define ROOTS_PHI 3.1 /* below the fold at 3.4186 */

static bool rests_beyond(table *t, double u)
{
  return sliver_rests(t, ROOTS_E, 3.1, u, ROOTS_PHI) > u;
}

/* The zero of u + e sin u - phi in [low, high], where it changes sign. */
static double kepler_root(double e, double phi, double low, double high)
{
  const bool rising = low + e * sin(low) < phi;

  for (int i = 0; i < 100; i++) {
    const double u = (low + high) / 2;

    if ((u + e * sin(u) < phi) == rising)
      low = u;
    else
      high = u;
  }
  return (low + high) / 2;
}

/* The rest vanishes where d phi / d u = 1 + e cos u = 0: at u = acos(-1/e), phi = acos(-1/e) + sqrt(e^2 - 1). */
static void snap_through(table *t)
{
  static const double es[] = {1.2, 3, 3.6};
  const double fold_15 = acos(-1 / ROOTS_E);
  char what[80];
  int above = 0;

  for (int i = 0; i < 3; i++) {
    const double e = es[i], fold = acos(-1 / e), phi = fold + sqrt(e * e - 1), u = fold - 1.2;
    const double from = u + e * sin(u), to = phi + 0.05;
    double part;
    stand s;

    start_sliver(&s, t, e, fold + 0.2, u);
    lead_sliver(&s, from);
    lead_sliver(&s, to);
    snprintf(what, sizeof what, "hand's angle at the snap, e = %g, rad", e);
    row(t, "V5", what, phi, find_event(&s, STIC_EVENT_SNAP, &part) ? from + part * (to - from) : NAN, ONSET);
    end(&s);
  }
  row(t, "V5", "below the fold: rest reached from below, rad", kepler_root(ROOTS_E, ROOTS_PHI, 1.55, fold_15),
      sliver_rests(t, ROOTS_E, 3.1, fold_15, ROOTS_PHI), 1e-12);
  row(t, "V5", "... from above, rad", kepler_root(ROOTS_E, ROOTS_PHI, 2 * STIC_PI - fold_15, 4.65),
      sliver_rests(t, ROOTS_E, 3.1, 4, ROOTS_PHI), 1e-12);
  row(t, "V5", "... and the unstable one that parts them, rad",
      kepler_root(ROOTS_E, ROOTS_PHI, fold_15, 2 * STIC_PI - fold_15),
      find_limit(t, rests_beyond, fold_15, 4), 1e-12);
  for (double u = 1.9; u < 4.9; u += 0.1)
    above += error_of(kepler_root(ROOTS_E, 3.43, 2 * STIC_PI - fold_15, 4.95),
                      sliver_rests(t, ROOTS_E, 3.4, u, 3.43)) > 1e-12;
  row(t, "V5", "above the fold: starts that end anywhere else", 0, above, 0);
}

/* ---- V6: when sliding is unique ------------------------------------------------------------ */

/* Let r lead from the holding point to the vertex. A contact force (T, N) moves the vertex by C (T, N), C = I/k_p
 * + p p'/k_theta, p = (-r_n, r_t); K of the literature is C^-1. Sliding at T = -sigma mu N keeps the gap closed
 * if N (C_nn - sigma mu C_tn) = depth: one N >= 0 for each depth iff mu < C_nn/|C_tn| = K_tt/|K_tn|. With k_p 500,
 * k_theta 2, r (0.02, -0.08): k_p C_tt = 2.6, k_p C_nn = 1.1, k_p C_tn = 0.4, so the limit is 2.75. Stuck, with the hand
 * X depths aside, (T, N) = K (-X, 1) depth: |T|/N = (1.1 X + 0.4)/(2.6 + 0.4 X) rises to 2.75 and no further: above
 * it nothing ever slips that way. All this to first order in the depth. */
#define DIG_X 1e4

static bool digs_in(table *t, double mu)
{
  const double depth = 1e-10;
  bool stuck;
  stand s;

  stand_init(&s, t, 500, 2);
  add_vertex(&s, 0.02, -0.08);
  add_vertex(&s, 0.04, 0.05);
  add_vertex(&s, -0.02, 0.05);
  add_surface(&s, 0, 0, 90, mu, mu);
  set_pose(&s, -0.02, 0.08, 0);
  start(&s);
  lead(&s, -0.02 + DIG_X * depth, 0.08 - depth, 0);
  stuck = s.r.slips == 0;
  end(&s);
  return stuck;
}

static void unique_sliding(table *t)
{
  row(t, "V6", "friction at which a pull of 10^4 depths sticks (oo: 2.75)",
      (1.1 * DIG_X + 0.4) / (2.6 + 0.4 * DIG_X), find_limit(t, digs_in, 2, 3), 1e-4);
}

/* ---- V7 to V9: a box between two parallel walls -------------------------------------------- */

#define SLOT_D 0.055 /* between the walls */
#define BOX_D 0.05   /* the box across ... */
#define BOX_L 0.03   /* ... and along the slot */

static double slot_angle(void)
{
  return atan2(BOX_L, BOX_D) - acos(SLOT_D / hypot(BOX_L, BOX_D));
}

/* How far the two corners that touch are apart, along the slot. */
static double slot_tip(void)
{
  return BOX_L * cos(slot_angle()) - BOX_D * sin(slot_angle());
}

static void turn_in_slot(stand *s, table *t, double mu_s, double mu_d)
{
  stand_init(s, t, 200, 0.5);
  stic_scene_set_box(&s->scene, BOX_D, BOX_L);
  add_surface(s, -SLOT_D / 2, 0, 0, mu_s, mu_d);
  add_surface(s, SLOT_D / 2, 0, 180, mu_s, mu_d);
  start(s);
  lead(s, 0, 0, 0);
  lead(s, 0, 0, slot_angle() + 0.3);
}

static bool slot_is_wedged(table *t, double mu)
{
  bool wedged;
  stand s;

  turn_in_slot(&s, t, mu, mu / 2);
  wedged = (s.r.flags & STIC_FLAG_WEDGED) != 0;
  end(&s);
  return wedged;
}

static bool slot_holds(table *t, double mu)
{
  bool holds;
  stand s;

  turn_in_slot(&s, t, mu, mu / 2);
  lead(&s, 0, -1, s.phi);
  holds = s.sim && s.r.slips == 0;
  end(&s);
  return holds;
}

/* Both corners slide down when both frictions mu N point up. About the middle of the slot at the lower corner's
 * height, with l the corners' distance along the slot and 2 r the slot's width, the balance of F_x, of F_z
 * (down) and of moments gives M/(r F_z) = lambda - mu (1 + lambda) F_x/F_z, lambda = l/(2 r mu). */
static double jamming_moment(table *t, double fx_over_fz)
{
  const double travel = 0.02;
  double part, k, fx, fz, moment = NAN;
  stand s;

  turn_in_slot(&s, t, 0.2, 0.1);
  k = s.scene.rotational_stiffness * (s.phi - s.r.theta);
  lead(&s, fx_over_fz * travel, -travel, s.phi);
  if (find_event(&s, STIC_EVENT_SLIP, &part)) {
    fx = 200 * travel * part * fx_over_fz;
    fz = 200 * travel * part;
    moment = (k - slot_tip() / 2 * fx) / (SLOT_D / 2 * fz);
  }
  end(&s);
  return moment;
}

/* Two contacts hold every load iff the line through them is inside both cones: slope l_y/D <= mu. The diagonal
 * corners of the box turned by theta are l sin + d cos apart across, l cos - d sin along. */
static void slot(table *t)
{
  static const double ratios[] = {-1, 0, 1};
  const double lambda = slot_tip() / (SLOT_D * 0.2), limit = slot_tip() / SLOT_D;
  char what[80];
  stand s;

  row(t, "V7", "friction from which the slot's contacts are wedged", limit,
      find_limit(t, slot_is_wedged, 0.1, 0.9), ONSET);
  row(t, "V7", "... and from which a pull of 500 times the load holds", limit,
      find_limit(t, slot_holds, 0.1, 0.9), 1e-6);
  for (int i = 0; i < 3; i++) {
    snprintf(what, sizeof what, "two-point line of the jamming diagram, F_x/F_z = %g", ratios[i]);
    row(t, "V8", what, lambda - 0.2 * (1 + lambda) * ratios[i], jamming_moment(t, ratios[i]), ONSET);
  }
  turn_in_slot(&s, t, 0.2, 0.1);
  row(t, "V9", "angle of two-point contact, l sin + d cos = D, rad", slot_angle(), s.r.theta, 1e-12);
  end(&s);
}

/* ---- V11, V12: a ladder -------------------------------------------------------------------- */

typedef struct ladder {
  double mu_1, mu_2, a;
} ladder;

/* Foot on the floor, top on a wall to the right, held at the part a of its length: 0.5 m, without moment. */
static void start_ladder(stand *s, table *t, const ladder *l, double angle)
{
  stand_init(s, t, 200, 0);
  add_vertex(s, 0, 0);
  add_vertex(s, 0.5, 0);
  add_vertex(s, 0.25, 0.01);
  s->scene.holding_point[0] = l->a * 0.5;
  add_surface(s, 0, 0, 90, l->mu_1, l->mu_1 * 0.8);
  add_surface(s, 0, 0, 180, l->mu_2, l->mu_2 * 0.9);
  set_pose(s, -0.5 * cos(angle), 0, angle);
  start(s);
}

/* The hand pulls by (x, y) k_p. */
static void load_ladder(stand *s, double x, double y)
{
  const double reach = s->scene.holding_point[0], angle = s->scene.angle;

  lead(s, s->scene.x + reach * cos(angle) + x, reach * sin(angle) + y, angle);
}

static bool ladder_holds(table *t, const ladder *l, double angle)
{
  bool holds;
  stand s;

  start_ladder(&s, t, l, angle);
  load_ladder(&s, 0, -1);
  holds = s.sim && s.r.slips == 0;
  end(&s);
  return holds;
}

static const ladder LADDERS[] = {{0.3, 0.4, 0.5}, {0.6, 0.2, 0.5}, {0.25, 0, 0.7}};

static bool ladder_0(table *t, double degrees)
{
  return ladder_holds(t, &LADDERS[0], degrees / 180 * STIC_PI);
}
static bool ladder_1(table *t, double degrees)
{
  return ladder_holds(t, &LADDERS[1], degrees / 180 * STIC_PI);
}
static bool ladder_2(table *t, double degrees)
{
  return ladder_holds(t, &LADDERS[2], degrees / 180 * STIC_PI);
}

/* At the limit both contacts are at theirs: N_2 = mu_1 N_1 and N_1 + mu_2 N_2 = W; moments about the foot:
 * W a cos = N_2 sin + mu_2 N_2 cos. */
static void ladder_limit(table *t)
{
  static bool (*const holds[])(table *, double) = {ladder_0, ladder_1, ladder_2};

  for (int i = 0; i < 3; i++) {
    const double m1 = LADDERS[i].mu_1, m2 = LADDERS[i].mu_2, a = LADDERS[i].a;
    char what[80];

    snprintf(what, sizeof what, "ladder holds from, mu %g and %g, load at %g, deg", m1, m2, a);
    row(t, "V11", what, atan((a * (1 + m1 * m2) - m1 * m2) / m1) / STIC_PI * 180,
        find_limit(t, holds[i], 10, 85), ONSET);
  }
}

/* Keeps of [low, high] where a + b x >= 0. */
static void clip(double a, double b, double *low, double *high)
{
  if (b > 0)
    *low = fmax(*low, -a / b);
  else if (b < 0)
    *high = fmin(*high, -a / b);
  else if (a < 0)
    *high = -INFINITY;
}

/* f_1 + f_2 = -(fx, fy), and moments about the foot fix the part of f_2 across the ladder, q; its part x along
 * the ladder is free: all cones are linear in x, so the forces are a segment. The least sum of squares is at
 * x = -(load along the ladder)/2, or at the nearest end. Returns the segment's length. */
static double least_norm(const ladder *l, double angle, double fx, double fy, double forces[4])
{
  const double c = cos(angle), s = sin(angle), q = -l->a * (c * fy - s * fx);
  double low = -INFINITY, high = INFINITY, x;

  /* f_2 = (-q s + x c, q c + x s); N_2 = -f_2x, T_2 = f_2y; N_1 = -fy - f_2y, T_1 = -fx - f_2x */
  for (int way = -1; way <= 1; way += 2) {
    clip(l->mu_2 * q * s + way * q * c, -l->mu_2 * c + way * s, &low, &high);
    clip(l->mu_1 * (-fy - q * c) + way * (-fx + q * s), -l->mu_1 * s - way * c, &low, &high);
  }
  x = fmax(low, fmin(high, -(fx * c + fy * s) / 2));
  forces[2] = q * s - x * c;
  forces[3] = q * c + x * s;
  forces[0] = -fy - forces[3];
  forces[1] = -fx + forces[2];
  return high - low;
}

static void redundant_forces(table *t)
{
  static const ladder l = {0.5, 0.4, 0.4};
  double worst = 0, shortest = INFINITY, moved = 0, x = NAN;
  stand s;

  start_ladder(&s, t, &l, 1.2);
  for (int i = 0; i < 40 && s.sim; i++) {
    const double fx = -0.03 + 0.002 * i, fy = -0.3;
    double want[4], got[4];

    load_ladder(&s, fx, fy);
    shortest = fmin(shortest, least_norm(&l, 1.2, fx, fy, want));
    for (int k = 0; k < 2 && s.r.contact_count == 2; k++) {
      got[2 * k] = s.r.contacts[k].normal / 200;
      got[2 * k + 1] = s.r.contacts[k].friction / 200;
    }
    for (int k = 0; k < 4; k++)
      keep_worst(0, s.r.contact_count == 2 ? (got[k] - want[k]) / 0.3 : NAN, &worst);
    x = i == 0 ? s.r.x : x;
    moved = fmax(moved, fabs(s.r.x - x));
  }
  end(&s);
  row(t, "V12", "inside V11 the forces are a segment: shortest > 0", 1, shortest > 0, 0);
  row(t, "V12", "reported forces minus the least-norm ones, of the load", 0, worst, 1e-10);
  row(t, "V12", "the choice of forces moves the object by, m", 0, moved, 0);
}

/* ---- V13, V14: an edge that tips ------------------------------------------------------------ */

#define PUSH_HEIGHT 0.08
#define HALF_WIDTH 0.04

/* Pushed at the height h_p, with N over the middle of the base 2 b: the centre of pressure is T h_p/N from the
 * middle. It tips when that is b, and slips when T = mu N: tips iff mu > b/h_p. */
static bool tips(table *t, double mu)
{
  bool opened = false;
  const stic_event *e;
  int count = 0;
  stand s;

  stand_init(&s, t, 200, 0);
  stic_scene_set_box(&s.scene, 2 * HALF_WIDTH, 0.12);
  s.scene.holding_point[1] = PUSH_HEIGHT - 0.06;
  add_surface(&s, 0, 0, 90, mu, mu / 2);
  set_pose(&s, 0, 0.06, 0);
  start(&s);
  lead(&s, 0, PUSH_HEIGHT, 0);
  lead(&s, 0, PUSH_HEIGHT - 0.05, 0);
  lead(&s, 0.05 * 0.5 * 1.0001, PUSH_HEIGHT - 0.05, 0);
  e = s.sim ? stic_sim_events(s.sim, &count) : NULL;
  for (int i = count - 1; i >= 0; i--) { /* which came first */
    if (e[i].kind == STIC_EVENT_OPEN || e[i].kind == STIC_EVENT_SLIP)
      opened = e[i].kind == STIC_EVENT_OPEN;
  }
  end(&s);
  return opened;
}

/* Turned by phi, the spring's moment k_theta phi takes the centre of pressure to k_theta phi/N from below the
 * holding point, which is over b_x: it reaches the edge's end b - b_x or b + b_x away, and the edge opens. The
 * forces N_1, N_2 split the load as the lever arms say. */
static void centre_of_pressure(table *t)
{
  const double b = 0.08, bx = 0.03, depth = 0.02, k_theta = 2;
  char what[80];

  for (int side = -1; side <= 1; side += 2) {
    const double phi = side * 200 * depth * (b + side * bx) / k_theta;
    double part;
    stand s;

    stand_init(&s, t, 200, k_theta);
    stic_scene_set_box(&s.scene, 2 * b, 0.08);
    s.scene.holding_point[0] = bx;
    add_surface(&s, 0, 0, 90, 0.5, 0.3);
    set_pose(&s, 0, 0.04, 0);
    start(&s);
    lead(&s, bx, 0.04, 0);
    lead(&s, bx, 0.04 - depth, 0);
    if (side < 0)
      row(t, "V14", "share of the left vertex in N", (b - bx) / (2 * b),
          s.r.contacts[0].normal / (200 * depth), 1e-12);
    lead(&s, bx, 0.04 - depth, 1.3 * phi);
    snprintf(what, sizeof what, "hand's angle at which the %s end opens, rad", side > 0 ? "right" : "left");
    row(t, "V14", what, phi, find_event(&s, STIC_EVENT_OPEN, &part) ? 1.3 * phi * part : NAN, ONSET);
    end(&s);
  }
}

/* ---- creep --------------------------------------------------------------------------------- */

static double tremor(long i, double hz)
{
  return sin(2 * STIC_PI * hz * (double)i / 31);
}

/* How far the box goes in all frames, loaded by a part of its friction limit; `shake` adds a hand's tremor that
 * stays within it. */
static double creep_of_edge(table *t, double load, double shake)
{
  double x, y, theta, farthest = 0;
  floor_box b;

  press_box(&b, t, 0, 200, 0.5, 0.3, 0.01);
  lead_box(&b, load * 0.005, 0.03, 0);
  x = b.s.r.x;
  y = b.s.r.y;
  theta = b.s.r.theta;
  for (long i = 0; i < t->frames && b.s.sim && stic_cli_signal() == 0; i++) {
    lead_box(&b, 0.005 * (load - 0.1 * shake + 0.05 * shake * tremor(i, 9.3)),
             0.03 + 2e-4 * shake * tremor(i, 10.7), 0.002 * shake * tremor(i, 8.1));
    farthest = fmax(farthest, fabs(b.s.r.x - x) + fabs(b.s.r.y - y) + fabs(b.s.r.theta - theta));
  }
  end(&b.s);
  return farthest;
}

/* On one vertex the box rocks with the hand, but the vertex stays. */
static double creep_of_vertex(table *t)
{
  const double phi = 0.5, height = 0.08 * sin(phi) + 0.04 * cos(phi);
  double x = NAN, farthest = 0;
  stand s;

  stand_init(&s, t, 200, 5);
  stic_scene_set_box(&s.scene, 0.16, 0.08);
  add_surface(&s, 0, 0, 90, 0.5, 0.3);
  set_pose(&s, 0, height + 0.01, phi);
  start(&s);
  lead(&s, 0, height + 0.01, phi);
  for (long i = 0; i < t->frames && s.sim && stic_cli_signal() == 0; i++) {
    lead(&s, 2e-4 * tremor(i, 9.3), height - 0.01 + 2e-4 * tremor(i, 10.7), phi + 0.01 * tremor(i, 8.1));
    if (i == 0)
      x = s.r.contacts[0].x;
    keep_worst(0, s.r.contact_count == 1 ? s.r.contacts[0].x - x : NAN, &farthest);
  }
  end(&s);
  return farthest;
}

static void creep(table *t)
{
  char what[80];

  snprintf(what, sizeof what, "creep in %ld frames at 50 %% of the limit, m", t->frames);
  row(t, "creep", what, 0, creep_of_edge(t, 0.5, 0), 0);
  row(t, "creep", "... at 95 % of the limit, m", 0, creep_of_edge(t, 0.95, 0), 0);
  row(t, "creep", "... with tremor, up to 92 % of the limit, m", 0, creep_of_edge(t, 0.95, 1), 0);
  row(t, "creep", "... of a vertex on which the box rocks with tremor, m", 0, creep_of_vertex(t), 0);
}

/* -------------------------------------------------------------------------------------------- */

static const char left_out[] =
  "Left out, as surfaces here are planes without end and the statics is planar:\n"
  "  V1   in three dimensions; here the floor is turned instead\n"
  "  V7-9 with the rim of a hole against a peg's side; two corners of a box between two walls obey the\n"
  "       same formulas. Of the jamming diagram the two-point lines; its upright sides are V1.\n";

static void all_rows(table *t)
{
  if (!t->silent)
    printf("%-5s %-58s %-16s %-16s %8s %8s\n", "case", "what", "expected", "got", "error", "allowed");
  stick_limit_of_edge(t);
  stick_limit_of_vertex(t);
  stick_slip(t);
  snap_through(t);
  unique_sliding(t);
  slot(t);
  ladder_limit(t);
  redundant_forces(t);
  row(t, "V13", "friction from which a pushed box tips: b/h_p", HALF_WIDTH / PUSH_HEIGHT,
      find_limit(t, tips, 0.3, 0.7), ONSET);
  centre_of_pressure(t);
  creep(t);
}

stic_status stic_closed_forms(stic_precision precision, stic_closed_form_result *result, stic_error *err)
{
  table t = {.spoil = 1, .frames = 100, .precision = precision, .silent = true, .status = STIC_OK};

  all_rows(&t);
  *result = (stic_closed_form_result){t.rows, t.rows - t.failures, t.worst};
  if (t.status != STIC_OK)
    *err = t.err;
  return t.status;
}

int stic_bench_validate(bool quick, const char *csv, double spoil)
{
  table t = {.spoil = spoil, .frames = quick ? 1000 : 100000, .precision = STIC_F64, .status = STIC_OK};

  if (csv && stic_outfile_open(csv, &t.csv, &t.err) != STIC_OK)
    return stic_cli_fail(&t.err);
  printf("stiction %s, level event, f64; error: relative, absolute where 0 is expected\n", stic_version());
  if (t.csv)
    stic_outfile_print(t.csv, "case,what,expected,got,error,allowed,pass\n");
  all_rows(&t);
  printf("%d of %d rows pass\n%s", t.rows - t.failures, t.rows, left_out);
  if (stic_cli_signal() != 0 || t.status != STIC_OK) {
    stic_outfile_abort(t.csv);
    return t.status != STIC_OK ? stic_cli_fail(&t.err) : STIC_EXIT_SIGNAL + stic_cli_signal();
  }
  if (t.csv && stic_outfile_commit(t.csv, &t.err) != STIC_OK)
    return stic_cli_fail(&t.err);
  return t.failures > 0 ? STIC_FAILED : STIC_OK;
}

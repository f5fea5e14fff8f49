/* Checks the oracle against closed forms and the invariants of the model. Prints what differs; 0 = all right. */
#include "oracle.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures;
static unsigned seen_rules;

static void expect(const char *what, double got, double want, double tol)
{
  if (!(fabs(got - want) <= tol)) {
    printf("FAIL %s: got %.15g, expected %.15g (+- %g)\n", what, got, want, tol);
    failures++;
  }
}

static void expect_true(const char *what, int ok)
{
  if (!ok) {
    printf("FAIL %s\n", what);
    failures++;
  }
}

/* ---- scenes ---- */

static const double PI = 3.14159265358979323846;

static void add_surface(orc_scene *sc, double x, double y, double normal_deg, double ms, double md)
{
  orc_surface *s = &sc->s[sc->ns++];
  s->point[0] = x;
  s->point[1] = y;
  s->normal[0] = cos(normal_deg * PI / 180);
  s->normal[1] = sin(normal_deg * PI / 180);
  if (fabs(s->normal[0]) < 1e-15)
    s->normal[0] = 0;
  if (fabs(s->normal[1]) < 1e-15)
    s->normal[1] = 0;
  s->mu_s = ms;
  s->mu_d = md;
}

static void add_vertex(orc_scene *sc, double x, double y)
{
  sc->v[sc->nv][0] = x;
  sc->v[sc->nv][1] = y;
  sc->nv++;
}

static void box(orc_scene *sc, double w, double h, double kp, double kt)
{
  memset(sc, 0, sizeof *sc);
  add_vertex(sc, -w / 2, -h / 2);
  add_vertex(sc, w / 2, -h / 2);
  add_vertex(sc, w / 2, h / 2);
  add_vertex(sc, -w / 2, h / 2);
  sc->k_p = kp;
  sc->k_theta = kt;
}

static void hold_point(const orc_scene *sc, const orc_state *st, double g[2])
{
  double c = cos(st->theta), s = sin(st->theta);
  g[0] = st->x + c * sc->hold[0] - s * sc->hold[1];
  g[1] = st->y + s * sc->hold[0] + c * sc->hold[1];
}

static void vertex(const orc_scene *sc, const orc_state *st, int v, double w[2])
{
  double c = cos(st->theta), s = sin(st->theta);
  w[0] = st->x + c * sc->v[v][0] - s * sc->v[v][1];
  w[1] = st->y + s * sc->v[v][0] + c * sc->v[v][1];
}

/* ---- closed forms ---- */

static void slip_end_point(void)
{
  int k;
  for (k = 0; k < 2; k++) {
    double sigma = k ? -1 : 1, phi = 0.35, y0 = 0.08 * sin(phi) + 0.04 * cos(phi), g[2], n;
    orc_scene sc;
    orc_state st;
    orc_report rep;
    box(&sc, 0.16, 0.08, 200, 0.5);
    add_surface(&sc, 0, 0, 90, 0.5, 0.3);
    memset(&rep, 0, sizeof rep);
    orc_init(&sc, &st, 0, y0 + 0.01, phi);
    orc_relax(&sc, &st, sigma * 0.10, y0 - 0.02, phi, &rep);
    hold_point(&sc, &st, g);
    n = sc.k_p * (g[1] - (y0 - 0.02));
    expect("slip end point theta", st.theta, k ? 0.170537983664 : 0.141425757103, 1e-11);
    expect("slip end point N", n, k ? 1.59800308252 : 1.17405813711, 2e-10);
    expect("slip end point T", sc.k_p * (sigma * 0.10 - g[0]), sigma * 0.3 * n, 1e-12);
    expect_true("slip end point: rule 1", (rep.rules & ORC_R_1_SLIDE) != 0);
    expect("slip end point: slips", rep.slips, 1, 0);
  }
}

/* V2, V3: edge drag. Also the jump of the object at each slip and force levels. */
static void sawtooth(void)
{
  const double h = 0.01, ms = 0.5, md = 0.3, travel = 0.1234;
  const int samples[3] = {1, 31, 400};
  int k, i;
  for (k = 0; k < 3; k++) {
    orc_scene sc;
    orc_state st;
    orc_report rep;
    double lag_max = 0, last;
    int count;
    box(&sc, 0.16, 0.08, 200, 0.5);
    add_surface(&sc, 0, 0, 90, ms, md);
    memset(&rep, 0, sizeof rep);
    orc_init(&sc, &st, 0, 0.04, 0);
    orc_relax(&sc, &st, 0, 0.04 - h, 0, &rep);
    expect("V3 pressed flat: contacts", st.nc, 2, 0);
    memset(&rep, 0, sizeof rep);
    last = st.x;
    for (i = 0; i < samples[k]; i++) {
      double a = travel * i / samples[k], b = travel * (i + 1) / samples[k], steps, jump = (ms - md) * h;
      orc_move_event(&sc, &st, a, 0.04 - h, 0, b, 0.04 - h, 0, &rep);
      if (b - st.x > lag_max)
        lag_max = b - st.x;
      steps = (st.x - last) / jump;
      /* each slip starts late by the rounding margin of the events: 1e-12 of the interval and of size */
      expect("V3 object moves by whole slips", steps, floor(steps + 0.5), 1e-6);
      last = st.x;
    }
    count = (int)ceil((travel - ms * h) / ((ms - md) * h));
    expect("V3 count of slips", rep.slips, count, 0);
    expect("V3 final place", st.x, count * (ms - md) * h, 1e-9);
    expect_true("V3 lag never above mu_s h", lag_max <= ms * h + 1e-11);
    expect_true("V3 lag never below mu_d h", samples[k] == 1 || lag_max >= md * h);
    expect_true("V3 rule 2", (rep.rules & ORC_R_2_EDGE) != 0);
  }
}

/* V2 at the end of a single slip: lag = mu_d h, for a vertex and an edge, whatever k_p is. */
static void lag_after_slip(void)
{
  double kp;
  for (kp = 50; kp <= 800; kp *= 4) {
    orc_scene sc;
    orc_state st;
    orc_report rep;
    memset(&rep, 0, sizeof rep);
    box(&sc, 0.16, 0.08, kp, 0.5);
    add_surface(&sc, 0, 0, 90, 0.5, 0.3);
    orc_init(&sc, &st, 0, 0.04, 0);
    orc_relax(&sc, &st, 0, 0.03, 0, &rep);
    orc_move_event(&sc, &st, 0, 0.03, 0, 0.00500001, 0.03, 0, &rep);
    expect("V2 lag", 0.00500001 - st.x, 0.3 * 0.01, 2e-8);
  }
}

/* V5: the pinned vertex snaps at M*. */
static void snap_through(void)
{
  const double e = 3, a = 0.09, d = 0.12, kp = 200, want = acos(-1 / e) + sqrt(e * e - 1);
  int k;
  expect("V5 formula", want, 4.739060360995, 1e-12);
  for (k = -1; k <= 1; k += 2) {
    /* thin sliver, held below its tip; the hand below the floor pulls it on */
    orc_scene sc;
    orc_state st;
    orc_report rep;
    double u0 = 1.0, u1, M;
    memset(&sc, 0, sizeof sc);
    memset(&rep, 0, sizeof rep);
    /* body angle 0 = tip-to-hold vector straight down; the sliver stands straight up at angle 1.5 */
    add_vertex(&sc, 0, 0);
    add_vertex(&sc, 0.1 * cos(PI / 2 - 1.5 - 0.01), 0.1 * sin(PI / 2 - 1.5 - 0.01));
    add_vertex(&sc, 0.1 * cos(PI / 2 - 1.5 + 0.01), 0.1 * sin(PI / 2 - 1.5 + 0.01));
    sc.hold[1] = -a;
    sc.k_p = kp;
    sc.k_theta = kp * a * d / e;
    add_surface(&sc, 0, 0, 90, 1000, 500);
    orc_init(&sc, &st, 0, 0, u0);
    expect("V5 starts on its tip", st.nc, 1, 0);
    M = u0 + e * sin(u0);
    orc_relax(&sc, &st, 0, -d, M, &rep);
    expect("V5 first equilibrium", st.theta, u0, 1e-12);
    memset(&rep, 0, sizeof rep);
    orc_move_event(&sc, &st, 0, -d, M, 0, -d, want + k * 1e-9, &rep);
    u1 = st.theta;
    expect_true(k < 0 ? "V5 no snap before M*" : "V5 snap after M*", !(rep.rules & ORC_R_SNAP) == (k < 0));
    expect_true("V5 place at M*", k < 0 ? fabs(u1 - acos(-1 / e)) < 1e-3 : u1 > acos(-1 / e) + 0.1);
  }
}

/* V11: the ladder. */
static void ladder(void)
{
  const double want = 55.7131, exact = atan((0.5 * (1 + 0.12) - 0.12) / 0.3) * 180 / PI;
  int k;
  expect("V11 formula", exact, want, 1e-4);
  for (k = -1; k <= 1; k += 2) {
    orc_scene sc;
    orc_state st;
    double deg = (exact + k * 1e-7) * PI / 180, l = 0.5, g[2];
    memset(&sc, 0, sizeof sc);
    /* along the body x axis: foot at 0, top at l, a third vertex above it */
    add_vertex(&sc, 0, 0);
    add_vertex(&sc, l, 0);
    add_vertex(&sc, l / 2, 0.01);
    sc.hold[0] = l / 2;
    sc.k_p = 200;
    sc.k_theta = 0;
    add_surface(&sc, 0, 0, 90, 0.3, 0.3);
    add_surface(&sc, 0, 0, 180, 0.4, 0.4);
    orc_init(&sc, &st, -l * cos(deg), 0, deg);
    expect("V11 contacts", st.nc, 2, 0);
    hold_point(&sc, &st, g);
    expect("V11 holds", orc_forces_exist(&sc, &st, g[0], g[1] - 0.05, 0), k > 0, 0);
  }
}

/* V13: a box pushed at height h_p tips iff mu > b/h_p. */
static void tip_or_slide(void)
{
  int k;
  for (k = 0; k < 2; k++) {
    orc_scene sc;
    orc_state st;
    orc_report rep;
    double mu = k ? 0.5001 : 0.4999, d = 0.01;
    memset(&rep, 0, sizeof rep);
    box(&sc, 0.08, 0.12, 200, 0.0);
    sc.hold[1] = 0.02; /* h_p = 0.08, b = 0.04 */
    add_surface(&sc, 0, 0, 90, mu, 0.3);
    orc_init(&sc, &st, 0, 0.06, 0);
    orc_relax(&sc, &st, 0, 0.08 - d, 0, &rep);
    memset(&rep, 0, sizeof rep);
    orc_move_event(&sc, &st, 0, 0.08 - d, 0, 0.50005 * d, 0.08 - d, 0, &rep);
    if (k) {
      expect_true("V13 tips", st.nc == 1 && st.theta < 0 && rep.slips == 0);
    } else {
      expect_true("V13 slides", st.nc == 2 && rep.slips == 1 && (rep.rules & ORC_R_2_EDGE));
    }
  }
}

/* mu_s = mu_d: at every sample the edge lags by mu h, then sticks on the way back. */
static void equal_friction(void)
{
  orc_scene sc;
  orc_state st;
  orc_report rep;
  double h = 0.01, mu = 0.4;
  int i;
  memset(&rep, 0, sizeof rep);
  box(&sc, 0.16, 0.08, 200, 0.5);
  add_surface(&sc, 0, 0, 90, mu, mu);
  orc_init(&sc, &st, 0, 0.04, 0);
  orc_relax(&sc, &st, 0, 0.04 - h, 0, &rep);
  memset(&rep, 0, sizeof rep);
  for (i = 0; i < 20; i++) {
    double a = 0.002 * i, b = 0.002 * (i + 1);
    orc_move_event(&sc, &st, a, 0.04 - h, 0, b, 0.04 - h, 0, &rep);
    if (i > 1)
      expect("mu_s = mu_d: lag", b - st.x, mu * h, 1e-12);
  }
  expect("mu_s = mu_d: slips", rep.slips, 18, 0);
  orc_move_event(&sc, &st, 0.04, 0.04 - h, 0, 0.039, 0.04 - h, 0, &rep);
  expect("mu_s = mu_d: sticks on the way back", st.x, 0.036, 1e-12);
  expect_true("mu_s = mu_d: rules", (rep.rules & ORC_R_GOES_ON) && (rep.rules & ORC_R_STICK));
  expect("mu_s = mu_d: slips", rep.slips, 18, 0);
}

/* A vertex that dips into the floor and out again within one step of the angle, and one that just does not. */
static void double_event(void)
{
  int k, event;
  for (k = -1; k <= 1; k += 2)
    for (event = 0; event < 2; event++) {
      orc_scene sc;
      orc_state st;
      orc_report rep;
      double y = 0.1 - k * 1e-9;
      memset(&sc, 0, sizeof sc);
      memset(&rep, 0, sizeof rep);
      add_vertex(&sc, 0, -0.1);
      add_vertex(&sc, 0.05, 0);
      add_vertex(&sc, -0.05, 0);
      sc.k_p = 200;
      sc.k_theta = 0.5;
      add_surface(&sc, 0, 0, 90, 0.5, 0.3);
      orc_init(&sc, &st, 0, y, -0.0007);
      orc_relax(&sc, &st, 0, y, -0.0007, &rep);
      if (event)
        orc_move_event(&sc, &st, 0, y, -0.0007, 0, y, 0.0008, &rep);
      else
        orc_move_frame(&sc, &st, 0, y, 0.0008, &rep);
      expect("dip within a step: touches", rep.touches, k > 0, 0);
    }
}

/* A vertex stuck while the hand at h = (0, -d) turns the object, held below its tip: |T|/N has its greatest value where
 * the line from h is tangent to the circle of the holding point. A friction limit just below it is passed, and met
 * again, within one step. */
static void short_slip(void)
{
  const double a = 0.09, d = 0.12, top = (a / d) / sqrt(1 - a * a / d / d);
  int k;
  for (k = -1; k <= 1; k += 2) {
    orc_scene sc;
    orc_state st;
    orc_report rep;
    memset(&sc, 0, sizeof sc);
    memset(&rep, 0, sizeof rep);
    add_vertex(&sc, 0, 0);
    add_vertex(&sc, 0.1 * cos(PI / 2 - 0.55), 0.1 * sin(PI / 2 - 0.55));
    add_vertex(&sc, 0.1 * cos(PI / 2 - 0.45), 0.1 * sin(PI / 2 - 0.45));
    sc.hold[1] = -a;
    sc.k_p = 200;
    sc.k_theta = 5;
    add_surface(&sc, 0, 0, 90, top + k * 1e-9, 0.5);
    orc_init(&sc, &st, 0, 0, 0);
    orc_relax(&sc, &st, 0, -d, 0, &rep);
    expect("short slip: starts stuck", rep.slips, 0, 0);
    orc_move_event(&sc, &st, 0, -d, 0, 0, -d, 1.4, &rep);
    expect("short slip: slips", rep.slips > 0, k < 0, 0);
    expect_true("short slip: found by its minimum", (k < 0) == ((rep.rules & ORC_R_DOUBLE) != 0));
    seen_rules |= rep.rules;
  }
}

/* A box turned in a slot slides along it: N from the moment, friction at both walls. */
static void slot(void)
{
  int k;
  for (k = 0; k < 2; k++) {
    orc_scene sc;
    orc_state st;
    orc_report rep;
    double th = 0.3, rx = 0.08 * cos(0.3) - 0.03 * sin(0.3), ry = 0.08 * sin(0.3) + 0.03 * cos(0.3), n, pull;
    box(&sc, 0.16, 0.06, 200, 0.5);
    add_surface(&sc, 0, -ry, 90, 0.4, 0.25);
    add_surface(&sc, 0, ry, 270, 0.4, 0.25);
    memset(&rep, 0, sizeof rep);
    orc_init(&sc, &st, 0, 0, th);
    expect("slot: contacts", st.nc, 2, 0);
    n = 0.5 * 0.2 / (2 * rx); /* phi - theta = 0.2 */
    pull = 2 * 0.4 * n / sc.k_p;
    if (k) {
      pull += 1e-6;
      orc_relax(&sc, &st, -pull, 0, th + 0.2, &rep);
      expect("slot: place after the slide", st.x, -pull + 2 * 0.25 * n / sc.k_p, 1e-14);
      expect_true("slot: rule 2", (rep.rules & ORC_R_2_PARALLEL) && rep.slips == 1 && st.nc == 2);
    } else {
      orc_relax(&sc, &st, -(pull - 1e-6), 0, th + 0.2, &rep);
      expect("slot: holds", rep.slips, 0, 0);
    }
    seen_rules |= rep.rules;
  }
}

/* A ladder slips down: at the end both frictions are at mu_d, against the motion, and all balances. */
static void trammel_end(void)
{
  orc_scene sc;
  orc_state st;
  orc_report rep;
  double l = 0.5, th = 0.7, hx, hy, g[2], f[2], n1, n2, m, w0[2], w1[2], t1, t2;
  memset(&rep, 0, sizeof rep);
  memset(&sc, 0, sizeof sc);
  add_vertex(&sc, 0, 0);
  add_vertex(&sc, l, 0);
  add_vertex(&sc, l / 2, 0.01);
  sc.hold[0] = 0.6 * l;
  sc.k_p = 200;
  sc.k_theta = 0.5;
  add_surface(&sc, 0, 0, 90, 0.3, 0.2);
  add_surface(&sc, 0, 0, 180, 0.4, 0.1);
  orc_init(&sc, &st, -l * cos(th), 0, th);
  hold_point(&sc, &st, g);
  hx = g[0];
  hy = g[1] - 0.05;
  orc_relax(&sc, &st, hx, hy, th, &rep);
  expect("trammel: contacts", st.nc, 2, 0);
  expect_true("trammel: rule 2, one slip",
              (rep.rules & ORC_R_2_TRAMMEL) && rep.slips == 1 && st.theta < th - 0.01);
  hold_point(&sc, &st, g);
  vertex(&sc, &st, 0, w0);
  vertex(&sc, &st, 1, w1);
  f[0] = sc.k_p * (hx - g[0]);
  f[1] = sc.k_p * (hy - g[1]);
  /* foot goes to -x, friction +x; top goes down, friction up: f_x + 0.2 n1 - n2 = 0, f_y + n1 + 0.1 n2 = 0 */
  n1 = (-f[1] - 0.1 * f[0]) / (1 + 0.2 * 0.1);
  n2 = f[0] + 0.2 * n1;
  t1 = 0.2 * n1;
  t2 = 0.1 * n2;
  m = sc.k_theta * (th - st.theta) + (w0[0] - g[0]) * n1 - (w0[1] - g[1]) * t1 + (w1[0] - g[0]) * t2 +
      (w1[1] - g[1]) * n2;
  expect_true("trammel: N > 0", n1 > 0 && n2 > 0);
  expect("trammel: moment at the end", m, 0, 1e-13);
  seen_rules |= rep.rules;
}

/* A vertex pulled straight out of a corner leaves both surfaces and goes to the hand. */
static void out_of_corner(void)
{
  orc_scene sc;
  orc_state st;
  orc_report rep;
  double r = 0.08;
  memset(&rep, 0, sizeof rep);
  memset(&sc, 0, sizeof sc);
  add_vertex(&sc, 0, 0);
  add_vertex(&sc, r, 0.3 * r);
  add_vertex(&sc, 0.3 * r, r);
  sc.hold[0] = sc.hold[1] = 0.04;
  sc.k_p = 200;
  sc.k_theta = 0.5;
  add_surface(&sc, 0, 0, 90, 0.5, 0.3);
  add_surface(&sc, 0, 0, 0, 0.5, 0.3);
  orc_init(&sc, &st, 0, 0, 0);
  expect("corner: contacts", st.nc, 2, 0);
  orc_relax(&sc, &st, 0.03, 0.03, 0, &rep);
  expect("corner: held", st.nc, 2, 0);
  orc_relax(&sc, &st, 0.06, 0.06, 0.1, &rep);
  expect("corner: free", st.nc, 0, 0);
  expect("corner: angle", st.theta, 0.1, 1e-15);
  expect_true("corner: rule 3, all", (rep.rules & ORC_R_3_ALL) && rep.opens == 2);
  seen_rules |= rep.rules;
}

/* ---- random scenes: invariants, and the answer against a refinement of itself ---- */

static uint64_t seed;

static double uniform(double lo, double hi)
{
  seed ^= seed << 13;
  seed ^= seed >> 7;
  seed ^= seed << 17;
  return lo + (hi - lo) * (double)(seed >> 11) / 9007199254740992.0;
}

static void random_scene(orc_scene *sc, int n)
{
  static const double ktheta[6] = {0.5, 0.5, 2, 0.05, 0, 0.2};
  int i, kind = n % 6, poly = n % 5 == 4;
  double ms = uniform(0.1, 0.9), md = ms * uniform(0.2, 0.98);
  if (n % 7 == 6)
    md = ms;
  if (n % 23 == 22)
    ms = md = 0;
  box(sc, uniform(0.08, 0.2), uniform(0.05, 0.12), uniform(50, 500), ktheta[n / 6 % 6]);
  if (poly) {
    int m = 3 + n % 4;
    sc->nv = 0;
    for (i = 0; i < m; i++) {
      double a = 2 * PI * (i + uniform(0.1, 0.6)) / m;
      add_vertex(sc, 0.09 * cos(a), 0.07 * sin(a));
    }
  }
  sc->hold[0] = uniform(-0.03, 0.03);
  sc->hold[1] = uniform(-0.02, 0.02);
  add_surface(sc, 0, 0, 90, ms, md);
  if (kind == 1)
    add_surface(sc, 0, 0, 0, ms * 0.8, n % 7 == 6 ? ms * 0.8 : md * 0.7);
  if (kind == 2 && n % 4)
    add_surface(sc, -0.2, 0, -uniform(15, 50), ms, md); /* acute */
  if (kind == 2 && n % 4 == 0)
    add_surface(sc, 0, 0, uniform(20, 70), ms, md);
  if (kind == 3) {
    add_surface(sc, 0, 0, 0, ms, md);
    add_surface(sc, 0.45, 0, 180, ms, md);
  }
  if (kind == 4) {
    add_surface(sc, 0, 0.22, 270, ms, md); /* a slot */
    add_surface(sc, 0, 0, 0, ms, md);
  }
  if (kind == 5)
    add_surface(sc, 0.35, 0, uniform(95, 130), ms * 0.9, n % 7 == 6 ? ms * 0.9 : md * 0.8);
}

typedef struct {
  double worst_depth, worst_rise, worst_apart[2];
  long frames, unfinished, flows, compared, apart[2];
} tally;

static void check_frame(const char *level, int n, int f, const orc_scene *sc, const orc_state *st,
                        const double h[3], const orc_report *was, const orc_report *rep, tally *t)
{
  int i, j;
  double w[2];
  for (i = 0; i < sc->nv; i++)
    for (j = 0; j < sc->ns; j++) {
      double depth;
      vertex(sc, st, i, w);
      depth =
        -((w[0] - sc->s[j].point[0]) * sc->s[j].normal[0] + (w[1] - sc->s[j].point[1]) * sc->s[j].normal[1]);
      if (depth > t->worst_depth)
        t->worst_depth = depth;
      if (depth > 1e-14) {
        printf("FAIL %s scene %d frame %d: vertex %d is %g below surface %d\n", level, n, f, i, depth, j);
        failures++;
      }
    }
  for (i = 0; i < st->nc; i++) {
    vertex(sc, st, st->c[i].vertex, w);
    if (fabs(w[0] - st->c[i].place[0]) + fabs(w[1] - st->c[i].place[1]) > 1e-14) {
      printf("FAIL %s scene %d frame %d: contact %d left its anchor\n", level, n, f, i);
      failures++;
    }
  }
  if (rep->no_answer != was->no_answer || rep->limit != was->limit) {
    t->unfinished++;
  } else if (!orc_forces_exist(sc, st, h[0], h[1], h[2])) {
    printf("FAIL %s scene %d frame %d: no balance inside the cones at rest\n", level, n, f);
    failures++;
  }
  if (rep->hold_rise > t->worst_rise)
    t->worst_rise = rep->hold_rise;
  if (rep->hold_rise > 1e-15) {
    printf("FAIL %s scene %d frame %d: HOLD raised the energy by %g\n", level, n, f, rep->hold_rise);
    failures++;
  }
  t->flows += rep->flow_stages - was->flow_stages;
  t->frames++;
}

/* One random path through one scene at one level. */
static void run_path(int n, int event, int frames, double factor, int mirror, tally *t, double *poses)
{
  orc_scene sc;
  orc_state st;
  orc_report rep, was;
  double h[3], to[3], v[3] = {0, 0, 0};
  int f, i;
  seed = 0x9e3779b97f4a7c15u + (uint64_t)n * 0x632be59bd9b4e019u;
  for (i = 0; i < 10; i++)
    uniform(0, 1);
  random_scene(&sc, n);
  for (i = 0; mirror && i < sc.nv; i++)
    sc.v[i][0] = -sc.v[i][0];
  for (i = 0; mirror && i < sc.ns; i++) {
    sc.s[i].point[0] = -sc.s[i].point[0];
    sc.s[i].normal[0] = -sc.s[i].normal[0];
  }
  if (mirror)
    sc.hold[0] = -sc.hold[0];
  memset(&rep, 0, sizeof rep);
  h[0] = uniform(0.18, 0.25);
  h[1] = 0.15;
  h[2] = uniform(-0.5, 0.5);
  if (n % 6 == 4) { /* between the walls of the slot */
    h[1] = 0.11;
    h[2] *= n % 5 == 4 ? 0 : 0.1;
  }
  if (mirror) {
    h[0] = -h[0];
    h[2] = -h[2];
  }
  {
    double c = cos(h[2]), s = sin(h[2]);
    orc_init(&sc, &st, h[0] - c * sc.hold[0] + s * sc.hold[1], h[1] - s * sc.hold[0] - c * sc.hold[1], h[2]);
  }
  orc_step_factor = factor;
  was = rep;
  orc_relax(&sc, &st, h[0], h[1], h[2], &rep);
  for (f = 0; f < frames; f++) {
    double speed = n % 3 == 0 ? 0.02 : 0.004;
    for (i = 0; i < 3; i++) {
      v[i] = 0.9 * v[i] + uniform(-1, 1) * (i == 2 ? 6 : 1) * speed * (mirror && i != 1 ? -1 : 1);
      to[i] = h[i] + v[i];
    }
    /* press against the surfaces, but stay near them */
    to[0] += 0.15 * ((n & 1 ? 0.0 : mirror ? -0.2 : 0.2) - to[0]);
    to[1] += 0.15 * (0.02 - to[1]);
    to[2] += 0.02 * (0 - to[2]);
    was = rep;
    if (event)
      orc_move_event(&sc, &st, h[0], h[1], h[2], to[0], to[1], to[2], &rep);
    else
      orc_move_frame(&sc, &st, to[0], to[1], to[2], &rep);
    memcpy(h, to, sizeof h);
    poses[3 * f] = mirror ? -st.x : st.x;
    poses[3 * f + 1] = st.y;
    poses[3 * f + 2] = mirror ? -st.theta : st.theta;
    check_frame(event ? "event" : "frame", n, f, &sc, &st, h, &was, &rep, t);
  }
  seen_rules |= rep.rules;
  orc_step_factor = 1;
}

static void random_paths(int event, int scenes, int frames)
{
  tally t, t2;
  int n, f, k;
  double *a = malloc(sizeof *a * 3 * (size_t)frames), *b = malloc(sizeof *b * 3 * (size_t)frames);
  if (!a || !b) {
    puts("FAIL out of memory");
    failures++;
    free(a);
    free(b);
    return;
  }
  memset(&t, 0, sizeof t);
  memset(&t2, 0, sizeof t2);
  for (n = 0; n < scenes; n++) {
    run_path(n, event, frames, 1, 0, &t, a);
    if (n % 5)
      continue;
    t.compared++;
    for (k = 0; k < 2; k++) {
      /* the same with smaller steps, and mirrored: only rounding may differ */
      run_path(n, event, frames, k ? 1 : 0.37, k, &t2, b);
      for (f = 0; f < 3 * frames; f++) {
        double d = fabs(a[f] - b[f]);
        if (d > 1e-7) {
          printf("note: %s scene %d frame %d: %g apart from %s\n", event ? "event" : "frame", n, f / 3, d,
                 k ? "its mirror image" : "its refinement");
          t.apart[k]++;
          break;
        }
        if (d > t.worst_apart[k])
          t.worst_apart[k] = d;
      }
    }
  }
  if ((t.apart[0] + t.apart[1]) * 50 > t.compared) {
    printf("FAIL %ld + %ld of %ld paths differ\n", t.apart[0], t.apart[1], t.compared);
    failures++;
  }
  if (t.unfinished * 100 > t.frames) {
    printf("FAIL %ld of %ld frames without an answer\n", t.unfinished, t.frames);
    failures++;
  }
  printf("%s: %ld frames, deepest %.2g m, energy rise %.2g, %ld unfinished, %ld flow stages\n",
         event ? "event" : "frame", t.frames, t.worst_depth, t.worst_rise, t.unfinished, t.flows);
  printf(
    "  %ld paths: %.2g apart from their refinement (%ld beyond 1e-7), %.2g from their mirror image (%ld)\n",
    t.compared, t.worst_apart[0], t.apart[0], t.worst_apart[1], t.apart[1]);
  free(a);
  free(b);
}

int main(int argc, char **argv)
{
  static const char *const names[ORC_R_COUNT] = {
    "free",         "free opened", "turn",       "turn corner", "turn skipped", "hold touch", "snap",
    "1 open",       "1 slide",     "2 edge",     "2 parallel",  "2 trammel",    "3 turn",     "3 pair",
    "3 slide",      "3 all",       "3 many",     "3 second",    "3 after",      "4 flow",     "slide touch",
    "slide N zero", "slide flip",  "slide jump", "goes on",     "stick",        "window",     "double"};
  int scale = argc > 1 ? atoi(argv[1]) : 100, i;

  slip_end_point();
  sawtooth();
  lag_after_slip();
  snap_through();
  ladder();
  tip_or_slide();
  equal_friction();
  double_event();
  short_slip();
  slot();
  trammel_end();
  out_of_corner();
  random_paths(0, 6 * scale, 60);
  random_paths(1, 2 * scale, 40);
  printf("rules not met:");
  for (i = 0; i < ORC_R_COUNT; i++)
    if (!(seen_rules >> i & 1u))
      printf(" [%s]", names[i]);
  printf("\n%d failures\n", failures);
  return failures != 0;
}

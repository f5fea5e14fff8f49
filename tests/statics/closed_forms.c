/* Cases whose answer is known in closed form, through the public interface. Every formula is derived where
 * it is used. N is k_p times the depth by which the hand is pressed below flush contact. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "rig.h"

/* Relative to the object's size, to the largest force, or in rad. */
#define TOLERANCE 1e-10

#define CLOSE(got, want, tolerance) close_to(#got, got, want, tolerance, __LINE__)

static void close_to(const char *what, double got, double want, double tolerance, int line)
{
  if (!(fabs(got - want) <= tolerance))
    fail_msg("line %d: %s is %.17g, expected %.17g (off by %.3g, allowed %.3g)", line, what, got, want,
             got - want, tolerance);
}

/* Stiffness and length are units: no answer may depend on them. */
typedef struct variant {
  double k, scale;
  stic_level level;
  stic_precision precision;
} variant;

static const variant VARIANTS[] = {
  {200, 1, STIC_LEVEL_EVENT, STIC_F64},    {200, 1, STIC_LEVEL_FRAME, STIC_F64},
  {1, 1, STIC_LEVEL_EVENT, STIC_F64},      {31234.5, 7.3, STIC_LEVEL_EVENT, STIC_F64},
  {777, 1e-3, STIC_LEVEL_EVENT, STIC_F64}, {0.02, 1024, STIC_LEVEL_FRAME, STIC_F64},
  {200, 1, STIC_LEVEL_EVENT, STIC_F80},    {3e4, 0.01, STIC_LEVEL_FRAME, STIC_F80},
  {200, 1, STIC_LEVEL_SUBSTEP, STIC_F64},
};
enum { VARIANT_COUNT = sizeof VARIANTS / sizeof VARIANTS[0] };

#define FOR_EACH_VARIANT(w) for (const variant *w = VARIANTS; w < VARIANTS + VARIANT_COUNT; w++)

static void rig_variant(rig *g, const variant *w, double k_theta_of_200)
{
  rig_init(g, w->k, k_theta_of_200 * w->k / 200 * w->scale * w->scale);
  g->settings.level = w->level;
  g->settings.precision = w->precision;
}

/* 0.16 x 0.08 flat on a floor at y = 0, held at its centre, pressed by `depth`. */
static void start_pressed_box(rig *g, double scale, double mu_s, double mu_d, double depth)
{
  stic_scene_set_box(&g->scene, 0.16 * scale, 0.08 * scale);
  rig_surface(g, 0, 0, 90, mu_s, mu_d);
  rig_pose(g, 0, 0.04 * scale, 0);
  rig_start(g);
  rig_to(g, 0, 0.04 * scale - depth, 0);
  assert_int_equal(g->r.state, STIC_EDGE);
}

/* ---- V1: sticks up to |T| = mu_s N, slips beyond ---- */

static void stick_limit_edge(void **state)
{
  (void)state;
  FOR_EACH_VARIANT(w)
  for (int side = -1; side <= 1; side += 2)
    for (int over = -1; over <= 1; over += 2) {
      rig g;
      double depth = 0.01 * w->scale, x = side * 0.5 * depth * (1 + over * 1e-9);
      rig_variant(&g, w, 0.5);
      start_pressed_box(&g, w->scale, 0.5, 0.3, depth);
      rig_to(&g, x, g.y, 0);
      assert_int_equal(g.r.slips, over > 0);
      CLOSE(g.r.x, over > 0 ? side * 0.2 * depth : 0, TOLERANCE * w->scale);
      double t = 0, n = 0;
      for (int i = 0; i < g.r.contact_count; i++)
        t += g.r.contacts[i].friction, n += g.r.contacts[i].normal;
      CLOSE(n / (w->k * depth), 1, TOLERANCE);
      CLOSE(t / (w->k * depth), side * (over > 0 ? -0.3 : -0.5), 1e-8);
      rig_end(&g);
    }
}

/* The holding point on the contact vertex (a = 0): its force is k (h - P) whatever the angle, and the
 * moment k_theta (phi - theta) alone. */
static void stick_limit_vertex(void **state)
{
  (void)state;
  FOR_EACH_VARIANT(w)
  for (int over = -1; over <= 1; over += 2) {
    rig g;
    double l = w->scale, depth = 0.01 * l, x = 0.7 * depth * (1 + over * 1e-9);
    rig_variant(&g, w, 0.5);
    stic_scene_set_box(&g.scene, 0.16 * l, 0.08 * l);
    g.scene.holding_point[0] = -0.08 * l, g.scene.holding_point[1] = -0.04 * l;
    rig_surface(&g, 0, 0, 90, 0.7, 0.2);
    rig_pose(&g, 0.08 * l * cos(0.3) - 0.04 * l * sin(0.3), 0.08 * l * sin(0.3) + 0.04 * l * cos(0.3), 0.3);
    rig_start(&g);
    rig_to(&g, 0, -depth, 0.3);
    assert_int_equal(g.r.state, STIC_VERTEX);
    rig_to(&g, 0, -depth, 0.4); /* turns about the vertex straight to phi */
    CLOSE(g.r.theta, 0.4, 1e-14);
    rig_to(&g, x, -depth, 0.4);
    assert_int_equal(g.r.slips, over > 0);
    CLOSE(g.r.contacts[0].x, over > 0 ? 0.5 * depth : 0, TOLERANCE * l);
    CLOSE(g.r.contacts[0].normal / (w->k * depth), 1, TOLERANCE);
    CLOSE(g.r.contacts[0].friction / (w->k * depth), over > 0 ? -0.2 : -0.7, 1e-8);
    CLOSE(g.r.theta, 0.4, 1e-14);
    rig_end(&g);
  }
}

/* ---- V2, V3, V4: drag of a pressed edge ----
 * It sticks until T = mu_s N, that is until the hand is mu_s h ahead; the slip ends at T = mu_d N, the hand
 * mu_d h ahead. So the object jumps by (mu_s - mu_d) h each time the hand has gone that far (an undamped
 * mass would go on to the mirror image and lose twice that force), at any speed and stiffness. */
static void stick_slip_sawtooth(void **state)
{
  static const struct {
    double mu_s, mu_d, h, travel;
    int samples;
  } cases[] = {{0.5, 0.3, 0.01, 0.1234, 1}, {0.5, 0.3, 0.01, 0.1234, 31}, {0.5, 0.3, 0.01, 0.1234, 400},
               {0.9, 0.1, 0.02, 0.1, 7},    {0.4, 0.38, 0.05, 0.05, 3},   {0.6, 0, 0.01, 0.05, 5}};
  (void)state;
  FOR_EACH_VARIANT(w)
  {
    if (w->level != STIC_LEVEL_EVENT)
      continue;
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++)
      for (int side = -1; side <= 1; side += 2) {
        rig g;
        double l = w->scale, h = cases[k].h * l, travel = cases[k].travel * l, mu_s = cases[k].mu_s,
               mu_d = cases[k].mu_d;
        double jump = (mu_s - mu_d) * h, step = travel / cases[k].samples;
        int count = (int)ceil((travel - mu_s * h) / jump), seen = 0;
        rig_variant(&g, w, 0.5);
        start_pressed_box(&g, l, mu_s, mu_d, h);
        for (int i = 1; i <= cases[k].samples; i++) {
          rig_to(&g, side * step * i, g.y, 0);
          int events;
          const stic_event *e = stic_sim_events(g.sim, &events);
          for (int n = 0; n < events; n++) {
            if (e[n].kind != STIC_EVENT_SLIP || e[n].vertex != 0)
              continue; /* both vertices report it */
            double hand = step * (i - 1 + rig_part(&g, &e[n])), object = side * (e[n].x + 0.08 * l);
            CLOSE((hand - (mu_s * h + seen * jump)) / l, 0, TOLERANCE); /* V3: when */
            CLOSE((hand - object) / l, mu_d * h / l, TOLERANCE); /* V2: the lag, and V4: T falls to mu_d N */
            CLOSE(e[n].length / l, jump / l, TOLERANCE);
            seen++;
          }
          double t = -(g.r.contacts[0].friction + g.r.contacts[1].friction) * side / (w->k * h);
          assert_int_equal(g.r.contact_count, 2);
          assert_true(t <= mu_s * (1 + 1e-12));
          CLOSE(t, (step * i - side * g.r.x) / h, TOLERANCE);
          CLOSE(side * g.r.x / l, seen * jump / l, TOLERANCE);
        }
        assert_int_equal(seen, count);
        assert_int_equal(g.r.slips, count);
        rig_end(&g);
      }
  }
}

/* Level frame: a slip begins at the sample after its limit and ends at the hand minus mu_d h there. */
static void drag_at_frames(void **state)
{
  (void)state;
  rig g;
  double place = 0, h = 0.01;
  int slips = 0;
  rig_init(&g, 200, 0.5);
  g.settings.level = STIC_LEVEL_FRAME;
  start_pressed_box(&g, 1, 0.5, 0.3, h);
  for (int i = 1; i <= 100; i++) {
    double x = 0.00037 * i;
    rig_to(&g, x, g.y, 0);
    if (x - place > 0.5 * h)
      place = x - 0.3 * h, slips++;
    CLOSE(g.r.x, place, 1e-15);
    assert_int_equal(g.r.slips, slips);
  }
  rig_end(&g);
}

/* ---- the slip end point of a single vertex ----
 * With a the vector from vertex to holding point: N = k (a_n - h_n), T = -sigma mu_d N, and the moments about
 * the vertex: k_theta (phi - theta) + a x F_h = k_theta (phi - theta) - N (a_t + sigma mu_d a_n) = 0. */
static void check_slip_end(const rig *g, double sigma, double mu_d)
{
  const stic_result *r = &g->r;
  double k = g->scene.stiffness, c = cos(r->theta), s = sin(r->theta), size = stic_scene_size(&g->scene);
  const double *v = g->scene.vertices[r->contacts[0].vertex], *b = g->scene.holding_point;
  double at = c * (b[0] - v[0]) - s * (b[1] - v[1]), an = s * (b[0] - v[0]) + c * (b[1] - v[1]);
  double n = k * (an - g->y), force = fmax(k * size, n);
  assert_int_equal(r->contact_count, 1);
  CLOSE(r->contacts[0].y / size, 0, 1e-15);
  CLOSE(r->contacts[0].normal / force, n / force, 1e-13);
  CLOSE(r->contacts[0].friction / force, -sigma * mu_d * n / force, 1e-13);
  CLOSE((g->scene.rotational_stiffness * (r->hand_theta - r->theta) - n * (at + sigma * mu_d * an)) /
          (force * size),
        0, 1e-13);
  CLOSE((g->x - (r->contacts[0].x + at)) / size, sigma * mu_d * n / k / size, 1e-13);
}

static void slip_end_point(void **state)
{
  (void)state;
  FOR_EACH_VARIANT(w)
  for (int sigma = -1; sigma <= 1; sigma += 2) {
    rig g;
    double l = w->scale, phi = 0.35, touch = (0.08 * sin(phi) + 0.04 * cos(phi)) * l;
    rig_variant(&g, w, 0.5);
    stic_scene_set_box(&g.scene, 0.16 * l, 0.08 * l);
    rig_surface(&g, 0, 0, 90, 0.5, 0.3);
    rig_pose(&g, 0, touch + 0.01 * l, phi);
    rig_start(&g);
    rig_to(&g, sigma * 0.1 * l, touch - 0.02 * l, phi);
    assert_int_equal(g.r.state, STIC_VERTEX);
    assert_int_equal(g.r.slips, 1);
    CLOSE(g.r.theta, sigma > 0 ? 0.141425757103 : 0.170537983664, 1e-12);
    CLOSE(g.r.contacts[0].normal / (w->k * l) * 200, sigma > 0 ? 1.17405813711 : 1.59800308252, 1e-11);
    check_slip_end(&g, sigma, 0.3);
    rig_end(&g);
  }
}

/* ---- V6: when is sliding unique? ----
 * Let r lead from the holding point to the vertex. A contact force (T, N) moves the vertex by C (T, N),
 * C = I / k + p p^T / k_theta with p = (-r_n, r_t); K of the literature is C^-1. While it slides, T = -sigma mu N, and
 * the gap stays zero: N (C_nn - sigma mu C_tn) = depth. One N >= 0 for each depth iff the bracket is positive in both
 * senses: mu < C_nn / |C_tn| = K_tt / |K_tn| = (k_theta / k + r_t^2) / |r_t r_n|; here 0.0044 / 0.0016 = 2.75.
 * Stuck with the hand at (x, -depth), (T, N) = K (-x, depth): pulled the way that digs in, |T| / N rises with x
 * towards K_tt / |K_tn| and no further. So below 2.75 it slips in the end, to the one N of the bracket; above, never.
 * All in units of k, where C_tt = 2.6, C_nn = 1.1, C_tn = 0.4. */
static void sliding_unique(void **state)
{
  (void)state;
  FOR_EACH_VARIANT(w)
  for (int over = -1; over <= 1; over += 2)
    for (int way = 0; way < 3; way++) {
      rig g;
      double l = w->scale, depth = 1e-11 * l, mu = 2.75 * (1 + over * 1e-3);
      double limit = (2.6 * mu - 0.4) / (1.1 - 0.4 * mu); /* of x / depth */
      double x = way == 0 ? -5 : way == 1 ? fabs(limit) * 0.98 : fabs(limit) * 1.02;
      bool slips = way == 0 || (way == 2 && over < 0);
      rig_variant(&g, w, 2 * 200. / 500);
      rig_vertex(&g, 0.02 * l, -0.08 * l);
      rig_vertex(&g, 0.04 * l, 0.05 * l);
      rig_vertex(&g, -0.02 * l, 0.05 * l);
      rig_surface(&g, 0, 0, 90, mu, mu);
      rig_pose(&g, -0.02 * l, 0.08 * l, 0);
      rig_start(&g);
      rig_to(&g, -0.02 * l + x * depth, 0.08 * l - depth, 0);
      assert_int_equal(g.r.slips, slips);
      double n = slips ? 1 / (1.1 - (way ? 1 : -1) * mu * 0.4) : (0.4 * x + 2.6) / 2.7;
      CLOSE(g.r.contacts[0].normal / w->k / depth / n, 1, 2e-3); /* linear, a thousandth from the limit */
      if (slips)
        check_slip_end(&g, way ? 1 : -1, mu);
      rig_end(&g);
    }
}

/* ---- single vertex stuck: Kepler's equation u + e sin u = M, its folds and snaps ----
 * A sliver stands on its tip, held below it at a; the hand d below the tip: with theta = u the moment about the
 * tip is k_theta (phi - u) - k a d sin u. It stands upright at theta = upright. */
static const double SLIVER_A = 0.09;

static void start_sliver(rig *g, const variant *w, double e, double d, double upright, double u0, double M)
{
  double l = w->scale, far = 0.1 * l;
  rig_variant(g, w, 200 * SLIVER_A * d / e);
  rig_vertex(g, 0, 0);
  rig_vertex(g, far * cos(STIC_PI / 2 - upright - 0.01), far * sin(STIC_PI / 2 - upright - 0.01));
  rig_vertex(g, far * cos(STIC_PI / 2 - upright + 0.01), far * sin(STIC_PI / 2 - upright + 0.01));
  g->scene.holding_point[1] = -SLIVER_A * l;
  rig_surface(g, 0, 0, 90, 1000, 500); /* never slips */
  rig_pose(g, 0, 0, u0);
  rig_start(g);
  rig_to(g, 0, -d * l, M);
}

/* The first zero of M - u - e sin u from u0 on, the way its sign says: small steps, then halving. */
static double kepler_zero(double e, double M, double u0)
{
  double f = M - u0 - e * sin(u0), step = f > 0 ? 1e-4 : -1e-4, a = u0;
  if (f == 0)
    return u0;
  while ((M - (a + step) - e * sin(a + step)) * f > 0)
    a += step;
  double b = a + step;
  for (int i = 0; i < 80; i++) {
    double m = (a + b) / 2;
    if ((M - m - e * sin(m)) * f > 0)
      a = m;
    else
      b = m;
  }
  return (a + b) / 2;
}

/* V5: the equilibrium vanishes where d M / d u = 1 + e cos u = 0, at M* = acos(-1/e) + sqrt(e^2 - 1). */
static void snap_fold(void **state)
{
  static const double es[] = {1.2, 1.3, 2, 3, 3.6};
  (void)state;
  CLOSE(acos(-1. / 3) + sqrt(8), 4.739060360995, 1e-12);
  FOR_EACH_VARIANT(w)
  for (size_t k = 0; k < sizeof es / sizeof es[0]; k++) {
    double e = es[k], fold = acos(-1 / e), M = fold + sqrt(e * e - 1), u0 = fold - 1.2, M0 = u0 + e * sin(u0),
           l = w->scale;
    for (int over = -1; over <= 1; over += 2) {
      rig g;
      start_sliver(&g, w, e, 0.12, fold + 0.2, u0, M0);
      CLOSE(g.r.theta, u0, 1e-12);
      rig_to(&g, 0, -0.12 * l, M - 0.1);
      rig_to(&g, 0, -0.12 * l, M + over * 1e-10);
      assert_true(over < 0 ? fabs(g.r.theta - fold) < 1e-3 : g.r.theta > fold + 0.1);
      CLOSE(g.r.contacts[0].x / l, 0, 0);
      if (w->level == STIC_LEVEL_EVENT)
        assert_true((rig_event(&g, STIC_EVENT_SNAP) != NULL) == (over > 0));
      rig_end(&g);
    }
    if (w->level != STIC_LEVEL_EVENT)
      continue;
    for (int samples = 1; samples <= 50; samples += 49) {
      rig g;
      int snaps = 0;
      start_sliver(&g, w, e, 0.12, fold + 0.2, u0, M0);
      for (int i = 1; i <= samples; i++) {
        double from = g.phi;
        rig_to(&g, 0, -0.12 * l, M0 + (M + 0.05 - M0) * i / samples);
        const stic_event *s = rig_event(&g, STIC_EVENT_SNAP);
        if (!s)
          continue;
        snaps++;
        CLOSE(from + (g.phi - from) * rig_part(&g, s), M, TOLERANCE);
      }
      assert_int_equal(snaps, 1);
      rig_end(&g);
    }
  }
}

/* A side vertex comes down where the sliver has turned a right angle, less its half width 0.01. */
#define TOUCH_BELOW(upright) ((upright)-STIC_PI / 2 + 0.01)
#define TOUCH_ABOVE(upright) ((upright) + STIC_PI / 2 - 0.01)

/* Three roots below the fold, one above: which one is taken depends on where the object comes from. */
static void kepler_roots(void **state)
{
  static const double starts[] = {1.65, 1.9, 2.5, 3.0, 3.2, 3.6, 4.2, 4.6};
  static const double Ms[] = {2.9, 3.1, 3.14};
  (void)state;
  FOR_EACH_VARIANT(w)
  for (size_t i = 0; i < sizeof starts / sizeof starts[0]; i++)
    for (size_t k = 0; k < sizeof Ms / sizeof Ms[0]; k++) {
      rig g;
      double want = fmax(kepler_zero(1.5, Ms[k], starts[i]), TOUCH_BELOW(3.1));
      start_sliver(&g, w, 1.5, 0.12, 3.1, starts[i], Ms[k]);
      CLOSE(g.r.theta, want, 1e-12);
      rig_end(&g);
    }
  /* e = 3.6 */
  CLOSE(200 * 0.09 * 0.1 / 0.5, 3.6, 1e-15);
  FOR_EACH_VARIANT(w)
  for (double u0 = 0.4; u0 < 3; u0 += 0.2) {
    rig g;
    double M = 2.5, want = kepler_zero(3.6, M, u0);
    start_sliver(&g, w, 3.6, 0.1, 1.9, u0, M);
    CLOSE(g.scene.rotational_stiffness / (w->k * w->scale * w->scale), 0.5 / 200, 1e-15);
    want = fmax(TOUCH_BELOW(1.9), fmin(TOUCH_ABOVE(1.9), want));
    CLOSE(g.r.theta, want, 1e-12);
    rig_end(&g);
  }
}

/* ---- V11, V12: the ladder ----
 * Foot on the floor (mu_1), top on the wall (mu_2), load W at the fraction a of its length. Both contacts at
 * their limits: N_2 = T_1 = mu_1 N_1, N_1 + mu_2 N_2 = W; moments about the foot:
 * W a cos = N_2 sin + mu_2 N_2 cos, so tan = (a (1 + mu_1 mu_2) - mu_1 mu_2) / mu_1. */
static void start_ladder(rig *g, const variant *w, double mu_1, double mu_2, double a, double angle)
{
  double l = 0.5 * w->scale;
  rig_variant(g, w, 0);
  rig_vertex(g, 0, 0);
  rig_vertex(g, l, 0);
  rig_vertex(g, l / 2, 0.02 * l);
  g->scene.holding_point[0] = a * l;
  rig_surface(g, 0, 0, 90, mu_1, mu_1 * 0.8);
  rig_surface(g, 0, 0, 180, mu_2, mu_2 * 0.9);
  rig_pose(g, -l * cos(angle), 0, angle);
  rig_start(g);
}

static void load_ladder(rig *g, double a, double load_x, double load_y)
{
  double l = g->scene.vertices[1][0], c = cos(g->scene.angle), s = sin(g->scene.angle);
  rig_to(g, -l * c + a * l * c + load_x, a * l * s + load_y, g->scene.angle);
}

static void ladder_limit(void **state)
{
  static const double mus[][3] = {{0.3, 0.4, 0.5}, {0.6, 0.2, 0.5}, {0.2, 0.1, 0.3}, {0.25, 0, 0.7}};
  (void)state;
  CLOSE(atan((0.5 * 1.12 - 0.12) / 0.3) * 180 / STIC_PI, 55.7131, 1e-4);
  FOR_EACH_VARIANT(w)
  for (size_t k = 0; k < sizeof mus / sizeof mus[0]; k++)
    for (int over = -1; over <= 1; over += 2) {
      rig g;
      double m1 = mus[k][0], m2 = mus[k][1], a = mus[k][2];
      double angle = atan((a * (1 + m1 * m2) - m1 * m2) / m1) + over * 1e-10;
      start_ladder(&g, w, m1, m2, a, angle);
      load_ladder(&g, a, 0, -1 * w->scale);
      assert_int_equal(g.r.slips, over < 0);
      if (over > 0) {
        assert_int_equal(g.r.state, STIC_TWO_VERTEX);
        CLOSE(g.r.theta, angle, 0);
      }
      rig_end(&g);
    }
}

/* The forces that hold the ladder: f_1 + f_2 = -load, and moments about the foot fix the part of f_2 across the
 * ladder; the part x along it is free within both cones. Least norm by search over x, not by the solver's way. */
static void redundant_forces(void **state)
{
  (void)state;
  FOR_EACH_VARIANT(w)
  {
    double last[4] = {0}, angle = 1.2, a = 0.4, m1 = 0.5, m2 = 0.4, step = 0.002;
    rig g;
    start_ladder(&g, w, m1, m2, a, angle);
    for (int i = 0; i < 40; i++) {
      double fx = -0.03 + step * i, fy = -0.3, c = cos(angle), s = sin(angle); /* load over k */
      load_ladder(&g, a, fx * w->scale, fy * w->scale);
      assert_int_equal(g.r.slips, 0);
      double across = -a * (c * fy - s * fx); /* of f_2, along (-s, c) */
      double low = INFINITY, high = -INFINITY;
      /* Feasible x: scan, then sharpen both ends. */
      for (int n = -20000; n <= 20000; n++) {
        double x = n * 1e-4, f2x = -across * s + x * c, f2y = across * c + x * s, f1x = -fx - f2x,
               f1y = -fy - f2y;
        if (f1y < 0 || fabs(f1x) > m1 * f1y || -f2x < 0 || fabs(f2y) > m2 * -f2x)
          continue;
        low = fmin(low, x), high = fmax(high, x);
      }
      assert_true(low < high); /* a segment, not a point */
      for (int end = -1; end <= 1; end += 2) {
        double in = end < 0 ? low : high, out = in + end * 1e-4;
        for (int n = 0; n < 60; n++) {
          double x = (in + out) / 2, f2x = -across * s + x * c, f2y = across * c + x * s, f1x = -fx - f2x,
                 f1y = -fy - f2y;
          if (f1y < 0 || fabs(f1x) > m1 * f1y || -f2x < 0 || fabs(f2y) > m2 * -f2x)
            out = x;
          else
            in = x;
        }
        if (end < 0)
          low = in;
        else
          high = in;
      }
      /* |f_1|^2 + |f_2|^2 is a parabola in x: its slope is zero at x = -(load along the ladder) / 2. */
      double x = fmax(low, fmin(high, -(fx * c + fy * s) / 2));
      double f2x = -across * s + x * c, f2y = across * c + x * s, f1x = -fx - f2x, f1y = -fy - f2y;
      double unit = w->k * w->scale;
      const stic_contact *foot = &g.r.contacts[0], *top = &g.r.contacts[1];
      CLOSE(foot->normal / unit, f1y, TOLERANCE);
      CLOSE(foot->friction / unit, f1x, TOLERANCE);
      CLOSE(top->normal / unit, -f2x, TOLERANCE);
      CLOSE(top->friction / unit, f2y, TOLERANCE); /* normal -x: tangent +y */
      double now[4] = {f1x, f1y, f2x, f2y};
      for (int n = 0; n < 4; n++) {
        if (i)
          assert_true(fabs(now[n] - last[n]) < 20 * step); /* continuous: bars do not jump */
        last[n] = now[n];
      }
    }
    rig_end(&g);
  }
}

/* ---- V13: tip before slide ----
 * Pushed at the height h_p with the normal load over the middle of the base 2 b: at T the centre of pressure is
 * T h_p / N from the middle. It tips when that is b, and slips when T = mu_s N. */
static void tip_before_slide(void **state)
{
  (void)state;
  FOR_EACH_VARIANT(w)
  for (int tips = 0; tips < 2; tips++)
    for (int side = -1; side <= 1; side += 2) {
      rig g;
      double l = w->scale, mu = 0.5 * (1 + (tips ? 1e-10 : -1e-10)), d = 0.5 * l;
      rig_variant(&g, w, 0);
      stic_scene_set_box(&g.scene, 0.08 * l, 0.12 * l);
      g.scene.holding_point[1] = 0.02 * l; /* h_p = 0.08, b = 0.04 */
      rig_surface(&g, 0, 0, 90, mu, 0.3);
      rig_pose(&g, 0, 0.06 * l, 0);
      rig_start(&g);
      rig_to(&g, 0, 0.08 * l - d, 0);
      assert_int_equal(g.r.state, STIC_EDGE);
      rig_to(&g, side * d * 0.5 * (1 + (tips ? 0.5e-10 : -0.5e-10)), 0.08 * l - d,
             0); /* between both limits */
      /* pressed so hard, it tips right over to the next edge */
      if (tips)
        assert_true(g.r.slips == 0 && g.r.theta * side < -0.1);
      else
        assert_true(g.r.slips == 1 && g.r.contact_count == 2 && g.r.theta == 0);
      rig_end(&g);
    }
}

/* ---- V14: an edge contact lives while the centre of pressure is between its vertices ----
 * A load N down at b_x from the middle of the base 2 b, with a sideways pull F_x at the height h_p and a moment M: the
 * moments about the place s of the resultant vanish, N (s - b_x) = F_x h_p - M. */
static void centre_of_pressure(void **state)
{
  (void)state;
  FOR_EACH_VARIANT(w)
  for (int side = -1; side <= 1; side += 2)
    for (int over = -1; over <= 1; over += 2) {
      /* turned: k_theta phi = N (b -+ b_x) */
      rig g;
      double l = w->scale, d = 0.02 * l, b = 0.08 * l, bx = 0.03 * l;
      rig_variant(&g, w, 2);
      stic_scene_set_box(&g.scene, 2 * b, 0.08 * l);
      g.scene.holding_point[0] = bx;
      rig_surface(&g, 0, 0, 90, 0.5, 0.3);
      rig_pose(&g, 0, 0.04 * l, 0);
      rig_start(&g);
      rig_to(&g, bx, 0.04 * l - d, 0);
      assert_int_equal(g.r.state, STIC_EDGE);
      /* N_left 2 b = N (b - b_x): the reported forces say where the centre of pressure is */
      CLOSE(g.r.contacts[0].normal / (w->k * d), (b - bx) / (2 * b), TOLERANCE);
      CLOSE(g.r.contacts[1].normal / (w->k * d), (b + bx) / (2 * b), TOLERANCE);
      /* A turn by phi > 0 lifts the right end: the centre of pressure goes left by k_theta phi / N. */
      double phi = side * w->k * d * (b + side * bx) / g.scene.rotational_stiffness;
      rig_to(&g, bx, 0.04 * l - d, phi + over * side * 1e-10);
      assert_int_equal(g.r.contact_count, over > 0 ? 1 : 2);
      if (over < 0)
        CLOSE(g.r.contacts[side > 0 ? 1 : 0].normal / (w->k * d), 0, 1e-9);
      assert_int_equal(g.r.slips, 0);
      rig_end(&g);

      /* pulled sideways at the height h_p: s = b_x + x h_p / d */
      double x = side * (b - side * bx) * d / (0.04 * l);
      rig_variant(&g, w, 0);
      stic_scene_set_box(&g.scene, 2 * b, 0.08 * l);
      g.scene.holding_point[0] = bx;
      rig_surface(&g, 0, 0, 90, 5, 0.3);
      rig_pose(&g, 0, 0.04 * l, 0);
      rig_start(&g);
      rig_to(&g, bx, 0.04 * l - d, 0);
      rig_to(&g, bx + x * (1 + over * 1e-9), 0.04 * l - d, 0);
      assert_int_equal(g.r.contact_count, over > 0 ? 1 : 2);
      assert_int_equal(g.r.slips, 0);
      rig_end(&g);
    }
}

/* When it opens, at level event: the hand's time of the event is that of the formula. */
static void opening_located(void **state)
{
  (void)state;
  FOR_EACH_VARIANT(w)
  {
    if (w->level != STIC_LEVEL_EVENT)
      continue;
    for (int samples = 1; samples <= 29; samples += 7) {
      rig g;
      double l = w->scale, d = 0.02 * l;
      int opened = 0;
      rig_variant(&g, w, 2);
      start_pressed_box(&g, l, 0.5, 0.3, d);
      double phi = w->k * d * 0.08 * l / g.scene.rotational_stiffness;
      for (int i = 1; i <= samples && !opened; i++) {
        double from = g.phi;
        rig_to(&g, 0, g.y, 1.3 * phi * i / samples);
        const stic_event *e = rig_event(&g, STIC_EVENT_OPEN);
        if (!e)
          continue;
        opened++;
        assert_int_equal(e->vertex, 1);
        CLOSE(from + (g.phi - from) * rig_part(&g, e), phi, TOLERANCE);
      }
      assert_int_equal(opened, 1);
      rig_end(&g);
    }
  }
}

/* ---- traps of model.md, section 4 ---- */

/* mu_s = mu_d: no jumps; while sliding the hand is mu h ahead, on the way back it sticks. */
static void equal_friction_edge(void **state)
{
  (void)state;
  FOR_EACH_VARIANT(w)
  {
    rig g;
    double l = w->scale, h = 0.01 * l, mu = 0.4;
    rig_variant(&g, w, 0.5);
    start_pressed_box(&g, l, mu, mu, h);
    double place = 0;
    for (int i = 1; i <= 60; i++) {
      double x = 0.02 * l * sin(0.13 * i) + 0.0011 * l * i;
      rig_to(&g, x, g.y, 0);
      place = fmax(fmin(place, x + mu * h), x - mu * h); /* a play operator */
      CLOSE(g.r.x / l, place / l, 1e-12);
    }
    rig_end(&g);
  }
}

static void equal_friction_vertex(void **state)
{
  (void)state;
  FOR_EACH_VARIANT(w)
  for (int sigma = -1; sigma <= 1; sigma += 2) {
    rig g;
    double l = w->scale, phi = 0.35, touch = (0.08 * sin(phi) + 0.04 * cos(phi)) * l, last = 0;
    rig_variant(&g, w, 5);
    stic_scene_set_box(&g.scene, 0.16 * l, 0.08 * l);
    rig_surface(&g, 0, 0, 90, 0.3, 0.3);
    rig_pose(&g, 0, touch, phi);
    rig_start(&g);
    rig_to(&g, 0, touch, phi);
    for (int i = 1; i <= 40; i++) {
      rig_to(&g, sigma * 0.003 * l * i, touch - 0.01 * l, phi + 0.002 * i);
      assert_int_equal(g.r.state, STIC_VERTEX);
      if (i > 3)
        check_slip_end(&g, sigma, 0.3);
      if (i > 3)
        assert_true((g.r.contacts[0].x - last) * sigma > 0);
      last = g.r.contacts[0].x;
    }
    rig_to(&g, g.x - sigma * 1e-5 * l, g.y, g.phi);
    CLOSE(g.r.contacts[0].x / l, last / l, 1e-15);
    last = g.r.contacts[0].x;
    for (int i = 0; i < 20; i++) {
      rig_to(&g, g.x - sigma * 1e-5 * l, g.y, g.phi);
      CLOSE(g.r.contacts[0].x, last, 0); /* back: stuck, to the bit */
    }
    rig_end(&g);
  }
}

/* Foot on the floor, top on the wall, mu_s = mu_d on both: one degree of freedom, the angle. Sliding, both contacts are
 * at mu N against their ways, so two forces of known direction and the spring balance in three equations. */
static void check_sliding_ladder(const rig *g, double mu, double way)
{
  const stic_result *r = &g->r;
  double l = g->scene.vertices[1][0], c = cos(r->theta), s = sin(r->theta);
  double held[2] = {r->x + c * g->scene.holding_point[0], r->y + s * g->scene.holding_point[0]};
  double pull[2] = {g->scene.stiffness * (g->x - held[0]), g->scene.stiffness * (g->y - held[1])};
  double size = hypot(pull[0], pull[1]), moment;
  /* way > 0: it slides down, the foot to the left, the top downwards */
  double floor_n = (-pull[1] - way * mu * pull[0]) / (1 + mu * mu),
         wall_n = (pull[0] - way * mu * pull[1]) / (1 + mu * mu);
  assert_int_equal(r->state, STIC_TWO_VERTEX);
  CLOSE(r->y / l, 0, 1e-12);
  CLOSE((r->x + l * c) / l, 0, 1e-12);
  CLOSE(r->contacts[0].normal / size, floor_n / size, 1e-9);
  CLOSE(r->contacts[1].normal / size, wall_n / size, 1e-9);
  CLOSE(fabs(r->contacts[0].friction) / size, mu * floor_n / size, 1e-9);
  CLOSE(fabs(r->contacts[1].friction) / size, mu * wall_n / size, 1e-9);
  moment = g->scene.rotational_stiffness * (g->phi - r->theta) +
           g->scene.holding_point[0] * (c * pull[1] - s * pull[0]) + l * (c * way * mu * wall_n + s * wall_n);
  CLOSE(moment / (size * l), 0, 1e-9);
}

static void equal_friction_ladder(void **state)
{
  static const double mus[] = {0, 0.1, 0.2};
  (void)state;
  FOR_EACH_VARIANT(w)
  for (size_t k = 0; k < sizeof mus / sizeof mus[0]; k++) {
    rig g;
    double l = w->scale, start = 1, mu = mus[k], theta;
    start_ladder(&g, w, mu, mu, 0.5, start);
    rig_end(&g);
    for (int i = 0; i < 2; i++)
      g.scene.surfaces[i].friction.mu_dynamic = mu;
    g.scene.rotational_stiffness = w->k * 0.004 * l * l;
    rig_start(&g);
    rig_to(&g, -0.25 * l * cos(start) + 0.05 * l, 0.25 * l * sin(start) - 0.05 * l, start);
    for (int i = 1; i <= 40; i++) { /* down */
      double a = start - 0.01 * i;
      rig_to(&g, -0.25 * l * cos(a) + 0.05 * l, 0.25 * l * sin(a) - 0.05 * l, a - 0.3);
      if (i > 20 || mu == 0)
        check_sliding_ladder(&g, mu, 1);
    }
    theta = g.r.theta;
    for (int i = 0; i < 5; i++) {
      rig_to(&g, g.x, g.y, g.phi + 1e-4);
      if (mu > 0)
        CLOSE(g.r.theta, theta, 0); /* back: stuck, to the bit */
      else
        check_sliding_ladder(&g, mu, -1);
    }
    for (int i = 1; i <= 40; i++) { /* and up */
      double a = start - 0.4 + 0.01 * i;
      rig_to(&g, -0.25 * l * cos(a) + 0.05 * l, 0.25 * l * sin(a) - 0.05 * l, a + 0.5);
      if (i > 20 || mu == 0)
        check_sliding_ladder(&g, mu, -1);
    }
    rig_end(&g);
  }
}

static void frictionless(void **state)
{
  (void)state;
  FOR_EACH_VARIANT(w)
  {
    rig g;
    double l = w->scale;
    rig_variant(&g, w, 0.5);
    start_pressed_box(&g, l, 0, 0, 0.01 * l);
    for (int i = 1; i <= 50; i++) {
      rig_to(&g, 0.1 * l * sin(i), g.y, 0);
      CLOSE(g.r.x / l, g.x / l, 1e-12);
      for (int k = 0; k < 2; k++)
        CLOSE(g.r.contacts[k].friction, 0, 0);
    }
    rig_end(&g);

    double phi = 0.35, touch = (0.08 * sin(phi) + 0.04 * cos(phi)) * l;
    rig_variant(&g, w, 5);
    stic_scene_set_box(&g.scene, 0.16 * l, 0.08 * l);
    rig_surface(&g, 0, 0, 90, 0, 0);
    rig_pose(&g, 0, touch + 0.01 * l, phi);
    rig_start(&g);
    rig_to(&g, 0, touch + 0.01 * l, phi);
    for (int i = 1; i <= 50; i++) {
      rig_to(&g, 0.1 * l * sin(i), touch - 0.01 * l, phi + 0.01 * cos(i));
      check_slip_end(&g, 1, 0);
    }
    rig_end(&g);
  }
}

/* k_theta = 0: a free object keeps its angle, to the bit; a pinned one comes into line with the hand: the only
 * moment is k |a| |d| sin(alpha - theta). */
static void no_rotational_stiffness(void **state)
{
  (void)state;
  FOR_EACH_VARIANT(w)
  {
    rig g;
    double l = w->scale;
    rig_variant(&g, w, 0);
    stic_scene_set_box(&g.scene, 0.16 * l, 0.08 * l);
    rig_surface(&g, 0, 0, 90, 0.9, 0.7);
    rig_pose(&g, 0, 1 * l, 0.2);
    rig_start(&g);
    for (int i = 0; i < 30; i++) {
      rig_to(&g, 0.1 * l * sin(i), 1 * l, 0.9 * i);
      CLOSE(g.r.theta, 0.2, 0);
      CLOSE(g.r.x / l, g.x / l, 1e-14);
    }
    rig_end(&g);

    /* The sliver's holding point lies below its tip, so the hand pulls it into line below. */
    rig_variant(&g, w, 0);
    rig_vertex(&g, 0, 0);
    rig_vertex(&g, 0.1 * l * sin(0.01), 0.1 * l * cos(0.01));
    rig_vertex(&g, -0.1 * l * sin(0.01), 0.1 * l * cos(0.01));
    g.scene.holding_point[1] = -0.09 * l;
    rig_surface(&g, 0, 0, 90, 1000, 500);
    rig_pose(&g, 0, 0, 0.3);
    rig_start(&g);
    for (int i = 0; i < 20; i++) {
      double at = 0.05 * i - 0.5;
      rig_to(&g, 0.2 * l * sin(at), -0.2 * l * cos(at), 77 * i);
      CLOSE(g.r.theta, at, 1e-12);
      CLOSE(g.r.contacts[0].normal / (w->k * l), 0.11 * cos(at), 1e-12);
    }
    rig_end(&g);
  }
}

/* d = 0: the hand on the anchor. Its pull has no moment about it: theta = phi, and the contact force is k R a. */
static void hand_on_anchor(void **state)
{
  (void)state;
  FOR_EACH_VARIANT(w)
  for (int free_turn = 0; free_turn < 2; free_turn++) {
    rig g;
    double l = w->scale;
    rig_variant(&g, w, free_turn ? 0 : 0.5);
    stic_scene_set_box(&g.scene, 0.16 * l, 0.08 * l);
    rig_surface(&g, 0, 0, 90, 50, 40);
    double start = 0.4, c = cos(start), s = sin(start);
    rig_pose(&g, 0.08 * l * c - 0.04 * l * s, 0.08 * l * s + 0.04 * l * c, start);
    rig_start(&g);
    for (int i = 0; i < 12; i++) {
      double phi = 0.4 + 0.04 * i;
      rig_to(&g, 0, 0, phi);
      double at = free_turn ? start : phi;
      CLOSE(g.r.theta, at, 1e-14);
      assert_int_equal(g.r.state, STIC_VERTEX);
      CLOSE(g.r.contacts[0].normal / (w->k * l), 0.08 * sin(at) + 0.04 * cos(at), 1e-13);
      CLOSE(g.r.contacts[0].friction / (w->k * l), 0.08 * cos(at) - 0.04 * sin(at), 1e-13);
      CLOSE(g.r.contacts[0].x, 0, 1e-16 * l);
    }
    rig_end(&g);
  }
}

/* The hand jumps right through one or several surfaces between two samples. */
static void jump_through(void **state)
{
  (void)state;
  FOR_EACH_VARIANT(w)
  for (int scene = 0; scene < 4; scene++)
    for (double far = 0.1; far < 1e4; far *= 10) {
      rig g;
      double l = w->scale;
      rig_variant(&g, w, 0.5);
      stic_scene_set_box(&g.scene, 0.16 * l, 0.08 * l);
      rig_surface(&g, 0, 0, 90, 0.5, 0.3);
      if (scene & 1) { /* further floors below the first */
        rig_surface(&g, 0, -0.05 * l, 90, 0.5, 0.3);
        rig_surface(&g, 0, -5 * l, 90, 0.5, 0.3);
      }
      if (scene & 2) {
        rig_surface(&g, -0.3 * l, 0, 0, 0.5, 0.3);
        rig_surface(&g, 0.3 * l, 0, 135, 0.5, 0.3);
      }
      rig_pose(&g, 0, 0.1 * l, 0);
      rig_start(&g);
      rig_to(&g, 0, 0.1 * l, 0);
      rig_to(&g, 0, -far * l, 0); /* straight down: flat on the floor, N = k depth */
      CLOSE(fmax(rig_depth(&g), 0) / l, 0, 1e-15 * (1 + far));
      if (!(scene & 2)) {
        assert_int_equal(g.r.state, STIC_EDGE);
        CLOSE(g.r.y / l, 0.04, 1e-15);
        CLOSE((g.r.contacts[0].normal + g.r.contacts[1].normal) / (w->k * l * (far + 0.04)), 1, 1e-14);
      }
      rig_to(&g, far * l, -far * l, 3);
      CLOSE(fmax(rig_depth(&g), 0) / l, 0, 1e-15 * (1 + far));
      rig_to(&g, -far * l, far * l, -3);
      CLOSE(fmax(rig_depth(&g), 0) / l, 0, 1e-15 * (1 + far));
      rig_to(&g, 0.03 * l, 0.5 * l, 0.1); /* and out again: free, at the hand */
      if (!(scene & 2)) {
        assert_int_equal(g.r.state, STIC_FREE);
        CLOSE(g.r.x / l, 0.03, 1e-15);
        CLOSE(g.r.theta, g.r.hand_theta, 0);
      }
      rig_end(&g);
    }
}

/* Thousands of turns: theta is unwrapped, never cut at pi. */
/* Turned by pi about an axis in the plane, the tracker's z axis points the other way: the angle is undefined there, and the
 * last one stays. */
static void no_angle_about_z(void **state)
{
  (void)state;
  rig g;
  rig_init(&g, 200, 0.5);
  start_pressed_box(&g, 1, 0.5, 0.3, 0.01);
  rig_to(&g, 0, 0.2, 1.25);
  CLOSE(g.r.theta, 1.25, 1e-15);
  const stic_sample turned = {g.t_ns + 1000000000, {0.1, 0.2, 0}, {0.6, 0.8, 0, 0}, 0, false};
  stic_sim_step(g.sim, &turned, &g.r);
  CLOSE(g.r.theta, 1.25, 1e-15);
  CLOSE(g.r.x, 0.1, 1e-15);
  rig_end(&g);
}

static void many_turns(void **state)
{
  (void)state;
  for (int level = 0; level < 2; level++) {
    rig g;
    double phi = 0;
    rig_init(&g, 200, 0.5);
    g.settings.level = level ? STIC_LEVEL_EVENT : STIC_LEVEL_FRAME;
    stic_scene_set_box(&g.scene, 0.16, 0.08);
    rig_surface(&g, 0, 0, 90, 0.5, 0.3);
    rig_pose(&g, 0, 0.2, 0);
    rig_start(&g);
    rig_to(&g, 0, 0.2, 0);
    for (int i = 0; i < 6000; i++)
      rig_to(&g, 0, 0.2, phi += 3);
    CLOSE(g.r.hand_theta, phi, 1e-9);
    CLOSE(g.r.theta, g.r.hand_theta, 0);
    /* Press it down there, at 2864 turns and the rest: the same as without the turns, up to the ulp of theta. */
    double turns = 2 * STIC_PI * round(phi / (2 * STIC_PI));
    rig_to(&g, 0, 0.2, turns);
    rig_to(&g, 0, 0.03, turns);
    CLOSE(g.r.theta - turns, 0, 1e-10);
    CLOSE(g.r.y, 0.04, 1e-10);
    assert_true(rig_depth(&g) < 1e-10);
    rig_end(&g);
  }
}

/* Parallel walls: turned until two opposite vertices touch, phi beyond that by delta. N = k_theta delta / lever at
 * both; pulled along the wall it holds up to 2 mu_s N and a slip leaves 2 mu_d N. */
static void slot(void **state)
{
  (void)state;
  FOR_EACH_VARIANT(w)
  for (int over = -1; over <= 1; over += 2) {
    rig g;
    double l = w->scale, theta = 0.3, rx = (0.08 * cos(theta) - 0.03 * sin(theta)) * l;
    double ry = (0.08 * sin(theta) + 0.03 * cos(theta)) * l;
    rig_variant(&g, w, 0.5);
    stic_scene_set_box(&g.scene, 0.16 * l, 0.06 * l);
    rig_surface(&g, 0, -ry, 90, 0.4, 0.25);
    rig_surface(&g, 0, ry, 270, 0.4, 0.25);
    rig_pose(&g, 0, 0, theta);
    rig_start(&g);
    rig_to(&g, 0, 0, theta + 0.2);
    double n = g.scene.rotational_stiffness * 0.2 / (2 * rx), pull = 2 * 0.4 * n / w->k;
    assert_int_equal(g.r.state, STIC_TWO_VERTEX);
    /* The least-norm forces lend the couple all the friction there is: N rx + mu_s N ry on each side. */
    for (int i = 0; i < 2; i++)
      CLOSE(g.r.contacts[i].normal / n, rx / (rx + 0.4 * ry), TOLERANCE);
    rig_to(&g, -pull * (1 + over * 1e-9), 0, theta + 0.2);
    assert_int_equal(g.r.slips, over > 0);
    CLOSE(g.r.x / l, over > 0 ? -pull * (1 - 0.25 / 0.4) / l : 0, TOLERANCE);
    CLOSE(g.r.theta, theta, 1e-15);
    for (int i = 0; i < 2 && over < 0; i++) /* at the limit friction has none left for the couple */
      CLOSE(g.r.contacts[i].normal / n, 1, 1e-8);
    rig_end(&g);
  }
}

/* Rods of 1:1000 along a wall of a corner: they bear any such load, in forces whose moments are a thousandth of the
 * forces. The second also has a friction of 664. */
static void thin_rods(void **state)
{
  static const struct {
    double half, k_theta, hold, floor, wall, hand[2], phi;
  } rods[] = {{0.0489, 0.034, -1, 1.317, 0.56, {-31.5, -53.3}, -0.79},
              {0.071367115164992376, 0, 0, 0.6, 664, {-0.0713671151649922, 1.4273423032998476e-4}, 0}};
  (void)state;
  for (size_t i = 0; i < sizeof rods / sizeof rods[0]; i++) {
    const double half = rods[i].half, thick = half / 1000;
    rig g;
    rig_init(&g, 200, rods[i].k_theta);
    stic_scene_set_box(&g.scene, 2 * half, 2 * thick);
    rig_surface(&g, 0, 0, 90, rods[i].floor, 0);
    rig_surface(&g, -half, 0, 0, rods[i].wall, 0.2);
    g.scene.holding_point[0] = rods[i].hold * half, g.scene.holding_point[1] = -rods[i].hold * thick;
    rig_pose(&g, 0, thick, 0);
    rig_start(&g);
    rig_to(&g, rods[i].hand[0], rods[i].hand[1], rods[i].phi);
    assert_int_equal(g.r.flags & (STIC_FLAG_NO_ANSWER | STIC_FLAG_LIMIT | STIC_FLAG_SLIPPED), 0);
    assert_true(g.r.x == 0 && g.r.y == thick && g.r.theta == 0);
    assert_true(g.r.residual < 1e-12);
    rig_end(&g);
  }
}

static void corner(void **state)
{
  (void)state;
  FOR_EACH_VARIANT(w)
  {
    rig g;
    double l = w->scale;
    rig_variant(&g, w, 5);
    rig_vertex(&g, 0, 0);
    rig_vertex(&g, 0.1 * l, 0.05 * l);
    rig_vertex(&g, 0.05 * l, 0.1 * l);
    g.scene.holding_point[0] = g.scene.holding_point[1] = 0.05 * l;
    rig_surface(&g, 0, 0, 90, 0, 0);
    rig_surface(&g, 0, 0, 0, 0, 0);
    rig_pose(&g, 0, 0, 0);
    rig_start(&g);
    rig_to(&g, 0.03 * l, 0.02 * l, 0.1);
    assert_int_equal(g.r.state, STIC_CORNER);
    CLOSE(g.r.contacts[0].normal / w->k / l, g.r.holding_y / l - 0.02, 1e-14);
    CLOSE(g.r.contacts[1].normal / w->k / l, g.r.holding_x / l - 0.03, 1e-14);
    /* It turns about the corner to the zero of k_theta (phi - theta) + g x F. */
    double m = g.scene.rotational_stiffness * (0.1 - g.r.theta) + g.r.holding_x * g.r.force_y -
               g.r.holding_y * g.r.force_x;
    CLOSE(m / (w->k * l * l), 0, 1e-14);
    rig_end(&g);

    rig_variant(&g, w, 0.5);
    stic_scene_set_box(&g.scene, 0.16 * l, 0.08 * l);
    rig_surface(&g, 0, 0, 90, 0, 0);
    rig_surface(&g, 0, 0, 0, 0, 0);
    rig_pose(&g, 0.08 * l, 0.04 * l, 0);
    rig_start(&g);
    rig_to(&g, 0.07 * l, 0.03 * l, 0);
    assert_int_equal(g.r.state, STIC_MULTI);
    assert_int_equal(g.r.contact_count, 4);
    double floor_n = 0, wall_n = 0;
    for (int i = 0; i < 4; i++) {
      if (g.r.contacts[i].surface == 0)
        floor_n += g.r.contacts[i].normal;
      else
        wall_n += g.r.contacts[i].normal;
    }
    CLOSE(floor_n / (w->k * l), 0.01, 1e-12);
    CLOSE(wall_n / (w->k * l), 0.01, 1e-12);
    rig_to(&g, 0.07 * l, 0.05 * l, 0); /* up along the wall, without friction */
    CLOSE(g.r.y / l, 0.05, 1e-12);
    CLOSE(g.r.x / l, 0.08, 1e-15);
    rig_to(&g, 0.2 * l, 0.2 * l, 0);
    assert_int_equal(g.r.state, STIC_FREE);
    rig_end(&g);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(stick_limit_edge),
    cmocka_unit_test(stick_limit_vertex),
    cmocka_unit_test(stick_slip_sawtooth),
    cmocka_unit_test(drag_at_frames),
    cmocka_unit_test(slip_end_point),
    cmocka_unit_test(sliding_unique),
    cmocka_unit_test(snap_fold),
    cmocka_unit_test(kepler_roots),
    cmocka_unit_test(ladder_limit),
    cmocka_unit_test(redundant_forces),
    cmocka_unit_test(tip_before_slide),
    cmocka_unit_test(centre_of_pressure),
    cmocka_unit_test(opening_located),
    cmocka_unit_test(equal_friction_edge),
    cmocka_unit_test(equal_friction_vertex),
    cmocka_unit_test(equal_friction_ladder),
    cmocka_unit_test(frictionless),
    cmocka_unit_test(no_rotational_stiffness),
    cmocka_unit_test(hand_on_anchor),
    cmocka_unit_test(jump_through),
    cmocka_unit_test(many_turns),
    cmocka_unit_test(no_angle_about_z),
    cmocka_unit_test(slot),
    cmocka_unit_test(corner),
    cmocka_unit_test(thin_rods),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

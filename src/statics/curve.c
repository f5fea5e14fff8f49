/* Functions of one angle. Along every motion that RELAX knows, gaps and forces are waves
 * (k + c cos x + s sin x) and the unbalanced moment is a curve (a wave, its second harmonic and a linear
 * term), so touches come in closed form and moments by a search that cannot pass a zero. */
#include "statics.h"

enum { ZERO_STEPS_MAX = 256 };

static real wave_at(const wave *w, real x)
{
  return w->k + w->c * r_cos(x) + w->s * r_sin(x);
}
static real wave_rate(const wave *w, real x)
{
  return w->s * r_cos(x) - w->c * r_sin(x);
}

static real wrap_turn(real x)
{
  while (x < 0)
    x += 2 * R_PI;
  while (x >= 2 * R_PI)
    x -= 2 * R_PI;
  return x;
}

/* Where the wave first falls through zero for x in [0, x_max]. A wave that starts at zero (within
 * noise) and falls is there at once; one that rises first has to come back. */
static real wave_first_down(const wave *w, real noise, real x_max)
{
  real amplitude = r_sqrt(w->c * w->c + w->s * w->s);
  real start = w->k + w->c;
  if (start > amplitude * x_max + noise)
    return R_HUGE;
  if (start <= noise) {
    real still = 16 * REAL_EPSILON * (amplitude + r_abs(w->k)); /* a rate this small is rounding */
    if (w->s < -still)
      return 0;
    if (w->s <= still && w->c > still)
      return 0; /* the second derivative decides: -c */
    if (w->k + amplitude <= noise)
      return w->s > still ? R_HUGE : 0;
  }
  if (w->k >= amplitude)
    return R_HUGE;
  if (-w->k >= amplitude)
    return 0;
  real crest = r_atan2(w->s, w->c);
  real x = wrap_turn(crest + r_acos(-w->k / amplitude));
  if (start > noise && x > 2 * R_PI - R(1e-6) && wave_rate(w, 0) < 0)
    x = 0; /* wrapped by rounding */
  /* One Newton step takes back what acos lost. */
  real rate = wave_rate(w, x);
  if (rate < -r_sqrt(REAL_EPSILON) * amplitude)
    x = r_max(0, x - wave_at(w, x) / rate);
  return x <= x_max ? x : R_HUGE;
}

/* The first x in (0, x_max] at which the wave is zero, either way. A start within rounding of zero
 * does not count. */
static real wave_next_zero(const wave *w, real x_max)
{
  real amplitude = r_sqrt(w->c * w->c + w->s * w->s);
  if (r_abs(w->k) >= amplitude)
    return R_HUGE;
  real crest = r_atan2(w->s, w->c), half = r_acos(-w->k / amplitude);
  real first = wrap_turn(crest - half), second = wrap_turn(crest + half);
  const real skip = 64 * REAL_EPSILON;
  if (first < skip || first > 2 * R_PI - skip)
    first = R_HUGE;
  if (second < skip || second > 2 * R_PI - skip)
    second = R_HUGE;
  real x = r_min(first, second);
  return x <= x_max ? x : R_HUGE;
}

static real curve_at(const curve *g, real x)
{
  real c = r_cos(x), s = r_sin(x);
  return g->k0 + g->k1 * x + g->c1 * c + g->s1 * s + g->c2 * (c * c - s * s) + g->s2 * (2 * s * c);
}

/* How far one can go from a point with value v > 0 and slope d1 while v + d1 x - bend x^2/2 stays >= 0. */
static real reach_of_parabola(real v, real d1, real bend)
{
  if (bend <= 0)
    return d1 < 0 ? v / -d1 : R_HUGE;
  real root = r_sqrt(d1 * d1 + 2 * bend * v);
  return d1 < 0 ? 2 * v / (root - d1) : (d1 + root) / bend;
}

/* The first zero of a curve that starts positive, in [0, x_max]. Every step is bounded by Taylor's
 * theorem with the curve's own largest third derivative, so none can pass a zero; near a simple zero the
 * steps are Newton's. False: none up to x_max (or the step limit: *x is then as far as was proven). */
static bool curve_first_zero(const curve *g, real x_max, real *x_out, int *iterations)
{
  real first = r_sqrt(g->c1 * g->c1 + g->s1 * g->s1), second = r_sqrt(g->c2 * g->c2 + g->s2 * g->s2);
  real bend_max = first + 4 * second, third_max = first + 8 * second;
  real still = 2 * REAL_EPSILON * (r_abs(g->k0) + first + second);
  real x = 0;
  for (int i = 0; i < ZERO_STEPS_MAX; i++) {
    real c = r_cos(x), s = r_sin(x), c_2 = c * c - s * s, s_2 = 2 * s * c;
    real value = g->k0 + g->k1 * x + g->c1 * c + g->s1 * s + g->c2 * c_2 + g->s2 * s_2;
    ++*iterations;
    *x_out = x;
    if (value <= still + 2 * REAL_EPSILON * r_abs(g->k1 * x))
      return true;
    if (x >= x_max)
      return false;
    real d1 = g->k1 - g->c1 * s + g->s1 * c + 2 * (g->s2 * c_2 - g->c2 * s_2);
    real d2 = -g->c1 * c - g->s1 * s - 4 * (g->c2 * c_2 + g->s2 * s_2);
    real sure = reach_of_parabola(value, d1, bend_max);
    real radius = r_min(x_max - x, 4 * sure);
    real step = r_min(radius, reach_of_parabola(value, d1, third_max * radius / 3 - d2));
    step = r_min(r_max(step, sure), x_max - x);
    if (x + step == x)
      return true;
    x += step;
  }
  *x_out = x;
  return false;
}

/* The same functions counted from x on. */
static wave wave_shift(const wave *w, real x)
{
  real c = r_cos(x), s = r_sin(x);
  wave r = {w->k, w->c * c + w->s * s, w->s * c - w->c * s};
  return r;
}

static curve curve_shift(const curve *g, real x)
{
  real c = r_cos(x), s = r_sin(x), c_2 = c * c - s * s, s_2 = 2 * s * c;
  curve r = {g->k0 + g->k1 * x,         g->k1,
             g->c1 * c + g->s1 * s,     g->s1 * c - g->c1 * s,
             g->c2 * c_2 + g->s2 * s_2, g->s2 * c_2 - g->c2 * s_2};
  return r;
}

/* First s in [0, 1] at which  drift s + w(turn s)  falls through zero: a vertex of an object that turns
 * while it moves straight. Any number of turns: outside the one turn in which the vertex's circle can
 * first reach the surface nothing can happen. */
static real drift_first_down(wave w, real turn, real drift, real noise, int *iterations)
{
  real radius = r_sqrt(w.c * w.c + w.s * w.s);
  real start = w.k + w.c;
  if (r_min(w.k, w.k + drift) - radius > noise)
    return R_HUGE;
  if (turn == 0) {
    if (drift >= 0 || start + drift > 0)
      return R_HUGE;
    return start <= noise ? 0 : r_min(1, start / -drift);
  }
  if (turn < 0)
    turn = -turn, w.s = -w.s;
  /* In the angle x = turn s; g(x) = w(x) + k1 x. */
  curve g = {w.k, drift / turn, w.c, w.s, 0, 0};
  real x_begin = drift < 0 ? r_max(0, (w.k - radius) / -drift * turn) : 0;
  real x_end = r_min(turn, x_begin + 2 * R_PI + R(0.1));
  if (x_begin == 0 && start <= noise) {
    real still = 16 * REAL_EPSILON * (radius + r_abs(w.k) + r_abs(g.k1)), rate = g.k1 + g.s1;
    if (rate < -still || (rate <= still && g.c1 >= 0))
      return 0;
    /* It rises: go on from where it is clear of the surface. */
    real clear = r_min(rate > 0 && radius > 0 ? rate / radius : R(1e-3), R(1e-3));
    if (clear >= x_end)
      return R_HUGE;
    x_begin = clear;
  }
  /* Shift the origin of x to x_begin. */
  curve shifted = curve_shift(&g, x_begin);
  if (shifted.k0 + shifted.c1 <= 0)
    return x_begin / turn;
  real x;
  if (!curve_first_zero(&shifted, x_end - x_begin, &x, iterations))
    return R_HUGE;
  return r_min(1, (x_begin + x) / turn);
}

/* The precision that this compilation of the statics core is for: STIC_REAL_BITS 32, 64 or 80. */
#ifndef STIC_REAL_H
#define STIC_REAL_H

#include <float.h>
#include <math.h>

#ifndef STIC_REAL_BITS
#define STIC_REAL_BITS 64
#endif

#if STIC_REAL_BITS == 32
typedef float real;
typedef double wide;
#define R(x) x##f
#define REAL(name) name##f
#define STIC_CORE stic_core_f32
#define REAL_EPSILON FLT_EPSILON
#elif STIC_REAL_BITS == 64
typedef double real;
typedef double wide;
#define R(x) x
#define REAL(name) name
#define STIC_CORE stic_core_f64
#define REAL_EPSILON DBL_EPSILON
#elif STIC_REAL_BITS == 80
typedef long double real;
typedef long double wide;
#define R(x) x##L
#define REAL(name) name##l
#define STIC_CORE stic_core_f80
#define REAL_EPSILON LDBL_EPSILON
#else
#error "STIC_REAL_BITS must be 32, 64 or 80"
#endif

/* wide: at least double, in which the world's coordinates come in and go out. */

#define r_sin(x) REAL(sin)(x)
#define r_cos(x) REAL(cos)(x)
#define r_acos(x) REAL(acos)(x)
#define r_atan2(y, x) REAL(atan2)(y, x)
#define r_sqrt(x) REAL(sqrt)(x)
#define r_abs(x) REAL(fabs)(x)
#define r_floor(x) REAL(floor)(x)

#define R_PI R(3.14159265358979323846264338327950288)
#define R_HUGE R(1e30) /* "no bound": beyond every scaled length and angle that is searched */

static inline real r_min(real a, real b)
{
  return a < b ? a : b;
}
static inline real r_max(real a, real b)
{
  return a > b ? a : b;
}
static inline real r_sign(real a)
{
  return a < 0 ? R(-1.0) : R(1.0);
}

/* A vector or point of the behaviour plane. */
typedef struct vec {
  real x, y;
} vec;

static inline vec v_make(real x, real y)
{
  vec v = {x, y};
  return v;
}
static inline vec v_add(vec a, vec b)
{
  return v_make(a.x + b.x, a.y + b.y);
}
static inline vec v_sub(vec a, vec b)
{
  return v_make(a.x - b.x, a.y - b.y);
}
static inline vec v_scale(vec a, real k)
{
  return v_make(a.x * k, a.y * k);
}
static inline vec v_mix(vec a, real k, vec b)
{
  return v_make(a.x + k * b.x, a.y + k * b.y);
}
static inline vec v_neg(vec a)
{
  return v_make(-a.x, -a.y);
}
static inline real v_dot(vec a, vec b)
{
  return a.x * b.x + a.y * b.y;
}
static inline real v_cross(vec a, vec b)
{
  return a.x * b.y - a.y * b.x;
}
static inline vec v_perp(vec a)
{
  return v_make(-a.y, a.x);
} /* turned by +90 degrees */
static inline real v_length(vec a)
{
  return r_sqrt(a.x * a.x + a.y * a.y);
}

#endif

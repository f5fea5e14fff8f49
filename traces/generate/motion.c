#include "motion.h"

#include "../../src/angle.h"

#include <math.h>

#define MM_PER_COUNT 0.0254
#define DEGREES_PER_COUNT 0.1

/* ---- random numbers ---------------------------------------------------------------------- */

void stic_random_seed(stic_random *random, uint64_t seed)
{
  for (int i = 0; i < 4; i++) {
    uint64_t z = seed += UINT64_C(0x9e3779b97f4a7c15);

    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    random->state[i] = z ^ (z >> 31);
  }
}

static uint64_t rotate(uint64_t x, int by)
{
  return (x << by) | (x >> (64 - by));
}

static uint64_t next(uint64_t s[4])
{
  const uint64_t result = rotate(s[1] * 5, 7) * 9;
  const uint64_t t = s[1] << 17;

  s[2] ^= s[0];
  s[3] ^= s[1];
  s[1] ^= s[2];
  s[0] ^= s[3];
  s[2] ^= t;
  s[3] = rotate(s[3], 45);
  return result;
}

double stic_random_normal(stic_random *random)
{
  double sum = -6;

  for (int i = 0; i < 12; i++)
    sum += (double)(next(random->state) >> 11) * 0x1p-53;
  return sum;
}

/* ---- the hand ---------------------------------------------------------------------------- */

stic_pose stic_reach(const stic_pose *from, const stic_pose *to, double tau)
{
  const double part = tau * tau * tau * (10 - tau * (15 - 6 * tau));
  stic_pose pose;

  for (int i = 0; i < STIC_AXES; i++)
    pose.axis[i] = from->axis[i] + (to->axis[i] - from->axis[i]) * part;
  return pose;
}

/* Taylor series; |x| up to about pi/4 leaves less than half a unit in the last place. */
static double series(double x, double first, int from)
{
  double term = first, sum = first;

  for (int n = from; n < from + 22; n += 2) {
    term *= -x * x / ((double)n * (n + 1));
    sum += term;
  }
  return sum;
}

static double sine(double x)
{
  return series(x, x, 2);
}

static double cosine(double x)
{
  return series(x, 1, 1);
}

void stic_tremor_start(stic_tremor *tremor, double hz, stic_random *random)
{
  static const double frequency[STIC_AXES] = {9.4, 10.3, 8.6, 11.2};
  const double width = 2.0; /* Hz */
  const double r = 1 - STIC_PI * width / hz;

  for (int i = 0; i < STIC_AXES; i++) {
    const double a1 = 2 * r * cosine(2 * STIC_PI * frequency[i] / hz), a2 = -r * r;

    tremor->a1[i] = a1;
    tremor->a2[i] = a2;
    tremor->gain[i] = sqrt((1 + a2) * ((1 - a2) * (1 - a2) - a1 * a1) / (1 - a2)); /* for rms 1 */
    tremor->last[i] = tremor->before[i] = 0;
  }
  for (int i = 0; i < (int)(2 * hz); i++)
    stic_tremor_step(tremor, random);
}

void stic_tremor_step(stic_tremor *t, stic_random *random)
{
  for (int i = 0; i < STIC_AXES; i++) {
    const double x =
      t->a1[i] * t->last[i] + t->a2[i] * t->before[i] + t->gain[i] * stic_random_normal(random);

    t->before[i] = t->last[i];
    t->last[i] = x;
  }
}

/* ---- the tracker ------------------------------------------------------------------------- */

static int64_t nearest(double x)
{
  return (int64_t)(x < 0 ? x - 0.5 : x + 0.5);
}

stic_counts stic_tracker_counts(const stic_pose *pose)
{
  stic_counts counts;

  for (int i = 0; i < 3; i++)
    counts.axis[i] = nearest(pose->axis[i] / MM_PER_COUNT);
  counts.axis[3] = nearest(pose->axis[3] / DEGREES_PER_COUNT);
  return counts;
}

void stic_half_angle(int64_t counts, double *s, double *c)
{
  /* Half an angle comes round after 7200 counts; an eighth of that is 90 degrees of angle, 45 of half. */
  const int64_t turn = (counts % 7200 + 7200) % 7200;
  const int64_t quarter = (turn + 900) / 1800; /* whole quarter turns of the half angle */
  const double rest = (double)(turn - quarter * 1800) * (STIC_PI / 3600);
  const double a = sine(rest), b = cosine(rest);

  switch (quarter % 4) {
  case 0:
    *s = a;
    *c = b;
    break;
  case 1:
    *s = b;
    *c = -a;
    break;
  case 2:
    *s = -a;
    *c = -b;
    break;
  default:
    *s = -b;
    *c = a;
    break;
  }
}

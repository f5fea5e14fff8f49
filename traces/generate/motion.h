/* How a hand moves and how a tracker sees it. Only + - * / and square roots, which IEEE 754 defines
 * to the last bit: the same recipe gives the same bytes on every machine, whatever its libm. */
#ifndef STIC_TRACES_MOTION_H
#define STIC_TRACES_MOTION_H

#include <stdint.h>

enum { STIC_AXES = 4 }; /* x, y, z in mm, angle in degrees */

typedef struct stic_pose {
  double axis[STIC_AXES];
} stic_pose;

/* xoshiro256**, seeded by splitmix64 (both public domain, Blackman and Vigna). */
typedef struct stic_random {
  uint64_t state[4];
} stic_random;

void stic_random_seed(stic_random *random, uint64_t seed);
/* Nearly normal: mean 0, variance 1, never beyond +-6. */
double stic_random_normal(stic_random *random);

/* Where a minimum-jerk reach is after the part `tau` (0..1) of its time. */
stic_pose stic_reach(const stic_pose *from, const stic_pose *to, double tau);

/* Physiological tremor: on each axis a resonance between 8 and 12 Hz driven by noise, so that it
 * comes and goes as a real one does. */
typedef struct stic_tremor {
  double gain[STIC_AXES], a1[STIC_AXES], a2[STIC_AXES]; /* x[n] = a1 x[n-1] + a2 x[n-2] + gain noise */
  double last[STIC_AXES], before[STIC_AXES];            /* rms 1 */
} stic_tremor;

/* `hz`: how often it will be stepped. Starts in full swing. */
void stic_tremor_start(stic_tremor *tremor, double hz, stic_random *random);
void stic_tremor_step(stic_tremor *tremor, stic_random *random);

/* What the ultrasonic tracker tells: whole counts of 0.001 inch and of 0.1 degree. */
typedef struct stic_counts {
  int64_t axis[STIC_AXES];
} stic_counts;

stic_counts stic_tracker_counts(const stic_pose *pose);

/* Sine and cosine of half an angle given in counts of 0.1 degree: a quaternion's z and w. */
void stic_half_angle(int64_t counts, double *sine, double *cosine);

#endif

#include "one_euro.h"

#include "../../src/angle.h"
#include "quaternion.h"

#include <math.h>
#include <string.h>

void stic_one_euro_settings_init(stic_one_euro_settings *settings)
{
  static const stic_one_euro_settings usual = {{1.15, 1.5}, {0.5, 0.5}, {1.2, 1.2}};

  *settings = usual;
}

void stic_one_euro_begin(stic_one_euro *filter, const stic_one_euro_settings *settings)
{
  memset(filter, 0, sizeof *filter);
  filter->settings = *settings;
}

/* The weight of a new value in a first-order low-pass. */
static double weight(double cutoff, double seconds)
{
  const double tau = 1 / (2 * STIC_PI * cutoff);

  return seconds / (seconds + tau);
}

/* Takes in the raw speed of a step and returns the weight of the new value. */
static double adapt(stic_one_euro *f, int channel, double speed, double seconds)
{
  const stic_one_euro_settings *s = &f->settings;

  f->speed[channel] += weight(s->derivative_cutoff[channel], seconds) * (speed - f->speed[channel]);
  return weight(s->min_cutoff[channel] + s->beta[channel] * f->speed[channel], seconds);
}

static double length(const double v[3])
{
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static void follow_position(stic_one_euro *f, const double position[3], double seconds)
{
  double step[3], a;

  for (int i = 0; i < 3; i++)
    step[i] = position[i] - f->position[i];
  a = adapt(f, 0, length(step) / seconds, seconds);
  for (int i = 0; i < 3; i++)
    f->position[i] += a * step[i];
}

/* Along the shorter arc, so that q and -q are the same orientation. */
static void follow_orientation(stic_one_euro *f, const double orientation[4], double seconds)
{
  const double back[4] = {-f->orientation[0], -f->orientation[1], -f->orientation[2], f->orientation[3]};
  double step[4], turn[3], a;

  stic_quaternion_multiply(orientation, back, step);
  stic_quaternion_to_turn(step, turn);
  a = adapt(f, 1, length(turn) / seconds, seconds);
  for (int i = 0; i < 3; i++)
    turn[i] *= a;
  stic_quaternion_from_turn(turn, step);
  stic_quaternion_multiply(step, f->orientation, f->orientation);
  stic_quaternion_normalize(f->orientation);
}

void stic_one_euro_apply(stic_one_euro *f, stic_device_sample *sample)
{
  const double seconds = (double)(sample->t_ns - f->t_ns) / 1e9;
  const bool tracked = (sample->flags & STIC_SAMPLE_TRACKED) != 0;

  if (tracked && f->begun && seconds > 0) {
    follow_position(f, sample->position, seconds);
    follow_orientation(f, sample->orientation, seconds);
    memcpy(sample->position, f->position, sizeof f->position);
    memcpy(sample->orientation, f->orientation, sizeof f->orientation);
  } else {
    memcpy(f->position, sample->position, sizeof f->position);
    memcpy(f->orientation, sample->orientation, sizeof f->orientation);
    f->speed[0] = f->speed[1] = 0;
  }
  f->begun = tracked;
  f->t_ns = sample->t_ns;
}

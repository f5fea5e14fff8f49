#include "rate_to_pose.h"

#include "quaternion.h"

#include <math.h>
#include <string.h>

#define STILL_NS INT64_C(1000000000)
#define STILL_PART 0.1 /* of the dead zone: a finger on the cap trembles more, an untouched sensor less */

void stic_rate_settings_init(stic_rate_settings *settings)
{
  memset(settings, 0, sizeof *settings);
  settings->linear = settings->angular = 1;
  settings->dead_zone[0] = 0.002;
  settings->dead_zone[1] = 0.02;
  settings->auto_zero = true;
  settings->home_orientation[3] = 1;
  settings->clutch = 4;
  settings->reset = 2;
  settings->hold_ns = 100000000;
}

static void go_home(stic_rate_to_pose *r)
{
  memcpy(r->position, r->settings.home_position, sizeof r->position);
  memcpy(r->orientation, r->settings.home_orientation, sizeof r->orientation);
}

void stic_rate_begin(stic_rate_to_pose *r, const stic_rate_settings *settings)
{
  memset(r, 0, sizeof *r);
  r->settings = *settings;
  stic_quaternion_normalize(r->settings.home_orientation);
  go_home(r);
}

static double dead_zone(const stic_rate_to_pose *r, int axis)
{
  return r->settings.dead_zone[axis >= 3];
}

/* ---- auto-zero --------------------------------------------------------------------------- */

static void restart_stillness(stic_rate_to_pose *r, const double raw[STIC_RATE_AXES], int64_t t_ns)
{
  r->still_since_ns = t_ns;
  memcpy(r->still_low, raw, sizeof r->still_low);
  memcpy(r->still_high, raw, sizeof r->still_high);
}

/* Takes for zero what stays the same, close to zero, for long enough. */
static void follow_zero(stic_rate_to_pose *r, const double raw[STIC_RATE_AXES], int64_t t_ns)
{
  for (int i = 0; i < STIC_RATE_AXES; i++) {
    r->still_low[i] = raw[i] < r->still_low[i] ? raw[i] : r->still_low[i];
    r->still_high[i] = raw[i] > r->still_high[i] ? raw[i] : r->still_high[i];
    if (r->still_high[i] - r->still_low[i] > STILL_PART * dead_zone(r, i) ||
        fabs(raw[i]) > 2 * dead_zone(r, i)) {
      restart_stillness(r, raw, t_ns);
      return;
    }
  }
  if (t_ns - r->still_since_ns < STILL_NS)
    return;
  for (int i = 0; i < STIC_RATE_AXES; i++)
    r->zero[i] = (r->still_low[i] + r->still_high[i]) / 2;
}

/* ---- integration ------------------------------------------------------------------------- */

/* Less the dead zone rather than cut at it: no jump of speed at its edge. */
static double beyond_dead_zone(double rate, double zone)
{
  if (fabs(rate) <= zone)
    return 0;
  return rate > 0 ? rate - zone : rate + zone;
}

static void move(stic_rate_to_pose *r, int64_t until_ns)
{
  const int64_t gap_ns = until_ns - r->t_ns;
  const double seconds = (double)(gap_ns < r->settings.hold_ns ? gap_ns : r->settings.hold_ns) / 1e9;
  double turn[3], step[4];

  if (gap_ns <= 0 || (r->buttons & r->settings.clutch))
    return;
  for (int i = 0; i < 3; i++) {
    r->position[i] += r->rates[i] * seconds;
    turn[i] = r->rates[3 + i] * seconds;
  }
  stic_quaternion_from_turn(turn, step);
  stic_quaternion_multiply(step, r->orientation, r->orientation);
  stic_quaternion_normalize(r->orientation);
}

static void take_rates(stic_rate_to_pose *r, const stic_device_sample *sample)
{
  double raw[STIC_RATE_AXES];

  if (!(sample->flags & STIC_SAMPLE_VELOCITY)) {
    memset(r->rates, 0, sizeof r->rates);
    return;
  }
  memcpy(raw, sample->velocity, sizeof sample->velocity);
  memcpy(raw + 3, sample->turn_rate, sizeof sample->turn_rate);
  if (!r->begun)
    restart_stillness(r, raw, sample->t_ns);
  if (r->settings.auto_zero)
    follow_zero(r, raw, sample->t_ns);
  for (int i = 0; i < STIC_RATE_AXES; i++)
    r->rates[i] = beyond_dead_zone(raw[i] - r->zero[i], dead_zone(r, i)) *
                  (i < 3 ? r->settings.linear : r->settings.angular);
}

static void give_pose(const stic_rate_to_pose *r, stic_device_sample *sample)
{
  const bool held = (r->buttons & r->settings.clutch) != 0;

  memcpy(sample->position, r->position, sizeof r->position);
  memcpy(sample->orientation, r->orientation, sizeof r->orientation);
  for (int i = 0; i < 3; i++) {
    sample->velocity[i] = held ? 0 : r->rates[i];
    sample->turn_rate[i] = held ? 0 : r->rates[3 + i];
  }
  sample->flags |= STIC_SAMPLE_POSITION | STIC_SAMPLE_ORIENTATION;
  sample->flags |= sample->flags & STIC_SAMPLE_VELOCITY ? STIC_SAMPLE_TRACKED : 0;
}

void stic_rate_apply(stic_rate_to_pose *r, stic_device_sample *sample)
{
  if (r->begun)
    move(r, sample->t_ns);
  take_rates(r, sample);
  if (sample->buttons & ~r->buttons & r->settings.reset)
    go_home(r);
  r->buttons = sample->buttons;
  r->t_ns = sample->t_ns;
  r->begun = true;
  give_pose(r, sample);
}

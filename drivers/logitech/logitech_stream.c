#include "logitech_stream.h"

#include "../motion/quaternion.h"

#include <math.h>
#include <string.h>

/* What a hand does not exceed: blows of 10 g, flicks of the wrist; and what the tracker trembles by. */
#define ACCELERATION 100.0       /* m/s^2 */
#define ANGULAR_ACCELERATION 1e3 /* rad/s^2 */
#define SPEED 3.0                /* m/s, when taken up anew */
#define TURN_RATE 20.0           /* rad/s, ditto */
#define POSITION_NOISE 0.01      /* m */
#define ANGLE_NOISE 0.05         /* rad */
/* After a longer gap the last motion says nothing about the next pose. */
#define FOLLOW_NS (5 * (int64_t)STIC_LOGITECH_PERIOD_NS)

static uint32_t buttons_of(const stic_logitech_record *record)
{
  static const struct {
    unsigned wire;
    uint32_t button;
  } map[] = {{STIC_LOGITECH_LEFT, STIC_LOGITECH_BUTTON_LEFT},
             {STIC_LOGITECH_MIDDLE, STIC_LOGITECH_BUTTON_MIDDLE},
             {STIC_LOGITECH_RIGHT, STIC_LOGITECH_BUTTON_RIGHT},
             {STIC_LOGITECH_SUSPEND, STIC_LOGITECH_BUTTON_SUSPEND},
             {STIC_LOGITECH_STAND, STIC_LOGITECH_BUTTON_STAND}};
  uint32_t buttons = 0;

  for (size_t i = 0; i < sizeof map / sizeof map[0]; i++)
    buttons |= (record->bits & map[i].wire) ? map[i].button : 0;
  return buttons;
}

static void debounce(stic_logitech_stream *s, uint32_t buttons)
{
  s->candidate_count = buttons == s->candidate ? s->candidate_count + 1 : 1;
  s->candidate = buttons;
  if (s->candidate_count >= STIC_LOGITECH_DEBOUNCE) {
    s->buttons = buttons;
    s->candidate_count = STIC_LOGITECH_DEBOUNCE;
  }
}

/* The time that lies between two samples at least: those that arrive in a burst were further apart. */
static double seconds_between(const stic_device_sample *from, const stic_device_sample *to)
{
  const int64_t gap_ns = to->t_ns - from->t_ns;

  return (double)(gap_ns > STIC_LOGITECH_PERIOD_NS ? gap_ns : STIC_LOGITECH_PERIOD_NS) / 1e9;
}

/* The motion from one pose to another: m and, as a vector, rad. */
static void difference(const stic_device_sample *from, const stic_device_sample *to, double step[3],
                       double turn[3])
{
  const double *q = from->orientation;
  const double back[4] = {-q[0], -q[1], -q[2], q[3]};
  double rotation[4];

  for (int i = 0; i < 3; i++)
    step[i] = to->position[i] - from->position[i];
  stic_quaternion_multiply(to->orientation, back, rotation);
  stic_quaternion_to_turn(rotation, turn);
}

static double length(const double v[3])
{
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Whether two poses confirm each other. */
static bool is_near(const stic_device_sample *from, const stic_device_sample *to)
{
  const double seconds = seconds_between(from, to);
  double step[3], turn[3];

  difference(from, to, step, turn);
  return length(step) <= SPEED * seconds + POSITION_NOISE &&
         length(turn) <= TURN_RATE * seconds + ANGLE_NOISE;
}

/* Whether a pose lies about where the motion so far leads. */
static bool is_expected(const stic_logitech_stream *s, const stic_device_sample *to)
{
  const double seconds = seconds_between(&s->pose, to);
  double step[3], turn[3];

  if (!s->following || to->t_ns - s->pose.t_ns > FOLLOW_NS)
    return false;
  difference(&s->pose, to, step, turn);
  for (int i = 0; i < 3; i++) {
    step[i] -= s->velocity[i] * seconds;
    turn[i] -= s->turn_rate[i] * seconds;
  }
  return length(step) <= ACCELERATION * seconds * seconds + POSITION_NOISE &&
         length(turn) <= ANGULAR_ACCELERATION * seconds * seconds + ANGLE_NOISE;
}

static void follow(stic_logitech_stream *s, const stic_device_sample *from, const stic_device_sample *to)
{
  const double seconds = seconds_between(from, to);

  difference(from, to, s->velocity, s->turn_rate);
  for (int i = 0; i < 3; i++) {
    s->velocity[i] /= seconds;
    s->turn_rate[i] /= seconds;
  }
  s->acquired = s->following = true;
  s->doubted = false;
  s->pose = *to;
}

/* A record without a pose of its own: the last one that was known, if any. */
static void hold_pose(stic_logitech_stream *s, stic_device_sample *sample)
{
  s->following = s->doubted = false;
  memcpy(sample->position, s->pose.position, sizeof sample->position);
  memcpy(sample->orientation, s->pose.orientation, sizeof sample->orientation);
  if (!s->acquired)
    sample->orientation[3] = 1;
  sample->flags = s->acquired ? STIC_SAMPLE_POSITION | STIC_SAMPLE_ORIENTATION : 0;
}

/* Whether `sample` can be given out now; another may have to be before it, then it is in `next`. */
static bool judge(stic_logitech_stream *s, stic_device_sample *sample)
{
  if (is_expected(s, sample)) {
    s->jumps += s->doubted;
    follow(s, &s->pose, sample);
    return true;
  }
  if (s->doubted && is_near(&s->doubt, sample)) {
    s->next = *sample;
    s->pending = true;
    *sample = s->doubt;
    follow(s, sample, &s->next);
    return true;
  }
  s->jumps += s->doubted;
  s->doubted = true;
  s->doubt = *sample;
  return false;
}

static bool take_record(stic_logitech_stream *s, const stic_logitech_record *record, int64_t arrival_ns,
                        stic_device_sample *sample)
{
  memset(sample, 0, sizeof *sample);
  sample->t_ns = sample->source_ns = arrival_ns - STIC_LOGITECH_WIRE_NS;
  sample->sequence = s->sequence++;
  debounce(s, buttons_of(record));
  sample->buttons = s->buttons;
  if (record->bits & STIC_LOGITECH_OUT) {
    hold_pose(s, sample);
    return true;
  }
  stic_logitech_pose(record, sample->position, sample->orientation);
  sample->flags = STIC_SAMPLE_POSITION | STIC_SAMPLE_ORIENTATION | STIC_SAMPLE_TRACKED;
  sample->flags |= record->bits & STIC_LOGITECH_FRINGE ? STIC_SAMPLE_FRINGE : 0;
  return judge(s, sample);
}

static void give(stic_logitech_stream *s, stic_device_sample *sample)
{
  if (sample->t_ns <= s->last_ns && s->last_ns != 0)
    sample->t_ns = sample->source_ns = s->last_ns + 1;
  s->last_ns = sample->t_ns;
}

bool stic_logitech_stream_next(stic_logitech_stream *s, const uint8_t *bytes, size_t length,
                               int64_t arrival_ns, size_t *used, stic_device_sample *sample)
{
  stic_logitech_record record;
  size_t n;

  *used = 0;
  if (s->pending) {
    s->pending = false;
    *sample = s->next;
    give(s, sample);
    return true;
  }
  while (*used < length) {
    const bool whole = stic_logitech_decode(&s->decoder, bytes + *used, length - *used, &n, &record);

    *used += n;
    /* Bytes that came together were at least their time on the wire apart. */
    if (whole &&
        take_record(s, &record, arrival_ns - (int64_t)(length - *used) * STIC_LOGITECH_BYTE_NS, sample)) {
      give(s, sample);
      return true;
    }
  }
  return false;
}

void stic_logitech_stream_restart(stic_logitech_stream *s)
{
  s->decoder.count = 0;
  s->decoder.in_phase = false;
  s->following = s->doubted = s->pending = false;
  s->buttons = s->candidate = 0;
  s->candidate_count = 0;
}

int64_t stic_logitech_stream_bad(const stic_logitech_stream *s)
{
  return s->decoder.phase_errors + s->decoder.bad_angles + s->jumps;
}

/* What stands between drivers and the solver: rates to poses, the filter, the place in the room. */
#include "../../drivers/motion/one_euro.h"
#include "../../drivers/motion/quaternion.h"
#include "../../drivers/motion/rate_to_pose.h"
#include "../../drivers/motion/tracker_frame.h"
#include "../files/help.h"
#include "angle.h"

#include <math.h>
#include <string.h>

#define MS INT64_C(1000000)
#define assert_near(a, b, tolerance) assert_true(fabs((a) - (b)) <= (tolerance))

static stic_device_sample rate_sample(int64_t t_ns, double vx, double wz, uint32_t buttons)
{
  stic_device_sample s;

  memset(&s, 0, sizeof s);
  s.t_ns = t_ns;
  s.velocity[0] = vx;
  s.turn_rate[2] = wz;
  s.buttons = buttons;
  s.flags = STIC_SAMPLE_VELOCITY;
  return s;
}

static void begin(stic_rate_to_pose *r, double dead)
{
  stic_rate_settings settings;

  stic_rate_settings_init(&settings);
  settings.dead_zone[0] = settings.dead_zone[1] = dead;
  stic_rate_begin(r, &settings);
}

static stic_device_sample step(stic_rate_to_pose *r, int64_t t_ns, double vx, double wz, uint32_t buttons)
{
  stic_device_sample s = rate_sample(t_ns, vx, wz, buttons);

  stic_rate_apply(r, &s);
  return s;
}

static void test_integration(void **state)
{
  stic_rate_to_pose r;
  stic_device_sample s;

  (void)state;
  begin(&r, 0);
  /* 0.1 m/s and a quarter turn a second, for two seconds, at uneven times. */
  for (int64_t t = 0; t <= 2000; t += t % 3 == 0 ? 7 : 9)
    s = step(&r, t * MS, 0.1, STIC_PI / 2, 0);
  s = step(&r, 2010 * MS, 0, 0, 0);
  assert_near(s.position[0], 0.201, 1e-12);
  assert_near(2 * atan2(s.orientation[2], s.orientation[3]), STIC_PI / 2 * 2.01, 1e-9);
  assert_int_equal(s.flags, STIC_SAMPLE_VELOCITY | STIC_SAMPLE_POSITION | STIC_SAMPLE_ORIENTATION |
                              STIC_SAMPLE_TRACKED);
  s = step(&r, 3000 * MS, 0, 0, 0);
  assert_near(s.position[0], 0.201, 1e-12);
}

static void test_silence(void **state)
{
  stic_rate_to_pose r;
  stic_device_sample s;

  (void)state;
  begin(&r, 0);
  step(&r, 0, 1, 0, 0);
  /* A velocity holds 100 ms, no longer. */
  s = step(&r, 5000 * MS, 0, 0, 0);
  assert_near(s.position[0], 0.1, 1e-12);
  /* Lost: no velocity, not tracked, nothing moves; time that does not advance does no harm. */
  step(&r, 5001 * MS, 1, 0, 0);
  s = rate_sample(5002 * MS, 1, 1, 0);
  s.flags = 0;
  stic_rate_apply(&r, &s);
  assert_false(s.flags & STIC_SAMPLE_TRACKED);
  s = step(&r, 5100 * MS, 0, 0, 0);
  assert_near(s.position[0], 0.101, 1e-12);
  s = step(&r, 4000 * MS, 0, 0, 0);
  assert_near(s.position[0], 0.101, 1e-12);
}

static void test_buttons(void **state)
{
  stic_rate_to_pose r;
  stic_device_sample s;

  (void)state;
  begin(&r, 0);
  step(&r, 0, 1, 0, STIC_BUTTON_CLUTCH);
  s = step(&r, 50 * MS, 1, 0, STIC_BUTTON_CLUTCH);
  assert_true(s.position[0] == 0 && s.velocity[0] == 0);
  s = step(&r, 60 * MS, 1, 0, STIC_BUTTON_GRIP);
  assert_true(s.position[0] == 0);
  s = step(&r, 70 * MS, 1, 0, 0);
  assert_near(s.position[0], 0.01, 1e-12);
  s = step(&r, 80 * MS, 1, 0, STIC_BUTTON_RESET);
  assert_true(s.position[0] == 0);
  /* Held down it does not bring it home again. */
  s = step(&r, 90 * MS, 1, 0, STIC_BUTTON_RESET);
  assert_near(s.position[0], 0.01, 1e-12);
}

static void test_dead_zone(void **state)
{
  stic_rate_to_pose r;
  stic_device_sample s;

  (void)state;
  begin(&r, 0.02);
  step(&r, 0, 0.02, -0.02, 0);
  s = step(&r, 100 * MS, 0.12, 0, 0);
  assert_true(s.position[0] == 0 && s.orientation[2] == 0);
  s = step(&r, 200 * MS, -0.12, 0, 0);
  assert_near(s.position[0], 0.01, 1e-12);
  s = step(&r, 300 * MS, 0, 0, 0);
  assert_near(s.position[0], 0, 1e-12);
}

static void test_auto_zero(void **state)
{
  stic_rate_to_pose r;
  stic_device_sample s = rate_sample(0, 0, 0, 0);
  double drifted;

  (void)state;
  begin(&r, 0.02);
  /* Drift of one and a half dead zones: for a second it moves, then it is zero. */
  for (int i = 0; i <= 125; i++)
    s = step(&r, i * 8 * MS, 0.03, 0, 0);
  drifted = s.position[0];
  assert_near(drifted, 0.01, 1e-3);
  for (int i = 126; i < 1000; i++)
    s = step(&r, i * 8 * MS, 0.03, 0, 0);
  assert_near(s.position[0], drifted, 1e-3);
  /* A hand that pushes as softly but trembles is no drift. */
  begin(&r, 0.02);
  for (int i = 0; i < 1000; i++)
    s = step(&r, i * 8 * MS, 0.03 + 0.003 * (i % 2), 0, 0);
  assert_true(s.position[0] > 0.07);
  /* Nor is a fast constant push. */
  begin(&r, 0.02);
  for (int i = 0; i < 1000; i++)
    s = step(&r, i * 8 * MS, 0.05, 0, 0);
  assert_near(s.position[0], 0.03 * 7.992, 1e-9);
}

/* ---- filter ------------------------------------------------------------------------------ */

static stic_device_sample pose_sample(int64_t t_ns, double x, double angle)
{
  stic_device_sample s;

  memset(&s, 0, sizeof s);
  s.t_ns = t_ns;
  s.position[0] = x;
  s.orientation[2] = sin(angle / 2);
  s.orientation[3] = cos(angle / 2);
  s.flags = STIC_SAMPLE_POSITION | STIC_SAMPLE_ORIENTATION | STIC_SAMPLE_TRACKED;
  return s;
}

static void begin_filter(stic_one_euro *f)
{
  stic_one_euro_settings settings;

  stic_one_euro_settings_init(&settings);
  stic_one_euro_begin(f, &settings);
}

static double angle_of(const stic_device_sample *s)
{
  return 2 * atan2(s->orientation[2], s->orientation[3]);
}

static void test_filter_rest(void **state)
{
  stic_one_euro f;
  double worst = 0, worst_angle = 0;

  (void)state;
  begin_filter(&f);
  for (int i = 0; i < 500; i++) {
    const double tremble = i % 2 ? 1e-3 : -1e-3;
    stic_device_sample s = pose_sample(i * 20 * MS, 1 + tremble, 0.5 + tremble);

    stic_one_euro_apply(&f, &s);
    if (i > 100) {
      worst = fmax(worst, fabs(s.position[0] - 1));
      worst_angle = fmax(worst_angle, fabs(angle_of(&s) - 0.5));
    }
  }
  print_message("tremble of 1 mm and 1 mrad left: %.3f mm, %.3f mrad\n", worst * 1e3, worst_angle * 1e3);
  assert_true(worst < 2e-4 && worst_angle < 2e-4);
}

/* The first step against the formula; a step lost in between is a longer step, not a slower one. */
static void test_filter_formula(void **state)
{
  stic_one_euro f;
  stic_device_sample a = pose_sample(0, 0, 0), b = pose_sample(20 * MS, 0.01, 0);
  const double dt = 0.02, ad = dt / (dt + 1 / (2 * STIC_PI * 1.2)), speed = ad * 0.5;
  const double cutoff = 1.15 + 0.5 * speed, weight = dt / (dt + 1 / (2 * STIC_PI * cutoff));

  (void)state;
  begin_filter(&f);
  stic_one_euro_apply(&f, &a);
  assert_true(a.position[0] == 0);
  stic_one_euro_apply(&f, &b);
  assert_near(b.position[0], weight * 0.01, 1e-15);
}

static void test_filter_gap(void **state)
{
  stic_one_euro f;
  stic_device_sample s = pose_sample(0, 0, 0);

  (void)state;
  begin_filter(&f);
  stic_one_euro_apply(&f, &s);
  s = pose_sample(20 * MS, 0, 0);
  s.flags = STIC_SAMPLE_POSITION;
  s.position[0] = 7;
  stic_one_euro_apply(&f, &s);
  assert_true(s.position[0] == 7);
  s = pose_sample(40 * MS, 3, 1);
  stic_one_euro_apply(&f, &s);
  assert_true(s.position[0] == 3);
  /* Equal times and the other sign of the quaternion. */
  s = pose_sample(40 * MS, 4, 1);
  stic_one_euro_apply(&f, &s);
  assert_true(s.position[0] == 4);
  s = pose_sample(60 * MS, 4, 1 + 2 * STIC_PI);
  stic_one_euro_apply(&f, &s);
  assert_near(remainder(angle_of(&s) - 1, 2 * STIC_PI), 0, 1e-12);
}

/* ---- place in the room ------------------------------------------------------------------- */

static void test_frame_identity(void **state)
{
  stic_tracker_frame frame;
  stic_device_sample s = pose_sample(5, 0.123456789, 0.7), before;

  (void)state;
  s.buttons = 7;
  before = s;
  stic_tracker_frame_init(&frame);
  stic_tracker_frame_apply(&frame, &s);
  assert_memory_equal(s.position, before.position, sizeof s.position);
  for (int i = 0; i < 4; i++)
    assert_near(s.orientation[i], before.orientation[i], 1e-16);
  assert_int_equal(s.buttons, 7);
}

/* Turned by 90 degrees about z: the device's x is the room's y. */
static void test_frame_turned(void **state)
{
  static const double turned[9] = {0, -1, 0, 1, 0, 0, 0, 0, 1}, back[9] = {0, 1, 0, -1, 0, 0, 0, 0, 1};
  stic_tracker_frame frame;
  stic_device_sample s = pose_sample(5, 0.5, 0.3);

  (void)state;
  stic_tracker_frame_init(&frame);
  memcpy(frame.axes, turned, sizeof turned);
  memcpy(frame.hand_axes, back, sizeof back);
  frame.scale = 2;
  frame.offset[2] = -1;
  frame.buttons[0] = 5;
  frame.buttons[1] = -1;
  frame.buttons[2] = 0;
  s.velocity[0] = 1;
  s.turn_rate[1] = 1;
  s.buttons = 1u << 5 | 2u;
  stic_tracker_frame_apply(&frame, &s);
  assert_near(s.position[0], 0, 1e-15);
  assert_near(s.position[1], 1, 1e-15);
  assert_near(s.position[2], -1, 1e-15);
  assert_near(s.velocity[1], 2, 1e-15);
  assert_near(s.turn_rate[0], -1, 1e-15);
  assert_near(angle_of(&s), 0.3, 1e-14);
  assert_int_equal(s.buttons, STIC_BUTTON_GRIP);
  /* Without the hand's own axes the device's mounting shows in the angle. */
  stic_tracker_frame_init(&frame);
  memcpy(frame.axes, turned, sizeof turned);
  s = pose_sample(5, 0, 0.3);
  stic_tracker_frame_apply(&frame, &s);
  assert_near(angle_of(&s), 0.3 + STIC_PI / 2, 1e-14);
}

static void test_matrices(void **state)
{
  const double mirror[9] = {1, 0, 0, 0, 1, 0, 0, 0, -1}, stretched[9] = {1.1, 0, 0, 0, 1, 0, 0, 0, 1};
  double turn[3], q[4], m[9];

  (void)state;
  assert_false(stic_is_proper_rotation(mirror));
  assert_false(stic_is_proper_rotation(stretched));
  /* Turns up to half a circle, all octants: to a quaternion, to a matrix, and back. */
  for (int i = 0; i < 343; i++) {
    double back[4], sign;

    turn[0] = (i % 7 - 3) * 0.55;
    turn[1] = (i / 7 % 7 - 3) * 0.55;
    turn[2] = (i / 49 - 3) * 0.55;
    stic_quaternion_from_turn(turn, q);
    for (int c = 0; c < 3; c++) {
      const double e[4] = {c == 0, c == 1, c == 2, 0}, inverse[4] = {-q[0], -q[1], -q[2], q[3]};
      double v[4];

      stic_quaternion_multiply(q, e, v);
      stic_quaternion_multiply(v, inverse, v);
      for (int row = 0; row < 3; row++)
        m[3 * row + c] = v[row];
    }
    assert_true(stic_is_proper_rotation(m));
    stic_quaternion_from_matrix(m, back);
    sign = back[0] * q[0] + back[1] * q[1] + back[2] * q[2] + back[3] * q[3];
    assert_near(fabs(sign), 1, 1e-14);
    stic_quaternion_to_turn(q, m);
    stic_quaternion_from_turn(m, back);
    sign = back[0] * q[0] + back[1] * q[1] + back[2] * q[2] + back[3] * q[3];
    assert_near(fabs(sign), 1, 1e-14);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_integration),    cmocka_unit_test(test_silence),
    cmocka_unit_test(test_buttons),        cmocka_unit_test(test_dead_zone),
    cmocka_unit_test(test_auto_zero),      cmocka_unit_test(test_filter_rest),
    cmocka_unit_test(test_filter_formula), cmocka_unit_test(test_filter_gap),
    cmocka_unit_test(test_frame_identity), cmocka_unit_test(test_frame_turned),
    cmocka_unit_test(test_matrices),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}

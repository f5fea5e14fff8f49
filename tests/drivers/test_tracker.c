/* Tracker files: what they set, every way in which one can be wrong, and a sample's way through it. */
#include "../../drivers/motion/tracker_yaml.h"
#include "../files/help.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define HEAD "stiction: 1\ntracker:\n"

static const stic_test_wrong wrong[] = {
  {"", 1, "no tracker section"},
  {"stiction: 1\n", 1, "no tracker section; expected tracker:"},
  {"tracker: {}\n", 1, "stiction is missing"},
  {"stiction: 2\ntracker: {}\n", 1, "stiction is '2'; expected the format version, 1"},
  {"- 1\n", 1, "expected a mapping with stiction"},
  {"stiction: 1\ntracker: 5\n", 2, "tracker is '5'; expected a mapping"},
  {"stiction: 1\ntracker: {}\ntracker: {}\n", 3, "given again, first in line 2"},
  {"stiction: 1\ntracker: &a {}\n", 2, "anchor"},
  {"stiction: 1\ntracker: [\n", 3, "not valid YAML"},
  {HEAD "  scale: 1\n---\na: 1\n", 5, "second document; expected one tracker"},
  {HEAD "  axis: [x, y, z]\n", 3, "unknown key 'axis' in tracker; expected axes, hand_axes, scale"},
  {HEAD "  axes: [x, y, -z]\n", 3, "rotation and no mirror"},
  {HEAD "  axes: [x, x, z]\n", 3, "rotation and no mirror"},
  {HEAD "  axes: [x, y]\n", 3, "a list of 2; expected three of x"},
  {HEAD "  axes:\n  - x\n  - w\n  - z\n", 5, "'w'; expected three of x"},
  {HEAD "  axes: [1, 0, 0, 0, 1, 0, 0, 0, 1.001]\n", 3, "rotation and no mirror"},
  {HEAD "  axes: [1, 0, 0, 0, .nan, 0, 0, 0, 1]\n", 3, "'.nan'"},
  {HEAD "  hand_axes: 3\n", 3, "tracker.hand_axes is '3'"},
  {HEAD "  scale: 0\n", 3, "tracker.scale is '0'; expected a number >= 0.001 and <= 1000"},
  {HEAD "  scale: [1]\n", 3, "a list of 1; expected a number"},
  {HEAD "  offset: [0, 0]\n", 3, "a list of 2; expected a list of 3 numbers, each within +-1e+06 m"},
  {HEAD "  offset: [0, 0, '1']\n", 3, "'1' in quotes"},
  {HEAD "  buttons: {grip: 32}\n", 3, "tracker.buttons.grip is '32'; expected a bit from 0 to 31, or none"},
  {HEAD "  buttons: {grab: 1}\n", 3, "unknown key 'grab' in tracker.buttons; expected grip, reset, clutch"},
  {HEAD "  filter: {min_cutoff: [0, 1]}\n", 3, "'0'; expected a list of 2 numbers, each > 0 and <= 1000 Hz"},
  {HEAD "  filter: on\n", 3, "expected a mapping"},
  {HEAD "  rate: {auto_zero: yes}\n", 3, "'yes'; expected true or false"},
  {HEAD "  rate: {dead_zone: [0, -1]}\n", 3, "'-1'"},
};

static stic_status read_tracker(const char *path, stic_error *err)
{
  stic_tracker_settings settings;
  const stic_status status = stic_tracker_read(path, NULL, true, &settings, err);

  assert_true(settings.frame.scale == 1);
  return status;
}

static void test_wrong(void **state)
{
  (void)state;
  stic_test_wrong_files(wrong, sizeof wrong / sizeof wrong[0], read_tracker);
}

static void test_absent(void **state)
{
  stic_tracker_settings settings;
  stic_error err;

  (void)state;
  assert_int_equal(stic_tracker_read("/no/such/file", NULL, false, &settings, &err), STIC_BAD_INPUT);
  stic_test_contains(err.message, "cannot open the tracker");
  assert_int_equal(
    stic_tracker_read(stic_test_write("s.yaml", stic_test_scene), NULL, false, &settings, &err), STIC_OK);
  assert_false(settings.filtered);
  assert_true(settings.frame.buttons[0] == 0 && settings.frame.axes[0] == 1 && settings.rate.linear == 1);
}

/* A scene may have the section; its own reader leaves it alone. */
static void test_in_scene(void **state)
{
  char text[2048];
  stic_tracker_settings settings;
  stic_scene scene;
  stic_error err;
  const char *path;

  (void)state;
  snprintf(text, sizeof text, "%stracker: {scale: 2, axes: [x, -z, y]}\n", stic_test_scene);
  path = stic_test_write("s.yaml", text);
  assert_int_equal(stic_scene_read(path, NULL, 0, &scene, &err), STIC_OK);
  assert_int_equal(stic_tracker_read(path, NULL, true, &settings, &err), STIC_OK);
  assert_true(settings.frame.scale == 2);
}

static void test_all_keys(void **state)
{
  static const double axes[9] = {1, 0, 0, 0, 0, -1, 0, 1, 0}, hand[9] = {1, 0, 0, 0, 0, 1, 0, -1, 0};
  stic_tracker_settings s;
  stic_error err;

  (void)state;
  assert_int_equal(
    stic_tracker_read(
      stic_test_write(
        "t.yaml", HEAD
        "  axes: [x, -z, y]\n  scale: 0.5\n  offset: [1, 2, 3]\n  buttons: {grip: 5, reset: none, clutch: 31}\n"
        "  filter: {min_cutoff: [1, 2], beta: [3, 4], derivative_cutoff: [5, 6]}\n"
        "  rate: {linear: 2, angular: 3, dead_zone: [0.1, 0.2], auto_zero: false, home: [7, 8, 9]}\n"),
      NULL, true, &s, &err),
    STIC_OK);
  assert_memory_equal(s.frame.axes, axes, sizeof axes);
  assert_memory_equal(s.frame.hand_axes, hand, sizeof hand);
  assert_true(s.frame.scale == 0.5 && s.frame.offset[2] == 3);
  assert_true(s.frame.buttons[0] == 5 && s.frame.buttons[1] == -1 && s.frame.buttons[2] == 31);
  assert_true(s.filtered && s.filter.min_cutoff[1] == 2 && s.filter.beta[0] == 3 &&
              s.filter.derivative_cutoff[1] == 6);
  assert_true(s.rate.linear == 2 && s.rate.angular == 3 && s.rate.dead_zone[1] == 0.2 && !s.rate.auto_zero &&
              s.rate.home_position[0] == 7);
  assert_int_equal(
    stic_tracker_read(stic_test_write("t.yaml", HEAD "  hand_axes: [x, z, -y]\n  filter: {}\n"), NULL, true,
                      &s, &err),
    STIC_OK);
  /* The hand's y is the part's z, its z the part's -y. */
  assert_true(s.frame.hand_axes[7] == 1 && s.frame.hand_axes[5] == -1 && s.filtered &&
              s.filter.beta[0] == 0.5);
}

/* A puck pushed along its own z, mounted so that this is up, moves the hand up from its home. */
static void test_way(void **state)
{
  stic_tracker_settings settings;
  stic_tracker tracker;
  stic_device_sample s;
  stic_error err;

  (void)state;
  assert_int_equal(
    stic_tracker_read(
      stic_test_write(
        "t.yaml", HEAD
        "  axes: [x, z, -y]\n  scale: 2\n  buttons: {grip: 3}\n  rate: {dead_zone: [0, 0], home: [0, 1, 0]}\n"),
      NULL, true, &settings, &err),
    STIC_OK);
  stic_tracker_begin(&tracker, &settings, STIC_DRIVER_RATE);
  for (int i = 0; i <= 10; i++) {
    memset(&s, 0, sizeof s);
    s.t_ns = i * INT64_C(10000000);
    s.velocity[2] = 0.1;
    s.flags = STIC_SAMPLE_VELOCITY;
    s.buttons = 8;
    stic_tracker_apply(&tracker, &s);
  }
  assert_true(fabs(s.position[1] - 1.02) < 1e-12 && s.position[0] == 0 && s.orientation[3] == 1);
  assert_int_equal(s.buttons, STIC_BUTTON_GRIP);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_wrong),    cmocka_unit_test(test_absent), cmocka_unit_test(test_in_scene),
    cmocka_unit_test(test_all_keys), cmocka_unit_test(test_way),
  };

  return cmocka_run_group_tests(tests, NULL, stic_test_clean_up);
}

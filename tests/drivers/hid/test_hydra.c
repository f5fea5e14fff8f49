/* Razer Hydra: decoder, hemisphere, mode switch, driver. */
#include "fake_hid.h"
#include "vectors.h"

#include "../../../drivers/hydra/hydra_decode.h"
#include "../../../drivers/hydra/hydra_mode.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOTION_SIDE 0x1532, 0x0300, 0x01, 0x00
#define GAMEPAD_SIDE 0x1532, 0x0300, 0x01, 0x05
#define SECOND INT64_C(1000000000)

static void assert_near(double got, double expected, double tolerance)
{
  if (!(fabs(got - expected) <= tolerance))
    fail_msg("%.17g, expected %.17g", got, expected);
}

static stic_hydra_result decode(const uint8_t *report, size_t length, stic_hydra_report *out)
{
  uint8_t *exact = malloc(length > 0 ? length : 1);
  stic_hydra_result result;

  assert_non_null(exact);
  memcpy(exact, report, length);
  result = stic_hydra_decode(exact, length, out);
  free(exact);
  return result;
}

/* ---- decoder ----------------------------------------------------------------------------- */

static void test_crc(void **state)
{
  (void)state;
  /* the check value of this CRC-16 for "123456789" in the catalogues of CRCs */
  assert_int_equal(stic_hydra_crc((const uint8_t *)"123456789", 9), 0xe5cc);
  assert_int_equal(stic_hydra_crc(stic_hydra_captured, 50), 0x8dff);
}

/* Position (X, -Z, Y) in m; quaternion vector part likewise, over its norm. */
static void test_captured(void **state)
{
  const double left_norm = sqrt(8481. * 8481 + 31100. * 31100 + 1825. * 1825 + 5581. * 5581);
  stic_hydra_report report;
  const stic_hydra_wand *left = &report.wands[STIC_HYDRA_LEFT], *right = &report.wands[STIC_HYDRA_RIGHT];

  (void)state;
  assert_int_equal(decode(stic_hydra_captured, 52, &report), STIC_HYDRA_OK);
  assert_int_equal(report.sequence, 0x63);
  assert_near(left->position[0], 0.047, 1e-15);
  assert_near(left->position[1], 0.052, 1e-15);
  assert_near(left->position[2], -0.065, 1e-15);
  assert_near(right->position[0], -0.042, 1e-15);
  assert_near(right->position[1], 0.054, 1e-15);
  assert_near(right->position[2], -0.068, 1e-15);
  assert_near(left->orientation[0], 31100 / left_norm, 1e-15);
  assert_near(left->orientation[1], 5581 / left_norm, 1e-15);
  assert_near(left->orientation[2], 1825 / left_norm, 1e-15);
  assert_near(left->orientation[3], -8481 / left_norm, 1e-15);
  assert_int_equal(left->keys, 0); /* bit 7 is no key */
  assert_true(left->trigger == 0 && left->stick[0] == 0 && left->stick[1] == 0);
}

static void test_controls(void **state)
{
  static const int mm[3] = {100, 200, 300};
  uint8_t bytes[52];
  stic_hydra_report report;
  const stic_hydra_wand *right = &report.wands[STIC_HYDRA_RIGHT];

  (void)state;
  stic_make_hydra(bytes, 7, mm, 255);
  bytes[44] = 0x80 | STIC_HYDRA_BUMPER | STIC_HYDRA_STICK;
  bytes[45] = 0x00; /* stick x = 0x4000 = half */
  bytes[46] = 0x40;
  bytes[47] = 0x00; /* stick y = -32768 */
  bytes[48] = 0x80;
  stic_seal_hydra(bytes);
  assert_int_equal(decode(bytes, 52, &report), STIC_HYDRA_OK);
  assert_int_equal(right->keys, STIC_HYDRA_BUMPER | STIC_HYDRA_STICK);
  assert_true(right->stick[0] == 0.5 && right->stick[1] == -1 && right->trigger == 1);
}

static void test_cut(void **state)
{
  uint8_t longer[64] = {0};

  (void)state;
  memcpy(longer, stic_hydra_captured, 52);
  for (size_t length = 0; length <= sizeof longer; length++) {
    stic_hydra_report report;

    assert_int_equal(decode(longer, length, &report), length == 52 ? STIC_HYDRA_OK : STIC_HYDRA_OTHER);
  }
}

/* A CRC-16 finds every error within 16 bits, so every byte at every other value. */
static void test_every_byte(void **state)
{
  (void)state;
  for (size_t at = 0; at < 52; at++) {
    for (int flip = 1; flip < 256; flip++) {
      uint8_t bytes[52];
      stic_hydra_report report;

      memcpy(bytes, stic_hydra_captured, 52);
      bytes[at] ^= (uint8_t)flip;
      assert_int_equal(decode(bytes, 52, &report), STIC_HYDRA_BAD_CHECKSUM);
    }
  }
}

static void test_right_checksum_wrong_content(void **state)
{
  uint8_t bytes[52];
  stic_hydra_report report;

  (void)state;
  memcpy(bytes, stic_hydra_captured, 52);
  bytes[2] = 0x33;
  stic_seal_hydra(bytes);
  assert_int_equal(decode(bytes, 52, &report), STIC_HYDRA_BAD_HEADER);
  memcpy(bytes, stic_hydra_captured, 52);
  memset(bytes + 14, 0, 8);
  stic_seal_hydra(bytes);
  assert_int_equal(decode(bytes, 52, &report), STIC_HYDRA_BAD_ROTATION);
}

static void test_command(void **state)
{
  uint8_t feature[STIC_HYDRA_FEATURE_LENGTH];
  uint8_t expected[STIC_HYDRA_FEATURE_LENGTH] = {0};

  (void)state;
  expected[6] = 1;
  expected[8] = 4;
  expected[9] = 3;
  expected[89] = 1 ^ 4 ^ 3;
  stic_hydra_mode_command(true, feature);
  assert_memory_equal(feature, expected, sizeof expected);
  expected[9] = 0;
  expected[89] = 1 ^ 4;
  stic_hydra_mode_command(false, feature);
  assert_memory_equal(feature, expected, sizeof expected);
}

static void test_grip(void **state)
{
  (void)state;
  assert_false(stic_hydra_grips(false, 0.5));
  assert_true(stic_hydra_grips(false, 0.51));
  assert_true(stic_hydra_grips(true, 0.4));
  assert_false(stic_hydra_grips(true, 0.39));
}

/* ---- hemisphere -------------------------------------------------------------------------- */

static void test_first_hemisphere(void **state)
{
  static const struct {
    int wand;
    double position[3];
    bool mirrored;
  } cases[] = {
    {STIC_HYDRA_LEFT, {0.047, 0.052, -0.065}, true}, /* in the dock on the wrong side: the captured one */
    {STIC_HYDRA_RIGHT, {-0.042, 0.054, -0.068}, true},
    {STIC_HYDRA_LEFT, {-0.047, 0.01, -0.03}, false},
    {STIC_HYDRA_RIGHT, {0.047, 0.01, -0.03}, false},
    {STIC_HYDRA_RIGHT, {-0.2, 0.1, 0.3}, false}, /* out of the dock: on the user's side */
    {STIC_HYDRA_RIGHT, {0.2, 0.1, -0.3}, true},
  };

  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    stic_hydra_hemisphere hemisphere = {0};
    double position[3];

    memcpy(position, cases[i].position, sizeof position);
    stic_hydra_keep_hemisphere(&hemisphere, cases[i].wand, position);
    for (int axis = 0; axis < 3; axis++)
      assert_true(position[axis] == (cases[i].mirrored ? -1 : 1) * cases[i].position[axis]);
  }
}

/* A circle of 0.4 m around the base, the sign wrong in every third report: the path stays whole. */
static void test_path_stays_whole(void **state)
{
  stic_hydra_hemisphere hemisphere = {0};

  (void)state;
  for (int i = 0; i < 500; i++) {
    const double angle = 2 * 3.14159265358979 * i / 250;
    const double truth[3] = {0.4 * sin(angle), 0.1, 0.4 * cos(angle)};
    double position[3];

    for (int axis = 0; axis < 3; axis++)
      position[axis] = i % 3 == 2 ? -truth[axis] : truth[axis];
    stic_hydra_keep_hemisphere(&hemisphere, STIC_HYDRA_RIGHT, position);
    assert_memory_equal(position, truth, sizeof truth);
  }
}

/* ---- mode -------------------------------------------------------------------------------- */

static void test_mode_times(void **state)
{
  stic_hydra_mode mode;

  (void)state;
  stic_hydra_mode_start(&mode, 0);
  assert_int_equal(stic_hydra_mode_next(&mode, SECOND - 1), STIC_HYDRA_WAIT);
  for (int i = 0; i < 4; i++) {
    assert_int_equal(stic_hydra_mode_next(&mode, SECOND + 5 * i * SECOND), STIC_HYDRA_COMMAND);
    assert_int_equal(stic_hydra_mode_next(&mode, 6 * SECOND + 5 * i * SECOND - 1), STIC_HYDRA_WAIT);
  }
  assert_int_equal(stic_hydra_mode_next(&mode, 21 * SECOND), STIC_HYDRA_GIVE_UP);
  stic_hydra_mode_heard(&mode, 30 * SECOND);
  assert_int_equal(stic_hydra_mode_next(&mode, 31 * SECOND - 1), STIC_HYDRA_WAIT);
  assert_int_equal(stic_hydra_mode_next(&mode, 31 * SECOND), STIC_HYDRA_COMMAND);
}

/* ---- driver ------------------------------------------------------------------------------ */

static const int hand_mm[3] = {100, 300, -200}; /* raw: right, toward the user, up */

/* The device switches at once: sends ten reports at 250 Hz from its motion side, if the command is right. */
static void obey(stic_fake_hid *hid, int node, const uint8_t *data, size_t length)
{
  uint8_t command[STIC_HYDRA_FEATURE_LENGTH];

  (void)node;
  stic_hydra_mode_command(true, command);
  if (length != sizeof command || memcmp(data, command, sizeof command) != 0)
    return;
  for (int i = 0; i < 10; i++) {
    uint8_t report[52];

    stic_make_hydra(report, (uint8_t)i, hand_mm, i < 5 ? 200 : 50);
    stic_fake_send(hid, 0, 4 * STIC_MS * (i + 1), report, sizeof report);
  }
}

/* It takes commands on one side only. */
static void obey_motion_side(stic_fake_hid *hid, int node, const uint8_t *data, size_t length)
{
  if (node == 0)
    obey(hid, node, data, length);
}

static void plug_both(stic_fake_hid *hid)
{
  stic_fake_init(hid);
  stic_fake_plug(hid, 0, MOTION_SIDE);
  stic_fake_plug(hid, 1, GAMEPAD_SIDE);
}

static void test_switch_and_run(void **state)
{
  stic_fake_hid hid;
  stic_device_sample samples[16];
  stic_device *device;
  char text[300];
  int64_t start;

  (void)state;
  plug_both(&hid);
  hid.on_feature = obey;
  device = stic_fake_open(&hid, "hydra:hand=right");
  start = hid.now_ns;
  assert_int_equal(device->state, STIC_CONNECTION_SYNCING);
  assert_int_equal(stic_fake_poll(&hid, device, 900 * STIC_MS, samples, 16), 0);
  assert_int_equal(hid.sent_count, 0); /* it listens for a second */
  assert_int_equal(hid.now_ns - start, 900 * STIC_MS);
  assert_int_equal(stic_fake_poll(&hid, device, 2 * SECOND, samples, 16), 1);
  assert_int_equal(hid.sent_count, 1);
  assert_int_equal(hid.sent[0].node, 1); /* the gamepad side takes it first */
  assert_int_equal(hid.features_got, 1);
  assert_int_equal(device->state, STIC_CONNECTION_RUNNING);
  assert_near(samples[0].position[0], 0.1, 1e-15);
  assert_near(samples[0].position[1], 0.2, 1e-15);
  assert_near(samples[0].position[2], 0.3, 1e-15);
  assert_true(samples[0].orientation[3] == 1);
  assert_int_equal(samples[0].flags, STIC_SAMPLE_POSITION | STIC_SAMPLE_ORIENTATION | STIC_SAMPLE_TRACKED);
  for (int i = 1; i < 10; i++) {
    assert_int_equal(stic_fake_poll(&hid, device, SECOND / 10, samples, 16), 1);
    assert_int_equal(samples[0].buttons & STIC_BUTTON_GRIP, i < 5);
    assert_int_equal(samples[0].sequence, i + 1);
  }
  stic_device_describe(device, text, sizeof text);
  assert_string_equal(text, "Razer Hydra 1532:0300 at /dev/fake0 (fake), right hand");
  stic_device_close(device);
  assert_int_equal(hid.sent_count, 2); /* back to a gamepad, where the switch worked */
  assert_int_equal(hid.sent[1].node, 1);
  assert_int_equal(hid.sent[1].data[9], 0);
}

static void test_other_side_takes_command(void **state)
{
  stic_fake_hid hid;
  stic_device_sample sample;
  stic_device *device;

  (void)state;
  plug_both(&hid);
  hid.on_feature = obey_motion_side;
  device = stic_fake_open(&hid, "hydra");
  assert_int_equal(stic_fake_poll(&hid, device, 10 * SECOND, &sample, 1), 1);
  assert_int_equal(hid.sent_count, 2);
  assert_int_equal(hid.sent[1].node, 0);
  stic_device_close(device);
}

/* A backend that tells no usages, and lists the gamepad side first. */
static void test_unknown_usages(void **state)
{
  stic_fake_hid hid;
  stic_device_sample sample;
  stic_device *device;
  uint8_t report[52];
  char text[300];

  (void)state;
  stic_fake_init(&hid);
  stic_fake_plug(&hid, 0, 0x1532, 0x0300, 0, 0);
  stic_fake_plug(&hid, 1, 0x1532, 0x0300, 0, 0);
  device = stic_fake_open(&hid, "hydra:hand=left");
  stic_make_hydra(report, 1, hand_mm, 0);
  for (int i = 0; i < 5; i++) {
    stic_fake_send(&hid, 0, 1 * STIC_MS * i, "gamepad data", 12);
    stic_fake_send(&hid, 1, 4 * STIC_MS * i, report, sizeof report);
  }
  assert_int_equal(stic_fake_poll(&hid, device, SECOND / 2, &sample, 1), 1);
  assert_int_equal(device->state, STIC_CONNECTION_RUNNING);
  assert_int_equal(device->counters.bad_records, 0);
  assert_int_equal(hid.sent_count, 0); /* it was in motion mode, so it stays in it */
  stic_device_describe(device, text, sizeof text);
  assert_string_equal(text, "Razer Hydra 1532:0300 at /dev/fake1 (fake), left hand");
  stic_device_close(device);
  assert_int_equal(hid.sent_count, 0);
}

static void test_gives_up(void **state)
{
  stic_fake_hid hid;
  stic_device_sample sample;
  stic_device *device;

  (void)state;
  plug_both(&hid);
  device = stic_fake_open(&hid, "hydra");
  assert_int_equal(stic_fake_poll(&hid, device, 20 * SECOND, &sample, 1), 0);
  assert_int_equal(device->state, STIC_CONNECTION_RESETTING);
  assert_int_equal(hid.sent_count, 4);
  assert_int_equal(hid.sent[0].node, 1);
  assert_int_equal(hid.sent[1].node, 0);
  assert_int_equal(stic_fake_poll(&hid, device, 20 * SECOND, &sample, 1), STIC_DRIVER_LOST);
  assert_non_null(strstr(device->error.message, "does not switch to motion reports"));
  stic_device_close(device);
  assert_int_equal(hid.sent_count, 4);
}

static void test_garbage_and_gaps(void **state)
{
  stic_fake_hid hid;
  stic_device_sample samples[64];
  stic_device *device;
  uint8_t report[52];

  (void)state;
  plug_both(&hid);
  device = stic_fake_open(&hid, "hydra");
  stic_make_hydra(report, 1, hand_mm, 0);
  stic_fake_send(&hid, 0, 0, report, 52);
  for (size_t at = 0; at < 52; at++) {
    report[at] ^= 0x10;
    stic_fake_send(&hid, 0, 0, report, 52);
    report[at] ^= 0x10;
  }
  for (size_t length = 1; length < 52; length++)
    stic_fake_send(&hid, 0, 0, report, length);
  stic_make_hydra(report, 5, hand_mm, 0);
  stic_fake_send(&hid, 0, 0, report, 52);
  assert_int_equal(stic_fake_poll(&hid, device, 0, samples, 64), 2);
  assert_int_equal(device->counters.bad_records, 52 + 51);
  assert_int_equal(device->counters.gaps, 1);
  assert_int_equal(samples[1].sequence - samples[0].sequence, 4);
  stic_device_close(device);
}

/* Falls back to a gamepad in the middle of a run: is told again after a second. */
static void test_stops_and_is_told_again(void **state)
{
  stic_fake_hid hid;
  stic_device_sample sample;
  stic_device *device;
  uint8_t report[52];

  (void)state;
  plug_both(&hid);
  device = stic_fake_open(&hid, "hydra");
  stic_make_hydra(report, 1, hand_mm, 0);
  stic_fake_send(&hid, 0, 0, report, 52);
  assert_int_equal(stic_fake_poll(&hid, device, 0, &sample, 1), 1);
  hid.on_feature = obey;
  assert_int_equal(stic_fake_poll(&hid, device, SECOND - STIC_MS, &sample, 1), 0);
  assert_int_equal(hid.sent_count, 0);
  assert_int_equal(stic_fake_poll(&hid, device, SECOND, &sample, 1), 1);
  assert_int_equal(hid.sent_count, 1);
  stic_device_close(device);
}

/* Pulled out at every moment of a run, then plugged in elsewhere. */
static void test_unplug_at_every_moment(void **state)
{
  (void)state;
  for (int moment = 0; moment < 40; moment++) {
    stic_fake_hid hid;
    stic_device_sample samples[4];
    stic_device *device;
    int result = 0;

    plug_both(&hid);
    hid.on_feature = obey;
    device = stic_fake_open(&hid, "hydra");
    for (int turn = 0; turn < moment; turn++)
      result = stic_fake_poll(&hid, device, 50 * STIC_MS, samples, 4);
    assert_true(result >= 0);
    stic_fake_unplug(&hid, 0);
    stic_fake_unplug(&hid, 1);
    assert_int_equal(stic_fake_poll(&hid, device, 50 * STIC_MS, samples, 4), STIC_DRIVER_LOST);
    assert_int_equal(device->state, STIC_CONNECTION_LOST);
    stic_device_close(device);
    stic_fake_plug(&hid, 2, GAMEPAD_SIDE);
    stic_fake_plug(&hid, 3, MOTION_SIDE);
    device = stic_fake_open(&hid, "hydra");
    stic_device_close(device);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_crc),
                                     cmocka_unit_test(test_captured),
                                     cmocka_unit_test(test_controls),
                                     cmocka_unit_test(test_cut),
                                     cmocka_unit_test(test_every_byte),
                                     cmocka_unit_test(test_right_checksum_wrong_content),
                                     cmocka_unit_test(test_command),
                                     cmocka_unit_test(test_grip),
                                     cmocka_unit_test(test_first_hemisphere),
                                     cmocka_unit_test(test_path_stays_whole),
                                     cmocka_unit_test(test_mode_times),
                                     cmocka_unit_test(test_switch_and_run),
                                     cmocka_unit_test(test_other_side_takes_command),
                                     cmocka_unit_test(test_unknown_usages),
                                     cmocka_unit_test(test_gives_up),
                                     cmocka_unit_test(test_garbage_and_gaps),
                                     cmocka_unit_test(test_stops_and_is_told_again),
                                     cmocka_unit_test(test_unplug_at_every_moment)};

  return cmocka_run_group_tests(tests, NULL, NULL);
}

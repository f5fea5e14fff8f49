/* DualSense: decoder and driver, over USB and Bluetooth. */
#include "fake_hid.h"
#include "vectors.h"

#include "../../../drivers/gamepad/gamepad_decode.h"

#include <stdlib.h>
#include <string.h>

#define DUALSENSE 0x054c, 0x0ce6, 0x01, 0x05

static stic_gamepad_result decode(const uint8_t *report, size_t length, stic_gamepad *pad)
{
  uint8_t *exact = malloc(length > 0 ? length : 1);
  stic_gamepad_result result;

  assert_non_null(exact);
  memcpy(exact, report, length);
  result = stic_gamepad_decode(exact, length, pad);
  free(exact);
  return result;
}

/* ---- decoder ----------------------------------------------------------------------------- */

static void test_crc(void **state)
{
  (void)state;
  /* CRC-32 of the ten bytes a1 "123456789", by zlib */
  assert_int_equal(stic_gamepad_crc((const uint8_t *)"123456789", 9), 0x88ed2411u);
}

static void test_rest(void **state)
{
  uint8_t usb[64], bluetooth[78];
  stic_gamepad pads[2];

  (void)state;
  stic_make_pad_usb(usb, 9);
  stic_make_pad_bluetooth(bluetooth, 9);
  assert_int_equal(decode(usb, sizeof usb, &pads[0]), STIC_GAMEPAD_OK);
  assert_int_equal(decode(bluetooth, sizeof bluetooth, &pads[1]), STIC_GAMEPAD_OK);
  for (int i = 0; i < 2; i++) {
    assert_true(pads[i].left[0] == 0 && pads[i].left[1] == 0 && pads[i].right[0] == 0 &&
                pads[i].right[1] == 0);
    assert_true(pads[i].l2 == 0 && pads[i].r2 == 0 && pads[i].hat[0] == 0 && pads[i].hat[1] == 0);
    assert_int_equal(pads[i].buttons, 0);
    assert_int_equal(pads[i].sequence, 9);
  }
}

static void test_sticks(void **state)
{
  uint8_t usb[64];
  stic_gamepad pad;

  (void)state;
  stic_make_pad_usb(usb, 0);
  usb[1] = 255; /* left stick right, */
  usb[2] = 0;   /* up */
  usb[3] = 0;   /* right stick left, */
  usb[4] = 255; /* down */
  usb[5] = 51;  /* 51 / 255 = 0.2 */
  usb[6] = 255;
  assert_int_equal(decode(usb, sizeof usb, &pad), STIC_GAMEPAD_OK);
  assert_true(pad.left[0] == 1 && pad.left[1] == 1 && pad.right[0] == -1 && pad.right[1] == -1);
  assert_true(pad.l2 == 0.2 && pad.r2 == 1);
}

static void test_buttons(void **state)
{
  static const struct {
    int byte;
    uint8_t bit;
    uint32_t button;
  } map[] = {
    {9, 0x02, STIC_GAMEPAD_R1},      {9, 0x01, STIC_GAMEPAD_L1},       {8, 0x10, STIC_GAMEPAD_SQUARE},
    {8, 0x20, STIC_GAMEPAD_CROSS},   {8, 0x40, STIC_GAMEPAD_CIRCLE},   {8, 0x80, STIC_GAMEPAD_TRIANGLE},
    {9, 0x04, STIC_GAMEPAD_L2},      {9, 0x08, STIC_GAMEPAD_R2},       {9, 0x10, STIC_GAMEPAD_CREATE},
    {9, 0x20, STIC_GAMEPAD_OPTIONS}, {9, 0x40, STIC_GAMEPAD_L3},       {9, 0x80, STIC_GAMEPAD_R3},
    {10, 0x01, STIC_GAMEPAD_PS},     {10, 0x02, STIC_GAMEPAD_TOUCHPAD}};
  uint32_t all = 0;

  (void)state;
  for (size_t i = 0; i < sizeof map / sizeof map[0]; i++) {
    uint8_t usb[64];
    stic_gamepad pad;

    stic_make_pad_usb(usb, 0);
    usb[map[i].byte] |= map[i].bit;
    assert_int_equal(decode(usb, sizeof usb, &pad), STIC_GAMEPAD_OK);
    assert_int_equal(pad.buttons, map[i].button);
    all |= map[i].button;
  }
  assert_int_equal(all, 0x3fff); /* each its own bit */
  assert_int_equal(STIC_GAMEPAD_R1, STIC_BUTTON_GRIP);
}

static void test_hat(void **state)
{
  static const int expected[9][2] = {{0, 1},   {1, 1},  {1, 0},  {1, -1}, {0, -1},
                                     {-1, -1}, {-1, 0}, {-1, 1}, {0, 0}};

  (void)state;
  for (int hat = 0; hat < 16; hat++) {
    uint8_t usb[64];
    stic_gamepad pad;

    stic_make_pad_usb(usb, 0);
    usb[8] = (uint8_t)hat;
    assert_int_equal(decode(usb, sizeof usb, &pad), hat < 9 ? STIC_GAMEPAD_OK : STIC_GAMEPAD_BAD_VALUE);
    if (hat < 9)
      assert_true(pad.hat[0] == expected[hat][0] && pad.hat[1] == expected[hat][1]);
  }
}

static void test_cut(void **state)
{
  uint8_t usb[64], bluetooth[78];
  stic_gamepad pad;

  (void)state;
  stic_make_pad_usb(usb, 0);
  stic_make_pad_bluetooth(bluetooth, 0);
  for (size_t length = 0; length < sizeof usb; length++)
    assert_int_equal(decode(usb, length, &pad),
                     length == 10 ? STIC_GAMEPAD_REDUCED : STIC_GAMEPAD_BAD_LENGTH);
  for (size_t length = 0; length < sizeof bluetooth; length++)
    assert_int_equal(decode(bluetooth, length, &pad), STIC_GAMEPAD_BAD_LENGTH);
}

/* Over Bluetooth every byte is covered, but the ID, which makes it another kind. */
static void test_every_byte(void **state)
{
  (void)state;
  for (size_t at = 0; at < 78; at++) {
    for (int flip = 1; flip < 256; flip++) {
      uint8_t bytes[78];
      stic_gamepad pad;

      stic_make_pad_bluetooth(bytes, 3);
      bytes[at] ^= (uint8_t)flip;
      if (at > 0)
        assert_int_equal(decode(bytes, sizeof bytes, &pad), STIC_GAMEPAD_BAD_CHECKSUM);
      else if (bytes[0] != 0x01)
        assert_int_equal(decode(bytes, sizeof bytes, &pad), STIC_GAMEPAD_OTHER);
    }
  }
}

/* ---- driver ------------------------------------------------------------------------------ */

static void test_run(void **state)
{
  stic_fake_hid hid;
  stic_device_sample samples[8];
  stic_device *device;
  uint8_t usb[64];
  char text[300];

  (void)state;
  stic_fake_init(&hid);
  stic_fake_plug(&hid, 0, DUALSENSE);
  device = stic_fake_open(&hid, "gamepad:speed=0.5,turn=2");
  stic_device_describe(device, text, sizeof text);
  assert_string_equal(text,
                      "DualSense 054c:0ce6 at /dev/fake0 (fake), 0.5 m/s and 2 rad/s at full deflection");
  assert_int_equal(device->state, STIC_CONNECTION_SYNCING);
  stic_make_pad_usb(usb, 254);
  usb[1] = 255;
  usb[2] = 255; /* right and down */
  usb[3] = 255;
  usb[4] = 0;           /* right and up */
  usb[6] = 255;         /* R2: away */
  usb[8] = 6;           /* hat left */
  usb[9] = 0x02 | 0x08; /* R1, R2 */
  stic_fake_send(&hid, 0, STIC_MS, usb, sizeof usb);
  stic_make_pad_usb(usb, 255);
  stic_fake_send(&hid, 0, 5 * STIC_MS, usb, sizeof usb);
  stic_make_pad_usb(usb, 1); /* 0 is lost */
  stic_fake_send(&hid, 0, 9 * STIC_MS, usb, sizeof usb);
  assert_int_equal(stic_fake_poll(&hid, device, 20 * STIC_MS, samples, 8), 1);
  assert_int_equal(device->state, STIC_CONNECTION_RUNNING);
  assert_int_equal(samples[0].flags, STIC_SAMPLE_VELOCITY);
  assert_true(samples[0].velocity[0] == 0.5 && samples[0].velocity[1] == -0.5 &&
              samples[0].velocity[2] == -0.5);
  assert_true(samples[0].turn_rate[0] == 2 && samples[0].turn_rate[1] == -2 && samples[0].turn_rate[2] == 2);
  assert_int_equal(samples[0].buttons, STIC_GAMEPAD_R1 | STIC_GAMEPAD_R2);
  assert_int_equal(stic_fake_poll(&hid, device, 4 * STIC_MS, samples, 8), 1);
  assert_int_equal(samples[0].buttons, 0);
  assert_int_equal(stic_fake_poll(&hid, device, 4 * STIC_MS, samples, 8), 1);
  assert_int_equal(samples[0].sequence, 4);
  assert_int_equal(device->counters.gaps, 1);
  assert_int_equal(device->counters.bad_records, 0);
  stic_device_close(device);
}

/* Asked for its calibration, the pad sends full reports. It is asked once a second, not at its rate. */
static void test_bluetooth(void **state)
{
  static const uint8_t reduced[10] = {1, 128, 128, 128, 128, 8, 0, 0, 0, 0};
  stic_fake_hid hid;
  stic_device_sample samples[8];
  stic_device *device;
  uint8_t full[78];

  (void)state;
  stic_fake_init(&hid);
  stic_fake_plug(&hid, 0, DUALSENSE);
  device = stic_fake_open(&hid, "gamepad");
  for (int i = 0; i < 150; i++)
    stic_fake_send(&hid, 0, i * 10 * STIC_MS, reduced, sizeof reduced);
  stic_make_pad_bluetooth(full, 0);
  full[10] = 0x02; /* R1 */
  stic_seal_pad(full);
  stic_fake_send(&hid, 0, 1500 * STIC_MS, full, sizeof full);
  full[10] = 0; /* without R1, but with the old checksum */
  stic_fake_send(&hid, 0, 1501 * STIC_MS, full, sizeof full);
  assert_int_equal(stic_fake_poll(&hid, device, 1499 * STIC_MS, samples, 8), 0);
  assert_int_equal(hid.features_got, 2);
  assert_int_equal(device->state, STIC_CONNECTION_RESETTING);
  assert_int_equal(stic_fake_poll(&hid, device, 20 * STIC_MS, samples, 8), 1);
  assert_int_equal(samples[0].buttons, STIC_BUTTON_GRIP);
  assert_int_equal(stic_fake_poll(&hid, device, 20 * STIC_MS, samples, 8), 0);
  assert_int_equal(device->counters.bad_records, 1);
  stic_device_close(device);
}

/* A pad that is known to be on Bluetooth is asked when it is opened, not in poll(). */
static void test_asked_at_open(void **state)
{
  stic_fake_hid hid;
  stic_device *device;

  (void)state;
  stic_fake_init(&hid);
  stic_fake_plug(&hid, 0, DUALSENSE);
  hid.nodes[0].node.bus = "bluetooth";
  device = stic_fake_open(&hid, "gamepad");
  assert_int_equal(hid.features_got, 1);
  stic_device_close(device);
}

static void test_garbage_and_unplug(void **state)
{
  stic_fake_hid hid;
  stic_device_sample samples[8];
  stic_device *device;
  uint8_t usb[64];

  (void)state;
  stic_fake_init(&hid);
  stic_fake_plug(&hid, 0, DUALSENSE);
  device = stic_fake_open(&hid, "gamepad");
  stic_make_pad_usb(usb, 0);
  for (size_t length = 1; length < sizeof usb; length++)
    stic_fake_send(&hid, 0, 0, usb, length);
  assert_int_equal(stic_fake_poll(&hid, device, STIC_MS, samples, 8), 0);
  assert_int_equal(device->counters.bad_records, 62); /* and a reduced one */
  stic_fake_unplug(&hid, 0);
  assert_int_equal(stic_fake_poll(&hid, device, STIC_MS, samples, 8), STIC_DRIVER_LOST);
  stic_device_close(device);
  stic_fake_plug(&hid, 3, DUALSENSE);
  device = stic_fake_open(&hid, "gamepad");
  stic_fake_send(&hid, 3, 0, usb, sizeof usb);
  assert_int_equal(stic_fake_poll(&hid, device, STIC_MS, samples, 8), 1);
  stic_device_close(device);
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_crc),
                                     cmocka_unit_test(test_rest),
                                     cmocka_unit_test(test_sticks),
                                     cmocka_unit_test(test_buttons),
                                     cmocka_unit_test(test_hat),
                                     cmocka_unit_test(test_cut),
                                     cmocka_unit_test(test_every_byte),
                                     cmocka_unit_test(test_run),
                                     cmocka_unit_test(test_bluetooth),
                                     cmocka_unit_test(test_asked_at_open),
                                     cmocka_unit_test(test_garbage_and_unplug)};

  return cmocka_run_group_tests(tests, NULL, NULL);
}

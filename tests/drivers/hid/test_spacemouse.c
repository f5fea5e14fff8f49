/* SpaceMouse family: decoder, models, driver. */
#include "fake_hid.h"

#include "../../../drivers/spacemouse/spacemouse_decode.h"
#include "../../../drivers/spacemouse/spacemouse_driver.h"
#include "../../../drivers/spacemouse/spacemouse_models.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NAVIGATOR 0x046d, 0xc626, 0x01, 0x08
#define WIRELESS 0x256f, 0xc62e, 0x01, 0x08
#define PRO 0x046d, 0xc62b, 0x01, 0x08

static const uint8_t rest_translation[] = {1, 0, 0, 0, 0, 0, 0};
static const uint8_t turn_y_30[] = {2, 0x00, 0x00, 0xe2, 0xff, 0x00, 0x00}; /* captured: Ry = -30 */
static const uint8_t press_1[] = {3, 1, 0}, press_2[] = {3, 2, 0}, release[] = {3, 0, 0}; /* captured */
/* X 350 = 0x015e, Y -350 = 0xfea2, Z 175 = 0x00af */
static const uint8_t push[] = {1, 0x5e, 0x01, 0xa2, 0xfe, 0xaf, 0x00};
/* the same and Rx 35, Ry -70, Rz 105 = 0x0069 */
static const uint8_t combined[] = {1, 0x5e, 0x01, 0xa2, 0xfe, 0xaf, 0x00, 0x23, 0x00, 0xba, 0xff, 0x69, 0x00};
static const uint8_t battery[] = {0x17, 80, 1};

static void assert_axes(const double got[3], double x, double y, double z)
{
  const double expected[3] = {x, y, z};

  for (int i = 0; i < 3; i++) {
    if (got[i] != expected[i])
      fail_msg("axis %d: %.17g, expected %.17g", i, got[i], expected[i]);
  }
}

/* ---- decoder ----------------------------------------------------------------------------- */

static stic_spacemouse_report decode(stic_spacemouse *mouse, const void *report, size_t length)
{
  /* A buffer of exactly this length, so that a sanitizer sees a read beyond it. */
  uint8_t *exact = malloc(length > 0 ? length : 1);
  stic_spacemouse_report kind;

  assert_non_null(exact);
  memcpy(exact, report, length);
  kind = stic_spacemouse_decode(mouse, exact, length);
  free(exact);
  return kind;
}

static void test_split(void **state)
{
  stic_spacemouse mouse = {.battery = -1};

  (void)state;
  assert_int_equal(decode(&mouse, push, sizeof push), STIC_SPACEMOUSE_MOTION);
  /* raw (1, -1, 0.5) -> (X, -Z, Y) */
  assert_axes(mouse.translation, 1, -0.5, -1);
  assert_axes(mouse.rotation, 0, 0, 0);
  assert_int_equal(decode(&mouse, turn_y_30, sizeof turn_y_30), STIC_SPACEMOUSE_MOTION);
  assert_axes(mouse.rotation, 0, 0, -30 / 350.0);
  assert_axes(mouse.translation, 1, -0.5, -1);
  assert_int_equal(decode(&mouse, rest_translation, sizeof rest_translation), STIC_SPACEMOUSE_MOTION);
  assert_axes(mouse.translation, 0, 0, 0);
}

static void test_combined(void **state)
{
  stic_spacemouse mouse = {.battery = -1};

  (void)state;
  assert_int_equal(decode(&mouse, combined, sizeof combined), STIC_SPACEMOUSE_MOTION);
  assert_axes(mouse.translation, 1, -0.5, -1);
  assert_axes(mouse.rotation, 35 / 350.0, -105 / 350.0, -70 / 350.0);
}

static void test_clamp(void **state)
{
  /* 500, as an old unit may send, and the ends of the 16 bits */
  static const uint8_t beyond[] = {1, 0xf4, 0x01, 0xff, 0x7f, 0x00, 0x80};
  stic_spacemouse mouse = {.battery = -1};

  (void)state;
  assert_int_equal(decode(&mouse, beyond, sizeof beyond), STIC_SPACEMOUSE_MOTION);
  assert_axes(mouse.translation, 1, 1, 1); /* Z = -1 points up */
}

static void test_keys(void **state)
{
  static const uint8_t pro_ctrl[] = {3, 0x00, 0x10, 0x00, 0x02}; /* key 1 is bit 12, CTRL bit 25 */
  stic_spacemouse mouse = {.battery = -1};

  (void)state;
  assert_int_equal(decode(&mouse, press_1, sizeof press_1), STIC_SPACEMOUSE_KEYS);
  assert_int_equal(mouse.keys, 1);
  decode(&mouse, press_2, sizeof press_2);
  assert_int_equal(mouse.keys, 2);
  decode(&mouse, pro_ctrl, sizeof pro_ctrl);
  assert_int_equal(mouse.keys, 1u << 12 | 1u << 25);
  decode(&mouse, release, sizeof release);
  assert_int_equal(mouse.keys, 0);
}

static void test_battery(void **state)
{
  static const uint8_t wrong[] = {0x17, 101, 0};
  stic_spacemouse mouse = {.battery = -1};

  (void)state;
  assert_int_equal(decode(&mouse, battery, sizeof battery), STIC_SPACEMOUSE_BATTERY);
  assert_int_equal(mouse.battery, 80);
  assert_int_equal(decode(&mouse, wrong, sizeof wrong), STIC_SPACEMOUSE_BAD);
  assert_int_equal(mouse.battery, 80);
}

/* Every report cut at every length: what is too short changes nothing. A combined report cut to 7..12 bytes
 * is a split one. */
static void test_cut(void **state)
{
  static const struct {
    const uint8_t *report;
    size_t length, needed;
  } reports[] = {{push, sizeof push, 7},
                 {combined, sizeof combined, 7},
                 {turn_y_30, sizeof turn_y_30, 7},
                 {press_1, sizeof press_1, 3},
                 {battery, sizeof battery, 3}};

  (void)state;
  for (size_t i = 0; i < sizeof reports / sizeof reports[0]; i++) {
    for (size_t length = 0; length < reports[i].needed; length++) {
      stic_spacemouse mouse = {.battery = -1}, before = mouse;

      assert_int_equal(decode(&mouse, reports[i].report, length), STIC_SPACEMOUSE_BAD);
      assert_memory_equal(&mouse, &before, sizeof mouse);
    }
    for (size_t length = reports[i].needed; length <= reports[i].length; length++) {
      stic_spacemouse mouse = {.battery = -1};

      assert_int_not_equal(decode(&mouse, reports[i].report, length), STIC_SPACEMOUSE_BAD);
      for (int axis = 0; length < 13 && axis < 3 && reports[i].report == combined; axis++)
        assert_true(mouse.rotation[axis] == 0);
    }
  }
}

/* There is no checksum: every byte at every value decodes to something in range, or to nothing. */
static void test_every_byte(void **state)
{
  (void)state;
  for (size_t at = 0; at < sizeof combined; at++) {
    for (int value = 0; value < 256; value++) {
      stic_spacemouse mouse = {.battery = -1};
      uint8_t report[sizeof combined];

      memcpy(report, combined, sizeof report);
      report[at] = (uint8_t)value;
      decode(&mouse, report, sizeof report);
      for (int i = 0; i < 3; i++) {
        assert_true(mouse.translation[i] >= -1 && mouse.translation[i] <= 1);
        assert_true(mouse.rotation[i] >= -1 && mouse.rotation[i] <= 1);
      }
      assert_true(mouse.battery >= -1 && mouse.battery <= 100);
    }
  }
}

static void test_padded(void **state)
{
  uint8_t padded[64] = {0};
  stic_spacemouse mouse = {.battery = -1};

  (void)state;
  memcpy(padded, press_2, sizeof press_2);
  assert_int_equal(decode(&mouse, padded, 13), STIC_SPACEMOUSE_KEYS);
  assert_int_equal(mouse.keys, 2);
  memcpy(padded, combined, sizeof combined);
  assert_int_equal(decode(&mouse, padded, sizeof padded), STIC_SPACEMOUSE_MOTION);
  assert_axes(mouse.rotation, 0.1, -0.3, -0.2);
}

/* ---- models ------------------------------------------------------------------------------ */

static char *read_rules(void)
{
  static char text[8192];
  FILE *file = fopen(STIC_TEST_RULES, "r");

  assert_non_null(file);
  text[fread(text, 1, sizeof text - 1, file)] = '\0';
  fclose(file);
  return text;
}

/* Whether a line of the rules has both numbers. */
static bool in_rules(const char *rules, uint16_t vendor, uint16_t product)
{
  char v[32], p[8];
  const char *line = rules;

  snprintf(v, sizeof v, "ATTRS{idVendor}==\"%04x\"", (unsigned)vendor);
  snprintf(p, sizeof p, "%04x", (unsigned)product);
  while (line) {
    const char *end = strchr(line, '\n');
    char copy[512];

    snprintf(copy, sizeof copy, "%.*s", end ? (int)(end - line) : (int)strlen(line), line);
    if (strstr(copy, v) && strstr(strstr(copy, v) + strlen(v), p))
      return true;
    line = end ? end + 1 : NULL;
  }
  return false;
}

static void test_models(void **state)
{
  const char *rules = read_rules();
  int count = 0;

  (void)state;
  for (const stic_spacemouse_model *m; (m = stic_spacemouse_model_at(count)) != NULL; count++) {
    assert_true(m->vendor == 0x046d || m->vendor == 0x256f);
    assert_true(m->name && m->name[0]);
    assert_true(m->grip_key >= 0 && m->grip_key < 32);
    assert_false(stic_spacemouse_never(m->vendor, m->product));
    assert_ptr_equal(stic_spacemouse_find(m->vendor, m->product), m); /* so none is listed twice */
    if (!in_rules(rules, m->vendor, m->product))
      fail_msg("%s %04x:%04x is missing in the udev rules", m->name, m->vendor, m->product);
    for (int i = 0; i < count; i++)
      assert_string_not_equal(stic_spacemouse_model_at(i)->name, m->name);
  }
  assert_int_equal(count, 17);
  assert_null(stic_spacemouse_model_at(-1));
  assert_false(in_rules(rules, 0x256f, 0xc650));
  assert_true(in_rules(rules, 0x1532, 0x0300));
  assert_true(in_rules(rules, 0x054c, 0x0ce6) && in_rules(rules, 0x054c, 0x0df2));
}

static bool matches(uint16_t vendor, uint16_t product, uint16_t page, uint16_t usage)
{
  const stic_device_id id = {"usb", vendor, product, page, usage, "/dev/x", "x"};

  return stic_spacemouse_driver.match(&id);
}

static void test_match(void **state)
{
  static const uint16_t never[] = {0xc650, 0xc651, 0xc654, 0xc655, 0xc656, 0xc657,
                                   0xc658, 0xc664, 0xc665, 0xc668, 0xc62c, 0xc641};

  (void)state;
  assert_true(matches(0x046d, 0xc626, 1, 8));
  assert_true(matches(0x046d, 0xc626, 0, 0));  /* usage unknown */
  assert_false(matches(0x256f, 0xc652, 1, 2)); /* a receiver's mouse side */
  assert_false(matches(0x046d, 0xc077, 1, 8)); /* a Logitech mouse */
  assert_false(matches(0x256f, 0xc626, 1, 8)); /* the other vendor's number */
  for (size_t i = 0; i < sizeof never / sizeof never[0]; i++)
    assert_false(matches(0x256f, never[i], 1, 8));
}

/* ---- driver ------------------------------------------------------------------------------ */

static void test_run(void **state)
{
  stic_fake_hid hid;
  stic_device_sample samples[8];
  stic_device *device;
  char text[300];

  (void)state;
  stic_fake_init(&hid);
  stic_fake_plug(&hid, 0, NAVIGATOR);
  hid.nodes[0].usages = 3;
  device = stic_fake_open(&hid, "spacemouse:speed=0.5,turn=2");
  assert_int_equal(device->state, STIC_CONNECTION_RUNNING);
  assert_int_equal(hid.sent_count, 1); /* LED on */
  assert_memory_equal(hid.sent[0].data, "\x04\x01", 2);
  stic_device_describe(device, text, sizeof text);
  assert_string_equal(
    text, "SpaceNavigator 046d:c626 at /dev/fake0 (fake), 0.5 m/s and 2 rad/s at full deflection");

  assert_int_equal(stic_fake_poll(&hid, device, 20 * STIC_MS, samples, 8), 0);
  stic_fake_send(&hid, 0, 5 * STIC_MS, push, sizeof push);
  stic_fake_send(&hid, 0, 5 * STIC_MS, turn_y_30, sizeof turn_y_30);
  stic_fake_send(&hid, 0, 5 * STIC_MS, press_1, sizeof press_1);
  stic_fake_send(&hid, 0, 5 * STIC_MS, battery, sizeof battery);
  assert_int_equal(stic_fake_poll(&hid, device, 20 * STIC_MS, samples, 8), 3);
  assert_int_equal(samples[0].t_ns, hid.now_ns);
  assert_axes(samples[0].velocity, 0.5, -0.25, -0.5);
  assert_axes(samples[1].turn_rate, 0, 0, 2 * (-30 / 350.0));
  assert_int_equal(samples[1].buttons, 0);
  assert_int_equal(samples[2].buttons, STIC_BUTTON_GRIP);
  assert_axes(samples[2].velocity, 0.5, -0.25, -0.5);
  for (int i = 0; i < 3; i++) {
    assert_int_equal(samples[i].flags, STIC_SAMPLE_VELOCITY);
    assert_int_equal(samples[i].sequence, i);
  }
  stic_device_describe(device, text, sizeof text);
  assert_non_null(strstr(text, "battery 80 %"));

  /* 100 ms of silence: the release must not bring the old rates back. */
  stic_fake_send(&hid, 0, 100 * STIC_MS, release, sizeof release);
  assert_int_equal(stic_fake_poll(&hid, device, 200 * STIC_MS, samples, 8), 1);
  assert_int_equal(samples[0].buttons, 0);
  assert_axes(samples[0].velocity, 0, 0, 0);
  assert_axes(samples[0].turn_rate, 0, 0, 0);

  assert_int_equal(stic_device_send(device, &(stic_device_output){.led = false}), 0);
  assert_memory_equal(hid.sent[1].data, "\x04\x00", 2);
  assert_int_equal(device->counters.samples, 4);
  assert_int_equal(device->counters.bad_records, 0);
  stic_device_close(device);
  assert_int_equal(hid.sent_count, 3); /* LED off */
  assert_false(hid.nodes[0].open);
}

static void test_unplug_and_replug(void **state)
{
  stic_fake_hid hid;
  stic_device_sample samples[8];
  stic_device *device;

  (void)state;
  stic_fake_init(&hid);
  stic_fake_open_fails(&hid, "spacemouse", STIC_NO_DEVICE, "no spacemouse found by fake");
  stic_fake_plug(&hid, 0, WIRELESS);
  device = stic_fake_open(&hid, "spacemouse");
  stic_fake_send(&hid, 0, 0, combined, sizeof combined);
  assert_int_equal(stic_fake_poll(&hid, device, STIC_MS, samples, 8), 1);
  stic_fake_unplug(&hid, 0);
  assert_int_equal(stic_fake_poll(&hid, device, STIC_MS, samples, 8), STIC_DRIVER_LOST);
  assert_int_equal(stic_fake_poll(&hid, device, STIC_MS, samples, 8), STIC_DRIVER_LOST);
  assert_int_equal(device->state, STIC_CONNECTION_LOST);
  assert_string_equal(device->error.message, "spacemouse at /dev/fake0 has been unplugged or has failed");
  stic_device_close(device);
  stic_fake_open_fails(&hid, "spacemouse", STIC_NO_DEVICE, "no spacemouse found");
  stic_fake_plug(&hid, 1, WIRELESS); /* nodes renumber */
  device = stic_fake_open(&hid, "spacemouse:speed=1");
  stic_fake_send(&hid, 1, 0, combined, sizeof combined);
  assert_int_equal(stic_fake_poll(&hid, device, STIC_MS, samples, 8), 1);
  assert_axes(samples[0].velocity, 1, -0.5, -1);
  stic_device_close(device);
}

static void test_garbage(void **state)
{
  static const uint8_t unknown[] = {0x55, 1, 2, 3};
  stic_fake_hid hid;
  stic_device_sample samples[8];
  stic_device *device;

  (void)state;
  stic_fake_init(&hid);
  stic_fake_plug(&hid, 0, NAVIGATOR);
  device = stic_fake_open(&hid, "spacemouse");
  stic_fake_send(&hid, 0, 0, unknown, sizeof unknown);
  for (size_t length = 1; length < sizeof push; length++)
    stic_fake_send(&hid, 0, 0, push, length);
  assert_int_equal(stic_fake_poll(&hid, device, STIC_MS, samples, 8), 0);
  assert_int_equal(device->counters.bad_records, 6);
  /* A device that babbles cannot hold a poll: 256 at a time. */
  for (int i = 0; i < 300; i++)
    stic_fake_send(&hid, 0, 0, unknown, sizeof unknown);
  stic_fake_send(&hid, 0, 0, push, sizeof push);
  assert_int_equal(stic_fake_poll(&hid, device, STIC_MS, samples, 8), 0);
  assert_int_equal(hid.nodes[0].head, 7 + 256);
  assert_int_equal(stic_fake_poll(&hid, device, STIC_MS, samples, 8), 1);
  stic_device_close(device);
}

static void test_drain(void **state)
{
  static stic_device_sample samples[100];
  stic_fake_hid hid;
  stic_device *device;

  (void)state;
  stic_fake_init(&hid);
  stic_fake_plug(&hid, 0, NAVIGATOR);
  device = stic_fake_open(&hid, "spacemouse");
  for (int i = 0; i < 90; i++)
    stic_fake_send(&hid, 0, 0, push, sizeof push);
  assert_int_equal(stic_fake_poll(&hid, device, STIC_MS, samples, 16),
                   16); /* no more than there is room for */
  assert_int_equal(device->counters.overruns, 0);
  assert_int_equal(stic_fake_poll(&hid, device, STIC_MS, samples, 100),
                   74); /* the rest at once, without waiting */
  assert_int_equal(samples[73].sequence, 89);
  assert_int_equal(device->counters.overruns, 1);
  stic_device_close(device);
}

static void test_pro_grip(void **state)
{
  static const uint8_t key_1[] = {3, 0x00, 0x10, 0, 0}, menu[] = {3, 0x01, 0, 0, 0},
                       both[] = {3, 0x01, 0x10, 0, 0};
  stic_fake_hid hid;
  stic_device_sample samples[8];
  stic_device *device;

  (void)state;
  stic_fake_init(&hid);
  stic_fake_plug(&hid, 0, PRO);
  device = stic_fake_open(&hid, "spacemouse");
  stic_fake_send(&hid, 0, 0, key_1, sizeof key_1);
  stic_fake_send(&hid, 0, 0, menu, sizeof menu);
  stic_fake_send(&hid, 0, 0, both, sizeof both);
  assert_int_equal(stic_fake_poll(&hid, device, STIC_MS, samples, 8), 3);
  assert_int_equal(samples[0].buttons, 1);
  assert_int_equal(samples[1].buttons, 1u << 12);
  assert_int_equal(samples[2].buttons, 1u << 12 | 1);
  stic_device_close(device);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_split),      cmocka_unit_test(test_combined),
    cmocka_unit_test(test_clamp),      cmocka_unit_test(test_keys),
    cmocka_unit_test(test_battery),    cmocka_unit_test(test_cut),
    cmocka_unit_test(test_every_byte), cmocka_unit_test(test_padded),
    cmocka_unit_test(test_models),     cmocka_unit_test(test_match),
    cmocka_unit_test(test_run),        cmocka_unit_test(test_unplug_and_replug),
    cmocka_unit_test(test_garbage),    cmocka_unit_test(test_drain),
    cmocka_unit_test(test_pro_grip)};

  return cmocka_run_group_tests(tests, NULL, NULL);
}

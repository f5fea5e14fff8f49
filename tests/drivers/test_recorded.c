/* The driver `recording`: pacing, rounds, the end, and what it refuses. */
#include "../../drivers/driver.h"
#include "../../drivers/logitech/logitech_recording.h"
#include "../../drivers/raw_recording.h"
#include "../files/help.h"
#include "logitech_emulator.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SAMPLES_MAX 400

static const char *serial, *puck;

/* A second of the tracker's stream, and half a second of a SpaceNavigator that is pushed. */
static int set_up(void **state)
{
  static char paths[2][256];
  const uint8_t reset[] = "*S";
  stic_raw_device device = {.name = "SpaceNavigator", .bus = 3, .vendor = 0x046d, .product = 0xc626};
  stic_raw_writer *writer;
  stic_error err;
  emulator unit;

  (void)state;
  emulator_init(&unit);
  emulator_receive(&unit, reset, 2, 1000);
  strcpy(paths[0], stic_test_path("serial.raw"));
  assert_int_equal(stic_raw_create(paths[0], STIC_RAW_SERIAL, NULL, false, &writer, &err), STIC_OK);
  for (int64_t now_ns = 0; now_ns < 1000000000; now_ns += 3000000) {
    uint8_t bytes[64];
    const size_t n = emulator_send(&unit, now_ns, bytes, sizeof bytes);

    if (n > 0)
      assert_int_equal(stic_raw_write(writer, 0, now_ns, bytes, n, &err), STIC_OK);
  }
  assert_int_equal(stic_raw_finish(writer, &err), STIC_OK);
  strcpy(paths[1], stic_test_path("puck.raw"));
  assert_int_equal(stic_raw_create(paths[1], STIC_RAW_HID, &device, false, &writer, &err), STIC_OK);
  for (int i = 0; i < 60; i++) {
    const uint8_t report[7] = {(uint8_t)(1 + i % 2), 0x5e, 0x01};

    assert_int_equal(
      stic_raw_write(writer, 0, 1000000000 + i * INT64_C(8000000), report, sizeof report, &err), STIC_OK);
  }
  assert_int_equal(stic_raw_finish(writer, &err), STIC_OK);
  serial = paths[0];
  puck = paths[1];
  return 0;
}

static stic_device *open_it(const char *path, const char *extra)
{
  stic_device *device;
  stic_error err;
  char spec[400];

  snprintf(spec, sizeof spec, "recording:file=%s%s", path, extra);
  if (stic_device_open(spec, &device, &err) != STIC_OK)
    fail_msg("%s: %s", spec, err.message);
  return device;
}

/* All samples up to the end, at most SAMPLES_MAX; *result is what poll() said last. */
static int take_all(stic_device *device, stic_device_sample *samples, int *result)
{
  int count = 0;

  while (count < SAMPLES_MAX) {
    *result = stic_device_poll(device, INT64_MAX, samples + count, SAMPLES_MAX - count);
    if (*result < 0)
      break;
    count += *result;
  }
  for (int i = 1; i < count; i++)
    assert_true(samples[i].t_ns > samples[i - 1].t_ns);
  return count;
}

/* Ten times as fast: the same samples a tenth apart, and rates ten times as large. */
static void test_speed(void **state)
{
  static stic_device_sample fast[SAMPLES_MAX], faster[SAMPLES_MAX];
  stic_device *device = open_it(puck, ",speed=10");
  char text[600];
  int result, count;

  (void)state;
  assert_int_equal(device->driver->kind, STIC_DRIVER_RATE);
  count = take_all(device, fast, &result);
  assert_int_equal(result, STIC_DRIVER_END);
  assert_true(count > 20);
  device->driver->describe(device, text, sizeof text);
  stic_test_contains(text, "SpaceNavigator");
  stic_test_contains(text, "speed 10");
  stic_device_close(device);
  device = open_it(puck, ",speed=100");
  assert_int_equal(take_all(device, faster, &result), count);
  stic_device_close(device);
  for (int i = 0; i < count; i++) {
    assert_true(fabs(fast[i].velocity[0] * 10 - faster[i].velocity[0]) <=
                1e-12 * fabs(faster[i].velocity[0]));
    assert_true(llabs(fast[i].t_ns - fast[0].t_ns - 10 * (faster[i].t_ns - faster[0].t_ns)) <= 20);
  }
  assert_true(fabs(fast[5].velocity[0]) > 0);
}

static void test_rounds(void **state)
{
  static stic_device_sample once[SAMPLES_MAX], looped[SAMPLES_MAX];
  stic_device *device = open_it(serial, ",speed=1000,driver=logitech");
  char text[600];
  int result, count;

  (void)state;
  assert_int_equal(device->driver->kind, STIC_DRIVER_POSE);
  count = take_all(device, once, &result);
  assert_int_equal(result, STIC_DRIVER_END);
  assert_int_equal(stic_device_poll(device, 0, once, 1), STIC_DRIVER_END);
  assert_true(count > 40);
  stic_device_close(device);
  device = open_it(serial, ",speed=1000,loop");
  assert_int_equal(take_all(device, looped, &result), SAMPLES_MAX);
  device->driver->describe(device, text, sizeof text);
  stic_test_contains(text, ", loop");
  assert_int_equal(device->counters.samples, SAMPLES_MAX);
  stic_device_close(device);
  for (int i = 0; i < SAMPLES_MAX; i++)
    assert_memory_equal(looped[i].position, once[i % count].position, sizeof once[0].position);
}

static void test_refusals(void **state)
{
  static const struct {
    const char *spec;
    stic_status status;
    const char *words;
  } cases[] = {
    {"recording", STIC_USAGE, "expected recording:file=FILE"},
    {"recording:file=-,loop", STIC_USAGE, "standard input cannot loop"},
    {"recording:file=%s,speed=0", STIC_USAGE, "speed is '0'"},
    {"recording:file=/nonexistent/r", STIC_BAD_INPUT, "No such file"},
    {"recording:file=%s,driver=gamepad", STIC_USAGE, "'gamepad' does not decode serial recordings"},
    {"recording:file=%s,driver=logitech:", STIC_USAGE, ""},
    {"recording:file=%h,driver=hydra", STIC_BAD_INPUT, "the recording is of no hydra"},
    {"recording:file=%h,driver=mouse", STIC_USAGE, "'mouse' is no driver of HID devices"},
  };

  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    const char *mark = strchr(cases[i].spec, '%');
    stic_device *device = NULL;
    stic_error err;
    char spec[400];

    if (mark)
      snprintf(spec, sizeof spec, "%.*s%s%s", (int)(mark - cases[i].spec), cases[i].spec,
               mark[1] == 's' ? serial : puck, mark + 2);
    else
      snprintf(spec, sizeof spec, "%s", cases[i].spec);
    if (stic_device_open(spec, &device, &err) != cases[i].status)
      fail_msg("%s: status %d: %s", spec, (int)err.status, err.message);
    assert_null(device);
    stic_test_contains(err.message, cases[i].words);
  }
}

/* A bad record ends it, and says where; what was before it is given out first. */
static void test_bad_record(void **state)
{
  static stic_device_sample samples[SAMPLES_MAX];
  const char *path = stic_test_path("bad.raw");
  char *text = stic_test_read(serial);
  stic_device *device;
  int result;

  (void)state;
  strcpy(strrchr(text, '\n') + 1, "999000000 zz\n");
  stic_test_write("bad.raw", text);
  free(text);
  device = open_it(path, ",speed=1000");
  assert_true(take_all(device, samples, &result) > 40);
  assert_int_equal(result, STIC_DRIVER_BAD_DATA);
  assert_int_equal(device->error.status, STIC_BAD_INPUT);
  assert_string_equal(device->error.file, path);
  assert_true(device->error.line > 40);
  stic_test_contains(device->error.message, "found 'zz'");
  stic_device_close(device);
}

/* Gone between two rounds. */
static void test_vanishes(void **state)
{
  static stic_device_sample samples[SAMPLES_MAX];
  char *text = stic_test_read(serial);
  const char *path = stic_test_write("gone.raw", text);
  stic_device *device = open_it(path, ",speed=1000,loop");
  int result;

  (void)state;
  free(text);
  assert_int_equal(stic_device_poll(device, INT64_MAX, samples, 1), 1);
  assert_int_equal(remove(path), 0);
  assert_true(take_all(device, samples, &result) < SAMPLES_MAX);
  assert_int_equal(result, STIC_DRIVER_BAD_DATA);
  stic_test_contains(device->error.message, "No such file");
  stic_device_close(device);
}

/* The reader is the device's from the call on, also when it refuses. */
static void test_begins_with_bad_record(void **state)
{
  stic_raw_reader *reader;
  stic_device *device;
  stic_error err;

  (void)state;
  assert_int_equal(stic_raw_open(stic_test_write("b.raw", "# stiction-serial 1\n1 zz\n"), &reader, &err),
                   STIC_OK);
  assert_int_equal(stic_logitech_recording_begin(reader, &device, &err), STIC_BAD_INPUT);
  assert_null(device);
  stic_test_contains(err.message, "found 'zz'");
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_speed),    cmocka_unit_test(test_rounds),
    cmocka_unit_test(test_refusals), cmocka_unit_test(test_bad_record),
    cmocka_unit_test(test_vanishes), cmocka_unit_test(test_begins_with_bad_record),
  };

  return cmocka_run_group_tests(tests, set_up, stic_test_clean_up);
}

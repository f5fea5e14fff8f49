/* What a driver records of a device gives the same samples when it is decoded again. */
#include "fake_hid.h"
#include "vectors.h"

#include "../../../drivers/hid/hid_recording.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SAMPLES 64

static const uint8_t push[] = {1, 0x5e, 0x01, 0xa2, 0xfe, 0xaf, 0x00};
static const uint8_t turn[] = {2, 0x00, 0x00, 0xe2, 0xff, 0x00, 0x00};
static const uint8_t press[] = {3, 1, 0};

static char path[] = "/tmp/stiction-recording-XXXXXX";

static int make_file(void **state)
{
  const int file = mkstemp(path);

  (void)state;
  return file < 0 ? -1 : close(file);
}

static int remove_file(void **state)
{
  (void)state;
  return unlink(path);
}

static int poll_all(stic_device *device, int64_t until_ns, stic_device_sample *samples)
{
  int count = 0, result;

  while (count < SAMPLES &&
         (result = stic_device_poll(device, until_ns, samples + count, SAMPLES - count)) > 0)
    count += result;
  return count;
}

/* Times are kept to 1 us from the first report on. */
static void assert_same_samples(const stic_device_sample *a, const stic_device_sample *b, int count)
{
  for (int i = 0; i < count; i++) {
    const int64_t difference = (a[i].t_ns - a[0].t_ns) - (b[i].t_ns - b[0].t_ns);
    stic_device_sample x = a[i], y = b[i];

    assert_true(difference > -1000 && difference < 1000);
    x.t_ns = x.source_ns = y.t_ns = y.source_ns = 0;
    assert_memory_equal(&x, &y, sizeof x);
  }
}

static stic_status open_recording(const char *from, stic_hid_recording **recording, stic_error *err)
{
  stic_raw_reader *reader;
  const stic_status status = stic_raw_open(from, &reader, err);

  return status == STIC_OK ? stic_hid_recording_begin(reader, from, recording, err) : status;
}

static void replay(const char *spec_text, stic_device_sample *samples, int *count)
{
  stic_hid_recording *recording = NULL;
  stic_device *device = NULL;
  stic_device_spec spec;
  stic_error err = {.status = STIC_OK};

  if (open_recording(path, &recording, &err) != STIC_OK)
    fail_msg("%s", err.message);
  assert_int_equal(stic_spec_parse(spec_text, &spec, &err), STIC_OK);
  if (stic_hid_open_over(stic_hid_recording_transport(recording), &spec, &device, &err) != STIC_OK)
    fail_msg("%s", err.message);
  *count = poll_all(device, INT64_MAX, samples);
  assert_int_equal(stic_device_poll(device, INT64_MAX, samples + *count, 1), STIC_DRIVER_END);
  assert_int_equal(device->state, STIC_CONNECTION_CLOSED);
  assert_int_equal(stic_hid_recording_error(recording)->status, STIC_OK);
  stic_device_close(device);
  stic_hid_recording_close(recording);
}

static void test_spacemouse(void **state)
{
  static stic_device_sample live[SAMPLES], again[SAMPLES];
  stic_fake_hid hid;
  stic_device *device;
  char spec[200];
  int live_count, again_count;

  (void)state;
  stic_fake_init(&hid);
  stic_fake_plug(&hid, 0, 0x046d, 0xc626, 0x01, 0x08);
  snprintf(spec, sizeof spec, "spacemouse:raw=%s", path);
  device = stic_fake_open(&hid, spec);
  stic_fake_send(&hid, 0, 8 * STIC_MS, push, sizeof push);
  stic_fake_send(&hid, 0, 16 * STIC_MS + 300, turn, sizeof turn);
  stic_fake_send(&hid, 0, 24 * STIC_MS, press, 2); /* garbage is recorded as well */
  stic_fake_send(&hid, 0, 32 * STIC_MS, press, sizeof press);
  stic_fake_send(&hid, 0, 500 * STIC_MS, press, sizeof press);
  live_count = poll_all(device, hid.now_ns + 1000 * STIC_MS, live);
  assert_int_equal(live_count, 4);
  stic_device_close(device);
  replay("spacemouse", again, &again_count);
  assert_int_equal(again_count, live_count);
  assert_same_samples(live, again, live_count);
}

static void test_hydra(void **state)
{
  static const int mm[3] = {10, 200, -30};
  static stic_device_sample live[SAMPLES], again[SAMPLES];
  stic_fake_hid hid;
  stic_device *device;
  char spec[200];
  int live_count, again_count;

  (void)state;
  stic_fake_init(&hid);
  stic_fake_plug(&hid, 0, 0x1532, 0x0300, 0x01, 0x00);
  stic_fake_plug(&hid, 1, 0x1532, 0x0300, 0x01, 0x05);
  snprintf(spec, sizeof spec, "hydra:raw=%s", path);
  device = stic_fake_open(&hid, spec);
  for (int i = 0; i < 20; i++) {
    uint8_t report[52];

    stic_make_hydra(report, (uint8_t)(i < 10 ? i : i + 3), mm, (uint8_t)(10 * i));
    stic_fake_send(&hid, 0, i * 4 * STIC_MS, report, sizeof report);
  }
  live_count = poll_all(device, hid.now_ns + 100 * STIC_MS, live);
  assert_int_equal(live_count, 20);
  stic_device_close(device);
  replay("hydra", again, &again_count);
  assert_int_equal(again_count, live_count);
  assert_same_samples(live, again, live_count);
}

static void write_text(const char *text)
{
  FILE *file = fopen(path, "w");

  assert_non_null(file);
  fputs(text, file);
  assert_int_equal(fclose(file), 0);
}

/* Two devices take turns; only one is opened. */
static void test_two_devices(void **state)
{
  static stic_device_sample samples[SAMPLES];
  int count;

  (void)state;
  write_text("D: 0\nR: 8 05 01 09 02 a1 01 c0 c0\nN: Mouse\nP: usb-1\nI: 3 046d c077\n"
             "D: 1\nR: 8 05 01 09 08 a1 01 c0 c0\nN: SpaceNavigator\nP: usb-2\nI: 3 046d c626\n"
             "D: 0\nE: 000000.000000 4 01 02 03 04\n"
             "D: 1\nE: 000000.008000 7 01 5e 01 00 00 00 00\n"
             "D: 0\nE: 000000.009000 4 01 02 03 04\n"
             "D: 1\nE: 000000.016000 3 03 01 00\n");
  replay("spacemouse:speed=1", samples, &count);
  assert_int_equal(count, 2);
  assert_true(samples[0].velocity[0] == 1);
  assert_int_equal(samples[1].t_ns - samples[0].t_ns, 8 * STIC_MS);
}

static void write_event(FILE *file, int ms, const uint8_t *report, int length)
{
  fprintf(file, "E: %06d.%06d %d", ms / 1000, ms % 1000 * 1000, length);
  for (int i = 0; i < length; i++)
    fprintf(file, " %02x", report[i]);
  fputc('\n', file);
}

/* Both sides of one device: each node gets its own reports. */
static void test_two_nodes(void **state)
{
  static const int mm[3] = {10, 200, -30};
  static const uint8_t gamepad[12] = {0};
  stic_hid_recording *recording = NULL;
  stic_device *device = NULL;
  stic_device_sample samples[SAMPLES];
  stic_device_spec spec;
  stic_error err;
  FILE *file = fopen(path, "w");

  (void)state;
  assert_non_null(file);
  fputs("D: 0\nR: 7 05 01 09 00 a1 01 c0\nN: Hydra\nI: 3 1532 0300\n"
        "D: 1\nR: 7 05 01 09 05 a1 01 c0\nN: Hydra\nI: 3 1532 0300\n",
        file);
  for (int i = 0; i < 10; i++) {
    uint8_t report[52];

    stic_make_hydra(report, (uint8_t)i, mm, 0);
    fputs("D: 0\n", file);
    write_event(file, 4 * i, report, sizeof report);
    fputs("D: 1\n", file);
    write_event(file, 4 * i + 1, gamepad, sizeof gamepad);
  }
  assert_int_equal(fclose(file), 0);
  assert_int_equal(open_recording(path, &recording, &err), STIC_OK);
  assert_int_equal(stic_spec_parse("hydra", &spec, &err), STIC_OK);
  assert_int_equal(stic_hid_open_over(stic_hid_recording_transport(recording), &spec, &device, &err),
                   STIC_OK);
  assert_int_equal(poll_all(device, INT64_MAX, samples), 10);
  assert_int_equal(device->counters.bad_records, 0);
  stic_device_close(device);
  stic_hid_recording_close(recording);
}

static void test_refusals(void **state)
{
  stic_hid_recording *recording = NULL;
  stic_error err = {.status = STIC_OK};

  (void)state;
  write_text("# stiction-serial 1\n0 2a 52\n");
  assert_int_equal(open_recording(path, &recording, &err), STIC_BAD_INPUT);
  write_text("R: 1 00\nI: 3 046d c626\nE: 0.0 3 01 02\n");
  assert_int_equal(open_recording(path, &recording, &err), STIC_BAD_INPUT);
  assert_int_equal(open_recording("/nonexistent", &recording, &err), STIC_BAD_INPUT);
  assert_null(recording);
  stic_hid_recording_close(NULL);
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_spacemouse), cmocka_unit_test(test_hydra),
                                     cmocka_unit_test(test_two_devices), cmocka_unit_test(test_two_nodes),
                                     cmocka_unit_test(test_refusals)};

  return cmocka_run_group_tests(tests, make_file, remove_file);
}

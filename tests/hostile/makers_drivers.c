/* Makers of devices and of what reads and writes their recordings. */
#include "../../drivers/connection.h"
#include "../../drivers/gamepad/gamepad_driver.h"
#include "../../drivers/hid/hid_recording.h"
#include "../../drivers/hydra/hydra_driver.h"
#include "../../drivers/logitech/logitech_recording.h"
#include "../../drivers/recording/recorded.h"
#include "../../drivers/spacemouse/spacemouse_driver.h"
#include "../drivers/hid/fake_hid.h"
#include "../drivers/logitech_emulator.h"
#include "../files/help.h"
#include "makers.h"

#include <stdio.h>
#include <stdlib.h>

static struct {
  stic_fake_hid hid; /* large */
  emulator unit;
  logitech_pty pty;
  const char *trace, *serial, *again, *puck;
  char logitech[300], logitech_raw[600]; /* specifications */
} given;

static void write_raw(const char *path, stic_raw_kind kind)
{
  const stic_raw_device puck = {.name = "SpaceNavigator", .bus = 3, .vendor = 0x046d, .product = 0xc626};
  const uint8_t record[16] = {0x80, 0, 7, 0x68, 0x7f, 0x6c, 0x3c, 0, 0, 1, 3, 0x10, 0x6d, 0x30, 0, 4};
  const uint8_t report[7] = {1, 0x5e, 1};
  stic_raw_writer *writer;

  assert_int_equal(stic_raw_create(path, kind, kind == STIC_RAW_HID ? &puck : NULL, false, &writer, NULL),
                   STIC_OK);
  for (int i = 0; i < 5; i++)
    assert_int_equal(stic_raw_write(writer, 0, i * INT64_C(20000000), kind == STIC_RAW_HID ? report : record,
                                    kind == STIC_RAW_HID ? sizeof report : sizeof record, NULL),
                     STIC_OK);
  assert_int_equal(stic_raw_finish(writer, NULL), STIC_OK);
}

static void set_up(void)
{
  char *trace = stic_test_trace(20);

  stic_fake_init(&given.hid);
  stic_fake_plug(&given.hid, 0, 0x046d, 0xc626, 1, 8);
  stic_fake_plug(&given.hid, 1, 0x1532, 0x0300, 1, 0);
  stic_fake_plug(&given.hid, 2, 0x054c, 0x0ce6, 1, 5);
  emulator_init(&given.unit);
  assert_true(logitech_pty_open(&given.pty, &given.unit));
  snprintf(given.logitech, sizeof given.logitech, "logitech:port=%s", given.pty.path);
  snprintf(given.logitech_raw, sizeof given.logitech_raw, "%s,raw=%s", given.logitech,
           stic_test_path("raw.txt"));
  given.trace = stic_test_write("hand.csv", trace);
  given.serial = stic_test_path("serial.txt");
  given.again = stic_test_path("again.txt");
  given.puck = stic_test_path("puck.txt");
  free(trace);
  write_raw(given.serial, STIC_RAW_SERIAL);
  write_raw(given.again, STIC_RAW_SERIAL);
  write_raw(given.puck, STIC_RAW_HID);
}

static void tear_down(void)
{
  logitech_pty_close(&given.pty);
}

static const stic_recorded_options by_logitech = {.driver = "logitech"};

static void finish_raw(stic_raw_writer *writer)
{
  assert_int_equal(stic_raw_finish(writer, NULL), STIC_OK);
}

MAKE(sample, stic_device_open, stic_device, stic_device_close, "sample")
MAKE(mouse, stic_device_open, stic_device, stic_device_close, "mouse")
MAKE(reopen, stic_device_reopen, stic_device, stic_device_close, given.logitech_raw)
MAKE(logitech, stic_device_open, stic_device, stic_device_close, given.logitech)
MAKE(logitech_raw, stic_device_open, stic_device, stic_device_close, given.logitech_raw)
MAKE(supervisor, stic_supervisor_open, stic_supervisor, stic_supervisor_close, "sample", NULL)
MAKE(recorded_serial, stic_recorded_open, stic_recorded, stic_recorded_close, given.serial, &by_logitech)
MAKE(recorded_puck, stic_recorded_open, stic_recorded, stic_recorded_close, given.puck, NULL)
MAKE(raw_file, stic_raw_open, stic_raw_reader, stic_raw_close, given.serial)
MAKE(raw_writer, stic_raw_create, stic_raw_writer, finish_raw, stic_test_path("raw.txt"), STIC_RAW_SERIAL,
     NULL, false)

static stic_status open_file(const char *driver, const char *path, const char *rest, void **made,
                             stic_error *err)
{
  stic_device *device = (stic_device *)(void *)&poison;
  char spec[STIC_SPEC_MAX];
  stic_status status;

  snprintf(spec, sizeof spec, "%s:file=%s%s", driver, path, rest);
  status = stic_device_open(spec, &device, err);
  *made = device;
  return status;
}

static stic_status make_trace_device(void **made, stic_error *err)
{
  return open_file("trace", given.trace, "", made, err);
}

static stic_status make_serial_device(void **made, stic_error *err)
{
  return open_file("recording", given.serial, ",driver=logitech", made, err);
}

static stic_status make_puck_device(void **made, stic_error *err)
{
  return open_file("recording", given.puck, "", made, err);
}

static void end_device(void *made)
{
  stic_device_close(made);
}

typedef stic_status open_over(const stic_hid_transport *transport, const stic_device_spec *spec,
                              stic_device **device, stic_error *err);

/* With a recording of what comes, which asks for memory of its own. */
static stic_status open_hid(const char *name, open_over *open, void **made, stic_error *err)
{
  stic_device *device = (stic_device *)(void *)&poison;
  stic_device_spec spec;
  char text[STIC_SPEC_MAX];
  stic_status status;

  snprintf(text, sizeof text, "%s:raw=%s", name, stic_test_path("raw.txt"));
  assert_int_equal(stic_spec_parse(text, &spec, NULL), STIC_OK);
  status = open(&given.hid.transport, &spec, &device, err);
  *made = device;
  return status;
}

static stic_status make_hid(void **made, stic_error *err)
{
  return open_hid("spacemouse", stic_hid_open_over, made, err);
}

static stic_status make_spacemouse(void **made, stic_error *err)
{
  return open_hid("spacemouse", stic_spacemouse_open, made, err);
}

static stic_status make_hydra(void **made, stic_error *err)
{
  return open_hid("hydra", stic_hydra_open, made, err);
}

static stic_status make_gamepad(void **made, stic_error *err)
{
  return open_hid("gamepad", stic_gamepad_open, made, err);
}

/* What was recorded before is still there, whatever is refused. */
static stic_status make_raw_again(void **made, stic_error *err)
{
  stic_raw_writer *writer = (stic_raw_writer *)(void *)&poison;
  const stic_status status = stic_raw_create(given.again, STIC_RAW_SERIAL, NULL, true, &writer, err);
  FILE *file = fopen(given.again, "r");
  char text[2000] = "";

  assert_non_null(file);
  assert_true(fread(text, 1, sizeof text - 1, file) > 0);
  assert_int_equal(fclose(file), 0);
  stic_test_contains(text, "\n80000000 80 00 07");
  *made = writer;
  return status;
}

static void end_raw_again(void *made)
{
  finish_raw(made);
}

static int64_t no_time(void *context)
{
  (void)context;
  return 0;
}

static stic_status make_adopted(void **made, stic_error *err)
{
  stic_supervisor *supervisor = NULL;
  stic_device *device;
  stic_status status = stic_device_open("sample", &device, err);

  if (status == STIC_OK)
    status = stic_supervisor_adopt(device, no_time, NULL, &supervisor, err);
  *made = supervisor;
  return status;
}

static void end_adopted(void *made)
{
  stic_supervisor_close(made);
}

static stic_status make_serial_recording(void **made, stic_error *err)
{
  stic_device *device = NULL;
  stic_raw_reader *reader;
  stic_status status = stic_raw_open(given.serial, &reader, err);

  if (status == STIC_OK)
    status = stic_logitech_recording_begin(reader, &device, err);
  *made = device;
  return status;
}

static stic_status make_hid_recording(void **made, stic_error *err)
{
  stic_hid_recording *recording = NULL;
  stic_raw_reader *reader;
  stic_status status = stic_raw_open(given.puck, &reader, err);

  if (status == STIC_OK)
    status = stic_hid_recording_begin(reader, given.puck, &recording, err);
  *made = recording;
  return status;
}

static void end_hid_recording(void *made)
{
  stic_hid_recording_close(made);
}

/* ---- the table ------------------------------------------------------------------------------- */

static const maker makers[] = {
  {"stic_device_open", "sample", make_sample, end_sample},
  {"stic_device_open", "mouse", make_mouse, end_mouse},
  {"stic_device_open", "trace", make_trace_device, end_device},
  {"stic_device_open", "recording, serial", make_serial_device, end_device},
  {"stic_device_open", "recording, HID", make_puck_device, end_device},
  {"stic_device_open", "logitech", make_logitech, end_logitech},
  {"stic_device_open", "logitech, recorded", make_logitech_raw, end_logitech_raw},
  {"stic_device_reopen", "", make_reopen, end_reopen},
  {"stic_hid_open_over", "", make_hid, end_device},
  {"stic_hid_connect", "", make_spacemouse, end_device},
  {"stic_spacemouse_open", "", make_spacemouse, end_device},
  {"stic_hydra_open", "", make_hydra, end_device},
  {"stic_gamepad_open", "", make_gamepad, end_device},
  {"stic_tty_open", "", make_logitech, end_logitech},
  {"stic_supervisor_open", "", make_supervisor, end_supervisor},
  {"stic_supervisor_adopt", "", make_adopted, end_adopted},
  {"stic_recorded_open", "serial", make_recorded_serial, end_recorded_serial},
  {"stic_recorded_open", "HID", make_recorded_puck, end_recorded_puck},
  {"stic_raw_open", "", make_raw_file, end_raw_file},
  {"stic_raw_create", "", make_raw_writer, end_raw_writer},
  {"stic_raw_create", "again", make_raw_again, end_raw_again},
  {"stic_hid_recording_begin", "", make_hid_recording, end_hid_recording},
  {"stic_logitech_recording_begin", "", make_serial_recording, end_device},
  {NULL, NULL, NULL, NULL},
};

const maker_group driver_makers = {set_up, tear_down, makers};

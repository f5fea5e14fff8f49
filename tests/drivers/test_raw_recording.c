/* Raw recordings: both formats there and back, every way in which one can be wrong, and real decoding. */
#include "../../drivers/logitech/logitech_stream.h"
#include "../../drivers/raw_recording.h"
#include "../files/help.h"
#include "logitech_emulator.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SERIAL STIC_RAW_FORMAT "\n"
#define HID "D: 0\nR: 3 05 01 c0\nN: puck\nP: usb-1\nI: 3 046d c626\n"

static const stic_test_wrong wrong[] = {
  {"", 0, "no records; expected '# stiction-serial 1'"},
  {"# other\n", 1, "no records"},
  {SERIAL, 1, "no records"},
  {"# stiction-serial 2\n1 00\n", 1, "format version 2; expected 1"},
  {"t,x,y\n", 1, "expected '# stiction-serial 1' or a recording by hid-recorder"},
  {SERIAL "x 00\n", 2, "time is 'x'; expected whole nanoseconds"},
  {SERIAL "-1 00\n", 2, "time is '-1'"},
  {SERIAL "1.5 00\n", 2, "time is '1.5'"},
  {SERIAL "99999999999999999999 00\n", 2, "time is"},
  {SERIAL "1\n", 2, "a time without bytes"},
  {SERIAL "1 0\n", 2, "found '0'; expected bytes of two hexadecimal digits"},
  {SERIAL "1 000\n", 2, "found '000'"},
  {SERIAL "1 0x\n", 2, "found '0x'"},
  {SERIAL "# ok\n5 80\n4 80\n", 4, "time 4 ns is before the last record's 5"},
  {"D: 8\n", 1, "device is '8'; expected D: 0 to 7"},
  {"D:\n", 1, "device is ''"},
  {"X: 1\n", 1, "found 'X:'; expected a line that starts with D:"},
  {HID "hello\n", 6, "found 'hello'"},
  {"R: 2 05\n", 1, "found 1 bytes; expected the 2"},
  {"R: 0\n", 1, "length is '0'; expected a number of bytes from 1 to 4096"},
  {"R: 5000 00\n", 1, "length is '5000'"},
  {"I: 3 046d\n", 1, "expected I: bus vendor product"},
  {"I: 3 046d 12345\n", 1, "expected I: bus vendor product"},
  {"I: 3 046g 1\n", 1, "expected I: bus vendor product"},
  {HID "E: x 1 00\n", 6, "time is 'x'; expected E: sec.usec"},
  {HID "E: -1.0 1 00\n", 6, "time is '-1.0'"},
  {HID "E: 0.1 2 00\n", 6, "found 1 bytes; expected the 2"},
  {HID "E: 0.1 1 00 01\n", 6, "found 2 bytes; expected the 1"},
  {HID "E: 0.1\n", 6, "length is ''"},
  {HID "E: 0.2 1 00\nE: 0.1 1 00\n", 7, "before the last record's"},
};

/* The last status; `count` records went before it. */
static stic_raw_status read_all(stic_raw_reader *reader, int *count, stic_raw_record *last, stic_error *err)
{
  stic_raw_status status;

  *count = 0;
  while ((status = stic_raw_next(reader, last, err)) == STIC_RAW_RECORD || status == STIC_RAW_WAIT)
    *count += status == STIC_RAW_RECORD;
  return status;
}

static stic_status read_raw(const char *path, stic_error *err)
{
  stic_raw_reader *reader;
  stic_raw_record record;
  stic_raw_status status;
  int count;

  assert_int_equal(stic_raw_open(path, &reader, err), STIC_OK);
  status = read_all(reader, &count, &record, err);
  stic_raw_close(reader);
  return status == STIC_RAW_BAD ? err->status : STIC_OK;
}

static void test_wrong(void **state)
{
  (void)state;
  stic_test_wrong_files(wrong, sizeof wrong / sizeof wrong[0], read_raw);
}

static void test_long(void **state)
{
  const size_t room = 70000;
  char *text = malloc(room);
  stic_raw_reader *reader;
  stic_raw_record record;
  stic_error err;
  int count;

  (void)state;
  assert_non_null(text);
  for (int bytes = 4096; bytes <= 4097; bytes++) {
    size_t used = (size_t)snprintf(text, room, SERIAL "7");

    for (int i = 0; i < bytes; i++)
      used += (size_t)snprintf(text + used, room - used, " %02X", (unsigned)i & 255);
    snprintf(text + used, room - used, "\n");
    assert_int_equal(stic_raw_open(stic_test_write("raw", text), &reader, &err), STIC_OK);
    assert_int_equal(read_all(reader, &count, &record, &err), bytes == 4096 ? STIC_RAW_END : STIC_RAW_BAD);
    if (bytes == 4096)
      assert_true(record.length == 4096 && record.bytes[255] == 255);
    else
      stic_test_contains(err.message, "more than 4096 bytes");
    stic_raw_close(reader);
  }
  memset(text, ' ', room - 2);
  memcpy(text, SERIAL, sizeof SERIAL - 1);
  memcpy(text + room - 2, "\n", 2);
  assert_int_equal(stic_raw_open(stic_test_write("raw", text), &reader, &err), STIC_OK);
  assert_int_equal(read_all(reader, &count, &record, &err), STIC_RAW_BAD);
  stic_test_contains(err.message, "longer than");
  stic_raw_close(reader);
  free(text);
}

static void test_absent(void **state)
{
  stic_raw_reader *reader;
  stic_raw_writer *writer;
  stic_error err;

  (void)state;
  assert_int_equal(stic_raw_open("/no/such/file", &reader, &err), STIC_BAD_INPUT);
  assert_null(reader);
  assert_int_equal(stic_raw_create("/no/such/file", STIC_RAW_SERIAL, NULL, false, &writer, &err),
                   STIC_CANNOT_WRITE);
  assert_null(writer);
  assert_int_equal(stic_raw_create("/dev/full", STIC_RAW_SERIAL, NULL, false, &writer, &err), STIC_OK);
  assert_int_equal(stic_raw_write(writer, 0, 0, (const uint8_t *)"*", 1, &err), STIC_CANNOT_WRITE);
  assert_int_equal(stic_raw_finish(writer, &err), STIC_OK);
}

static void test_cut(void **state)
{
  stic_raw_reader *reader;
  stic_raw_record record;
  stic_error err;
  int count;

  (void)state;
  assert_int_equal(stic_raw_open(stic_test_write("raw", SERIAL "\n1 80 01\r\n1 02\n2 8"), &reader, &err),
                   STIC_OK);
  assert_int_equal(read_all(reader, &count, &record, &err), STIC_RAW_END);
  assert_int_equal(count, 2);
  stic_raw_close(reader);
}

/* As hid-recorder writes it. */
static void test_hid_recorder(void **state)
{
  const char *text =
    "# name\nD: 1\nN: second\nD: 0\nR: 3 05 01 c0\nN: 3Dconnexion SpaceNavigator\nP: usb-0/input0\n"
    "I: 3 046d c626\nE: 000000.000000 7 01 00 00 00 00 00 00\n"
    "E: 000001.008001 7 02 00 00 e2 ff 00 00\nD: 1\nE: 10.000000 1 ff\n";
  const uint8_t second[] = {2, 0, 0, 0xe2, 0xff, 0, 0};
  const stic_raw_device *device;
  stic_raw_reader *reader;
  stic_raw_record record;
  stic_error err;

  (void)state;
  assert_int_equal(stic_raw_open(stic_test_write("raw", text), &reader, &err), STIC_OK);
  assert_int_equal(stic_raw_next(reader, &record, &err), STIC_RAW_RECORD);
  assert_int_equal(record.t_ns, 0);
  assert_int_equal(stic_raw_reader_kind(reader), STIC_RAW_HID);
  device = stic_raw_reader_device(reader, 0);
  assert_string_equal(device->name, "3Dconnexion SpaceNavigator");
  assert_string_equal(device->place, "usb-0/input0");
  assert_true(device->bus == 3 && device->vendor == 0x046d && device->product == 0xc626);
  assert_int_equal(device->descriptor_length, 3);
  assert_string_equal(stic_raw_reader_device(reader, 1)->name, "second");
  assert_int_equal(stic_raw_next(reader, &record, &err), STIC_RAW_RECORD);
  assert_int_equal(record.t_ns, 1008001000);
  assert_true(record.device == 0 && record.length == 7);
  assert_memory_equal(record.bytes, second, 7);
  assert_int_equal(stic_raw_next(reader, &record, &err), STIC_RAW_RECORD);
  assert_true(record.device == 1 && record.t_ns == 10000000000 && record.bytes[0] == 0xff);
  assert_int_equal(stic_raw_next(reader, &record, &err), STIC_RAW_END);
  stic_raw_close(reader);
}

static void write_hid(const char *path)
{
  stic_raw_device device;
  stic_raw_writer *writer;
  stic_error err;
  uint8_t bytes[52];

  memset(&device, 0, sizeof device);
  snprintf(device.name, sizeof device.name, "puck");
  device.bus = 3;
  device.vendor = 0x1532;
  device.product = 0x300;
  device.descriptor_length = STIC_RAW_DESCRIPTOR_MAX;
  assert_int_equal(stic_raw_create(path, STIC_RAW_HID, &device, false, &writer, &err), STIC_OK);
  for (int i = 0; i < 100; i++) {
    memset(bytes, i, sizeof bytes);
    assert_int_equal(
      stic_raw_write(writer, i / 10 % 2, 5000000000 + i * INT64_C(4000000), bytes, sizeof bytes, &err),
      STIC_OK);
  }
  assert_int_equal(stic_raw_finish(writer, &err), STIC_OK);
}

static void test_hid_back(void **state)
{
  const char *path = stic_test_path("hid");
  stic_raw_reader *reader;
  stic_raw_record record;
  stic_error err;

  (void)state;
  write_hid(path);
  assert_int_equal(stic_raw_open(path, &reader, &err), STIC_OK);
  for (int i = 0; i < 100; i++) {
    assert_int_equal(stic_raw_next(reader, &record, &err), STIC_RAW_RECORD);
    assert_int_equal(record.t_ns, i * INT64_C(4000000));
    assert_int_equal(record.device, i / 10 % 2);
    assert_true(record.length == 52 && record.bytes[51] == i);
  }
  assert_int_equal(stic_raw_next(reader, &record, &err), STIC_RAW_END);
  assert_int_equal(stic_raw_reader_device(reader, 0)->product, 0x300);
  assert_int_equal(stic_raw_reader_device(reader, 0)->descriptor_length, STIC_RAW_DESCRIPTOR_MAX);
  stic_raw_close(reader);
}

/* Opened again after a loss: it goes on where it was, a line that was cut goes, and times stay on one clock. */
static void test_goes_on(void **state)
{
  const char *path = stic_test_path("again");
  const int64_t begin_ns = 7000000000000, again_ns = begin_ns + 3000000000;
  const uint8_t byte = 0x5a;

  (void)state;
  for (int kind = STIC_RAW_SERIAL; kind <= STIC_RAW_HID; kind++) {
    stic_raw_device device = {.name = "puck", .bus = 3, .vendor = 0x46d, .product = 0xc626};
    const stic_raw_device *about = kind == STIC_RAW_HID ? &device : NULL;
    const int64_t from_ns = kind == STIC_RAW_HID ? begin_ns : 0; /* what times are counted from */
    stic_raw_writer *writer;
    stic_raw_reader *reader;
    stic_raw_record record;
    stic_error err;
    FILE *file;

    assert_int_equal(stic_raw_create(path, (stic_raw_kind)kind, about, false, &writer, &err), STIC_OK);
    for (int i = 0; i < 4; i++)
      assert_int_equal(
        stic_raw_write(writer, kind == STIC_RAW_HID ? i % 2 : 0, begin_ns + i * 1000, &byte, 1, &err),
        STIC_OK);
    assert_int_equal(stic_raw_finish(writer, &err), STIC_OK);
    file = fopen(path, "a");
    fputs("E: 0000", file);
    fclose(file);
    assert_int_equal(stic_raw_create(path, (stic_raw_kind)kind, about, true, &writer, &err), STIC_OK);
    assert_int_equal(stic_raw_write(writer, 0, again_ns, &byte, 1, &err), STIC_OK);
    assert_int_equal(stic_raw_finish(writer, &err), STIC_OK);
    assert_int_equal(stic_raw_open(path, &reader, &err), STIC_OK);
    for (int i = 0; i < 5; i++) {
      assert_int_equal(stic_raw_next(reader, &record, &err), STIC_RAW_RECORD);
      assert_int_equal(record.t_ns, (i < 4 ? begin_ns + i * 1000 : again_ns) - from_ns);
      assert_int_equal(record.device, kind == STIC_RAW_HID && i < 4 ? i % 2 : 0);
    }
    assert_int_equal(stic_raw_next(reader, &record, &err), STIC_RAW_END);
    stic_raw_close(reader);
  }
  /* What is no recording of this kind is begun anew. */
  {
    stic_raw_writer *writer;
    stic_error err;
    char *text;

    for (int records = 0; records < 2; records++) {
      assert_int_equal(stic_raw_create(path, STIC_RAW_SERIAL, NULL, true, &writer, &err), STIC_OK);
      if (records)
        assert_int_equal(stic_raw_write(writer, 0, 7, (const uint8_t *)"*", 1, &err), STIC_OK);
      assert_int_equal(stic_raw_finish(writer, &err), STIC_OK);
      text = stic_test_read(path);
      if (records)
        assert_string_equal(text, STIC_RAW_FORMAT "\n7 2a\n");
      else /* until there is something to put in its place */
        assert_non_null(strstr(text, "E: "));
      free(text);
    }
  }
}

/* What the driver's raw=F writes decodes to the same samples as the live bytes. */
static void test_serial_decodes(void **state)
{
  const char *path = stic_test_path("serial");
  stic_logitech_stream live, replayed;
  stic_device_sample samples[64], sample;
  stic_raw_writer *writer;
  stic_raw_reader *reader;
  stic_raw_record record;
  stic_error err;
  emulator unit;
  int given = 0, back = 0;
  size_t used;

  (void)state;
  memset(&live, 0, sizeof live);
  memset(&replayed, 0, sizeof replayed);
  emulator_init(&unit);
  emulator_receive(&unit, (const uint8_t *)"*S", 2, 1000);
  assert_int_equal(stic_raw_create(path, STIC_RAW_SERIAL, NULL, false, &writer, &err), STIC_OK);
  for (int64_t now_ns = 0; now_ns < 1000000000; now_ns += 3000000) {
    uint8_t bytes[64];
    const size_t n = emulator_send(&unit, now_ns, bytes, sizeof bytes);

    if (n == 0)
      continue;
    assert_int_equal(stic_raw_write(writer, 0, now_ns, bytes, n, &err), STIC_OK);
    for (size_t at = 0; at < n; at += used) {
      if (stic_logitech_stream_next(&live, bytes + at, n - at, now_ns, &used, &samples[given]))
        given++;
    }
  }
  assert_int_equal(stic_raw_finish(writer, &err), STIC_OK);
  assert_true(given > 40);
  assert_int_equal(stic_raw_open(path, &reader, &err), STIC_OK);
  while (stic_raw_next(reader, &record, &err) == STIC_RAW_RECORD) {
    for (size_t at = 0; at < record.length; at += used) {
      if (stic_logitech_stream_next(&replayed, record.bytes + at, record.length - at, record.t_ns, &used,
                                    &sample))
        assert_memory_equal(&sample, &samples[back++], sizeof sample);
    }
  }
  assert_int_equal(stic_raw_reader_kind(reader), STIC_RAW_SERIAL);
  stic_raw_close(reader);
  assert_int_equal(back, given);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_wrong),          cmocka_unit_test(test_long),
    cmocka_unit_test(test_absent),         cmocka_unit_test(test_cut),
    cmocka_unit_test(test_hid_recorder),   cmocka_unit_test(test_hid_back),
    cmocka_unit_test(test_serial_decodes), cmocka_unit_test(test_goes_on),
  };

  return cmocka_run_group_tests(tests, NULL, stic_test_clean_up);
}

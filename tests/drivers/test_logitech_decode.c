/* The wire format of the Logitech tracker: known records both ways, finding records, poses. */
#include "../../drivers/logitech/logitech_decode.h"
#include "../files/help.h"
#include "angle.h"
#include "logitech_emulator.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct golden {
  emulator_record record;
  uint8_t bytes[16];
} golden;

static const golden vectors[] = {
  /* out of range, never acquired */
  {{{0, 0, 0}, 0, 0, 0, 0x20}, {0xa0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}},
  /* 1.000, -2.500, 0.001 inches; pitch 10, yaw 350, roll 0.1 degrees */
  {{{1000, -2500, 1}, 400, 14000, 4, 0},
   {0x80, 0x00, 0x07, 0x68, 0x7f, 0x6c, 0x3c, 0x00, 0x00, 0x01, 0x03, 0x10, 0x6d, 0x30, 0x00, 0x04}},
  /* fringe, the ends of all ranges */
  {{{1048575, -1048576, -1}, 14399, 14396, 0, 0x40},
   {0xc0, 0x3f, 0x7f, 0x7f, 0x40, 0x00, 0x00, 0x7f, 0x7f, 0x7f, 0x70, 0x3f, 0x70, 0x3c, 0x00, 0x00}},
  /* all buttons; -18, 12, 36 inches; 0, 90, 180 degrees */
  {{{-18000, 12000, 36000}, 0, 3600, 7200, 0x1f},
   {0x9f, 0x7e, 0x73, 0x30, 0x00, 0x5d, 0x60, 0x02, 0x19, 0x20, 0x00, 0x00, 0x1c, 0x10, 0x38, 0x20}},
};

#define VECTORS (sizeof vectors / sizeof vectors[0])

static void assert_same(const stic_logitech_record *got, const emulator_record *wanted)
{
  for (int i = 0; i < 3; i++)
    assert_int_equal(got->position[i], wanted->position[i]);
  assert_int_equal(got->pitch, wanted->pitch);
  assert_int_equal(got->yaw, wanted->yaw);
  assert_int_equal(got->roll, wanted->roll);
  assert_int_equal(got->bits, wanted->bits);
}

static void test_golden(void **state)
{
  (void)state;
  for (size_t i = 0; i < VECTORS; i++) {
    stic_logitech_record record;
    uint8_t bytes[16];

    assert_true(stic_logitech_unpack(vectors[i].bytes, &record));
    assert_same(&record, &vectors[i].record);
    emulator_pack(&vectors[i].record, bytes);
    assert_memory_equal(bytes, vectors[i].bytes, 16);
  }
}

static void test_all_values(void **state)
{
  emulator_record wanted = {{0, 0, 0}, 0, 0, 0, 0};
  stic_logitech_record got;
  uint8_t bytes[16];

  (void)state;
  for (int32_t v = -1048576; v <= 1048575; v += 101) {
    wanted.position[0] = v;
    wanted.position[1] = -1 - v;
    wanted.position[2] = v / 3;
    wanted.pitch = (v + 1048576) % 14400;
    wanted.yaw = 14399 - wanted.pitch;
    wanted.roll = wanted.pitch / 2;
    wanted.bits = (unsigned)v & 0x7f;
    emulator_pack(&wanted, bytes);
    assert_true(stic_logitech_unpack(bytes, &got));
    assert_same(&got, &wanted);
  }
}

static void test_refused(void **state)
{
  stic_logitech_record record;
  uint8_t bytes[16];

  (void)state;
  for (int i = 0; i < 16; i++) {
    memcpy(bytes, vectors[1].bytes, 16);
    bytes[i] ^= 0x80;
    assert_false(stic_logitech_unpack(bytes, &record));
  }
  for (int i = 10; i < 16; i += 2) {
    memcpy(bytes, vectors[1].bytes, 16);
    bytes[i] = 14400 >> 7;
    bytes[i + 1] = 14400 & 0x7f;
    assert_false(stic_logitech_unpack(bytes, &record));
  }
}

/* R = Ry(yaw) Rx(pitch) Rz(roll), applied to a vector, against the quaternion. */
static void rotate_by_angles(double pitch, double yaw, double roll, const double v[3], double out[3])
{
  const double x1 = v[0] * cos(roll) - v[1] * sin(roll), y1 = v[0] * sin(roll) + v[1] * cos(roll), z1 = v[2];
  const double y2 = y1 * cos(pitch) - z1 * sin(pitch), z2 = y1 * sin(pitch) + z1 * cos(pitch);

  out[0] = x1 * cos(yaw) + z2 * sin(yaw);
  out[1] = y2;
  out[2] = -x1 * sin(yaw) + z2 * cos(yaw);
}

static void rotate_by_quaternion(const double q[4], const double v[3], double out[3])
{
  /* v + 2 w (u x v) + 2 u x (u x v) */
  const double c[3] = {q[1] * v[2] - q[2] * v[1], q[2] * v[0] - q[0] * v[2], q[0] * v[1] - q[1] * v[0]};

  out[0] = v[0] + 2 * (q[3] * c[0] + q[1] * c[2] - q[2] * c[1]);
  out[1] = v[1] + 2 * (q[3] * c[1] + q[2] * c[0] - q[0] * c[2]);
  out[2] = v[2] + 2 * (q[3] * c[2] + q[0] * c[1] - q[1] * c[0]);
}

static void test_pose(void **state)
{
  const double v[3] = {0.3, -0.5, 0.7}, to_rad = STIC_PI / 7200;
  stic_logitech_record record = {{1000, -2000, 40000}, 0, 0, 0, 0};

  (void)state;
  for (record.pitch = 0; record.pitch < 14400; record.pitch += 1111) {
    for (record.yaw = 0; record.yaw < 14400; record.yaw += 1211) {
      for (record.roll = 0; record.roll < 14400; record.roll += 1013) {
        double position[3], q[4], wanted[3], got[3];

        stic_logitech_pose(&record, position, q);
        rotate_by_angles(record.pitch * to_rad, record.yaw * to_rad, record.roll * to_rad, v, wanted);
        rotate_by_quaternion(q, v, got);
        for (int i = 0; i < 3; i++)
          assert_true(fabs(got[i] - wanted[i]) < 1e-14);
        assert_true(fabs(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] - 1) < 1e-14);
        assert_true(q[3] >= 0);
        assert_true(fabs(position[0] - 0.0254) < 1e-15 && fabs(position[1] + 0.0508) < 1e-15 &&
                    fabs(position[2] - 1.016) < 1e-13);
      }
    }
  }
}

static int decode_all(stic_logitech_decoder *d, const uint8_t *bytes, size_t length, size_t piece,
                      stic_logitech_record *last)
{
  int count = 0;
  size_t used;

  for (size_t at = 0; at < length; at += piece) {
    size_t n = length - at < piece ? length - at : piece, taken = 0;

    while (taken < n) {
      count += stic_logitech_decode(d, bytes + at + taken, n - taken, &used, last);
      taken += used;
    }
  }
  return count;
}

/* However the stream is cut into reads, and wherever one joins it. */
static void test_pieces(void **state)
{
  uint8_t bytes[16 * VECTORS];

  (void)state;
  for (size_t i = 0; i < VECTORS; i++)
    memcpy(bytes + 16 * i, vectors[i].bytes, 16);
  for (size_t piece = 1; piece <= sizeof bytes; piece++) {
    for (size_t join = 0; join < 16; join++) {
      stic_logitech_decoder d = {{0}, 0, false, 0, 0};
      stic_logitech_record last;

      assert_int_equal(decode_all(&d, bytes + join, sizeof bytes - join, piece, &last),
                       (int)VECTORS - (join > 0));
      assert_same(&last, &vectors[VECTORS - 1].record);
      assert_int_equal(d.phase_errors, 0);
    }
  }
}

static void test_phase(void **state)
{
  uint8_t bytes[48];
  stic_logitech_decoder d = {{0}, 0, false, 0, 0};
  stic_logitech_record last;

  (void)state;
  for (int i = 0; i < 3; i++)
    memcpy(bytes + 16 * i, vectors[1].bytes, 16);
  bytes[16] &= 0x7f; /* the middle record is not recognised */
  assert_int_equal(decode_all(&d, bytes, sizeof bytes, sizeof bytes, &last), 1);
  assert_int_equal(d.phase_errors, 1);
  bytes[16] |= 0x80;
  bytes[20] |= 0x80; /* it breaks off, then a shorter one begins and breaks off */
  memset(&d, 0, sizeof d);
  assert_int_equal(decode_all(&d, bytes, sizeof bytes, sizeof bytes, &last), 2);
  assert_int_equal(d.phase_errors, 2);
}

static void test_noise(void **state)
{
  stic_logitech_decoder d = {{0}, 0, false, 0, 0};
  uint8_t bytes[4096];
  uint32_t random = 1;
  stic_logitech_record record = {{0, 0, 0}, 0, 0, 0, 0};

  (void)state;
  for (int round = 0; round < 100; round++) {
    for (size_t i = 0; i < sizeof bytes; i++) {
      random = random * 1664525u + 1013904223u;
      bytes[i] = (uint8_t)(random >> 24);
    }
    decode_all(&d, bytes, sizeof bytes, 61, &record);
    assert_true(record.pitch < 14400 && record.yaw < 14400 && record.roll < 14400);
  }
  assert_true(d.phase_errors > 0);
  assert_int_equal(decode_all(&d, vectors[1].bytes, 16, 16, &record), 1);
  assert_same(&record, &vectors[1].record);
}

static void test_diagnostics(void **state)
{
  const uint8_t good[2] = {0xbf, 0x3f}, no_receiver[2] = {0x9f, 0x3f}, no_eeprom[2] = {0xbf, 0x3d};
  const uint8_t wrong[2] = {0x3f, 0xbf};
  unsigned passed;

  (void)state;
  assert_true(stic_logitech_unpack_diagnostics(good, &passed));
  assert_int_equal(passed, 0xfff);
  assert_true(stic_logitech_unpack_diagnostics(no_receiver, &passed));
  assert_int_equal(~passed & 0xff, 1 << STIC_LOGITECH_PART_RECEIVER);
  assert_true(stic_logitech_unpack_diagnostics(no_eeprom, &passed));
  assert_int_equal(~passed & 0xff, 1 << 7);
  assert_string_equal(stic_logitech_part_name(7), "EEPROM");
  assert_false(stic_logitech_unpack_diagnostics(wrong, &passed));
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_golden), cmocka_unit_test(test_all_values),  cmocka_unit_test(test_refused),
    cmocka_unit_test(test_pose),   cmocka_unit_test(test_pieces),      cmocka_unit_test(test_phase),
    cmocka_unit_test(test_noise),  cmocka_unit_test(test_diagnostics),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}

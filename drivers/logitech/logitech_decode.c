#include "logitech_decode.h"

#include "../../src/angle.h"

#include <assert.h>
#include <math.h>

#define FIRST_BYTE 0x80u
#define METRES_PER_COUNT 25.4e-6

static int32_t unpack_21(const uint8_t *bytes)
{
  const int32_t v = (int32_t)((uint32_t)bytes[0] << 14 | (uint32_t)bytes[1] << 7 | bytes[2]);

  return v >= 1 << 20 ? v - (1 << 21) : v;
}

static int unpack_14(const uint8_t *bytes)
{
  return bytes[0] << 7 | bytes[1];
}

static bool is_framed(const uint8_t *bytes)
{
  for (int i = 1; i < STIC_LOGITECH_RECORD; i++) {
    if (bytes[i] & FIRST_BYTE)
      return false;
  }
  return (bytes[0] & FIRST_BYTE) != 0;
}

bool stic_logitech_unpack(const uint8_t bytes[STIC_LOGITECH_RECORD], stic_logitech_record *record)
{
  if (!is_framed(bytes))
    return false;
  record->bits = bytes[0] & ~FIRST_BYTE;
  for (int i = 0; i < 3; i++)
    record->position[i] = unpack_21(bytes + 1 + 3 * i);
  record->pitch = unpack_14(bytes + 10);
  record->yaw = unpack_14(bytes + 12);
  record->roll = unpack_14(bytes + 14);
  return record->pitch < STIC_LOGITECH_TURN && record->yaw < STIC_LOGITECH_TURN &&
         record->roll < STIC_LOGITECH_TURN;
}

static void lose_phase(stic_logitech_decoder *d)
{
  d->phase_errors += d->in_phase;
  d->in_phase = false;
  d->count = 0;
}

/* Takes one byte; whether it ends a record. */
static bool take_byte(stic_logitech_decoder *d, uint8_t byte)
{
  const bool first = (byte & FIRST_BYTE) != 0;

  if (first && d->count > 0) {
    /* Cut short: what is there is dropped, and this byte begins the next one. */
    d->in_phase = true;
    lose_phase(d);
  } else if (!first && d->count == 0) {
    lose_phase(d);
    return false;
  }
  d->bytes[d->count++] = byte;
  return d->count == STIC_LOGITECH_RECORD;
}

bool stic_logitech_decode(stic_logitech_decoder *d, const uint8_t *bytes, size_t length, size_t *used,
                          stic_logitech_record *record)
{
  size_t i = 0;

  while (i < length) {
    if (!take_byte(d, bytes[i++]))
      continue;
    d->count = 0;
    d->in_phase = true;
    /* A surplus byte inside the record shows only behind it: look there, where that costs no waiting. */
    if (i < length && !(bytes[i] & FIRST_BYTE))
      continue;
    if (stic_logitech_unpack(d->bytes, record)) {
      *used = i;
      return true;
    }
    d->bad_angles++;
  }
  *used = i;
  return false;
}

static double half_angle(int counts)
{
  return counts * (STIC_PI / STIC_LOGITECH_TURN);
}

void stic_logitech_pose(const stic_logitech_record *record, double position[3], double orientation[4])
{
  const double sx = sin(half_angle(record->pitch)), cx = cos(half_angle(record->pitch));
  const double sy = sin(half_angle(record->yaw)), cy = cos(half_angle(record->yaw));
  const double sz = sin(half_angle(record->roll)), cz = cos(half_angle(record->roll));
  /* Yaw after pitch, then multiplied by roll from the right. */
  const double x = cy * sx, y = sy * cx, z = -sy * sx, w = cy * cx;
  const double sign = w * cz - z * sz < 0 ? -1 : 1;

  for (int i = 0; i < 3; i++)
    position[i] = record->position[i] * METRES_PER_COUNT;
  orientation[0] = sign * (x * cz + y * sz);
  orientation[1] = sign * (y * cz - x * sz);
  orientation[2] = sign * (z * cz + w * sz);
  orientation[3] = sign * (w * cz - z * sz);
}

bool stic_logitech_unpack_diagnostics(const uint8_t bytes[2], unsigned *passed)
{
  *passed = (bytes[0] & 0x3fu) | (bytes[1] & 0x3fu) << 6;
  return (bytes[0] & 0xc0) == 0x80 && (bytes[1] & 0xc0) == 0;
}

const char *stic_logitech_part_name(int part)
{
  static const char *const names[STIC_LOGITECH_PARTS] = {
    "control unit", "CPU", "EPROM checksum", "RAM", "transmitter", "receiver", "serial port", "EEPROM"};

  assert(part >= 0 && part < STIC_LOGITECH_PARTS);
  return names[part];
}

/* The Logitech ultrasonic tracker's wire format: 16-byte Euler records in 7-bit groups, bit 7 marking the
 * first byte. Pure: no I/O, no clock, no allocation; all functions are real-time. */
#ifndef STIC_LOGITECH_DECODE_H
#define STIC_LOGITECH_DECODE_H

#include "../../src/stiction.h"

#define STIC_LOGITECH_RECORD 16  /* bytes */
#define STIC_LOGITECH_TURN 14400 /* counts of a whole turn: 40 a degree */

/* Bits of a record's first byte. */
enum {
  STIC_LOGITECH_RIGHT = 0x01,
  STIC_LOGITECH_MIDDLE = 0x02,
  STIC_LOGITECH_LEFT = 0x04,
  STIC_LOGITECH_SUSPEND = 0x08, /* either side button */
  STIC_LOGITECH_STAND = 0x10,   /* the mouse stand's button */
  STIC_LOGITECH_OUT = 0x20,     /* out of range: the pose is the last valid one, or zero before the first */
  STIC_LOGITECH_FRINGE = 0x40   /* at the edge of the range, still valid */
};

/* A record as the device counts. */
typedef struct stic_logitech_record {
  int32_t position[3];  /* x, y, z, 0.001 inch, 21 bits with sign */
  int pitch, yaw, roll; /* 1/40 degree, 0..14399 */
  unsigned bits;        /* STIC_LOGITECH_ */
} stic_logitech_record;

/* Finds records in a stream of bytes. All zero is a decoder that has seen nothing. */
typedef struct stic_logitech_decoder {
  uint8_t bytes[STIC_LOGITECH_RECORD];
  int count;            /* of bytes of the present record; 0: looks for a first byte */
  bool in_phase;        /* a record was whole and none was lost since */
  int64_t phase_errors; /* a first byte where none belongs, or none where one does */
  int64_t bad_angles;   /* records with an angle beyond a turn, dropped */
} stic_logitech_decoder;

/* Takes apart one record; false if it is none: bit 7 in the wrong place, or an angle beyond a turn. */
bool stic_logitech_unpack(const uint8_t bytes[STIC_LOGITECH_RECORD], stic_logitech_record *record);

/* Takes bytes up to the end of the next record: true and the record, or false when all are taken.
 * `*used` is the number of bytes taken. */
bool stic_logitech_decode(stic_logitech_decoder *decoder, const uint8_t *bytes, size_t length, size_t *used,
                          stic_logitech_record *record);

/* A record's pose: m, and R = Ry(yaw) Rx(pitch) Rz(roll) as a unit quaternion x, y, z, w with w >= 0.
 * The device's axes are OpenXR's as seen from in front of its transmitter. */
void stic_logitech_pose(const stic_logitech_record *record, double position[3], double orientation[4]);

/* The diagnostics reply, bit n: part n passed. False if the two bytes are no such reply. */
bool stic_logitech_unpack_diagnostics(const uint8_t bytes[2], unsigned *passed);

#define STIC_LOGITECH_PARTS 8 /* with a test of their own */
#define STIC_LOGITECH_PART_TRANSMITTER 4
#define STIC_LOGITECH_PART_RECEIVER 5
/* "control unit", "CPU" ... */
const char *stic_logitech_part_name(int part);

#endif

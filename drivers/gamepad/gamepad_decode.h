/* Reports of the DualSense gamepad, over USB and Bluetooth. Pure: no I/O, no clock. */
#ifndef STIC_GAMEPAD_DECODE_H
#define STIC_GAMEPAD_DECODE_H

#include <stddef.h>
#include <stdint.h>

/* Bits of `buttons`; the grip is bit 0 everywhere. */
enum {
  STIC_GAMEPAD_R1 = 1 << 0,
  STIC_GAMEPAD_L1 = 1 << 1,
  STIC_GAMEPAD_SQUARE = 1 << 2,
  STIC_GAMEPAD_CROSS = 1 << 3,
  STIC_GAMEPAD_CIRCLE = 1 << 4,
  STIC_GAMEPAD_TRIANGLE = 1 << 5,
  STIC_GAMEPAD_L2 = 1 << 6,
  STIC_GAMEPAD_R2 = 1 << 7,
  STIC_GAMEPAD_CREATE = 1 << 8,
  STIC_GAMEPAD_OPTIONS = 1 << 9,
  STIC_GAMEPAD_L3 = 1 << 10,
  STIC_GAMEPAD_R3 = 1 << 11,
  STIC_GAMEPAD_PS = 1 << 12,
  STIC_GAMEPAD_TOUCHPAD = 1 << 13
};

typedef struct stic_gamepad {
  double left[2], right[2]; /* sticks, -1..1, right and up; at rest within a few hundredths of 0 */
  double l2, r2;            /* triggers, 0..1 */
  int hat[2];               /* -1, 0 or 1: right and up */
  uint32_t buttons;         /* sum of the above */
  uint8_t sequence;         /* one more with each report, modulo 256 */
} stic_gamepad;

typedef enum stic_gamepad_result {
  STIC_GAMEPAD_OK,
  STIC_GAMEPAD_REDUCED, /* Bluetooth before the pad has been asked for full reports */
  STIC_GAMEPAD_OTHER,   /* a kind that says nothing to us */
  STIC_GAMEPAD_BAD_LENGTH,
  STIC_GAMEPAD_BAD_CHECKSUM,
  STIC_GAMEPAD_BAD_VALUE /* a hat direction that is none */
} stic_gamepad_result;

/* Decodes a report, its ID first; `*pad` is written only if it is STIC_GAMEPAD_OK. Real-time: yes. */
stic_gamepad_result stic_gamepad_decode(const uint8_t *report, size_t length, stic_gamepad *pad);

/* CRC-32 (IEEE 802.3) of the byte 0xA1, which stands for "input" in Bluetooth, and the data. Real-time: yes. */
uint32_t stic_gamepad_crc(const uint8_t *data, size_t length);

#endif

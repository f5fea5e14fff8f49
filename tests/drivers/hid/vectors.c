#include "vectors.h"

#include "../../../drivers/gamepad/gamepad_decode.h"
#include "../../../drivers/hydra/hydra_decode.h"

#include <string.h>

const uint8_t stic_hydra_captured[52] = {
  0x01, 0x00, 0x34, 0x00, 0x02, 0x00, 0x01, 0x63, 0x2f, 0x00, 0xbf, 0xff, 0xcc, 0xff, 0xdf, 0xde, 0x7c, 0x79,
  0x21, 0x07, 0x33, 0xea, 0x80, 0x00, 0x00, 0x00, 0x00, 0x00, 0x02, 0x63, 0xd6, 0xff, 0xbc, 0xff, 0xca, 0xff,
  0xcc, 0x26, 0xa8, 0x86, 0x69, 0xf4, 0xb0, 0xfb, 0x80, 0x00, 0x00, 0x00, 0x00, 0x00, 0xff, 0x8d};

static void put_int16(uint8_t *at, int value)
{
  at[0] = (uint8_t)((unsigned)value & 0xff);
  at[1] = (uint8_t)((unsigned)value >> 8 & 0xff);
}

void stic_seal_hydra(uint8_t report[52])
{
  put_int16(report + 50, stic_hydra_crc(report, 50));
}

void stic_make_hydra(uint8_t report[52], uint8_t sequence, const int mm[3], uint8_t trigger)
{
  memset(report, 0, 52);
  report[0] = 0x01;
  report[2] = 0x34;
  report[4] = 0x02;
  for (int wand = 0; wand < 2; wand++) {
    uint8_t *at = report + 6 + 22 * wand;

    at[0] = (uint8_t)(wand + 1);
    at[1] = sequence;
    for (int i = 0; i < 3; i++)
      put_int16(at + 2 + 2 * i, mm[i]);
    put_int16(at + 8, 32767);
    at[16] = 0x80;
    at[21] = trigger;
  }
  stic_seal_hydra(report);
}

static void make_common(uint8_t *at, uint8_t sequence)
{
  memset(at, 128, 4);
  at[6] = sequence;
  at[7] = 8;
}

void stic_make_pad_usb(uint8_t report[64], uint8_t sequence)
{
  memset(report, 0, 64);
  report[0] = 0x01;
  make_common(report + 1, sequence);
}

void stic_seal_pad(uint8_t report[78])
{
  const uint32_t crc = stic_gamepad_crc(report, 74);

  for (int i = 0; i < 4; i++)
    report[74 + i] = (uint8_t)(crc >> (8 * i));
}

void stic_make_pad_bluetooth(uint8_t report[78], uint8_t sequence)
{
  memset(report, 0, 78);
  report[0] = 0x31;
  make_common(report + 2, sequence);
  stic_seal_pad(report);
}

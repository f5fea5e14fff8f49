#include "gamepad_decode.h"

enum { ID_USB = 0x01, ID_BLUETOOTH = 0x31 };
enum { USB_LENGTH = 64, BLUETOOTH_LENGTH = 78, REDUCED_LENGTH = 10, CRC_LENGTH = 4 };
/* Where the common part begins: after the ID, over Bluetooth also after a byte of its own. */
enum { USB_START = 1, BLUETOOTH_START = 2 };
enum {
  AT_LEFT = 0,
  AT_RIGHT = 2,
  AT_L2 = 4,
  AT_R2 = 5,
  AT_SEQUENCE = 6,
  AT_KEYS = 7
}; /* in the common part */

#define INPUT_SEED 0xa1
#define HAT_CENTRE 8

static uint32_t crc_step(uint32_t crc, uint8_t byte)
{
  crc ^= byte;
  for (int bit = 0; bit < 8; bit++)
    crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
  return crc;
}

uint32_t stic_gamepad_crc(const uint8_t *data, size_t length)
{
  uint32_t crc = crc_step(0xffffffffu, INPUT_SEED);

  for (size_t i = 0; i < length; i++)
    crc = crc_step(crc, data[i]);
  return ~crc;
}

/* 128 is the centre, 0 and 255 the ends. */
static double stick(uint8_t value)
{
  const double part = (value - 128) / 127.0;

  return part < -1 ? -1 : part;
}

static void decode_stick(const uint8_t *at, double out[2])
{
  out[0] = stick(at[0]);
  out[1] = 0.0 - stick(at[1]); /* the pad counts down; 0 stays +0 */
}

static uint32_t decode_buttons(const uint8_t *keys)
{
  static const struct {
    int byte;
    unsigned mask;
    uint32_t button;
  } map[] = {
    {0, 0x10, STIC_GAMEPAD_SQUARE},   {0, 0x20, STIC_GAMEPAD_CROSS},    {0, 0x40, STIC_GAMEPAD_CIRCLE},
    {0, 0x80, STIC_GAMEPAD_TRIANGLE}, {1, 0x01, STIC_GAMEPAD_L1},       {1, 0x02, STIC_GAMEPAD_R1},
    {1, 0x04, STIC_GAMEPAD_L2},       {1, 0x08, STIC_GAMEPAD_R2},       {1, 0x10, STIC_GAMEPAD_CREATE},
    {1, 0x20, STIC_GAMEPAD_OPTIONS},  {1, 0x40, STIC_GAMEPAD_L3},       {1, 0x80, STIC_GAMEPAD_R3},
    {2, 0x01, STIC_GAMEPAD_PS},       {2, 0x02, STIC_GAMEPAD_TOUCHPAD},
  };
  uint32_t buttons = 0;

  for (size_t i = 0; i < sizeof map / sizeof map[0]; i++) {
    if (keys[map[i].byte] & map[i].mask)
      buttons |= map[i].button;
  }
  return buttons;
}

static stic_gamepad_result decode_common(const uint8_t *at, stic_gamepad *pad)
{
  /* clockwise from up; the last is the centre */
  static const int directions[HAT_CENTRE + 1][2] = {{0, 1},   {1, 1},  {1, 0},  {1, -1}, {0, -1},
                                                            {-1, -1}, {-1, 0}, {-1, 1}, {0, 0}};
  const int hat = at[AT_KEYS] & 0x0f;

  if (hat > HAT_CENTRE)
    return STIC_GAMEPAD_BAD_VALUE;
  decode_stick(at + AT_LEFT, pad->left);
  decode_stick(at + AT_RIGHT, pad->right);
  pad->l2 = at[AT_L2] / 255.0;
  pad->r2 = at[AT_R2] / 255.0;
  pad->hat[0] = directions[hat][0];
  pad->hat[1] = directions[hat][1];
  pad->buttons = decode_buttons(at + AT_KEYS);
  pad->sequence = at[AT_SEQUENCE];
  return STIC_GAMEPAD_OK;
}

static uint32_t little_endian_32(const uint8_t *at)
{
  return at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

stic_gamepad_result stic_gamepad_decode(const uint8_t *report, size_t length, stic_gamepad *pad)
{
  if (length == 0)
    return STIC_GAMEPAD_BAD_LENGTH;
  switch (report[0]) {
  case ID_USB:
    if (length == REDUCED_LENGTH)
      return STIC_GAMEPAD_REDUCED;
    /* Exactly: without a checksum, a longer one may be a Bluetooth report behind a surplus byte. */
    if (length != USB_LENGTH)
      return STIC_GAMEPAD_BAD_LENGTH;
    return decode_common(report + USB_START, pad);
  case ID_BLUETOOTH:
    if (length != BLUETOOTH_LENGTH)
      return STIC_GAMEPAD_BAD_LENGTH;
    if (stic_gamepad_crc(report, BLUETOOTH_LENGTH - CRC_LENGTH) !=
        little_endian_32(report + BLUETOOTH_LENGTH - CRC_LENGTH))
      return STIC_GAMEPAD_BAD_CHECKSUM;
    return decode_common(report + BLUETOOTH_START, pad);
  default: return STIC_GAMEPAD_OTHER;
  }
}

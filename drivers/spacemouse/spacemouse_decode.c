#include "spacemouse_decode.h"

#include "../hid/hid.h"

#include <string.h>

enum { ID_TRANSLATION = 1, ID_ROTATION = 2, ID_KEYS = 3, ID_BATTERY = 0x17 };

#define AXES_LENGTH 7      /* ID and three int16 */
#define ALL_AXES_LENGTH 13 /* ID and six */
#define KEYS_LENGTH 3      /* ID and 16 bits; more on models with more keys */
#define BATTERY_LENGTH 3
#define FULL 350.0 /* counts at full deflection by the descriptors; some units go beyond */

static double deflection(int counts)
{
  const double part = counts / FULL;

  return part > 1 ? 1 : part < -1 ? -1 : part;
}

static void decode_axes(const uint8_t *at, double out[3])
{
  double raw[3];

  for (int i = 0; i < 3; i++)
    raw[i] = deflection(stic_hid_int16(at + 2 * i));
  stic_hid_to_openxr(raw, out);
}

static uint32_t decode_keys(const uint8_t *at, size_t length)
{
  uint32_t keys = 0;

  for (size_t i = 0; i < length && i < 4; i++)
    keys |= (uint32_t)at[i] << (8 * i);
  return keys;
}

stic_spacemouse_report stic_spacemouse_decode(stic_spacemouse *mouse, const uint8_t *report, size_t length)
{
  if (length == 0)
    return STIC_SPACEMOUSE_BAD;
  switch (report[0]) {
  case ID_TRANSLATION:
    if (length < AXES_LENGTH)
      return STIC_SPACEMOUSE_BAD;
    decode_axes(report + 1, mouse->translation);
    if (length >= ALL_AXES_LENGTH)
      decode_axes(report + 7, mouse->rotation);
    return STIC_SPACEMOUSE_MOTION;
  case ID_ROTATION:
    if (length < AXES_LENGTH)
      return STIC_SPACEMOUSE_BAD;
    decode_axes(report + 1, mouse->rotation);
    return STIC_SPACEMOUSE_MOTION;
  case ID_KEYS:
    if (length < KEYS_LENGTH)
      return STIC_SPACEMOUSE_BAD;
    mouse->keys = decode_keys(report + 1, length - 1);
    return STIC_SPACEMOUSE_KEYS;
  case ID_BATTERY:
    if (length < BATTERY_LENGTH || report[1] > 100)
      return STIC_SPACEMOUSE_BAD;
    mouse->battery = report[1];
    return STIC_SPACEMOUSE_BATTERY;
  default: return STIC_SPACEMOUSE_OTHER;
  }
}

void stic_spacemouse_rest(stic_spacemouse *mouse)
{
  memset(mouse->translation, 0, sizeof mouse->translation);
  memset(mouse->rotation, 0, sizeof mouse->rotation);
}

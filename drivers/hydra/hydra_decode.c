#include "hydra_decode.h"

#include "../hid/hid.h"

#include <math.h>
#include <string.h>

enum { AT_SEQUENCE = 7, AT_WANDS = 8, WAND_STRIDE = 22, AT_CRC = 50 };
enum { IN_ROTATION = 6, IN_KEYS = 14, IN_STICK = 15, IN_TRIGGER = 19 }; /* within a wand */

#define KEYS_MASK 0x7fu /* bit 7 is always set and means nothing */
#define M_PER_COUNT 0.001
#define ONE 32768.0
#define NORM_TOLERANCE 0.05 /* of the squared norm; devices keep it within 2e-4 */
#define DOCK_RADIUS 0.1

static const uint8_t header[4] = {0x01, 0x00, 0x34, 0x00}; /* kind 1, length 52 */

uint16_t stic_hydra_crc(const uint8_t *data, size_t length)
{
  uint16_t crc = 0x1d0f;

  for (size_t i = 0; i < length; i++) {
    crc ^= (uint16_t)(data[i] << 8);
    for (int bit = 0; bit < 8; bit++)
      crc = (uint16_t)((crc << 1) ^ (crc & 0x8000 ? 0x1021 : 0));
  }
  return crc;
}

static bool decode_rotation(const uint8_t *at, double out[4])
{
  double q[4], norm2 = 0;

  for (int i = 0; i < 4; i++) {
    q[i] = stic_hid_int16(at + 2 * i) / ONE;
    norm2 += q[i] * q[i];
  }
  if (fabs(norm2 - 1) > NORM_TOLERANCE)
    return false;
  for (int i = 0; i < 4; i++)
    q[i] /= sqrt(norm2);
  stic_hid_to_openxr(q + 1, out);
  out[3] = q[0];
  return true;
}

static bool decode_wand(const uint8_t *at, stic_hydra_wand *wand)
{
  double raw[3];

  for (int i = 0; i < 3; i++)
    raw[i] = M_PER_COUNT * stic_hid_int16(at + 2 * i);
  stic_hid_to_openxr(raw, wand->position);
  wand->keys = at[IN_KEYS] & KEYS_MASK;
  for (int i = 0; i < 2; i++)
    wand->stick[i] = stic_hid_int16(at + IN_STICK + 2 * i) / ONE;
  wand->trigger = at[IN_TRIGGER] / 255.0;
  return decode_rotation(at + IN_ROTATION, wand->orientation);
}

stic_hydra_result stic_hydra_decode(const uint8_t *report, size_t length, stic_hydra_report *out)
{
  stic_hydra_report decoded;

  if (length != STIC_HYDRA_REPORT_LENGTH)
    return STIC_HYDRA_OTHER;
  if (stic_hydra_crc(report, AT_CRC) != (report[AT_CRC] | report[AT_CRC + 1] << 8))
    return STIC_HYDRA_BAD_CHECKSUM;
  if (memcmp(report, header, sizeof header) != 0)
    return STIC_HYDRA_BAD_HEADER;
  decoded.sequence = report[AT_SEQUENCE];
  for (int i = 0; i < 2; i++) {
    if (!decode_wand(report + AT_WANDS + i * WAND_STRIDE, &decoded.wands[i]))
      return STIC_HYDRA_BAD_ROTATION;
  }
  *out = decoded;
  return STIC_HYDRA_OK;
}

void stic_hydra_mode_command(bool motion, uint8_t feature[STIC_HYDRA_FEATURE_LENGTH])
{
  uint8_t sum = 0;

  memset(feature, 0, STIC_HYDRA_FEATURE_LENGTH);
  feature[6] = 1; /* one byte of data */
  feature[8] = 4; /* device mode */
  feature[9] = motion ? 3 : 0;
  for (int i = 3; i < 89; i++)
    sum ^= feature[i];
  feature[89] = sum;
}

bool stic_hydra_grips(bool gripped, double trigger)
{
  return gripped ? trigger >= 0.4 : trigger > 0.5;
}

static double dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static bool first_is_mirrored(int wand, const double position[3])
{
  if (dot(position, position) < DOCK_RADIUS * DOCK_RADIUS)
    return wand == STIC_HYDRA_LEFT ? position[0] > 0 : position[0] < 0;
  return position[2] < 0;
}

void stic_hydra_keep_hemisphere(stic_hydra_hemisphere *hemisphere, int wand, double position[3])
{
  /* |-p - last| < |p - last| exactly if p . last < 0 */
  const bool mirrored =
    hemisphere->known ? dot(position, hemisphere->last) < 0 : first_is_mirrored(wand, position);

  for (int i = 0; i < 3; i++) {
    if (mirrored)
      position[i] = -position[i];
    hemisphere->last[i] = position[i];
  }
  hemisphere->known = true;
}

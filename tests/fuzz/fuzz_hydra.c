/* Motion reports of the Hydra. The first byte's bits ask for a left wand that is not turned, for a right one, and
 * for the right checksum, so that what is behind these checks is reached. */
#include "../../drivers/hydra/hydra_decode.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(const stic_hydra_wand *wand)
{
  double norm2 = 0;

  for (int i = 0; i < 4; i++)
    norm2 += wand->orientation[i] * wand->orientation[i];
  if (!(fabs(norm2 - 1) < 1e-12) || !(wand->trigger >= 0 && wand->trigger <= 1) || wand->keys > 0x7f)
    abort();
  for (int i = 0; i < 3; i++) {
    if (!(fabs(wand->position[i]) <= 32.768))
      abort();
  }
  for (int i = 0; i < 2; i++) {
    if (!(fabs(wand->stick[i]) <= 1))
      abort();
  }
}

static void repair(uint8_t bytes[STIC_HYDRA_REPORT_LENGTH], uint8_t what)
{
  static const uint8_t upright[8] = {0xff, 0x7f}; /* w = 32767 */
  uint16_t crc;

  if (what & 1)
    memcpy(bytes + 14, upright, sizeof upright);
  if (what & 2)
    memcpy(bytes + 36, upright, sizeof upright);
  if (!(what & 4))
    return;
  memcpy(bytes, "\x01\x00\x34", 4);
  crc = stic_hydra_crc(bytes, STIC_HYDRA_REPORT_LENGTH - 2);
  bytes[STIC_HYDRA_REPORT_LENGTH - 2] = (uint8_t)(crc & 0xff);
  bytes[STIC_HYDRA_REPORT_LENGTH - 1] = (uint8_t)(crc >> 8);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  uint8_t bytes[256] = {0};
  stic_hydra_report report;
  stic_hydra_hemisphere hemisphere = {0};

  if (size == 0 || size > sizeof bytes)
    return 0;
  memcpy(bytes, data + 1, size - 1);
  if (size - 1 == STIC_HYDRA_REPORT_LENGTH)
    repair(bytes, data[0]);
  if (stic_hydra_decode(bytes, size - 1, &report) != STIC_HYDRA_OK)
    return 0;
  for (int i = 0; i < 2; i++) {
    check(&report.wands[i]);
    stic_hydra_keep_hemisphere(&hemisphere, i, report.wands[i].position);
    check(&report.wands[i]);
  }
  return 0;
}

/* Reports of the DualSense. With an odd first byte the checksum of a Bluetooth report is put right. */
#include "../../drivers/gamepad/gamepad_decode.h"

#include <stdlib.h>
#include <string.h>

#define BLUETOOTH_LENGTH 78

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(const stic_gamepad *pad)
{
  for (int i = 0; i < 2; i++) {
    if (!(pad->left[i] >= -1 && pad->left[i] <= 1) || !(pad->right[i] >= -1 && pad->right[i] <= 1) ||
        pad->hat[i] < -1 || pad->hat[i] > 1)
      abort();
  }
  if (!(pad->l2 >= 0 && pad->l2 <= 1) || !(pad->r2 >= 0 && pad->r2 <= 1) || pad->buttons > 0x3fff)
    abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  uint8_t bytes[256] = {0};
  stic_gamepad pad;

  if (size == 0 || size > sizeof bytes)
    return 0;
  memcpy(bytes, data + 1, size - 1);
  if (data[0] & 1 && size - 1 >= BLUETOOTH_LENGTH) {
    const uint32_t crc = stic_gamepad_crc(bytes, BLUETOOTH_LENGTH - 4);

    for (int i = 0; i < 4; i++)
      bytes[BLUETOOTH_LENGTH - 4 + i] = (uint8_t)(crc >> (8 * i));
  }
  if (stic_gamepad_decode(bytes, size - 1, &pad) == STIC_GAMEPAD_OK)
    check(&pad);
  return 0;
}

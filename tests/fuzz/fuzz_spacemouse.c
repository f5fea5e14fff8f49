/* Reports of 3Dconnexion devices, a stream of them: each is led by its length. */
#include "../../drivers/spacemouse/spacemouse_decode.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(const stic_spacemouse *mouse)
{
  for (int i = 0; i < 3; i++) {
    if (!(mouse->translation[i] >= -1 && mouse->translation[i] <= 1) ||
        !(mouse->rotation[i] >= -1 && mouse->rotation[i] <= 1))
      abort();
  }
  if (mouse->battery < -1 || mouse->battery > 100)
    abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  stic_spacemouse mouse = {.battery = -1};

  while (size > 0) {
    const size_t wanted = data[0] & 0x1f;
    const size_t length = wanted < size - 1 ? wanted : size - 1;
    const stic_spacemouse before = mouse;
    const stic_spacemouse_report kind = stic_spacemouse_decode(&mouse, data + 1, length);

    check(&mouse);
    if ((kind == STIC_SPACEMOUSE_BAD || kind == STIC_SPACEMOUSE_OTHER) &&
        memcmp(&before, &mouse, sizeof mouse) != 0)
      abort();
    data += 1 + length;
    size -= 1 + length;
  }
  return 0;
}

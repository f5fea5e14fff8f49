/* Reports to decode: captured ones and builders of others. */
#ifndef STIC_TEST_VECTORS_H
#define STIC_TEST_VECTORS_H

#include <stddef.h>
#include <stdint.h>

/* A Hydra's motion report as captured from the device. Left wand: (47, -65, -52) mm, quaternion w, x, y, z
 * = (-8481, 31100, 1825, -5581) / 32768; right: (-42, -68, -54) mm, (9932, -31064, -2967, -1104) / 32768. */
extern const uint8_t stic_hydra_captured[52];

/* Makes a Hydra report: both wands at `mm` with quaternion w = 32767, x = y = z = 0, this sequence number and
 * trigger (0..255), and the right checksum. */
void stic_make_hydra(uint8_t report[52], uint8_t sequence, const int mm[3], uint8_t trigger);
/* Puts the right checksum in. */
void stic_seal_hydra(uint8_t report[52]);

/* A DualSense at rest: sticks and hat centred. Over Bluetooth with the right checksum. */
void stic_make_pad_usb(uint8_t report[64], uint8_t sequence);
void stic_make_pad_bluetooth(uint8_t report[78], uint8_t sequence);
void stic_seal_pad(uint8_t report[78]);

#endif

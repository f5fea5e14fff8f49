/* Reports of the Razer Hydra: two wands in the field of a magnetic base. Pure: no I/O, no clock. */
#ifndef STIC_HYDRA_DECODE_H
#define STIC_HYDRA_DECODE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define STIC_HYDRA_REPORT_LENGTH 52  /* bytes of a motion report; it has no ID */
#define STIC_HYDRA_FEATURE_LENGTH 91 /* of the mode command, with the leading 0 that stands for no ID */

enum { STIC_HYDRA_LEFT, STIC_HYDRA_RIGHT };

/* Bits of `keys`. */
enum {
  STIC_HYDRA_BUMPER = 0x01,
  STIC_HYDRA_KEY_3 = 0x02,
  STIC_HYDRA_KEY_1 = 0x04,
  STIC_HYDRA_KEY_2 = 0x08,
  STIC_HYDRA_KEY_4 = 0x10,
  STIC_HYDRA_KEY_MIDDLE = 0x20,
  STIC_HYDRA_STICK = 0x40
};

typedef struct stic_hydra_wand {
  double position[3];    /* m from the base, OpenXR axes; the sign may be wrong, see the hemisphere below */
  double orientation[4]; /* unit quaternion x, y, z, w, ditto */
  double stick[2];       /* -1..1, right and up */
  double trigger;        /* 0..1 */
  unsigned keys;         /* sum of the above */
} stic_hydra_wand;

typedef struct stic_hydra_report {
  uint8_t sequence; /* one more with each report, modulo 256 */
  stic_hydra_wand wands[2];
} stic_hydra_report;

typedef enum stic_hydra_result {
  STIC_HYDRA_OK,
  STIC_HYDRA_OTHER, /* not as long as a motion report: from the gamepad side */
  STIC_HYDRA_BAD_HEADER,
  STIC_HYDRA_BAD_CHECKSUM,
  STIC_HYDRA_BAD_ROTATION /* a quaternion that is none */
} stic_hydra_result;

/* Decodes a report; `*out` is written only if it is good. Real-time: yes. */
stic_hydra_result stic_hydra_decode(const uint8_t *report, size_t length, stic_hydra_report *out);

/* CRC-16 of a report: polynomial 0x1021, initial value 0x1D0F, bits not reflected. Real-time: yes. */
uint16_t stic_hydra_crc(const uint8_t *data, size_t length);

/* Writes the feature report that switches to motion reports or back to a gamepad. Real-time: yes. */
void stic_hydra_mode_command(bool motion, uint8_t feature[STIC_HYDRA_FEATURE_LENGTH]);

/* Whether the trigger grips: from 0.5 on, until below 0.4 again. Real-time: yes. */
bool stic_hydra_grips(bool gripped, double trigger);

/* The base's field is the same at p and -p, so a wand's position may come with the wrong sign. All zero is
 * a wand not yet seen. */
typedef struct stic_hydra_hemisphere {
  bool known;
  double last[3]; /* m */
} stic_hydra_hemisphere;

/* Gives the position the sign that keeps the path whole. A wand seen for the first time within 0.1 m
 * of the base is in its dock, left or right; elsewhere it is on the user's side. Real-time: yes. */
void stic_hydra_keep_hemisphere(stic_hydra_hemisphere *hemisphere, int wand, double position[3]);

#endif

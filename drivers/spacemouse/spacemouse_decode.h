/* Reports of 3Dconnexion devices. Pure: no I/O, no clock. */
#ifndef STIC_SPACEMOUSE_DECODE_H
#define STIC_SPACEMOUSE_DECODE_H

#include <stddef.h>
#include <stdint.h>

/* The cap and the keys as last reported. All zero, battery -1, is the cap at rest. */
typedef struct stic_spacemouse {
  double translation[3]; /* of full deflection, -1..1, OpenXR axes */
  double rotation[3];    /* ditto, right-hand turns about the axes */
  uint32_t keys;         /* bits as in report 3, 1 = down */
  int battery;           /* percent, 0..100; -1: not told */
} stic_spacemouse;

typedef enum stic_spacemouse_report {
  STIC_SPACEMOUSE_BAD,   /* shorter than its kind must be, or a value that cannot be; nothing changed */
  STIC_SPACEMOUSE_OTHER, /* a kind that says nothing to us */
  STIC_SPACEMOUSE_MOTION,
  STIC_SPACEMOUSE_KEYS,
  STIC_SPACEMOUSE_BATTERY
} stic_spacemouse_report;

/* Takes one report in, its ID first, and says what it was. Longer than needed is right: some systems pad.
 * Real-time: yes. */
stic_spacemouse_report stic_spacemouse_decode(stic_spacemouse *mouse, const uint8_t *report, size_t length);

/* Sets the cap to rest; keys stay. Real-time: yes. */
void stic_spacemouse_rest(stic_spacemouse *mouse);

#endif

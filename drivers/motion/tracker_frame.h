/* Where a tracker stands in the room, how it is scaled and which of its buttons does what. */
#ifndef STIC_TRACKER_FRAME_H
#define STIC_TRACKER_FRAME_H

#include "../driver.h"

/* Buttons after the map. The grip is the solver's; clutch and reset are the rate integrator's. */
#define STIC_BUTTON_RESET 2u
#define STIC_BUTTON_CLUTCH 4u

#define STIC_TRACKER_BUTTONS 3 /* grip, reset, clutch: bits 0, 1, 2 */

typedef struct stic_tracker_frame {
  double axes[9];      /* device to room, a proper rotation, row by row: the room's x, y, z in the device's
                           * axes; default the identity */
  double hand_axes[9]; /* the hand's axes in those of the moving part, a proper rotation (columns: the hand's
                           * x, y, z); default the inverse of `axes`: a device at its own zero is a hand at zero */
  double scale;        /* room metres per device metre, > 0, default 1 */
  double offset[3];    /* m, where the device's origin is in the room, default 0 */
  int buttons[STIC_TRACKER_BUTTONS]; /* bit 0..31 of the device that is grip, reset, clutch; -1: none;
                                      * default 0, 1, 2 */
} stic_tracker_frame;

void stic_tracker_frame_init(stic_tracker_frame *frame);

/* Brings a sample into the room, in place: p' = scale axes p + offset, R' = axes R hand_axes, velocities alike.
 * Buttons that the map does not name are dropped. Real-time: yes. */
void stic_tracker_frame_apply(const stic_tracker_frame *frame, stic_device_sample *sample);

/* Whether a matrix is a rotation, not a mirror, to 1e-6. */
bool stic_is_proper_rotation(const double m[9]);

#endif

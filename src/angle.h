/* Angles in numbers: C99 has no constant for pi. Internal; the solver's own, in its three precisions, is in
 * statics/real.h. */
#ifndef STIC_ANGLE_H
#define STIC_ANGLE_H

#define STIC_PI 3.14159265358979323846
#define STIC_DEG_PER_RAD (180 / STIC_PI)
#define STIC_RAD_PER_DEG (STIC_PI / 180)

#endif

/* A pose from the velocities of a rate device (STIC_DRIVER_RATE). */
#ifndef STIC_RATE_TO_POSE_H
#define STIC_RATE_TO_POSE_H

#include "../driver.h"

typedef struct stic_rate_settings {
  double linear, angular;  /* factors on the velocities, default 1 */
  double dead_zone[2];     /* m/s, rad/s: per axis, no motion below, less by it above; default 0.002, 0.02 */
  bool auto_zero;          /* default true: what stands still below twice the dead zone for 1 s is drift */
  double home_position[3]; /* m, where it starts and where a reset brings it; default 0 */
  double home_orientation[4]; /* default no turn */
  uint32_t clutch, reset;     /* buttons, default 4 and 2: pressed, the clutch holds the pose; pressing reset
                                * brings it home */
  int64_t hold_ns;            /* a velocity holds until the next sample, but no longer; default 100 ms */
} stic_rate_settings;

#define STIC_RATE_AXES 6

typedef struct stic_rate_to_pose {
  stic_rate_settings settings;
  bool begun;
  int64_t t_ns;
  double position[3], orientation[4];
  double rates[STIC_RATE_AXES]; /* that hold since t_ns: m/s, rad/s */
  uint32_t buttons;             /* of the last sample */
  double zero[STIC_RATE_AXES];  /* the device's own at rest */
  int64_t still_since_ns;       /* for auto-zero: no axis has left its band since */
  double still_low[STIC_RATE_AXES], still_high[STIC_RATE_AXES];
} stic_rate_to_pose;

void stic_rate_settings_init(stic_rate_settings *settings);

/* Settings are copied; the pose is home. Real-time: yes, as all here. */
void stic_rate_begin(stic_rate_to_pose *integrator, const stic_rate_settings *settings);

/* Brings the pose to the sample's time and writes it into the sample, with STIC_SAMPLE_POSITION and _ORIENTATION,
 * and _TRACKED if the sample has a velocity; without one nothing moves. `velocity` and `turn_rate` become
 * those that the pose follows. */
void stic_rate_apply(stic_rate_to_pose *integrator, stic_device_sample *sample);

#endif

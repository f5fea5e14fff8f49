/* The `tracker:` section of a scene, or of a file of its own with the same shape:
 *
 *   stiction: 1
 *   tracker:
 *     axes: [x, -z, y]          # which of the device's axes is the room's right, up, toward the user; or nine
 *                               #   numbers, a rotation row by row; default [x, y, z]
 *     hand_axes: [x, y, z]      # the hand's axes in those of the moving part, alike; default the inverse of axes
 *     scale: 1                  # room metres per device metre, 0.001 to 1000
 *     offset: [0, 0, 0]         # m, where the device's origin is in the room
 *     buttons: {grip: 0, reset: 1, clutch: 2}  # bits of the device as `monitor` shows them, or none
 *     filter:                   # absent: none; {}: as here. Each [position, orientation]
 *       min_cutoff: [1.15, 1.5]           # Hz
 *       beta: [0.5, 0.5]                  # Hz per m/s, per rad/s
 *       derivative_cutoff: [1.2, 1.2]     # Hz
 *     rate:                     # for devices that give velocities
 *       linear: 1               # factors on the velocities
 *       angular: 1
 *       dead_zone: [0.002, 0.02]          # m/s, rad/s
 *       auto_zero: true         # what stands still near zero for 1 s is drift
 *       home: [0, 0, 0]         # m, where it starts and a reset brings it */
#ifndef STIC_TRACKER_YAML_H
#define STIC_TRACKER_YAML_H

#include "one_euro.h"
#include "rate_to_pose.h"
#include "tracker_frame.h"

typedef struct stic_tracker_settings {
  stic_tracker_frame frame;
  bool filtered; /* default false */
  stic_one_euro_settings filter;
  stic_rate_settings rate; /* for STIC_DRIVER_RATE; its buttons are those after the frame's map */
} stic_tracker_settings;

void stic_tracker_settings_init(stic_tracker_settings *settings);

/* Reads the section of a scene or tracker file, or of `text` if that is not NULL: what was in the file; `*settings` has the defaults where it says nothing, also if there
 * is no section and `required` is false. The first problem is told with its line. Other keys of the file are
 * for the reader of scenes. Errors: STIC_BAD_INPUT, STIC_NO_MEMORY; `*settings` is as after init then. Real-time:
 * no. */
stic_status stic_tracker_read(const char *path, const char *text, bool required,
                              stic_tracker_settings *settings, stic_error *err);

/* What a device's samples go through on their way to the solver. */
typedef struct stic_tracker {
  stic_tracker_settings settings;
  bool rate; /* the device gives velocities */
  stic_rate_to_pose integrator;
  stic_one_euro filter;
} stic_tracker;

void stic_tracker_begin(stic_tracker *tracker, const stic_tracker_settings *settings, stic_driver_kind kind);

/* Frame, then integrator (rate devices), then filter, in place. Real-time: yes. */
void stic_tracker_apply(stic_tracker *tracker, stic_device_sample *sample);

/* What the solver is given of a sample in the room, but for its time, which stays 0. False while nobody knows where the
 * hand is. Real-time: yes. */
bool stic_tracker_solvable(const stic_device_sample *from, stic_sample *to);

#endif

/* The One-Euro filter (Casiez, Roussel, Vogel, CHI 2012) on positions and orientations: a low-pass whose
 * cut-off rises with speed, so that a resting hand does not tremble and a fast one does not lag. Steps of time
 * are those of the samples. Off unless asked for. */
#ifndef STIC_ONE_EURO_H
#define STIC_ONE_EURO_H

#include "../driver.h"

typedef struct stic_one_euro_settings {
  double min_cutoff[2];        /* position, orientation: Hz at rest, > 0, default 1.15 and 1.5 */
  double beta[2];              /* Hz per m/s and per rad/s, >= 0, default 0.5 and 0.5 */
  double derivative_cutoff[2]; /* Hz, of the speed's own low-pass, > 0, default 1.2 and 1.2 */
} stic_one_euro_settings;

typedef struct stic_one_euro {
  stic_one_euro_settings settings;
  bool begun;
  int64_t t_ns;
  double position[3], orientation[4]; /* filtered */
  double speed[2];                    /* low-passed, m/s and rad/s */
} stic_one_euro;

void stic_one_euro_settings_init(stic_one_euro_settings *settings);

/* Settings are copied. Real-time: yes, as all here. */
void stic_one_euro_begin(stic_one_euro *filter, const stic_one_euro_settings *settings);

/* Filters a sample's pose in place. What is not tracked passes as it is and ends the filter's memory:
 * after a gap the first sample passes unchanged too. Velocities stay as they are. */
void stic_one_euro_apply(stic_one_euro *filter, stic_device_sample *sample);

#endif

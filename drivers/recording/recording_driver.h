/* A raw recording as a tracker, paced as recorded: recording:file=F[,speed=S][,loop][,driver=NAME...]. */
#ifndef STIC_RECORDING_DRIVER_H
#define STIC_RECORDING_DRIVER_H

#include "../driver.h"

extern const stic_driver stic_recording_driver;

#endif

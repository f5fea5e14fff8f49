/* A trace file or standard input as a tracker: trace:file=F[,speed=S][,loop]. */
#ifndef STIC_TRACE_DRIVER_H
#define STIC_TRACE_DRIVER_H

#include "../driver.h"

extern const stic_driver stic_trace_driver;

#endif

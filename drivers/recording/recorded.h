/* A raw recording, HID or serial, decoded by the real driver as the device would have been: silence counts too. Time is
 * the recording's and passes as fast as it is read. */
#ifndef STIC_RECORDED_H
#define STIC_RECORDED_H

#include "../connection.h"
#include "../raw_recording.h"

typedef struct stic_recorded_options {
  const char *driver; /* NAME[:key=value,...] as for a live device; NULL: the driver that the recording's own
                       * device matches. Keys that open a device (port=, path=, serial=, raw=) have no use here */
  bool lenient;       /* default false; true: bad lines are passed over */
  void (*report)(void *context, const stic_error *problem); /* told about each; may be NULL */
  void *context;
} stic_recorded_options;

typedef struct stic_recorded stic_recorded;

/* Opens a recording, "-" for standard input. `options` may be NULL. The caller owns `*recorded`. Errors: STIC_BAD_INPUT,
 * STIC_USAGE (the driver is not for it), STIC_NO_MEMORY. Real-time: no. */
stic_status stic_recorded_open(const char *path, const stic_recorded_options *options,
                               stic_recorded **recorded, stic_error *err);
void stic_recorded_close(stic_recorded *recorded); /* NULL allowed */

/* The next samples in order, times strictly increasing: their number > 0, 0 (a signal came; ask again), or
 * STIC_DRIVER_END, STIC_DRIVER_BAD_DATA with stic_recorded_error(). Allocates nothing; reads the file. */
int stic_recorded_next(stic_recorded *recorded, stic_device_sample *samples, int capacity);

const stic_error *stic_recorded_error(const stic_recorded *recorded);
const stic_driver *stic_recorded_driver(const stic_recorded *recorded);
stic_device_counters stic_recorded_counters(const stic_recorded *recorded);
/* The device inside, for its `raw`. */
const stic_device *stic_recorded_device(const stic_recorded *recorded);
void stic_recorded_describe(const stic_recorded *recorded, char *out, size_t out_size);

#endif

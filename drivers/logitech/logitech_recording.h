/* A raw serial recording of a Logitech tracker as a device, on the recording's own clock. */
#ifndef STIC_LOGITECH_RECORDING_H
#define STIC_LOGITECH_RECORDING_H

#include "../driver.h"
#include "../raw_recording.h"

/* Makes a device of a recording that has just been opened, and owns it from then on, also on failure. A wait takes no
 * time; after the last record poll() says STIC_DRIVER_END. Errors: STIC_BAD_INPUT, STIC_NO_MEMORY. Real-time: no. */
stic_status stic_logitech_recording_begin(stic_raw_reader *reader, stic_device **device, stic_error *err);

/* How far it has been read, ns of its clock. `device` is one of the above. */
int64_t stic_logitech_recording_now(const stic_device *device);

#endif

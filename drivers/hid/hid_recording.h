/* A raw HID recording as a transport: the real drivers decode it again. */
#ifndef STIC_HID_RECORDING_H
#define STIC_HID_RECORDING_H

#include "hid.h"

typedef struct stic_hid_recording stic_hid_recording;

/* Makes a transport of a recording that has just been opened, and owns it from then on, also on failure.
 * STIC_BAD_INPUT, also for a serial recording; STIC_NO_MEMORY. The caller owns `*recording`. Real-time: no. */
stic_status stic_hid_recording_begin(stic_raw_reader *reader, const char *path,
                                     stic_hid_recording **recording, stic_error *err);

void stic_hid_recording_close(stic_hid_recording *recording); /* NULL allowed */

/* Its nodes are "recording:0" ... for the devices known at its first event. Its clock is the recording's: it stands
 * where reading has come to, and a wait takes no time. Reports of devices that nobody opened are passed over.
 * Feature and output reports go nowhere. What ends early or is wrong ends as STIC_DRIVER_END;
 * stic_hid_recording_error() tells. Lives as long as the recording. */
const stic_hid_transport *stic_hid_recording_transport(stic_hid_recording *recording);

/* What was wrong with the file; STIC_OK status: nothing so far. */
const stic_error *stic_hid_recording_error(const stic_hid_recording *recording);

#endif

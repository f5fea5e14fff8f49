/* The drivers of HID devices, opened over any transport. */
#ifndef STIC_HID_DRIVERS_H
#define STIC_HID_DRIVERS_H

#include "hid.h"

/* Opens, over a transport that must outlive it, a device with the driver that the specification names.
 * STIC_USAGE if that is no HID driver or a key is wrong, else as the driver's open(). Real-time: no. */
stic_status stic_hid_open_over(const stic_hid_transport *transport, const stic_device_spec *spec,
                               stic_device **device, stic_error *err);

/* The HID driver that is for a node; NULL: none. */
const stic_driver *stic_hid_driver_for(const stic_hid_node *node);

#endif

/* Which hidraw nodes there are, from sysfs. */
#ifndef STIC_HID_SYSFS_H
#define STIC_HID_SYSFS_H

#include "hid.h"

#define STIC_HID_SYSFS "/sys/class/hidraw"

/* Lists the nodes under `root` (STIC_HID_SYSFS, or a test's copy of it) by their number, each once for every usage.
 * Devices that come or go meanwhile are listed whole or not at all. Returns the number, 0 without a root.
 * Real-time: no. */
int stic_hid_sysfs_enumerate(const char *root, stic_hid_node *nodes, int capacity);

#endif

/* What is connected: HID nodes and serial ports, the driver for each, what to type, and what stops it. */
#ifndef STIC_SCAN_H
#define STIC_SCAN_H

#include "hid/hid.h"

#define STIC_SCAN_MAX 128      /* devices found at once; what is beyond is not seen */
#define STIC_SCAN_GROUP_MAX 32 /* bytes of a group's name */

/* Why a device would not open, as far as its node tells. */
typedef enum stic_scan_state {
  STIC_SCAN_READY,
  STIC_SCAN_NO_NODE,      /* listed, but there is nothing at its path */
  STIC_SCAN_NO_PERMISSION /* a node that may not be read and written */
} stic_scan_state;

typedef struct stic_scan_device {
  stic_hid_node node;        /* of a serial port: bus "serial", the numbers of its USB adapter or 0 */
  const stic_driver *driver; /* NULL: none is for it */
  bool certain;              /* false: the driver is for whatever may be behind the port */
  char spec[STIC_SPEC_MAX];  /* what to type after --device; "" without a driver */
  stic_scan_state state;
  char group[STIC_SCAN_GROUP_MAX]; /* that owns the node; "" if not known */
} stic_scan_device;

/* Where to look; a test has places of its own. */
typedef struct stic_scan_places {
  const stic_hid_transport *hid;             /* of which only enumerate() is used */
  const char *tty;                           /* folder with an entry for every terminal */
  const char *dev;                           /* folder of serial ports' nodes */
  int (*access)(const char *path, int mode); /* as access(2) */
} stic_scan_places;

/* The system's own. */
extern const stic_scan_places stic_scan_system;

/* Lists what is there, HID first; opens nothing, since opening a serial port moves its modem lines. `devices` holds
 * at least STIC_SCAN_MAX. Returns the number. Real-time: no. */
int stic_scan(const stic_scan_places *places, stic_scan_device *devices);

#endif

/* HID devices, found and read through a small table of functions: hidapi is one, a test's fake or a
 * recording can be another. Shared by the drivers of HID devices. */
#ifndef STIC_HID_H
#define STIC_HID_H

#include "../driver.h"
#include "../raw_recording.h"

#define STIC_HID_NODES_MAX 64   /* found at once; what is beyond is not seen */
#define STIC_HID_PATH_MAX 256   /* bytes with the final 0; longer ones are not seen */
#define STIC_HID_TEXT_MAX 64    /* ditto, of names and serial numbers; longer ones are cut */
#define STIC_HID_REPORT_MAX 128 /* bytes of the longest report read, with its ID */
#define STIC_HID_QUEUE 64       /* reports that the kernel keeps for one reader; then it drops the newest */
#define STIC_HID_DRAIN_MAX 256  /* reports taken in one poll(), so that a babbling device cannot hold it */

/* What a top-level collection is for, in the numbers of USB's HID Usage Tables. */
typedef struct stic_hid_usage {
  uint16_t page, id; /* 0, 0: unknown */
} stic_hid_usage;

/* One thing that can be opened. */
typedef struct stic_hid_node {
  char path[STIC_HID_PATH_MAX];
  char product_name[STIC_HID_TEXT_MAX]; /* "" if it tells none; ASCII, the rest shown as '?' */
  char serial[STIC_HID_TEXT_MAX];       /* ditto */
  const char *bus;                      /* "usb", "bluetooth", "hid" if unknown; static */
  uint16_t vendor, product;
  stic_hid_usage usage;
} stic_hid_node;

/* An opened node; each transport has its own. */
typedef struct stic_hid_handle stic_hid_handle;

/* How to get at HID devices. All functions take the `context` of their table or a handle that its open()
 * gave. */
typedef struct stic_hid_transport {
  const char *name; /* "hidraw", "libusb" ... */
  void *context;    /* owned by whoever made the table */

  /* Writes what is there, a path perhaps several times (once for each usage): their number, at most
   * `capacity`. Real-time: no. */
  int (*enumerate)(void *context, stic_hid_node *nodes, int capacity);

  /* Opens a node that enumerate() gave. Errors: STIC_NO_DEVICE, with what to do in the message if there
   * is no permission; STIC_NO_MEMORY. Real-time: no. */
  stic_status (*open)(void *context, const stic_hid_node *node, stic_hid_handle **handle, stic_error *err);

  /* One whole report, its ID first if it is numbered: its length > 0 and when it came; 0 if there is none
   * until `until_ns` (the past: does not wait) or a signal came first; STIC_DRIVER_LOST, STIC_DRIVER_END.
   * What is longer than `size` is cut. Real-time: yes. */
  int (*read)(stic_hid_handle *handle, uint8_t *report, size_t size, int64_t until_ns, int64_t *t_ns);

  /* Output report; data[0] is its ID, 0 if unnumbered. 0, or STIC_DRIVER_LOST. May take one USB transfer's
   * time. */
  int (*write)(stic_hid_handle *handle, const uint8_t *data, size_t length);

  /* Feature reports, ditto. get: data[0] is the ID wanted; the length with the ID, or STIC_DRIVER_LOST. */
  int (*set_feature)(stic_hid_handle *handle, const uint8_t *data, size_t length);
  int (*get_feature)(stic_hid_handle *handle, uint8_t *data, size_t size);

  void (*close)(stic_hid_handle *handle);

  /* Now, on the clock that read() stamps reports with (of a live transport: CLOCK_MONOTONIC). Real-time: yes. */
  int64_t (*now)(void *context);
} stic_hid_transport;

/* The system's devices, by hidapi. */
extern const stic_hid_transport stic_hid_system;

/* Keys that every HID driver knows, for its table. */
#define STIC_HID_SPEC_KEYS                                                                                   \
  {"path", false, "which node, as `stiction devices` shows it, default the first that fits"},                \
    {"serial", false, "which device, by its serial number"},                                                 \
  {                                                                                                          \
    "raw", false, "record the received reports to a file, for reports of problems"                           \
  }

/* Lists what the transport has, each path once: of several usages the first on the Generic Desktop page, else
 * the first. Returns the number. Real-time: no. */
int stic_hid_list(const stic_hid_transport *transport, stic_hid_node *nodes, int capacity);

/* The node as match() wants it; its strings are the node's. */
stic_device_id stic_hid_id(const stic_hid_node *node);

/* An opened node. Must not be moved. Fields are read-only outside. */
typedef struct stic_hid_link {
  const stic_hid_transport *transport;
  stic_hid_handle *handle;
  stic_hid_node node;
  struct stic_hid_link *first; /* of those that were opened together */
  stic_raw_writer *raw;        /* of the first: where received reports are recorded; NULL: nowhere */
} stic_hid_link;

/* Opens up to `capacity` of the nodes that `driver` matches (with any of their usages) and the specification's
 * path and serial number allow, all of one product, by their usage's number and unknown usages last. At least
 * one, else STIC_NO_DEVICE. Begins the raw recording if the specification asks for one (STIC_CANNOT_WRITE).
 * Nothing is left open on failure. Real-time: no. */
stic_status stic_hid_connect(const stic_hid_transport *transport, const stic_driver *driver,
                             const stic_device_spec *spec, stic_hid_link *links, int capacity, int *count,
                             stic_error *err);
void stic_hid_disconnect(stic_hid_link *links, int count);

/* A driver's part of reading: takes one report in and says whether it filled `*sample`. Real-time: yes. */
typedef bool (*stic_hid_take)(stic_device *device, const stic_hid_link *link, const uint8_t *report,
                              size_t length, int64_t t_ns, stic_device_sample *sample);

/* Waits until a report has made a sample or `until_ns`, and then takes what is queued: what poll() returns. On
 * loss sets the device's state and error; a queue found full counts as an overrun. Real-time: yes, unless
 * reports are recorded: the disk may be waited for, and a recording that fails ends with a word in the error. */
int stic_hid_drain(stic_hid_link *link, stic_device *device, stic_hid_take take, int64_t until_ns,
                   stic_device_sample *samples, int capacity);

int64_t stic_hid_now(const stic_hid_link *link);

/* "SpaceNavigator 046d:c626 at /dev/hidraw3 (hidraw)", always terminated. */
void stic_hid_describe(const stic_hid_link *link, const char *name, char *out, size_t out_size);

/* What to tell a user who may not open a node: path, udev rule and the command that reloads the rules.
 * Returns STIC_NO_DEVICE. Real-time: no. */
stic_status stic_hid_no_permission(const stic_hid_node *node, stic_error *err);

/* ---- what reports have in common --------------------------------------------------------- */

/* A sample without a pose or rates, but with a unit quaternion. Real-time: yes. */
void stic_hid_clear_sample(stic_device_sample *sample, int64_t t_ns, uint64_t sequence, unsigned flags);

/* A device's count of its reports, modulo 256. All zero is one not yet begun. */
typedef struct stic_hid_sequence {
  bool begun;
  uint8_t last;
  uint64_t total; /* reports sent, those that were lost as well */
} stic_hid_sequence;

/* Takes the next report's count in; one that does not follow the last adds to `*gaps`. Real-time: yes. */
void stic_hid_count(stic_hid_sequence *sequence, uint8_t count, int64_t *gaps);

/* What full deflection means for devices that give rates. */
typedef struct stic_hid_rates {
  double speed; /* m/s, 0..100, default 0.25: across a table-top scene in about a second */
  double turn;  /* rad/s, 0..100, default 1.5: a quarter turn in about a second */
} stic_hid_rates;

#define STIC_HID_RATE_KEYS                                                                                   \
  {"speed", false, "m/s at full deflection, 0 to 100, default 0.25"},                                        \
  {                                                                                                          \
    "turn", false, "rad/s at full deflection, 0 to 100, default 1.5"                                         \
  }

/* STIC_USAGE for what is out of range. Real-time: no. */
stic_status stic_hid_read_rates(const stic_device_spec *spec, stic_hid_rates *rates, stic_error *err);

/* Usages of the top-level collections in a report descriptor, in order: their number, at most `capacity`.
 * Real-time: yes. */
int stic_hid_usages(const uint8_t *descriptor, size_t length, stic_hid_usage *usages, int capacity);

/* A little-endian two's complement number. */
static inline int stic_hid_int16(const uint8_t *at)
{
  const int value = at[0] | at[1] << 8;

  return value < 0x8000 ? value : value - 0x10000;
}

/* The raw frame of the SpaceMouse and of the Hydra (x right, y toward the user, z down) in OpenXR's axes.
 * A rotation of the axes, so it holds for turns as well. */
static inline void stic_hid_to_openxr(const double raw[3], double out[3])
{
  out[0] = raw[0];
  out[1] = -raw[2];
  out[2] = raw[1];
}

#endif

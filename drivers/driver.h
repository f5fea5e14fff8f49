/* What all tracker drivers share: one const table of functions per driver, one sample, one state machine.
 *
 * Conventions, for every driver:
 *   frame        OpenXR: right-handed, x right, y up, -z away; m, rad, rad/s; quaternions x, y, z, w
 *   time         int64_t ns of CLOCK_MONOTONIC
 *   threads      one device is used by one thread at a time
 *   real time    after open() no function allocates; poll() waits no longer than it is told to
 *   bad data     is dropped and counted, never used anyway
 * A driver gives what the device says and nothing else: filters, prediction, integration of rates and
 * the tracker's place in the room are outside. */
#ifndef STIC_DRIVER_H
#define STIC_DRIVER_H

#include "../src/stiction.h"
#include "device_spec.h"

/* ---- samples ----------------------------------------------------------------------------- */

enum {
  STIC_SAMPLE_POSITION = 1,    /* `position` is known, be it from earlier */
  STIC_SAMPLE_ORIENTATION = 2, /* `orientation` is known, be it from earlier */
  STIC_SAMPLE_TRACKED = 4,     /* both come from the device now */
  STIC_SAMPLE_FRINGE = 8,      /* tracked, at the edge of the device's space: less exact */
  STIC_SAMPLE_VELOCITY = 16    /* `velocity` and `turn_rate` are known */
};

typedef struct stic_device_sample {
  int64_t t_ns;          /* CLOCK_MONOTONIC: when the pose was measured, as well as the host can tell
                          * (arrival of the last byte minus the known time on the wire) */
  int64_t source_ns;     /* on the source's own clock, for drivers with own_time; else t_ns */
  uint64_t sequence;     /* counts the device's samples, lost ones too where that is known */
  double position[3];    /* m */
  double orientation[4]; /* unit quaternion x, y, z, w */
  double velocity[3];    /* m/s */
  double turn_rate[3];   /* rad/s, about the axes */
  uint32_t buttons;      /* bit mask, STIC_BUTTON_GRIP is bit 0 */
  unsigned flags;        /* sum of STIC_SAMPLE_ */
} stic_device_sample;

/* ---- states, results, counters ----------------------------------------------------------- */

typedef enum stic_connection {
  STIC_CONNECTION_CLOSED,
  STIC_CONNECTION_OPENING,
  STIC_CONNECTION_RESETTING,
  STIC_CONNECTION_SYNCING, /* looking for the start of a record */
  STIC_CONNECTION_RUNNING,
  STIC_CONNECTION_STALE, /* silent too long: pose held, not tracked, rates zero, grip let go */
  STIC_CONNECTION_LOST   /* closed by the other side; to be opened again */
} stic_connection;

/* "closed", "opening" ... Real-time: yes. */
const char *stic_connection_name(stic_connection state);

/* What poll() and send() return if not a count. */
enum {
  STIC_DRIVER_END = -1,        /* the source has no more, in order */
  STIC_DRIVER_LOST = -2,       /* unplugged or failed; close it and try again later */
  STIC_DRIVER_BAD_DATA = -3,   /* the source's content is wrong for good; see stic_device.error */
  STIC_DRIVER_UNSUPPORTED = -4 /* the device cannot do this */
};

typedef enum stic_driver_kind {
  STIC_DRIVER_POSE, /* gives positions and orientations */
  STIC_DRIVER_RATE  /* gives velocities; one shared integrator makes the pose */
} stic_driver_kind;

/* What it means when a device says nothing. */
typedef enum stic_silence {
  STIC_SILENCE_STALE, /* a streaming tracker that stops has lost the hand */
  STIC_SILENCE_REST /* silent at rest: rates are zero, the grip stays. Tells buttons when they change, and only then */
} stic_silence;

typedef struct stic_device_counters {
  int64_t samples;     /* given out */
  int64_t bad_records; /* garbled: checksum, phase, length, unknown kind */
  int64_t gaps;        /* in the device's sequence */
  int64_t overruns;    /* records lost because nobody read them in time */
  int64_t reconnects;
} stic_device_counters;

/* ---- drivers ----------------------------------------------------------------------------- */

/* A device that the system has found; for match(). */
typedef struct stic_device_id {
  const char *bus;          /* "usb", "bluetooth", "serial" */
  uint16_t vendor, product; /* 0 where there are none */
  uint16_t usage_page, usage;
  const char *path;         /* to open it with, e.g. "/dev/hidraw3" */
  const char *product_name; /* what it calls itself; "" or NULL if it does not */
} stic_device_id;

/* What goes to a device; fields that it lacks are ignored. */
typedef struct stic_device_output {
  bool led;
} stic_device_output;

typedef struct stic_driver stic_driver;

#define STIC_RAW_SHOWN_MAX 64 /* bytes */

/* Start of every driver's own struct. Fields are read-only outside the driver. */
typedef struct stic_device {
  const stic_driver *driver;
  stic_connection state;
  stic_device_counters counters;
  stic_error error;                /* why poll() returned LOST or BAD_DATA */
  size_t raw_length;               /* of `raw`; 0: nothing came yet, or the driver does not tell */
  uint8_t raw[STIC_RAW_SHOWN_MAX]; /* the last bytes that came, cut, for people to look at */
} stic_device;

struct stic_driver {
  const char *name;          /* as in NAME:key=value; unique, lower case */
  const char *about;         /* one line for `devices` and --help */
  const stic_spec_key *keys; /* what the specification may hold; ended by a NULL name */
  stic_driver_kind kind;
  stic_silence silence;
  int64_t silence_ns; /* how long a silence means that; 0: never */
  bool own_time;      /* source_ns, not the time of arrival, is the samples' time */
  bool in_room;       /* poses are the hand's in the scene: no tracker frame or filter applies */

  /* Whether this driver is for the device, as far as ids and names tell: a serial port may be for any serial
   * tracker. No I/O. NULL: no device of the system's, opened by name alone. */
  bool (*match)(const stic_device_id *id);

  /* Opens a device; `spec` has been checked against `keys`. The caller owns `*device` until close().
   * Errors: STIC_NO_DEVICE, STIC_USAGE, STIC_BAD_INPUT, STIC_NO_MEMORY. Real-time: no. */
  stic_status (*open)(const stic_device_spec *spec, stic_device **device, stic_error *err);

  /* Waits for samples until there is one or `until_ns` (CLOCK_MONOTONIC; the past: does not wait), or a
   * signal comes; a device that gives no samples may in its start cost a control transfer's time on top, at most
   * 10 s by the kernel's own limits. Gives out all that is there up to `capacity` (>= 1), oldest first: the number, 0, or one of
   * STIC_DRIVER_. */
  int (*poll)(stic_device *device, int64_t until_ns, stic_device_sample *samples, int capacity);

  /* Sends an output: 0 or one of STIC_DRIVER_. NULL: takes none. */
  int (*send)(stic_device *device, const stic_device_output *output);

  /* Leaves the device as found and frees it. */
  void (*close)(stic_device *device);

  /* One line for people: which device, where, how set. */
  void (*describe)(const stic_device *device, char *out, size_t out_size);
};

/* The one list of drivers; NULL past its end. */
const stic_driver *stic_driver_at(int index);

/* Reads NAME[:key=value,...], finds the driver and opens the device. STIC_USAGE for what cannot be
 * meant, else as open(). */
stic_status stic_device_open(const char *spec_text, stic_device **device, stic_error *err);
/* The same after a loss: raw recordings go on instead of beginning anew. */
stic_status stic_device_reopen(const char *spec_text, stic_device **device, stic_error *err);
int stic_device_poll(stic_device *device, int64_t until_ns, stic_device_sample *samples, int capacity);
int stic_device_send(stic_device *device, const stic_device_output *output);
void stic_device_describe(const stic_device *device, char *out, size_t out_size);
void stic_device_close(stic_device *device); /* NULL allowed */

/* For drivers: keeps the beginning of what came in `device->raw`. Real-time: yes. */
void stic_device_show_raw(stic_device *device, const uint8_t *bytes, size_t length);

#endif

/* A Logitech ultrasonic tracker that is not there: commands in, replies and paced records out, with
 * faults to order. The unit itself knows no I/O and no clock; logitech_pty puts it behind a pseudo terminal. */
#ifndef LOGITECH_EMULATOR_H
#define LOGITECH_EMULATOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define EMULATOR_RECORD 16
#define EMULATOR_PERIOD_NS 20000000
#define EMULATOR_BYTE_NS 520833
#define EMULATOR_QUEUE 256
#define EMULATOR_NEVER INT64_MAX

/* What a record tells, in the unit's own counts. */
typedef struct emulator_record {
  int32_t position[3];  /* 0.001 inch */
  int pitch, yaw, roll; /* 1/40 degree */
  unsigned bits;        /* first byte without its bit 7 */
} emulator_record;

/* Written from the format's description, apart from the decoder under test. */
void emulator_pack(const emulator_record *record, uint8_t bytes[EMULATOR_RECORD]);

typedef struct emulator_faults {
  bool out;   /* every record out of range */
  bool never; /* ... and never seen: all zero */
  bool fringe;
  bool silent;       /* 2D mode: ignores all */
  int64_t drop_at;   /* byte of the stream, from 0, that is lost; EMULATOR_NEVER: none */
  int64_t insert_at; /* ... before which `insert` is put in */
  uint8_t insert;
  int64_t flip_at; /* ... in which `flip` is inverted */
  uint8_t flip;
  int64_t stall_at; /* record before which the stream pauses */
  int64_t stall_ns;
  uint8_t diagnostics[2]; /* default BF 3F */
  int record_size;        /* that *m tells, default 16 */
  bool no_information;    /* does not answer *m */
  int glitch;             /* so many records tell the right button when the left one is pressed */
  bool split;             /* a write per byte */
} emulator_faults;

/* Where the hand is `t_ns` after the start of the stream; `context` is the caller's. */
typedef void emulator_motion(void *context, int64_t t_ns, emulator_record *record);

typedef struct emulator {
  emulator_faults faults;
  emulator_motion *motion;
  void *context;
  /* Read-only outside. */
  bool streaming, wrong_format;
  int64_t resets, refused; /* commands that are not allowed while it streams */
  int64_t records, bytes;  /* sent of the stream */
  bool sound_off;
  /* Inside. */
  bool in_command, seen;
  int64_t deaf_until_ns, stream_start_ns, record_ns;
  int64_t pressed_at; /* record at which the left button was pressed last */
  bool was_pressed;
  uint8_t queue[EMULATOR_QUEUE];
  int64_t due_ns[EMULATOR_QUEUE];
  size_t queued;
} emulator;

/* No faults, a circle of 0.1 m in front of the origin, the left button pressed for every second of two. */
void emulator_init(emulator *e);

void emulator_receive(emulator *e, const uint8_t *bytes, size_t length, int64_t now_ns);
/* Bytes that are due; at most `size`. */
size_t emulator_send(emulator *e, int64_t now_ns, uint8_t *bytes, size_t size);
/* When the next byte is due; EMULATOR_NEVER: not before a command. */
int64_t emulator_next_ns(const emulator *e);

/* ---- behind a pseudo terminal ------------------------------------------------------------ */

typedef struct logitech_pty {
  emulator *unit;
  int master, slave;
  char path[64]; /* of the slave, to be opened by a driver */
} logitech_pty;

/* False and errno on failure. */
bool logitech_pty_open(logitech_pty *pty, emulator *unit);
/* Serves the driver for up to `limit_ns`; false if the pseudo terminal failed. */
bool logitech_pty_serve(logitech_pty *pty, int64_t limit_ns);
/* Unplugs. */
void logitech_pty_close(logitech_pty *pty);

#endif

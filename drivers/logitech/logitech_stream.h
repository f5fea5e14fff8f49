/* Samples from the Logitech tracker's stream of records: debounced buttons, garbled records left out. Live
 * bytes and recorded ones take this same way. Pure: no I/O, no clock; all functions are real-time. */
#ifndef STIC_LOGITECH_STREAM_H
#define STIC_LOGITECH_STREAM_H

#include "../driver.h"
#include "logitech_decode.h"

#define STIC_LOGITECH_PERIOD_NS 20000000 /* between two records, at most 50 a second */
#define STIC_LOGITECH_SILENCE_NS (3 * (int64_t)STIC_LOGITECH_PERIOD_NS)
#define STIC_LOGITECH_BYTE_NS 520833 /* on the wire: 10 bits at 19200 baud */
#define STIC_LOGITECH_WIRE_NS (STIC_LOGITECH_RECORD * (int64_t)STIC_LOGITECH_BYTE_NS)

/* Worn mice tell a wrong button at the moment of pressing; so many equal records count. */
#define STIC_LOGITECH_DEBOUNCE 3

/* Buttons of a sample. */
enum {
  STIC_LOGITECH_BUTTON_LEFT = STIC_BUTTON_GRIP,
  STIC_LOGITECH_BUTTON_MIDDLE = 2,
  STIC_LOGITECH_BUTTON_RIGHT = 4,
  STIC_LOGITECH_BUTTON_SUSPEND = 8,
  STIC_LOGITECH_BUTTON_STAND = 16
};

/* All zero is a stream that has seen nothing. Counters are read-only outside. */
typedef struct stic_logitech_stream {
  stic_logitech_decoder decoder;
  int64_t jumps;     /* poses dropped because the next ones deny them */
  uint64_t sequence; /* of records, dropped ones too */
  int64_t last_ns;   /* of the last sample given out */
  bool acquired;     /* `pose` is one that was given out as tracked */
  bool following;    /* ... and tracked ever since: the next must fit its motion */
  stic_device_sample pose;
  double velocity[3], turn_rate[3]; /* of `pose`, m/s, rad/s */
  bool doubted;                     /* `doubt` waits for the next record to confirm it */
  stic_device_sample doubt;
  bool pending; /* `next` is to be given out before any further byte */
  stic_device_sample next;
  uint32_t buttons, candidate; /* given out; and those that may become so */
  int candidate_count;
} stic_logitech_stream;

/* Takes bytes up to the next sample: true and the sample, or false when all are taken; `*used` is the number
 * taken, which may be 0. `arrival_ns` is when the last of `length` bytes came. Times increase strictly.
 *
 * The wire has no checksum, so a pose off the path that a hand can take (and the first one) waits for the
 * next record: if that is near it both are given out, else the first was garbled and is dropped. */
bool stic_logitech_stream_next(stic_logitech_stream *stream, const uint8_t *bytes, size_t length,
                               int64_t arrival_ns, size_t *used, stic_device_sample *sample);

/* Forgets pressed buttons and half a record, as after a restart of the stream. */
void stic_logitech_stream_restart(stic_logitech_stream *stream);

/* Records dropped for whatever reason. */
int64_t stic_logitech_stream_bad(const stic_logitech_stream *stream);

#endif

/* The conversation with a Logitech tracker: its start, its stream, its end. No I/O and no clock of its
 * own: bytes and times are handed in, what is to be sent goes through a port. All functions are real-time. */
#ifndef STIC_LOGITECH_PROTOCOL_H
#define STIC_LOGITECH_PROTOCOL_H

#include "logitech_stream.h"

/* Where commands go. */
typedef struct stic_logitech_port {
  void *context;
  bool (*write)(void *context, const uint8_t *bytes, size_t length); /* false: the port is gone */
  /* Sets DTR, or RTS; false where there are no modem lines. */
  bool (*set_line)(void *context, bool rts, bool on);
} stic_logitech_port;

/* Steps of the start, in order; each ends when its time is over or its answer is there. */
typedef enum stic_logitech_step {
  STIC_LOGITECH_STEP_SELECT,   /* DTR low: 3D mode at the next reset */
  STIC_LOGITECH_STEP_HOLD,     /* RTS low: reset */
  STIC_LOGITECH_STEP_LET_GO,   /* RTS high */
  STIC_LOGITECH_STEP_RESET,    /* *R */
  STIC_LOGITECH_STEP_DEMAND,   /* *D */
  STIC_LOGITECH_STEP_DIAGNOSE, /* *ENQ */
  STIC_LOGITECH_STEP_FORMAT,   /* *G */
  STIC_LOGITECH_STEP_INFORM,   /* *m */
  STIC_LOGITECH_STEP_STREAM    /* *S, until the end */
} stic_logitech_step;

#define STIC_LOGITECH_INFORMATION 30 /* bytes of the *m reply */

typedef struct stic_logitech_protocol {
  stic_logitech_port port;
  bool head; /* head-tracker mode is wanted */
  stic_connection state;
  stic_error error; /* why stic_logitech_advance() failed */
  char notice[160]; /* what is wrong but no hindrance; "" nothing */
  int firmware;     /* index that the unit tells; -1: not known */
  stic_logitech_stream stream;
  /* Below: inside. */
  stic_logitech_step step;
  int64_t step_end_ns;
  int attempt;      /* of the whole start, from 0 */
  int asked;        /* how often this step's question was put */
  int refused_size; /* record size of the last *m reply that was not ours */
  uint8_t reply[STIC_LOGITECH_INFORMATION];
  int reply_count;
} stic_logitech_protocol;

/* Begins with the first step. */
void stic_logitech_begin(stic_logitech_protocol *protocol, const stic_logitech_port *port, bool head,
                         int64_t now_ns);

/* Takes received bytes up to the next sample, as stic_logitech_stream_next(). */
bool stic_logitech_receive(stic_logitech_protocol *protocol, const uint8_t *bytes, size_t length,
                           int64_t arrival_ns, size_t *used, stic_device_sample *sample);

/* Goes on if a step is over; call it when all that has arrived is taken. 0; STIC_DRIVER_LOST: the unit does
 * not answer, or the port is gone; STIC_DRIVER_BAD_DATA: it answers that it cannot do what we need. */
int stic_logitech_advance(stic_logitech_protocol *protocol, int64_t now_ns);

/* When to call stic_logitech_advance() at the latest. */
int64_t stic_logitech_deadline(const stic_logitech_protocol *protocol);

/* Stops the stream and the transmitter's sound. */
void stic_logitech_end(stic_logitech_protocol *protocol);

#endif

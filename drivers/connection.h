/* Keeps a device going: notices silence, lets go of the grip, closes what is lost and opens it again. The
 * same for all drivers; a driver only says LOST and declares what its silence means.
 *
 *   OPENING -> RESETTING -> SYNCING -> RUNNING <-> STALE -> LOST -> OPENING ...
 *
 *   STALE   no sample for the driver's silence_ns (STIC_SILENCE_STALE): one sample with the last pose, not
 *           tracked, no rates, no buttons
 *   LOST    the driver says so, or STALE for 2 s: closed, and opened again after 0.5 s, then after twice
 *           as long each time up to 5 s, until it works
 *   rest    silence of a STIC_SILENCE_REST device: one sample with rates zero, buttons and tracking as before
 *
 * After STALE and LOST the grip counts again only once it was seen released; of a STIC_SILENCE_REST device at once. */
#ifndef STIC_CONNECTION_H
#define STIC_CONNECTION_H

#include "driver.h"

#define STIC_LOST_AFTER_NS INT64_C(2000000000) /* of silence */
#define STIC_BACKOFF_MIN_NS INT64_C(500000000)
#define STIC_BACKOFF_MAX_NS INT64_C(5000000000)

/* ---- silence and back-off: no I/O, no clock ----------------------------------------------- */

typedef enum stic_watch_event {
  STIC_WATCH_NONE,
  STIC_WATCH_REST,  /* rates are zero now */
  STIC_WATCH_STALE, /* let go */
  STIC_WATCH_LOST   /* close it */
} stic_watch_event;

typedef struct stic_watch {
  stic_silence silence;
  int64_t silence_ns; /* 0: may be silent for ever */
  bool heard;         /* since it was opened */
  int64_t heard_ns;   /* when last */
  bool told;          /* this silence's first event has been given out */
  int64_t backoff_ns; /* the next wait */
  int64_t retry_ns;   /* when to open again */
} stic_watch;

/* Real-time: yes, all of them. */
void stic_watch_begin(stic_watch *watch, stic_silence silence, int64_t silence_ns);
void stic_watch_heard(stic_watch *watch, int64_t now_ns); /* a sample came: also ends the back-off */
/* What the silence up to now means, each event once. */
stic_watch_event stic_watch_look(stic_watch *watch, int64_t now_ns);
int64_t stic_watch_deadline(const stic_watch *watch);    /* when to look; INT64_MAX: never */
void stic_watch_lost(stic_watch *watch, int64_t now_ns); /* sets retry_ns and doubles the wait */

/* Whether, after a loss, a pressed grip is that of before and must be seen released first. A device that is silent at rest
 * tells its buttons when they change only: what it tells after it was opened again is pressed now, and of a release that
 * happened meanwhile it will never tell. */
bool stic_watch_bars_grip(const stic_watch *watch);

/* ---- the supervisor ---------------------------------------------------------------------- */

/* Told about each change of state once; retries that fail are no change. `text` is the device's description
 * (RUNNING), the reason (LOST), else "". Called from stic_supervisor_poll(). */
typedef void stic_connection_report(void *context, stic_connection state, const char *text);

typedef struct stic_supervisor_options {
  stic_connection_report *report; /* may be NULL */
  void *context;
  int64_t give_up_ns; /* lost for so long is lost for good; 0: never */
} stic_supervisor_options;

typedef struct stic_supervisor stic_supervisor;

/* Opens a device as stic_device_open(); what is absent at the start is refused. `options` may be NULL. The
 * caller owns `*supervisor`. Real-time: no. */
stic_status stic_supervisor_open(const char *spec_text, const stic_supervisor_options *options,
                                 stic_supervisor **supervisor, stic_error *err);

/* Supervises a device that is open already and is a recording: time is what `now` says (called with `context`), and
 * silence is judged as it would have been, but nothing is ever closed and opened again. The supervisor owns the device
 * from then on, also on failure (STIC_NO_MEMORY). Real-time: no. */
stic_status stic_supervisor_adopt(stic_device *device, int64_t (*now)(void *context), void *context,
                                  stic_supervisor **supervisor, stic_error *err);

/* As stic_device_poll(), times increasing strictly, also across a reconnection. STIC_DRIVER_LOST only when
 * lost for good, with stic_supervisor_error(). Real-time: yes, but for opening a device again, which
 * allocates and happens only while there is none. */
int stic_supervisor_poll(stic_supervisor *supervisor, int64_t until_ns, stic_device_sample *samples,
                         int capacity);

int stic_supervisor_send(stic_supervisor *supervisor, const stic_device_output *output);

/* Real-time: yes. */
stic_connection stic_supervisor_state(const stic_supervisor *supervisor);
const stic_driver *stic_supervisor_driver(const stic_supervisor *supervisor);
/* The device, to be fed (mouse) or looked at; NULL while there is none, another one after a reconnection. */
stic_device *stic_supervisor_device(const stic_supervisor *supervisor);
/* Over all connections so far. */
stic_device_counters stic_supervisor_counters(const stic_supervisor *supervisor);
/* Why it was lost last, or why a poll failed. */
const stic_error *stic_supervisor_error(const stic_supervisor *supervisor);
/* The device's description, of the last one while there is none. */
void stic_supervisor_describe(const stic_supervisor *supervisor, char *out, size_t out_size);

void stic_supervisor_close(stic_supervisor *supervisor); /* NULL allowed */

#endif

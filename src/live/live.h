/* The real-time loop: a device's samples through the solver, each in its turn, on threads that cannot hold each
 * other up.
 *
 *   reader    waits for the device, brings its samples into the room          -> queue of samples
 *   solver    "the loop": each sample in order, and the last pose again where none came within 1/31 s
 *             (devices with the host's time only)                             -> queue of rows, cell, queue of pictures
 *   writer    recording, log, events: the caller's function, row by row
 *   pictures  draws what it can in time: the caller's functions, if asked for
 *   caller    waits, tells news, shows the cell's newest value in a window
 *
 * No queue waits: what a full one means stands below. Between the threads there are no locks (ring.h). Reader and
 * solver ask for SCHED_FIFO and locked memory and go on without. All threads but the caller's leave signals to it. */
#ifndef STIC_LIVE_H
#define STIC_LIVE_H

#include "../../drivers/connection.h"
#include "../../drivers/motion/tracker_yaml.h"
#include "../io/timing.h"
#include "../stiction.h"
#include "ring.h"

/* ---- what goes in -------------------------------------------------------------------------- */

/* What the solver was given and what it said. Lives until the function that is given it returns. Of the contacts
 * only those that a log lists are there; contact_count is the true number. */
typedef struct stic_live_row {
  stic_sample sample;
  stic_result result;
  int64_t solved_ns;        /* CLOCK_MONOTONIC, when the solver had it */
  const stic_event *events; /* of this row; none if they were not asked for */
  int event_count;
} stic_live_row;

/* Called in the writer thread only; may block as long as it likes. */
typedef struct stic_live_output {
  void *user;
  /* Writes a row: STIC_OK, or the run ends with that error and no further row is written. */
  stic_status (*row)(void *user, const stic_live_row *row, stic_error *err);
  /* Now and then, and when nothing waits any more: what is buffered may go out. As row(). */
  stic_status (*flush)(void *user, stic_error *err);
} stic_live_output;

/* Called in the pictures' thread only, which so owns the renderer that open() makes. Failures end the pictures,
 * not the run. */
typedef struct stic_live_pictures {
  void *user;
  stic_status (*open)(void *user, stic_error *err); /* before the loop starts */
  /* The next result. `late`: pictures lag behind; what is due is to be shown without drawing. */
  stic_status (*result)(void *user, const stic_result *result, bool late, stic_error *err);
  stic_status (*finish)(void *user, stic_error *err); /* after the last result, not after a failure */
  void (*close)(void *user);                          /* always, also after a failed open() */
} stic_live_pictures;

typedef struct stic_live_settings {
  stic_supervisor *device;     /* the reader's from start to finish */
  const stic_tracker *tracker; /* from the device's frame to the room's; not for devices that are in_room */
  stic_sim *sim;               /* the solver's from start to finish */
  bool events;                 /* rows carry their events, default false */
  stic_live_output output;
  const stic_live_pictures *pictures; /* NULL (default): none */
  size_t queue_samples;               /* that may wait for the solver; 0 (default): 131072 */
  size_t queue_rows;                  /* that may wait for the writer; 0 (default): 65536 */
} stic_live_settings;

/* ---- what can be seen while it runs -------------------------------------------------------- */

/* The newest frame, for a view. */
typedef struct stic_live_view_item {
  stic_result result;
  stic_connection state;
  stic_device_counters counters;
} stic_live_view_item;

/* ---- the loop ------------------------------------------------------------------------------ */

/* Why it ended. */
typedef enum stic_live_end {
  STIC_LIVE_STOPPED,      /* stic_live_stop() */
  STIC_LIVE_DEVICE_ENDED, /* stic_supervisor_poll() gave a negative number: `device_result` */
  STIC_LIVE_OUTPUT_FAILED /* output.row() failed, or its queue was full */
} stic_live_end;

typedef struct stic_live_report {
  stic_live_end end;
  int device_result;        /* STIC_DRIVER_ */
  bool device_stalls;       /* it has not come back from a read: the loop has ended without its reader */
  stic_error output_error;  /* status STIC_OK: none */
  stic_error picture_error; /* the same */
  int64_t rows;             /* solved; all of them written unless output_error */
  int64_t repeated;         /* of them with the last pose again */
  double seconds;           /* from the first sample to the last row */
  int64_t lost_samples;   /* given by the device when the solver's queue was full, or not solved at the end */
  int64_t unseen_results; /* not given to the pictures, whose queue was full */
  size_t samples_most, rows_most, pictures_most; /* that waited in the queues */
  char scheduling[300];                          /* what the threads got and why not more */
} stic_live_report;

typedef struct stic_live stic_live;

/* Allocates all that the loop will use, opens the pictures and starts the threads. `*live` is NULL on failure and
 * nothing runs then. The caller owns it. Errors: STIC_NO_MEMORY (also no thread, no pipe), those of
 * pictures->open(). Real-time: no. */
stic_status stic_live_start(const stic_live_settings *settings, stic_live **live, stic_error *err);

/* Whether the loop goes on; false once it has ended by itself or was told to stop. Any thread. Real-time: yes. */
bool stic_live_runs(const stic_live *live);

/* Waits until the loop ends, at most `ns`, or until a signal that the calling thread takes. */
void stic_live_wait(stic_live *live, int64_t ns);

/* The cell of stic_live_view_item; the caller's thread may read it (stic_latest_read()), no other. NULL in it
 * before the first frame. Valid until stic_live_finish(). */
stic_latest *stic_live_view(stic_live *live);

/* Asks the loop to end. What was read is solved within 0.1 s, what is solved is written. Any thread, at any time,
 * as often as wanted. Real-time: yes. */
void stic_live_stop(stic_live *live);

/* Stops, waits for all threads and until all is written, tells how it went, adds the times to `timing` (may be
 * NULL) and frees. A device that blocks (a pipe whose writer stalls) is waited for 2 s; then the reader's thread, the
 * device and what its callbacks use must be left as they are until the process ends (device_stalls). NULL `live`
 * allowed. Real-time: no. */
void stic_live_finish(stic_live *live, stic_timing *timing, stic_live_report *report);

#endif

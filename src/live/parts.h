/* What the threads of the loop share. Each field is one thread's or says who else reads it. Internal. */
#ifndef STIC_LIVE_PARTS_H
#define STIC_LIVE_PARTS_H

#include <pthread.h>
#include <semaphore.h>

#include "../io/log_csv.h"
#include "live.h"
#include "wake.h"

/* Minutes at 250 Hz: 8.7 of samples, 4.4 of rows. */
#define STIC_LIVE_SAMPLES 131072
#define STIC_LIVE_ROWS 65536
#define STIC_LIVE_EVENTS (8 * STIC_EVENTS_MAX)
#define STIC_LIVE_PICTURES 1024
#define STIC_LIVE_AHEAD 4096         /* samples that a source without haste may be ahead of the solver */
#define STIC_LIVE_DRAIN_NS 100000000 /* after a stop the solver goes on for so long with what was read */
#define STIC_LIVE_STALL_NS                                                                                   \
  2000000000 /* a device that does not come back within this after a stop is left behind */
#define STIC_LIVE_LOOK_NS 10000000      /* how often a thread looks into a queue that nobody wakes it for */
#define STIC_LIVE_PICTURE_LAG 250000000 /* ns that a picture may be late and still be drawn */

/* Reader to solver. */
typedef struct live_sample {
  stic_sample sample;
  int64_t zero_ns;    /* CLOCK_MONOTONIC at the sample's t = 0; for devices with the host's time */
  int64_t arrived_ns; /* CLOCK_MONOTONIC */
  int64_t read_ns;    /* what getting it took */
} live_sample;

typedef struct live_status {
  stic_connection state;
  stic_device_counters counters;
} live_status;

/* Solver to writer: the part of a result that is written. Copied as bytes. */
#define STIC_LIVE_RESULT_SIZE (offsetof(stic_result, contacts) + STIC_LOG_CONTACTS * sizeof(stic_contact))
typedef struct live_row {
  stic_sample sample;
  int64_t solved_ns;
  int event_count;
  unsigned char result[STIC_LIVE_RESULT_SIZE];
} live_row;

/* Solver to pictures. */
typedef struct live_picture {
  int64_t made_ns;
  stic_result result;
} live_picture;

typedef struct live_reader {
  stic_supervisor *device;
  stic_tracker tracker;
  bool own_time;
  bool begun;
  int64_t start_ns; /* CLOCK_MONOTONIC of the first sample */
  int64_t lost;
  int result; /* STIC_DRIVER_ that ended it, 0: told to stop */
  stic_timing timing;
} live_reader;

typedef struct live_solver {
  stic_sim *sim;
  bool own_time;
  bool begun;
  live_sample last;                /* solved last */
  int64_t deadline_ns;             /* of the next frame */
  int64_t go_ns, first_ns, end_ns; /* the loop starts, the first sample is there, the last row is */
  int64_t rows, repeated, unseen;
  bool overflow; /* the queue of rows was full */
  stic_timing timing;
} live_solver;

typedef struct live_writer {
  stic_live_output output;
  stic_event *gathered; /* events of one row */
  stic_live_row row;
  stic_error error;
  stic_timing timing;
} live_writer;

typedef struct live_pictures {
  stic_live_pictures calls;
  sem_t opened;
  stic_status open_status; /* set before `opened` is posted */
  stic_error error;
} live_pictures;

struct stic_live {
  int64_t started_ns;
  stic_ring *samples, *rows, *events, *pictures; /* events, pictures: NULL if not asked for */
  stic_latest *view, *status;
  stic_wake to_solver, to_caller;
  int stopping, reader_done, solver_done; /* atomic */
  live_reader reader;
  live_solver solver;
  live_writer writer;
  live_pictures picture_maker;
  sem_t go; /* posted for the solver when all is prepared */
  int thread_count;
  pthread_t threads[4];
  char scheduling[300];
};

/* The threads; the argument is the stic_live. */
void *stic_live_reader_main(void *live);
void *stic_live_solver_main(void *live);
void *stic_live_writer_main(void *live);
void *stic_live_pictures_main(void *live);

/* Before the loop starts; signals are waited out. */
static inline void live_await(sem_t *semaphore)
{
  while (sem_wait(semaphore) != 0)
    ;
}

static inline bool live_flag(const int *flag)
{
  return __atomic_load_n(flag, __ATOMIC_ACQUIRE) != 0;
}

static inline void live_raise(int *flag)
{
  __atomic_store_n(flag, 1, __ATOMIC_RELEASE);
}

#endif

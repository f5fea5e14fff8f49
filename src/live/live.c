#include "live.h"

#include <assert.h>
#include <errno.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "../error.h"
#include "parts.h"

#define STACK_BYTES (1 << 20) /* of reader and solver: locked, so not the usual 8 MB */
#define PRIORITY_ABOVE_MIN 10

/* ---- making and freeing -------------------------------------------------------------------- */

static void destroy(stic_live *live)
{
  stic_wake_destroy(&live->to_solver);
  stic_wake_destroy(&live->to_caller);
  stic_ring_destroy(live->samples);
  stic_ring_destroy(live->rows);
  stic_ring_destroy(live->events);
  stic_ring_destroy(live->pictures);
  stic_latest_destroy(live->view);
  stic_latest_destroy(live->status);
  free(live->writer.gathered);
  sem_destroy(&live->picture_maker.opened);
  sem_destroy(&live->go);
  free(live);
}

/* What the reader needs. */
static stic_status make_inputs(stic_live *live, const stic_live_settings *s, stic_error *err)
{
  const size_t samples = s->queue_samples > 0 ? s->queue_samples : STIC_LIVE_SAMPLES;
  stic_status status = stic_wake_create(&live->to_solver, err);

  if (status == STIC_OK)
    status = stic_wake_create(&live->to_caller, err);
  if (status == STIC_OK)
    status = stic_ring_create(sizeof(live_sample), samples, &live->samples, err);
  if (status == STIC_OK)
    status = stic_latest_create(sizeof(live_status), &live->status, err);
  return status;
}

static stic_status make_outputs(stic_live *live, const stic_live_settings *s, stic_error *err)
{
  const size_t rows = s->queue_rows > 0 ? s->queue_rows : STIC_LIVE_ROWS;
  stic_status status = stic_ring_create(sizeof(live_row), rows, &live->rows, err);

  if (status == STIC_OK && s->events)
    status = stic_ring_create(sizeof(stic_event), STIC_LIVE_EVENTS, &live->events, err);
  if (status == STIC_OK && s->pictures)
    status = stic_ring_create(sizeof(live_picture), STIC_LIVE_PICTURES, &live->pictures, err);
  if (status == STIC_OK)
    status = stic_latest_create(sizeof(stic_live_view_item), &live->view, err);
  return status;
}

/* What only holds zeros would get its pages at the first use, in the loop. */
static void touch(void *memory, size_t size)
{
  volatile char *at = memory;

  for (size_t i = 0; i < size; i += 4096)
    at[i] = 0;
}

static stic_live *make(const stic_live_settings *s)
{
  stic_live *live = calloc(1, sizeof *live);

  if (!live)
    return NULL;
  touch(live, sizeof *live);
  live->to_solver.ends[0] = live->to_solver.ends[1] = -1;
  live->to_caller.ends[0] = live->to_caller.ends[1] = -1;
  live->started_ns = stic_clock_ns();
  live->reader.device = s->device;
  live->reader.own_time = stic_supervisor_driver(s->device)->own_time;
  if (s->tracker)
    live->reader.tracker = *s->tracker;
  live->solver.sim = s->sim;
  live->solver.own_time = live->reader.own_time;
  live->writer.output = s->output;
  if (s->pictures)
    live->picture_maker.calls = *s->pictures;
  sem_init(&live->picture_maker.opened, 0, 0);
  sem_init(&live->go, 0, 0);
  if (s->events && !(live->writer.gathered = malloc(STIC_EVENTS_MAX * sizeof(stic_event)))) {
    destroy(live);
    return NULL;
  }
  return live;
}

/* ---- threads ------------------------------------------------------------------------------- */

static int start_thread(stic_live *live, void *(*run)(void *), size_t stack)
{
  pthread_attr_t attributes;
  int problem = pthread_attr_init(&attributes);

  if (problem != 0)
    return problem;
  if (stack > 0)
    pthread_attr_setstacksize(&attributes, stack);
  problem = pthread_create(&live->threads[live->thread_count], &attributes, run, live);
  live->thread_count += problem == 0;
  pthread_attr_destroy(&attributes);
  return problem;
}

static stic_status no_thread(int problem, stic_error *err)
{
  return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "cannot start a thread: %s", strerror(problem));
}

static stic_status start_pictures(stic_live *live, stic_error *err)
{
  live_pictures *p = &live->picture_maker;
  const int problem = start_thread(live, stic_live_pictures_main, 0);

  if (problem != 0)
    return no_thread(problem, err);
  live_await(&p->opened);
  if (p->open_status != STIC_OK && err)
    *err = p->error;
  return p->open_status;
}

/* The reader first: a device that has been opened must not wait for the rest, which takes a while. The solver last,
 * so that whatever is refused is so before the first sample is solved. */
static stic_status start_threads(stic_live *live, const stic_live_settings *s, stic_error *err)
{
  stic_status status = make_inputs(live, s, err);
  int problem = 0;

  if (status == STIC_OK)
    problem = start_thread(live, stic_live_reader_main, STACK_BYTES);
  if (status == STIC_OK && problem == 0)
    status = make_outputs(live, s, err);
  if (status == STIC_OK && problem == 0 && live->pictures)
    status = start_pictures(live, err);
  if (status == STIC_OK && problem == 0)
    problem = start_thread(live, stic_live_writer_main, 0);
  if (status == STIC_OK && problem == 0)
    problem = start_thread(live, stic_live_solver_main, STACK_BYTES);
  return problem == 0 ? status : no_thread(problem, err);
}

/* Of threads[0], the reader; it may be held up in a read of its device. */
static bool reader_ends(const stic_live *live)
{
  const int64_t until_ns = stic_clock_ns() + STIC_LIVE_STALL_NS;

  while (!live_flag(&live->reader_done) && stic_clock_ns() < until_ns)
    stic_clock_sleep_until(stic_clock_ns() + 1000000);
  return live_flag(&live->reader_done);
}

static void join(stic_live *live, int first)
{
  for (int i = first; i < live->thread_count; i++)
    pthread_join(live->threads[i], NULL);
  live->thread_count = 0;
}

static int ask_for_fifo(pthread_t thread, int above)
{
  const struct sched_param priority = {.sched_priority = sched_get_priority_min(SCHED_FIFO) + above};

  return pthread_setschedparam(thread, SCHED_FIFO, &priority);
}

/* Only what there is now is locked: with MCL_FUTURE allocations of a view or of pictures could fail. Queues and
 * stacks of the loop are there already. */
static void ask_for_real_time(stic_live *live)
{
  const pthread_t *const reader = &live->threads[0], *const solver = &live->threads[live->thread_count - 1];
  char policy[120], memory[120];
  int problem = ask_for_fifo(*reader, PRIORITY_ABOVE_MIN + 1);

  /* ESRCH: a short trace has been read already. */
  if (problem == 0 || problem == ESRCH)
    problem = ask_for_fifo(*solver, PRIORITY_ABOVE_MIN);
  if (problem == 0)
    snprintf(policy, sizeof policy, "SCHED_FIFO");
  else
    snprintf(policy, sizeof policy, "SCHED_OTHER (SCHED_FIFO refused: %s)", strerror(problem));
  if (mlockall(MCL_CURRENT) == 0)
    snprintf(memory, sizeof memory, "memory locked");
  else
    snprintf(memory, sizeof memory, "memory not locked (refused: %s)", strerror(errno));
  snprintf(live->scheduling, sizeof live->scheduling, "%s, %s", policy, memory);
}

static void give_up(stic_live *live)
{
  live_raise(&live->solver_done);
  stic_live_stop(live);
  sem_post(&live->go);
  join(live, 0);
  destroy(live);
}

stic_status stic_live_start(const stic_live_settings *settings, stic_live **out, stic_error *err)
{
  stic_live *live = make(settings);
  sigset_t all, before;
  stic_status status;

  *out = NULL;
  if (!live)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  /* Threads inherit the mask: signals are the caller's. */
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  status = start_threads(live, settings, err);
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  if (status != STIC_OK) {
    give_up(live);
    return status;
  }
  ask_for_real_time(live);
  sem_post(&live->go);
  *out = live;
  return STIC_OK;
}

/* ---- while it runs ------------------------------------------------------------------------- */

bool stic_live_runs(const stic_live *live)
{
  return !live_flag(&live->stopping) && !live_flag(&live->solver_done);
}

void stic_live_wait(stic_live *live, int64_t ns)
{
  stic_wake_wait(&live->to_caller, stic_clock_ns() + ns);
}

stic_latest *stic_live_view(stic_live *live)
{
  return live->view;
}

void stic_live_stop(stic_live *live)
{
  live_raise(&live->stopping);
  stic_wake_send(&live->to_solver);
  stic_wake_send(&live->to_caller);
}

/* ---- the end ------------------------------------------------------------------------------- */

static void tell_overflow(const stic_live *live, stic_error *err)
{
  stic_error_set(
    err, STIC_CANNOT_WRITE, NULL, 0,
    "the output is too slow: %zu rows wait for it and the queue is full; the run ends after them",
    stic_ring_most(live->rows));
}

static void make_report(const stic_live *live, bool stalls, stic_live_report *report)
{
  memset(report, 0, sizeof *report);
  report->device_stalls = stalls;
  report->device_result = stalls ? 0 : live->reader.result;
  report->end = report->device_result < 0 ? STIC_LIVE_DEVICE_ENDED : STIC_LIVE_STOPPED;
  report->output_error = live->writer.error;
  if (live->solver.overflow && report->output_error.status == STIC_OK)
    tell_overflow(live, &report->output_error);
  if (report->output_error.status != STIC_OK)
    report->end = STIC_LIVE_OUTPUT_FAILED;
  report->picture_error = live->picture_maker.error;
  report->rows = live->solver.rows;
  report->seconds = (double)(live->solver.end_ns - live->solver.first_ns) / 1e9;
  report->repeated = live->solver.repeated;
  report->lost_samples = (stalls ? 0 : live->reader.lost) + (int64_t)stic_ring_count(live->samples);
  report->unseen_results = live->solver.unseen;
  report->samples_most = stic_ring_most(live->samples);
  report->rows_most = stic_ring_most(live->rows);
  report->pictures_most = live->pictures ? stic_ring_most(live->pictures) : 0;
  memcpy(report->scheduling, live->scheduling, sizeof report->scheduling);
}

void stic_live_finish(stic_live *live, stic_timing *timing, stic_live_report *report)
{
  bool stalls;

  if (!live)
    return;
  if (stic_live_runs(live))
    stic_live_stop(live);
  stalls = !reader_ends(live);
  join(live, stalls ? 1 : 0); /* what is left behind keeps `live` */
  make_report(live, stalls, report);
  if (timing) {
    if (!stalls)
      stic_timing_merge(timing, &live->reader.timing);
    stic_timing_merge(timing, &live->solver.timing);
    stic_timing_merge(timing, &live->writer.timing);
  }
  if (!stalls)
    destroy(live);
}

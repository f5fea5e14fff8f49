/* stiction run: a device's samples through the solver in real time. */
#include "../../drivers/connection.h"
#include "../../drivers/motion/tracker_yaml.h"
#include "../error.h"
#include "../io/trace_csv.h"
#include "cli.h"
#include "session.h"

#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BATCH 64 /* samples taken at once */

static const stic_cli_usage usage = {
  "run", "[OPTION...] SCENE --device NAME[:key=value,...]",
  "Solves a device's samples as they come, at least 31 a second if the device gives them, and says at\n"
  "the end how it kept up. SIGINT or SIGTERM ends it with 0 and everything written. A recording is\n"
  "readable to its last whole line whatever happens; replay of it gives the same log rows.\n",
  1, 1};

typedef struct run {
  stic_session session;
  stic_supervisor *device;
  stic_tracker tracker;         /* from the device's frame to the room's */
  stic_trace_writer *recording; /* NULL: none asked for */
  int64_t start_ns;             /* t_ns of the first sample */
  bool begun;
} run;

static bool has_own_time(const run *r)
{
  return stic_supervisor_driver(r->device)->own_time;
}

/* What the solver is given: time since the first sample, or the source's own. */
static stic_sample solver_sample(run *r, const stic_device_sample *from)
{
  stic_sample to;

  if (!r->begun)
    r->start_ns = from->t_ns;
  r->begun = true;
  memset(&to, 0, sizeof to);
  to.t_ns = has_own_time(r) ? from->source_ns : from->t_ns - r->start_ns;
  memcpy(to.position, from->position, sizeof to.position);
  memcpy(to.orientation, from->orientation, sizeof to.orientation);
  to.buttons = from->buttons & ~STIC_TRACE_BUTTON_LOST;
  to.lost = !(from->flags & STIC_SAMPLE_TRACKED);
  return to;
}

static stic_status solve(run *r, stic_device_sample *samples, int count, int64_t read_ns, stic_error *err)
{
  const unsigned known = STIC_SAMPLE_POSITION | STIC_SAMPLE_ORIENTATION;

  for (int i = 0; i < count; i++) {
    stic_sample sample;

    /* A trace is a hand in the room already. */
    if (!has_own_time(r))
      stic_tracker_apply(&r->tracker, &samples[i]);
    if ((samples[i].flags & known) != known)
      continue; /* nobody knows yet where the hand is */
    sample = solver_sample(r, &samples[i]);
    /* Recorded first: what the solver was given is on disk whatever it does with it. */
    if (r->recording) {
      const stic_status status = stic_trace_write(r->recording, &sample, err);

      if (status != STIC_OK)
        return status;
    }
    stic_session_step(&r->session, &sample, i == 0 ? read_ns : 0);
  }
  return STIC_OK;
}

/* Each change of the connection, once. */
static void tell_connection(void *context, stic_connection state, const char *text)
{
  (void)context;
  if (state == STIC_CONNECTION_STALE || state == STIC_CONNECTION_LOST)
    stic_cli_say("the tracker is %s%s%s", stic_connection_name(state), text[0] ? ": " : "", text);
  else if (state == STIC_CONNECTION_RUNNING)
    stic_cli_say("tracking: %s", text);
}

static int device_failure(const run *r, int result)
{
  stic_error err = *stic_supervisor_error(r->device);

  switch (result) {
  case STIC_DRIVER_END: return STIC_OK;
  case STIC_DRIVER_BAD_DATA: return stic_cli_fail(&err);
  default:
    stic_cli_say("the device is lost%s%s", err.message[0] ? ": " : "", err.message);
    return STIC_NO_DEVICE;
  }
}

/* Until the device ends, a signal comes or nothing can be written any more. Returns the exit code. */
static int loop(run *r, stic_error *err)
{
  stic_device_sample samples[BATCH];

  while (stic_cli_signal() == 0 && !stic_session_write_failed(&r->session)) {
    const int64_t asleep_ns = stic_clock_ns();
    const int count = stic_supervisor_poll(r->device, asleep_ns + STIC_FRAME_NS, samples, BATCH);
    const int64_t awake_ns = stic_clock_ns();

    if (count < 0)
      return device_failure(r, count);
    /* Late is what the scheduler adds; a sample that waited for us is another matter. */
    if (count > 0 && has_own_time(r) && samples[0].t_ns > asleep_ns)
      stic_timing_add(r->session.timing, STIC_STAGE_WAKEUP, awake_ns - samples[0].t_ns);
    if (solve(r, samples, count, 0, err) != STIC_OK)
      return stic_cli_fail(err);
  }
  return STIC_OK;
}

static const char *scheduling_text(void)
{
  switch (sched_getscheduler(0)) {
  case SCHED_FIFO: return "SCHED_FIFO";
  case SCHED_RR: return "SCHED_RR";
  default: return "SCHED_OTHER";
  }
}

static void report(const run *r)
{
  const stic_timing *t = r->session.timing;
  const stic_histogram *frame = &t->stages[STIC_STAGE_FRAME];
  const stic_histogram *wakeup = &t->stages[STIC_STAGE_WAKEUP];
  const double seconds = (double)(stic_clock_ns() - r->session.started_ns) / 1e9;

  stic_cli_say("%lld samples in %.1f s, %.1f a second; target %d", (long long)r->session.rows, seconds,
               (double)r->session.rows / seconds, STIC_TARGET_HZ);
  if (r->session.rows > 0)
    stic_cli_say(
      "computing p50 %.1f us, p99 %.1f us, max %.1f us; %lld of %lld over 1/%d s; woke late p99 %.1f us",
      (double)stic_histogram_quantile(frame, 0.5) / 1e3, (double)stic_histogram_quantile(frame, 0.99) / 1e3,
      (double)frame->max_ns / 1e3, (long long)t->missed, (long long)frame->count, STIC_TARGET_HZ,
      (double)stic_histogram_quantile(wakeup, 0.99) / 1e3);
}

static int finish(run *r, int code, stic_error *err)
{
  stic_trace_writer *recording = r->recording;
  bool pipe_closed;

  r->recording = NULL;
  if (stic_trace_finish(recording, err) != STIC_OK && code == STIC_OK)
    code = stic_cli_fail(err);
  if (stic_session_commit(&r->session, scheduling_text(), &pipe_closed, err) != STIC_OK && !pipe_closed)
    code = stic_cli_fail(err);
  report(r);
  return code;
}

static stic_status open_all(run *r, const stic_session_options *options, const char *scene,
                            const char *device, const char *tracker, const char *record, stic_error *err)
{
  const stic_supervisor_options supervised = {tell_connection, NULL, 0};
  const char *const inputs[] = {scene};
  stic_tracker_settings settings;
  const char *const outputs[] = {options->log, options->events, options->timing, record};
  char described[300];
  stic_status status = stic_cli_check_paths(inputs, 1, outputs, 4, err);

  if (status == STIC_OK)
    status = stic_tracker_read(tracker ? tracker : scene, tracker != NULL, &settings, err);
  if (status == STIC_OK)
    status = stic_supervisor_open(device, &supervised, &r->device, err);
  if (status != STIC_OK)
    return status;
  stic_tracker_begin(&r->tracker, &settings, stic_supervisor_driver(r->device)->kind);
  stic_supervisor_describe(r->device, described, sizeof described);
  status = stic_session_open(&r->session, options, scene, "device", described, err);
  if (status == STIC_OK)
    status = stic_session_time(&r->session, err);
  if (status == STIC_OK && record)
    status = stic_trace_create(record, described, &r->recording, err);
  return status;
}

static int run_device(const stic_session_options *options, const char *scene, const char *device,
                      const char *tracker, const char *record)
{
  run r;
  stic_error err;
  int code;

  memset(&r, 0, sizeof r);
  if (open_all(&r, options, scene, device, tracker, record, &err) != STIC_OK)
    code = stic_cli_fail(&err);
  else
    code = finish(&r, loop(&r, &err), &err);
  stic_trace_finish(r.recording, NULL);
  stic_session_close(&r.session);
  stic_supervisor_close(r.device);
  return code;
}

int stic_cmd_run(int argc, const char **argv)
{
  stic_session_options options = {NULL, NULL, NULL, NULL, NULL, NULL};
  char *device = NULL, *tracker = NULL, *record = NULL;
  const struct poptOption table[] = {
    {"device", 'd', POPT_ARG_STRING, &device, 0,
     "The tracker, e.g. trace:file=hand.csv,speed=2,loop or trace:file=- (standard input)",
     "NAME[:key=value,...]"},
    {"tracker", '\0', POPT_ARG_STRING, &tracker, 0,
     "Where the tracker stands and which button does what, instead of the scene's section tracker", "FILE"},
    {"record", '\0', POPT_ARG_STRING, &record, 0, "Record the samples as a trace", "FILE"},
    STIC_SESSION_OPTIONS(&options),
    POPT_TABLEEND};
  stic_cli_args args;
  int code = stic_cli_parse(&usage, table, argc, argv, &args);

  if (code < 0 && !device) {
    stic_cli_say("run: no device; expected --device NAME[:key=value,...]");
    code = STIC_USAGE;
  }
  if (code < 0)
    code = run_device(&options, args.positions[0], device, tracker, record);
  stic_cli_args_free(&args);
  stic_session_options_free(&options);
  free(device);
  free(tracker);
  free(record);
  return code;
}

/* stiction run: a device's samples through the solver in real time. */
#include "../../drivers/device_spec.h"
#include "../../drivers/mouse/mouse_driver.h"
#include "../error.h"
#include "../io/trace_csv.h"
#include "../live/live.h"
#include "auto_level.h"
#include "cli.h"
#include "run_pictures.h"
#include "session.h"
#include "viewer.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NEWS_ROOM 64
#define NOT_GIVEN LLONG_MIN /* of --budget-ns */
#define LOOK_NS                                                                                              \
  50000000 /* how often the main thread looks for news, and for a signal that just missed its wait */

static const stic_cli_usage usage = {
  "run", "[OPTION...] SCENE --device NAME[:key=value,...]",
  "Solves a device's samples as they come, each of them, and says at the end how it kept up. Where none\n"
  "comes within 1/31 s the last pose is solved again and recorded as such; not for traces, whose samples\n"
  "have times of their own that an invented one could overtake.\n"
  "SIGINT or SIGTERM ends it with 0 and everything written. Disk, terminal and pictures never delay the\n"
  "loop: rows wait in a queue, and if that is full the run ends with 5; pictures that come too late are\n"
  "dropped and counted. A recording is readable to its last whole line whatever happens; replay of it\n"
  "gives the same log rows.\n",
  1, 1};

/* A change of the connection, from the reader to the main thread. */
typedef struct news {
  stic_connection state;
  char text[600];
} news;

typedef struct run {
  stic_session session;
  stic_supervisor *device;
  stic_tracker tracker;         /* from the device's frame to the room's */
  stic_trace_writer *recording; /* NULL: none asked for */
  stic_ring *news;
  stic_run_pictures *pictures;
  stic_viewer *viewer; /* NULL: none asked for, or it failed */
  int view_code;       /* why it failed */
} run;

/* ---- news of the connection ---------------------------------------------------------------- */

/* Each change of the connection, once; in the reader's thread, which no terminal may hold up. */
static void on_connection(void *context, stic_connection state, const char *text)
{
  run *r = context;
  news *item = stic_ring_slot(r->news);

  if (!item)
    return;
  item->state = state;
  stic_error_quote(text, strlen(text), item->text, sizeof item->text);
  stic_ring_put(r->news);
}

static void tell_news(run *r)
{
  const news *item;

  while ((item = stic_ring_front(r->news)) != NULL) {
    const stic_connection state = item->state;

    if (state == STIC_CONNECTION_STALE || state == STIC_CONNECTION_LOST)
      stic_cli_say("the tracker is %s%s%s", stic_connection_name(state), item->text[0] ? ": " : "",
                   item->text);
    else if (state == STIC_CONNECTION_RUNNING)
      stic_cli_say("tracking: %s", item->text);
    stic_ring_take(r->news);
  }
}

/* ---- what the writer thread does ------------------------------------------------------------ */

static stic_status session_status(const run *r, stic_error *err)
{
  /* The commit will say which file and why. */
  return stic_session_write_failed(&r->session)
           ? stic_error_set(err, STIC_CANNOT_WRITE, NULL, 0, "an output cannot be written")
           : STIC_OK;
}

static stic_status write_row(void *user, const stic_live_row *row, stic_error *err)
{
  run *r = user;

  /* Recorded first: what the log has can be replayed. */
  if (r->recording) {
    const stic_status status = stic_trace_write(r->recording, &row->sample, err);

    if (status != STIC_OK)
      return status;
  }
  stic_session_write(&r->session, &row->result, row->events, row->event_count);
  return session_status(r, err);
}

static stic_status flush_rows(void *user, stic_error *err)
{
  run *r = user;

  stic_session_flush(&r->session);
  return session_status(r, err);
}

/* ---- the run -------------------------------------------------------------------------------- */

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

static bool is_mouse(const run *r)
{
  return stic_supervisor_driver(r->device) == &stic_mouse_driver;
}

/* One turn of the main thread; false when the user has closed the window, or is left without the mouse in it. */
static bool look(run *r, stic_live *live)
{
  bool ended = false;
  stic_error err;

  if (!r->viewer) {
    stic_live_wait(live, LOOK_NS);
  } else if (stic_viewer_turn(r->viewer, stic_live_view(live), &ended, &err) != STIC_OK) {
    /* Whoever holds a tracker goes on without the window. */
    r->view_code = stic_cli_fail(&err);
    stic_viewer_close(r->viewer);
    r->viewer = NULL;
    ended = is_mouse(r);
  }
  tell_news(r);
  return !ended;
}

/* Until the device ends, a signal or the user ends it, or nothing can be written any more. */
static stic_status loop(run *r, stic_live_report *report, stic_error *err)
{
  const stic_live_pictures pictures = stic_run_pictures_calls(r->pictures, &r->session.scene);
  const stic_live_settings settings = {
    .device = r->device,
    .tracker = &r->tracker,
    .sim = r->session.sim,
    .events = r->session.events != NULL,
    .output = {r, write_row, flush_rows},
    .pictures = stic_run_pictures_wanted(r->pictures) ? &pictures : NULL,
  };
  stic_live *live;
  const stic_status status = stic_live_start(&settings, &live, err);

  if (status != STIC_OK)
    return status;
  while (stic_live_runs(live) && stic_cli_signal() == 0 && look(r, live))
    ;
  stic_live_finish(live, r->session.timing, report);
  tell_news(r);
  return STIC_OK;
}

/* ---- how it went ---------------------------------------------------------------------------- */

static void count_all(run *r, const stic_live_report *report)
{
  stic_timing *t = r->session.timing;

  stic_timing_count(t, "repeated", report->repeated);
  stic_timing_count(t, "lost_samples", report->lost_samples);
  stic_timing_count(t, "samples_queued_most", (int64_t)report->samples_most);
  stic_timing_count(t, "rows_queued_most", (int64_t)report->rows_most);
  if (r->viewer)
    stic_timing_count(t, "view_pictures", stic_viewer_pictures(r->viewer));
  if (!stic_run_pictures_wanted(r->pictures))
    return;
  stic_timing_count(t, "pictures", r->pictures->count);
  stic_timing_count(t, "dropped_pictures", r->pictures->dropped);
  stic_timing_count(t, "results_unseen_by_pictures", report->unseen_results);
  stic_timing_merge(t, &r->pictures->timing);
}

static void tell_times(const stic_timing *t)
{
  const stic_histogram *frame = &t->stages[STIC_STAGE_FRAME], *latency = &t->stages[STIC_STAGE_LATENCY];

  stic_cli_say(
    "computing p50 %.1f us, p99 %.1f us, max %.1f us; %lld of %lld over 1/%d s; woke late p99 %.1f us",
    (double)stic_histogram_quantile(frame, 0.5) / 1e3, (double)stic_histogram_quantile(frame, 0.99) / 1e3,
    (double)frame->max_ns / 1e3, (long long)t->missed, (long long)frame->count, STIC_TARGET_HZ,
    (double)stic_histogram_quantile(&t->stages[STIC_STAGE_WAKEUP], 0.99) / 1e3);
  if (latency->count > 0)
    stic_cli_say("from measurement to result p50 %.1f us, p99 %.1f us, max %.1f us",
                 (double)stic_histogram_quantile(latency, 0.5) / 1e3,
                 (double)stic_histogram_quantile(latency, 0.99) / 1e3, (double)latency->max_ns / 1e3);
  for (int i = 0; i < STIC_DEVICE_RATES; i++) {
    if (t->over[i] > t->missed)
      stic_cli_say("%lld over 1/%g s", (long long)t->over[i], stic_timing_rate(i));
  }
  for (int i = 0; i < t->miss_count && i < 4; i++)
    stic_cli_say("missed at %.3f s: %s took %.1f ms", (double)t->misses[i].at_ns / 1e9, t->misses[i].why,
                 (double)t->misses[i].ns / 1e6);
}

static void tell_report(const run *r, const stic_live_report *report)
{
  /* From the first row to the last there is one interval less than rows. */
  const double rate = report->rows > 1 ? (double)(report->rows - 1) / report->seconds : 0;

  stic_cli_say("%lld samples and %lld repeated frames in %.1f s, %.1f frames a second; target %d",
               (long long)(report->rows - report->repeated), (long long)report->repeated, report->seconds,
               rate, STIC_TARGET_HZ);
  tell_times(r->session.timing);
  stic_cli_say("%s; %zu samples and %zu rows at most waited", report->scheduling, report->samples_most,
               report->rows_most);
  if (report->device_stalls)
    stic_cli_say("the device does not come back from a read: left as it is");
  if (report->lost_samples > 0)
    stic_cli_say("%lld samples lost: the solver was too slow for them", (long long)report->lost_samples);
  if (stic_run_pictures_wanted(r->pictures))
    stic_cli_say("%lld pictures, %lld of them dropped (shown as the one before)",
                 (long long)r->pictures->count, (long long)r->pictures->dropped);
}

static int finish(run *r, const stic_live_report *report, stic_error *err)
{
  stic_trace_writer *recording = r->recording;
  const bool session_failed = stic_session_write_failed(&r->session);
  int code;

  r->session.seconds = report->seconds;
  count_all(r, report);
  if (report->rows > 0)
    tell_report(r, report); /* first: what failed is the last word */
  code = report->end == STIC_LIVE_DEVICE_ENDED ? device_failure(r, report->device_result) : STIC_OK;
  if (report->output_error.status != STIC_OK && !session_failed)
    code = stic_cli_fail(&report->output_error);
  r->recording = NULL;
  if (stic_trace_finish(recording, err) != STIC_OK && code == STIC_OK)
    code = stic_cli_fail(err);
  if (stic_session_commit(&r->session, report->scheduling, err) != STIC_OK)
    code = stic_cli_fail(err);
  if (report->picture_error.status != STIC_OK)
    code = stic_cli_fail(&report->picture_error);
  if (code == STIC_OK)
    code = r->view_code;
  if (code == STIC_OK && report->rows == 0)
    stic_cli_say("no sample came");
  return code;
}

/* Where samples come from and go to. */
typedef struct run_options {
  stic_session_options session;
  char *device, *tracker, *record; /* popt's copies */
  stic_run_pictures pictures;
  int view;
} run_options;

static stic_status open_device(run *r, const run_options *o, const char *scene, stic_error *err)
{
  const stic_supervisor_options supervised = {on_connection, r, 0};
  const char *const outputs[] = {o->session.log, o->session.events, o->session.timing, o->record,
                                 o->pictures.video};
  stic_tracker_settings settings;
  stic_device_spec spec;
  stic_status status = stic_spec_parse(o->device, &spec, err);

  if (status == STIC_OK) {
    /* A recording that is replayed as a device must not be what is written. */
    const char *const inputs[] = {scene, o->tracker, stic_spec_text(&spec, "file", NULL)};

    status = stic_cli_check_paths(inputs, 3, outputs, 5, err);
  }
  if (status == STIC_OK)
    status = o->tracker ? stic_tracker_read(o->tracker, NULL, true, &settings, err)
                        : stic_tracker_read(scene, r->session.scene_text, false, &settings, err);
  if (status == STIC_OK)
    status = stic_ring_create(sizeof(news), NEWS_ROOM, &r->news, err);
  if (status == STIC_OK)
    status = stic_supervisor_open(o->device, &supervised, &r->device, err);
  if (status == STIC_OK && is_mouse(r) && !o->view)
    status = stic_error_set(err, STIC_USAGE, NULL, 0, "device mouse: it moves in the window; add --view");
  if (status == STIC_OK)
    stic_tracker_begin(&r->tracker, &settings, stic_supervisor_driver(r->device)->kind);
  return status;
}

static stic_status open_view(run *r, const run_options *o, stic_error *err)
{
  stic_viewer_settings settings = {.scene = &r->session.scene,
                                   .mouse = is_mouse(r) ? stic_supervisor_device(r->device) : NULL};
  stic_status status;

  stic_render_settings_init(&settings.picture);
  status = stic_pictures_apply(&o->pictures.options, &settings.picture, err);
  return status == STIC_OK ? stic_viewer_open(&settings, &r->viewer, err) : status;
}

static stic_status open_all(run *r, const run_options *o, const char *scene, stic_error *err)
{
  char described[300];
  stic_status status = stic_session_load(&r->session, &o->session, scene, err);

  if (status == STIC_OK) /* after "auto" is settled: no sample has to wait for that */
    status = open_device(r, o, scene, err);
  if (status != STIC_OK)
    return status;
  stic_supervisor_describe(r->device, described, sizeof described);
  status = stic_session_begin(&r->session, "device", described, err);
  if (status == STIC_OK)
    status = stic_session_time(&r->session, err);
  if (status == STIC_OK && o->view)
    status = open_view(r, o, err);
  if (status == STIC_OK && o->record) {
    const stic_provenance provenance = stic_session_provenance(&r->session, "device", described);

    status = stic_trace_create(o->record, &provenance, &r->recording, err);
  }
  return status;
}

static int run_device(run_options *options, const char *scene)
{
  run *r = calloc(1, sizeof *r);
  stic_live_report report = {.device_stalls = false};
  stic_error err;
  int code;

  if (!r) {
    stic_cli_say("out of memory");
    return STIC_NO_MEMORY;
  }
  r->pictures = &options->pictures;
  if (open_all(r, options, scene, &err) != STIC_OK)
    code = stic_cli_fail_to_begin(&err);
  else if (loop(r, &report, &err) != STIC_OK)
    code = stic_cli_fail(&err);
  else
    code = finish(r, &report, &err);
  stic_trace_finish(r->recording, NULL);
  stic_viewer_close(r->viewer);
  stic_session_close(&r->session);
  if (report.device_stalls) /* the reader is still in the device, which tells its news to `r` */
    return code;
  stic_supervisor_close(r->device);
  stic_ring_destroy(r->news);
  free(r);
  return code;
}

static void free_options(run_options *o)
{
  stic_session_options_free(&o->session);
  stic_run_pictures_free(&o->pictures);
  free(o->device);
  free(o->tracker);
  free(o->record);
}

/* -1: all is well. */
static int settle_budget(long long budget_ns, stic_session_options *session)
{
  session->budget_ns = budget_ns == NOT_GIVEN ? STIC_AUTO_BUDGET_NS : budget_ns;
  if (session->budget_ns < 1)
    stic_cli_say("run: --budget-ns %lld: expected at least 1", budget_ns);
  else if (budget_ns != NOT_GIVEN && !(session->accuracy && strcmp(session->accuracy, "auto") == 0))
    stic_cli_say("run: --budget-ns goes with --accuracy auto only");
  else
    return -1;
  return STIC_USAGE;
}

int stic_cmd_run(int argc, const char **argv)
{
  run_options o;
  long long budget_ns = NOT_GIVEN;
  const struct poptOption table[] = {
    {"device", 'd', POPT_ARG_STRING, &o.device, 0,
     "The tracker, e.g. trace:file=hand.csv,speed=2,loop or trace:file=- (standard input)",
     "NAME[:key=value,...]"},
    {"tracker", '\0', POPT_ARG_STRING, &o.tracker, 0,
     "Where the tracker stands and which button does what, instead of the scene's section tracker", "FILE"},
    {"record", '\0', POPT_ARG_STRING, &o.record, 0, "Record the samples as a trace", "FILE"},
    {"view", '\0', POPT_ARG_NONE, &o.view, 0, "Show it live in a window (key h: help)", NULL},
    {"budget-ns", '\0', POPT_ARG_LONGLONG, &budget_ns, 0,
     "For --accuracy auto, which takes the most accurate level and precision whose p99.9 on this scene is within "
     "so many ns of computing a sample (default a tenth of 1/31 s)",
     "NS"},
    STIC_SESSION_OPTIONS(&o.session, "frame, substep=N, event (default) or auto"),
    STIC_RUN_PICTURE_OPTIONS(&o.pictures),
    POPT_TABLEEND};
  stic_cli_args args;
  int code;

  memset(&o, 0, sizeof o);
  stic_run_pictures_init(&o.pictures);
  code = stic_cli_parse(&usage, table, argc, argv, &args);
  if (code < 0 && !o.device) {
    stic_cli_say("run: no device; expected --device NAME[:key=value,...]");
    code = STIC_USAGE;
  }
  if (code < 0)
    code = settle_budget(budget_ns, &o.session);
  if (code < 0)
    code = run_device(&o, args.positions[0]);
  stic_cli_args_free(&args);
  free_options(&o);
  return code;
}

/* stiction replay: a trace through the solver, headless and as fast as it can. */
#include "../error.h"
#include "../io/trace_csv.h"
#include "cli.h"
#include "pictures.h"
#include "review.h"
#include "session.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MANY_PICTURES 20000 /* minutes of drawing */

static const stic_cli_usage usage = {
  "replay", "[OPTION...] SCENE TRACE",
  "Solves each sample of TRACE (CSV; '-': standard input) in SCENE (YAML), deterministically and as\n"
  "fast as it can. Output files appear whole or not at all; SIGINT or SIGTERM leaves none and ends\n"
  "with 128 + its number. A bad line ends it with exit code 3 unless --lenient is given.\n",
  2, 2};

/* Command-line values beside those of the session. */
typedef struct replay_options {
  char *folder, *video; /* NULL: no pictures of that kind */
  char *report;         /* NULL: no page */
  stic_picture_options pictures;
  int fps, force, hud_timing, lenient;
} replay_options;

typedef struct replay {
  stic_session session;
  stic_trace_reader *trace;
  stic_movie *movie;      /* NULL: none asked for, or it failed */
  stic_error movie_error; /* why it failed; the rest of the run goes on without pictures */
  stic_review review;
  bool hud_timing;
  stic_error first_skipped; /* with --lenient */
} replay;

static void on_problem(void *context, bool warning, const stic_error *problem)
{
  replay *r = context;

  if (warning)
    stic_cli_warn(problem);
  else if (r->first_skipped.status == STIC_OK)
    r->first_skipped = *problem;
}

/* Pictures that fail leave nothing and take nothing else with them. */
static void movie_failed(replay *r, const stic_error *err)
{
  r->movie_error = *err;
  stic_review_no_video(&r->review, err);
  stic_movie_close(r->movie);
  r->movie = NULL;
}

/* Also after a failed write, which the commit tells and cleans up. */
static int finish(replay *r, stic_error *err)
{
  if (r->movie && stic_movie_finish(r->movie, err) != STIC_OK)
    movie_failed(r, err);
  if (stic_cli_signal() != 0)
    return STIC_EXIT_SIGNAL + stic_cli_signal();
  if (stic_session_commit(&r->session, "", err) != STIC_OK)
    return stic_cli_fail(err);
  if (r->movie && stic_movie_keep(r->movie, err) != STIC_OK)
    movie_failed(r, err);
  if (stic_review_finish(&r->review, &r->session, err) != STIC_OK)
    return stic_cli_fail(err);
  if (stic_trace_skipped(r->trace) > 0) {
    char text[800];

    stic_error_format(&r->first_skipped, text, sizeof text);
    stic_cli_say("%lld bad line%s passed over, the first: %s", (long long)stic_trace_skipped(r->trace),
                 stic_trace_skipped(r->trace) == 1 ? "" : "s", text);
  }
  return r->movie_error.status == STIC_OK ? STIC_OK : stic_cli_fail(&r->movie_error);
}

/* The clock's values, which the pictures of a replay only show on request. */
static void show_timing(replay *r, int64_t frame_ns)
{
  char note[64];

  snprintf(note, sizeof note, "computed in %.1f us", (double)frame_ns / 1e3);
  stic_render_set_note(stic_movie_renderer(r->movie), note);
}

/* Returns the exit code; a negative one stands for "go on". */
static int one_sample(replay *r, const stic_sample *sample, int64_t read_ns, stic_error *err)
{
  stic_session *s = &r->session;
  int64_t frame_ns;

  if (r->movie && stic_movie_before(r->movie, sample->t_ns, err) != STIC_OK)
    movie_failed(r, err);
  frame_ns = stic_session_step(s, sample, read_ns);
  stic_review_add(&r->review, s, frame_ns);
  if (r->movie)
    stic_movie_observe(r->movie, &s->result);
  if (r->movie && r->hud_timing)
    show_timing(r, frame_ns);
  return stic_session_write_failed(s) ? finish(r, err) : -1;
}

static int replay_all(replay *r, stic_error *err)
{
  stic_sample sample;

  while (stic_cli_signal() == 0) {
    const int64_t start = r->session.timing ? stic_clock_ns() : 0;
    int code;

    switch (stic_trace_next(r->trace, &sample, err)) {
    case STIC_TRACE_END: return -1;
    case STIC_TRACE_BAD: return stic_cli_fail(err);
    case STIC_TRACE_WAIT: continue;
    case STIC_TRACE_SAMPLE: break;
    }
    code = one_sample(r, &sample, r->session.timing ? stic_clock_ns() - start : 0, err);
    if (code >= 0)
      return code;
  }
  return STIC_EXIT_SIGNAL + stic_cli_signal();
}

static void on_stage(void *user, stic_movie_stage stage, int64_t ns)
{
  stic_timing_add(user, stage == STIC_MOVIE_RENDER ? STIC_STAGE_RENDER : STIC_STAGE_ENCODE, ns);
}

static bool is_stopped(void)
{
  return stic_cli_signal() != 0;
}

static stic_status open_movie(replay *r, const replay_options *o, const char *trace, stic_error *err)
{
  stic_movie_settings settings;
  stic_extent extent;
  bool measured = true;
  double seconds = 0;
  stic_status status;

  stic_movie_settings_init(&settings);
  settings.folder = o->folder;
  settings.video = r->review.video ? r->review.video : o->video;
  settings.fps = o->fps;
  settings.force = o->force != 0;
  settings.timed = r->session.timing ? on_stage : NULL;
  settings.user = r->session.timing;
  settings.stopped = is_stopped;
  settings.render.extent = &extent;
  status = stic_pictures_apply(&o->pictures, &settings.render, err);
  if (status == STIC_OK && o->hud_timing)
    status = stic_session_time(&r->session, err);
  if (status == STIC_OK)
    status = stic_pictures_measure(&r->session.scene, &r->session.settings, trace, o->lenient != 0, &extent,
                                   &measured, &seconds, err);
  if (status == STIC_OK && seconds * o->fps >= MANY_PICTURES)
    stic_cli_say("%.0f pictures have to be drawn; fewer with a smaller --fps", floor(seconds * o->fps) + 1);
  if (!measured)
    settings.render.extent = NULL;
  r->hud_timing = o->hud_timing != 0;
  return status == STIC_OK ? stic_movie_open(&settings, &r->session.scene, &r->movie, err) : status;
}

/* A missing renderer or folder is told at once only if nothing else is wanted of the run. */
static stic_status start_movie(replay *r, const replay_options *o, const stic_session_options *session,
                               const char *trace, stic_error *err)
{
  stic_status status;

  if (!o->folder && !o->video && !r->review.video)
    return STIC_OK;
  status = open_movie(r, o, trace, err);
  /* A page alone does without; what is said of a file or the renderer is no wrong option. */
  if (status != STIC_OK && !o->folder && !o->video && (status == STIC_CANNOT_WRITE || err->file[0])) {
    stic_review_no_video(&r->review, err);
    return STIC_OK;
  }
  if (status != STIC_CANNOT_WRITE || !(session->log || session->events))
    return status;
  movie_failed(r, err);
  return STIC_OK;
}

int stic_cmd_replay(int argc, const char **argv)
{
  stic_session_options session = {NULL, NULL, NULL, NULL, NULL, NULL, 0};
  replay_options o = {.fps = STIC_TARGET_HZ};
  const struct poptOption table[] = {
    STIC_SESSION_OPTIONS(&session, "frame, substep=N or event (default)"),
    {"lenient", '\0', POPT_ARG_NONE, &o.lenient, 0, "Pass over bad lines of the trace and count them", NULL},
    {"frames", '\0', POPT_ARG_STRING, &o.folder, 0, "Write pictures DIR/frame_000000.png ...", "DIR"},
    {"video", '\0', POPT_ARG_STRING, &o.video, 0,
     "Write a video: .mp4 (H.264), .mkv (lossless) or .webm (VP9)", "FILE"},
    {"report", '\0', POPT_ARG_STRING, &o.report, 0,
     "Write a page to review the run in a browser (HTML, one file)", "FILE"},
    {"fps", '\0', POPT_ARG_INT, &o.fps, 0, "Pictures per second of the trace, 1 to 1000 (default 31)", "N"},
    {"force", '\0', POPT_ARG_NONE, &o.force, 0, "Remove older pictures from DIR", NULL},
    STIC_PICTURE_OPTIONS(&o.pictures),
    {"hud-timing", '\0', POPT_ARG_NONE, &o.hud_timing, 0, "Show in the pictures what each frame cost", NULL},
    POPT_TABLEEND};
  replay r = {.trace = NULL};
  stic_cli_args args;
  stic_error err;
  int code = stic_cli_parse(&usage, table, argc, argv, &args);

  if (code < 0) {
    const char *const outputs[] = {session.log, session.events, session.timing, o.video, o.report};
    const stic_trace_options trace_options = {o.lenient != 0, on_problem, &r};
    const stic_review_source source = {args.positions[0], args.positions[1], argc, argv, o.fps, o.video};

    code = -1;
    if (stic_cli_check_paths(args.positions, 2, outputs, 5, &err) != STIC_OK ||
        stic_session_open(&r.session, &session, args.positions[0], "trace", args.positions[1], &err) !=
          STIC_OK ||
        stic_trace_open(args.positions[1], &trace_options, &r.trace, &err) != STIC_OK ||
        stic_review_open(&r.review, o.report, &r.session, &source, &err) != STIC_OK ||
        start_movie(&r, &o, &session, args.positions[1], &err) != STIC_OK)
      code = stic_cli_fail_to_begin(&err);
    if (code < 0)
      code = replay_all(&r, &err);
    if (code < 0)
      code = finish(&r, &err);
    stic_movie_close(r.movie);
    stic_review_close(&r.review);
    stic_trace_close(r.trace);
    stic_session_close(&r.session);
  }
  stic_cli_args_free(&args);
  stic_session_options_free(&session);
  stic_picture_options_free(&o.pictures);
  free(o.folder);
  free(o.video);
  free(o.report);
  return code;
}

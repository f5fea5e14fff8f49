/* stiction replay: a trace through the solver, headless and as fast as it can. */
#include "../error.h"
#include "../io/trace_csv.h"
#include "../number.h"
#include "cli.h"
#include "movie.h"
#include "session.h"

#include <stdlib.h>
#include <string.h>

static const stic_cli_usage usage = {
  "replay", "[OPTION...] SCENE TRACE",
  "Solves each sample of TRACE (CSV; '-': standard input) in SCENE (YAML), deterministically and as\n"
  "fast as it can. Output files appear whole or not at all; SIGINT or SIGTERM leaves none and ends\n"
  "with 128 + its number. A bad line ends it with exit code 3 unless --lenient is given.\n",
  2, 2};

/* Command-line values. */
typedef struct picture_options {
  char *folder; /* NULL: no pictures */
  char *size;   /* NULL: the renderer's default */
  int fps, force;
} picture_options;

typedef struct replay {
  stic_session session;
  stic_trace_reader *trace;
  stic_movie *movie; /* NULL: none asked for */
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

/* Also after a failed write, which the commit tells and cleans up. A reader of standard output that
 * has left gets no message. */
static int finish(replay *r, stic_error *err)
{
  bool pipe_closed;

  if (r->movie && stic_movie_finish(r->movie, err) != STIC_OK)
    return stic_cli_fail(err);
  if (stic_cli_signal() != 0)
    return STIC_EXIT_SIGNAL + stic_cli_signal();
  if (stic_session_commit(&r->session, "", &pipe_closed, err) != STIC_OK)
    return pipe_closed ? STIC_EXIT_SIGNAL + SIGPIPE : stic_cli_fail(err);
  if (r->movie && stic_movie_keep(r->movie, err) != STIC_OK)
    return stic_cli_fail(err);
  if (stic_trace_skipped(r->trace) > 0) {
    char text[800];

    stic_error_format(&r->first_skipped, text, sizeof text);
    stic_cli_say("%lld bad line%s passed over, the first: %s", (long long)stic_trace_skipped(r->trace),
                 stic_trace_skipped(r->trace) == 1 ? "" : "s", text);
  }
  return STIC_OK;
}

/* Returns the exit code; a negative one stands for "go on". */
static int one_sample(replay *r, const stic_sample *sample, int64_t read_ns, stic_error *err)
{
  stic_session *s = &r->session;

  if (r->movie && stic_movie_before(r->movie, sample->t_ns, err) != STIC_OK)
    return stic_cli_fail(err);
  stic_session_step(s, sample, read_ns);
  if (r->movie)
    stic_movie_observe(r->movie, &s->result);
  return stic_session_write_failed(s) ? finish(r, err) : -1;
}

static int replay_all(replay *r, stic_error *err)
{
  stic_sample sample;

  while (stic_cli_signal() == 0) {
    const int64_t start = r->session.timing ? stic_clock_ns() : 0;
    int code;

    switch (stic_trace_next(r->trace, &sample, err)) {
    case STIC_TRACE_END:
      return -1;
    case STIC_TRACE_BAD:
      return stic_cli_fail(err);
    case STIC_TRACE_WAIT:
      continue;
    case STIC_TRACE_SAMPLE:
      break;
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

static bool parse_size(const char *text, int *width, int *height)
{
  const char *x = strchr(text, 'x');
  int64_t w, h;

  if (!x || stic_number_parse_integer(text, (size_t)(x - text), 1, INT16_MAX, &w) != STIC_NUMBER_OK ||
      stic_number_parse_integer(x + 1, strlen(x + 1), 1, INT16_MAX, &h) != STIC_NUMBER_OK)
    return false;
  *width = (int)w;
  *height = (int)h;
  return true;
}

static stic_status open_movie(replay *r, const picture_options *options, stic_error *err)
{
  stic_movie_settings settings;

  stic_movie_settings_init(&settings);
  settings.folder = options->folder;
  settings.fps = options->fps;
  settings.force = options->force != 0;
  settings.timed = r->session.timing ? on_stage : NULL;
  settings.user = r->session.timing;
  if (options->size && !parse_size(options->size, &settings.render.width, &settings.render.height))
    return stic_error_set(err, STIC_USAGE, NULL, 0, "--size %.40s: expected WIDTHxHEIGHT in pixels",
                          options->size);
  return stic_movie_open(&settings, &r->session.scene, &r->movie, err);
}

int stic_cmd_replay(int argc, const char **argv)
{
  stic_session_options options = {NULL, NULL, NULL, NULL, NULL, NULL};
  picture_options pictures = {NULL, NULL, STIC_TARGET_HZ, 0};
  int lenient = 0;
  const struct poptOption table[] = {
    STIC_SESSION_OPTIONS(&options),
    {"lenient", '\0', POPT_ARG_NONE, &lenient, 0, "Pass over bad lines of the trace and count them", NULL},
    {"frames", '\0', POPT_ARG_STRING, &pictures.folder, 0, "Write pictures DIR/frame_000000.png ...", "DIR"},
    {"fps", '\0', POPT_ARG_INT, &pictures.fps, 0, "Pictures per second of the trace, 1 to 1000 (default 31)", "N"},
    {"size", '\0', POPT_ARG_STRING, &pictures.size, 0, "Size of pictures in pixels (default 1280x720)", "WxH"},
    {"force", '\0', POPT_ARG_NONE, &pictures.force, 0, "Remove older pictures from DIR", NULL},
    POPT_TABLEEND
  };
  replay r = {.trace = NULL};
  stic_cli_args args;
  stic_error err;
  int code = stic_cli_parse(&usage, table, argc, argv, &args);

  if (code < 0) {
    const char *const outputs[] = {options.log, options.events, options.timing};
    const stic_trace_options trace_options = {lenient != 0, on_problem, &r};

    code = -1;
    if (stic_cli_check_paths(args.positions, 2, outputs, 3, &err) != STIC_OK ||
        stic_session_open(&r.session, &options, args.positions[0], "trace", args.positions[1], &err) != STIC_OK ||
        stic_trace_open(args.positions[1], &trace_options, &r.trace, &err) != STIC_OK ||
        (pictures.folder && open_movie(&r, &pictures, &err) != STIC_OK))
      code = stic_cli_fail(&err);
    if (code < 0)
      code = replay_all(&r, &err);
    if (code < 0)
      code = finish(&r, &err);
    stic_movie_close(r.movie);
    stic_trace_close(r.trace);
    stic_session_close(&r.session);
  }
  stic_cli_args_free(&args);
  stic_session_options_free(&options);
  free(pictures.folder);
  free(pictures.size);
  return code;
}

/* stiction check: all errors and warnings of a scene and a trace in one go. */
#include "../../drivers/motion/tracker_yaml.h"
#include "../error.h"
#include "../io/trace_csv.h"
#include "../scene_yaml.h"
#include "cli.h"

#include <stdio.h>
#include <stdlib.h>

static const stic_cli_usage usage = {
  "check", "[OPTION...] SCENE [TRACE]",
  "Reads the files as replay does and tells every error and warning; solves nothing. Ends with 1 if\n"
  "there is an error.\n",
  1, 2};

#define LINES_MAX 64

typedef struct findings {
  int64_t errors, warnings;
  stic_status worst; /* what is no fault of a file: usage, memory */
  int line_count;
  int64_t lines[LINES_MAX]; /* of the first errors */
} findings;

static void on_finding(void *context, bool warning, const stic_error *problem)
{
  findings *f = context;

  if (warning) {
    f->warnings++;
    stic_cli_warn(problem);
    return;
  }
  f->errors++;
  if (f->line_count < LINES_MAX)
    f->lines[f->line_count++] = problem->line;
  if (problem->status != STIC_BAD_INPUT)
    f->worst = problem->status;
  stic_cli_fail(problem);
}

/* The scene's section tracker; a line that the scene's own reader has told about is not told again. */
static void check_tracker(const char *path, const char *text, findings *f)
{
  stic_tracker_settings settings;
  stic_error err;

  if (stic_tracker_read(path, text, false, &settings, &err) == STIC_OK)
    return;
  for (int i = 0; i < f->line_count; i++) {
    if (f->lines[i] == err.line)
      return;
  }
  on_finding(f, false, &err);
}

static void check_trace(const char *path, const stic_scene *scene, findings *f)
{
  const stic_trace_options options = {true, on_finding, f};
  stic_trace_reader *reader;
  stic_trace_status status = STIC_TRACE_WAIT;
  stic_sample sample;
  stic_error err;
  bool gripped = false;
  int64_t samples = 0;

  if (stic_trace_open(path, &options, &reader, &err) != STIC_OK) {
    on_finding(f, false, &err);
    return;
  }
  while (stic_cli_signal() == 0 && (status == STIC_TRACE_WAIT || status == STIC_TRACE_SAMPLE)) {
    status = stic_trace_next(reader, &sample, &err);
    if (status == STIC_TRACE_SAMPLE) {
      samples++;
      gripped |= (sample.buttons & STIC_BUTTON_GRIP) != 0;
    }
  }
  if (status == STIC_TRACE_BAD) {
    on_finding(f, false, &err);
  } else if (samples > 0 && scene && scene->hold == STIC_HOLD_BUTTON && !gripped) {
    stic_error_set(&err, STIC_OK, path, 0,
                   "the grip button is never pressed, and the scene has hold: button");
    on_finding(f, true, &err);
  }
  stic_trace_close(reader);
}

static int check_files(const stic_cli_args *args, char **set)
{
  stic_override *overrides = NULL;
  int override_count;
  findings f = {0, 0, STIC_OK, 0, {0}};
  stic_scene *scene = malloc(sizeof *scene);
  stic_error err;
  char *text = NULL;
  bool scene_good;

  if (!scene || stic_cli_overrides(set, &overrides, &override_count, &err) != STIC_OK) {
    if (!scene)
      stic_error_set(&err, STIC_NO_MEMORY, NULL, 0, "out of memory");
    free(overrides);
    free(scene);
    return stic_cli_fail(&err);
  }
  scene_good = stic_scene_read_all(args->positions[0], overrides, override_count, scene, &text, on_finding,
                                   &f) == STIC_OK;
  if (text && stic_cli_signal() == 0)
    check_tracker(args->positions[0], text, &f);
  free(text);
  if (args->position_count > 1 && stic_cli_signal() == 0)
    check_trace(args->positions[1], scene_good ? scene : NULL, &f);
  free(overrides);
  free(scene);
  if (stic_cli_signal() != 0)
    return STIC_EXIT_SIGNAL + stic_cli_signal();
  printf("%lld error%s, %lld warning%s\n", (long long)f.errors, f.errors == 1 ? "" : "s",
         (long long)f.warnings, f.warnings == 1 ? "" : "s");
  if (f.worst != STIC_OK)
    return (int)f.worst;
  return f.errors > 0 ? STIC_FAILED : STIC_OK;
}

int stic_cmd_check(int argc, const char **argv)
{
  char **set = NULL;
  const struct poptOption table[] = {
    {"set", '\0', POPT_ARG_ARGV, &set, 0, "Override a value of the scene; repeatable", "KEY=VALUE"},
    POPT_TABLEEND};
  stic_cli_args args;
  int code = stic_cli_parse(&usage, table, argc, argv, &args);

  if (code < 0)
    code = check_files(&args, set);
  stic_cli_args_free(&args);
  stic_cli_free_list(set);
  return code;
}

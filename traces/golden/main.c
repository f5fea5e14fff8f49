/* stiction-golden SCENE TRACE EVERY FOLDER: writes FOLDER/expected.hash and FOLDER/reference.csv (each
 * EVERY-th row of the log). Run by the target `traces` only, so that a changed answer is a decision. */
#include "golden.h"

#include "../../src/io/log_csv.h"
#include "../../src/io/outfile.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct writer {
  stic_outfile *out;
  int64_t every, row;
} writer;

static void on_row(void *user, const stic_result *row, const stic_event *events, int event_count)
{
  writer *w = user;

  (void)events;
  (void)event_count;
  if (w->row++ % w->every == 0)
    stic_log_row(w->out, row);
}

static stic_status write_golden(const char *scene_path, const char *trace_path, const char *folder, writer *w,
                                stic_error *err)
{
  static stic_scene scene;
  stic_settings settings;
  stic_golden_trace trace = {NULL, 0};
  stic_golden_expected expected;
  char path[1024];
  stic_status status;

  stic_golden_here(&expected);
  stic_settings_init(&settings);
  snprintf(path, sizeof path, "%s/reference.csv", folder);
  if ((status = stic_scene_read(scene_path, NULL, 0, &scene, err)) == STIC_OK &&
      (status = stic_golden_read_trace(trace_path, &trace, err)) == STIC_OK &&
      (status = stic_outfile_open(path, &w->out, err)) == STIC_OK) {
    stic_outfile_print(w->out,
                       STIC_LOG_FORMAT "\n# one row in %lld, for comparison to 1e-10\n" STIC_LOG_HEADER "\n",
                       (long long)w->every);
    status = stic_golden_replay(&scene, &settings, &trace, on_row, w, expected.log, err);
    if (status == STIC_OK)
      status = stic_outfile_commit(w->out, err);
    else
      stic_outfile_abort(w->out);
  }
  free(trace.samples);
  snprintf(path, sizeof path, "%s/expected.hash", folder);
  return status == STIC_OK ? stic_golden_write_expected(path, &expected, err) : status;
}

int main(int argc, char **argv)
{
  writer w = {NULL, 0, 0};
  stic_error err;
  char text[900];

  if (argc == 5)
    w.every = atoll(argv[3]);
  if (w.every < 1) {
    fprintf(stderr, "usage: stiction-golden SCENE TRACE EVERY FOLDER\n");
    return STIC_USAGE;
  }
  if (write_golden(argv[1], argv[2], argv[4], &w, &err) != STIC_OK) {
    stic_error_format(&err, text, sizeof text);
    fprintf(stderr, "stiction-golden: %s\n", text);
    return (int)err.status;
  }
  return 0;
}

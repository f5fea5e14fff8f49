/* The library's makers, those of files, and the loop's. */
#include "../../src/collide.h"
#include "../../src/io/line_reader.h"
#include "../../src/io/log_csv.h"
#include "../../src/io/outfile.h"
#include "../../src/io/pose_file.h"
#include "../../src/io/trace_csv.h"
#include "../../src/live/live.h"
#include "../../src/live/wake.h"
#include "../../src/scene_yaml.h"
#include "../../src/sim.h"
#include "../../src/yaml_text.h"
#include "../files/help.h"
#include "makers.h"

#include <stdlib.h>

static struct {
  stic_scene scene;
  stic_settings settings;
  stic_supervisor *device;
  stic_tracker tracker;
  const char *yaml, *tracker_yaml, *trace, *log, *poses, *older;
} given;

static const stic_override override = {"friction.static", "0.6"};
static const stic_provenance provenance = {"scene.yaml", "device", "x", NULL, &given.settings, &override, 1};

static void set_up(void)
{
  stic_tracker_settings tracker;
  char *trace = stic_test_trace(20);

  given.yaml = stic_test_write("scene.yaml", stic_test_scene);
  given.tracker_yaml = stic_test_write("tracker.yaml", "stiction: 1\ntracker: {scale: 2}\n");
  given.trace = stic_test_write("hand.csv", trace);
  given.poses = stic_test_write("poses.txt", "1.5 0 0.1 0.2 0 0 0 1\n");
  given.log = stic_test_write("rows.log", "# stiction-log 1\n# scene: scene.yaml\n" STIC_LOG_HEADER "\n");
  given.older = stic_test_write("older", "older\n");
  free(trace);
  assert_int_equal(stic_scene_read(given.yaml, NULL, 0, &given.scene, NULL), STIC_OK);
  stic_settings_init(&given.settings);
  assert_int_equal(stic_supervisor_open("sample", NULL, &given.device, NULL), STIC_OK);
  stic_tracker_settings_init(&tracker);
  stic_tracker_begin(&given.tracker, &tracker, STIC_DRIVER_POSE);
}

static void tear_down(void)
{
  stic_supervisor_close(given.device);
}

static void finish_trace(stic_trace_writer *writer)
{
  assert_int_equal(stic_trace_finish(writer, NULL), STIC_OK);
}

MAKE(sim, stic_sim_create, stic_sim, stic_sim_destroy, &given.scene, &given.settings)
MAKE(sim_parts, stic_sim_create_parts, stic_sim, stic_sim_destroy, &given.scene, &given.settings,
     STIC_LEAVE_NONE)
MAKE(outfile, stic_outfile_open, stic_outfile, stic_outfile_abort, stic_test_path("new"))
MAKE(outfile_older, stic_outfile_open, stic_outfile, stic_outfile_abort, given.older)
MAKE(lines, stic_line_reader_open, stic_line_reader, stic_line_reader_close, given.trace)
MAKE(log_file, stic_log_open, stic_log_reader, stic_log_close, given.log)
MAKE(trace, stic_trace_open, stic_trace_reader, stic_trace_close, given.trace, NULL)
MAKE(trace_writer, stic_trace_create, stic_trace_writer, finish_trace, stic_test_path("new"), &provenance)
MAKE(poses, stic_pose_open, stic_pose_reader, stic_pose_close, given.poses, STIC_POSE_TUM, NULL)
MAKE(ring, stic_ring_create, stic_ring, stic_ring_destroy, 64, 16)
MAKE(latest, stic_latest_create, stic_latest, stic_latest_destroy, 64)

static stic_status make_scene(void **made, stic_error *err)
{
  static stic_scene scene;

  *made = NULL;
  return stic_scene_read(given.yaml, &override, 1, &scene, err);
}

/* The first problem is the one that counts. */
static void on_problem(void *context, bool warning, const stic_error *problem)
{
  stic_error *err = context;

  assert_false(warning);
  if (err->status == STIC_OK)
    *err = *problem;
}

static stic_status make_scene_all(void **made, stic_error *err)
{
  static stic_scene scene;
  stic_error first = {.status = STIC_OK};
  char *text = NULL;
  const stic_status status = stic_scene_read_all(given.yaml, &override, 1, &scene, &text, on_problem, &first);

  if (status != STIC_OK)
    free(text);
  if (err)
    *err = first;
  *made = status == STIC_OK ? text : NULL;
  return status;
}

static stic_status make_scene_text(void **made, stic_error *err)
{
  static stic_scene scene;
  char *text = NULL;
  const stic_status status = stic_scene_read_text(given.yaml, &override, 1, &scene, &text, err);

  if (status != STIC_OK)
    free(text);
  *made = status == STIC_OK ? text : NULL;
  return status;
}

static void on_yaml_problem(void *context, stic_status status, int64_t line, const char *message)
{
  stic_error_set(context, status, NULL, line, "%s", message);
}

static stic_status make_yaml(void **made, stic_error *err)
{
  stic_error own = {.status = STIC_OK};
  stic_yaml yaml = {.what = "scene", .problem = on_yaml_problem, .context = &own};
  size_t length;
  char *text = stic_yaml_read_file(&yaml, given.yaml, &length);

  *made = NULL;
  if (text && stic_yaml_begin(&yaml, text, length))
    stic_yaml_end(&yaml);
  free(text);
  if (err)
    *err = own;
  return own.status;
}

static stic_status make_tracker(void **made, stic_error *err)
{
  stic_tracker_settings settings;

  *made = NULL;
  return stic_tracker_read(given.tracker_yaml, NULL, true, &settings, err);
}

static stic_status make_collider(void **made, stic_error *err)
{
  const int surfaces[] = {0, 1};

  *made = stic_collider_create(&given.scene, 0.1, surfaces, 2, true);
  return without_words(*made != NULL, err);
}

static void end_collider(void *made)
{
  stic_collider_destroy(made);
}

static stic_status make_timing(void **made, stic_error *err)
{
  *made = stic_timing_create();
  return without_words(*made != NULL, err);
}

static stic_status make_timing_file(void **made, stic_error *err)
{
  static stic_timing timing;

  *made = NULL;
  timing.miss_count = 2;
  timing.misses[0].why = timing.misses[1].why = "";
  return stic_timing_write(&timing, 1, "", stic_test_path("timing.json"), err);
}

static stic_status make_wake(void **made, stic_error *err)
{
  static stic_wake wake;
  const stic_status status = stic_wake_create(&wake, err);

  *made = status == STIC_OK ? &wake : NULL;
  return status;
}

static void end_wake(void *made)
{
  stic_wake_destroy(made);
}

/* ---- the loop -------------------------------------------------------------------------------- */

static stic_status take_row(void *user, const stic_live_row *row, stic_error *err)
{
  (void)user, (void)row, (void)err;
  return STIC_OK;
}

static stic_status flush(void *user, stic_error *err)
{
  (void)user, (void)err;
  return STIC_OK;
}

static stic_status open_pictures(void *user, stic_error *err)
{
  (void)user, (void)err;
  return STIC_OK;
}

static stic_status take_picture(void *user, const stic_result *result, bool late, stic_error *err)
{
  (void)user, (void)result, (void)late, (void)err;
  return STIC_OK;
}

static void close_pictures(void *user)
{
  (void)user;
}

/* Each loop with a simulation of its own, as time begins anew. */
static stic_sim *solver;

static stic_status make_live(void **made, stic_error *err)
{
  const stic_live_pictures pictures = {NULL, open_pictures, take_picture, flush, close_pictures};
  stic_live_settings settings = {.device = given.device,
                                 .tracker = &given.tracker,
                                 .events = true,
                                 .output = {NULL, take_row, flush},
                                 .pictures = &pictures,
                                 .queue_samples = 16,
                                 .queue_rows = 16};
  stic_live *live = NULL;
  stic_status status = stic_sim_create(&given.scene, &given.settings, &solver, err);

  settings.sim = solver;
  if (status == STIC_OK)
    status = stic_live_start(&settings, &live, err);
  if (status != STIC_OK)
    stic_sim_destroy(solver);
  *made = live;
  return status;
}

static void end_live(void *made)
{
  stic_live_report report;

  stic_live_finish(made, NULL, &report);
  stic_sim_destroy(solver);
}

/* ---- the table ------------------------------------------------------------------------------- */

static const maker makers[] = {
  {"stic_scene_read", "", make_scene, end_nothing},
  {"stic_scene_read_all", "", make_scene_all, free},
  {"stic_scene_read_text", "", make_scene_text, free},
  {"stic_yaml_read_file", "", make_yaml, end_nothing},
  {"stic_yaml_begin", "", make_yaml, end_nothing},
  {"stic_sim_create", "", make_sim, end_sim},
  {"stic_sim_create_parts", "", make_sim_parts, end_sim_parts},
  {"stic_collider_create", "", make_collider, end_collider},
  {"stic_outfile_open", "a new file", make_outfile, end_outfile},
  {"stic_outfile_open", "instead of an older one", make_outfile_older, end_outfile_older},
  {"stic_line_reader_open", "", make_lines, end_lines},
  {"stic_log_open", "", make_log_file, end_log_file},
  {"stic_trace_open", "", make_trace, end_trace},
  {"stic_trace_create", "", make_trace_writer, end_trace_writer},
  {"stic_pose_open", "", make_poses, end_poses},
  {"stic_timing_create", "", make_timing, free},
  {"stic_timing_write", "", make_timing_file, end_nothing},
  {"stic_wake_create", "", make_wake, end_wake},
  {"stic_ring_create", "", make_ring, end_ring},
  {"stic_latest_create", "", make_latest, end_latest},
  {"stic_live_start", "", make_live, end_live},
  {"stic_tracker_read", "", make_tracker, end_nothing},
  {NULL, NULL, NULL, NULL},
};

const maker_group library_makers = {set_up, tear_down, makers};

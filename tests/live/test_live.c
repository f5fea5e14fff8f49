/* The loop's threads by themselves: nothing is lost or reordered without being told, whoever is slow or fails. */
#include "../../src/live/live.h"
#include "../files/help.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"
#include "io/log_csv.h"

#define MS INT64_C(1000000)
#define ROWS_MAX 20000

/* What the writer thread was given. */
typedef struct bench {
  stic_scene scene;
  stic_sim *sim;
  stic_supervisor *device;
  stic_tracker tracker;
  stic_live_settings settings;
  stic_live *live;
  int64_t slow_ns; /* per row */
  int fail_at;     /* row that cannot be written, -1: none */
  int hold_until_stop;
  int rows; /* atomic */
  stic_sample *samples;
  stic_result *results;
  int events;
} bench;

/* Also before start() knows it. */
static bool is_running(bench *b)
{
  const stic_live *live = __atomic_load_n(&b->live, __ATOMIC_ACQUIRE);

  return !live || stic_live_runs(live);
}

static stic_status take_row(void *user, const stic_live_row *row, stic_error *err)
{
  bench *b = user;

  if (b->rows == b->fail_at)
    return stic_error_set(err, STIC_CANNOT_WRITE, NULL, 0, "row %d", b->rows);
  while (b->hold_until_stop && is_running(b))
    stic_clock_sleep_until(stic_clock_ns() + MS);
  if (b->slow_ns > 0)
    stic_clock_sleep_until(stic_clock_ns() + b->slow_ns);
  assert_in_range(b->rows, 0, ROWS_MAX - 1);
  b->samples[b->rows] = row->sample;
  b->results[b->rows] = row->result;
  b->events += row->event_count;
  for (int i = 0; i < row->event_count; i++)
    assert_true(row->events[i].t <= (double)row->sample.t_ns / 1e9 + 1e-9);
  __atomic_fetch_add(&b->rows, 1, __ATOMIC_RELEASE);
  return STIC_OK;
}

static stic_status flush(void *user, stic_error *err)
{
  (void)user, (void)err;
  return STIC_OK;
}

static void make_scene(stic_scene *scene)
{
  stic_scene_init(scene);
  stic_scene_set_box(scene, 0.16, 0.08);
  scene->y = 0.06;
  scene->stiffness = 200;
  scene->rotational_stiffness = 0.5;
  scene->surface_count = 1;
  memset(&scene->surfaces[0], 0, sizeof scene->surfaces[0]);
  scene->surfaces[0].normal_deg = 90;
  scene->surfaces[0].friction = (stic_friction){0.5, 0.3};
}

static void prepare(bench *b, const char *device)
{
  stic_tracker_settings tracker;
  stic_settings settings;

  memset(b, 0, sizeof *b);
  b->fail_at = -1;
  b->samples = malloc(ROWS_MAX * sizeof *b->samples);
  b->results = malloc(ROWS_MAX * sizeof *b->results);
  make_scene(&b->scene);
  stic_settings_init(&settings);
  assert_int_equal(stic_sim_create(&b->scene, &settings, &b->sim, NULL), STIC_OK);
  assert_int_equal(stic_supervisor_open(device, NULL, &b->device, NULL), STIC_OK);
  stic_tracker_settings_init(&tracker);
  stic_tracker_begin(&b->tracker, &tracker, stic_supervisor_driver(b->device)->kind);
  b->settings.device = b->device;
  b->settings.tracker = &b->tracker;
  b->settings.sim = b->sim;
  b->settings.events = true;
  b->settings.output = (stic_live_output){b, take_row, flush};
}

static void start(bench *b)
{
  stic_live *live;

  assert_int_equal(stic_live_start(&b->settings, &live, NULL), STIC_OK);
  __atomic_store_n(&b->live, live, __ATOMIC_RELEASE);
}

static int rows_so_far(bench *b)
{
  return __atomic_load_n(&b->rows, __ATOMIC_ACQUIRE);
}

static void wait_for_rows(bench *b, int rows)
{
  while (rows_so_far(b) < rows && stic_live_runs(b->live))
    stic_live_wait(b->live, MS);
}

/* Solving what was written again gives what was written, with as many events. */
static void check_rows(const bench *b)
{
  stic_settings settings;
  stic_sim *sim;
  int events = 0, count;

  stic_settings_init(&settings);
  assert_int_equal(stic_sim_create(&b->scene, &settings, &sim, NULL), STIC_OK);
  for (int i = 0; i < b->rows; i++) {
    char wanted[STIC_LOG_ROW_MAX], got[STIC_LOG_ROW_MAX];
    stic_result result;

    assert_true(i == 0 || b->samples[i].t_ns > b->samples[i - 1].t_ns);
    stic_sim_step(sim, &b->samples[i], &result);
    stic_sim_events(sim, &count);
    events += count;
    wanted[stic_log_row_text(&result, wanted)] = '\0';
    got[stic_log_row_text(&b->results[i], got)] = '\0';
    assert_string_equal(got, wanted);
  }
  if (b->settings.events)
    assert_int_equal(b->events, events);
  stic_sim_destroy(sim);
}

static void end(bench *b)
{
  stic_sim_destroy(b->sim);
  stic_supervisor_close(b->device);
  free(b->samples);
  free(b->results);
}

static void every_row_arrives_and_can_be_solved_again(void **state)
{
  stic_live_report report;
  stic_timing *timing = stic_timing_create();
  bench b;

  (void)state;
  prepare(&b, "sample:rate=1000");
  start(&b);
  wait_for_rows(&b, 500);
  stic_live_stop(b.live);
  stic_live_stop(b.live);
  stic_live_finish(b.live, timing, &report);
  assert_int_equal(report.end, STIC_LIVE_STOPPED);
  assert_int_equal(report.rows, b.rows);
  assert_true(b.rows >= 500);
  assert_int_equal(report.rows - report.repeated + report.lost_samples,
                   stic_supervisor_counters(b.device).samples);
  assert_int_equal(timing->stages[STIC_STAGE_FRAME].count, report.rows);
  assert_int_equal(timing->stages[STIC_STAGE_WRITE].count, report.rows);
  assert_true(strstr(report.scheduling, "SCHED_") && strstr(report.scheduling, "memory"));
  check_rows(&b);
  end(&b);
  free(timing);
}

/* Two samples a second: the frames between have the last one's pose and times of their own. */
static void a_silent_device_is_repeated(void **state)
{
  const int64_t start_ns = stic_clock_ns();
  stic_live_report report;
  bench b;
  int repeats = 0;

  (void)state;
  prepare(&b, "sample:rate=2");
  start(&b);
  wait_for_rows(&b, 40);
  stic_live_finish(b.live, NULL, &report);
  for (int i = 1; i < b.rows; i++)
    repeats += memcmp(b.samples[i].position, b.samples[i - 1].position, sizeof b.samples[i].position) == 0;
  assert_true(report.repeated > 10);
  assert_int_equal(report.repeated, repeats);
  /* About from the first sample (the reader may have been late for it) to the last frame, nothing of the time to get ready. */
  assert_true(report.seconds * 1e9 > (double)(b.samples[b.rows - 2].t_ns - 1000 * MS));
  assert_true(report.seconds * 1e9 < (double)(stic_clock_ns() - start_ns));
  check_rows(&b);
  end(&b);
}

/* A trace's own times stay as they are: no repeats, nothing lost although it comes faster than it is solved. */
static void a_trace_is_solved_as_it_is(void **state)
{
  const int samples = 8000;
  char spec[300] = "trace:speed=1e6,file=", *text = stic_test_trace(samples);
  stic_live_report report;
  bench b;

  (void)state;
  strcat(spec, stic_test_write("fast.csv", text));
  prepare(&b, spec);
  b.settings.queue_rows = 16;
  start(&b);
  wait_for_rows(&b, ROWS_MAX);
  stic_live_finish(b.live, NULL, &report);
  assert_int_equal(report.end, STIC_LIVE_DEVICE_ENDED);
  assert_int_equal(report.device_result, STIC_DRIVER_END);
  assert_int_equal(report.rows, samples);
  assert_int_equal(b.rows, samples);
  assert_int_equal(report.repeated + report.lost_samples, 0);
  assert_true(report.rows_most <= 16);
  for (int i = 0; i < samples; i++)
    assert_int_equal(b.samples[i].t_ns, i * 20 * MS);
  check_rows(&b);
  end(&b);
  free(text);
}

/* A writer that stands still does not hold up the loop; when the queue is full the run ends, and all that was
 * solved is written. */
static void a_full_queue_ends_the_run(void **state)
{
  stic_live_report report;
  bench b;

  (void)state;
  prepare(&b, "sample:rate=1000");
  b.settings.queue_rows = 64;
  b.hold_until_stop = 1;
  start(&b);
  wait_for_rows(&b, ROWS_MAX);
  stic_live_finish(b.live, NULL, &report);
  assert_int_equal(report.end, STIC_LIVE_OUTPUT_FAILED);
  assert_int_equal(report.output_error.status, STIC_CANNOT_WRITE);
  stic_test_contains(report.output_error.message, "64 rows wait");
  assert_int_equal(b.rows, 64);
  assert_int_equal(report.rows, 64);
  check_rows(&b);
  end(&b);
}

static void a_failed_write_ends_the_run(void **state)
{
  stic_live_report report;
  bench b;

  (void)state;
  prepare(&b, "sample:rate=1000");
  b.fail_at = 10;
  start(&b);
  wait_for_rows(&b, ROWS_MAX);
  stic_live_finish(b.live, NULL, &report);
  assert_int_equal(report.end, STIC_LIVE_OUTPUT_FAILED);
  assert_string_equal(report.output_error.message, "row 10");
  assert_int_equal(b.rows, 10);
  end(&b);
}

/* A hundred samples at once where eight have room: what is not solved is counted. */
static void samples_without_room_are_counted(void **state)
{
  stic_live_report report;
  bench b;

  (void)state;
  prepare(&b, "sample:rate=1000");
  b.settings.queue_samples = 2;
  stic_clock_sleep_until(stic_clock_ns() + 300 * MS);
  start(&b);
  wait_for_rows(&b, 200);
  stic_live_finish(b.live, NULL, &report);
  assert_true(report.lost_samples > 0);
  assert_int_equal(report.rows - report.repeated + report.lost_samples,
                   stic_supervisor_counters(b.device).samples);
  check_rows(&b);
  end(&b);
}

/* ---- the cell and the pictures ------------------------------------------------------------- */

static void the_view_sees_the_newest_frame(void **state)
{
  stic_live_report report;
  const stic_live_view_item *item = NULL;
  int64_t last_ns = -1;
  bench b;
  int seen = 0;

  (void)state;
  prepare(&b, "sample:rate=500");
  start(&b);
  while (seen < 100) {
    bool fresh;

    item = stic_latest_read(stic_live_view(b.live), &fresh);
    if (!fresh) {
      stic_live_wait(b.live, MS);
      continue;
    }
    assert_true(item->result.t_ns > last_ns);
    last_ns = item->result.t_ns;
    seen++;
  }
  assert_int_equal(item->state, STIC_CONNECTION_RUNNING);
  assert_true(item->counters.samples > 0);
  stic_live_finish(b.live, NULL, &report);
  end(&b);
}

typedef struct album {
  pthread_t thread;
  int opened, results, late, finished, closed;
  int fail_open, fail_at;
  int64_t slow_ns, last_ns;
} album;

static stic_status album_open(void *user, stic_error *err)
{
  album *a = user;

  a->thread = pthread_self();
  a->opened++;
  return a->fail_open ? stic_error_set(err, STIC_USAGE, NULL, 0, "no pictures") : STIC_OK;
}

static stic_status album_result(void *user, const stic_result *result, bool late, stic_error *err)
{
  album *a = user;

  assert_true(pthread_equal(a->thread, pthread_self()));
  assert_true(result->t_ns > a->last_ns || a->results == 0);
  a->last_ns = result->t_ns;
  a->late += late;
  if (++a->results == a->fail_at)
    return stic_error_set(err, STIC_CANNOT_WRITE, NULL, 0, "picture %d", a->results);
  if (a->slow_ns > 0 && !late)
    stic_clock_sleep_until(stic_clock_ns() + a->slow_ns);
  return STIC_OK;
}

static stic_status album_finish(void *user, stic_error *err)
{
  album *a = user;

  (void)err;
  a->finished++;
  return STIC_OK;
}

static void album_close(void *user)
{
  album *a = user;

  assert_true(pthread_equal(a->thread, pthread_self()));
  a->closed++;
}

static void run_with(album *a, stic_live_report *report)
{
  const stic_live_pictures calls = {a, album_open, album_result, album_finish, album_close};
  bench b;

  prepare(&b, "sample:rate=500");
  b.settings.pictures = &calls;
  start(&b);
  wait_for_rows(&b, 400);
  stic_live_finish(b.live, NULL, report);
  check_rows(&b);
  assert_int_equal(report->rows, b.rows);
  end(&b);
}

static void pictures_get_every_result_in_one_thread(void **state)
{
  stic_live_report report;
  album a = {.fail_at = -1};

  (void)state;
  run_with(&a, &report);
  assert_int_equal(a.opened, 1);
  assert_int_equal(a.results + report.unseen_results, report.rows);
  assert_int_equal(a.finished, 1);
  assert_int_equal(a.closed, 1);
  assert_int_equal(report.picture_error.status, STIC_OK);
}

static void slow_pictures_are_told_so_and_hold_up_nobody(void **state)
{
  stic_live_report report;
  album a = {.fail_at = -1, .slow_ns = 400 * MS};

  (void)state;
  run_with(&a, &report);
  assert_true(a.late > 0);
  assert_int_equal(a.finished, 1);
}

static void failing_pictures_take_nothing_with_them(void **state)
{
  stic_live_report report;
  album a = {.fail_at = 5};

  (void)state;
  run_with(&a, &report);
  assert_int_equal(report.end, STIC_LIVE_STOPPED);
  assert_int_equal(report.picture_error.status, STIC_CANNOT_WRITE);
  assert_int_equal(a.results, 5);
  assert_int_equal(a.finished, 0);
  assert_int_equal(a.closed, 1);
}

static void pictures_that_cannot_be_opened_are_refused(void **state)
{
  album a = {.fail_open = 1};
  const stic_live_pictures calls = {&a, album_open, album_result, album_finish, album_close};
  stic_error err;
  stic_live *live;
  bench b;

  (void)state;
  prepare(&b, "sample");
  b.settings.pictures = &calls;
  assert_int_equal(stic_live_start(&b.settings, &live, &err), STIC_USAGE);
  assert_null(live);
  assert_string_equal(err.message, "no pictures");
  assert_int_equal(a.closed, 1);
  assert_int_equal(b.rows, 0);
  end(&b);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_row_arrives_and_can_be_solved_again),
    cmocka_unit_test(a_silent_device_is_repeated),
    cmocka_unit_test(a_trace_is_solved_as_it_is),
    cmocka_unit_test(a_full_queue_ends_the_run),
    cmocka_unit_test(a_failed_write_ends_the_run),
    cmocka_unit_test(samples_without_room_are_counted),
    cmocka_unit_test(the_view_sees_the_newest_frame),
    cmocka_unit_test(pictures_get_every_result_in_one_thread),
    cmocka_unit_test(slow_pictures_are_told_so_and_hold_up_nobody),
    cmocka_unit_test(failing_pictures_take_nothing_with_them),
    cmocka_unit_test(pictures_that_cannot_be_opened_are_refused),
  };

  return cmocka_run_group_tests(tests, NULL, stic_test_clean_up);
}

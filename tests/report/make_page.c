/* make_page OUT SCENE TRACE FPS none|barcode|VIDEO [timing]: a review page without the renderer. `barcode`
 * is a video whose pictures carry their own number as 12 black or white squares, lowest bit first. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../src/io/trace_csv.h"
#include "../../src/scene_yaml.h"
#include "report.h"
#include "video.h"

#define WIDTH 640
#define HEIGHT 360
#define BITS 12
#define SQUARE 48 /* px */

static int fail(const stic_error *err)
{
  char text[1024];

  stic_error_format(err, text, sizeof text);
  fprintf(stderr, "make_page: %s\n", text);
  return (int)err->status;
}

static void draw_code(uint8_t *pixels, int number)
{
  for (int y = 0; y < HEIGHT; y++) {
    for (int x = 0; x < WIDTH; x++) {
      uint8_t *p = pixels + 4 * (y * WIDTH + x);
      const int bit = x / SQUARE;
      const bool code = y < SQUARE && bit < BITS;

      p[0] = code ? (number >> bit & 1 ? 255 : 0) : (uint8_t)((x + 3 * number) & 255);
      p[1] = code ? p[0] : (uint8_t)((y + 5 * number) & 255);
      p[2] = code ? p[0] : 128;
      p[3] = 255;
    }
  }
}

static stic_status make_barcode(const char *path, int64_t frames, int fps, stic_error *err)
{
  uint8_t *pixels = malloc((size_t)WIDTH * HEIGHT * 4);
  stic_video *video = NULL;
  stic_status status =
    pixels ? stic_video_create(path, WIDTH, HEIGHT, fps, false, &video, err) : STIC_NO_MEMORY;

  for (int64_t i = 0; i < frames && status == STIC_OK; i++) {
    const stic_image image = {WIDTH, HEIGHT, pixels};

    draw_code(pixels, (int)i);
    status = stic_video_add(video, &image, err);
  }
  if (status == STIC_OK)
    status = stic_video_finish(video, err);
  if (status == STIC_OK)
    status = stic_video_keep(video, err);
  stic_video_destroy(video);
  free(pixels);
  return status;
}

/* Replays the trace into the report; returns how long it took in the trace's own time. */
static stic_status replay(stic_report *report, const stic_scene *scene, const stic_settings *settings,
                          const char *trace_path, stic_timing *timing, int64_t *span_ns, stic_error *err)
{
  static stic_result result;
  stic_trace_reader *trace = NULL;
  stic_sim *sim = NULL;
  stic_sample sample;
  stic_trace_status got = STIC_TRACE_END;
  int64_t first = -1;
  stic_status status = stic_trace_open(trace_path, NULL, &trace, err);

  if (status == STIC_OK)
    status = stic_sim_create(scene, settings, &sim, err);
  while (status == STIC_OK && (got = stic_trace_next(trace, &sample, err)) == STIC_TRACE_SAMPLE) {
    const int64_t start = stic_clock_ns();
    const stic_event *events;
    int count;
    int64_t ns;

    stic_sim_step(sim, &sample, &result);
    ns = stic_clock_ns() - start;
    if (timing)
      stic_timing_add(timing, STIC_STAGE_FRAME, ns);
    events = stic_sim_events(sim, &count);
    stic_report_add(report, &result, events, count, timing ? ns : 0);
    first = first < 0 ? sample.t_ns : first;
    *span_ns = sample.t_ns - first;
  }
  if (got == STIC_TRACE_BAD)
    status = err->status;
  stic_sim_destroy(sim);
  stic_trace_close(trace);
  return status;
}

static stic_status make(char **argv, stic_timing *timing, stic_error *err)
{
  static stic_scene scene;
  stic_settings settings;
  stic_report_settings page = {argv[1], &scene,      &settings, argv[2], NULL, "trace",
                               argv[3], "make_page", NULL,      0,       0};
  stic_report *report = NULL;
  const char *video = strcmp(argv[5], "none") == 0 ? NULL : argv[5];
  char *text;
  int64_t span = 0;
  stic_status status = stic_scene_read_text(argv[2], NULL, 0, &scene, &text, err);

  stic_settings_init(&settings);
  page.scene_text = text;
  page.fps = atoi(argv[4]);
  if (status == STIC_OK)
    status = stic_report_open(&page, &report, err);
  if (status == STIC_OK)
    status = replay(report, &scene, &settings, argv[3], timing, &span, err);
  if (status == STIC_OK && video && strcmp(video, "barcode") == 0) {
    video = stic_report_video_path(report);
    status = make_barcode(video, (span / 1000 * page.fps + 1) / 1000000 + 1, page.fps, err);
  }
  if (status == STIC_OK)
    status = stic_report_finish(report, video, "none was asked for", timing, err);
  if (status == STIC_OK)
    status = stic_report_keep(report, err);
  stic_report_close(report);
  free(text);
  return status;
}

int main(int argc, char **argv)
{
  stic_timing *timing = argc > 6 ? stic_timing_create() : NULL;
  stic_error err;
  int code;

  if (argc < 6) {
    fprintf(stderr, "usage: make_page OUT SCENE TRACE FPS none|barcode|VIDEO [timing]\n");
    return STIC_USAGE;
  }
  code = make(argv, timing, &err) == STIC_OK ? 0 : fail(&err);
  free(timing);
  return code;
}

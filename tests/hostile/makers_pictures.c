/* Makers of pictures, videos, pages and windows. */
#include "../files/help.h"
#include "hud.h"
#include "makers.h"
#include "movie.h"
#include "overlay.h"
#include "png_encoder.h"
#include "png_writer.h"
#include "report.h"
#include "report_data.h"
#include "sheet.h"
#include "submit.h"
#include "theme.h"
#include "video.h"
#include "view.h"
#include "viewer.h"
#include "window.h"
#ifdef WITH_WINDOW
#include "../window/xvfb.h"
#endif

#include <stdlib.h>

enum { WIDTH = 160, HEIGHT = 120 };

static struct {
  stic_scene scene;
  stic_settings settings;
  stic_gl gl;
  const char *yaml;
#ifdef WITH_WINDOW
  stic_xvfb x;
#endif
} given;

static void set_up(void)
{
  given.yaml = stic_test_write("scene.yaml", stic_test_scene);
  assert_int_equal(stic_scene_read(given.yaml, NULL, 0, &given.scene, NULL), STIC_OK);
  stic_settings_init(&given.settings);
  assert_int_equal(stic_gl_open(&given.gl, STIC_GL_AUTO, NULL, NULL), STIC_OK);
#ifdef WITH_WINDOW
  stic_xvfb_start(&given.x);
#endif
}

static void tear_down(void)
{
  stic_gl_close(&given.gl);
#ifdef WITH_WINDOW
  stic_xvfb_stop(&given.x);
#endif
}

MAKE(png_writer, stic_png_writer_create, stic_png_writer, stic_png_writer_destroy, stic_test_folder(), WIDTH,
     HEIGHT, 3)
#ifdef WITH_VIDEO
MAKE(video, stic_video_create, stic_video, stic_video_destroy, stic_test_path("v.mkv"), WIDTH, HEIGHT, 31,
     false)
#endif

static stic_render_settings small(void)
{
  stic_render_settings settings;

  stic_render_settings_init(&settings);
  settings.width = WIDTH;
  settings.height = HEIGHT;
  return settings;
}

static stic_status make_gl(void **made, stic_error *err)
{
  static stic_gl gl;
  const stic_status status = stic_gl_open(&gl, STIC_GL_AUTO, NULL, err);

  *made = status == STIC_OK ? &gl : NULL;
  return status;
}

static void end_gl(void *made)
{
  stic_gl_close(made);
}

static stic_status make_submit(void **made, stic_error *err)
{
  static stic_submit submit;
  stic_status status;

  assert_true(stic_gl_make_current(&given.gl));
  status = stic_submit_init(&submit, &given.gl, WIDTH, HEIGHT, 1, err);
  *made = status == STIC_OK ? &submit : NULL;
  return status;
}

static void end_submit(void *made)
{
  stic_submit_free(made);
}

static stic_status make_render(void **made, stic_error *err)
{
  const stic_render_settings settings = small();
  stic_render *render = (stic_render *)(void *)&poison;
  const stic_status status = stic_render_create(&given.scene, &settings, &render, err);

  *made = render;
  return status;
}

static void end_render(void *made)
{
  stic_render_destroy(made);
}

static stic_status make_hud(void **made, stic_error *err)
{
  static stic_hud hud;
  const stic_render_settings settings = small();
  const bool good = stic_hud_init(&hud, &settings, &given.scene, &stic_theme_light);

  if (!good)
    stic_hud_free(&hud);
  *made = good ? &hud : NULL;
  return without_words(good, err);
}

static void end_hud(void *made)
{
  stic_hud_free(made);
}

static stic_status make_view(void **made, stic_error *err)
{
  static stic_view view;
  const stic_render_settings settings = small();
  const bool good = stic_view_init(&view, &given.scene, &settings, &stic_theme_light, WIDTH, HEIGHT);

  *made = good ? &view : NULL;
  return without_words(good, err);
}

static void end_view(void *made)
{
  stic_view_free(made);
}

static stic_status make_overlay(void **made, stic_error *err)
{
  static stic_overlay overlay;
  const bool good = stic_overlay_init(&overlay, WIDTH, HEIGHT, STIC_LOOK_DARK);

  if (!good)
    stic_overlay_free(&overlay);
  *made = good ? &overlay : NULL;
  return without_words(good, err);
}

static void end_overlay(void *made)
{
  stic_overlay_free(made);
}

static stic_status make_font(void **made, stic_error *err)
{
  *made = stic_font_create(true, 12);
  return without_words(*made != NULL, err);
}

static void end_font(void *made)
{
  stic_font_destroy(made);
}

static stic_status make_encoder(void **made, stic_error *err)
{
  *made = stic_png_encoder_create(1);
  return without_words(*made != NULL, err);
}

static void end_encoder(void *made)
{
  stic_png_encoder_destroy(made);
}

static stic_status make_sheet(void **made, stic_error *err)
{
  const stic_sheet_settings settings = {.columns = 2,
                                        .count = 3,
                                        .width = WIDTH,
                                        .height = HEIGHT,
                                        .look = STIC_LOOK_LIGHT,
                                        .title = "title",
                                        .subtitle = "subtitle"};
  stic_sheet *sheet = (stic_sheet *)(void *)&poison;
  const stic_status status = stic_sheet_create(&settings, &sheet, err);

  *made = sheet;
  return status;
}

static void end_sheet(void *made)
{
  stic_sheet_destroy(made);
}

static stic_status make_movie(void **made, stic_error *err)
{
  stic_movie_settings settings;
  stic_movie *movie = (stic_movie *)(void *)&poison;
  stic_status status;

  stic_movie_settings_init(&settings);
  settings.render = small();
  settings.folder = stic_test_path("frames");
#ifdef WITH_VIDEO
  settings.video = stic_test_path("v.mkv");
#endif
  status = stic_movie_open(&settings, &given.scene, &movie, err);
  *made = movie;
  return status;
}

static void end_movie(void *made)
{
  stic_movie_close(made);
}

static stic_status make_report(void **made, stic_error *err)
{
  const stic_report_settings settings = {.path = stic_test_path("page.html"),
                                         .scene = &given.scene,
                                         .solver = &given.settings,
                                         .scene_path = given.yaml,
                                         .scene_text = stic_test_scene,
                                         .input_kind = "trace",
                                         .input = "hand.csv",
                                         .command = "",
                                         .fps = 31};
  stic_report *report = (stic_report *)(void *)&poison;
  const stic_status status = stic_report_open(&settings, &report, err);

  if (status == STIC_OK)
    assert_non_null(stic_report_video_path(report));
  *made = report;
  return status;
}

static void end_report(void *made)
{
  stic_report_close(made);
}

static stic_status make_report_json(void **made, stic_error *err)
{
  const stic_report_video video = {.why = "none"};
  char *json = NULL;
  void *report;
  stic_status status = make_report(&report, err);

  if (status == STIC_OK) {
    status = stic_report_json(report, &video, NULL, &json, err);
    stic_report_close(report);
  }
  *made = json;
  return status;
}

static stic_status make_clean(void **made, stic_error *err)
{
  *made = stic_utf8_clean("\xff", 1);
  return without_words(*made != NULL, err);
}

#ifdef WITH_WINDOW
static stic_status make_window(void **made, stic_error *err)
{
  const stic_window_module *module;

  return stic_window_load(&module, made, err);
}

static void end_window(void *made)
{
  stic_window_unload(made);
}

static stic_status make_viewer(void **made, stic_error *err)
{
  const stic_viewer_settings settings = {.scene = &given.scene, .picture = small()};
  stic_viewer *viewer = (stic_viewer *)(void *)&poison;
  stic_status status;

  if (!given.x.display) /* none to be had: see stic_xvfb_start() */
    return make_window(made, err);
  status = stic_viewer_open(&settings, &viewer, err);
  *made = viewer;
  return status;
}

static void end_viewer(void *made)
{
  stic_viewer_close(made);
}
#endif

/* ---- the table ------------------------------------------------------------------------------- */

static const maker makers[] = {
  {"stic_gl_open", "", make_gl, end_gl},
  {"stic_submit_init", "", make_submit, end_submit},
  {"stic_render_create", "", make_render, end_render},
  {"stic_hud_init", "", make_hud, end_hud},
  {"stic_view_init", "", make_view, end_view},
  {"stic_overlay_init", "", make_overlay, end_overlay},
  {"stic_font_create", "", make_font, end_font},
  {"stic_png_encoder_create", "", make_encoder, end_encoder},
  {"stic_png_writer_create", "", make_png_writer, end_png_writer},
  {"stic_sheet_create", "", make_sheet, end_sheet},
  {"stic_movie_open", "", make_movie, end_movie},
  {"stic_report_open", "", make_report, end_report},
  {"stic_report_json", "", make_report_json, free},
  {"stic_utf8_clean", "", make_clean, free},
#ifdef WITH_VIDEO
  {"stic_video_create", "", make_video, end_video},
  {"stic_module_load", "", make_video, end_video},
#endif
#ifdef WITH_WINDOW
  {"stic_window_load", "", make_window, end_window},
  {"stic_viewer_open", "", make_viewer, end_viewer},
#endif
  {NULL, NULL, NULL, NULL},
};

const maker_group picture_makers = {set_up, tear_down, makers};

/* The window on a display in memory, with a user at the keyboard: what it shows is what the renderer draws. */
#include "xvfb.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "clock.h"
#include "scenes.h"
#include "viewer.h"

#define WIDTH 800
#define HEIGHT 600
#define WORDS_TALL 110 /* px below the legend where badges and hints may be */

typedef struct stage {
  stic_xvfb x; /* the group's */
  stic_scene scene;
  stic_latest *cell;
  stic_viewer *viewer;
  stic_render *render; /* draws the same rows beside it */
  stic_result row;
  int64_t drawn; /* pictures by then */
  bool ended;
} stage;

static stic_render_settings picture_settings(int width, int height, stic_look look)
{
  stic_render_settings settings;

  stic_render_settings_init(&settings);
  settings.width = width;
  settings.height = height;
  settings.look = look;
  return settings;
}

/* Lets the view run until `done` or for a minute: false. */
static bool run_until(stage *s, bool (*done)(stage *))
{
  const int64_t until_ns = stic_clock_ns() + INT64_C(60000000000);

  while (!done(s)) {
    if (s->ended || stic_clock_ns() > until_ns)
      return false;
    assert_int_equal(stic_viewer_turn(s->viewer, s->cell, &s->ended, NULL), STIC_OK);
  }
  return true;
}

static void run_for(stage *s, int ms)
{
  const int64_t until_ns = stic_clock_ns() + ms * INT64_C(1000000);

  while (!s->ended && stic_clock_ns() < until_ns)
    assert_int_equal(stic_viewer_turn(s->viewer, s->cell, &s->ended, NULL), STIC_OK);
}

static void feed(stage *s, double x, bool observe)
{
  stic_live_view_item *item = stic_latest_slot(s->cell);

  stic_test_edge(&s->row, s->row.t_ns + 30000000, x, 0.5);
  memset(item, 0, sizeof *item);
  item->result = s->row;
  item->state = STIC_CONNECTION_RUNNING;
  stic_latest_publish(s->cell);
  if (observe)
    stic_render_observe(s->render, &s->row);
}

/* Whether the window shows what `render` draws, but for the words on it. */
static bool shows_render(stage *s)
{
  int width, height, top;
  uint8_t *seen = stic_xvfb_grab(&s->x, &width, &height);
  stic_image image;
  bool same;

  assert_int_equal(stic_render_draw(s->render, &image, NULL), STIC_OK);
  top = stic_render_scene_area(s->render).y0 + WORDS_TALL;
  same = seen && width == image.width && height == image.height &&
         !memcmp(seen + (size_t)(top * width) * 4, image.pixels + (size_t)(top * width) * 4,
                 (size_t)(width * (height - top)) * 4);
  free(seen);
  return same;
}

static bool shows_other(stage *s)
{
  return !shows_render(s);
}

static int start_server(void **state)
{
  stage *s = calloc(1, sizeof *s);

  *state = s;
  stic_xvfb_start(&s->x);
  return 0;
}

static int stop_server(void **state)
{
  stage *s = *state;

  stic_xvfb_stop(&s->x);
  free(s);
  return 0;
}

static int set_up(void **state)
{
  stage *s = *state;
  stic_viewer_settings settings = {.scene = &s->scene};

  if (!s->x.display)
    return 0;
  stic_test_scene(&s->scene, true);
  strcpy(s->scene.name, "test");
  settings.picture = picture_settings(WIDTH, HEIGHT, STIC_LOOK_LIGHT);
  assert_int_equal(stic_latest_create(sizeof(stic_live_view_item), &s->cell, NULL), STIC_OK);
  assert_int_equal(stic_viewer_open(&settings, &s->viewer, NULL), STIC_OK);
  assert_int_equal(stic_render_create(&s->scene, &settings.picture, &s->render, NULL), STIC_OK);
  assert_true(stic_xvfb_find_window(&s->x));
  return 0;
}

static int tear_down(void **state)
{
  stage *s = *state;

  stic_viewer_close(s->viewer);
  stic_render_destroy(s->render);
  stic_latest_destroy(s->cell);
  *s = (stage){.x = {.server = s->x.server, .display = s->x.display}};
  return 0;
}

/* The test's stage; skips where there is no display to be had. */
static stage *stage_of(void **state)
{
  stage *s = *state;

  if (!s->viewer) {
    print_message("no Xvfb here: skipped\n");
    skip();
  }
  return s;
}

/* A while without a picture. */
static bool is_at_rest(stage *s)
{
  const int64_t before = stic_viewer_pictures(s->viewer);

  run_for(s, 200);
  return stic_viewer_pictures(s->viewer) == before;
}

static bool has_drawn(stage *s)
{
  return stic_viewer_pictures(s->viewer) > s->drawn;
}

static void test_shows_newest(void **state)
{
  stage *s = stage_of(state);

  for (int i = 0; i < 5; i++) {
    feed(s, 0.2 + 0.004 * i, true);
    assert_true(run_until(s, shows_render));
  }
  /* It draws only when there is news. */
  assert_true(run_until(s, is_at_rest));
}

static void test_pause(void **state)
{
  stage *s = stage_of(state);

  feed(s, 0.2, true);
  assert_true(run_until(s, shows_render));
  assert_true(run_until(s, is_at_rest));
  s->drawn = stic_viewer_pictures(s->viewer);
  stic_xvfb_key(&s->x, "space");
  assert_true(run_until(s, has_drawn)); /* that it is held */
  feed(s, 0.3, false);
  feed(s, 0.25, false);
  run_for(s, 200);
  assert_true(shows_render(s)); /* still the old one */
  stic_xvfb_key(&s->x, "space");
  stic_render_observe(s->render, &s->row);
  assert_true(run_until(s, shows_render));
}

static void test_keys(void **state)
{
  static const char *const keys[] = {"h", "F1", "d", "t"}; /* there and back again */
  stage *s = stage_of(state);

  for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
    for (int k = 0; k < 4; k++) { /* a trail */
      feed(s, 0.2 + 0.02 * k, true);
      assert_true(run_until(s, shows_render));
    }
    stic_xvfb_key(&s->x, keys[i]);
    assert_true(run_until(s, shows_other));
    stic_xvfb_key(&s->x, keys[i]);
    assert_true(run_until(s, shows_render));
  }
  for (int i = 0; i < 3; i++) {
    stic_xvfb_key(&s->x, "c");
    assert_true(run_until(s, i < 2 ? shows_other : shows_render));
  }
}

static void test_resize(void **state)
{
  const stic_render_settings settings = picture_settings(1000, 700, STIC_LOOK_LIGHT);
  stage *s = stage_of(state);
  stic_render *larger;

  feed(s, 0.2, true);
  assert_true(run_until(s, shows_render));
  XResizeWindow(s->x.display, s->x.window, 1001, 700); /* odd: a picture's sides are even */
  XSync(s->x.display, False);
  run_for(s, 100);
  XResizeWindow(s->x.display, s->x.window, 1000, 700);
  XSync(s->x.display, False);
  assert_int_equal(stic_render_create(&s->scene, &settings, &larger, NULL), STIC_OK);
  stic_render_continue(larger, s->render);
  stic_render_destroy(s->render);
  s->render = larger;
  assert_true(run_until(s, shows_render));
}

static bool has_saved_one(stage *s)
{
  (void)s;
  return access("stiction-0001.png", F_OK) == 0;
}

static bool has_saved_two(stage *s)
{
  (void)s;
  return access("stiction-0002.png", F_OK) == 0;
}

static void test_screenshot(void **state)
{
  stage *s = stage_of(state);
  char folder[] = "/tmp/stiction-view-XXXXXX", here[4096];
  char magic[4] = "";
  FILE *file;

  assert_non_null(getcwd(here, sizeof here));
  assert_non_null(mkdtemp(folder));
  assert_int_equal(chdir(folder), 0);
  feed(s, 0.2, true);
  stic_xvfb_key(&s->x, "s");
  assert_true(run_until(s, has_saved_one));
  stic_xvfb_key(&s->x, "s");
  assert_true(run_until(s, has_saved_two));
  file = fopen("stiction-0001.png", "rb");
  assert_non_null(file);
  assert_int_equal(fread(magic, 1, 4, file), 4);
  assert_memory_equal(magic, "\x89PNG", 4);
  fclose(file);
  remove("stiction-0001.png");
  remove("stiction-0002.png");
  assert_int_equal(chdir(here), 0);
  rmdir(folder);
}

static bool has_ended(stage *s)
{
  return s->ended;
}

static void test_end(void **state)
{
  stage *s = stage_of(state);
  XEvent event;

  stic_xvfb_key(&s->x, "x"); /* means nothing */
  run_for(s, 100);
  assert_false(s->ended);
  stic_xvfb_key(&s->x, "q");
  assert_true(run_until(s, has_ended));
  s->ended = false;
  stic_viewer_close(s->viewer);
  {
    stic_viewer_settings settings = {.scene = &s->scene};

    settings.picture = picture_settings(WIDTH, HEIGHT, STIC_LOOK_DARK);
    assert_int_equal(stic_viewer_open(&settings, &s->viewer, NULL), STIC_OK);
  }
  s->x.window = 0;
  assert_true(stic_xvfb_find_window(&s->x));
  memset(&event, 0, sizeof event);
  event.xclient.type = ClientMessage;
  event.xclient.window = s->x.window;
  event.xclient.message_type = XInternAtom(s->x.display, "WM_PROTOCOLS", False);
  event.xclient.format = 32;
  event.xclient.data.l[0] = (long)XInternAtom(s->x.display, "WM_DELETE_WINDOW", False);
  XSendEvent(s->x.display, s->x.window, False, NoEventMask, &event);
  XSync(s->x.display, False);
  assert_true(run_until(s, has_ended));
}

static void test_no_display(void **state)
{
  stage *s = stage_of(state);
  stic_viewer_settings settings = {.scene = &s->scene};
  stic_viewer *viewer;
  char name[40];
  stic_error err;

  snprintf(name, sizeof name, "%s", getenv("DISPLAY"));
  stic_viewer_close(s->viewer);
  s->viewer = NULL;
  setenv("DISPLAY", "", 1);
  settings.picture = picture_settings(WIDTH, HEIGHT, STIC_LOOK_DARK);
  assert_int_equal(stic_viewer_open(&settings, &viewer, &err), STIC_CANNOT_WRITE);
  assert_null(viewer);
  assert_non_null(strstr(err.message, "cannot open a window: "));
  assert_non_null(strstr(err.message, "; set DISPLAY or leave out --view"));
  setenv("DISPLAY", name, 1);
}

#define WITH_STAGE(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)

int main(void)
{
  const struct CMUnitTest tests[] = {
    WITH_STAGE(test_shows_newest), WITH_STAGE(test_pause),      WITH_STAGE(test_keys),
    WITH_STAGE(test_resize),       WITH_STAGE(test_screenshot), WITH_STAGE(test_end),
    WITH_STAGE(test_no_display),
  };

  return cmocka_run_group_tests_name("viewer", tests, start_server, stop_server);
}

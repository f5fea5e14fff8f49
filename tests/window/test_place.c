/* The hand is where the pointer is: the way back from a pixel, against the pictures themselves. No window. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "../../drivers/mouse/mouse_hand.h"
#include "mesh.h"
#include "render.h"
#include "scenes.h"

static const int sizes[][2] = {{1280, 720}, {800, 600}, {420, 700}};

static stic_render *make(stic_camera_preset camera, const int size[2])
{
  stic_render_settings settings;
  stic_scene scene;
  stic_render *render;

  stic_test_scene(&scene, true);
  stic_render_settings_init(&settings);
  settings.width = size[0];
  settings.height = size[1];
  settings.camera = camera;
  settings.quality = STIC_QUALITY_FAST;
  assert_int_equal(stic_render_create(&scene, &settings, &render, NULL), STIC_OK);
  return render;
}

static void draw(stic_render *render, const stic_result *result)
{
  stic_image image;

  stic_render_observe(render, result);
  assert_int_equal(stic_render_draw(render, &image, NULL), STIC_OK);
}

/* What the picture has at a pixel of it. */
static unsigned id_at(stic_render *render, const double pixel[2])
{
  static uint16_t ids[1280 * 720], depths[1280 * 720];
  const stic_rect area = stic_render_scene_area(render);
  int width, height;

  assert_int_equal(
    stic_render_identify(render, ids, depths, sizeof ids / sizeof ids[0], &width, &height, NULL), STIC_OK);
  assert_true(pixel[0] >= 0 && pixel[0] < width && pixel[1] >= area.y0 && pixel[1] < area.y1);
  return ids[((int)pixel[1] - area.y0) * width + (int)pixel[0]];
}

/* The hand that stic_mouse_hand_point() puts under a pixel is drawn there. */
static void check_pixel(stic_render *render, stic_result *result, const double pixel[2])
{
  stic_mouse_hand hand = {{0, 0, result->hand_z}, 0, 0};
  double eye[3], through[3], shift, seen[2];

  stic_render_ray(render, pixel, eye, through);
  shift = hand.position[2] - through[2];
  eye[2] += shift;
  through[2] += shift;
  stic_mouse_hand_point(&hand, eye, through);
  result->hand_x = hand.position[0];
  result->hand_y = hand.position[1];
  result->t_ns += 20000000;
  draw(render, result);
  stic_render_hand_pixel(render, seen);
  assert_true(fabs(seen[0] - pixel[0]) < 1e-6 && fabs(seen[1] - pixel[1]) < 1e-6);
  assert_int_equal(id_at(render, pixel), STIC_ID_HAND);
}

static void test_under_pointer(void **state)
{
  (void)state;
  for (int preset = STIC_CAMERA_THREE_QUARTER; preset <= STIC_CAMERA_FOLLOW; preset++) {
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
      stic_render *render = make((stic_camera_preset)preset, sizes[i]);
      stic_result result;
      double home[2];

      stic_test_free(&result, 0, 0.2, 0.12, 0.1);
      result.z = result.hand_z = 0.02;
      draw(render, &result);
      stic_render_hand_pixel(render, home);
      for (int k = 0; k < 9; k++) {
        const double step = sizes[i][0] * 0.04;
        const double pixel[2] = {floor(home[0] + step * (k % 3 - 1)) + 0.5,
                                 floor(home[1] + step * (k / 3 - 1)) + 0.5};

        check_pixel(render, &result, pixel);
      }
      stic_render_destroy(render);
    }
  }
}

/* Outside the scene the pointer counts as at its border. */
static void test_border(void **state)
{
  stic_render *render = make(STIC_CAMERA_THREE_QUARTER, sizes[0]);
  const double below[2] = {300, 715}, left[2] = {-40, 300};
  double eye[3], p[3], q[3];
  stic_result result;
  stic_rect area;

  (void)state;
  stic_test_free(&result, 0, 0.2, 0.12, 0);
  draw(render, &result);
  area = stic_render_scene_area(render);
  assert_true(area.y0 > 0 && area.y1 < 720 && area.x1 == 1280);
  stic_render_ray(render, below, eye, p);
  stic_render_ray(render, (double[2]){300, area.y1}, eye, q);
  assert_memory_equal(p, q, sizeof p);
  stic_render_ray(render, left, eye, p);
  stic_render_ray(render, (double[2]){0, 300}, eye, q);
  assert_memory_equal(p, q, sizeof p);
  stic_render_destroy(render);
}

/* A renderer that goes on from another one draws what a single one would have drawn. */
static void test_continue(void **state)
{
  stic_render *one = make(STIC_CAMERA_THREE_QUARTER, sizes[1]), *first = make(STIC_CAMERA_FRONT, sizes[2]);
  stic_render *second;
  stic_image a, b;
  stic_result r;

  (void)state;
  for (int i = 0; i < 40; i++) {
    stic_test_edge(&r, i * INT64_C(30000000), 0.2 + 0.01 * i, 0.5); /* leaves the first camera's view */
    stic_render_observe(one, &r);
    stic_render_observe(first, &r);
    assert_int_equal(stic_render_draw(one, &a, NULL), STIC_OK);
    assert_int_equal(stic_render_draw(first, &b, NULL), STIC_OK);
  }
  second = make(STIC_CAMERA_THREE_QUARTER, sizes[1]);
  stic_render_continue(second, first);
  assert_int_equal(stic_render_draw(second, &b, NULL), STIC_OK);
  assert_int_equal(a.width, b.width);
  assert_memory_equal(a.pixels, b.pixels, (size_t)a.width * (size_t)a.height * 4);
  stic_render_set_trails(second, false);
  assert_int_equal(stic_render_draw(second, &b, NULL), STIC_OK);
  assert_memory_not_equal(a.pixels, b.pixels, (size_t)a.width * (size_t)a.height * 4);
  stic_render_destroy(one);
  stic_render_destroy(first);
  stic_render_destroy(second);
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_under_pointer), cmocka_unit_test(test_border),
                                     cmocka_unit_test(test_continue)};

  return cmocka_run_group_tests_name("place", tests, NULL, NULL);
}

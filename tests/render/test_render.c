#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <dirent.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <png.h>

#include "camera.h"
#include "golden.h"
#include "history.h"
#include "hud.h"
#include "mesh.h"
#include "movie.h"
#include "png_writer.h"
#include "scenes.h"
#include "video.h"
#include "view.h"

#if defined(STIC_WITH_LIBAV)
#include <libavformat/avformat.h>
#endif

#define MS INT64_C(1000000)

/* ---- helpers ------------------------------------------------------------------------------- */

static stic_render *make_render(const stic_scene *scene, int width, int height, stic_quality quality,
                                const stic_extent *extent)
{
  stic_render_settings settings;
  stic_render *render;
  stic_error err = {0};

  stic_render_settings_init(&settings);
  settings.width = width;
  settings.height = height;
  settings.quality = quality;
  settings.extent = extent;
  if (stic_render_create(scene, &settings, &render, &err))
    fail_msg("%s", err.message);
  return render;
}

/* A copy, to be freed, of what the renderer draws now. */
static stic_image draw_copy(stic_render *render)
{
  stic_image image;
  stic_error err = {0};
  uint8_t *pixels;
  size_t size;

  if (stic_render_draw(render, &image, &err))
    fail_msg("%s", err.message);
  size = (size_t)image.width * (size_t)image.height * 4;
  pixels = malloc(size);
  assert_non_null(pixels);
  memcpy(pixels, image.pixels, size);
  image.pixels = pixels;
  return image;
}

static bool identical(const stic_image *a, const stic_image *b)
{
  return a->width == b->width && a->height == b->height &&
         !memcmp(a->pixels, b->pixels, (size_t)a->width * (size_t)a->height * 4);
}

static void free_image(stic_image *image)
{
  free((void *)(uintptr_t)image->pixels);
}

/* What the named fixture shows, drawn at 320 x 240. */
static stic_render *fixture(const char *name)
{
  stic_scene scene;
  stic_result r;
  stic_extent extent;
  stic_render *render;

  stic_test_scene(&scene, strcmp(name, "edge") != 0);
  if (!strcmp(name, "two-vertex"))
    stic_test_two_vertex(&r, 0, 0.6);
  else if (!strcmp(name, "free"))
    stic_test_free(&r, 0, 0.2, 0.12, 0.3);
  else
    stic_test_edge(&r, 0, 0.2, 0.99);
  stic_extent_init(&extent);
  stic_extent_add(&extent, &scene, &r);
  render = make_render(&scene, 320, 240, STIC_QUALITY_GOOD, &extent);
  stic_render_observe(render, &r);
  return render;
}

static const char *const fixtures[] = {"edge", "two-vertex", "free"};
enum { FIXTURES = sizeof fixtures / sizeof fixtures[0] };

/* A fresh folder's name in `path`. */
static void make_folder(char path[64])
{
  strcpy(path, "/tmp/stic-render-XXXXXX");
  assert_non_null(mkdtemp(path));
}

static int count_entries(const char *folder)
{
  DIR *dir = opendir(folder);
  int count = 0;

  assert_non_null(dir);
  while (readdir(dir))
    count++;
  closedir(dir);
  return count - 2;
}

static void remove_folder(const char *folder)
{
  DIR *dir = opendir(folder);
  const struct dirent *entry;

  assert_non_null(dir);
  while ((entry = readdir(dir)) != NULL)
    unlinkat(dirfd(dir), entry->d_name, 0);
  closedir(dir);
  assert_int_equal(rmdir(folder), 0);
}

static void movie_settings(stic_movie_settings *s, const char *folder, int fps)
{
  stic_movie_settings_init(s);
  s->render.width = 160;
  s->render.height = 120;
  s->render.quality = STIC_QUALITY_FAST;
  s->folder = folder;
  s->fps = fps;
}

/* A movie of results `step_ns` apart; where the box is says which result a picture shows. */
static stic_status run_movie(const stic_movie_settings *settings, int results, int64_t step_ns,
                             int64_t *count, stic_error *err)
{
  stic_scene scene;
  stic_movie *movie;
  stic_result r;
  stic_status status;

  stic_test_scene(&scene, false);
  status = stic_movie_open(settings, &scene, &movie, err);
  for (int i = 0; !status && i < results; i++) {
    stic_test_edge(&r, 5 * MS + i * step_ns, 0.2 + 0.001 * i, 0);
    if (i)
      status = stic_movie_before(movie, r.t_ns, err);
    if (!status)
      stic_movie_observe(movie, &r);
  }
  if (!status)
    status = stic_movie_finish(movie, err);
  if (!status)
    status = stic_movie_keep(movie, err);
  if (!status)
    *count = stic_movie_count(movie);
  stic_movie_close(movie);
  return status;
}

/* ---- arithmetic ---------------------------------------------------------------------------- */

static void test_camera_shows_the_box(void **state)
{
  const double low[3] = {-0.3, -0.1, -0.2}, high[3] = {0.9, 0.5, 0.1}, aside[2] = {0.4, 0.3};
  stic_camera camera;
  float m[16];

  (void)state;
  stic_camera_fit(&camera, aside, low, high, 640, 340, 0.03);
  stic_camera_matrix(&camera, (double[3]){0.1, 0.2, 0.3}, 2, m);
  for (int i = 0; i < 8; i++) {
    double p[3], pixel[2], clip[4];

    for (int k = 0; k < 3; k++)
      p[k] = i >> k & 1 ? high[k] : low[k];
    stic_camera_project(&camera, p, pixel);
    assert_true(pixel[0] > 15 && pixel[0] < 625 && pixel[1] > 8 && pixel[1] < 332);
    for (int k = 0; k < 4; k++)
      clip[k] =
        m[k] * (p[0] - 0.1) / 2 + m[4 + k] * (p[1] - 0.2) / 2 + m[8 + k] * (p[2] - 0.3) / 2 + m[12 + k];
    assert_true(fabs((clip[0] / clip[3] + 1) * 320 - pixel[0]) < 0.01);
    assert_true(fabs((clip[1] / clip[3] + 1) * 170 - pixel[1]) < 0.01);
    assert_true(fabs(clip[2] / clip[3]) < 1);
  }
}

static void test_plane_is_to_scale(void **state)
{
  const double low[3] = {0, 0, -0.1}, high[3] = {1, 1, 0.1}, aside[2] = {0.4, 0.3};
  stic_camera camera;
  double a[2], b[2], c[2];

  (void)state;
  stic_camera_fit(&camera, aside, low, high, 640, 480, 0.03);
  stic_camera_project(&camera, (double[3]){0.2, 0.2, 0}, a);
  stic_camera_project(&camera, (double[3]){0.7, 0.2, 0}, b);
  stic_camera_project(&camera, (double[3]){0.2, 0.7, 0}, c);
  assert_true(fabs(a[1] - b[1]) < 1e-9 && fabs(a[0] - c[0]) < 1e-9);
  assert_true(fabs((b[0] - a[0]) - (a[1] - c[1])) < 1e-9);
}

static void test_round_up_125(void **state)
{
  (void)state;
  assert_true(fabs(stic_round_up_125(0.11) - 0.2) < 1e-12);
  assert_true(fabs(stic_round_up_125(2.0) - 2.0) < 1e-12);
  assert_true(fabs(stic_round_up_125(2.01) - 5.0) < 1e-12);
  assert_true(fabs(stic_round_up_125(700) - 1000) < 1e-9);
}

static void test_history_sees_slips(void **state)
{
  stic_history *h = calloc(1, sizeof *h);
  stic_result r;

  (void)state;
  assert_non_null(h);
  h->size = 0.18;
  stic_test_edge(&r, 0, 0.2, 0.5);
  stic_history_add(h, &r);
  stic_test_edge(&r, 32 * MS, 0.2, 0.9);
  stic_history_add(h, &r);
  assert_int_equal(h->slip_count, 0);
  stic_test_edge(&r, 64 * MS, 0.21, 0.6);
  stic_history_add(h, &r);
  assert_int_equal(h->slip_count, 2);
  assert_true(stic_history_slipping(h, 0, 0));
  stic_test_edge(&r, 400 * MS, 0.21, 0.7);
  stic_history_add(h, &r);
  assert_false(stic_history_slipping(h, 0, 0));
  /* Rings keep the newest. */
  for (int i = 0; i < 3000; i++) {
    stic_test_edge(&r, (500 + i) * MS, 0.21 + 0.01 * i, 0.6);
    stic_history_add(h, &r);
  }
  assert_int_equal(h->slip_count, STIC_SLIPS_MAX);
  assert_true(stic_history_curve(h, h->curve_count - 1)->t > stic_history_curve(h, 0)->t);
  free(h);
}

static void test_labels_do_not_overlap(void **state)
{
  stic_render_settings settings;
  stic_labels labels = {0};
  stic_rect areas[STIC_LABELS_MAX];
  stic_scene scene;
  stic_hud hud;

  (void)state;
  stic_test_scene(&scene, false);
  stic_render_settings_init(&settings);
  settings.width = 640;
  settings.height = 480;
  assert_true(stic_hud_init(&hud, &settings, &scene, &stic_theme_light));
  for (int i = 0; i < 12; i++)
    stic_labels_add(&labels, (double[2]){300 + 3 * i, 150}, 1, 0.2 * i, 4, stic_theme_light.text, true,
                    "normal 1.23 N");
  stic_hud_place_labels(&hud, &labels, 0, areas);
  for (int i = 0; i < labels.count; i++) {
    for (int k = 0; k < i; k++)
      assert_true(stic_rect_empty(stic_rect_intersect(areas[i], areas[k])));
  }
  stic_hud_free(&hud);
}

/* ---- pictures ------------------------------------------------------------------------------ */

static void judge(stic_verdict verdict, const char *name, const char *rasteriser)
{
  const char *required = getenv("STIC_GOLDEN_REQUIRED");

  if (verdict == STIC_DIFFERENT)
    fail_msg("%s differs from its golden for %s", name, rasteriser);
  if (verdict == STIC_NO_GOLDEN && required && !strcmp(required, "1"))
    fail_msg("there is no golden %s for %s", name, rasteriser);
  if (verdict == STIC_NO_GOLDEN)
    print_message("no golden %s for %s: not compared\n", name, rasteriser);
}

static void test_identity_is_exact(void **state)
{
  enum { PIXELS = 320 * 240 };
  static uint16_t ids[PIXELS], depth[PIXELS];

  (void)state;
  for (int i = 0; i < FIXTURES; i++) {
    stic_render *render = fixture(fixtures[i]);
    int width, height;
    char name[64];

    assert_int_equal(stic_render_identify(render, ids, depth, PIXELS, &width, &height, NULL), STIC_OK);
    snprintf(name, sizeof name, "%s-ids", fixtures[i]);
    judge(
      stic_golden_hash(name, stic_render_rasteriser(render), stic_hash(ids, (size_t)(width * height) * 2)),
      name, stic_render_rasteriser(render));
    snprintf(name, sizeof name, "%s-depth", fixtures[i]);
    judge(
      stic_golden_hash(name, stic_render_rasteriser(render), stic_hash(depth, (size_t)(width * height) * 2)),
      name, stic_render_rasteriser(render));
    stic_render_destroy(render);
  }
}

static int count_id(const uint16_t *ids, int count, unsigned id)
{
  int found = 0;

  for (int i = 0; i < count; i++)
    found += ids[i] == id;
  return found;
}

static void test_everything_is_seen(void **state)
{
  enum { PIXELS = 320 * 240 };
  static const unsigned expected[] = {STIC_ID_OBJECT,      STIC_ID_SPRING,       STIC_ID_HAND,
                                      STIC_ID_HOLDING,     STIC_ID_NORMAL,       STIC_ID_NORMAL + 1,
                                      STIC_ID_FRICTION,    STIC_ID_FRICTION + 1, STIC_ID_CONTACT,
                                      STIC_ID_CONTACT + 1, STIC_ID_SURFACE,      STIC_ID_SURFACE + 1};
  static uint16_t ids[PIXELS], depth[PIXELS];
  stic_render *render = fixture("two-vertex");
  int width, height;

  (void)state;
  assert_int_equal(stic_render_identify(render, ids, depth, PIXELS, &width, &height, NULL), STIC_OK);
  for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++) {
    if (count_id(ids, width * height, expected[i]) < 3)
      fail_msg("id %u is not seen", expected[i]);
  }
  assert_int_equal(stic_render_identify(render, ids, depth, 10, &width, &height, NULL), STIC_USAGE);
  stic_render_destroy(render);
}

static void test_egl_gives_the_same(void **state)
{
  enum { PIXELS = 320 * 240 };
  static uint16_t ids[2][PIXELS], depth[2][PIXELS];
  stic_render_settings settings;
  stic_scene scene;
  stic_result r;

  (void)state;
  stic_test_scene(&scene, true);
  stic_test_two_vertex(&r, 0, 0.6);
  stic_render_settings_init(&settings);
  settings.width = 320;
  settings.height = 240;
  for (int i = 0; i < 2; i++) {
    stic_render *render;
    int width, height;

    settings.backend = i ? STIC_GL_EGL : STIC_GL_OSMESA;
    if (stic_render_create(&scene, &settings, &render, NULL)) {
      print_message("one of OSMesa and EGL is missing: not compared\n");
      return;
    }
    stic_render_observe(render, &r);
    assert_int_equal(stic_render_identify(render, ids[i], depth[i], PIXELS, &width, &height, NULL), STIC_OK);
    stic_render_destroy(render);
  }
  assert_memory_equal(ids[0], ids[1], sizeof ids[0]);
  assert_memory_equal(depth[0], depth[1], sizeof depth[0]);
}

static void test_golden_pictures(void **state)
{
  (void)state;
  for (int i = 0; i < FIXTURES; i++) {
    stic_render *render = fixture(fixtures[i]);
    stic_image image = draw_copy(render);

    judge(stic_golden_picture(fixtures[i], stic_render_rasteriser(render), &image), fixtures[i],
          stic_render_rasteriser(render));
    free_image(&image);
    stic_render_destroy(render);
  }
}

/* A control: stick against slip, and friction to the left against to the right, are different pictures. */
static void test_pictures_are_told_apart(void **state)
{
  stic_scene scene;
  stic_result r;
  stic_extent extent;
  stic_image images[3];

  (void)state;
  stic_test_scene(&scene, false);
  stic_extent_init(&extent);
  stic_test_edge(&r, 0, 0.2, 0.8);
  stic_extent_add(&extent, &scene, &r);
  for (int i = 0; i < 3; i++) {
    stic_render *render = make_render(&scene, 320, 240, STIC_QUALITY_GOOD, &extent);

    stic_test_edge(&r, 0, i == 1 ? 0.199 : 0.2, 0.8);
    stic_render_observe(render, &r);
    stic_test_edge(&r, 32 * MS, 0.2, i == 2 ? -0.8 : 0.8);
    stic_render_observe(render, &r);
    images[i] = draw_copy(render);
    stic_render_destroy(render);
  }
  assert_true(stic_pictures_agree(&images[0], &images[0]));
  assert_false(stic_pictures_agree(&images[0], &images[1]));
  assert_false(stic_pictures_agree(&images[0], &images[2]));
  for (int i = 0; i < 3; i++)
    free_image(&images[i]);
}

/* Only what changes is drawn again; the result must be as if all had been. */
static void test_partial_drawing_is_complete(void **state)
{
  static const stic_quality qualities[] = {STIC_QUALITY_FAST, STIC_QUALITY_GOOD, STIC_QUALITY_BEST};
  stic_scene scene;
  stic_extent extent;
  stic_result r;

  (void)state;
  stic_test_scene(&scene, true);
  stic_extent_init(&extent);
  for (int i = 0; i < 6; i++) {
    stic_test_edge(&r, 0, 0.15 + 0.05 * i, -0.9);
    stic_extent_add(&extent, &scene, &r);
  }
  for (size_t q = 0; q < 3; q++) {
    stic_render *bit_by_bit = make_render(&scene, 320, 240, qualities[q], &extent);
    stic_render *at_once = make_render(&scene, 320, 240, qualities[q], &extent);
    stic_image a = {0}, b;

    for (int i = 0; i < 6; i++) {
      stic_test_edge(&r, i * 32 * MS, 0.15 + 0.05 * i, i % 2 ? -0.9 : 0.4);
      stic_render_observe(bit_by_bit, &r);
      stic_render_observe(at_once, &r);
      free_image(&a);
      a = draw_copy(bit_by_bit);
    }
    b = draw_copy(at_once);
    assert_true(identical(&a, &b));
    free_image(&a);
    free_image(&b);
    stic_render_destroy(bit_by_bit);
    stic_render_destroy(at_once);
  }
}

/* Far hands, many surfaces, slopes, slots: nothing breaks. */
static void test_odd_scenes(void **state)
{
  static const stic_camera_preset presets[] = {STIC_CAMERA_THREE_QUARTER, STIC_CAMERA_FRONT,
                                               STIC_CAMERA_FOLLOW};
  stic_render_settings settings;
  stic_scene scene;
  stic_result r;

  (void)state;
  stic_render_settings_init(&settings);
  settings.width = 160;
  settings.height = 120;
  settings.quality = STIC_QUALITY_FAST;
  stic_test_scene(&scene, true);
  scene.surface_count = 200;
  for (int i = 0; i < 200; i++) {
    double angle = i * 1.8 * 3.14159265358979 / 180;

    scene.surfaces[i] = (stic_surface){
      .normal_deg = i * 1.8, .point = {0.2 - cos(angle), 0.1 - sin(angle)}, .friction = {0.5, 0.3}};
  }
  for (int i = 0; i < 3; i++) {
    stic_render *render;
    stic_image image;

    settings.camera = presets[i];
    settings.look = i == 1 ? STIC_LOOK_DARK : STIC_LOOK_LIGHT;
    assert_int_equal(stic_render_create(&scene, &settings, &render, NULL), STIC_OK);
    for (int k = 0; k < 3; k++) {
      stic_test_edge(&r, k * 32 * MS, 0.2, 0.5);
      r.hand_x = k == 1 ? 1e9 : 0.2;
      r.contacts[1].surface = 199;
      r.contacts[1].normal = k == 2 ? 1e6 : 1;
      r.state = k == 2 ? STIC_RELEASED : STIC_MULTI;
      stic_render_observe(render, &r);
      assert_int_equal(stic_render_draw(render, &image, NULL), STIC_OK);
    }
    stic_render_destroy(render);
  }
}

/* Objects of a nanometre and of a million kilometres look alike. */
static void test_any_size(void **state)
{
  static const double sizes[] = {1e-9, 1, 1e9};
  enum { PIXELS = 320 * 240 };
  static uint16_t ids[PIXELS], depth[PIXELS];
  int seen[3];

  (void)state;
  for (int i = 0; i < 3; i++) {
    stic_scene scene;
    stic_result r;
    stic_render *render;
    double s = sizes[i];
    int width, height;

    stic_test_scene(&scene, false);
    stic_test_edge(&r, 0, 0.2, 0.5);
    for (int k = 0; k < scene.vertex_count; k++) {
      scene.vertices[k][0] *= s;
      scene.vertices[k][1] *= s;
    }
    scene.depth *= s;
    scene.x = r.x = r.holding_x = 0.2 * s;
    scene.y = r.y = r.holding_y = 0.04 * s;
    r.hand_x *= s;
    r.hand_y *= s;
    for (int k = 0; k < 2; k++)
      r.contacts[k].x *= s;
    render = make_render(&scene, 320, 240, STIC_QUALITY_FAST, NULL);
    stic_render_observe(render, &r);
    assert_int_equal(stic_render_identify(render, ids, depth, PIXELS, &width, &height, NULL), STIC_OK);
    seen[i] = count_id(ids, width * height, STIC_ID_OBJECT);
    stic_render_destroy(render);
  }
  assert_true(seen[1] > 500);
  assert_true(abs(seen[0] - seen[1]) < seen[1] / 5 && abs(seen[2] - seen[1]) < seen[1] / 5);
}

static void test_texts(void **state)
{
  char text[32];

  (void)state;
  stic_force_text(0, text, sizeof text);
  assert_string_equal(text, "0.00");
  stic_force_text(0.00123, text, sizeof text);
  assert_string_equal(text, "0.0012");
  stic_force_text(-9.999, text, sizeof text);
  assert_string_equal(text, "-10.0");
  stic_force_text(1234.4, text, sizeof text);
  assert_string_equal(text, "1234");
  assert_int_equal(stic_decimals(0.05), 2);
  assert_int_equal(stic_decimals(0.1), 1);
  assert_int_equal(stic_decimals(20), 0);
}

static void test_names(void **state)
{
  stic_render_settings s;

  (void)state;
  stic_render_settings_init(&s);
  assert_true(stic_look_from_name("dark", &s.look) && s.look == STIC_LOOK_DARK);
  assert_true(stic_camera_from_name("follow", &s.camera) && s.camera == STIC_CAMERA_FOLLOW);
  assert_true(stic_quality_from_name("best", &s.quality) && s.quality == STIC_QUALITY_BEST);
  assert_true(stic_plot_from_name("angle", &s.plot) && s.plot == STIC_PLOT_ANGLE);
  assert_false(stic_plot_from_name("z", &s.plot));
  assert_int_equal(s.plot, STIC_PLOT_ANGLE);
}

/* ---- movies -------------------------------------------------------------------------------- */

static void test_frame_count_rule(void **state)
{
  static const struct {
    int fps, results;
    int64_t step_ns, expected; /* floor(T fps) + 1 */
  } cases[] = {{31, 1, 10 * MS, 1},    {31, 101, 10 * MS, 32}, {30, 4, 100 * MS, 10}, {10, 11, 100 * MS, 11},
               {10, 11, 99999999, 10}, {1, 2, 2500 * MS, 3},   {3, 4, 333333333, 3},  {3, 4, 333333334, 4}};
  stic_movie_settings settings;
  stic_error err = {0};

  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    int64_t count = -1;

    movie_settings(&settings, NULL, cases[i].fps);
    assert_int_equal(run_movie(&settings, cases[i].results, cases[i].step_ns, &count, &err), STIC_OK);
    assert_int_equal(count, cases[i].expected);
  }
}

static stic_image read_png(const char *path)
{
  png_image file;
  uint8_t *pixels;

  memset(&file, 0, sizeof file);
  file.version = PNG_IMAGE_VERSION;
  assert_true(png_image_begin_read_from_file(&file, path));
  file.format = PNG_FORMAT_RGBA;
  pixels = malloc(PNG_IMAGE_SIZE(file));
  assert_non_null(pixels);
  assert_true(png_image_finish_read(&file, NULL, pixels, 0, NULL));
  return (stic_image){(int)file.width, (int)file.height, pixels};
}

/* Results every 25 ms, pictures every 100 ms: picture i shows result 4 i, exactly. */
static void test_frames_show_the_newest(void **state)
{
  char folder[64], path[128];
  stic_movie_settings settings;
  stic_error err = {0};
  stic_scene scene;
  stic_render *render;
  stic_result r;
  int64_t count;

  (void)state;
  make_folder(folder);
  movie_settings(&settings, folder, 10);
  assert_int_equal(run_movie(&settings, 10, 25 * MS, &count, &err), STIC_OK);
  assert_int_equal(count, 3);
  assert_int_equal(count_entries(folder), 3);
  stic_test_scene(&scene, false);
  render = make_render(&scene, 160, 120, STIC_QUALITY_FAST, NULL);
  for (int i = 0; i < 9; i++) {
    stic_test_edge(&r, 5 * MS + i * 25 * MS, 0.2 + 0.001 * i, 0);
    stic_render_observe(render, &r);
    if (i % 4 == 0) {
      stic_image drawn = draw_copy(render), read;

      snprintf(path, sizeof path, "%s/frame_%06d.png", folder, i / 4);
      read = read_png(path);
      assert_true(identical(&drawn, &read));
      free_image(&drawn);
      free_image(&read);
    }
  }
  stic_render_destroy(render);
  remove_folder(folder);
}

static void test_older_frames(void **state)
{
  static const char *const older[] = {"frame_000001.png", "frame_000077.png", "other.png"};
  char folder[64], path[128];
  stic_movie_settings settings;
  stic_error err = {0};
  int64_t count;

  (void)state;
  make_folder(folder);
  for (int i = 0; i < 3; i++) {
    FILE *file;

    snprintf(path, sizeof path, "%s/%s", folder, older[i]);
    file = fopen(path, "w");
    assert_non_null(file);
    fclose(file);
  }
  movie_settings(&settings, folder, 10);
  assert_int_equal(run_movie(&settings, 10, 25 * MS, &count, &err), STIC_CANNOT_WRITE);
  assert_non_null(strstr(err.message, "older"));
  assert_int_equal(count_entries(folder), 3);
  settings.force = true;
  assert_int_equal(run_movie(&settings, 10, 25 * MS, &count, &err), STIC_OK);
  /* The three new ones and what was never ours. */
  assert_int_equal(count_entries(folder), 4);
  snprintf(path, sizeof path, "%s/other.png", folder);
  assert_int_equal(access(path, F_OK), 0);
  remove_folder(folder);
}

#if defined(STIC_WITH_LIBAV)
static int count_packets(const char *path, enum AVCodecID expected)
{
  AVFormatContext *format = NULL;
  AVPacket *packet = av_packet_alloc();
  int count = 0;

  assert_true(avformat_open_input(&format, path, NULL, NULL) >= 0);
  assert_true(avformat_find_stream_info(format, NULL) >= 0);
  assert_int_equal(format->streams[0]->codecpar->codec_id, expected);
  while (av_read_frame(format, packet) >= 0) {
    count++;
    av_packet_unref(packet);
  }
  av_packet_free(&packet);
  avformat_close_input(&format);
  return count;
}

static void test_video_frame_count(void **state)
{
  static const struct {
    const char *ending;
    enum AVCodecID codec;
  } kinds[] = {{"mp4", AV_CODEC_ID_H264}, {"mkv", AV_CODEC_ID_H264}, {"webm", AV_CODEC_ID_VP9}};
  char folder[64], path[128];
  stic_movie_settings settings;
  stic_error err = {0};
  int64_t count;

  (void)state;
  make_folder(folder);
  for (int i = 0; i < 3; i++) {
    snprintf(path, sizeof path, "%s/a.%s", folder, kinds[i].ending);
    movie_settings(&settings, NULL, 31);
    settings.video = path;
    if (run_movie(&settings, 60, 25 * MS, &count, &err))
      fail_msg("%s", err.message);
    assert_int_equal(count, 46);
    assert_int_equal(count_packets(path, kinds[i].codec), 46);
  }
  assert_int_equal(count_entries(folder), 3);
  remove_folder(folder);
}
#endif

/* ---- bad days ------------------------------------------------------------------------------ */

static void test_no_renderer(void **state)
{
  stic_render_settings settings;
  stic_render *render;
  stic_error err = {0};
  stic_scene scene;

  (void)state;
  stic_test_scene(&scene, false);
  stic_render_settings_init(&settings);
  settings.backend = STIC_GL_OSMESA;
  settings.osmesa_library = "/nowhere/libOSMesa.so";
  assert_int_equal(stic_render_create(&scene, &settings, &render, &err), STIC_CANNOT_WRITE);
  assert_null(render);
  assert_non_null(strstr(err.message, "OSMesa"));
}

static void test_absurd_sizes(void **state)
{
  static const int sizes[][2] = {{0, 0}, {-640, 480}, {641, 480}, {100, 100}, {100000, 100000}, {4098, 480}};
  stic_render_settings settings;
  stic_movie_settings movie;
  stic_render *render;
  stic_error err = {0};
  stic_scene scene;
  int64_t count;

  (void)state;
  stic_test_scene(&scene, false);
  for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
    stic_render_settings_init(&settings);
    settings.width = sizes[i][0];
    settings.height = sizes[i][1];
    assert_int_equal(stic_render_create(&scene, &settings, &render, &err), STIC_USAGE);
  }
  movie_settings(&movie, NULL, 0);
  assert_int_equal(run_movie(&movie, 1, MS, &count, &err), STIC_USAGE);
}

static void test_unwritable(void **state)
{
  stic_movie_settings settings;
  stic_error err = {0};
  int64_t count;

  (void)state;
  movie_settings(&settings, "/dev/null/pictures", 10);
  assert_int_equal(run_movie(&settings, 1, MS, &count, &err), STIC_CANNOT_WRITE);
  assert_string_equal(err.file, "/dev/null/pictures");
  movie_settings(&settings, NULL, 10);
  settings.video = "/dev/null/a.mp4";
  assert_int_equal(run_movie(&settings, 1, MS, &count, &err),
                   stic_video_available() ? STIC_CANNOT_WRITE : STIC_USAGE);
  settings.video = "a.gif";
  assert_int_equal(run_movie(&settings, 1, MS, &count, &err), STIC_USAGE);
}

static void test_device_is_full(void **state)
{
  static uint8_t pixels[160 * 120 * 4];
  stic_image image = {160, 120, pixels};
  stic_error err = {0};
  struct stat there;

  (void)state;
  if (access("/dev/full", W_OK))
    skip();
  assert_int_equal(stic_png_write("/dev/full", &image, &err), STIC_CANNOT_WRITE);
  assert_non_null(strstr(err.message, "space"));
  assert_int_equal(stat("/dev/full", &there), 0);
  assert_true(S_ISCHR(there.st_mode));
}

/* The disk fills up in the middle: nothing is left, not even the folder that was made. */
static void test_disk_fills_up(void **state)
{
  struct rlimit old, small;
  stic_movie_settings settings;
  stic_error err = {0};
  char folder[64], inside[80];
  stic_status status[2];
  int64_t count;

  (void)state;
  make_folder(folder);
  snprintf(inside, sizeof inside, "%s/new", folder);
  signal(SIGXFSZ, SIG_IGN);
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
  small = old;
  small.rlim_cur = 1500;
  movie_settings(&settings, inside, 31);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
  status[0] = run_movie(&settings, 100, 25 * MS, &count, &err);
  settings.folder = NULL;
  settings.video = "/tmp/stic-render-full.mp4";
  status[1] = run_movie(&settings, 100, 25 * MS, &count, NULL);
  setrlimit(RLIMIT_FSIZE, &old);
  assert_int_equal(status[0], STIC_CANNOT_WRITE);
  assert_int_equal(status[1], stic_video_available() ? STIC_CANNOT_WRITE : STIC_USAGE);
  assert_int_equal(count_entries(folder), 0);
  assert_int_not_equal(access(settings.video, F_OK), 0);
  remove_folder(folder);
}

static void test_not_llvmpipe(void **state)
{
  stic_render_settings settings;
  stic_render *render;
  stic_error err = {0};
  stic_scene scene;

  (void)state;
  stic_test_scene(&scene, false);
  stic_render_settings_init(&settings);
  assert_int_equal(stic_render_create(&scene, &settings, &render, &err), STIC_CANNOT_WRITE);
  assert_non_null(strstr(err.message, "llvmpipe"));
}

int main(int argc, char **argv)
{
  static const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_camera_shows_the_box),
    cmocka_unit_test(test_plane_is_to_scale),
    cmocka_unit_test(test_round_up_125),
    cmocka_unit_test(test_history_sees_slips),
    cmocka_unit_test(test_labels_do_not_overlap),
    cmocka_unit_test(test_identity_is_exact),
    cmocka_unit_test(test_everything_is_seen),
    cmocka_unit_test(test_egl_gives_the_same),
    cmocka_unit_test(test_golden_pictures),
    cmocka_unit_test(test_pictures_are_told_apart),
    cmocka_unit_test(test_partial_drawing_is_complete),
    cmocka_unit_test(test_odd_scenes),
    cmocka_unit_test(test_any_size),
    cmocka_unit_test(test_texts),
    cmocka_unit_test(test_names),
    cmocka_unit_test(test_frame_count_rule),
    cmocka_unit_test(test_frames_show_the_newest),
    cmocka_unit_test(test_older_frames),
#if defined(STIC_WITH_LIBAV)
    cmocka_unit_test(test_video_frame_count),
#endif
    cmocka_unit_test(test_no_renderer),
    cmocka_unit_test(test_absurd_sizes),
    cmocka_unit_test(test_unwritable),
    cmocka_unit_test(test_device_is_full),
    cmocka_unit_test(test_disk_fills_up)
  };
  static const struct CMUnitTest refused[] = {cmocka_unit_test(test_not_llvmpipe)};

  if (argc > 1 && !strcmp(argv[1], "not-llvmpipe"))
    return cmocka_run_group_tests(refused, NULL, NULL);
  return cmocka_run_group_tests(tests, NULL, NULL);
}

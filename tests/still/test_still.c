/* stiction still and bench render: pictures, contact sheets, messages, exit codes. */
#include "../files/help.h"

#include "sheet.h"

#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *scene, *trace, *bad_trace, *air_trace;

/* A hand that goes down into the floor and then along it: touches, then slips. */
static char *drag_trace(void)
{
  const size_t room = 40000;
  char *text = malloc(room);
  size_t used;

  assert_non_null(text);
  used = (size_t)snprintf(text, room, "# stiction-trace 1\n");
  for (int i = 0; i < 150; i++) {
    const double down = i < 60 ? i / 60.0 : 1, along = i < 60 ? 0 : (i - 60) / 90.0;

    used += (size_t)snprintf(text + used, room - used, "%d.%02d,%.5f,%.5f,0,0,0,0.1736,0.9848,0\n", i / 50,
                             i % 50 * 2, 0.3 + 0.1 * along, 0.2 - 0.17 * down);
  }
  return text;
}

static int set_up(void **state)
{
  char *text = drag_trace();

  (void)state;
  scene = stic_test_write("scene.yaml", stic_test_scene);
  trace = stic_test_write("hand.csv", text);
  bad_trace = stic_test_write("bad.csv", "# stiction-trace 1\n0,0.3,0.2,0,0,0,0,1,0\n1,2\n");
  free(text);
  text = stic_test_trace(20); /* nothing is touched */
  air_trace = stic_test_write("air.csv", text);
  free(text);
  return 0;
}

static void expect_absent(const char *path)
{
  assert_int_equal(access(path, F_OK), -1);
  assert_int_equal(stic_test_count_entries(".tmp"), 0);
}

/* The first bytes of a file; the IHDR's width and height. */
static void png_size(const char *path, unsigned *width, unsigned *height)
{
  unsigned char head[24];
  FILE *file = fopen(path, "rb");

  assert_non_null(file);
  assert_int_equal(fread(head, 1, sizeof head, file), sizeof head);
  fclose(file);
  assert_memory_equal(head, "\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16);
  *width = (unsigned)head[16] << 24 | (unsigned)head[17] << 16 | (unsigned)head[18] << 8 | head[19];
  *height = (unsigned)head[20] << 24 | (unsigned)head[21] << 16 | (unsigned)head[22] << 8 | head[23];
}

static bool same_bytes(const char *a, const char *b)
{
  FILE *x = fopen(a, "rb"), *y = fopen(b, "rb");
  int c, d;

  assert_non_null(x);
  assert_non_null(y);
  do {
    c = getc(x);
    d = getc(y);
  } while (c == d && c != EOF);
  fclose(x);
  fclose(y);
  return c == d;
}

#define SMALL "--size", "320x240", "--quality", "fast"

static void test_still(void **state)
{
  const char *a = stic_test_path("a.png"), *b = stic_test_path("b.png");
  unsigned width, height;

  (void)state;
  expect(stic_test_program("still", scene, trace, "--at", "2", "--out", a, SMALL, NULL), 0, "");
  png_size(a, &width, &height);
  assert_int_equal(width, 320);
  assert_int_equal(height, 240);
  expect(stic_test_program("still", scene, trace, "--at", "2.019", "--out", b, SMALL, NULL), 0, "");
  assert_true(same_bytes(a, b)); /* the newest result is the same one */
  expect(stic_test_program("still", scene, trace, "--at", "2.02", "--out", b, SMALL, NULL), 0, "");
  assert_false(same_bytes(a, b));
  expect(stic_test_program("still", scene, trace, "--at", "0", "--out", b, SMALL, NULL), 0, "");
  expect(stic_test_program("still", scene, trace, "--at", "2.98", "--out", a, SMALL, NULL), 0, "");
  expect(stic_test_program("still", scene, trace, "--at", "end", "--out", b, SMALL, NULL), 0, "");
  assert_true(same_bytes(a, b));
  expect(stic_test_program("still", scene, trace, "--at", "first-slip", "--out", b, SMALL, NULL), 0, "");
}

static void test_solver_options(void **state)
{
  const char *a = stic_test_path("a.png"), *b = stic_test_path("b.png");

  (void)state;
  expect(stic_test_program("still", scene, trace, "--at", "2.9", "--out", a, SMALL, NULL), 0, "");
  expect(stic_test_program("still", scene, trace, "--at", "2.9", "--out", b, SMALL, "--set",
                           "friction.static=3", NULL),
         0, "");
  assert_false(same_bytes(a, b));
  expect(stic_test_program("still", scene, trace, "--at", "2.9", "--out", b, SMALL, "--accuracy", "frame",
                           "--precision", "f32", NULL),
         0, "");
}

static void test_sheet(void **state)
{
  const char *a = stic_test_path("a.png"), *b = stic_test_path("b.png");
  unsigned width, height, wide;

  (void)state;
  expect(stic_test_program("still", scene, trace, "--sheet", "--out", a, SMALL, NULL), 0, "");
  expect(stic_test_program("still", scene, trace, "--sheet", "--out", b, SMALL, NULL), 0, "");
  assert_true(same_bytes(a, b));
  png_size(a, &width, &height);
  assert_true(width > 3 * 320 && width < 5 * 320 && height > 240);
  expect(stic_test_program("still", scene, trace, "--sheet", "--out", b, SMALL, "--columns", "2", "--rows",
                           "1", NULL),
         0, "");
  png_size(b, &wide, &height);
  assert_true(wide > 2 * 320 && wide < 3 * 320 && height < 2 * 240);
  expect(stic_test_program("still", scene, trace, "--sheet", "--out", b, SMALL, "--columns", "1", "--rows",
                           "1", "--theme", "dark", NULL),
         0, "");
}

static void test_usage(void **state)
{
  const char *out = stic_test_path("none.png");

  (void)state;
  expect(stic_test_program("still", scene, trace, "--out", out, NULL), 2, "either --at T or --sheet");
  expect(stic_test_program("still", scene, trace, "--at", "1", "--sheet", "--out", out, NULL), 2, "either");
  expect(stic_test_program("still", scene, trace, "--at", "1", NULL), 2, "no output");
  expect(stic_test_program("still", scene, trace, "--at", "1", "--out", stic_test_path("none.jpg"), NULL), 2,
         ".png");
  expect(stic_test_program("still", scene, trace, "--at", "noon", "--out", out, NULL), 2, "--at noon");
  expect(stic_test_program("still", scene, trace, "--at", "3", "--out", out, NULL), 2,
         "expected 0 to 2.98 s");
  expect(stic_test_program("still", scene, air_trace, "--at", "first-slip", "--out", out, NULL), 2,
         "nothing slips");
  expect(stic_test_program("still", scene, trace, "--at=-1", "--out", out, NULL), 2, "outside the trace");
  expect(stic_test_program("still", scene, trace, "--at", "1", "--rows", "2", "--out", out, NULL), 2,
         "--sheet");
  expect(stic_test_program("still", scene, trace, "--sheet", "--columns", "99", "--out", out, NULL), 2,
         "--columns 99: expected 1 to 16");
  expect(stic_test_program("still", scene, trace, "--sheet", "--rows", "0", "--out", out, NULL), 2,
         "--rows 0: expected 1 to 64");
  expect(stic_test_program("still", scene, trace, "--sheet", "--columns", "-1", "--out", out, NULL), 2,
         "1 to 16");
  expect(stic_test_program("still", scene, trace, "--sheet", "--size", "4096x4096", "--columns", "5", "--out",
                           out, NULL),
         2, "at most 16384");
  expect(stic_test_program("still", scene, trace, "--at", "1", "--size", "1x1", "--out", out, NULL), 2,
         "1 x 1");
  expect(stic_test_program("still", scene, "--at", "1", "--out", out, NULL), 2, "arguments are missing");
  expect_absent(out);
}

static void test_bad_days(void **state)
{
  const char *out = stic_test_path("none.png");

  (void)state;
  expect(stic_test_program("still", scene, bad_trace, "--at", "0", "--out", out, NULL), 3,
         "bad.csv:3: found 2");
  expect(stic_test_program("still", scene, "/nonexistent", "--sheet", "--out", out, NULL), 3, "No such file");
  expect_absent(out);
  expect(stic_test_program("still", scene, bad_trace, "--lenient", "--at", "0", "--out", out, SMALL, NULL), 0,
         "1 bad line passed over");
  unlink(out);
  expect(stic_test_program("still", scene, air_trace, "--sheet", "--out", out, SMALL, NULL), 0, "");
  unlink(out);
  expect(stic_test_program("still", scene, trace, "--at", "1", "--out", "/nonexistent/a.png", NULL), 5,
         "cannot write");
  expect(stic_test_program("still", scene, trace, "--at", "1", "--out", "/dev/full", SMALL, NULL), 5,
         "No space left");
  expect(stic_test_program("still", scene, trace, "--at", "1", "--out", trace, NULL), 2, "ends with .png");
  setenv("GALLIUM_DRIVER", "softpipe", 1);
  expect(stic_test_program("still", scene, trace, "--at", "1", "--out", out, NULL), 5, "no usable renderer");
  expect(stic_test_program("still", scene, trace, "--sheet", "--out", out, NULL), 5, "no usable renderer");
  expect(stic_test_program("bench", "render", "--quick", NULL), 5, "no usable renderer");
  unsetenv("GALLIUM_DRIVER");
  expect_absent(out);
}

static void test_standard_streams(void **state)
{
  const char *const arguments[] = {"still", scene, "-", "--at", "1", "--out", "-", SMALL, NULL};
  const char *a = stic_test_path("a.png");

  (void)state;
  expect(stic_test_program("still", scene, trace, "--at", "1", "--out", a, SMALL, NULL), 0, "");
  assert_int_equal(stic_test_wait(stic_test_start(trace, arguments)), 0);
  assert_true(same_bytes(a, stic_test_path("out")));
}

/* By a reader that is not ours. To be freed. */
static uint8_t *read_pixels(const char *path, size_t *length)
{
  png_image image = {.version = PNG_IMAGE_VERSION};
  uint8_t *pixels;

  assert_true(png_image_begin_read_from_file(&image, path));
  image.format = PNG_FORMAT_RGB;
  *length = PNG_IMAGE_SIZE(image);
  pixels = malloc(*length);
  assert_non_null(pixels);
  assert_true(png_image_finish_read(&image, NULL, pixels, 0, NULL));
  return pixels;
}

static void test_same_as_replay(void **state)
{
  const char *out = stic_test_path("a.png"), *folder = stic_test_path("frames");
  uint8_t *still, *frame;
  size_t still_length, frame_length;

  (void)state;
  expect(stic_test_program("replay", scene, trace, "--frames", folder, "--fps", "10", SMALL, NULL), 0, "");
  expect(stic_test_program("still", scene, trace, "--at", "2", "--out", out, SMALL, NULL), 0, "");
  still = read_pixels(out, &still_length);
  frame = read_pixels(stic_test_path("frames/frame_000020.png"), &frame_length);
  assert_int_equal(still_length, frame_length);
  assert_memory_equal(still, frame, frame_length);
  free(still);
  free(frame);
}

/* Words that do not fit, times that lie on each other, one row only. */
static void test_sheet_extremes(void **state)
{
  static const char words[] =
    "a very long caption \xc2\xb7 with signs \xe2\x86\x92 that are several bytes long, "
    "again and again \xc2\xb7\xc2\xb7\xc2\xb7\xc2\xb7\xc2\xb7\xc2\xb7\xc2\xb7\xc2\xb7";
  const stic_sheet_settings settings = {2, 3, 160, 120, STIC_LOOK_DARK, words, words};
  const stic_sheet_row rows[2] = {{5, STIC_FREE, false}, {6, STIC_MULTI, true}};
  const int64_t marks[3] = {5, 5, 5};
  const stic_sheet_caption caption = {5, words, words};
  uint8_t *pixels = calloc(160 * 120, 4);
  const stic_image picture = {160, 120, pixels};
  stic_sheet *sheet;
  stic_image image;
  stic_error err;

  (void)state;
  assert_non_null(pixels);
  for (size_t count = 1; count <= 2; count++) {
    assert_int_equal(stic_sheet_create(&settings, &sheet, &err), STIC_OK);
    stic_sheet_draw_band(sheet, rows, count, marks, 3);
    for (int i = 0; i < 3; i++)
      stic_sheet_place(sheet, i, &picture, &caption);
    image = stic_sheet_image(sheet);
    assert_true(image.width > 320 && image.height > 240);
    stic_sheet_destroy(sheet);
  }
  free(pixels);
}

static void test_bench(void **state)
{
  const stic_test_run *run;

  (void)state;
  /* The video libraries keep memory each time they are loaded, and cannot be named once they are unloaded. */
  setenv("ASAN_OPTIONS", "detect_leaks=0", 1);
  run = stic_test_program("bench", "render", "--quick", NULL);
  unsetenv("ASAN_OPTIONS");
  expect(run, 0, "");
  stic_test_contains(run->out, "1280x720    good");
  stic_test_contains(run->out, "PNG of quality good");
  stic_test_contains(run->out, "target <= 11");
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_still),          cmocka_unit_test(test_solver_options),
    cmocka_unit_test(test_sheet),          cmocka_unit_test(test_usage),
    cmocka_unit_test(test_bad_days),       cmocka_unit_test(test_standard_streams),
    cmocka_unit_test(test_same_as_replay), cmocka_unit_test(test_sheet_extremes),
    cmocka_unit_test(test_bench),
  };

  return cmocka_run_group_tests_name("still", tests, set_up, stic_test_clean_up);
}

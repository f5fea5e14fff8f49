/* stiction run --view --device mouse on a display in memory: a user takes the box, drags it along the floor, turns it
 * and ends the run; the recording replays to the same log. */
#include "xvfb.h"

#include "../files/help.h"
#include "angle.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TRIES 3000 /* of 20 ms: a minute, on a loaded machine */

/* The last row of the recording or log that grows on disk: its first `count` numbers; false if there is none. */
static bool last_numbers(const char *path, double *numbers, int count)
{
  char *text = stic_test_read(path), *line = text, *end;
  bool ok = false;

  if (text && (end = strrchr(text, '\n'))) {
    *end = '\0';
    line = strrchr(text, '\n');
    ok = line && line[1] >= '0' && line[1] <= '9';
    line = line ? line + 1 : text;
    for (int i = 0; ok && i < count; i++) {
      numbers[i] = strtod(line, &end);
      line = end + 1;
    }
  }
  free(text);
  return ok;
}

/* Points at a pixel and waits until the recording says where that is: m. */
static void point(stic_xvfb *x, const double pixel[2], double place[2])
{
  double before[3] = {0, 1e300, 1e300}, now[3];

  last_numbers(stic_test_path("hand.csv"), before, 3);
  stic_xvfb_point(x, (int)pixel[0], (int)pixel[1]);
  for (int i = 0; i < TRIES; i++) {
    stic_test_pause(20);
    if (last_numbers(stic_test_path("hand.csv"), now, 3) && (now[1] != before[1] || now[2] != before[2])) {
      stic_test_pause(60); /* and the picture with it */
      memcpy(place, now + 1, 2 * sizeof *place);
      return;
    }
  }
  fail_msg("the pointer moved, the hand did not");
}

/* The pixel of a place, from where two other pixels are: x and y are to scale in the hand's plane. */
static void pixel_of(const double place[2], double pixels[2][2], double places[2][2], double pixel[2])
{
  for (int k = 0; k < 2; k++)
    pixel[k] = pixels[0][k] +
               (pixels[1][k] - pixels[0][k]) * (place[k] - places[0][k]) / (places[1][k] - places[0][k]);
}

/* From the pixel to the place in steps, as a hand does. */
static void drag(stic_xvfb *x, double pixel[2], const double to[2])
{
  const double from[2] = {pixel[0], pixel[1]};

  for (int i = 1; i <= 40; i++) {
    for (int k = 0; k < 2; k++)
      pixel[k] = floor(from[k] + (to[k] - from[k]) * i / 40 + 0.5);
    stic_xvfb_point(x, (int)pixel[0], (int)pixel[1]);
    stic_test_pause(5);
  }
  stic_test_pause(100);
}

/* Brings the pointer to a place, m: the pixels of others tell where that is, once the camera rests. */
static void point_at(stic_xvfb *x, const double place[2], double pixels[2][2], double places[2][2],
                     double at[2])
{
  for (int i = 0; i < 100; i++) {
    double got[2];

    for (int k = 0; k < 2; k++) {
      pixels[k][0] = 360 + 80 * k + i;
      pixels[k][1] = 200 + 60 * k + i;
      point(x, pixels[k], places[k]);
    }
    pixel_of(place, pixels, places, at);
    point(x, at, got);
    if (fabs(got[0] - place[0]) < 0.002 && fabs(got[1] - place[1]) < 0.002)
      return;
  }
  fail_msg("the hand is not where the pointer is");
}

/* Waits until the recording's last sample has the hand's angle (rad) and is pressed. */
static void await_angle(double angle)
{
  double row[9] = {0};

  for (int i = 0; i < TRIES; i++) {
    if (last_numbers(stic_test_path("hand.csv"), row, 9) && fabs(2 * atan2(row[6], row[7]) - angle) < 1e-9) {
      assert_true(row[3] == 0 && row[8] == 1);
      return;
    }
    stic_test_pause(20);
  }
  fail_msg("the wheel turned the hand to %g degrees, not to %g", 2 * atan2(row[6], row[7]) / STIC_RAD_PER_DEG,
           angle / STIC_RAD_PER_DEG);
}

/* Waits until it has moved away from the user and is let go or still pressed, as given. */
static void await_away(bool pressed)
{
  double row[9] = {0};

  for (int i = 0; i < TRIES; i++) {
    if (last_numbers(stic_test_path("hand.csv"), row, 9) && row[3] < 0 && (row[8] == 1) == pressed)
      return;
    stic_test_pause(20);
  }
  fail_msg("the hand did not move away or was not let go");
}

static void turn_wheel(stic_xvfb *x, unsigned button, const char *key)
{
  if (key)
    stic_xvfb_hold_key(x, key, true);
  stic_xvfb_button(x, button, true);
  stic_xvfb_button(x, button, false);
  if (key)
    stic_xvfb_hold_key(x, key, false);
}

/* The session of a user; all places in m. */
static void use_mouse(stic_xvfb *x)
{
  double pixels[2][2], places[2][2], at[2], to[2];

  point_at(x, (double[2]){0.12, 0.04}, pixels, places, at);
  stic_xvfb_button(x, 1, true);
  pixel_of((double[2]){0.12, 0.02}, pixels, places, to);
  drag(x, at, to);
  pixel_of((double[2]){0.22, 0.02}, pixels, places, to);
  drag(x, at, to);
  for (int i = 0; i < 5; i++)
    turn_wheel(x, 4, NULL);
  await_angle(10 * STIC_RAD_PER_DEG);
  turn_wheel(x, 5, "Shift_L");
  await_angle(9.75 * STIC_RAD_PER_DEG);
  turn_wheel(x, 4, "Control_L");
  await_away(true);
  stic_xvfb_button(x, 1, false);
  await_away(false);
}

static void test_mouse(void **state)
{
  char hand[300], log[300], again[300], events[300];
  const stic_test_run *replay;
  char *live, *replayed, *told;
  stic_xvfb x;
  pid_t child;

  (void)state;
  if (!stic_xvfb_start(&x)) {
    print_message("no Xvfb here: skipped\n");
    skip();
  }
  snprintf(hand, sizeof hand, "%s", stic_test_path("hand.csv"));
  snprintf(log, sizeof log, "%s", stic_test_path("log.csv"));
  snprintf(again, sizeof again, "%s", stic_test_path("again.csv"));
  snprintf(events, sizeof events, "%s", stic_test_path("events.csv"));
  child =
    stic_test_start(NULL, (const char *const[]){"run", SCENE, "--device", "mouse", "--view", "--record", hand,
                                                "--log", log, "--events", events, "--size", "800x600", NULL});
  assert_true(stic_xvfb_find_window(&x));
  use_mouse(&x);
  stic_xvfb_key(&x, "q");
  assert_int_equal(stic_test_wait(child), 0);
  replay = stic_test_program("replay", SCENE, hand, "--log", again, NULL);
  assert_int_equal(replay->code, 0);
  live = stic_test_read(log);
  replayed = stic_test_read(again);
  assert_string_equal(stic_test_rows(live), stic_test_rows(replayed));
  assert_non_null(strstr(live, ",edge,"));
  told = stic_test_read(events);
  assert_non_null(strstr(told, ",take,"));
  assert_non_null(strstr(told, ",slip,"));
  assert_non_null(strstr(told, ",release,"));
  free(live);
  free(replayed);
  free(told);
  stic_xvfb_stop(&x);
}

/* Waits until the program has said this. */
static void await_words(const char *words)
{
  for (int i = 0; i < TRIES; i++) {
    char *said = stic_test_read(stic_test_path("err"));
    const bool found = said && strstr(said, words);

    free(said);
    if (found)
      return;
    stic_test_pause(20);
  }
  fail_msg("it did not say \"%s\"", words);
}

/* Without the display a run with a tracker goes on, one by the mouse ends; all is written either way. */
static void check_lost_display(const char *device, bool ends)
{
  const char *hand = stic_test_path("lost-hand.csv"), *log = stic_test_path("lost-log.csv");
  stic_xvfb x;
  pid_t child;

  if (!stic_xvfb_start(&x))
    skip();
  remove(hand);
  child = stic_test_start(NULL, (const char *const[]){"run", SCENE, "--device", device, "--view", "--record",
                                                      hand, "--log", log, "--size", "400x300", NULL});
  assert_true(stic_xvfb_find_window(&x));
  for (int i = 0; i < TRIES && stic_test_count_rows(hand) == 0; i++) {
    stic_xvfb_point(&x, 200 + i % 10, 150);
    stic_test_pause(20);
  }
  stic_xvfb_stop(&x);
  if (!ends) {
    await_words("the window's display is gone");
    stic_test_wait_for_rows(child, hand, stic_test_count_rows(hand) + 10);
    kill(child, SIGINT);
  }
  assert_int_equal(stic_test_wait(child), 5);
  await_words("the window's display is gone");
  assert_true(stic_test_count_rows(log) > 0);
  assert_int_equal(stic_test_count_rows(log), stic_test_count_rows(hand));
}

static void test_lost_display(void **state)
{
  (void)state;
  check_lost_display("sample", false);
  check_lost_display("mouse", true);
}

static void test_refusals(void **state)
{
  const stic_test_run *run = stic_test_program("run", SCENE, "--device", "mouse", NULL);

  (void)state;
  assert_int_equal(run->code, 2);
  stic_test_contains(run->err, "device mouse: it moves in the window; add --view");
  setenv("DISPLAY", "", 1);
  run = stic_test_program("run", SCENE, "--device", "sample", "--view", "--log", stic_test_path("none.csv"),
                          NULL);
  assert_int_equal(run->code, 5);
  stic_test_contains(run->err, "cannot open a window: ");
  assert_int_equal(stic_test_count_entries("none.csv"), 0);
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_refusals), cmocka_unit_test(test_mouse),
                                     cmocka_unit_test(test_lost_display)};

  return cmocka_run_group_tests_name("run_view", tests, NULL, stic_test_clean_up);
}

/* The program's measurements and `explain`, as a user meets them. */
#include "../files/help.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int count_text(const char *text, const char *part)
{
  int count = 0;

  for (const char *at = text; (at = strstr(at, part)) != NULL; at += strlen(part))
    count++;
  return count;
}

static int count_lines(const char *path)
{
  char *text = stic_test_read(path);
  const int count = text ? count_text(text, "\n") : -1;

  free(text);
  return count;
}

static void validate_passes(void **state)
{
  const char *csv = stic_test_path("validate.csv");
  const stic_test_run *run = stic_test_program("bench", "validate", "--quick", "--csv", csv, NULL);
  const int rows = count_text(run->out, " pass\n") - 1; /* the last line counts them */

  (void)state;
  assert_int_equal(run->code, 0);
  assert_int_equal(count_text(run->out, "FAIL"), 0);
  assert_true(rows >= 35);
  stic_test_contains(run->out, "Left out");
  assert_int_equal(count_lines(csv), rows + 1);
}

/* Friction that is wrong by a millionth is seen. */
static void validate_fails_when_it_must(void **state)
{
  const stic_test_run *run;

  (void)state;
  run = stic_test_program("bench", "validate", "--quick", "--spoil", "1.000001", NULL);
  assert_int_equal(run->code, 1);
  assert_true(count_text(run->out, "FAIL") >= 10);
  run = stic_test_program("bench", "validate", "--quick", "--spoil", "0.9999999", NULL);
  assert_int_equal(run->code, 1);
}

static void wrong_usage(void **state)
{
  (void)state;
  assert_int_equal(stic_test_program("bench", NULL)->code, 2);
  assert_int_equal(stic_test_program("bench", "nothing", NULL)->code, 2);
  assert_int_equal(stic_test_program("bench", "validate", "x.yaml", NULL)->code, 2);
  assert_int_equal(stic_test_program("bench", "validate", "--plot", "x", NULL)->code, 2);
  assert_int_equal(stic_test_program("bench", "speed", "--csv", "x", NULL)->code, 2);
  assert_int_equal(stic_test_program("bench", "trade", "x.yaml", NULL)->code, 2);
  assert_int_equal(stic_test_program("bench", "speed", "--seconds", "1", NULL)->code, 2);
  assert_int_equal(stic_test_program("bench", "devices", "--seconds", "-1", NULL)->code, 2);
  assert_int_equal(stic_test_program("explain", NULL)->code, 2);
  assert_int_equal(stic_test_program("bench", "validate", "--quick", "--csv", "/nowhere/x.csv", NULL)->code,
                   5);
}

static void devices_lose_nothing(void **state)
{
  const char *csv = stic_test_path("devices.csv");
  const stic_test_run *run =
    stic_test_program("bench", "devices", "--quick", "--seconds", "1", "--csv", csv, NULL);

  (void)state;
  if (run->code != 0)
    fail_msg("exit code %d: %s", run->code, run->err);
  stic_test_contains(run->out, "of 6000 records lost: 0 on the way, 0 in the recording");
  assert_int_equal(count_lines(csv), 1 + 4 + 1 + 1);
}

static void trade_tells_and_draws(void **state)
{
  const char *scene = stic_test_write("scene.yaml", stic_test_scene), *csv = stic_test_path("trade.csv");
  char *text = stic_test_trace(40);
  const char *trace = stic_test_write("hand.csv", text);
  const stic_test_run *run = stic_test_program("bench", "trade", scene, trace, "--quick", "--csv", csv,
                                               "--plot", stic_test_path("trade"), NULL);
  char *svg;

  (void)state;
  free(text);
  assert_int_equal(run->code, 0);
  stic_test_contains(run->out, "In words: the knee is at");
  stic_test_contains(run->out, "Recommended for this scene");
  stic_test_contains(run->out, "with f80 (38 of 38 within bounds)");
  stic_test_contains(run->out, "substep=256");
  assert_true(count_lines(csv) >= 1 + 30 + 5 + 14); /* levels, h_min, starts */
  svg = stic_test_read(stic_test_path("trade.svg"));
  assert_non_null(svg);
  stic_test_contains(svg, "</svg>");
  free(svg);
  assert_int_equal(stic_test_count_entries(".part"), 0);
  assert_int_equal(stic_test_count_entries("trade.png"), 1);
}

/* Where there is no tree of traces it takes a motion of its own. */
static void trade_has_a_motion(void **state)
{
  const char *out = stic_test_path("trade-out");
  char command[600], *said;

  (void)state;
  snprintf(command, sizeof command, "cd %s && \"$STICTION\" bench trade --quick --csv own.csv >%s",
           stic_test_folder(), out);
  assert_int_equal(system(command), 0);
  said = stic_test_read(out);
  stic_test_contains(said, "built in: a box between floor and wall: 400 samples in 12.87 s");
  stic_test_contains(said, "Recommended for this scene");
  free(said);
  assert_true(count_lines(stic_test_path("own.csv")) > 1 + 30 + 5 + 14);
}

static void trade_refuses(void **state)
{
  const char *scene = stic_test_write("scene.yaml", stic_test_scene), *csv = stic_test_path("none.csv");
  const stic_test_run *run;

  (void)state;
  run = stic_test_program("bench", "trade", scene, "/nowhere.csv", "--quick", "--csv", csv, NULL);
  assert_int_equal(run->code, 3);
  assert_int_equal(count_lines(csv), -1); /* nothing is left */
  run = stic_test_program("bench", "trade", "/nowhere.yaml", "/nowhere.csv", "--quick", NULL);
  assert_int_equal(run->code, 3);
}

static void explain_says_why(void **state)
{
  static const char room[] = "stiction: 1\nname: \"a \\\"room\\\"\"\n"
                             "object: {size: [0.16, 0.08, 0.1], pose: {x: 0, y: 0.06}}\n"
                             "hand: {stiffness: 200, rotational_stiffness: 0.5}\n"
                             "friction: {static: 0.5, dynamic: 0.3}\n"
                             "surfaces:\n"
                             "  - {name: floor, point: [0, 0], normal_deg: 90}\n"
                             "  - {name: cellar, point: [0, -1], normal_deg: 90}\n"
                             "  - {name: wall, point: [3, 0], normal_deg: 180}\n";
  const char *scene = stic_test_write("room.yaml", room);
  const stic_test_run *run;

  (void)state;
  run = stic_test_program("explain", scene, NULL);
  assert_int_equal(run->code, 0);
  stic_test_contains(run->out, "Surfaces that can be touched: 2 of 3.");
  stic_test_contains(run->out, "never: no part of it is free of floor");
  run = stic_test_program("explain", scene, "--workspace", "-0.3,0.3,-0.05,0.4", NULL);
  assert_int_equal(run->code, 0);
  stic_test_contains(run->out, "Surfaces that can be touched: 1 of 3.");
  stic_test_contains(run->out, "never: no vertex comes closer");
  run = stic_test_program("explain", scene, "--json", "--set", "friction.dynamic=0.5", NULL);
  assert_int_equal(run->code, 0);
  stic_test_contains(run->out, "\"reach\": \"behind\"");
  stic_test_contains(run->out, "\"friction\": \"no-jumps\"");
}

static void explain_reads_traces(void **state)
{
  const char *scene = stic_test_write("scene.yaml", stic_test_scene);
  char *text = stic_test_trace(20);
  const char *trace = stic_test_write("hand.csv", text);
  const stic_test_run *run = stic_test_program("explain", scene, trace, NULL);

  (void)state;
  free(text);
  assert_int_equal(run->code, 0);
  stic_test_contains(run->out, "20 samples");
}

static void explain_refuses(void **state)
{
  const char *scene = stic_test_write("scene.yaml", stic_test_scene),
             *bad = stic_test_write("bad.yaml", "stiction: 2\n");
  const char *trace = stic_test_write("bad.csv", "# stiction-trace 1\n1,2,3\n");

  (void)state;
  assert_int_equal(stic_test_program("explain", bad, NULL)->code, 3);
  assert_int_equal(stic_test_program("explain", scene, trace, NULL)->code, 3);
  assert_int_equal(stic_test_program("explain", scene, "--workspace", "1,2,3", NULL)->code, 2);
  assert_int_equal(stic_test_program("explain", scene, "--workspace", "2,1,0,1", NULL)->code, 2);
  assert_int_equal(stic_test_program("explain", scene, trace, "--workspace", "0,1,0,1", NULL)->code, 2);
  assert_int_equal(stic_test_program("explain", scene, "--set", "friction.static", NULL)->code, 2);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(validate_passes),      cmocka_unit_test(validate_fails_when_it_must),
    cmocka_unit_test(wrong_usage),          cmocka_unit_test(trade_tells_and_draws),
    cmocka_unit_test(devices_lose_nothing), cmocka_unit_test(trade_refuses),
    cmocka_unit_test(trade_has_a_motion),   cmocka_unit_test(explain_says_why),
    cmocka_unit_test(explain_reads_traces), cmocka_unit_test(explain_refuses),
  };

  return cmocka_run_group_tests(tests, NULL, stic_test_clean_up);
}

/* bench extremes as a user meets it: a case of each sweep goes out to files and comes back, tables, pictures, refusals. */
#include "../files/help.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int lines_in(const char *path)
{
  char *text = stic_test_read(path);
  int count = 0;

  assert_non_null(text);
  for (const char *c = text; *c; c++)
    count += *c == '\n';
  free(text);
  return count;
}

/* Rows and failures of the first table line that begins with `name`. */
static void read_line(const char *out, const char *name, long *rows, long *failures)
{
  char start[40], line[400];
  const char *at, *last;

  snprintf(start, sizeof start, "\n%s ", name);
  at = strstr(out, start);
  if (!at)
    fail_msg("no line of %s: %s", name, out);
  snprintf(line, sizeof line, "%.*s", (int)strcspn(at + 1, "\n"), at + 1);
  assert_int_equal(sscanf(line, "%*s %*s %*s %ld", rows), 1);
  last = strrchr(line, ' ');
  *failures = strtol(last, NULL, 10);
}

/* The files hold the case: they pass `check`, and the three levels of each precision meet the invariants on them too. */
static void cases_go_out_and_come_back(void **state)
{
  static const char *const sweeps[] = {"stiffness", "friction", "k_p-mu", "shape", "polygon", "distance",
                                       "far",       "surfaces", "hand",   "press", "exact",   "still"};
  char scene[300], trace[300];

  (void)state;
  for (size_t i = 0; i < sizeof sweeps / sizeof sweeps[0]; i++) {
    const char *folder = stic_test_path("case");
    long rows, failures, again;

    expect(stic_test_program("bench", "extremes", "--quick", "--sweep", sweeps[i], "--case", "1", "--dump",
                             folder, NULL),
           0, "");
    read_line(
      stic_test_program("bench", "extremes", "--quick", "--sweep", sweeps[i], "--case", "1", NULL)->out,
      sweeps[i], &rows, &failures);
    assert_int_equal(failures, 0);
    snprintf(scene, sizeof scene, "%s/scene.yaml", folder);
    snprintf(trace, sizeof trace, "%s/hand.csv", folder);
    expect(stic_test_program("check", scene, trace, NULL), 0, "");
    read_line(stic_test_program("bench", "extremes", scene, trace, NULL)->out, "files", &again, &failures);
    assert_int_equal(failures, 0);
    assert_true(rows > 0);
    assert_int_equal(again, rows);
  }
}

static void random_case_goes_out(void **state)
{
  char trace[300];
  const char *folder = stic_test_path("random");

  (void)state;
  expect(stic_test_program("bench", "extremes", "--random", "1", "--seed", "7", "--case", "3", "--dump",
                           folder, NULL),
         0, "");
  snprintf(trace, sizeof trace, "%s/hand.csv", folder);
  assert_int_equal(lines_in(trace), 2 + 60);
}

static void table_and_picture(void **state)
{
  const char *csv = stic_test_path("e.csv"), *png = stic_test_path("e.png");
  char *bytes;

  (void)state;
  expect(stic_test_program("bench", "extremes", "--quick", "--sweep", "distance", "--csv", csv, "--picture",
                           png, NULL),
         0, "");
  assert_true(lines_in(csv) > 20);
  bytes = stic_test_read(png);
  assert_non_null(bytes);
  assert_memory_equal(bytes, "\x89PNG", 4);
  free(bytes);
  expect(stic_test_program("bench", "extremes", "--quick", "--sweep", "distance", "--case", "0", "--picture",
                           "/nonexistent/e.png", NULL),
         5, "/nonexistent/e.png");
  expect(stic_test_program("bench", "extremes", "--sweep", "friction", "--picture", png, NULL), 2,
         "--picture shows the sweeps k_p-mu and distance only");
}

static void refusals(void **state)
{
  const char *csv = stic_test_path("none.csv"), *scene = stic_test_write("scene.yaml", stic_test_scene);

  (void)state;
  expect(stic_test_program("bench", "extremes", "--sweep", "none", "--csv", csv, NULL), 2, "no sweep 'none'");
  expect(stic_test_program("bench", "extremes", "--sweep", "hand", "--random", "5", NULL), 2,
         "without --sweep");
  expect(stic_test_program("bench", "extremes", "--random", "-5", NULL), 2, "above 0");
  expect(stic_test_program("bench", "extremes", "--dump", "x", NULL), 2, "--dump needs --case K");
  expect(stic_test_program("bench", "extremes", scene, NULL), 2, "expected SCENE and TRACE, or neither");
  expect(stic_test_program("bench", "speed", "--long", NULL), 2, "bench speed has none of --picture");
  expect(stic_test_program("bench", "extremes", scene, "/nonexistent", "--csv", csv, NULL), 3,
         "No such file");
  expect(stic_test_program("bench", "extremes", "--csv", "/nonexistent/x", NULL), 5, "cannot write");
  expect(stic_test_program("bench", "extremes", "--random", "1", "--case", "0", "--dump", "/nonexistent/a/b",
                           NULL),
         5, "/nonexistent/a/b/scene.yaml");
  assert_int_equal(stic_test_count_entries("none.csv"), 0); /* whole or absent */
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(cases_go_out_and_come_back),
    cmocka_unit_test(random_case_goes_out),
    cmocka_unit_test(table_and_picture),
    cmocka_unit_test(refusals),
  };

  return cmocka_run_group_tests(tests, NULL, stic_test_clean_up);
}

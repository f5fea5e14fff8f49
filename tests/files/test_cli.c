/* The program as users and scripts see it: exit codes, messages, outputs, signals. */
#include "help.h"
#include "stiction.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static const char *scene, *trace, *bad_trace;

static int set_up(void **state)
{
  static char paths[3][256];
  char *text = stic_test_trace(500);

  (void)state;
  strcpy(paths[0], stic_test_write("scene.yaml", stic_test_scene));
  strcpy(paths[1], stic_test_write("hand.csv", text));
  strcpy(paths[2], stic_test_write("bad.csv", "# stiction-trace 1\n0,0.3,0.2,0,0,0,0,1,0\n1,2\n"));
  scene = paths[0];
  trace = paths[1];
  bad_trace = paths[2];
  free(text);
  return 0;
}

static void test_help(void **state)
{
  static const char *const commands[] = {"replay", "run", "check", "bench"};

  (void)state;
  expect(stic_test_program("--help", NULL), 0, "");
  for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
    const stic_test_run *run = stic_test_program(commands[i], "--help", NULL);

    assert_int_equal(run->code, 0);
    stic_test_contains(run->out, "Usage: stiction ");
    assert_string_equal(run->err, "");
  }
}

/* The libav of Debian has x264, so that the program with its video module is under the GPL. */
static void test_version(void **state)
{
  const stic_test_run *run = stic_test_program("--version", NULL);

  (void)state;
  expect(run, 0, "");
  stic_test_contains(run->out, "stiction " STIC_VERSION "\nMIT licence");
  stic_test_contains(run->out, WITH_VIDEO ? "\nvideo: libav, " : "\nvideo: none\n");
  stic_test_contains(run->out, WITH_WINDOW ? "\nwindow: SDL\n" : "\nwindow: none\n");
  assert_true(!strstr(run->out, "libav, GPL") == !strstr(run->out, "(x264): GPL version "));
}

static void test_usage(void **state)
{
  const char *long_trace = stic_test_write("long.csv", "# stiction-trace 1\n0,0,0.2,0,0,0,0,1,1\n"
                                                       "1000,0,0.2,0,0,0,0,1,1\n");

  (void)state;
  expect(stic_test_program(NULL), 2, "which command?");
  expect(stic_test_program("dance", NULL), 2, "unknown command 'dance'");
  expect(stic_test_program("replay", scene, trace, "a\nb\033", NULL), 2, "one argument too many: a?b?;");
  expect(stic_test_program("replay", scene, NULL), 2, "arguments are missing");
  expect(stic_test_program("replay", scene, trace, trace, NULL), 2, "one argument too many");
  expect(stic_test_program("replay", scene, trace, "--nonsense", NULL), 2, "--nonsense");
  expect(stic_test_program("replay", scene, trace, "--log", NULL), 2, "--log");
  expect(stic_test_program("replay", scene, trace, "--accuracy", "good", NULL), 2, "accuracy 'good'");
  expect(stic_test_program("replay", scene, trace, "--precision", "f128", NULL), 2, "precision 'f128'");
  expect(stic_test_program("replay", scene, trace, "--set", "friction", NULL), 2, "expected KEY=VALUE");
  expect(stic_test_program("replay", scene, trace, "--set", "a.b=1", NULL), 2, "unknown key 'a'");
  expect(stic_test_program("replay", scene, trace, "--log", trace, NULL), 2, "is an input");
  expect(stic_test_program("replay", scene, trace, "--log", "-", "--events", "-", NULL), 2, "two outputs");
  expect(stic_test_program("replay", scene, trace, "--frames", "x", "--size", "12", NULL), 2, "--size 12");
  expect(stic_test_program("replay", scene, trace, "--frames", "x", "--size", "40000x40", NULL), 2,
         "40000 x 40; expected even numbers");
  expect(stic_test_program("replay", scene, trace, "--frames", "x", "--camera", "no", NULL), 2,
         "--camera no: expected three-quarter, front or follow");
  expect(stic_test_program("replay", scene, trace, "--frames", "x", "--theme", "no", NULL), 2,
         "--theme no: expected light or dark");
  expect(stic_test_program("replay", scene, trace, "--frames", "x", "--quality", "no", NULL), 2,
         "--quality no: expected fast, good or best");
  expect(stic_test_program("replay", scene, long_trace, "--frames", "/nonexistent/x", NULL), 5,
         "31001 pictures have to be drawn");
  expect(stic_test_program("replay", scene, trace, "--frames", "x", "--plot-of", "no", NULL), 2,
         "--plot-of no: expected auto, x, y or angle");
  expect(stic_test_program("replay", scene, trace, "--report", "x.html", "--fps", "0", NULL), 2, "");
  expect(stic_test_program("check", scene, trace, "--set", "friction", NULL), 2, "expected KEY=VALUE");
  expect(stic_test_program("run", scene, NULL), 2, "no device");
  expect(stic_test_program("run", scene, "--device", "x", NULL), 2, "unknown device");
  expect(stic_test_program("bench", "x", NULL), 2, "unknown measurement 'x'");
}

static void test_bad_files(void **state)
{
  const char *log = stic_test_path("log.csv"),
             *bad_scene = stic_test_write("bad.yaml", "stiction: 1\nsize: 3\n");

  (void)state;
  expect(stic_test_program("replay", bad_scene, trace, NULL), 3, "bad.yaml:2: unknown key 'size'");
  expect(stic_test_program("replay", scene, bad_trace, "--log", log, NULL), 3, "bad.csv:3: found 2 fields");
  assert_int_equal(access(log, F_OK), -1);
  expect(stic_test_program("replay", scene, bad_trace, "--lenient", "--log", log, NULL), 0,
         "1 bad line passed over");
  assert_int_equal(access(log, F_OK), 0);
  unlink(log);
  expect(stic_test_program("replay", scene, "/nonexistent", NULL), 3, "No such file");
  expect(stic_test_program("check", bad_scene, bad_trace, NULL), 1, "bad.csv:3: found 2 fields");
  stic_test_contains(stic_test_program("check", "/nonexistent", NULL)->out, "1 error,");
  {
    char text[2000];

    snprintf(text, sizeof text, "%stracker:\n  scale: 0\n", stic_test_scene);
    expect(stic_test_program("check", stic_test_write("tracker.yaml", text), NULL), 1, "tracker.yaml:12: ");
    stic_test_contains(stic_test_program("check", stic_test_path("tracker.yaml"), NULL)->out, "1 error,");
  }
  expect(stic_test_program("check", scene, trace, NULL), 0, "");
  stic_test_contains(stic_test_program("check", scene, trace, NULL)->out, "0 errors");
}

/* Allowed, but seldom meant. */
static void test_warnings(void **state)
{
  const char *odd = stic_test_write(
    "odd.yaml", "stiction: 1\nobject:\n  size: [16, 8, 10]\n  pose: {x: 0, y: 20}\n"
                "hand: {stiffness: 200, rotational_stiffness: 0.5, hold: button}\n"
                "friction: {static: 0.5, dynamic: 0.3}\nsurfaces:\n"
                "  - {name: a, point: [0, 0], normal_deg: 90, friction: {static: 1, dynamic: 1}}\n"
                "  - {name: a, point: [0, -1], normal_deg: 90, friction: {static: 1, dynamic: 1}}\n");
  const stic_test_run *run = stic_test_program("check", odd, trace, NULL);

  (void)state;
  expect(run, 0, "odd.yaml:3: the object is larger than 10 m; lengths are in m, not mm");
  stic_test_contains(run->err, "odd.yaml:9: this surface has the name of an earlier one");
  stic_test_contains(run->err, "odd.yaml:6: friction has no effect: every surface has its own");
  stic_test_contains(run->err, "hand.csv: the grip button is never pressed, and the scene has hold: button");
  assert_string_equal(run->out, "0 errors, 4 warnings\n");
}

/* A device that is a bad file ends the run as the file's own reader would. */
static void test_run_bad_trace(void **state)
{
  char device[300];

  (void)state;
  snprintf(device, sizeof device, "trace:file=%s", bad_trace);
  expect(stic_test_program("run", scene, "--device", device, NULL), 3, "bad.csv:3: found 2 fields");
}

static void test_outputs(void **state)
{
  const char *log = stic_test_path("log.csv"), *again = stic_test_path("again.csv");
  char *first, *second;

  (void)state;
  expect(stic_test_program("replay", scene, trace, "--log", log, "--events", stic_test_path("e.csv"),
                           "--timing", stic_test_path("t.json"), NULL),
         0, "");
  expect(stic_test_program("replay", scene, trace, "--log", again, NULL), 0, "");
  first = stic_test_read(log);
  second = stic_test_read(again);
  assert_string_equal(first, second);
  free(first);
  free(second);
  expect(stic_test_program("replay", scene, trace, "--log", "/dev/full", NULL), 5, "No space left");
  expect(stic_test_program("replay", scene, trace, "--log", "", NULL), 5, "the output's name is empty");
  expect(stic_test_program("replay", scene, trace, "--log", "/nonexistent/log", NULL), 5, "cannot write");
  expect(stic_test_program("replay", scene, trace, "--events", "/nonexistent/e", "--log",
                           stic_test_path("no.csv"), NULL),
         5, "");
  assert_int_equal(access(stic_test_path("no.csv"), F_OK), -1);
  assert_int_equal(stic_test_count_entries(".tmp"), 0);
}

/* A replay that waits for more of its trace is ended by a signal and leaves nothing. */
static void test_signal_replay(void **state)
{
  static const int signals[] = {SIGINT, SIGTERM};
  const char *pipe_path = stic_test_path("pipe"), *log = stic_test_path("signal.csv");
  const char *const arguments[] = {"replay", scene, pipe_path, "--log", log, NULL};

  (void)state;
  assert_int_equal(mkfifo(pipe_path, 0600), 0);
  for (int i = 0; i < 2; i++) {
    const pid_t child = stic_test_start(NULL, arguments);
    const int fd = open(pipe_path, O_WRONLY);
    static const char text[] = "# stiction-trace 1\n0,0.3,0.2,0,0,0,0,1,0\n";

    assert_true(fd >= 0);
    assert_int_equal(write(fd, text, sizeof text - 1), sizeof text - 1);
    stic_test_pause(100);
    kill(child, signals[i]);
    assert_int_equal(stic_test_wait(child), 128 + signals[i]);
    close(fd);
    assert_int_equal(access(log, F_OK), -1);
    assert_int_equal(stic_test_count_entries(".tmp"), 0);
  }
}

static void test_signal_run(void **state)
{
  char device[300];
  const char *log = stic_test_path("live.csv"), *record = stic_test_path("record.csv");
  const char *const arguments[] = {"run", scene, "--device", device, "--log", log, "--record", record, NULL};
  pid_t child;

  (void)state;
  snprintf(device, sizeof device, "trace:loop,file=%s", trace);
  child = stic_test_start(NULL, arguments);
  stic_test_wait_for_rows(child, record, 10);
  kill(child, SIGINT);
  assert_int_equal(stic_test_wait(child), 0);
  assert_true(stic_test_count_rows(log) >= 10);
  assert_int_equal(stic_test_count_rows(log), stic_test_count_rows(record));
  /* After kill -9 the recording is there, whole lines and all. */
  unlink(record);
  child = stic_test_start(NULL, arguments);
  stic_test_wait_for_rows(child, record, 10);
  kill(child, SIGKILL);
  assert_int_equal(stic_test_wait(child), 1000 + SIGKILL);
  assert_true(stic_test_count_rows(record) >= 10);
  expect(stic_test_program("replay", scene, record, NULL), 0, "");
}

/* What a run recorded gives the run's rows again. */
static void test_run_and_replay(void **state)
{
  char device[300], *live, *again;
  const char *record = stic_test_path("record2.csv");

  (void)state;
  snprintf(device, sizeof device, "trace:speed=100,file=%s", trace);
  expect(stic_test_program("run", scene, "--device", device, "--record", record, "--log",
                           stic_test_path("l1.csv"), "--timing", stic_test_path("t1.json"), NULL),
         0, "500 samples");
  expect(stic_test_program("replay", scene, record, "--log", stic_test_path("l2.csv"), NULL), 0, "");
  live = stic_test_read(stic_test_path("l1.csv"));
  again = stic_test_read(stic_test_path("l2.csv"));
  assert_string_equal(strstr(live, "\nt,state"), strstr(again, "\nt,state"));
  free(live);
  free(again);
}

/* The value of a "# key: value" line; the caller frees. */
static char *provenance(const char *log, const char *key)
{
  char start[64], *value;
  const char *at;
  size_t length;

  snprintf(start, sizeof start, "\n# %s: ", key);
  at = strstr(log, start);
  assert_non_null(at);
  at += strlen(start);
  length = strcspn(at, "\n");
  value = malloc(length + 1);
  memcpy(value, at, length);
  value[length] = '\0';
  return value;
}

/* The choice is written down, and a replay with it gives the run's rows. */
static void check_auto(const char *budget, const char *said, const char *noted)
{
  const char *log = stic_test_path("auto.csv"), *record = stic_test_path("auto-record.csv"),
             *again = stic_test_path("auto-again.csv");
  char device[300], *live, *recorded, *replayed, *accuracy, *precision, *note;

  snprintf(device, sizeof device, "trace:speed=100,file=%s", trace);
  expect(stic_test_program("run", scene, "--device", device, "--accuracy", "auto", "--record", record,
                           "--log", log, budget ? "--budget-ns" : NULL, budget, NULL),
         0, said);
  live = stic_test_read(log);
  recorded = stic_test_read(record);
  accuracy = provenance(live, "accuracy");
  precision = provenance(live, "precision");
  stic_test_contains(accuracy, noted);
  stic_test_contains(recorded, accuracy);
  stic_test_contains(recorded, precision);
  note = strstr(accuracy, " (auto");
  assert_non_null(note);
  *note = '\0';
  expect(stic_test_program("replay", scene, record, "--accuracy", accuracy, "--precision", precision, "--log",
                           again, NULL),
         0, "");
  replayed = stic_test_read(again);
  assert_string_equal(strstr(live, "\nt,state"), strstr(replayed, "\nt,state"));
  free(live);
  free(recorded);
  free(replayed);
  free(accuracy);
  free(precision);
}

static void test_auto(void **state)
{
  char device[300];
  const stic_test_run *run;

  (void)state;
  check_auto(NULL, "accuracy auto: ", "(auto, budget 3225806 ns)");
  check_auto("1", "warning: accuracy auto: ", "(auto, budget 1 ns)");
  check_auto("100000000000", "accuracy auto: ", "(auto, budget 100000000000 ns)");
  /* With all the time there is, the most accurate: if the machine gets through all of its samples. */
  snprintf(device, sizeof device, "trace:speed=100,file=%s", trace);
  run = stic_test_program("run", scene, "--device", device, "--accuracy", "auto", "--budget-ns",
                          "100000000000", NULL);
  expect(run, 0, strstr(run->err, " and more") ? "accuracy auto: " : "accuracy auto: event ");
  expect(stic_test_program("replay", scene, trace, "--accuracy", "auto", NULL), 2, "'auto' is for run only");
  expect(stic_test_program("run", scene, "--device", "x", "--accuracy", "auto", "--precision", "f64", NULL),
         2, "does not go with it");
  expect(stic_test_program("run", scene, "--device", "x", "--accuracy", "auto", "--budget-ns", "0", NULL), 2,
         "expected at least 1");
  expect(stic_test_program("run", scene, "--device", "x", "--budget-ns", "5000", NULL), 2,
         "goes with --accuracy auto only");
}

/* One message, and no report of a loop that had nothing to do. */
static void test_no_sample(void **state)
{
  char device[300];
  const stic_test_run *run;

  (void)state;
  snprintf(device, sizeof device, "trace:file=%s", scene);
  run = stic_test_program("run", scene, "--device", device, NULL);
  expect(run, 3, "expected '# stiction-trace 1'");
  assert_ptr_equal(strchr(run->err, '\n'), run->err + strlen(run->err) - 1);
}

static void test_standard_streams(void **state)
{
  const char *const arguments[] = {"replay", scene, "-", "--log", "-", NULL};
  char *out;

  (void)state;
  assert_int_equal(stic_test_wait(stic_test_start(trace, arguments)), 0);
  out = stic_test_read(stic_test_path("out"));
  stic_test_contains(out, "# stiction-log 1\n");
  stic_test_contains(out, "\n9.980000000,");
  free(out);
}

/* A reader that leaves ends the program without a word. */
static void test_closed_pipe(void **state)
{
  char command[1024];
  char *text;
  int status;

  (void)state;
  snprintf(command, sizeof command,
           "( \"$STICTION\" replay %s %s --log - 2>%s; echo $? >%s ) | head -1 >/dev/null", scene, trace,
           stic_test_path("pipe-err"), stic_test_path("pipe-code"));
  status = system(command);
  assert_int_equal(status, 0);
  text = stic_test_read(stic_test_path("pipe-err"));
  assert_string_equal(text, "");
  free(text);
  /* A recording: the trace has no end, so nothing but the closed pipe ends the run. */
  snprintf(command, sizeof command,
           "( \"$STICTION\" run %s --device trace:speed=100,loop,file=%s --record - 2>%s; echo $? >%s ) | "
           "head -1 >/dev/null",
           scene, trace, stic_test_path("pipe-err"), stic_test_path("pipe-code"));
  status = system(command);
  assert_int_equal(status, 0);
  text = stic_test_read(stic_test_path("pipe-err"));
  assert_null(strstr(text, "cannot write"));
  free(text);
  text = stic_test_read(stic_test_path("pipe-code"));
  assert_string_equal(text, "141\n");
  free(text);
}

static void test_frames(void **state)
{
  const char *folder = stic_test_path("frames");
  char *text = stic_test_trace(26); /* 0.5 s: 16 pictures */
  const char *short_trace = stic_test_write("short.csv", text);
  char path[300];

  (void)state;
  free(text);
  expect(stic_test_program("replay", scene, short_trace, "--frames", folder, "--size", "160x120", NULL), 0,
         "");
  snprintf(path, sizeof path, "%s/frame_000015.png", folder);
  assert_int_equal(access(path, F_OK), 0);
  snprintf(path, sizeof path, "%s/frame_000016.png", folder);
  assert_int_equal(access(path, F_OK), -1);
  expect(stic_test_program("replay", scene, short_trace, "--frames", folder, "--size", "160x120", NULL), 5,
         "--force");
  expect(
    stic_test_program("replay", scene, short_trace, "--frames", folder, "--size", "160x120", "--force", NULL),
    0, "");
}

/* The clock shows in pictures of a replay only when it is asked for. */
static void test_hud_timing(void **state)
{
  static const char *const names[] = {"hud-a", "hud-b", "hud-timing"};
  char *text = stic_test_trace(3), *pictures[3];
  const char *tiny_trace = stic_test_write("tiny.csv", text);
  struct stat st[3];
  char path[300];

  (void)state;
  free(text);
  for (int i = 0; i < 3; i++) {
    const char *folder = stic_test_path(names[i]);

    expect(stic_test_program("replay", scene, tiny_trace, "--frames", folder, "--size", "640x360",
                             i == 2 ? "--hud-timing" : NULL, NULL),
           0, "");
    snprintf(path, sizeof path, "%s/frame_000000.png", folder);
    pictures[i] = stic_test_read(path);
    assert_non_null(pictures[i]);
    assert_int_equal(stat(path, &st[i]), 0);
  }
  assert_int_equal(st[0].st_size, st[1].st_size);
  assert_memory_equal(pictures[0], pictures[1], (size_t)st[0].st_size);
  assert_true(st[0].st_size != st[2].st_size || memcmp(pictures[0], pictures[2], (size_t)st[0].st_size) != 0);
  for (int i = 0; i < 3; i++)
    free(pictures[i]);
}

/* One picture per 1/31 s of the run, whether it was drawn or dropped. */
static void test_run_frames(void **state)
{
  const char *folder = stic_test_path("run-frames"), *log = stic_test_path("run-frames.csv"),
             *record = stic_test_path("run-frames-hand.csv");
  const char *const arguments[] = {"run",    scene,     "--device", "sample:rate=100", "--frames",
                                   folder,   "--log",   log,        "--record",        record,
                                   "--size", "160x120", NULL};
  char *text, path[300];
  double first, last;
  pid_t child;
  int pictures;

  (void)state;
  child = stic_test_start(NULL, arguments);
  stic_test_wait_for_rows(child, record, 70);
  kill(child, SIGINT);
  assert_int_equal(stic_test_wait(child), 0);
  text = stic_test_read(log);
  first = strtod(strchr(strstr(text, "\nt,state") + 1, '\n'), NULL);
  text[strlen(text) - 1] = '\0';
  last = strtod(strrchr(text, '\n'), NULL);
  pictures = (int)((last - first) * 31) + 1;
  snprintf(path, sizeof path, "%s/frame_%06d.png", folder, pictures - 1);
  assert_int_equal(access(path, F_OK), 0);
  snprintf(path, sizeof path, "%s/frame_%06d.png", folder, pictures);
  assert_int_equal(access(path, F_OK), -1);
  free(text);
  text = stic_test_read(stic_test_path("err"));
  snprintf(path, sizeof path, "%d pictures, ", pictures);
  stic_test_contains(text, path);
  free(text);
  /* Refused before the first sample. */
  expect(stic_test_program("run", scene, "--device", "sample", "--frames", folder, NULL), 5, "--force");
  expect(stic_test_program("run", scene, "--device", "sample", "--video", stic_test_path("v.avi"), NULL), 2,
         "");
}

static void test_bench(void **state)
{
  const stic_test_run *run;

  (void)state;
  run = stic_test_program("bench", "speed", "--quick", NULL);
  expect(run, 0, "");
  stic_test_contains(run->out, "hash");
  stic_test_contains(run->out, "CSV to CSV");
  expect(stic_test_program("bench", "extremes", "--random", "0", NULL), 2, "above 0");
  expect(stic_test_program("bench", "extremes", "--sweep", "x", NULL), 2, "expected stiffness, ");
  expect(stic_test_program("bench", "extremes", "--sweep", "shape", "--case", "99999", NULL), 2,
         "no case 99999");
  expect(stic_test_program("bench", "extremes", "--random", "1", "--picture", "x.png", NULL), 2, "of sweeps");
  expect(stic_test_program("bench", "extremes", "--seed", "2", "--sweep", "still", NULL), 2, "--random only");
  expect(stic_test_program("bench", "extremes", "--long", "--random", "9", NULL), 2, "only without");
  expect(stic_test_program("bench", "extremes", "--sweep", "shape", "--picture", "x.png", NULL), 2, "k_p-mu");
  expect(stic_test_program("bench", "devices", "--seconds", "0", NULL), 2, "expected 0.1 to");
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_help),
    cmocka_unit_test(test_version),
    cmocka_unit_test(test_usage),
    cmocka_unit_test(test_bad_files),
    cmocka_unit_test(test_warnings),
    cmocka_unit_test(test_run_bad_trace),
    cmocka_unit_test(test_outputs),
    cmocka_unit_test(test_signal_replay),
    cmocka_unit_test(test_signal_run),
    cmocka_unit_test(test_run_and_replay),
    cmocka_unit_test(test_auto),
    cmocka_unit_test(test_no_sample),
    cmocka_unit_test(test_standard_streams),
    cmocka_unit_test(test_closed_pipe),
    cmocka_unit_test(test_hud_timing),
    cmocka_unit_test(test_run_frames),
    cmocka_unit_test(test_frames),
    cmocka_unit_test(test_bench),
  };

  return cmocka_run_group_tests(tests, set_up, stic_test_clean_up);
}

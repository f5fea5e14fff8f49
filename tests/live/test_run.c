/* stiction run as users have it: recordings that give the log again, whatever happens to device, disk and program. */
#include "../files/help.h"
#include "io/timing.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define MS INT64_C(1000000)

static const char *scene, *trace, *log_path, *record, *events, *timing;

static int set_up(void **state)
{
  char *text = stic_test_trace(500);

  (void)state;
  scene = stic_test_write("scene.yaml", stic_test_scene);
  trace = stic_test_write("trace.csv", text);
  log_path = stic_test_path("live.csv");
  record = stic_test_path("record.csv");
  events = stic_test_path("events.csv");
  timing = stic_test_path("timing.json");
  free(text);
  return 0;
}

/* ---- what files hold ----------------------------------------------------------------------- */

static int count_lines(const char *text)
{
  int count = 0;

  for (const char *c = text; *c; c++)
    count += *c == '\n';
  return count;
}

static int recorded(void)
{
  return stic_test_count_rows(record);
}

static void wait_for_recorded(pid_t child, int count)
{
  stic_test_wait_for_rows(child, record, count);
}

/* Replays the recording; the text of its log, to be freed. */
static char *replay(void)
{
  const char *again = stic_test_path("again.csv"), *again_events = stic_test_path("again-events.csv");
  const stic_test_run *run =
    stic_test_program("replay", scene, record, "--log", again, "--events", again_events, NULL);

  if (run->code != 0)
    fail_msg("replay: exit code %d: %s", run->code, run->err);
  return stic_test_read(again);
}

/* Log and events are, byte for byte, what replay makes of the recording. */
static void check_replay(void)
{
  char *live = stic_test_read(log_path), *again = replay();
  char *live_events = stic_test_read(events),
       *again_events = stic_test_read(stic_test_path("again-events.csv"));

  assert_non_null(live);
  assert_true(count_lines(stic_test_rows(live)) > 0);
  assert_int_equal(count_lines(stic_test_rows(live)), recorded());
  assert_string_equal(stic_test_rows(live), stic_test_rows(again));
  assert_string_equal(live_events, again_events);
  free(live);
  free(again);
  free(live_events);
  free(again_events);
}

/* A whole number of the timing summary. */
static int64_t summary(const char *name)
{
  char *text = stic_test_read(timing), key[64];
  const char *at;
  int64_t value;

  snprintf(key, sizeof key, "\"%s\": ", name);
  assert_non_null(text);
  at = strstr(text, key);
  assert_non_null(at);
  value = strtoll(at + strlen(key), NULL, 10);
  free(text);
  return value;
}

static pid_t start(const char *device)
{
  const char *const arguments[] = {"run",  scene,      "--device", device,     "--log", log_path, "--record",
                                   record, "--events", events,     "--timing", timing,  NULL};

  unlink(log_path);
  unlink(record);
  return stic_test_start(NULL, arguments);
}

static void stop(pid_t child, int number)
{
  int code;

  kill(child, number);
  code = stic_test_wait(child);
  if (code != 0)
    fail_msg("exit code %d: %s", code, stic_test_read(stic_test_path("err")));
}

/* ---- replay gives the run again ------------------------------------------------------------ */

static void test_devices(void **state)
{
  static const char *const devices[] = {"sample:rate=1000", "sample:rate=50", "sample:rate=3"};

  (void)state;
  for (size_t i = 0; i < sizeof devices / sizeof devices[0]; i++) {
    pid_t child = start(devices[i]);

    wait_for_recorded(child, 60);
    stop(child, SIGINT);
    check_replay();
    assert_int_equal(summary("frames"), recorded());
    assert_int_equal(summary("lost_samples"), 0);
  }
  /* Three samples a second: nearly all are the last pose again. */
  assert_true(summary("repeated") > 40);
}

static void test_trace(void **state)
{
  char device[300], *log, *again;

  (void)state;
  snprintf(device, sizeof device, "trace:speed=100,file=%s", trace);
  assert_int_equal(stic_test_wait(start(device)), 0);
  check_replay();
  assert_int_equal(summary("repeated"), 0);
  assert_int_equal(summary("frames"), 500);
  /* A trace is solved as if it were replayed itself. */
  stic_test_program("replay", scene, trace, "--log", stic_test_path("again.csv"), NULL);
  log = stic_test_read(log_path);
  again = stic_test_read(stic_test_path("again.csv"));
  assert_string_equal(stic_test_rows(log), stic_test_rows(again));
  free(log);
  free(again);
}

static void test_signals(void **state)
{
  unsigned random = 1;
  char device[300];

  (void)state;
  snprintf(device, sizeof device, "trace:loop,speed=20,file=%s", trace);
  for (int i = 0; i < 10; i++) {
    const pid_t child = start(i % 2 ? device : "sample:rate=500");

    wait_for_recorded(child, 1);
    random = random * 1103515245 + 12345;
    stic_clock_sleep_until(stic_clock_ns() + (int64_t)(random >> 16) * 3000);
    stop(child, i % 3 ? SIGINT : SIGTERM);
    check_replay();
  }
}

/* A source that says nothing for ever does not keep a run from ending. */
static void test_silent_pipe(void **state)
{
  const char *pipe_path = stic_test_path("silent");
  const char *const arguments[] = {"run", scene, "--device", "trace:file=-", "--log", log_path, NULL};
  int fd;
  pid_t child;

  (void)state;
  assert_int_equal(mkfifo(pipe_path, 0600), 0);
  fd = open(pipe_path, O_RDWR);
  child = stic_test_start(pipe_path, arguments);
  stic_test_pause(300);
  stop(child, SIGINT);
  close(fd);
  assert_int_equal(stic_test_count_rows(log_path), 0);
}

static void test_kill(void **state)
{
  const char *const arguments[] = {"run",      scene,  "--device", "sample:rate=1000", "--log", "-",
                                   "--record", record, NULL};
  char *out, *again;
  const char *rows, *again_rows, *end;
  pid_t child;

  (void)state;
  unlink(record);
  child = stic_test_start(NULL, arguments);
  wait_for_recorded(child, 300);
  kill(child, SIGKILL);
  assert_int_equal(stic_test_wait(child), 1000 + SIGKILL);
  out = stic_test_read(stic_test_path("out")); /* before replay has it */
  again = replay();
  rows = stic_test_rows(out);
  again_rows = stic_test_rows(again);
  end = strrchr(rows, '\n');
  /* What is in the log was recorded before. */
  assert_true(count_lines(again_rows) >= 300);
  assert_true(count_lines(rows) > 0 && count_lines(rows) <= count_lines(again_rows));
  assert_memory_equal(rows, again_rows, (size_t)(end - rows) + 1);
  free(again);
  free(out);
}

/* ---- disks and readers --------------------------------------------------------------------- */

/* What a shell says of its command's exit code. */
static int shell(const char *command)
{
  const int status = system(command);

  assert_true(WIFEXITED(status));
  return WEXITSTATUS(status);
}

/* A disk of 20 KiB; a coverage build's counts go elsewhere, as it would cut them off too. */
static void test_full_disk(void **state)
{
  const char *err_path = stic_test_path("full-err");
  char command[1200], *log, *again, *err;

  (void)state;
  snprintf(
    command, sizeof command,
    "trap '' XFSZ; ulimit -f 40; export GCOV_PREFIX=%s; exec \"$STICTION\" run %s --device sample:rate=1000 --record %s "
    "--log - 2>%s >%s",
    stic_test_folder(), scene, record, err_path, stic_test_path("full-log"));
  /* Rows are longer than samples: so the log is full first ... */
  assert_int_equal(shell(command), 5);
  again = replay();
  err = stic_test_read(err_path);
  stic_test_contains(err, "cannot write");
  free(err);
  log = stic_test_read(stic_test_path("full-log"));
  assert_true(strlen(log) == 40 * 512);
  *strrchr(log, '\n') = '\0';
  assert_memory_equal(stic_test_rows(log), stic_test_rows(again), strlen(stic_test_rows(log)));
  free(log);
  free(again);
  /* ... and here the recording. */
  snprintf(
    command, sizeof command,
    "(trap '' XFSZ; ulimit -f 40; export GCOV_PREFIX=%s; \"$STICTION\" run %s --device sample:rate=1000 --record %s "
    "--log - 2>%s; test $? = 5 && echo five >>%s) | cat >%s",
    stic_test_folder(), scene, record, err_path, err_path, log_path);
  assert_int_equal(shell(command), 0);
  err = stic_test_read(err_path);
  stic_test_contains(err, "cannot write the recording");
  stic_test_contains(err, "\nfive\n");
  free(err);
  log = stic_test_read(log_path);
  again = replay();
  assert_true(count_lines(stic_test_rows(again)) > 100);
  assert_string_equal(stic_test_rows(log), stic_test_rows(again));
  free(log);
  free(again);
}

static void test_full_device(void **state)
{
  const stic_test_run *run;

  (void)state;
  run = stic_test_program("run", scene, "--device", "sample:rate=1000", "--log", "/dev/full", "--record",
                          record, NULL);
  assert_int_equal(run->code, 5);
  stic_test_contains(run->err, "/dev/full: cannot write: No space left");
  free(replay());
  run = stic_test_program("run", scene, "--device", "sample", "--record", "/dev/full", NULL);
  assert_int_equal(run->code, 5);
  stic_test_contains(run->err, "cannot write the recording: No space left");
}

/* Nobody reads the log for a while: the loop goes on, and later all rows come in order. */
static void test_slow_reader(void **state)
{
  const char *fifo = stic_test_path("slow");
  const char *const arguments[] = {"run",      scene,  "--device", "sample:rate=1000",
                                   "--log",    fifo,   "--record", record,
                                   "--timing", timing, NULL};
  static char text[4 << 20];
  char *again;
  size_t used = 0;
  ssize_t n;
  int fd;
  pid_t child;

  (void)state;
  unlink(record);
  assert_int_equal(mkfifo(fifo, 0600), 0);
  fd = open(fifo, O_RDWR);
  child = stic_test_start(NULL, arguments);
  wait_for_recorded(child, 1);
  stic_test_pause(1500);
  kill(child, SIGTERM);
  /* It ends only when all is read; the test's own end of the pipe must not hold it open then. */
  while (used < 65536 && (n = read(fd, text + used, 4096)) > 0)
    used += (size_t)n;
  {
    const int only_read = open(fifo, O_RDONLY);

    close(fd);
    while (used < sizeof text - 1 && (n = read(only_read, text + used, sizeof text - 1 - used)) > 0)
      used += (size_t)n;
    close(only_read);
  }
  text[used] = '\0';
  assert_int_equal(stic_test_wait(child), 0);
  again = replay();
  assert_string_equal(stic_test_rows(text), stic_test_rows(again));
  assert_int_equal(summary("lost_samples"), 0);
  /* More than a pipe holds waited, so the solver was not held up. */
  assert_true(summary("rows_queued_most") > 300);
  free(again);
}

/* ---- a tracker that is pulled out ---------------------------------------------------------- */

static pid_t start_emulator(const char *link)
{
  const char *program = getenv("LOGITECH_EMULATOR");
  const pid_t child = fork();

  assert_non_null(program);
  assert_true(child >= 0);
  if (child == 0) {
    const int null = open("/dev/null", O_WRONLY);

    dup2(null, STDOUT_FILENO);
    dup2(null, STDERR_FILENO);
    execl(program, "logitech-emulator", "--link", link, (char *)NULL);
    _exit(98);
  }
  while (access(link, F_OK) != 0)
    stic_test_pause(10);
  return child;
}

static int rows_with_flag_lost(void)
{
  char *text = stic_test_read(record), *line;
  int count = 0;

  for (line = strtok(text, "\n"); line; line = strtok(NULL, "\n")) {
    const char *comma = strrchr(line, ',');

    count += comma && strtoul(comma + 1, NULL, 10) >= 0x80000000u;
  }
  free(text);
  return count;
}

static void test_unplug(void **state)
{
  const char *link = stic_test_path("tracker");
  char device[300], *err;
  pid_t child, emulator = start_emulator(link);
  int lost, tracked;

  (void)state;
  snprintf(device, sizeof device, "logitech:port=%s", link);
  child = start(device);
  wait_for_recorded(child, 60);
  kill(emulator, SIGTERM);
  waitpid(emulator, NULL, 0);
  while ((lost = rows_with_flag_lost()) < 10)
    wait_for_recorded(child, recorded() + 1);
  emulator = start_emulator(link);
  tracked = recorded() - lost;
  while (recorded() - rows_with_flag_lost() < tracked + 60)
    wait_for_recorded(child, recorded() + 1);
  stop(child, SIGINT);
  kill(emulator, SIGTERM);
  waitpid(emulator, NULL, 0);
  err = stic_test_read(stic_test_path("err"));
  stic_test_contains(err, "the tracker is lost");
  free(err);
  check_replay();
  assert_true(summary("repeated") > 5);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_devices),     cmocka_unit_test(test_trace),       cmocka_unit_test(test_signals),
    cmocka_unit_test(test_silent_pipe), cmocka_unit_test(test_kill),        cmocka_unit_test(test_full_disk),
    cmocka_unit_test(test_full_device), cmocka_unit_test(test_slow_reader), cmocka_unit_test(test_unplug),
  };

  return cmocka_run_group_tests(tests, set_up, stic_test_clean_up);
}

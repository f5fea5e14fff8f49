/* Silence, back-off, and the supervisor over a real port: stale, unplugged, plugged in again. */
#define _XOPEN_SOURCE 700 /* symlink() */
#include "../../drivers/connection.h"
#include "../../drivers/raw_recording.h"
#include "../../src/io/timing.h"
#include "../files/help.h"
#include "logitech_emulator.h"

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define MS INT64_C(1000000)
#define S INT64_C(1000000000)

/* ---- silence and back-off ---------------------------------------------------------------- */

static void test_watch_stale(void **state)
{
  stic_watch w;

  (void)state;
  stic_watch_begin(&w, STIC_SILENCE_STALE, 60 * MS);
  assert_int_equal(stic_watch_deadline(&w), INT64_MAX);
  assert_int_equal(stic_watch_look(&w, 100 * S), STIC_WATCH_NONE); /* its start is the driver's */
  stic_watch_heard(&w, S);
  assert_int_equal(stic_watch_deadline(&w), S + 60 * MS);
  assert_int_equal(stic_watch_look(&w, S + 60 * MS - 1), STIC_WATCH_NONE);
  assert_int_equal(stic_watch_look(&w, S + 60 * MS), STIC_WATCH_STALE);
  assert_int_equal(stic_watch_look(&w, S + 61 * MS), STIC_WATCH_NONE);
  assert_int_equal(stic_watch_deadline(&w), S + 2 * S);
  stic_watch_heard(&w, 2 * S);
  assert_int_equal(stic_watch_look(&w, 3 * S), STIC_WATCH_STALE);
  assert_int_equal(stic_watch_look(&w, 4 * S), STIC_WATCH_LOST);
}

static void test_watch_rest(void **state)
{
  stic_watch w;

  (void)state;
  stic_watch_begin(&w, STIC_SILENCE_REST, 100 * MS);
  stic_watch_heard(&w, S);
  assert_int_equal(stic_watch_look(&w, S + 100 * MS), STIC_WATCH_REST);
  assert_int_equal(stic_watch_look(&w, 1000 * S), STIC_WATCH_NONE);
  assert_int_equal(stic_watch_deadline(&w), INT64_MAX);
  /* A press after it was plugged in again is no old one: a key that was let go meanwhile is never told. */
  assert_false(stic_watch_bars_grip(&w));
  stic_watch_begin(&w, STIC_SILENCE_STALE, 0);
  stic_watch_heard(&w, S);
  assert_int_equal(stic_watch_look(&w, 1000 * S), STIC_WATCH_NONE);
  assert_true(stic_watch_bars_grip(&w));
  /* Slower than 2 s by nature: never lost before it is stale. */
  stic_watch_begin(&w, STIC_SILENCE_STALE, 3 * S);
  stic_watch_heard(&w, S);
  assert_int_equal(stic_watch_look(&w, 3 * S + 1), STIC_WATCH_NONE);
  assert_int_equal(stic_watch_look(&w, 4 * S), STIC_WATCH_STALE);
}

static void test_backoff(void **state)
{
  static const int64_t waits_ms[] = {500, 1000, 2000, 4000, 5000, 5000};
  stic_watch w;

  (void)state;
  stic_watch_begin(&w, STIC_SILENCE_STALE, 60 * MS);
  for (int round = 0; round < 2; round++) {
    for (size_t i = 0; i < sizeof waits_ms / sizeof waits_ms[0]; i++) {
      stic_watch_lost(&w, S);
      assert_int_equal(w.retry_ns, S + waits_ms[i] * MS);
    }
    stic_watch_heard(&w, S);
  }
}

/* ---- the supervisor over a port ---------------------------------------------------------- */

/* The unit lives in a thread of its own; the faults are set before it starts. */
typedef struct plugged {
  emulator unit;
  logitech_pty pty;
  pthread_t thread;
  pthread_mutex_t lock;
  bool stopped;
} plugged;

static void hand_held(void *context, int64_t t_ns, emulator_record *record)
{
  (void)context, (void)t_ns;
  memset(record, 0, sizeof *record);
  record->position[1] = 4000;
  record->bits = 4;
}

static bool is_stopped(plugged *p)
{
  bool stopped;

  pthread_mutex_lock(&p->lock);
  stopped = p->stopped;
  pthread_mutex_unlock(&p->lock);
  return stopped;
}

static void *live(void *context)
{
  plugged *p = context;

  while (!is_stopped(p) && logitech_pty_serve(&p->pty, 10 * MS))
    ;
  return NULL;
}

static const char *port_path(void)
{
  return stic_test_path("port");
}

static void plug_in(plugged *p)
{
  assert_true(logitech_pty_open(&p->pty, &p->unit));
  unlink(port_path());
  assert_int_equal(symlink(p->pty.path, port_path()), 0);
  p->stopped = false;
  pthread_mutex_init(&p->lock, NULL);
  assert_int_equal(pthread_create(&p->thread, NULL, live, p), 0);
}

static void unplug(plugged *p)
{
  pthread_mutex_lock(&p->lock);
  p->stopped = true;
  pthread_mutex_unlock(&p->lock);
  pthread_join(p->thread, NULL);
  logitech_pty_serve(&p->pty, 5 * MS); /* what the driver sent last */
  pthread_mutex_destroy(&p->lock);
  unlink(port_path());
  logitech_pty_close(&p->pty);
}

typedef struct history {
  int count;
  stic_connection states[64];
  char texts[64][128];
} history;

static void remember(void *context, stic_connection state, const char *text)
{
  history *h = context;

  assert_true(h->count < 64);
  snprintf(h->texts[h->count], sizeof h->texts[0], "%s", text);
  h->states[h->count++] = state;
}

static stic_supervisor *open_supervised(history *h, int64_t give_up_ns)
{
  const stic_supervisor_options options = {remember, h, give_up_ns};
  stic_supervisor *s;
  stic_error err;
  char spec[600];
  int n = snprintf(spec, sizeof spec, "logitech:port=%s", port_path());

  snprintf(spec + n, sizeof spec - (size_t)n, ",raw=%s", stic_test_path("raw.txt"));
  memset(h, 0, sizeof *h);
  assert_int_equal(stic_supervisor_open(spec, &options, &s, &err), STIC_OK);
  return s;
}

/* Polls until a sample fits all of `flags` and `buttons`; others must be in order of time. */
static stic_device_sample wait_for(stic_supervisor *s, unsigned flags, unsigned mask, uint32_t buttons,
                                   int64_t limit_ns)
{
  static int64_t last_ns;
  const int64_t end_ns = stic_clock_ns() + limit_ns;
  stic_device_sample samples[16];

  while (stic_clock_ns() < end_ns) {
    const int n = stic_supervisor_poll(s, stic_clock_ns() + 30 * MS, samples, 16);

    assert_true(n >= 0);
    for (int i = 0; i < n; i++) {
      assert_true(samples[i].t_ns > last_ns);
      last_ns = samples[i].t_ns;
    }
    if (n > 0 && (samples[n - 1].flags & mask) == flags && samples[n - 1].buttons == buttons)
      return samples[n - 1];
  }
  fail_msg("no such sample in %lld ms", (long long)(limit_ns / MS));
  return samples[0];
}

static void test_stale(void **state)
{
  plugged p;
  history h;
  stic_supervisor *s;
  stic_device_sample sample;
  int64_t gripped_ns;

  (void)state;
  emulator_init(&p.unit);
  p.unit.motion = hand_held;
  p.unit.faults.stall_at = 25;
  p.unit.faults.stall_ns = S;
  plug_in(&p);
  s = open_supervised(&h, 0);
  assert_int_equal(stic_supervisor_driver(s)->silence, STIC_SILENCE_STALE);
  sample = wait_for(s, STIC_SAMPLE_TRACKED, STIC_SAMPLE_TRACKED, STIC_BUTTON_GRIP, 5 * S);
  gripped_ns = stic_clock_ns();
  sample = wait_for(s, 0, STIC_SAMPLE_TRACKED, 0, 2 * S);
  assert_int_equal(stic_supervisor_state(s), STIC_CONNECTION_STALE);
  assert_true(sample.position[1] == 4000 * 25.4e-6);
  assert_true(stic_clock_ns() - gripped_ns < 700 * MS);
  /* It streams again with the button still held: that does not count. */
  wait_for(s, STIC_SAMPLE_TRACKED, STIC_SAMPLE_TRACKED, 0, 3 * S);
  assert_int_equal(stic_supervisor_state(s), STIC_CONNECTION_RUNNING);
  for (int i = 0; i < 10; i++)
    wait_for(s, STIC_SAMPLE_TRACKED, STIC_SAMPLE_TRACKED, 0, S);
  stic_supervisor_close(s);
  unplug(&p);
  assert_int_equal(h.count, 5);
  assert_true(h.states[0] == STIC_CONNECTION_RESETTING && h.states[1] == STIC_CONNECTION_SYNCING &&
              h.states[2] == STIC_CONNECTION_RUNNING && h.states[3] == STIC_CONNECTION_STALE &&
              h.states[4] == STIC_CONNECTION_RUNNING);
  stic_test_contains(h.texts[2], "firmware 12");
  assert_true(p.unit.sound_off && !p.unit.wrong_format && p.unit.refused == 0);
}

/* The raw recording of all connections: how many times are before and after `at_ns`. */
static void count_recorded(int64_t at_ns, int *before, int *after)
{
  stic_raw_reader *reader;
  stic_raw_record record;
  stic_raw_status status;
  stic_error err;

  *before = *after = 0;
  assert_int_equal(stic_raw_open(stic_test_path("raw.txt"), &reader, &err), STIC_OK);
  while ((status = stic_raw_next(reader, &record, &err)) == STIC_RAW_RECORD || status == STIC_RAW_WAIT) {
    if (status == STIC_RAW_RECORD)
      ++*(record.t_ns < at_ns ? before : after);
  }
  assert_int_equal(status, STIC_RAW_END);
  stic_raw_close(reader);
}

static void test_unplug_and_replug(void **state)
{
  plugged p;
  history h;
  stic_supervisor *s;
  stic_device_counters counters;
  int64_t at_ns;
  int before, after;

  (void)state;
  emulator_init(&p.unit);
  plug_in(&p);
  s = open_supervised(&h, 0);
  wait_for(s, STIC_SAMPLE_TRACKED, STIC_SAMPLE_TRACKED, STIC_BUTTON_GRIP, 5 * S);
  unplug(&p);
  at_ns = stic_clock_ns();
  wait_for(s, 0, STIC_SAMPLE_TRACKED, 0, 2 * S);
  print_message("unplugged: let go after %.1f ms\n", (double)(stic_clock_ns() - at_ns) / 1e6);
  assert_true(stic_clock_ns() - at_ns < 50 * MS);
  assert_int_equal(stic_supervisor_state(s), STIC_CONNECTION_LOST);
  stic_test_contains(stic_supervisor_error(s)->message, "unplugged");
  /* Retries fail silently; a poll ends in time all the same. */
  while (stic_clock_ns() < at_ns + 1200 * MS) {
    const int64_t from_ns = stic_clock_ns();
    stic_device_sample sample;

    assert_int_equal(stic_supervisor_poll(s, from_ns + 20 * MS, &sample, 1), 0);
    assert_true(stic_clock_ns() - from_ns < 200 * MS);
  }
  emulator_init(&p.unit);
  plug_in(&p);
  at_ns = stic_clock_ns();
  wait_for(s, STIC_SAMPLE_TRACKED, STIC_SAMPLE_TRACKED, 0, 6 * S);
  print_message("plugged in again: tracked after %.0f ms\n", (double)(stic_clock_ns() - at_ns) / 1e6);
  wait_for(s, STIC_SAMPLE_TRACKED, STIC_SAMPLE_TRACKED, STIC_BUTTON_GRIP, 4 * S);
  counters = stic_supervisor_counters(s);
  assert_int_equal(counters.reconnects, 1);
  assert_int_equal(counters.bad_records, 0);
  assert_true(counters.samples > 50);
  stic_supervisor_close(s);
  unplug(&p);
  count_recorded(at_ns, &before, &after);
  print_message("recorded: %d records before, %d after\n", before, after);
  assert_true(before > 20 && after > 20);    /* the first press comes after a second */
  assert_true(h.count >= 4); /* how the start is seen depends on the machine's load */
  assert_int_equal(h.states[h.count - 2], STIC_CONNECTION_LOST);
  assert_int_equal(h.states[h.count - 1], STIC_CONNECTION_RUNNING);
}

static void test_lost_for_good(void **state)
{
  plugged p;
  history h;
  stic_supervisor *s;
  stic_device_sample sample;
  int result;

  (void)state;
  emulator_init(&p.unit);
  plug_in(&p);
  s = open_supervised(&h, 800 * MS);
  wait_for(s, STIC_SAMPLE_TRACKED, STIC_SAMPLE_TRACKED, 0, 5 * S);
  unplug(&p);
  while ((result = stic_supervisor_poll(s, stic_clock_ns() + 30 * MS, &sample, 1)) >= 0)
    assert_true(h.count <= 4);
  assert_int_equal(result, STIC_DRIVER_LOST);
  assert_int_equal(stic_supervisor_send(s, &(const stic_device_output){true}), STIC_DRIVER_LOST);
  stic_supervisor_close(s);
}

static void test_absent(void **state)
{
  stic_supervisor *s;
  stic_error err;

  (void)state;
  assert_int_equal(stic_supervisor_open("logitech:port=/no/such/port", NULL, &s, &err), STIC_NO_DEVICE);
  assert_null(s);
  assert_string_equal(err.file, "/no/such/port");
  assert_int_equal(stic_supervisor_open("nothing", NULL, &s, &err), STIC_USAGE);
}

/* The driver to be copied does what it says. */
static void test_sample_driver(void **state)
{
  stic_supervisor *s;
  stic_device_sample samples[4];
  stic_error err;
  char text[200];
  int count = 0;

  (void)state;
  assert_int_equal(stic_supervisor_open("sample:rate=0", NULL, &s, &err), STIC_USAGE);
  assert_int_equal(stic_supervisor_open("sample:rate=200", NULL, &s, &err), STIC_OK);
  stic_supervisor_describe(s, text, sizeof text);
  stic_test_contains(text, "200 a second");
  for (const int64_t end_ns = stic_clock_ns() + 200 * MS; stic_clock_ns() < end_ns;)
    count += stic_supervisor_poll(s, end_ns, samples, 4);
  assert_in_range(count, 38, 42);
  assert_int_equal(stic_supervisor_state(s), STIC_CONNECTION_RUNNING);
  stic_supervisor_close(s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_watch_stale),
    cmocka_unit_test(test_watch_rest),
    cmocka_unit_test(test_backoff),
    cmocka_unit_test(test_stale),
    cmocka_unit_test(test_unplug_and_replug),
    cmocka_unit_test(test_lost_for_good),
    cmocka_unit_test(test_absent),
    cmocka_unit_test(test_sample_driver),
  };

  return cmocka_run_group_tests(tests, NULL, stic_test_clean_up);
}

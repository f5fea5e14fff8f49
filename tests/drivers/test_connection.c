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

/* The unit lives in a thread of its own; the faults are set before it starts. On a loaded machine silence and loss may
 * come at any time without being asked for: the tests wait for what must come in the end, and say no times. */
typedef struct plugged {
  emulator unit;
  logitech_pty pty;
  pthread_t thread;
  pthread_mutex_t lock;
  bool stopped, silent; /* under the lock */
  bool held;            /* the button; else it is let go for a moment twice a second */
} plugged;

static void hand_held(void *context, int64_t t_ns, emulator_record *record)
{
  plugged *p = context;

  memset(record, 0, sizeof *record);
  record->position[1] = 4000;
  pthread_mutex_lock(&p->lock);
  record->bits = p->held || t_ns / (100 * MS) % 5 > 0 ? 4 : 0;
  pthread_mutex_unlock(&p->lock);
}

static bool get(plugged *p, const bool *flag)
{
  bool value;

  pthread_mutex_lock(&p->lock);
  value = *flag;
  pthread_mutex_unlock(&p->lock);
  return value;
}

static void set(plugged *p, bool *flag, bool value)
{
  pthread_mutex_lock(&p->lock);
  *flag = value;
  pthread_mutex_unlock(&p->lock);
}

static void *live(void *context)
{
  plugged *p = context;

  while (!get(p, &p->stopped)) {
    if (get(p, &p->silent))
      stic_clock_sleep_until(stic_clock_ns() + 10 * MS);
    else if (!logitech_pty_serve(&p->pty, 10 * MS))
      break;
  }
  return NULL;
}

static const char *port_path(void)
{
  return stic_test_path("port");
}

static void plug_in(plugged *p)
{
  emulator_init(&p->unit);
  p->unit.motion = hand_held;
  p->unit.context = p;
  p->stopped = p->silent = p->held = false;
  assert_true(logitech_pty_open(&p->pty, &p->unit));
  unlink(port_path());
  assert_int_equal(symlink(p->pty.path, port_path()), 0);
  pthread_mutex_init(&p->lock, NULL);
  assert_int_equal(pthread_create(&p->thread, NULL, live, p), 0);
}

static void unplug(plugged *p)
{
  set(p, &p->stopped, true);
  pthread_join(p->thread, NULL);
  logitech_pty_serve(&p->pty, 5 * MS); /* what the driver sent last */
  pthread_mutex_destroy(&p->lock);
  unlink(port_path());
  logitech_pty_close(&p->pty);
}

#define HISTORY_MAX 256

typedef struct history {
  int count;
  stic_connection states[HISTORY_MAX];
  char texts[HISTORY_MAX][128];
} history;

static void remember(void *context, stic_connection state, const char *text)
{
  history *h = context;

  assert_true(h->count < HISTORY_MAX);
  assert_true(h->count == 0 || h->states[h->count - 1] != state); /* each change once */
  snprintf(h->texts[h->count], sizeof h->texts[0], "%s", text);
  h->states[h->count++] = state;
}

/* The first time of a state at or after `from`; fails if there is none. */
static int find_state(const history *h, int from, stic_connection state)
{
  while (from < h->count && h->states[from] != state)
    from++;
  assert_true(from < h->count);
  return from;
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

/* Polls until the newest sample is tracked or not and has just these buttons. Samples must be in order of time. */
static stic_device_sample wait_for(stic_supervisor *s, bool tracked, uint32_t buttons)
{
  static int64_t last_ns;
  const int64_t end_ns = stic_clock_ns() + 60 * S;
  stic_device_sample samples[16];

  while (stic_clock_ns() < end_ns) {
    const int n = stic_supervisor_poll(s, stic_clock_ns() + 30 * MS, samples, 16);

    assert_true(n >= 0);
    for (int i = 0; i < n; i++) {
      assert_true(samples[i].t_ns > last_ns);
      last_ns = samples[i].t_ns;
      if (!(samples[i].flags & STIC_SAMPLE_TRACKED) == !tracked && samples[i].buttons == buttons)
        return samples[i];
    }
  }
  fail_msg("no %s sample with buttons %u", tracked ? "tracked" : "untracked", (unsigned)buttons);
  return samples[0];
}

static void test_stale(void **state)
{
  plugged p;
  history h;
  stic_supervisor *s;
  stic_device_sample sample;
  int at;

  (void)state;
  plug_in(&p);
  s = open_supervised(&h, 0);
  assert_int_equal(stic_supervisor_driver(s)->silence, STIC_SILENCE_STALE);
  wait_for(s, true, STIC_BUTTON_GRIP);
  set(&p, &p.held, true);
  set(&p, &p.silent, true);
  sample = wait_for(s, false, 0);
  assert_int_equal(stic_supervisor_state(s), STIC_CONNECTION_STALE);
  assert_true(sample.position[1] == 4000 * 25.4e-6);
  /* It streams again with the button still held: that does not count. */
  set(&p, &p.silent, false);
  for (int i = 0; i < 10; i++)
    wait_for(s, true, 0);
  assert_int_equal(stic_supervisor_state(s), STIC_CONNECTION_RUNNING);
  set(&p, &p.held, false);
  wait_for(s, true, STIC_BUTTON_GRIP);
  stic_supervisor_close(s);
  unplug(&p);
  at = find_state(&h, 0, STIC_CONNECTION_RESETTING);
  at = find_state(&h, at, STIC_CONNECTION_SYNCING);
  at = find_state(&h, at, STIC_CONNECTION_RUNNING);
  stic_test_contains(h.texts[at], "firmware 12");
  at = find_state(&h, at, STIC_CONNECTION_STALE);
  find_state(&h, at, STIC_CONNECTION_RUNNING);
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

/* Polls until it is lost, and on for a retry or two, which fail without a word. */
static void poll_while_gone(stic_supervisor *s, const history *h, stic_device_sample *last)
{
  const int64_t end_ns = stic_clock_ns() + 60 * S;
  int64_t lost_ns = 0;
  int told = 0;

  while (lost_ns == 0 || stic_clock_ns() < lost_ns + 700 * MS) {
    stic_device_sample samples[16];
    const int n = stic_supervisor_poll(s, stic_clock_ns() + 20 * MS, samples, 16);

    assert_true(n >= 0 && stic_clock_ns() < end_ns);
    if (n > 0)
      *last = samples[n - 1];
    if (lost_ns == 0 && stic_supervisor_state(s) == STIC_CONNECTION_LOST) {
      lost_ns = stic_clock_ns();
      told = h->count;
      stic_test_contains(stic_supervisor_error(s)->message, "unplugged");
    } else if (lost_ns > 0) {
      assert_int_equal(n, 0);
    }
  }
  assert_int_equal(h->count, told);
}

static void test_unplug_and_replug(void **state)
{
  plugged p;
  history h;
  stic_supervisor *s;
  stic_device_sample last = {0};
  stic_device_counters counters;
  int64_t at_ns;
  int before, after, at;

  (void)state;
  plug_in(&p);
  s = open_supervised(&h, 0);
  wait_for(s, true, STIC_BUTTON_GRIP);
  last.buttons = STIC_BUTTON_GRIP;
  unplug(&p);
  poll_while_gone(s, &h, &last);
  assert_false(last.flags & STIC_SAMPLE_TRACKED);
  assert_int_equal(last.buttons, 0);
  at_ns = stic_clock_ns();
  plug_in(&p);
  wait_for(s, true, 0);
  wait_for(s, true, STIC_BUTTON_GRIP);
  counters = stic_supervisor_counters(s);
  assert_true(counters.reconnects >= 1 && counters.samples >= 4);
  stic_supervisor_close(s);
  unplug(&p);
  count_recorded(at_ns, &before, &after);
  print_message("recorded: %d records before, %d after\n", before, after);
  assert_true(before > 0 && after > 0);
  at = find_state(&h, find_state(&h, 0, STIC_CONNECTION_RUNNING), STIC_CONNECTION_LOST);
  find_state(&h, at, STIC_CONNECTION_RUNNING);
}

static void test_lost_for_good(void **state)
{
  plugged p;
  history h;
  stic_supervisor *s;
  stic_device_sample samples[16];
  int result;

  (void)state;
  plug_in(&p);
  s = open_supervised(&h, 800 * MS);
  wait_for(s, true, 0);
  unplug(&p);
  while ((result = stic_supervisor_poll(s, stic_clock_ns() + 30 * MS, samples, 16)) >= 0)
    ;
  assert_int_equal(result, STIC_DRIVER_LOST);
  assert_int_equal(stic_supervisor_send(s, &(const stic_device_output){true}), STIC_DRIVER_LOST);
  assert_int_equal(h.states[h.count - 1], STIC_CONNECTION_LOST);
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
  for (int64_t last_ns = 0; count < 40;) {
    const int n = stic_supervisor_poll(s, stic_clock_ns() + S, samples, 4);

    for (int i = 0; i < n; i++, count++) {
      assert_true(count == 0 || samples[i].t_ns - last_ns == 5 * MS);
      last_ns = samples[i].t_ns;
    }
  }
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

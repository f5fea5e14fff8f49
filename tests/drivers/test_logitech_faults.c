/* The fault campaign: unit and driver's protocol on one virtual clock, every fault at every place. */
#include "../../drivers/connection.h"
#include "../../drivers/logitech/logitech_protocol.h"
#include "../files/help.h"
#include "logitech_emulator.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define MS 1000000
#define S 1000000000
#define SAFE_ERROR 0.075 /* m, that one garbled record may move the hand */

typedef struct rig {
  emulator unit;
  stic_logitech_protocol driver;
  stic_watch watch;
  int64_t now_ns;
  int result;        /* of the last advance */
  int64_t unplug_ns; /* from then on bytes go nowhere */
  size_t piece;      /* largest read */
  /* what was seen */
  int64_t samples, tracked, wrong; /* wrong: off by more than 1 mm */
  int64_t stale_ns, lost_ns;
  int64_t last_good_ns, longest_gap_ns; /* between correct samples */
  double worst;                         /* m, of tracked samples */
  bool gripped;                         /* by the last sample, or let go as stale */
  uint32_t buttons_seen;
  stic_device_sample last;
} rig;

static bool rig_write(void *context, const uint8_t *bytes, size_t length)
{
  rig *r = context;

  if (r->now_ns >= r->unplug_ns)
    return false;
  emulator_receive(&r->unit, bytes, length, r->now_ns);
  return true;
}

static bool rig_set_line(void *context, bool rts, bool on)
{
  (void)context, (void)rts, (void)on;
  return false;
}

static void rig_init(rig *r)
{
  memset(r, 0, sizeof *r);
  emulator_init(&r->unit);
  r->now_ns = S;
  r->unplug_ns = INT64_MAX;
  r->piece = 64;
  stic_watch_begin(&r->watch, STIC_SILENCE_STALE, 3 * (int64_t)STIC_LOGITECH_PERIOD_NS);
}

static void rig_begin(rig *r)
{
  const stic_logitech_port port = {r, rig_write, rig_set_line};

  stic_logitech_begin(&r->driver, &port, false, r->now_ns);
}

static double position_error(const rig *r, const stic_device_sample *sample)
{
  emulator_record truth;
  double sum = 0;

  r->unit.motion(r->unit.context, sample->t_ns - r->unit.stream_start_ns, &truth);
  for (int i = 0; i < 3; i++) {
    const double e = sample->position[i] - truth.position[i] * 25.4e-6;

    sum += e * e;
  }
  return sqrt(sum);
}

static void look_at(rig *r, const stic_device_sample *sample)
{
  double norm = 0;

  assert_true(r->samples == 0 || sample->t_ns > r->last.t_ns);
  for (int i = 0; i < 4; i++)
    norm += sample->orientation[i] * sample->orientation[i];
  assert_true(fabs(norm - 1) < 1e-12);
  r->samples++;
  r->last = *sample;
  r->gripped = (sample->buttons & STIC_BUTTON_GRIP) != 0;
  r->buttons_seen |= sample->buttons;
  if (sample->flags & STIC_SAMPLE_TRACKED) {
    const double error = position_error(r, sample);

    r->tracked++;
    r->worst = error > r->worst ? error : r->worst;
    r->wrong += error > 0.001;
    if (error <= 0.001) {
      if (r->last_good_ns > 0 && r->now_ns - r->last_good_ns > r->longest_gap_ns)
        r->longest_gap_ns = r->now_ns - r->last_good_ns;
      r->last_good_ns = r->now_ns;
    }
  }
}

static void take(rig *r, const uint8_t *bytes, size_t length)
{
  size_t at = 0, used;
  stic_device_sample sample;
  bool given;

  do {
    given = stic_logitech_receive(&r->driver, bytes + at, length - at, r->now_ns, &used, &sample);
    at += used;
    if (given) {
      stic_watch_heard(&r->watch, r->now_ns);
      look_at(r, &sample);
    }
  } while (given || at < length);
}

static void follow_watch(rig *r)
{
  switch (stic_watch_look(&r->watch, r->now_ns)) {
  case STIC_WATCH_STALE:
    r->stale_ns = r->now_ns;
    r->gripped = false;
    break;
  case STIC_WATCH_LOST:
    r->lost_ns = r->now_ns;
    stic_watch_lost(&r->watch, r->now_ns);
    break;
  default: break;
  }
}

static int64_t least(int64_t a, int64_t b)
{
  return a < b ? a : b;
}

/* Runs until `until_ns`, or until the protocol ends. */
static void rig_run(rig *r, int64_t until_ns)
{
  while (r->now_ns < until_ns && r->result == 0) {
    int64_t next_ns = least(emulator_next_ns(&r->unit), stic_logitech_deadline(&r->driver));
    uint8_t bytes[64];
    size_t n;

    next_ns = least(least(next_ns, stic_watch_deadline(&r->watch)), until_ns);
    r->now_ns = next_ns > r->now_ns ? next_ns : r->now_ns + 1;
    while ((n = emulator_send(&r->unit, r->now_ns, bytes, r->piece)) > 0) {
      if (r->now_ns < r->unplug_ns)
        take(r, bytes, n);
    }
    r->result = stic_logitech_advance(&r->driver, r->now_ns);
    follow_watch(r);
  }
}

/* To the first sample; fails if there is none. */
static void rig_start(rig *r)
{
  rig_begin(r);
  while (r->samples == 0 && r->result == 0 && r->now_ns < 20 * (int64_t)S)
    rig_run(r, r->now_ns + MS);
  assert_true(r->samples > 0);
}

/* ---- without faults ---------------------------------------------------------------------- */

static void test_good(void **state)
{
  rig r;

  (void)state;
  for (size_t piece = 1; piece <= 64; piece *= 2) {
    rig_init(&r);
    r.piece = piece;
    rig_start(&r);
    if (piece == 1)
      print_message("first sample %lld ms after opening\n", (long long)((r.now_ns - S) / MS));
    rig_run(&r, r.now_ns + 5 * (int64_t)S);
    assert_true(r.samples >= 249 && r.tracked == r.samples);
    assert_int_equal(r.wrong, 0);
    assert_true(r.worst < 1e-12);
    assert_int_equal(stic_logitech_stream_bad(&r.driver.stream), 0);
    assert_int_equal(r.last.sequence + 1, r.samples);
    assert_int_equal(r.stale_ns, 0);
    assert_int_equal(r.buttons_seen, STIC_BUTTON_GRIP);
    assert_int_equal(r.unit.refused, 0);
    assert_int_equal(r.driver.firmware, 12);
    stic_logitech_end(&r.driver);
    assert_true(!r.unit.streaming && r.unit.sound_off);
  }
}

/* ---- each byte --------------------------------------------------------------------------- */

typedef struct tally {
  int64_t runs, wrong, longest_gap_ns;
  double worst;
} tally;

static void hurt(rig *r, tally *t)
{
  rig_start(r);
  rig_run(r, r->now_ns + 800 * MS);
  assert_int_equal(r->result, 0);
  assert_int_equal(r->driver.state, STIC_CONNECTION_RUNNING);
  /* It goes on rightly, and nothing in between has moved the hand by more than a hand moves. */
  assert_true(r->now_ns - r->last_good_ns < 40 * MS);
  assert_true(r->worst < SAFE_ERROR);
  assert_int_equal(r->stale_ns, 0);
  t->runs++;
  t->wrong += r->wrong;
  t->longest_gap_ns = r->longest_gap_ns > t->longest_gap_ns ? r->longest_gap_ns : t->longest_gap_ns;
  t->worst = r->worst > t->worst ? r->worst : t->worst;
}

static void tell(const char *name, const tally *t)
{
  print_message("%s: %lld runs, wrong samples %lld, worst %.4f m, longest time without a right one %.1f ms\n",
                name, (long long)t->runs, (long long)t->wrong, t->worst, (double)t->longest_gap_ns / 1e6);
}

static void test_dropped(void **state)
{
  tally t = {0, 0, 0, 0};
  rig r;

  (void)state;
  for (int64_t at = 0; at < 20 * EMULATOR_RECORD; at++) {
    rig_init(&r);
    r.unit.faults.drop_at = at;
    hurt(&r, &t);
  }
  tell("dropped", &t);
  assert_int_equal(t.wrong, 0);
}

static void test_inserted(void **state)
{
  static const uint8_t values[] = {0x00, 0x01, 0x2a, 0x7f, 0x80, 0xa0, 0xff};
  tally t = {0, 0, 0, 0};
  rig r;

  (void)state;
  for (int64_t at = 0; at < 20 * EMULATOR_RECORD; at++) {
    for (size_t i = 0; i < sizeof values; i++) {
      rig_init(&r);
      r.unit.faults.insert_at = at;
      r.unit.faults.insert = values[i];
      r.piece = 1; /* the worst: the surplus is seen only after the record */
      hurt(&r, &t);
    }
  }
  tell("inserted", &t);
}

static void test_flipped(void **state)
{
  tally t = {0, 0, 0, 0};
  rig r;

  (void)state;
  for (int64_t at = 0; at < 20 * EMULATOR_RECORD; at++) {
    for (unsigned bit = 0; bit < 9; bit++) {
      rig_init(&r);
      r.unit.faults.flip_at = at;
      r.unit.faults.flip = (uint8_t)(bit < 8 ? 1u << bit : 0xffu);
      hurt(&r, &t);
    }
  }
  tell("flipped", &t);
}

/* ---- each moment ------------------------------------------------------------------------- */

static void test_stalled(void **state)
{
  rig r;
  int64_t slowest_ns = 0;

  (void)state;
  for (int64_t at = 2; at < 120; at++) {
    rig_init(&r);
    r.unit.faults.stall_at = at;
    r.unit.faults.stall_ns = S;
    rig_start(&r);
    while (r.stale_ns == 0 && r.now_ns < 20 * (int64_t)S)
      rig_run(&r, r.now_ns + MS);
    assert_true(r.stale_ns > 0 && !r.gripped);
    slowest_ns = r.stale_ns - r.last_good_ns > slowest_ns && r.last_good_ns > 0 ? r.stale_ns - r.last_good_ns
                                                                                : slowest_ns;
    rig_run(&r, r.now_ns + 1500 * (int64_t)MS);
    assert_true(r.now_ns - r.last_good_ns < 40 * MS);
    assert_int_equal(r.lost_ns, 0);
    assert_int_equal(r.wrong, 0);
  }
  print_message("stalled: let go at the latest %.1f ms after the last sample\n", (double)slowest_ns / 1e6);
  assert_true(slowest_ns <= 61 * MS);
}

static void test_unplugged(void **state)
{
  rig r;

  (void)state;
  for (int64_t at_ns = S; at_ns < 4 * (int64_t)S; at_ns += 3 * MS + 1) {
    rig_init(&r);
    r.unplug_ns = at_ns;
    rig_begin(&r);
    rig_run(&r, at_ns + 20 * (int64_t)S);
    /* Either a command could not be sent any more, or silence was noticed. */
    assert_true(r.result == STIC_DRIVER_LOST ||
                (r.stale_ns > 0 && r.stale_ns - at_ns <= 61 * MS && r.lost_ns > 0));
    assert_int_equal(r.wrong, 0);
    if (r.samples > 0)
      assert_false(r.gripped && r.result == 0);
    stic_logitech_end(&r.driver);
  }
}

/* ---- what records tell ------------------------------------------------------------------- */

static void test_out(void **state)
{
  rig r;
  double held[3];

  (void)state;
  rig_init(&r);
  rig_start(&r);
  rig_run(&r, r.now_ns + 500 * MS);
  memcpy(held, r.last.position, sizeof held);
  assert_true(r.last.flags & STIC_SAMPLE_TRACKED);
  r.unit.faults.out = true;
  rig_run(&r, r.now_ns + 500 * MS);
  assert_int_equal(r.last.flags, STIC_SAMPLE_POSITION | STIC_SAMPLE_ORIENTATION);
  assert_true(fabs(r.last.position[0] - held[0]) < 0.01);
  assert_int_equal(r.driver.state, STIC_CONNECTION_RUNNING);
  r.unit.faults.out = false;
  r.unit.faults.fringe = true;
  rig_run(&r, r.now_ns + 500 * MS);
  assert_int_equal(r.last.flags,
                   STIC_SAMPLE_POSITION | STIC_SAMPLE_ORIENTATION | STIC_SAMPLE_TRACKED | STIC_SAMPLE_FRINGE);
  assert_int_equal(r.wrong, 0);
}

static void test_never_seen(void **state)
{
  rig r;

  (void)state;
  rig_init(&r);
  r.unit.faults.never = true;
  rig_start(&r);
  rig_run(&r, r.now_ns + 500 * MS);
  assert_int_equal(r.last.flags, 0);
  assert_int_equal(r.tracked, 0);
  r.unit.faults.never = false;
  rig_run(&r, r.now_ns + 500 * MS);
  assert_true(r.last.flags & STIC_SAMPLE_TRACKED);
  assert_int_equal(r.wrong, 0);
}

static void test_glitch(void **state)
{
  rig r;

  (void)state;
  for (int glitch = 0; glitch <= 3; glitch++) {
    rig_init(&r);
    r.unit.faults.glitch = glitch;
    rig_start(&r);
    rig_run(&r, r.now_ns + 3 * (int64_t)S);
    /* Two wrong records are passed over, three are believed. */
    assert_int_equal(r.buttons_seen, STIC_BUTTON_GRIP | (glitch > 2 ? STIC_LOGITECH_BUTTON_RIGHT : 0));
  }
}

/* ---- the start --------------------------------------------------------------------------- */

static void test_silent(void **state)
{
  rig r;

  (void)state;
  rig_init(&r);
  r.unit.faults.silent = true;
  rig_begin(&r);
  rig_run(&r, 60 * (int64_t)S);
  assert_int_equal(r.result, STIC_DRIVER_LOST);
  stic_test_contains(r.driver.error.message, "no answer to the diagnostics");
  print_message("silent: given up after %.1f s\n", (double)(r.now_ns - S) / 1e9);
}

static void run_diagnostics(rig *r, uint8_t first, uint8_t second)
{
  rig_init(r);
  r->unit.faults.diagnostics[0] = first;
  r->unit.faults.diagnostics[1] = second;
  rig_begin(r);
  rig_run(r, 10 * (int64_t)S);
}

static void test_diagnostics(void **state)
{
  rig r;

  (void)state;
  run_diagnostics(&r, 0xbf & ~0x30, 0x3f); /* transmitter and receiver */
  assert_int_equal(r.result, 0);
  assert_true(r.tracked > 0);
  stic_test_contains(r.driver.notice, "transmitter, receiver");
  run_diagnostics(&r, 0xbf & ~0x06, 0x3f);
  assert_int_equal(r.result, STIC_DRIVER_LOST);
  stic_test_contains(r.driver.error.message, "CPU, EPROM checksum");
  run_diagnostics(&r, 0xbf, 0x3d);
  stic_test_contains(r.driver.error.message, "EEPROM");
  run_diagnostics(&r, 0xbf, 0xff);
  assert_int_equal(r.result, STIC_DRIVER_LOST);
  stic_test_contains(r.driver.error.message, "garbled (bf ff)");
}

static void test_information(void **state)
{
  rig r;

  (void)state;
  rig_init(&r);
  r.unit.faults.record_size = 24;
  rig_begin(&r);
  rig_run(&r, 10 * (int64_t)S);
  assert_int_equal(r.result, STIC_DRIVER_BAD_DATA);
  stic_test_contains(r.driver.error.message, "24 bytes; expected 16");
  rig_init(&r);
  r.unit.faults.no_information = true;
  rig_start(&r);
  stic_test_contains(r.driver.notice, "no operating information");
}

/* A unit that streams already, as after a program that was killed. */
static void test_already_streaming(void **state)
{
  rig r;

  (void)state;
  for (int64_t before_ns = 0; before_ns < 40 * MS; before_ns += MS / 2) {
    rig_init(&r);
    emulator_receive(&r.unit, (const uint8_t *)"*S", 2, r.now_ns);
    r.now_ns += before_ns;
    rig_start(&r);
    rig_run(&r, r.now_ns + 200 * MS);
    assert_int_equal(r.wrong, 0);
    assert_int_equal(r.unit.refused, 0);
  }
}

/* What was done to the lines, and when after the start: 'd', 'r' low, 'D', 'R' high; '*' the first command. */
typedef struct lines {
  rig rig;
  char done[8];
  int64_t at_ms[8];
  int count;
} lines;

static void note(lines *l, char what)
{
  assert_true(l->count < 7);
  l->at_ms[l->count] = (l->rig.now_ns - S) / MS;
  l->done[l->count++] = what;
}

static bool lines_write(void *context, const uint8_t *bytes, size_t length)
{
  lines *l = context;

  if (!memchr(l->done, '*', sizeof l->done))
    note(l, '*');
  return rig_write(&l->rig, bytes, length);
}

static bool lines_set(void *context, bool rts, bool on)
{
  note(context, rts ? (on ? 'R' : 'r') : (on ? 'D' : 'd'));
  return true;
}

/* A port with modem lines: DTR is low before RTS resets the unit, then it is let go and told. */
static void test_modem_lines(void **state)
{
  lines l;
  const stic_logitech_port port = {&l, lines_write, lines_set};

  (void)state;
  memset(&l, 0, sizeof l);
  rig_init(&l.rig);
  stic_logitech_begin(&l.rig.driver, &port, false, l.rig.now_ns);
  rig_run(&l.rig, 5 * (int64_t)S);
  assert_string_equal(l.done, "drR*");
  assert_int_equal(l.at_ms[0], 0);
  assert_int_equal(l.at_ms[1], 200);
  assert_int_equal(l.at_ms[2], 400);
  assert_int_equal(l.at_ms[3], 420);
  assert_true(l.rig.tracked > 0);
  assert_int_equal(l.rig.unit.refused, 0);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_good),
    cmocka_unit_test(test_dropped),
    cmocka_unit_test(test_inserted),
    cmocka_unit_test(test_flipped),
    cmocka_unit_test(test_stalled),
    cmocka_unit_test(test_unplugged),
    cmocka_unit_test(test_out),
    cmocka_unit_test(test_never_seen),
    cmocka_unit_test(test_glitch),
    cmocka_unit_test(test_silent),
    cmocka_unit_test(test_diagnostics),
    cmocka_unit_test(test_information),
    cmocka_unit_test(test_already_streaming),
    cmocka_unit_test(test_modem_lines),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}

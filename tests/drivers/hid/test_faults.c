/* The fault campaign on HID drivers: each byte of a report lost, added and changed, each length, stalls and unplugging
 * at each moment, on a clock of its own, under the supervisor. One line of a table for each driver and fault. The
 * serial driver's is test_logitech_faults. */
#include "fake_hid.h"
#include "vectors.h"

#include "../../../drivers/connection.h"
#include "../../../src/io/timing.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#define REPORTS 60
#define SAMPLES (REPORTS + 8)
#define NOTHING (-1)

/* ---- drivers and their streams ------------------------------------------------------------ */

typedef size_t make_report(int i, uint8_t *bytes); /* a moving hand without its grip; the length */

typedef struct subject {
  const char *name, *spec;
  uint16_t vendor, product, page, usage;
  int64_t period_ns;
  make_report *make;
  bool checked; /* the protocol has a checksum, so that nothing garbled may come through */
  bool rest;    /* silent at rest */
  int keys;     /* reports from one that tells the keys to the next: how long a wrong key may last */
} subject;

static size_t make_hydra(int i, uint8_t *bytes)
{
  const int mm[3] = {100 + 2 * i, 200, -50};

  stic_make_hydra(bytes, (uint8_t)i, mm, 0);
  return 52;
}

static size_t make_pad(int i, uint8_t *bytes)
{
  stic_make_pad_usb(bytes, (uint8_t)i);
  bytes[1] = (uint8_t)(128 + i);
  return 64;
}

static size_t make_pad_bluetooth(int i, uint8_t *bytes)
{
  stic_make_pad_bluetooth(bytes, (uint8_t)i);
  bytes[2] = (uint8_t)(128 + i);
  stic_seal_pad(bytes);
  return 78;
}

/* A key that is not the grip in every tenth report. */
static size_t make_key(uint8_t *bytes, int i)
{
  bytes[0] = 3;
  bytes[1] = i / 10 % 2 ? 2 : 0;
  bytes[2] = 0;
  return 3;
}

static size_t make_split(int i, uint8_t *bytes)
{
  memset(bytes, 0, 7);
  if (i % 10 == 5)
    return make_key(bytes, i);
  bytes[0] = (uint8_t)(1 + i % 2);
  bytes[1] = (uint8_t)(100 + i);
  return 7;
}

static size_t make_combined(int i, uint8_t *bytes)
{
  memset(bytes, 0, 13);
  if (i % 10 == 5)
    return make_key(bytes, i);
  bytes[0] = 1;
  bytes[1] = bytes[7] = (uint8_t)(100 + i);
  return 13;
}

static const subject subjects[] = {
  {"hydra", "hydra", 0x1532, 0x0300, 1, 0, 4 * STIC_MS, make_hydra, true, false, 1},
  {"gamepad, USB", "gamepad", 0x054c, 0x0ce6, 1, 5, 4 * STIC_MS, make_pad, false, false, 1},
  {"gamepad, Bluetooth", "gamepad", 0x054c, 0x0ce6, 1, 5, 4 * STIC_MS, make_pad_bluetooth, true, false, 1},
  {"spacemouse, split", "spacemouse", 0x046d, 0xc626, 1, 8, 8 * STIC_MS, make_split, false, true, 10},
  {"spacemouse, combined", "spacemouse", 0x256f, 0xc62e, 1, 8, 16 * STIC_MS, make_combined, false, true, 10},
};

#define SUBJECTS (sizeof subjects / sizeof subjects[0])

/* ---- one run ------------------------------------------------------------------------------ */

typedef struct report {
  size_t length;
  uint8_t bytes[STIC_HID_REPORT_MAX];
} report;

typedef struct outcome {
  int count;
  stic_device_sample samples[SAMPLES];
  bool there[REPORTS]; /* whether report i gave a sample, and which */
  stic_device_sample of[REPORTS];
  stic_device_counters counters;
} outcome;

static stic_fake_hid hid; /* large */
static int64_t start_ns;

static int64_t fake_now(void *context)
{
  (void)context;
  return hid.now_ns;
}

static stic_supervisor *begin(const subject *s, const char *spec)
{
  stic_supervisor *supervisor;
  stic_error err;

  stic_fake_init(&hid);
  stic_fake_plug(&hid, 0, s->vendor, s->product, s->page, s->usage);
  start_ns = hid.now_ns;
  assert_int_equal(stic_supervisor_adopt(stic_fake_open(&hid, spec), fake_now, NULL, &supervisor, &err),
                   STIC_OK);
  return supervisor;
}

static void look_at(const subject *s, outcome *o, const stic_device_sample *sample)
{
  const int64_t i = (sample->t_ns - start_ns + s->period_ns / 2) / s->period_ns;
  double norm = 0;

  for (int k = 0; k < 4; k++)
    norm += sample->orientation[k] * sample->orientation[k];
  assert_true(fabs(norm - 1) < 1e-9);
  assert_true(o->count < SAMPLES && (o->count == 0 || sample->t_ns > o->samples[o->count - 1].t_ns));
  o->samples[o->count++] = *sample;
  if (i >= 0 && i < REPORTS) {
    o->there[i] = true;
    o->of[i] = *sample;
  }
}

/* All reports, report `at` replaced by `instead` (NULL: lost), those from `late` on `late_ns` later. */
static void run(const subject *s, const char *spec, int at, const report *instead, int late, int64_t late_ns,
                outcome *o)
{
  stic_supervisor *supervisor = begin(s, spec);
  stic_device_sample batch[4];
  int count;

  memset(o, 0, sizeof *o);
  for (int i = 0; i < REPORTS; i++) {
    report good;
    const report *r = i == at ? instead : &good;

    good.length = s->make(i, good.bytes);
    if (r && r->length > 0)
      stic_fake_send(&hid, 0, i * s->period_ns + (i >= late && late != NOTHING ? late_ns : 0), r->bytes,
                     r->length);
  }
  while (hid.now_ns < start_ns + REPORTS * s->period_ns + late_ns) {
    count = stic_supervisor_poll(supervisor, hid.now_ns + s->period_ns, batch, 4);
    assert_true(count >= 0);
    for (int i = 0; i < count; i++)
      look_at(s, o, &batch[i]);
  }
  o->counters = stic_supervisor_counters(supervisor);
  stic_supervisor_close(supervisor);
}

/* ---- what a fault did --------------------------------------------------------------------- */

typedef struct tally {
  int runs, wrong, grips, longest;
  double worst; /* m, that the hand was moved wrongly */
} tally;

/* What a wrong sample moves the hand by: its position, or its velocity until the next sample. */
static double moved(const subject *s, const stic_device_sample *a, const stic_device_sample *b)
{
  double sum = 0;

  for (int i = 0; i < 3; i++) {
    const double p = a->position[i] - b->position[i];
    const double v = (a->velocity[i] - b->velocity[i]) * (double)s->period_ns / 1e9;

    sum += p * p + v * v;
  }
  return sqrt(sum);
}

static bool is_same(const subject *s, const stic_device_sample *a, const stic_device_sample *b)
{
  double turn = 0;

  for (int i = 0; i < 3; i++)
    turn += fabs(a->turn_rate[i] - b->turn_rate[i]);
  for (int i = 0; i < 4; i++)
    turn += fabs(a->orientation[i] - b->orientation[i]);
  return moved(s, a, b) < 1e-12 && turn < 1e-12 && a->buttons == b->buttons && a->flags == b->flags;
}

static void judge(const subject *s, int at, const outcome *good, const outcome *hurt, tally *t)
{
  int wrong = 0, grips = 0, last = at - 1;
  double way = 0;

  for (int i = 0; i < REPORTS; i++) {
    if (good->there[i] && hurt->there[i]) {
      wrong += !is_same(s, &good->of[i], &hurt->of[i]);
      way += moved(s, &good->of[i], &hurt->of[i]);
    }
    grips += hurt->there[i] && hurt->of[i].buttons & STIC_BUTTON_GRIP;
    if (good->there[i] != hurt->there[i] || (good->there[i] && !is_same(s, &good->of[i], &hurt->of[i]))) {
      assert_true(i >= at); /* nothing before the fault */
      last = i;
    }
  }
  t->runs++;
  t->wrong += wrong;
  t->grips += grips;
  t->worst = way > t->worst ? way : t->worst;
  t->longest = last - at + 1 > t->longest ? last - at + 1 : t->longest;
  if (s->checked) {
    assert_int_equal(wrong, 0);
    assert_int_equal(grips, 0);
    assert_true(last <= at); /* this report at most */
  } else {
    /* Full deflection either way while it lasts; two halves of split reports. */
    assert_true(way <= 2 * 0.25 * sqrt(3) * 2 * (double)s->period_ns / 1e9 + 1e-12);
    assert_true(last - at < (s->keys > 2 ? s->keys : 2));
    assert_true(grips <= s->keys);
  }
}

static void tell(const char *driver, const char *fault, const tally *t)
{
  print_message("  %-21s %-9s %5d runs %5d wrong %5d grip %8.4f m worst, right again after %2d reports\n",
                driver, fault, t->runs, t->wrong, t->grips, t->worst, t->longest);
}

/* ---- each byte, each length --------------------------------------------------------------- */

/* A report of each kind: motion, and where there are such, the other half and the keys. */
static const int places[] = {20, 21, 25};

#define PLACES (sizeof places / sizeof places[0])

static void hurt_bytes(const subject *s, const outcome *good, const char *fault)
{
  static const uint8_t added[] = {0x00, 0x01, 0x80, 0xff};
  tally t = {0, 0, 0, 0, 0};
  static outcome o;

  for (size_t p = 0; p < PLACES; p++) {
    report original;

    original.length = s->make(places[p], original.bytes);
    for (size_t at = 0; at < original.length; at++) {
      for (int k = 0; k < 9; k++) {
        report r = original;

        if (strcmp(fault, "flipped") == 0) {
          r.bytes[at] ^= (uint8_t)(k < 8 ? 1 << k : 0xff);
        } else if (strcmp(fault, "dropped") == 0 && k == 0) {
          memmove(r.bytes + at, r.bytes + at + 1, --r.length - at);
        } else if (strcmp(fault, "inserted") == 0 && k < 4) {
          memmove(r.bytes + at + 1, r.bytes + at, r.length++ - at);
          r.bytes[at] = added[k];
        } else if (strcmp(fault, "cut") == 0 && k == 0) {
          r.length = at; /* 0: the report is lost */
        } else {
          continue;
        }
        run(s, s->spec, places[p], &r, NOTHING, 0, &o);
        judge(s, places[p], good, &o, &t);
      }
    }
  }
  tell(s->name, fault, &t);
  assert_true(t.runs > 0);
}

static void test_bytes(void **state)
{
  static const char *const faults[] = {"dropped", "inserted", "flipped", "cut"};
  static outcome good;

  (void)state;
  for (size_t i = 0; i < SUBJECTS; i++) {
    run(&subjects[i], subjects[i].spec, NOTHING, NULL, NOTHING, 0, &good);
    assert_int_equal(good.count, REPORTS);
    assert_int_equal(good.counters.bad_records, 0);
    for (size_t f = 0; f < sizeof faults / sizeof faults[0]; f++)
      hurt_bytes(&subjects[i], &good, faults[f]);
  }
}

/* ---- each moment -------------------------------------------------------------------------- */

/* A pause of a second: what streams lets go, what rests stands still; then all goes on. */
static void test_stalled(void **state)
{
  (void)state;
  for (size_t k = 0; k < SUBJECTS; k++) {
    const subject *s = &subjects[k];
    static outcome o;

    for (int at = 1; at < REPORTS; at++) {
      const stic_device_sample *own;

      run(s, s->spec, NOTHING, NULL, at, 1000 * STIC_MS, &o);
      assert_int_equal(o.count, REPORTS + 1);
      own = &o.samples[at];
      assert_true(own->t_ns - o.samples[at - 1].t_ns <= 100 * STIC_MS);
      for (int i = 0; i < 3; i++)
        assert_true(own->velocity[i] == 0 && own->turn_rate[i] == 0);
      assert_true(s->rest || (!(own->flags & STIC_SAMPLE_TRACKED) && own->buttons == 0));
    }
    print_message("  %-21s stalled at each of %d reports: still after 100 ms, none lost\n", s->name,
                  REPORTS - 1);
  }
}

static void test_unplugged(void **state)
{
  (void)state;
  for (size_t k = 0; k < SUBJECTS; k++) {
    const subject *s = &subjects[k];

    for (int at = 0; at < REPORTS; at++) {
      stic_device_sample samples[8];
      stic_device *device;

      stic_fake_init(&hid);
      stic_fake_plug(&hid, 0, s->vendor, s->product, s->page, s->usage);
      device = stic_fake_open(&hid, s->spec);
      for (int i = 0; i < at; i++) {
        report r;

        r.length = s->make(i, r.bytes);
        stic_fake_send(&hid, 0, 0, r.bytes, r.length);
        assert_int_equal(stic_fake_poll(&hid, device, s->period_ns, samples, 8), 1);
      }
      stic_fake_unplug(&hid, 0);
      assert_int_equal(stic_fake_poll(&hid, device, s->period_ns, samples, 8), STIC_DRIVER_LOST);
      assert_int_equal(stic_fake_poll(&hid, device, s->period_ns, samples, 8), STIC_DRIVER_LOST);
      assert_int_equal(device->state, STIC_CONNECTION_LOST);
      stic_device_close(device);
    }
  }
}

/* What came is in the raw recording, garbled or not. */
static void test_recorded(void **state)
{
  char path[] = "/tmp/stiction-faults-XXXXXX", spec[100];
  const int file = mkstemp(path);

  (void)state;
  assert_true(file >= 0);
  close(file);
  for (size_t k = 0; k < SUBJECTS; k++) {
    const report garbled = {5, {0xff, 1, 2, 3, 4}};
    stic_raw_reader *reader;
    stic_raw_record record;
    stic_error err;
    static outcome o;

    snprintf(spec, sizeof spec, "%s:raw=%s", subjects[k].spec, path);
    run(&subjects[k], spec, 20, &garbled, NOTHING, 0, &o);
    assert_int_equal(o.count, REPORTS - 1);
    assert_int_equal(stic_raw_open(path, &reader, &err), STIC_OK);
    for (int i = 0; i < REPORTS; i++) {
      assert_int_equal(stic_raw_next(reader, &record, &err), STIC_RAW_RECORD);
      assert_true(i != 20 || (record.length == 5 && record.bytes[0] == 0xff));
    }
    if (stic_raw_next(reader, &record, &err) != STIC_RAW_END)
      fail_msg("%s", err.message);
    stic_raw_close(reader);
  }
  unlink(path);
}

/* ---- the time of day ---------------------------------------------------------------------- */

/* In place of the C library's, for all that is linked here: a clock that can be set must not be asked at all, so that
 * setting it changes nothing. */
static int64_t asked;

int __real_clock_gettime(clockid_t clock, struct timespec *t);
int __wrap_clock_gettime(clockid_t clock, struct timespec *t);
time_t __wrap_time(time_t *t);
int __wrap_gettimeofday(struct timeval *t, void *zone);

int __wrap_clock_gettime(clockid_t clock, struct timespec *t)
{
  asked++;
  if (clock != CLOCK_MONOTONIC)
    fail_msg("clock %d was asked", (int)clock);
  return __real_clock_gettime(clock, t);
}

time_t __wrap_time(time_t *t)
{
  (void)t;
  fail_msg("time() was asked");
  return 0;
}

int __wrap_gettimeofday(struct timeval *t, void *zone)
{
  (void)t;
  (void)zone;
  fail_msg("gettimeofday() was asked");
  return -1;
}

static void test_time_of_day(void **state)
{
  stic_supervisor *supervisor;
  stic_device_sample samples[8];
  stic_error err;
  int count = 0;

  (void)state;
  assert_int_equal(stic_supervisor_open("sample:rate=1000", NULL, &supervisor, &err), STIC_OK);
  while (count < 20)
    count += stic_supervisor_poll(supervisor, stic_clock_ns() + 10 * STIC_MS, samples, 8);
  stic_supervisor_close(supervisor);
  assert_true(asked > 20);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_bytes),    cmocka_unit_test(test_stalled),     cmocka_unit_test(test_unplugged),
    cmocka_unit_test(test_recorded), cmocka_unit_test(test_time_of_day),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}

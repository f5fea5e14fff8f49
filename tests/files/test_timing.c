/* The histogram against sorted values, and the summary's shape. */
#include "help.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/timing.h"

#define COUNT 20000

static int by_value(const void *a, const void *b)
{
  const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;

  return (x > y) - (x < y);
}

/* From 1 ns to 100 s, the same everywhere on a logarithmic scale. */
static void test_quantiles(void **state)
{
  static const double parts[] = {0.001, 0.1, 0.5, 0.9, 0.99, 0.999, 1};
  int64_t *values = malloc(COUNT * sizeof *values);
  stic_histogram *h = calloc(1, sizeof *h);
  uint64_t random = 7;

  (void)state;
  assert_non_null(values);
  assert_non_null(h);
  assert_int_equal(stic_histogram_quantile(h, 0.5), 0);
  for (int i = 0; i < COUNT; i++) {
    random = random * UINT64_C(6364136223846793005) + 1442695040888963407u;
    values[i] = (int64_t)exp((double)(random >> 11) / 9007199254740992.0 * log(1e11));
    stic_histogram_add(h, values[i]);
  }
  qsort(values, COUNT, sizeof *values, by_value);
  assert_int_equal(h->count, COUNT);
  assert_int_equal(h->max_ns, values[COUNT - 1]);
  for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
    const int64_t expected = values[(int)ceil(parts[i] * COUNT) - 1];
    const int64_t found = stic_histogram_quantile(h, parts[i]);

    if (fabs((double)(found - expected)) > 0.005 * (double)expected)
      fail_msg("part %g: %lld, not %lld", parts[i], (long long)found, (long long)expected);
  }
  free(values);
  free(h);
}

static void test_bounds(void **state)
{
  stic_histogram *h = calloc(1, sizeof *h);

  (void)state;
  assert_non_null(h);
  for (int64_t t = 0; t < 256; t++) {
    memset(h, 0, sizeof *h);
    stic_histogram_add(h, t);
    assert_int_equal(stic_histogram_quantile(h, 0.5), t);
  }
  memset(h, 0, sizeof *h);
  stic_histogram_add(h, -5);
  stic_histogram_add(h, INT64_MAX);
  assert_int_equal(stic_histogram_quantile(h, 0.5), 0);
  assert_int_equal(h->max_ns, INT64_MAX);
  free(h);
}

static void test_summary(void **state)
{
  static const char *const parts[] = {
    "\"frames\": 2,", "\"seconds\": 1.5,", "\"target_hz\": 31,",   "\"missed\": 1,",
    "\"stages\": {",  "\"read\": {",       "\"collide\": {",       "\"solve\": {",
    "\"render\": {",  "\"encode\": {",     "\"write\": {",         "\"frame\": {",
    "\"p50_ns\": ",   "\"p99_ns\": ",      "\"p999_ns\": ",        "\"max_ns\": 40000000",
    "\"wakeup\": {",  "\"machine\": \"",   "\"scheduling\": \"x\""};
  stic_timing *timing = stic_timing_create();
  char *text;

  (void)state;
  assert_non_null(timing);
  stic_timing_add(timing, STIC_STAGE_FRAME, 1000);
  stic_timing_add(timing, STIC_STAGE_FRAME, 40000000);
  stic_timing_add(timing, STIC_STAGE_READ, 40000000);
  stic_timing_add(NULL, STIC_STAGE_READ, 1);
  assert_int_equal(stic_timing_write(timing, 1.5, "x", stic_test_path("t.json"), NULL), STIC_OK);
  text = stic_test_read(stic_test_path("t.json"));
  for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++)
    stic_test_contains(text, parts[i]);
  free(text);
  free(timing);
}

/* What two threads measured is one summary: counts add, the first misses of both are listed in order of time. */
static void test_merge(void **state)
{
  stic_timing *a = stic_timing_create(), *b = stic_timing_create();
  char *text;

  (void)state;
  stic_timing_add(a, STIC_STAGE_FRAME, 4000001);
  stic_timing_add(b, STIC_STAGE_FRAME, 40000000);
  stic_timing_count(b, "apples", 7);
  for (int i = 0; i < STIC_MISSES_MAX + 3; i++) {
    stic_timing_list_miss(a, 2 * i, 1000 + i, "computing");
    stic_timing_list_miss(b, 2 * i + 1, 1000 + i, "wakeup");
  }
  stic_timing_merge(a, b);
  assert_int_equal(a->missed, 1);
  assert_int_equal(a->over[0], 1);
  assert_int_equal(a->over[3], 2);
  assert_true(stic_timing_rate(3) == 250);
  assert_int_equal(a->stages[STIC_STAGE_FRAME].count, 2);
  assert_int_equal(a->stages[STIC_STAGE_FRAME].max_ns, 40000000);
  assert_int_equal(a->miss_count, STIC_MISSES_MAX);
  for (int i = 0; i < STIC_MISSES_MAX; i++)
    assert_int_equal(a->misses[i].at_ns, i);
  assert_int_equal(stic_timing_write(a, 1, "", stic_test_path("m.json"), NULL), STIC_OK);
  text = stic_test_read(stic_test_path("m.json"));
  stic_test_contains(text, "\"apples\": 7");
  stic_test_contains(text, "\"62.5\": 1");
  stic_test_contains(text, "\"why\": \"wakeup\"");
  free(text);
  free(a);
  free(b);
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_quantiles), cmocka_unit_test(test_bounds),
                                     cmocka_unit_test(test_merge), cmocka_unit_test(test_summary)};

  return cmocka_run_group_tests(tests, NULL, stic_test_clean_up);
}

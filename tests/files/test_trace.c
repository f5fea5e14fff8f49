/* Traces: every rule of the format, exact times, lenient reading, recordings. */
#include "help.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/trace_csv.h"
#include "number.h"

#define FORMAT "# stiction-trace 1\n"
#define HEADER "t,x,y,z,qx,qy,qz,qw,buttons\n"
#define GOOD ",0,0,0,0,0,0,1,0\n"

static const stic_test_wrong wrong[] = {
  {"", 0, "the trace is empty"},
  {"0" GOOD, 1, "the first line is '0,0,0,0,0,0,0,1,0'; expected '# stiction-trace 1'"},
  {"# stiction-trace 2\n0" GOOD, 1, "format version 2; expected 1"},
  {"# stiction-trace one\n", 1, "the first line is"},
  {"# stiction-log 1\n", 1, "expected '# stiction-trace 1'"},
  {FORMAT, 1, "no samples"},
  {FORMAT HEADER "# only this\n", 3, "no samples"},
  {FORMAT "t,x,y\n", 2, "found 3 fields; expected 9"},
  {FORMAT HEADER "0" GOOD HEADER, 4, "t is 't'"},
  {FORMAT HEADER HEADER, 3, "t is 't'"},
  {FORMAT "0" GOOD "\n1" GOOD, 3, "the line is empty"},
  {FORMAT "0" GOOD "1,0,0,0,0,0,0,1\n", 3, "found 8 fields"},
  {FORMAT "0,0,0,0,0,0,0,1,0,0\n", 2, "found 10 fields"},
  {FORMAT "0,a,0,0,0,0,0,1,0\n", 2, "x is 'a'; expected a plain number"},
  {FORMAT "0,0,nan,0,0,0,0,1,0\n", 2, "y is 'nan'"},
  {FORMAT "0,0,0,inf,0,0,0,1,0\n", 2, "z is 'inf'"},
  {FORMAT "0,0,0,0x1,0,0,0,1,0\n", 2, "z is '0x1'"},
  {FORMAT "0,0,0,1e999,0,0,0,1,0\n", 2, "z is '1e999'; expected a finite number"},
  {FORMAT "0,0,0,,0,0,0,1,0\n", 2, "z is ''"},
  {FORMAT "0,1e19,0,0,0,0,0,1,0\n", 2, "x is 1e+19 m"},
  {FORMAT "0,0,0,0,0,0,0,1.02,0\n", 2, "norm is 1.02; expected 1 within 1 %"},
  {FORMAT "0,0,0,0,0,0,0,0,0\n", 2, "norm is 0"},
  {FORMAT "0,0,0,0,0,0,0,1,-1\n", 2, "buttons is '-1'"},
  {FORMAT "0,0,0,0,0,0,0,1,1.5\n", 2, "buttons is '1.5'"},
  {FORMAT "0,0,0,0,0,0,0,1,4294967296\n", 2, "buttons is '4294967296'"},
  {FORMAT "x" GOOD, 2, "t is 'x'; expected seconds"},
  {FORMAT "1e99" GOOD, 2, "t is '1e99'; expected seconds within"},
  {FORMAT "1" GOOD "1" GOOD, 3, "t is '1' after 1.000000000; expected strictly increasing"},
  {FORMAT "1" GOOD "1.0000000004" GOOD, 3, "strictly increasing"},
  {FORMAT "1" GOOD "0.5" GOOD, 3, "strictly increasing"},
};

static stic_trace_status read_all(const char *path, const stic_trace_options *options, int *count,
                                  stic_sample *last, stic_error *err)
{
  stic_trace_reader *reader;
  stic_trace_status status;

  *count = 0;
  memset(err, 0, sizeof *err);
  assert_int_equal(stic_trace_open(path, options, &reader, err), STIC_OK);
  do {
    status = stic_trace_next(reader, last, err);
    *count += status == STIC_TRACE_SAMPLE;
  } while (status == STIC_TRACE_SAMPLE || status == STIC_TRACE_WAIT);
  stic_trace_close(reader);
  return status;
}

static stic_status read_trace(const char *path, stic_error *err)
{
  stic_sample sample;
  int count;

  return read_all(path, NULL, &count, &sample, err) == STIC_TRACE_BAD ? err->status : STIC_OK;
}

static void test_wrong_traces(void **state)
{
  (void)state;
  stic_test_wrong_files(wrong, sizeof wrong / sizeof wrong[0], read_trace);
}

static void test_tolerated(void **state)
{
  static const char *const good[] = {
    FORMAT "0" GOOD,
    FORMAT HEADER "0" GOOD,
    "\xef\xbb\xbf" FORMAT "0" GOOD,
    "# stiction-trace 1\r\nt,x,y,z,qx,qy,qz,qw,buttons\r\n0,0,0,0,0,0,0,1,0\r\n",
    FORMAT "# a comment\n" HEADER "# another\n0" GOOD "# last\n",
    FORMAT "0, 0,\t0 ,0,0,0,0,1, 0\n",
    FORMAT "-1e-3,+.5,1.,1E2,0,0,0,-1.005,0\n"};
  stic_sample sample;
  stic_error err;
  int count;

  (void)state;
  for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
    if (read_all(stic_test_write("t.csv", good[i]), NULL, &count, &sample, &err) != STIC_TRACE_END)
      fail_msg("case %d: %s", (int)i, err.message);
    assert_int_equal(count, 1);
  }
  assert_true(sample.t_ns == -1000000 && sample.position[0] == 0.5 && sample.position[2] == 100);
}

typedef struct tally {
  int errors, warnings;
  int64_t first_line;
} tally;

static void on_problem(void *context, bool warning, const stic_error *problem)
{
  tally *t = context;

  if (!warning && t->errors++ == 0)
    t->first_line = problem->line;
  t->warnings += warning;
}

static void test_lenient(void **state)
{
  tally t = {0, 0, 0};
  const stic_trace_options options = {true, on_problem, &t};
  stic_sample sample;
  stic_error err;
  int count;

  (void)state;
  assert_int_equal(
    read_all(stic_test_write("t.csv", FORMAT "0" GOOD "bad\n1" GOOD "0.5" GOOD "2" GOOD "3,0,0"), &options,
             &count, &sample, &err),
    STIC_TRACE_END);
  assert_int_equal(count, 3);
  assert_int_equal(t.errors, 2);
  assert_int_equal(t.warnings, 1);
  assert_int_equal(t.first_line, 3);
  assert_int_equal(read_all(stic_test_write("t.csv", "0" GOOD), &options, &count, &sample, &err),
                   STIC_TRACE_BAD);
}

/* 65536 bytes are a line, one more is not; what follows a line that is too long is read. */
static void test_line_limit(void **state)
{
  char *text = malloc(400000);
  stic_sample sample;
  stic_error err;
  int count;

  (void)state;
  assert_non_null(text);
  for (int over = 0; over < 3; over++) {
    const size_t length = over < 2 ? 65536 + (size_t)over : 300000;
    size_t used = (size_t)sprintf(text, FORMAT "0" GOOD);

    memset(text + used, ' ', length);
    memcpy(text + used, "1,0,0,0,0,0,0,1,0", 17);
    used += length;
    used += (size_t)sprintf(text + used, "\n2" GOOD);
    assert_int_equal(read_all(stic_test_write_bytes("t.csv", text, used), NULL, &count, &sample, &err),
                     over ? STIC_TRACE_BAD : STIC_TRACE_END);
    assert_int_equal(count, over ? 1 : 3);
    if (over) {
      const stic_trace_options lenient = {true, NULL, NULL};

      assert_int_equal(err.line, 3);
      stic_test_contains(err.message, "longer than 65536 bytes");
      assert_int_equal(read_all(stic_test_path("t.csv"), &lenient, &count, &sample, &err), STIC_TRACE_END);
      assert_int_equal(count, 2);
      assert_int_equal(sample.t_ns, 2000000000);
    }
  }
  free(text);
}

static void test_times(void **state)
{
  static const struct {
    const char *text;
    stic_number_status status;
    int64_t ns;
  } times[] = {
    {"0", STIC_NUMBER_OK, 0},
    {"0.1", STIC_NUMBER_OK, 100000000},
    {"-0.000000001", STIC_NUMBER_OK, -1},
    {"1234567890.123456789", STIC_NUMBER_OK, INT64_C(1234567890123456789)},
    {"9223372036.854775807", STIC_NUMBER_OK, INT64_MAX},
    {"9223372036.854775808", STIC_NUMBER_TOO_LARGE, 0},
    {"1e-9", STIC_NUMBER_OK, 1},
    {"5e-10", STIC_NUMBER_OK, 1},
    {"4.9999e-10", STIC_NUMBER_OK, 0},
    {"1e-400", STIC_NUMBER_OK, 0},
    {"1e400", STIC_NUMBER_TOO_LARGE, 0},
    {"0e400", STIC_NUMBER_OK, 0},
    {"0.0000000000000000000000000000001", STIC_NUMBER_OK, 0},
    {"1.0000000015", STIC_NUMBER_OK, 1000000002},
    {"1.00000000149999999999999999999999", STIC_NUMBER_OK, 1000000001},
    {"1e9999999999999999999", STIC_NUMBER_TOO_LARGE, 0},
    {"", STIC_NUMBER_NOT_PLAIN, 0},
    {".", STIC_NUMBER_NOT_PLAIN, 0},
    {"1e", STIC_NUMBER_NOT_PLAIN, 0},
    {"--1", STIC_NUMBER_NOT_PLAIN, 0},
    {"1 ", STIC_NUMBER_NOT_PLAIN, 0},
    {"01", STIC_NUMBER_NOT_PLAIN, 0},
  };

  (void)state;
  for (size_t i = 0; i < sizeof times / sizeof times[0]; i++) {
    int64_t ns = 0;

    if (stic_number_parse_ns(times[i].text, strlen(times[i].text), &ns) != times[i].status ||
        ns != times[i].ns)
      fail_msg("'%s' gave %lld", times[i].text, (long long)ns);
  }
}

/* The fast way must give what the C library gives, bit for bit. */
static void test_numbers(void **state)
{
  uint64_t random = 1;

  (void)state;
  for (int i = 0; i < 200000; i++) {
    char text[64];
    double expected, found = 0;

    random = random * UINT64_C(6364136223846793005) + 1442695040888963407u;
    snprintf(text, sizeof text, "%s%.*f", i & 1 ? "-" : "", (int)(random >> 60),
             (double)(random >> 20) / 1e9);
    if (i % 3 == 0)
      snprintf(text, sizeof text, "%.17ge%d", (double)(random >> 11) * 1e-3, (int)(random % 600) - 330);
    if (strchr(text, 'e') != strrchr(text, 'e'))
      continue;
    expected = strtod(text, NULL);
    if (!isfinite(expected))
      continue;
    assert_int_equal(stic_number_parse(text, strlen(text), &found), STIC_NUMBER_OK);
    if (memcmp(&expected, &found, sizeof found) != 0)
      fail_msg("%s: %.17g, not %.17g", text, found, expected);
  }
}

/* The middle between two doubles to its last digit, and what a digit beyond it decides, however far. */
static void test_long_numbers(void **state)
{
  enum { ROOM = 3000 };
  char text[ROOM];

  (void)state;
  for (int i = 0; i < 3000; i++) {
    const double low = ldexp(1 + (double)(i * 7919 % 4096) / 4096 + ldexp(1, -52) * (i % 3), i % 1060 - 1040);
    const long double middle =
      (long double)low + ((long double)nextafter(low, INFINITY) - (long double)low) / 2;
    double expected, found = 0;
    int length = snprintf(text, ROOM, i % 5 == 2 ? "%.*Le" : "%.*Lf", 1100, middle);

    assert_in_range(length, 1, ROOM - 1000);
    if (i % 5 != 2) {
      memset(text + length, '0', (size_t)(i % 900));
      length += i % 900;
      text[length++] = (char)('0' + i % 2);
      text[length] = '\0';
    }
    expected = strtod(text, NULL);
    assert_int_equal(stic_number_parse(text, (size_t)length, &found), STIC_NUMBER_OK);
    if (memcmp(&expected, &found, sizeof found) != 0)
      fail_msg("%.17g, not %.17g: %s", found, expected, text);
  }
}

static void test_recording(void **state)
{
  const char *path = stic_test_path("r.csv");
  stic_trace_writer *writer;
  stic_trace_reader *reader;
  stic_sample written[100], sample;
  stic_settings settings;
  const stic_override set[] = {{"friction.static", "0.6"}};
  const stic_provenance provenance = {"a\nscene.yaml", "device", "a tracker", NULL, &settings, set, 1};
  stic_error err;

  (void)state;
  stic_settings_init(&settings);
  assert_int_equal(stic_trace_create(path, &provenance, &writer, &err), STIC_OK);
  memset(written, 0, sizeof written);
  for (int i = 0; i < 100; i++) {
    written[i].t_ns = -5 + i * INT64_C(1234567891);
    written[i].position[0] = i == 0 ? -0.0 : sin(i) * pow(10, i % 7 - 3);
    written[i].position[1] = 1.0 / (i + 3);
    written[i].position[2] = i * 5e-324;
    written[i].orientation[2] = sin(i / 7.0);
    written[i].orientation[3] = cos(i / 7.0);
    written[i].buttons = (uint32_t)i;
    written[i].lost = i % 5 == 0;
    assert_int_equal(stic_trace_write(writer, &written[i], &err), STIC_OK);
    if (i == 50) { /* readable up to here at any moment */
      char *text = stic_test_read(path);

      assert_non_null(text);
      assert_int_equal(text[strlen(text) - 1], '\n');
      free(text);
    }
  }
  assert_int_equal(stic_trace_finish(writer, &err), STIC_OK);
  assert_int_equal(stic_trace_open(path, NULL, &reader, &err), STIC_OK);
  for (int i = 0; i < 100; i++) {
    memset(&sample, 0, sizeof sample);
    assert_int_equal(stic_trace_next(reader, &sample, &err), STIC_TRACE_SAMPLE);
    assert_memory_equal(sample.position, written[i].position, sizeof sample.position);
    assert_memory_equal(sample.orientation, written[i].orientation, sizeof sample.orientation);
    assert_true(sample.t_ns == written[i].t_ns && sample.buttons == written[i].buttons &&
                sample.lost == written[i].lost);
  }
  assert_int_equal(stic_trace_next(reader, &sample, &err), STIC_TRACE_END);
  stic_trace_close(reader);
  assert_int_equal(stic_trace_create("/dev/full", NULL, &writer, &err), STIC_CANNOT_WRITE);
  assert_int_equal(stic_trace_create("/nonexistent/r.csv", NULL, &writer, &err), STIC_CANNOT_WRITE);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_wrong_traces), cmocka_unit_test(test_tolerated), cmocka_unit_test(test_lenient),
    cmocka_unit_test(test_line_limit),   cmocka_unit_test(test_times),     cmocka_unit_test(test_numbers),
    cmocka_unit_test(test_long_numbers), cmocka_unit_test(test_recording),
  };

  return cmocka_run_group_tests(tests, NULL, stic_test_clean_up);
}

/* Device specifications, the driver list and the trace driver. */
#include "help.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../drivers/driver.h"
#include "io/timing.h"

static void test_specifications(void **state)
{
  static const struct {
    const char *text, *words;
  } bad[] = {
    {"", "no name"},
    {":file=x", "no name"},
    {"trace:", "expected NAME:key=value"},
    {"trace:=x", "expected NAME:key=value"},
    {"trace:file=a,,loop", "expected NAME:key=value"},
    {"none:file=a", "unknown device 'none'; expected"},
    {"trace:fil=a", "unknown key 'fil'; expected file=, speed=, loop"},
    {"trace:file", "'file' has no value"},
    {"trace:file=", "'file' has no value"},
    {"trace:file=a,loop=1", "'loop' takes no value"},
    {"trace:file=a,file=b", "'file' is given twice"},
    {"trace:loop", "expected trace:file=FILE"},
    {"trace:file=a,speed=0", "speed is '0'; expected a number from"},
    {"trace:file=a,speed=fast", "speed is 'fast'"},
    {"trace:file=-,loop", "standard input cannot loop"},
  };
  stic_device_spec spec;
  stic_device *device;
  stic_error err;

  (void)state;
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
    assert_int_equal(stic_device_open(bad[i].text, &device, &err), STIC_USAGE);
    assert_null(device);
    stic_test_contains(err.message, bad[i].words);
  }
  assert_int_equal(stic_spec_parse("trace:file=a\\,b\\\\c,loop", &spec, &err), STIC_OK);
  assert_string_equal(stic_spec_text(&spec, "file", ""), "a,b\\c");
  assert_true(stic_spec_flag(&spec, "loop"));
  assert_int_equal(stic_device_open("trace:file=/nonexistent/x", &device, &err), STIC_BAD_INPUT);
}

static void test_specification_too_large(void **state)
{
  char text[STIC_SPEC_MAX + 1] = "trace:", *end = text + strlen(text);
  stic_device_spec spec;
  stic_error err;

  (void)state;
  for (int i = 0; i <= STIC_SPEC_PAIRS_MAX; i++)
    end += sprintf(end, "%sk%d=1", i > 0 ? "," : "", i);
  assert_int_equal(stic_spec_parse(text, &spec, &err), STIC_USAGE);
  stic_test_contains(err.message, "device trace: expected at most");
  *strrchr(text, ',') = '\0';
  assert_int_equal(stic_spec_parse(text, &spec, &err), STIC_OK);
  assert_int_equal(spec.pair_count, STIC_SPEC_PAIRS_MAX);
  memset(text, 'x', STIC_SPEC_MAX);
  text[STIC_SPEC_MAX] = '\0';
  assert_int_equal(stic_spec_parse(text, &spec, &err), STIC_USAGE);
  stic_test_contains(err.message, "is longer than");
}

static void test_list(void **state)
{
  (void)state;
  for (int i = 0; stic_driver_at(i); i++) {
    const stic_driver *d = stic_driver_at(i);

    assert_true(d->name && d->about && d->open && d->poll && d->close && d->describe);
    for (int j = 0; j < i; j++)
      assert_string_not_equal(d->name, stic_driver_at(j)->name);
  }
  assert_null(stic_driver_at(-1));
  assert_string_equal(stic_connection_name(STIC_CONNECTION_STALE), "stale");
}

static int poll_all(const char *spec, stic_device_sample *samples, int limit)
{
  stic_device *device;
  int count = 0, n;

  assert_int_equal(stic_device_open(spec, &device, NULL), STIC_OK);
  do {
    n = stic_device_poll(device, stic_clock_ns() + 1000000000, samples + count, limit - count);
    count += n > 0 ? n : 0;
  } while (n >= 0 && count < limit);
  stic_device_close(device);
  return count;
}

static void test_pace(void **state)
{
  char spec[300] = "trace:speed=10,file=", *trace = stic_test_trace(51);
  stic_device_sample samples[60];
  int64_t start = stic_clock_ns(), took;

  (void)state;
  strcat(spec, stic_test_write("t.csv", trace));
  assert_int_equal(poll_all(spec, samples, 60), 51);
  took = stic_clock_ns() - start;
  assert_true(took >= 100000000 && took < 1000000000);
  for (int i = 0; i < 51; i++) {
    assert_int_equal(samples[i].source_ns, i * 20000000);
    assert_int_equal(samples[i].sequence, i);
    assert_true(samples[i].flags & STIC_SAMPLE_TRACKED);
    assert_int_equal(samples[i].t_ns - samples[0].t_ns, i * 2000000);
  }
  free(trace);
}

static void test_loop(void **state)
{
  char spec[300] = "trace:loop,speed=1e6,file=", *trace = stic_test_trace(10);
  stic_device_sample samples[35];

  (void)state;
  strcat(spec, stic_test_write("t.csv", trace));
  assert_int_equal(poll_all(spec, samples, 35), 35);
  for (int i = 1; i < 35; i++)
    assert_int_equal(samples[i].source_ns - samples[i - 1].source_ns, 20000000);
  assert_true(samples[10].position[1] == samples[0].position[1]);
  free(trace);
}

/* The file is gone when the next round begins. */
static void test_loop_without_file(void **state)
{
  char spec[300] = "trace:loop,speed=1e6,file=", *trace = stic_test_trace(10);
  const char *path = stic_test_write("gone.csv", trace);
  stic_device_sample samples[35];
  stic_device *device;
  int n, count = 0;

  (void)state;
  free(trace);
  strcat(spec, path);
  assert_int_equal(stic_device_open(spec, &device, NULL), STIC_OK);
  assert_int_equal(remove(path), 0);
  while ((n = stic_device_poll(device, stic_clock_ns() + 1000000000, samples, 35)) >= 0)
    count += n;
  assert_int_equal(count, 10);
  assert_int_equal(n, STIC_DRIVER_LOST);
  assert_int_equal(device->state, STIC_CONNECTION_LOST);
  stic_test_contains(device->error.message, "No such file");
  stic_device_close(device);
}

static void test_bad_trace(void **state)
{
  char spec[300] = "trace:file=";
  stic_device_sample sample;
  stic_device *device;

  (void)state;
  strcat(spec, stic_test_write("t.csv", "# stiction-trace 1\nx\n"));
  assert_int_equal(stic_device_open(spec, &device, NULL), STIC_OK);
  assert_int_equal(stic_device_poll(device, 0, &sample, 1), STIC_DRIVER_BAD_DATA);
  assert_int_equal(device->error.line, 2);
  assert_int_equal(stic_device_poll(device, 0, &sample, 1), STIC_DRIVER_BAD_DATA); /* each time */
  assert_int_equal(stic_device_send(device, &(const stic_device_output){true}), STIC_DRIVER_UNSUPPORTED);
  stic_device_close(device);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_specifications),
    cmocka_unit_test(test_list),
    cmocka_unit_test(test_pace),
    cmocka_unit_test(test_loop),
    cmocka_unit_test(test_bad_trace),
    cmocka_unit_test(test_loop_without_file),
    cmocka_unit_test(test_specification_too_large),
  };

  return cmocka_run_group_tests(tests, NULL, stic_test_clean_up);
}

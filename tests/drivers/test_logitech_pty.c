/* The Logitech driver on a real terminal: set-up, drain, faults on the way in, close. */
#include "../../drivers/driver.h"
#include "../../drivers/serial/tty.h"
#include "../../src/io/timing.h"
#include "../files/help.h"
#include "logitech_emulator.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define MS INT64_C(1000000)
#define S INT64_C(1000000000)

typedef struct bench {
  emulator unit;
  logitech_pty pty;
  pthread_t thread;
  int64_t serve_ns;
} bench;

static void *serve(void *context)
{
  bench *b = context;

  logitech_pty_serve(&b->pty, b->serve_ns);
  return NULL;
}

static stic_device *open_driver(bench *b, const char *extra)
{
  stic_device *device;
  stic_error err;
  char spec[400];

  snprintf(spec, sizeof spec, "logitech:port=%s%s", b->pty.path, extra);
  assert_int_equal(stic_device_open(spec, &device, &err), STIC_OK);
  return device;
}

/* The unit serves for so long, with the faults set before; the driver is polled meanwhile. */
static stic_device *start(bench *b, int64_t serve_ns, const char *extra)
{
  assert_true(logitech_pty_open(&b->pty, &b->unit));
  b->serve_ns = serve_ns;
  assert_int_equal(pthread_create(&b->thread, NULL, serve, b), 0);
  return open_driver(b, extra);
}

static void end(bench *b, stic_device *device)
{
  pthread_join(b->thread, NULL);
  stic_device_close(device);
  logitech_pty_close(&b->pty);
}

/* Polls until something other than nothing comes, or time is over. */
static int poll_for(stic_device *device, stic_device_sample *sample, int64_t limit_ns)
{
  const int64_t end_ns = stic_clock_ns() + limit_ns;
  int n = 0;

  while (n == 0 && stic_clock_ns() < end_ns)
    n = stic_device_poll(device, end_ns, sample, 1);
  return n;
}

static void test_stream(void **state)
{
  const char *raw = stic_test_path("raw");
  bench b;
  stic_device *device;
  stic_device_sample sample;
  char extra[300], *text;
  int64_t began_ns = stic_clock_ns(), worst_ns = 0;
  int count = 0;

  (void)state;
  emulator_init(&b.unit);
  b.unit.faults.split = true;
  snprintf(extra, sizeof extra, ",raw=%s", raw);
  device = start(&b, 3 * S, extra);
  assert_int_equal(device->state, STIC_CONNECTION_RESETTING);
  while (stic_clock_ns() < began_ns + 2900 * MS) {
    if (poll_for(device, &sample, 50 * MS) != 1)
      continue;
    count++;
    /* The first one waited for the second to confirm it. */
    if (count > 1 && stic_clock_ns() - sample.t_ns > worst_ns)
      worst_ns = stic_clock_ns() - sample.t_ns;
  }
  print_message("%d samples, oldest %.2f ms when given out (8.33 ms are the wire's)\n", count,
                (double)worst_ns / 1e6);
  assert_true(count > 55);
  assert_int_equal(device->state, STIC_CONNECTION_RUNNING);
  assert_int_equal(device->counters.bad_records, 0);
  assert_int_equal(device->counters.samples, count);
  end(&b, device);
  assert_false(b.unit.wrong_format);
  assert_int_equal(b.unit.refused, 0);
  text = stic_test_read(raw);
  assert_non_null(text);
  stic_test_contains(text, "# stiction-serial 1\n");
  free(text);
}

/* A reader that slept finds all samples, and in the order of time. */
static void test_drain(void **state)
{
  bench b;
  stic_device *device;
  stic_device_sample samples[64];
  const struct timespec pause = {0, 600000000};
  int n;

  (void)state;
  emulator_init(&b.unit);
  device = start(&b, 3 * S, "");
  assert_int_equal(poll_for(device, samples, 3 * S), 1);
  nanosleep(&pause, NULL);
  n = stic_device_poll(device, 0, samples, 64);
  assert_in_range(n, 25, 35);
  for (int i = 1; i < n; i++) {
    assert_true(samples[i].t_ns > samples[i - 1].t_ns);
    assert_int_equal(samples[i].sequence, samples[i - 1].sequence + 1);
  }
  end(&b, device);
}

static void test_wrong_unit(void **state)
{
  bench b;
  stic_device *device;
  stic_device_sample sample;

  (void)state;
  emulator_init(&b.unit);
  b.unit.faults.record_size = 24;
  device = start(&b, 4 * S, ",head");
  assert_int_equal(poll_for(device, &sample, 4 * S), STIC_DRIVER_BAD_DATA);
  stic_test_contains(device->error.message, "expected 16");
  assert_string_equal(device->error.file, b.pty.path);
  end(&b, device);
}

static void test_silent_unit(void **state)
{
  bench b;
  stic_device *device;
  stic_device_sample sample;

  (void)state;
  emulator_init(&b.unit);
  b.unit.faults.silent = true;
  device = start(&b, 6 * S, "");
  assert_int_equal(poll_for(device, &sample, 7 * S), STIC_DRIVER_LOST);
  stic_test_contains(device->error.message, "3D mode");
  assert_int_equal(device->state, STIC_CONNECTION_LOST);
  end(&b, device);
}

/* poll() keeps its time whatever the start is doing. */
static void test_never_blocks(void **state)
{
  bench b;
  stic_device *device;
  stic_device_sample sample;
  int64_t worst_ns = 0;

  (void)state;
  emulator_init(&b.unit);
  device = start(&b, 2 * S, "");
  for (const int64_t end_ns = stic_clock_ns() + 1900 * MS; stic_clock_ns() < end_ns;) {
    const int64_t from_ns = stic_clock_ns();
    const struct timespec pause = {0, 2000000};
    int64_t took_ns;

    stic_device_poll(device, 0, &sample, 1);
    took_ns = stic_clock_ns() - from_ns;
    worst_ns = took_ns > worst_ns ? took_ns : worst_ns;
    nanosleep(&pause, NULL);
  }
  print_message("longest poll without waiting: %.3f ms\n", (double)worst_ns / 1e6);
  assert_true(worst_ns < 100 * MS); /* whatever else the machine does */
  end(&b, device);
}

/* ---- the port itself --------------------------------------------------------------------- */

static void test_port(void **state)
{
  emulator unit;
  logitech_pty pty;
  stic_tty tty;
  stic_error err;
  uint8_t bytes[64];
  struct termios t;

  (void)state;
  emulator_init(&unit);
  assert_true(logitech_pty_open(&pty, &unit));
  assert_int_equal(stic_tty_open(&tty, pty.path, B19200, &err), STIC_OK);
  assert_int_equal(tcgetattr(pty.master, &t), 0);
  assert_true(cfgetospeed(&t) == B19200 && cfgetispeed(&t) == B19200);
  assert_false(t.c_lflag & (ICANON | ECHO | ISIG));
  assert_false(t.c_iflag & (IXON | IXOFF | ICRNL | ISTRIP));
  assert_false(stic_tty_set_line(&tty, STIC_TTY_DTR, false));
  assert_int_equal(stic_tty_cts(&tty), -1);
  assert_int_equal(stic_tty_read(&tty, bytes, sizeof bytes), 0);
  assert_true(stic_tty_write(&tty, (const uint8_t *)"\0*\n\r\x11\x13\xff", 7));
  assert_int_equal(read(pty.master, bytes, sizeof bytes), 7);
  assert_memory_equal(bytes, "\0*\n\r\x11\x13\xff", 7);
  assert_int_equal(write(pty.master, "\0\n\r\x03\x04\x11\x13\x7f\xff", 9), 9);
  assert_true(stic_tty_wait(&tty, stic_clock_ns() + S));
  assert_int_equal(stic_tty_read(&tty, bytes, 5), 5);
  assert_int_equal(stic_tty_read(&tty, bytes + 5, sizeof bytes - 5), 4);
  assert_memory_equal(bytes, "\0\n\r\x03\x04\x11\x13\x7f\xff", 9);
  /* The settings from before come back. */
  stic_tty_close(&tty);
  assert_int_equal(tcgetattr(pty.master, &t), 0);
  assert_true(cfgetospeed(&t) == B1200);
  /* Unplugged: an end, not silence. */
  assert_int_equal(stic_tty_open(&tty, pty.path, B19200, &err), STIC_OK);
  logitech_pty_close(&pty);
  assert_true(stic_tty_wait(&tty, stic_clock_ns() + S));
  assert_int_equal(stic_tty_read(&tty, bytes, sizeof bytes), -1);
  assert_false(stic_tty_write(&tty, (const uint8_t *)"*D", 2));
  stic_tty_close(&tty);
}

static void test_no_port(void **state)
{
  stic_tty tty;
  stic_error err;
  stic_device *device;

  (void)state;
  assert_int_equal(stic_tty_open(&tty, "/no/such/port", B19200, &err), STIC_NO_DEVICE);
  stic_test_contains(err.message, "No such file");
  assert_int_equal(stic_tty_open(&tty, "/dev/null", B19200, &err), STIC_NO_DEVICE);
  stic_test_contains(err.message, "expected a serial port");
  assert_int_equal(stic_tty_open(&tty, stic_test_folder(), B19200, &err), STIC_NO_DEVICE);
  assert_int_equal(stic_device_open("logitech", &device, &err), STIC_USAGE);
  stic_test_contains(err.message, "logitech:port=PORT");
  assert_int_equal(stic_device_open("logitech:port=/dev/null,baud=1", &device, &err), STIC_USAGE);
}

/* A recording that cannot be made is told at once, and the port is free again. */
static void test_no_recording(void **state)
{
  emulator unit;
  logitech_pty pty;
  stic_device *device = NULL;
  stic_error err;
  char spec[200];

  (void)state;
  emulator_init(&unit);
  assert_true(logitech_pty_open(&pty, &unit));
  snprintf(spec, sizeof spec, "logitech:port=%s,raw=/nonexistent/raw", pty.path);
  assert_int_equal(stic_device_open(spec, &device, &err), STIC_CANNOT_WRITE);
  assert_null(device);
  stic_test_contains(err.file, "/nonexistent/raw");
  snprintf(spec, sizeof spec, "logitech:port=%s", pty.path);
  assert_int_equal(stic_device_open(spec, &device, &err), STIC_OK);
  stic_device_close(device);
  logitech_pty_close(&pty);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_stream),       cmocka_unit_test(test_drain),
    cmocka_unit_test(test_wrong_unit),   cmocka_unit_test(test_silent_unit),
    cmocka_unit_test(test_never_blocks), cmocka_unit_test(test_port),
    cmocka_unit_test(test_no_port),      cmocka_unit_test(test_no_recording),
  };

  return cmocka_run_group_tests(tests, NULL, stic_test_clean_up);
}

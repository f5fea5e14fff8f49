/* The system's transport over a hidapi that is a fake: what it asks of hidapi, and what it makes of the answers. hidapi
 * itself, the kernel and devices are the kernel tests' matter. */
#include "fake_hid.h"

#include "../../../src/io/timing.h"
#include "../../files/help.h"

#include <errno.h>
#include <hidapi.h>
#include <stdio.h>
#include <string.h>

#define NODE "/dev/hidraw7"
#define MS INT64_C(1000000)

/* What the fake is to say, and what it was asked. */
static struct {
  int open_errno, ioctl_errno; /* 0: works */
  bool refuses;                /* hid_open_path() */
  bool no_memory;
  int answers[4]; /* of hid_read_timeout(): lengths, -1 */
  int result;     /* of what is written, or of a feature report */
  char path[STIC_HID_PATH_MAX];
  int waits[4], reads, closed;
  uint8_t sent[8];
  size_t sent_length;
} fake;

static char the_device;

static int reset(void **state)
{
  (void)state;
  memset(&fake, 0, sizeof fake);
  return 0;
}

static hid_device *device(void)
{
  return (hid_device *)(void *)&the_device;
}

/* ---- instead of hidapi and the kernel --------------------------------------------------------- */

void *__real_malloc(size_t size);
void *__wrap_malloc(size_t size);
int __real_open(const char *path, int flags, ...);
int __wrap_open(const char *path, int flags, ...);
int __wrap_ioctl(int file, unsigned long request, ...);
hid_device *__wrap_hid_open_path(const char *path);
void __wrap_hid_close(hid_device *opened);
int __wrap_hid_read_timeout(hid_device *opened, unsigned char *data, size_t length, int milliseconds);
int __wrap_hid_write(hid_device *opened, const unsigned char *data, size_t length);
int __wrap_hid_send_feature_report(hid_device *opened, const unsigned char *data, size_t length);
int __wrap_hid_get_feature_report(hid_device *opened, unsigned char *data, size_t length);

void *__wrap_malloc(size_t size)
{
  return fake.no_memory ? NULL : __real_malloc(size);
}

int __wrap_open(const char *path, int flags, ...)
{
  if (strcmp(path, NODE) != 0)
    return __real_open(path, flags, 0666);
  errno = fake.open_errno;
  return fake.open_errno ? -1 : __real_open("/dev/null", flags);
}

int __wrap_ioctl(int file, unsigned long request, ...)
{
  (void)file, (void)request;
  errno = fake.ioctl_errno;
  return fake.ioctl_errno ? -1 : 0;
}

hid_device *__wrap_hid_open_path(const char *path)
{
  snprintf(fake.path, sizeof fake.path, "%s", path);
  return fake.refuses ? NULL : device();
}

void __wrap_hid_close(hid_device *opened)
{
  assert_ptr_equal(opened, device());
  fake.closed++;
}

/* Waits as long as it is told when it has nothing; a report is its length over and over. */
int __wrap_hid_read_timeout(hid_device *opened, unsigned char *data, size_t length, int milliseconds)
{
  const int answer = fake.answers[fake.reads];

  assert_ptr_equal(opened, device());
  assert_true(fake.reads < 4 && answer <= (int)length);
  fake.waits[fake.reads++] = milliseconds;
  if (answer > 0)
    memset(data, answer, (size_t)answer);
  else if (answer == 0 && milliseconds < 100)
    stic_clock_sleep_until(stic_clock_ns() + milliseconds * MS);
  return answer;
}

static int keep_sent(const unsigned char *data, size_t length)
{
  assert_true(length <= sizeof fake.sent);
  memcpy(fake.sent, data, length);
  fake.sent_length = length;
  return fake.result;
}

int __wrap_hid_write(hid_device *opened, const unsigned char *data, size_t length)
{
  assert_ptr_equal(opened, device());
  return keep_sent(data, length);
}

int __wrap_hid_send_feature_report(hid_device *opened, const unsigned char *data, size_t length)
{
  assert_ptr_equal(opened, device());
  return keep_sent(data, length);
}

int __wrap_hid_get_feature_report(hid_device *opened, unsigned char *data, size_t length)
{
  assert_ptr_equal(opened, device());
  keep_sent(data, 1);
  if (fake.result > 0)
    memset(data + 1, 0x5a, length - 1);
  return fake.result;
}

/* ---- opening ---------------------------------------------------------------------------------- */

static stic_status try_open(stic_hid_handle **handle, stic_error *err)
{
  stic_hid_node node = {.path = NODE, .bus = "usb", .vendor = 0x046d, .product = 0xc626};

  *handle = NULL;
  err->message[0] = '\0';
  return stic_hid_system.open(stic_hid_system.context, &node, handle, err);
}

static stic_hid_handle *open_it(void)
{
  stic_hid_handle *handle;
  stic_error err;

  assert_int_equal(try_open(&handle, &err), STIC_OK);
  assert_non_null(handle);
  return handle;
}

static void test_open_and_close(void **state)
{
  stic_hid_handle *handle = open_it();

  (void)state;
  assert_string_equal(fake.path, NODE);
  stic_hid_system.close(handle);
  assert_int_equal(fake.closed, 1);
}

static void expect_refused(const char *words)
{
  stic_hid_handle *handle;
  stic_error err;

  assert_int_equal(try_open(&handle, &err), STIC_NO_DEVICE);
  assert_null(handle);
  stic_test_contains(err.message, words);
  stic_test_contains(err.message, NODE);
}

static void test_refused(void **state)
{
  char by[80];

  (void)state;
  fake.refuses = true;
  snprintf(by, sizeof by, "cannot open " NODE " by hidapi-%s", stic_hid_system.name);
  expect_refused(by);
}

static void test_no_memory(void **state)
{
  stic_hid_handle *handle;
  stic_error err;

  (void)state;
  fake.no_memory = true;
  assert_int_equal(try_open(&handle, &err), STIC_NO_MEMORY);
  fake.no_memory = false;
  assert_null(handle);
  assert_string_equal(err.message, "out of memory");
  assert_string_equal(fake.path, "");
}

#ifdef STIC_HIDAPI_HIDRAW
/* hidapi is not even asked for a node that cannot be opened or is none. */
static void test_node_is_asked_first(void **state)
{
  (void)state;
  fake.open_errno = EACCES;
  expect_refused("no permission to open " NODE);
  fake.open_errno = EPERM;
  expect_refused("udevadm");
  fake.open_errno = ENODEV;
  expect_refused("cannot open " NODE ": No such device");
  fake.open_errno = 0;
  fake.ioctl_errno = ENOTTY;
  expect_refused("cannot open " NODE ": Inappropriate ioctl");
  assert_string_equal(fake.path, "");
}
#endif

/* ---- reading ---------------------------------------------------------------------------------- */

static int read_until(int64_t until_ns, uint8_t report[64])
{
  stic_hid_handle *handle = open_it();
  const int64_t before = stic_clock_ns();
  int64_t t_ns = 0;
  const int length = stic_hid_system.read(handle, report, 64, until_ns, &t_ns);

  assert_true(t_ns >= before && t_ns <= stic_clock_ns());
  stic_hid_system.close(handle);
  return length;
}

static void test_report(void **state)
{
  uint8_t report[64] = {0};

  (void)state;
  fake.answers[0] = 7;
  assert_int_equal(read_until(0, report), 7);
  assert_int_equal(report[6], 7);
  assert_int_equal(report[7], 0);
  assert_int_equal(fake.reads, 1);
  assert_int_equal(fake.waits[0], 0); /* the past does not wait */
}

static void test_longest_wait(void **state)
{
  uint8_t report[64];

  (void)state;
  fake.answers[0] = 3;
  assert_int_equal(read_until(INT64_MAX, report), 3);
  assert_int_equal(fake.waits[0], 60000);
}

/* hidapi waits whole milliseconds: the rest is slept, and what came meanwhile is taken. */
static void test_parts_of_milliseconds(void **state)
{
  uint8_t report[64];
  int length = 0;

  (void)state;
  /* On a busy machine the time may be over before the first look: then there is no second one. */
  for (int i = 0; i < 100 && fake.reads != 2; i++) {
    const int64_t until_ns = stic_clock_ns() + 900000;

    reset(NULL);
    fake.answers[1] = 5;
    length = read_until(until_ns, report);
    assert_true(fake.reads == 2 ? stic_clock_ns() >= until_ns : length == 0);
  }
  assert_int_equal(length, 5);
  assert_int_equal(fake.waits[0], 0);
  assert_int_equal(fake.waits[1], 0);
}

/* -1 is a signal if it is not said again, else the device is gone. */
static void test_signal_and_loss(void **state)
{
  uint8_t report[64];

  (void)state;
  fake.answers[0] = -1;
  assert_int_equal(read_until(stic_clock_ns() + 60000 * MS, report), 0);
  assert_int_equal(fake.reads, 2);
  assert_int_equal(fake.waits[1], 0);
  reset(NULL);
  fake.answers[0] = fake.answers[1] = -1;
  assert_int_equal(read_until(stic_clock_ns() + 60000 * MS, report), STIC_DRIVER_LOST);
  reset(NULL);
  fake.answers[0] = -1;
  assert_int_equal(read_until(0, report), STIC_DRIVER_LOST);
  assert_int_equal(fake.reads, 1);
}

/* ---- writing ---------------------------------------------------------------------------------- */

static void test_write(void **state)
{
  static const uint8_t led[2] = {4, 1};
  stic_hid_handle *handle = open_it();

  (void)state;
  fake.result = 2;
  assert_int_equal(stic_hid_system.write(handle, led, 2), 0);
  assert_int_equal(fake.sent_length, 2);
  assert_memory_equal(fake.sent, led, 2);
  assert_int_equal(stic_hid_system.set_feature(handle, led, 2), 0);
  fake.result = -1;
  assert_int_equal(stic_hid_system.write(handle, led, 2), STIC_DRIVER_LOST);
  assert_int_equal(stic_hid_system.set_feature(handle, led, 2), STIC_DRIVER_LOST);
  stic_hid_system.close(handle);
}

static void test_get_feature(void **state)
{
  stic_hid_handle *handle = open_it();
  uint8_t data[8] = {9};

  (void)state;
  fake.result = 8;
  assert_int_equal(stic_hid_system.get_feature(handle, data, sizeof data), 8);
  assert_int_equal(fake.sent[0], 9); /* the ID that is wanted */
  assert_int_equal(data[7], 0x5a);
  fake.result = -1;
  assert_int_equal(stic_hid_system.get_feature(handle, data, sizeof data), STIC_DRIVER_LOST);
  stic_hid_system.close(handle);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup(test_open_and_close, reset),
    cmocka_unit_test_setup(test_refused, reset),
    cmocka_unit_test_setup(test_no_memory, reset),
#ifdef STIC_HIDAPI_HIDRAW
    cmocka_unit_test_setup(test_node_is_asked_first, reset),
#endif
    cmocka_unit_test_setup(test_report, reset),
    cmocka_unit_test_setup(test_longest_wait, reset),
    cmocka_unit_test_setup(test_parts_of_milliseconds, reset),
    cmocka_unit_test_setup(test_signal_and_loss, reset),
    cmocka_unit_test_setup(test_write, reset),
    cmocka_unit_test_setup(test_get_feature, reset),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}

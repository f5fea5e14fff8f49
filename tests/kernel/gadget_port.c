/* The port as a USB gadget: a device with one interface and without feature reports, on a real USB bus (of the
 * dummy_hcd module, which joins a gadget to the machine it is in). */
#include "emulated_hid.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define GADGET "/sys/kernel/config/usb_gadget/stiction"
#define FUNCTION GADGET "/functions/hid.usb0"
#define CONFIG GADGET "/configs/c.1"
#define STRINGS GADGET "/strings/0x409"
#define CONTROLLER "dummy_udc.0"
#define NODE "/dev/hidg0"
#define APPEAR_MS 10000
#define SEND_MS 1000
/* More than the longest report: a report that fills its packet would be followed by an empty one. */
#define REPORT_LENGTH "16"

static bool put(const char *path, const void *data, size_t length)
{
  const int file = open(path, O_WRONLY | O_CLOEXEC);
  const bool good = file >= 0 && write(file, data, length) == (ssize_t)length;

  if (!good)
    fprintf(stderr, "%s: %s\n", path, strerror(errno));
  if (file >= 0)
    close(file);
  return good;
}

static bool put_text(const char *path, const char *text)
{
  return put(path, text, strlen(text));
}

static bool put_number(const char *path, unsigned number)
{
  char text[16];

  snprintf(text, sizeof text, "0x%04x", number);
  return put_text(path, text);
}

static bool make_gadget(const stic_emulated_device *d)
{
  mkdir(GADGET, 0755);
  mkdir(STRINGS, 0755);
  mkdir(CONFIG, 0755);
  mkdir(FUNCTION, 0755);
  return put_number(GADGET "/idVendor", d->vendor) && put_number(GADGET "/idProduct", d->product_id) &&
         put_number(GADGET "/bcdUSB", 0x0200) && put_text(STRINGS "/product", d->product) &&
         put_text(STRINGS "/serialnumber", d->serial) && put_text(FUNCTION "/protocol", "0") &&
         put_text(FUNCTION "/subclass", "0") && put_text(FUNCTION "/report_length", REPORT_LENGTH) &&
         put(FUNCTION "/report_desc", d->descriptors[0], d->descriptor_lengths[0]) &&
         symlink(FUNCTION, CONFIG "/hid.usb0") == 0;
}

/* Undone in the opposite order, so that the next device can be made. */
static void remove_gadget(void)
{
  unlink(CONFIG "/hid.usb0");
  rmdir(FUNCTION);
  rmdir(CONFIG);
  rmdir(STRINGS);
  rmdir(GADGET);
}

bool stic_port_open(stic_emulator *e)
{
  const stic_emulated_device *d = e->device;

  if (d->interface_count != 1 || d->set_feature || d->get_feature || !d->output) {
    fprintf(stderr, "%s cannot be a gadget\n", d->name);
    return false;
  }
  e->files[0] = -1;
  return access("/sys/kernel/config/usb_gadget", W_OK) == 0;
}

static void pause_ms(int ms)
{
  const struct timespec pause = {0, ms * 1000000L};

  nanosleep(&pause, NULL);
}

bool stic_port_plug_in(stic_emulator *e)
{
  const int64_t end_ms = stic_emulator_now_ms() + APPEAR_MS;

  if (!make_gadget(e->device) || !put_text(GADGET "/UDC", CONTROLLER))
    return false;
  while ((e->files[0] = open(NODE, O_RDWR | O_NONBLOCK | O_CLOEXEC)) < 0 && stic_emulator_now_ms() < end_ms)
    pause_ms(10);
  return e->files[0] >= 0;
}

bool stic_port_pull_out(stic_emulator *e)
{
  const bool good = put_text(GADGET "/UDC", "\n");

  close(e->files[0]);
  remove_gadget();
  e->files[0] = -1; /* poll() passes it over */
  return good;
}

void stic_port_serve(stic_emulator *e, int64_t until_ms)
{
  for (;;) {
    struct pollfd polled = {e->files[0], POLLIN, 0};
    const int64_t left_ms = until_ms - stic_emulator_now_ms();
    uint8_t report[64];
    ssize_t length;

    if (poll(&polled, 1, left_ms > 0 ? (int)left_ms : 0) == 0)
      return;
    length = read(e->files[0], report, sizeof report);
    if (length > 0)
      e->device->output(e, report, (size_t)length);
    else
      pause_ms(1);
  }
}

void stic_port_send(stic_emulator *e, int interface, const uint8_t *report, size_t length)
{
  struct pollfd polled = {e->files[interface], POLLOUT, 0};

  /* The host takes reports at its own rate. */
  if (poll(&polled, 1, SEND_MS) != 1 || write(e->files[interface], report, length) != (ssize_t)length)
    fprintf(stderr, "%s: a report was not sent: %s\n", e->device->name, strerror(errno));
}

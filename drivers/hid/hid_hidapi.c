/* The system's HID devices by hidapi, with either of its Linux backends. */
#include "hid.h"
#include "hid_sysfs.h"

#include "../../src/error.h"
#include "../../src/io/timing.h"

#include <hidapi.h>

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#ifdef STIC_HIDAPI_HIDRAW
#include <linux/hidraw.h>
#include <sys/ioctl.h>
#define BACKEND "hidraw"
#define HINT ""
#else
#define BACKEND "libusb"
#define HINT "; it needs write permission on /dev/bus/usb"
#endif

#define NS_PER_MS INT64_C(1000000)
#define WAIT_MAX_NS (60000 * NS_PER_MS) /* in one call of hidapi */

struct stic_hid_handle {
  hid_device *device;
};

/* ---- finding ----------------------------------------------------------------------------- */

#ifdef STIC_HIDAPI_HIDRAW

/* Not by hidapi: its version 0.13 reads through a null pointer if any HID device goes away meanwhile, and devices are
 * looked for just when one has gone. */
static int find_nodes(void *context, stic_hid_node *nodes, int capacity)
{
  (void)context;
  return stic_hid_sysfs_enumerate(STIC_HID_SYSFS, nodes, capacity);
}

#else

static void copy_ascii(const wchar_t *from, char *to, size_t size)
{
  size_t n = 0;

  for (; from && from[n] && n + 1 < size; n++)
    to[n] = from[n] >= 0x20 && from[n] < 0x7f ? (char)from[n] : '?';
  to[n] = '\0';
}

static const char *bus_name(const struct hid_device_info *info)
{
#if HID_API_VERSION >= HID_API_MAKE_VERSION(0, 13, 0)
  if (info->bus_type == HID_API_BUS_USB)
    return "usb";
  if (info->bus_type == HID_API_BUS_BLUETOOTH)
    return "bluetooth";
#else
  (void)info;
#endif
  return "hid";
}

static int find_nodes(void *context, stic_hid_node *nodes, int capacity)
{
  struct hid_device_info *list = hid_enumerate(0, 0);
  int count = 0;

  (void)context;
  for (const struct hid_device_info *info = list; info && count < capacity; info = info->next) {
    stic_hid_node *node = &nodes[count];

    if (!info->path || strlen(info->path) >= sizeof node->path)
      continue;
    memset(node, 0, sizeof *node);
    strcpy(node->path, info->path);
    copy_ascii(info->product_string, node->product_name, sizeof node->product_name);
    copy_ascii(info->serial_number, node->serial, sizeof node->serial);
    node->bus = bus_name(info);
    node->vendor = info->vendor_id;
    node->product = info->product_id;
    node->usage.page = info->usage_page;
    node->usage.id = info->usage;
    count++;
  }
  hid_free_enumeration(list);
  return count;
}

#endif

/* ---- opening ----------------------------------------------------------------------------- */

/* hidapi does not tell why it cannot open a node, and 0.13 crashes on what is none; so the node is asked
 * first. */
static stic_status check_node(const stic_hid_node *node, stic_error *err)
{
#ifdef STIC_HIDAPI_HIDRAW
  const int file = open(node->path, O_RDWR | O_CLOEXEC);
  int size, why = 0;

  if (file < 0 && (errno == EACCES || errno == EPERM))
    return stic_hid_no_permission(node, err);
  if (file < 0 || ioctl(file, HIDIOCGRDESCSIZE, &size) != 0)
    why = errno;
  if (file >= 0)
    close(file);
  if (why)
    return stic_error_set(err, STIC_NO_DEVICE, NULL, 0, "cannot open %.100s: %s", node->path, strerror(why));
#else
  (void)node;
  (void)err;
#endif
  return STIC_OK;
}

static stic_status hidapi_open(void *context, const stic_hid_node *node, stic_hid_handle **handle,
                               stic_error *err)
{
  stic_hid_handle *opened;
  const stic_status status = check_node(node, err);

  (void)context;
  if (status != STIC_OK)
    return status;
  opened = malloc(sizeof *opened);
  if (!opened)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  opened->device = hid_open_path(node->path);
  if (!opened->device) {
    free(opened);
    return stic_error_set(err, STIC_NO_DEVICE, NULL, 0, "cannot open %.100s by hidapi-" BACKEND HINT,
                          node->path);
  }
  *handle = opened;
  return STIC_OK;
}

static void hidapi_close(stic_hid_handle *handle)
{
  hid_close(handle->device);
  free(handle);
}

/* ---- reports ----------------------------------------------------------------------------- */

/* hidapi says -1 for a signal as for an unplugged device; asked again without waiting, only the latter
 * says it again. */
static int read_for(stic_hid_handle *handle, uint8_t *report, size_t size, int milliseconds)
{
  int length = hid_read_timeout(handle->device, report, size, milliseconds);

  if (length < 0 && milliseconds > 0)
    length = hid_read_timeout(handle->device, report, size, 0);
  return length < 0 ? STIC_DRIVER_LOST : length;
}

/* 0..WAIT_MAX_NS */
static int64_t time_left(int64_t until_ns)
{
  const int64_t now = stic_clock_ns();

  if (until_ns <= now)
    return 0;
  return until_ns - now < WAIT_MAX_NS ? until_ns - now : WAIT_MAX_NS;
}

static int hidapi_read(stic_hid_handle *handle, uint8_t *report, size_t size, int64_t until_ns, int64_t *t_ns)
{
  const int64_t left_ns = time_left(until_ns);
  int length = read_for(handle, report, size, (int)(left_ns / NS_PER_MS));

  /* hidapi waits whole milliseconds; the rest is slept, so that the time given is neither cut nor passed. */
  if (length == 0 && left_ns % NS_PER_MS > 0 && time_left(until_ns) < NS_PER_MS) {
    stic_clock_sleep_until(until_ns);
    length = read_for(handle, report, size, 0);
  }
  *t_ns = stic_clock_ns();
  return length;
}

static int hidapi_write(stic_hid_handle *handle, const uint8_t *data, size_t length)
{
  return hid_write(handle->device, data, length) < 0 ? STIC_DRIVER_LOST : 0;
}

static int hidapi_set_feature(stic_hid_handle *handle, const uint8_t *data, size_t length)
{
  return hid_send_feature_report(handle->device, data, length) < 0 ? STIC_DRIVER_LOST : 0;
}

static int hidapi_get_feature(stic_hid_handle *handle, uint8_t *data, size_t size)
{
  const int length = hid_get_feature_report(handle->device, data, size);

  return length < 0 ? STIC_DRIVER_LOST : length;
}

static int64_t hidapi_now(void *context)
{
  (void)context;
  return stic_clock_ns();
}

const stic_hid_transport stic_hid_system = {
  .name = BACKEND,
  .context = NULL,
  .enumerate = find_nodes,
  .open = hidapi_open,
  .read = hidapi_read,
  .write = hidapi_write,
  .set_feature = hidapi_set_feature,
  .get_feature = hidapi_get_feature,
  .close = hidapi_close,
  .now = hidapi_now,
};

#include "hid_recording.h"

#include "../../src/error.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct stic_hid_handle {
  stic_hid_recording *recording;
  int device;
  bool open;
};

struct stic_hid_recording {
  stic_hid_transport transport;
  stic_raw_reader *reader;
  stic_raw_record next; /* if `pending` */
  bool pending;
  int64_t clock_ns;
  stic_error error;
  stic_hid_handle handles[STIC_RAW_DEVICES_MAX];
};

/* ---- transport --------------------------------------------------------------------------- */

static int recording_enumerate(void *context, stic_hid_node *nodes, int capacity)
{
  const stic_hid_recording *r = context;
  int count = 0;

  for (int i = 0; i < STIC_RAW_DEVICES_MAX && count < capacity; i++) {
    const stic_raw_device *device = stic_raw_reader_device(r->reader, i);
    stic_hid_node *node = &nodes[count];

    if (device->vendor == 0 && device->product == 0)
      continue;
    memset(node, 0, sizeof *node);
    snprintf(node->path, sizeof node->path, "recording:%d", i);
    snprintf(node->product_name, sizeof node->product_name, "%.63s", device->name);
    node->bus = device->bus == 5 ? "bluetooth" : "usb";
    node->vendor = (uint16_t)device->vendor;
    node->product = (uint16_t)device->product;
    stic_hid_usages(device->descriptor, device->descriptor_length, &node->usage, 1);
    count++;
  }
  return count;
}

static stic_status recording_handle(void *context, const stic_hid_node *node, stic_hid_handle **handle,
                                    stic_error *err)
{
  stic_hid_recording *r = context;
  int device;

  if (sscanf(node->path, "recording:%d", &device) != 1 || device < 0 || device >= STIC_RAW_DEVICES_MAX)
    return stic_error_set(err, STIC_NO_DEVICE, NULL, 0, "%.100s is no device of the recording", node->path);
  r->handles[device].recording = r;
  r->handles[device].device = device;
  r->handles[device].open = true;
  *handle = &r->handles[device];
  return STIC_OK;
}

/* The next report of a device that is open; false at the end. */
static bool find_next(stic_hid_recording *r)
{
  while (!r->pending || !r->handles[r->next.device].open) {
    const stic_raw_status status = stic_raw_next(r->reader, &r->next, &r->error);

    r->pending = status == STIC_RAW_RECORD;
    if (status == STIC_RAW_END || status == STIC_RAW_BAD)
      return false;
  }
  return true;
}

static void advance_clock(stic_hid_recording *r, int64_t t_ns)
{
  if (t_ns > r->clock_ns)
    r->clock_ns = t_ns;
}

static int recording_read(stic_hid_handle *handle, uint8_t *report, size_t size, int64_t until_ns,
                          int64_t *t_ns)
{
  stic_hid_recording *r = handle->recording;
  size_t length;

  if (!find_next(r))
    return STIC_DRIVER_END;
  if (r->next.t_ns > r->clock_ns && r->next.t_ns > until_ns) {
    advance_clock(r, until_ns);
    return 0;
  }
  advance_clock(r, r->next.t_ns);
  if (r->next.device != handle->device)
    return 0;
  length = r->next.length < size ? r->next.length : size;
  memcpy(report, r->next.bytes, length);
  *t_ns = r->next.t_ns;
  r->pending = false;
  return (int)length;
}

static int recording_take(stic_hid_handle *handle, const uint8_t *data, size_t length)
{
  (void)handle;
  (void)data;
  (void)length;
  return 0;
}

static int recording_get(stic_hid_handle *handle, uint8_t *data, size_t size)
{
  (void)handle;
  (void)data;
  (void)size;
  return STIC_DRIVER_LOST;
}

static void recording_release(stic_hid_handle *handle)
{
  handle->open = false;
}

static int64_t recording_now(void *context)
{
  return ((const stic_hid_recording *)context)->clock_ns;
}

/* ---- opening and closing ----------------------------------------------------------------- */

static stic_status read_first(stic_hid_recording *r, const char *path, stic_error *err)
{
  stic_raw_status status;

  do
    status = stic_raw_next(r->reader, &r->next, err);
  while (status == STIC_RAW_WAIT);
  if (status == STIC_RAW_BAD)
    return STIC_BAD_INPUT;
  if (status == STIC_RAW_END || stic_raw_reader_kind(r->reader) != STIC_RAW_HID)
    return stic_error_set(err, STIC_BAD_INPUT, path, 0, "expected a HID recording (hid-recorder's text)");
  r->pending = true;
  r->clock_ns = r->next.t_ns;
  return STIC_OK;
}

stic_status stic_hid_recording_begin(stic_raw_reader *reader, const char *path,
                                     stic_hid_recording **recording, stic_error *err)
{
  stic_hid_recording *r = calloc(1, sizeof *r);
  stic_status status;

  if (!r) {
    stic_raw_close(reader);
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  }
  r->reader = reader;
  r->transport = (stic_hid_transport){.name = "recording",
                                      .context = r,
                                      .enumerate = recording_enumerate,
                                      .open = recording_handle,
                                      .read = recording_read,
                                      .write = recording_take,
                                      .set_feature = recording_take,
                                      .get_feature = recording_get,
                                      .close = recording_release,
                                      .now = recording_now};
  status = read_first(r, path, err);
  if (status != STIC_OK) {
    stic_hid_recording_close(r);
    return status;
  }
  *recording = r;
  return STIC_OK;
}

void stic_hid_recording_close(stic_hid_recording *recording)
{
  if (recording)
    stic_raw_close(recording->reader);
  free(recording);
}

const stic_hid_transport *stic_hid_recording_transport(stic_hid_recording *recording)
{
  return &recording->transport;
}

const stic_error *stic_hid_recording_error(const stic_hid_recording *recording)
{
  return &recording->error;
}

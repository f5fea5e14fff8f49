#include "recorded.h"

#include "../../src/error.h"
#include "../hid/hid_drivers.h"
#include "../hid/hid_recording.h"
#include "../logitech/logitech_driver.h"
#include "../logitech/logitech_recording.h"

#include <stdlib.h>
#include <string.h>

struct stic_recorded {
  stic_raw_reader *reader; /* owned by what reads it */
  stic_hid_recording *hid; /* NULL: a serial recording */
  stic_device *device;     /* the supervisor's */
  stic_supervisor *supervisor;
  stic_error error;
};

static int64_t hid_now(void *context)
{
  const stic_hid_transport *transport = context;

  return transport->now(transport->context);
}

static int64_t serial_now(void *context)
{
  return stic_logitech_recording_now(context);
}

/* ---- opening ----------------------------------------------------------------------------- */

/* The driver of the first recorded device that has one. */
static stic_status find_driver(const stic_hid_transport *transport, const char *path, stic_device_spec *spec,
                               stic_error *err)
{
  stic_hid_node nodes[STIC_RAW_DEVICES_MAX];
  const int count = stic_hid_list(transport, nodes, STIC_RAW_DEVICES_MAX);

  for (int i = 0; i < count; i++) {
    const stic_driver *driver = stic_hid_driver_for(&nodes[i]);

    if (driver)
      return stic_spec_parse(driver->name, spec, err);
  }
  if (count == 0)
    return stic_error_set(
      err, STIC_BAD_INPUT, path, 0,
      "the recording does not say of which device it is; expected a line I: bus vendor product");
  return stic_error_set(err, STIC_BAD_INPUT, path, 0,
                        "no driver is for the recorded device %04x:%04x (%.60s)", (unsigned)nodes[0].vendor,
                        (unsigned)nodes[0].product, nodes[0].product_name);
}

static stic_status open_hid(stic_recorded *r, const char *path, const char *driver, stic_error *err)
{
  const stic_hid_transport *transport;
  stic_device_spec spec;
  stic_status status = stic_hid_recording_begin(r->reader, path, &r->hid, err);

  if (status != STIC_OK)
    return status;
  transport = stic_hid_recording_transport(r->hid);
  status = driver ? stic_spec_parse(driver, &spec, err) : find_driver(transport, path, &spec, err);
  if (status == STIC_OK)
    status = stic_hid_open_over(transport, &spec, &r->device, err);
  if (status == STIC_NO_DEVICE)
    return stic_error_set(err, STIC_BAD_INPUT, path, 0, "the recording is of no %.40s", spec.name);
  if (status != STIC_OK)
    return status;
  return stic_supervisor_adopt(r->device, hid_now, (void *)(uintptr_t)transport, &r->supervisor, err);
}

/* A serial recording does not say of what; there is one serial driver. */
static stic_status open_serial(stic_recorded *r, const char *driver, stic_error *err)
{
  stic_device_spec spec;
  stic_status status = STIC_OK;

  if (driver)
    status = stic_spec_parse(driver, &spec, err);
  if (status == STIC_OK && driver && strcmp(spec.name, stic_logitech_driver.name) != 0)
    status =
      stic_error_set(err, STIC_USAGE, NULL, 0, "'%.40s' does not decode serial recordings; expected %s",
                     spec.name, stic_logitech_driver.name);
  if (status == STIC_OK && driver)
    status = stic_spec_check(&spec, stic_logitech_driver.keys, err);
  if (status != STIC_OK) {
    stic_raw_close(r->reader);
    return status;
  }
  status = stic_logitech_recording_begin(r->reader, &r->device, err);
  if (status != STIC_OK)
    return status;
  return stic_supervisor_adopt(r->device, serial_now, r->device, &r->supervisor, err);
}

static stic_status open_by_kind(stic_recorded *r, const char *path, const char *driver, stic_error *err)
{
  stic_raw_record first;
  stic_raw_status status;

  do
    status = stic_raw_peek(r->reader, &first, err);
  while (status == STIC_RAW_WAIT);
  if (status != STIC_RAW_RECORD) {
    stic_raw_close(r->reader);
    return STIC_BAD_INPUT;
  }
  return stic_raw_reader_kind(r->reader) == STIC_RAW_HID ? open_hid(r, path, driver, err)
                                                         : open_serial(r, driver, err);
}

stic_status stic_recorded_open(const char *path, const stic_recorded_options *options,
                               stic_recorded **recorded, stic_error *err)
{
  stic_recorded *r = calloc(1, sizeof *r);
  const char *driver = options ? options->driver : NULL;
  stic_status status;

  *recorded = NULL;
  if (!r)
    return stic_error_set(err, STIC_NO_MEMORY, path, 0, "out of memory");
  status = stic_raw_open(path, &r->reader, err);
  if (status == STIC_OK) {
    if (options && options->lenient)
      stic_raw_be_lenient(r->reader, options->report, options->context);
    status = open_by_kind(r, path, driver, err);
  }
  if (status != STIC_OK)
    stic_recorded_close(r);
  else
    *recorded = r;
  return status;
}

void stic_recorded_close(stic_recorded *r)
{
  if (!r)
    return;
  stic_supervisor_close(r->supervisor);
  stic_hid_recording_close(r->hid);
  free(r);
}

/* ---- reading ----------------------------------------------------------------------------- */

int stic_recorded_next(stic_recorded *r, stic_device_sample *samples, int capacity)
{
  const int count = stic_supervisor_poll(r->supervisor, INT64_MAX, samples, capacity);

  if (count >= 0)
    return count;
  r->error = r->hid ? *stic_hid_recording_error(r->hid) : *stic_supervisor_error(r->supervisor);
  return r->error.status == STIC_OK ? STIC_DRIVER_END : STIC_DRIVER_BAD_DATA;
}

const stic_error *stic_recorded_error(const stic_recorded *r)
{
  return &r->error;
}

const stic_driver *stic_recorded_driver(const stic_recorded *r)
{
  return r->device->driver;
}

stic_device_counters stic_recorded_counters(const stic_recorded *r)
{
  return stic_supervisor_counters(r->supervisor);
}

const stic_device *stic_recorded_device(const stic_recorded *r)
{
  return r->device;
}

void stic_recorded_describe(const stic_recorded *r, char *out, size_t out_size)
{
  stic_supervisor_describe(r->supervisor, out, out_size);
}

/* The one list of drivers, and the calls that go through it. */
#include "../src/error.h"
#include "driver.h"
#include "gamepad/gamepad_driver.h"
#include "hydra/hydra_driver.h"
#include "logitech/logitech_driver.h"
#include "mouse/mouse_driver.h"
#include "recording/recording_driver.h"
#include "sample/sample_driver.h"
#include "spacemouse/spacemouse_driver.h"
#include "trace/trace_driver.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

/* In the order in which they are listed and asked to match. */
static const stic_driver *const drivers[] = {
  &stic_spacemouse_driver, &stic_hydra_driver, &stic_gamepad_driver,   &stic_logitech_driver,
  &stic_mouse_driver,      &stic_trace_driver, &stic_recording_driver, &stic_sample_driver,
};

#define DRIVER_COUNT ((int)(sizeof drivers / sizeof drivers[0]))

const stic_driver *stic_driver_at(int index)
{
  return index >= 0 && index < DRIVER_COUNT ? drivers[index] : NULL;
}

const char *stic_connection_name(stic_connection state)
{
  static const char *const names[] = {"closed",  "opening", "resetting", "syncing",
                                      "running", "stale",   "lost"};

  assert((unsigned)state < sizeof names / sizeof names[0]);
  return names[state];
}

static const stic_driver *find_driver(const char *name, stic_error *err)
{
  char names[200] = "";
  size_t used = 0;

  for (int i = 0; i < DRIVER_COUNT; i++) {
    int n;

    if (strcmp(drivers[i]->name, name) == 0)
      return drivers[i];
    n = snprintf(names + used, sizeof names - used, "%s%s", i > 0 ? ", " : "", drivers[i]->name);
    used += n > 0 && (size_t)n < sizeof names - used ? (size_t)n : 0;
  }
  stic_error_set(err, STIC_USAGE, NULL, 0, "unknown device '%.40s'; expected %s", name, names);
  return NULL;
}

static stic_status open_device(const char *spec_text, bool again, stic_device **device, stic_error *err)
{
  stic_device_spec spec;
  const stic_driver *driver;
  stic_status status = stic_spec_parse(spec_text, &spec, err);

  *device = NULL;
  if (status != STIC_OK)
    return status;
  spec.again = again;
  driver = find_driver(spec.name, err);
  if (!driver)
    return STIC_USAGE;
  status = stic_spec_check(&spec, driver->keys, err);
  if (status == STIC_OK)
    status = driver->open(&spec, device, err);
  assert((status == STIC_OK) == (*device != NULL));
  return status;
}

stic_status stic_device_open(const char *spec_text, stic_device **device, stic_error *err)
{
  return open_device(spec_text, false, device, err);
}

stic_status stic_device_reopen(const char *spec_text, stic_device **device, stic_error *err)
{
  return open_device(spec_text, true, device, err);
}

int stic_device_poll(stic_device *device, int64_t until_ns, stic_device_sample *samples, int capacity)
{
  int count;

  assert(device && samples && capacity >= 1);
  count = device->driver->poll(device, until_ns, samples, capacity);
  assert(count <= capacity);
  if (count > 0)
    device->counters.samples += count;
  return count;
}

int stic_device_send(stic_device *device, const stic_device_output *output)
{
  assert(device && output);
  return device->driver->send ? device->driver->send(device, output) : STIC_DRIVER_UNSUPPORTED;
}

void stic_device_describe(const stic_device *device, char *out, size_t out_size)
{
  assert(device && out && out_size > 0);
  device->driver->describe(device, out, out_size);
}

void stic_device_close(stic_device *device)
{
  if (device)
    device->driver->close(device);
}

void stic_device_show_raw(stic_device *device, const uint8_t *bytes, size_t length)
{
  device->raw_length = length < sizeof device->raw ? length : sizeof device->raw;
  memcpy(device->raw, bytes, device->raw_length);
}

#include "hid_drivers.h"

#include "../../src/error.h"
#include "../gamepad/gamepad_driver.h"
#include "../hydra/hydra_driver.h"
#include "../spacemouse/spacemouse_driver.h"

#include <string.h>

static const struct {
  const stic_driver *driver;
  stic_status (*open)(const stic_hid_transport *transport, const stic_device_spec *spec, stic_device **device,
                      stic_error *err);
} drivers[] = {
  {&stic_spacemouse_driver, stic_spacemouse_open},
  {&stic_hydra_driver, stic_hydra_open},
  {&stic_gamepad_driver, stic_gamepad_open},
};

#define DRIVER_COUNT (sizeof drivers / sizeof drivers[0])

stic_status stic_hid_open_over(const stic_hid_transport *transport, const stic_device_spec *spec,
                               stic_device **device, stic_error *err)
{
  for (size_t i = 0; i < DRIVER_COUNT; i++) {
    stic_status status;

    if (strcmp(drivers[i].driver->name, spec->name) != 0)
      continue;
    status = stic_spec_check(spec, drivers[i].driver->keys, err);
    return status == STIC_OK ? drivers[i].open(transport, spec, device, err) : status;
  }
  return stic_error_set(err, STIC_USAGE, NULL, 0, "'%.40s' is no driver of HID devices", spec->name);
}

const stic_driver *stic_hid_driver_for(const stic_hid_node *node)
{
  const stic_device_id id = stic_hid_id(node);

  for (size_t i = 0; i < DRIVER_COUNT; i++) {
    if (drivers[i].driver->match(&id))
      return drivers[i].driver;
  }
  return NULL;
}

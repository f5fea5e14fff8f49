#include "spacemouse_driver.h"

#include "../../src/error.h"
#include "spacemouse_decode.h"
#include "spacemouse_models.h"

#include <stdio.h>
#include <stdlib.h>

#define SILENCE_NS INT64_C(100000000) /* six missed reports at the slowest model's 16 ms */
#define MULTI_AXIS_CONTROLLER 0x08
#define ID_LED 4

typedef struct spacemouse_device {
  stic_device base;
  stic_hid_link link;
  stic_spacemouse mouse;
  stic_hid_rates rates;
  int grip_key;      /* of its model */
  int64_t motion_ns; /* when the cap's last report came */
  uint64_t sequence;
} spacemouse_device;

static const stic_spacemouse_model *model_of(const stic_hid_node *node)
{
  return stic_spacemouse_identify(node->vendor, node->product, node->product_name);
}

static bool spacemouse_match(const stic_device_id *id)
{
  const bool cap = (id->usage_page == 0x01 && id->usage == MULTI_AXIS_CONTROLLER) ||
                   (id->usage_page == 0 && id->usage == 0); /* the libusb backend does not tell */

  return cap && stic_spacemouse_identify(id->vendor, id->product, id->product_name);
}

/* ---- samples ----------------------------------------------------------------------------- */

/* Key bits with the grip key's at bit 0, and the one that was there in its place. */
static uint32_t swap_grip(uint32_t keys, int grip_key)
{
  const uint32_t differ = (keys ^ keys >> grip_key) & 1u;

  return keys ^ (differ | differ << grip_key);
}

static void make_sample(spacemouse_device *d, int64_t t_ns, stic_device_sample *sample)
{
  stic_hid_clear_sample(sample, t_ns, d->sequence++, STIC_SAMPLE_VELOCITY);
  for (int i = 0; i < 3; i++) {
    sample->velocity[i] = d->rates.speed * d->mouse.translation[i];
    sample->turn_rate[i] = d->rates.turn * d->mouse.rotation[i];
  }
  sample->buttons = swap_grip(d->mouse.keys, d->grip_key);
}

static bool take_report(stic_device *device, const stic_hid_link *link, const uint8_t *report, size_t length,
                        int64_t t_ns, stic_device_sample *sample)
{
  spacemouse_device *d = (spacemouse_device *)device;

  (void)link;
  /* A cap off its centre reports all the time. After a silence a key or one half of the axes must not bring the
   * old deflection back. */
  if (t_ns - d->motion_ns >= SILENCE_NS)
    stic_spacemouse_rest(&d->mouse);
  switch (stic_spacemouse_decode(&d->mouse, report, length)) {
  case STIC_SPACEMOUSE_MOTION: d->motion_ns = t_ns; break;
  case STIC_SPACEMOUSE_KEYS: break;
  case STIC_SPACEMOUSE_BAD: device->counters.bad_records++; return false;
  case STIC_SPACEMOUSE_OTHER:
  case STIC_SPACEMOUSE_BATTERY: return false;
  }
  make_sample(d, t_ns, sample);
  return true;
}

static int spacemouse_poll(stic_device *device, int64_t until_ns, stic_device_sample *samples, int capacity)
{
  return stic_hid_drain(&((spacemouse_device *)device)->link, device, take_report, until_ns, samples,
                        capacity);
}

/* ---- opening and closing ----------------------------------------------------------------- */

static int set_led(spacemouse_device *d, bool on)
{
  const uint8_t data[2] = {ID_LED, on};

  return d->link.transport->write(d->link.handle, data, sizeof data);
}

static int spacemouse_send(stic_device *device, const stic_device_output *output)
{
  return set_led((spacemouse_device *)device, output->led);
}

static void spacemouse_close(stic_device *device)
{
  spacemouse_device *d = (spacemouse_device *)device;

  if (d->base.state != STIC_CONNECTION_LOST)
    set_led(d, false);
  stic_hid_disconnect(&d->link, 1);
  free(d);
}

stic_status stic_spacemouse_open(const stic_hid_transport *transport, const stic_device_spec *spec,
                                 stic_device **device, stic_error *err)
{
  spacemouse_device *d = calloc(1, sizeof *d);
  stic_status status;
  int count;

  if (!d)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  d->base.driver = &stic_spacemouse_driver;
  d->mouse.battery = -1;
  status = stic_hid_read_rates(spec, &d->rates, err);
  if (status == STIC_OK)
    status = stic_hid_connect(transport, &stic_spacemouse_driver, spec, &d->link, 1, &count, err);
  if (status != STIC_OK) {
    free(d);
    return status;
  }
  d->grip_key = model_of(&d->link.node)->grip_key;
  d->base.state = STIC_CONNECTION_RUNNING;
  set_led(d, true); /* some models have none, so a refusal means nothing */
  *device = &d->base;
  return STIC_OK;
}

static stic_status open_system(const stic_device_spec *spec, stic_device **device, stic_error *err)
{
  return stic_spacemouse_open(&stic_hid_system, spec, device, err);
}

static void spacemouse_describe(const stic_device *device, char *out, size_t out_size)
{
  const spacemouse_device *d = (const spacemouse_device *)device;
  char where[STIC_HID_PATH_MAX + 100], battery[32] = "";

  stic_hid_describe(&d->link, model_of(&d->link.node)->name, where, sizeof where);
  if (d->mouse.battery >= 0)
    snprintf(battery, sizeof battery, ", battery %d %%", d->mouse.battery);
  snprintf(out, out_size, "%s, %g m/s and %g rad/s at full deflection%s", where, d->rates.speed,
           d->rates.turn, battery);
}

static const stic_spec_key keys[] = {STIC_HID_SPEC_KEYS, STIC_HID_RATE_KEYS, {NULL, false, NULL}};

const stic_driver stic_spacemouse_driver = {
  .name = "spacemouse",
  .about = "3Dconnexion SpaceNavigator, SpaceMouse and relatives: push and turn the cap",
  .keys = keys,
  .kind = STIC_DRIVER_RATE,
  .silence = STIC_SILENCE_REST,
  .silence_ns = SILENCE_NS,
  .own_time = false,
  .match = spacemouse_match,
  .open = open_system,
  .poll = spacemouse_poll,
  .send = spacemouse_send,
  .close = spacemouse_close,
  .describe = spacemouse_describe,
};

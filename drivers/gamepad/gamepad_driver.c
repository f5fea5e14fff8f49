#include "gamepad_driver.h"

#include "../../src/error.h"
#include "gamepad_decode.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SONY 0x054c
#define DUALSENSE 0x0ce6
#define DUALSENSE_EDGE 0x0df2
#define GAMEPAD 0x05
#define SILENCE_NS INT64_C(100000000) /* 25 reports over USB */
/* Asked for its calibration over Bluetooth, the pad begins to send full reports. */
#define ID_CALIBRATION 0x05
#define CALIBRATION_LENGTH 41
#define ASK_AGAIN_NS INT64_C(1000000000)

typedef struct gamepad_device {
  stic_device base;
  stic_hid_link link;
  stic_hid_rates rates;
  stic_hid_sequence sequence;
  int64_t asked_ns; /* when full reports were last asked for */
  bool asked;
} gamepad_device;

/* By its numbers or, where they are none of these, by what it calls itself: adapters hide numbers. */
static bool is_dualsense(const stic_device_id *id)
{
  if (id->vendor == SONY && (id->product == DUALSENSE || id->product == DUALSENSE_EDGE))
    return true;
  return (id->vendor == SONY || (id->vendor == 0 && id->product == 0)) && id->product_name &&
         strstr(id->product_name, "DualSense");
}

static bool gamepad_match(const stic_device_id *id)
{
  return is_dualsense(id) &&
         ((id->usage_page == 0x01 && id->usage == GAMEPAD) || (id->usage_page == 0 && id->usage == 0));
}

/* ---- samples ----------------------------------------------------------------------------- */

/* Left stick: right and up. L2 pulls nearer, R2 pushes away. Right stick: looks right and up, that is turns
 * about -y and +x. Hat: rolls to its side. */
static void make_sample(const gamepad_device *d, const stic_gamepad *pad, int64_t t_ns,
                        stic_device_sample *sample)
{
  stic_hid_clear_sample(sample, t_ns, d->sequence.total, STIC_SAMPLE_VELOCITY);
  sample->velocity[0] = d->rates.speed * pad->left[0];
  sample->velocity[1] = d->rates.speed * pad->left[1];
  sample->velocity[2] = d->rates.speed * (pad->l2 - pad->r2);
  sample->turn_rate[0] = d->rates.turn * pad->right[1];
  sample->turn_rate[1] = d->rates.turn * (0.0 - pad->right[0]);
  sample->turn_rate[2] = d->rates.turn * (0 - pad->hat[0]);
  sample->buttons = pad->buttons;
}

/* A pad that does not hear is asked again, but not at its report rate. The kernel waits for the answer, up to 5 s; so a
 * Bluetooth pad is asked when it is opened, and in poll() only one that gives no samples anyway. */
static void ask_for_full_reports(gamepad_device *d, int64_t now_ns)
{
  uint8_t calibration[CALIBRATION_LENGTH] = {ID_CALIBRATION};

  if (d->asked && now_ns - d->asked_ns < ASK_AGAIN_NS)
    return;
  d->asked = true;
  d->asked_ns = now_ns;
  d->link.transport->get_feature(d->link.handle, calibration, sizeof calibration);
}

static bool take_report(stic_device *device, const stic_hid_link *link, const uint8_t *report, size_t length,
                        int64_t t_ns, stic_device_sample *sample)
{
  gamepad_device *d = (gamepad_device *)device;
  stic_gamepad pad;

  (void)link;
  switch (stic_gamepad_decode(report, length, &pad)) {
  case STIC_GAMEPAD_OK:
    d->base.state = STIC_CONNECTION_RUNNING;
    stic_hid_count(&d->sequence, pad.sequence, &device->counters.gaps);
    make_sample(d, &pad, t_ns, sample);
    return true;
  case STIC_GAMEPAD_REDUCED:
    d->base.state = STIC_CONNECTION_RESETTING;
    ask_for_full_reports(d, t_ns);
    return false;
  case STIC_GAMEPAD_OTHER: return false;
  case STIC_GAMEPAD_BAD_LENGTH:
  case STIC_GAMEPAD_BAD_CHECKSUM:
  case STIC_GAMEPAD_BAD_VALUE: break;
  }
  d->base.counters.bad_records++;
  return false;
}

static int gamepad_poll(stic_device *device, int64_t until_ns, stic_device_sample *samples, int capacity)
{
  return stic_hid_drain(&((gamepad_device *)device)->link, device, take_report, until_ns, samples, capacity);
}

/* ---- opening and closing ----------------------------------------------------------------- */

static void gamepad_close(stic_device *device)
{
  gamepad_device *d = (gamepad_device *)device;

  stic_hid_disconnect(&d->link, 1);
  free(d);
}

stic_status stic_gamepad_open(const stic_hid_transport *transport, const stic_device_spec *spec,
                              stic_device **device, stic_error *err)
{
  gamepad_device *d = calloc(1, sizeof *d);
  stic_status status;
  int count;

  if (!d)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  d->base.driver = &stic_gamepad_driver;
  status = stic_hid_read_rates(spec, &d->rates, err);
  if (status == STIC_OK)
    status = stic_hid_connect(transport, &stic_gamepad_driver, spec, &d->link, 1, &count, err);
  if (status != STIC_OK) {
    free(d);
    return status;
  }
  d->base.state = STIC_CONNECTION_SYNCING;
  if (strcmp(d->link.node.bus, "bluetooth") == 0)
    ask_for_full_reports(d, stic_hid_now(&d->link));
  *device = &d->base;
  return STIC_OK;
}

static stic_status open_system(const stic_device_spec *spec, stic_device **device, stic_error *err)
{
  return stic_gamepad_open(&stic_hid_system, spec, device, err);
}

static void gamepad_describe(const stic_device *device, char *out, size_t out_size)
{
  const gamepad_device *d = (const gamepad_device *)device;
  const bool edge = d->link.node.product == DUALSENSE_EDGE;
  char where[STIC_HID_PATH_MAX + 100];

  stic_hid_describe(&d->link, edge ? "DualSense Edge" : "DualSense", where, sizeof where);
  snprintf(out, out_size, "%s, %g m/s and %g rad/s at full deflection", where, d->rates.speed, d->rates.turn);
}

static const stic_spec_key keys[] = {STIC_HID_SPEC_KEYS, STIC_HID_RATE_KEYS, {NULL, false, NULL}};

const stic_driver stic_gamepad_driver = {
  .name = "gamepad",
  .about = "DualSense gamepad: sticks, L2, R2 and hat move the hand, R1 grips",
  .keys = keys,
  .kind = STIC_DRIVER_RATE,
  .silence = STIC_SILENCE_STALE,
  .silence_ns = SILENCE_NS,
  .own_time = false,
  .match = gamepad_match,
  .open = open_system,
  .poll = gamepad_poll,
  .send = NULL,
  .close = gamepad_close,
  .describe = gamepad_describe,
};

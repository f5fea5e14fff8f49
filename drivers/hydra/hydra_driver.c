#include "hydra_driver.h"

#include "../../src/error.h"
#include "hydra_decode.h"
#include "hydra_mode.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define VENDOR 0x1532
#define PRODUCT 0x0300
#define NODES_MAX 2                   /* its two interfaces: motion, and gamepad with control */
#define SILENCE_NS INT64_C(100000000) /* 25 reports */
#define SLICE_NS INT64_C(10000000)    /* of a wait on one of two nodes */

typedef struct hydra_device {
  stic_device base;
  stic_hid_link links[NODES_MAX];
  int link_count;
  int motion;   /* the node that motion comes from; a guess until it has come */
  int command;  /* the node that commands go to */
  bool changed; /* the mode, by us */
  stic_hydra_mode mode;
  int wand;
  stic_hydra_hemisphere hemisphere;
  bool gripped;
  stic_hid_sequence sequence;
} hydra_device;

static bool hydra_match(const stic_device_id *id)
{
  if (id->vendor == 0 && id->product == 0) /* an adapter that hides them */
    return id->product_name && strstr(id->product_name, "Razer Hydra");
  return id->vendor == VENDOR && id->product == PRODUCT;
}

/* ---- samples ----------------------------------------------------------------------------- */

static void make_sample(hydra_device *d, const stic_hydra_report *report, int64_t t_ns,
                        stic_device_sample *sample)
{
  const stic_hydra_wand *wand = &report->wands[d->wand];

  stic_hid_clear_sample(sample, t_ns, d->sequence.total,
                        STIC_SAMPLE_POSITION | STIC_SAMPLE_ORIENTATION | STIC_SAMPLE_TRACKED);
  d->gripped = stic_hydra_grips(d->gripped, wand->trigger);
  memcpy(sample->position, wand->position, sizeof sample->position);
  stic_hydra_keep_hemisphere(&d->hemisphere, d->wand, sample->position);
  memcpy(sample->orientation, wand->orientation, sizeof sample->orientation);
  sample->buttons = (d->gripped ? STIC_BUTTON_GRIP : 0) | wand->keys << 1;
}

static bool take_report(stic_device *device, const stic_hid_link *link, const uint8_t *data, size_t length,
                        int64_t t_ns, stic_device_sample *sample)
{
  hydra_device *d = (hydra_device *)device;
  const int node = (int)(link - d->links);
  stic_hydra_report report;

  switch (stic_hydra_decode(data, length, &report)) {
  case STIC_HYDRA_OK: break;
  case STIC_HYDRA_OTHER:
    if (node == d->motion && device->state == STIC_CONNECTION_RUNNING)
      device->counters.bad_records++;
    return false;
  case STIC_HYDRA_BAD_HEADER:
  case STIC_HYDRA_BAD_CHECKSUM:
  case STIC_HYDRA_BAD_ROTATION: device->counters.bad_records++; return false;
  }
  d->motion = node;
  device->state = STIC_CONNECTION_RUNNING;
  stic_hydra_mode_heard(&d->mode, t_ns);
  stic_hid_count(&d->sequence, report.sequence, &device->counters.gaps);
  make_sample(d, &report, t_ns, sample);
  return true;
}

/* ---- mode -------------------------------------------------------------------------------- */

/* Some programs send to one interface, some to the other, and both work in the field: take turns. The
 * answer is fetched, as the maker's protocol wants, and thrown away. The kernel may wait 5 s for each of the two; in
 * poll() that happens only after a second without motion, when the hand was let go long ago. */
static void send_mode(hydra_device *d, bool motion)
{
  const stic_hid_link *link = &d->links[d->command];
  uint8_t feature[STIC_HYDRA_FEATURE_LENGTH];

  stic_hydra_mode_command(motion, feature);
  if (link->transport->set_feature(link->handle, feature, sizeof feature) == 0) {
    feature[0] = 0;
    link->transport->get_feature(link->handle, feature, sizeof feature);
  }
}

/* Sends what is due: 0, or STIC_DRIVER_LOST if it does not answer. */
static int advance_mode(hydra_device *d)
{
  switch (stic_hydra_mode_next(&d->mode, stic_hid_now(&d->links[0]))) {
  case STIC_HYDRA_WAIT: break;
  case STIC_HYDRA_COMMAND:
    d->base.state = STIC_CONNECTION_RESETTING;
    d->changed = true;
    if (d->mode.commands > 1)
      d->command = (d->command + 1) % d->link_count;
    send_mode(d, true);
    break;
  case STIC_HYDRA_GIVE_UP:
    d->base.state = STIC_CONNECTION_LOST;
    stic_error_set(&d->base.error, STIC_NO_DEVICE, NULL, 0,
                   "hydra at %.100s does not switch to motion reports; unplug it and plug it in again",
                   d->links[d->motion].node.path);
    return STIC_DRIVER_LOST;
  }
  return 0;
}

/* ---- reading ----------------------------------------------------------------------------- */

static int64_t earliest(int64_t a, int64_t b)
{
  return a < b ? a : b;
}

/* One turn: the gamepad side is read as well, since it may turn out to be the motion side. */
static int take_turn(hydra_device *d, int64_t until_ns, stic_device_sample *samples, int capacity)
{
  const int motion = d->motion;
  const int count = stic_hid_drain(&d->links[motion], &d->base, take_report, until_ns, samples, capacity);

  if (count != 0 || d->link_count == 1)
    return count;
  return stic_hid_drain(&d->links[d->link_count - 1 - motion], &d->base, take_report, 0, samples, capacity);
}

static int hydra_poll(stic_device *device, int64_t until_ns, stic_device_sample *samples, int capacity)
{
  hydra_device *d = (hydra_device *)device;

  for (;;) {
    int result = take_turn(d, earliest(until_ns, stic_hid_now(&d->links[0]) + SLICE_NS), samples, capacity);

    if (result == 0)
      result = advance_mode(d);
    if (result != 0 || stic_hid_now(&d->links[0]) >= until_ns)
      return result;
  }
}

/* ---- opening and closing ----------------------------------------------------------------- */

static void hydra_close(stic_device *device)
{
  hydra_device *d = (hydra_device *)device;

  if (d->changed && d->base.state != STIC_CONNECTION_LOST)
    send_mode(d, false);
  stic_hid_disconnect(d->links, d->link_count);
  free(d);
}

static stic_status choose_wand(hydra_device *d, const stic_device_spec *spec, stic_error *err)
{
  const char *hand = stic_spec_text(spec, "hand", "right");

  if (strcmp(hand, "left") != 0 && strcmp(hand, "right") != 0)
    return stic_error_set(err, STIC_USAGE, NULL, 0, "device hydra: hand is '%.40s'; expected left or right",
                          hand);
  d->wand = strcmp(hand, "left") == 0 ? STIC_HYDRA_LEFT : STIC_HYDRA_RIGHT;
  return STIC_OK;
}

stic_status stic_hydra_open(const stic_hid_transport *transport, const stic_device_spec *spec,
                            stic_device **device, stic_error *err)
{
  hydra_device *d = calloc(1, sizeof *d);
  stic_status status;

  if (!d)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  d->base.driver = &stic_hydra_driver;
  status = choose_wand(d, spec, err);
  if (status == STIC_OK)
    status = stic_hid_connect(transport, &stic_hydra_driver, spec, d->links, NODES_MAX, &d->link_count, err);
  if (status != STIC_OK) {
    free(d);
    return status;
  }
  d->command = d->link_count - 1; /* the gamepad side, whose usage has the greater number */
  d->base.state = STIC_CONNECTION_SYNCING;
  stic_hydra_mode_start(&d->mode, stic_hid_now(&d->links[0]));
  *device = &d->base;
  return STIC_OK;
}

static stic_status open_system(const stic_device_spec *spec, stic_device **device, stic_error *err)
{
  return stic_hydra_open(&stic_hid_system, spec, device, err);
}

static void hydra_describe(const stic_device *device, char *out, size_t out_size)
{
  const hydra_device *d = (const hydra_device *)device;
  char where[STIC_HID_PATH_MAX + 100];

  stic_hid_describe(&d->links[d->motion], "Razer Hydra", where, sizeof where);
  snprintf(out, out_size, "%s, %s hand", where, d->wand == STIC_HYDRA_LEFT ? "left" : "right");
}

static const stic_spec_key keys[] = {
  STIC_HID_SPEC_KEYS, {"hand", false, "left or right: which wand, default right"}, {NULL, false, NULL}};

const stic_driver stic_hydra_driver = {
  .name = "hydra",
  .about = "Razer Hydra: a wand on a magnetic tracker; its trigger grips",
  .keys = keys,
  .kind = STIC_DRIVER_POSE,
  .silence = STIC_SILENCE_STALE,
  .silence_ns = SILENCE_NS,
  .own_time = false,
  .match = hydra_match,
  .open = open_system,
  .poll = hydra_poll,
  .send = NULL,
  .close = hydra_close,
  .describe = hydra_describe,
};

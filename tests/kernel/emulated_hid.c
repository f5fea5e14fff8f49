/* The devices, their gesture, and a life of them:
 *
 *   uhid-devices NAME, gadget-device NAME
 *
 * The device is plugged in, waits until a driver is at work, makes its gesture (a second long: grip, push to
 * the right, let go), is pulled out, plugged in again, and repeats the gesture until the driver says farewell.
 * Exit code 0: all of that happened; 1: not within the time; 77: it cannot be plugged into this kernel. */
#include "emulated_hid.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define BUS_USB 3
#define BUS_BLUETOOTH 5
#define REPORT_MAX 128
#define CYCLE_MS 1000
#define PATIENCE_MS 60000 /* for anything that a driver is expected to do */
#define AWAY_MS 300       /* between pulling out and plugging in */

/* ---- the gesture ------------------------------------------------------------------------- */

static bool gripping(int64_t t_ms)
{
  return t_ms >= 200 && t_ms < 800;
}

static bool pushing(int64_t t_ms)
{
  return t_ms >= 350 && t_ms < 650;
}

static void put_int16(uint8_t *at, int value)
{
  at[0] = (uint8_t)((unsigned)value & 0xff);
  at[1] = (uint8_t)((unsigned)value >> 8 & 0xff);
}

/* ---- 3Dconnexion ------------------------------------------------------------------------- */

/* As listed in public analyses of the devices. What both have in common: */
#define CAP_START                                                                                            \
  0x05, 0x01, 0x09, 0x08, 0xa1, 0x01, 0xa1, 0x00, 0x85, 0x01, 0x16, 0xa2, 0xfe, 0x26, 0x5e, 0x01, 0x36,      \
    0x88, 0xfa, 0x46, 0x78, 0x05, 0x55, 0x0c, 0x65, 0x11, 0x09, 0x30, 0x09, 0x31, 0x09, 0x32
#define CAP_KEYS_AND_LED                                                                                     \
  0xa1, 0x02, 0x85, 0x03, 0x05, 0x01, 0x05, 0x09, 0x19, 0x01, 0x29, 0x02, 0x15, 0x00, 0x25, 0x01, 0x35,      \
    0x00, 0x45, 0x01, 0x75, 0x01, 0x95, 0x02, 0x81, 0x02, 0x95, 0x0e, 0x81, 0x03, 0xc0, 0xa1, 0x02, 0x85,    \
    0x04, 0x05, 0x08, 0x09, 0x4b, 0x15, 0x00, 0x25, 0x01, 0x95, 0x01, 0x75, 0x01, 0x91, 0x02, 0x95, 0x01,    \
    0x75, 0x07, 0x91, 0x03, 0xc0
#define VENDOR_FEATURE(id, usage, count) 0xa1, 0x02, 0x85, id, 0x09, usage, 0x95, count, 0xb1, 0x02, 0xc0
#define CAP_FEATURES                                                                                         \
  VENDOR_FEATURE(0x05, 0x20, 1), VENDOR_FEATURE(0x06, 0x21, 1), VENDOR_FEATURE(0x07, 0x22, 1),               \
    VENDOR_FEATURE(0x08, 0x23, 7), VENDOR_FEATURE(0x09, 0x24, 7), VENDOR_FEATURE(0x0a, 0x25, 7),             \
    VENDOR_FEATURE(0x0b, 0x26, 1), VENDOR_FEATURE(0x13, 0x2e, 1)

static const uint8_t navigator_descriptor[217] = {
  CAP_START, 0x75, 0x10,         0x95, 0x03, 0x81, 0x06, 0xc0, 0xa1, 0x00, 0x85, 0x02, 0x09,
  0x33,      0x09, 0x34,         0x09, 0x35, 0x75, 0x10, 0x95, 0x03, 0x81, 0x06, 0xc0, CAP_KEYS_AND_LED,
  0x06,      0x00, 0xff,         0x09, 0x01, 0xa1, 0x02, 0x15, 0x80, 0x25, 0x7f, 0x75, 0x08,
  0x09,      0x3a, CAP_FEATURES, 0xc0, 0xc0};

static const uint8_t wireless_descriptor[270] = {
  CAP_START, 0x09, 0x33, 0x09, 0x34, 0x09, 0x35, 0x75, 0x10, 0x95, 0x06, 0x81, 0x02, 0xc0, CAP_KEYS_AND_LED,
  /* battery */
  0xa1, 0x02, 0x85, 0x17, 0x15, 0x00, 0x25, 0x64, 0x55, 0x00, 0x65, 0x00, 0x05, 0x06, 0x09, 0x20, 0x75, 0x08,
  0x95, 0x01, 0x81, 0x02, 0x15, 0x00, 0x25, 0x01, 0x06, 0x00, 0xff, 0x09, 0x27, 0x75, 0x01, 0x95, 0x01, 0x81,
  0x02, 0x75, 0x07, 0x81, 0x03, 0xc0, 0x06, 0x00, 0xff, 0x09, 0x01, 0xa1, 0x02, 0x15, 0x80, 0x25, 0x7f, 0x75,
  0x08, 0x09, 0x3a, CAP_FEATURES, VENDOR_FEATURE(0x19, 0x31, 4), VENDOR_FEATURE(0x1a, 0x32, 7), 0xc0, 0xc0};

/* The LED tells when a driver comes and goes. */
static void cap_output(stic_emulator *e, const uint8_t *data, size_t length)
{
  if (length != 2 || data[0] != 0x04)
    return;
  e->farewell = e->at_work && data[1] == 0;
  e->at_work = e->at_work || data[1] == 1;
}

/* A key's report when it changes; axes while the cap is off its centre and three more times at rest. */
static bool cap_says(stic_emulator *e, int64_t t_ms, int echoes)
{
  if (pushing(t_ms))
    e->echoes = echoes;
  else if (e->echoes > 0)
    e->echoes--;
  else
    return false;
  return true;
}

static bool cap_key(stic_emulator *e, int64_t t_ms, uint8_t *out)
{
  if (gripping(t_ms) == e->told_grip)
    return false;
  e->told_grip = !e->told_grip;
  out[0] = 3;
  out[1] = e->told_grip;
  return true;
}

static size_t navigator_report(stic_emulator *e, int64_t t_ms, int *interface, uint8_t *out)
{
  *interface = 0;
  if (cap_key(e, t_ms, out))
    return 3;
  if (!cap_says(e, t_ms, 6))
    return 0;
  out[0] = e->step & 1 ? 2 : 1;
  if (out[0] == 1)
    put_int16(out + 1, pushing(t_ms) ? 350 : 0);
  else
    put_int16(out + 3, pushing(t_ms) ? -30 : 0);
  return 7;
}

static size_t wireless_report(stic_emulator *e, int64_t t_ms, int *interface, uint8_t *out)
{
  *interface = 0;
  if (e->step == 0) {
    memcpy(out, "\x17\x50\x01", 3);
    return 3;
  }
  if (cap_key(e, t_ms, out))
    return 3;
  if (!cap_says(e, t_ms, 3))
    return 0;
  out[0] = 1;
  put_int16(out + 1, pushing(t_ms) ? 350 : 0);
  put_int16(out + 9, pushing(t_ms) ? -30 : 0);
  return 13;
}

/* ---- Razer Hydra ------------------------------------------------------------------------- */

#define HYDRA_LENGTH 52
#define HYDRA_COMMAND_LENGTH 91 /* with the 0 that the kernel passes on */

static const uint8_t hydra_motion_descriptor[25] = {0x05, 0x01, 0x09, 0x00, 0xa1, 0x01, 0x09, 0x03, 0x15,
                                                    0x00, 0x26, 0xff, 0x00, 0x35, 0x00, 0x46, 0xff, 0x00,
                                                    0x75, 0x08, 0x95, 0x34, 0x81, 0x02, 0xc0};

/* The device's own is not public; this is a gamepad of 12 bytes with the 90-byte feature report. */
static const uint8_t hydra_gamepad_descriptor[] = {0x05, 0x01, 0x09, 0x05, 0xa1, 0x01, 0x15, 0x00, 0x26, 0xff,
                                                   0x00, 0x75, 0x08, 0x06, 0x00, 0xff, 0x09, 0x01, 0x95, 0x0c,
                                                   0x81, 0x02, 0x09, 0x02, 0x95, 0x5a, 0xb1, 0x02, 0xc0};

/* CRC-16, polynomial 0x1021, initial value 0x1D0F; written apart from the driver's, as a check of it. */
static unsigned hydra_crc(const uint8_t *data, size_t length)
{
  unsigned long rest = 0x1d0f;

  for (size_t bit = 0; bit < 8 * length; bit++) {
    const unsigned in = data[bit / 8] >> (7 - bit % 8) & 1u;
    const unsigned out = (unsigned)(rest >> 15 & 1);

    rest = rest << 1 & 0xffff;
    if (in ^ out)
      rest ^= 0x1021;
  }
  return (unsigned)rest;
}

static void hydra_set_feature(stic_emulator *e, const uint8_t *data, size_t length)
{
  uint8_t sum = 0;

  if (length != HYDRA_COMMAND_LENGTH || data[6] != 1 || data[8] != 4)
    return;
  for (size_t i = 3; i < 89; i++)
    sum ^= data[i];
  if (sum != data[89])
    return;
  e->farewell = e->at_work && data[9] == 0;
  e->at_work = e->at_work || data[9] == 3;
}

static size_t hydra_get_feature(stic_emulator *e, uint8_t id, uint8_t *out)
{
  (void)e;
  out[0] = id;
  out[1] = 2; /* done */
  return HYDRA_COMMAND_LENGTH;
}

/* Right wand, raw axes (x right, y to the user, z down): from x = -0.1 m to +0.1 m and back at once. */
static void hydra_motion_report(stic_emulator *e, int64_t t_ms, uint8_t *out)
{
  const int x_mm = t_ms < 350 || t_ms >= 650 ? -100 : (int)(-100 + 200 * (t_ms - 350) / 300);

  memcpy(out, "\x01\x00\x34\x00\x02\x00", 6);
  for (int wand = 0; wand < 2; wand++) {
    uint8_t *at = out + 6 + 22 * wand;

    at[0] = (uint8_t)(wand + 1);
    at[1] = e->sequence;
    put_int16(at + 2, wand == 0 ? -200 : x_mm);
    put_int16(at + 4, 300);
    put_int16(at + 6, -200);
    put_int16(at + 8, 32767);
    at[16] = 0x80;
    at[21] = wand == 1 && gripping(t_ms) ? 255 : 0;
  }
  put_int16(out + 50, (int)hydra_crc(out, 50));
}

static size_t hydra_report(stic_emulator *e, int64_t t_ms, int *interface, uint8_t *out)
{
  if (!e->at_work) {
    *interface = 1; /* a gamepad still */
    return 12;
  }
  *interface = 0;
  e->sequence = (uint8_t)(e->sequence + (e->step % 100 == 99 ? 3 : 1)); /* two lost */
  hydra_motion_report(e, t_ms, out);
  if (e->step % 50 == 25)
    out[8] ^= 0x55; /* garbled on the way */
  return HYDRA_LENGTH;
}

/* ---- DualSense --------------------------------------------------------------------------- */

/* Only the reports' IDs and lengths are the device's. */
static const uint8_t pad_usb_descriptor[] = {
  0x05, 0x01, 0x09, 0x05, 0xa1, 0x01, 0x15, 0x00, 0x26, 0xff, 0x00, 0x75, 0x08, 0x06, 0x00, 0xff, 0x85,
  0x01, 0x09, 0x20, 0x95, 0x3f, 0x81, 0x02, 0x85, 0x05, 0x09, 0x22, 0x95, 0x28, 0xb1, 0x02, 0xc0};
static const uint8_t pad_bluetooth_descriptor[] = {
  0x05, 0x01, 0x09, 0x05, 0xa1, 0x01, 0x15, 0x00, 0x26, 0xff, 0x00, 0x75, 0x08, 0x06,
  0x00, 0xff, 0x85, 0x01, 0x09, 0x20, 0x95, 0x09, 0x81, 0x02, 0x85, 0x31, 0x09, 0x21,
  0x95, 0x4d, 0x81, 0x02, 0x85, 0x05, 0x09, 0x22, 0x95, 0x28, 0xb1, 0x02, 0xc0};

static uint32_t pad_crc(const uint8_t *data, size_t length)
{
  uint32_t rest = 0xffffffffu;

  for (size_t i = 0; i <= length; i++) {
    const uint8_t byte = i == 0 ? 0xa1 : data[i - 1];

    for (int bit = 0; bit < 8; bit++) {
      const uint32_t out = (rest ^ byte >> bit) & 1u;

      rest = rest >> 1 ^ (out ? 0xedb88320u : 0);
    }
  }
  return ~rest;
}

static void pad_common(stic_emulator *e, int64_t t_ms, uint8_t *at)
{
  memset(at, 128, 4);
  at[0] = pushing(t_ms) ? 255 : 127; /* not quite centred at rest */
  at[6] = e->sequence++;
  at[7] = 8;
  at[8] = gripping(t_ms) ? 0x02 : 0;
}

/* It has no farewell but being closed, and a driver may close and open it again while it comes. */
static void pad_watch(stic_emulator *e)
{
  e->idle = e->open_count > 0 ? 0 : e->idle + 1;
  e->farewell = e->at_work && e->idle >= 50;
}

static size_t pad_usb_report(stic_emulator *e, int64_t t_ms, int *interface, uint8_t *out)
{
  *interface = 0;
  pad_watch(e);
  e->at_work = e->at_work || e->open_count > 0;
  out[0] = 0x01;
  pad_common(e, t_ms, out + 1);
  return 64;
}

static size_t pad_get_feature(stic_emulator *e, uint8_t id, uint8_t *out)
{
  if (id != 0x05)
    return 0;
  e->at_work = true; /* over Bluetooth: full reports from now on */
  out[0] = id;
  return 41;
}

static size_t pad_bluetooth_report(stic_emulator *e, int64_t t_ms, int *interface, uint8_t *out)
{
  uint32_t crc;

  *interface = 0;
  pad_watch(e);
  if (!e->at_work) {
    out[0] = 0x01;
    memset(out + 1, 128, 4);
    out[5] = 8;
    return 10;
  }
  out[0] = 0x31;
  pad_common(e, t_ms, out + 2);
  crc = pad_crc(out, 74);
  for (int i = 0; i < 4; i++)
    out[74 + i] = (uint8_t)(crc >> (8 * i));
  if (e->step % 50 == 25)
    out[2] ^= 0x55;
  return 78;
}

/* ---- the table --------------------------------------------------------------------------- */

static const stic_emulated_device devices[] = {
  {.name = "spacenavigator",
   .product = "3Dconnexion SpaceNavigator",
   .serial = "NAVIGATOR",
   .bus = BUS_USB,
   .vendor = 0x046d,
   .product_id = 0xc626,
   .interface_count = 1,
   .descriptors = {navigator_descriptor},
   .descriptor_lengths = {sizeof navigator_descriptor},
   .period_ms = 8,
   .report = navigator_report,
   .output = cap_output},
  {.name = "spacemouse-wireless",
   .product = "3Dconnexion SpaceMouse Wireless",
   .serial = "WIRELESS",
   .bus = BUS_USB,
   .vendor = 0x256f,
   .product_id = 0xc62e,
   .interface_count = 1,
   .descriptors = {wireless_descriptor},
   .descriptor_lengths = {sizeof wireless_descriptor},
   .period_ms = 16,
   .report = wireless_report,
   .output = cap_output},
  {.name = "hydra",
   .product = "Razer Hydra",
   .serial = "",
   .bus = BUS_USB,
   .vendor = 0x1532,
   .product_id = 0x0300,
   .interface_count = 2,
   .descriptors = {hydra_motion_descriptor, hydra_gamepad_descriptor},
   .descriptor_lengths = {sizeof hydra_motion_descriptor, sizeof hydra_gamepad_descriptor},
   .period_ms = 4,
   .report = hydra_report,
   .set_feature = hydra_set_feature,
   .get_feature = hydra_get_feature},
  {.name = "dualsense",
   .product = "DualSense Wireless Controller",
   .serial = "PADUSB",
   .bus = BUS_USB,
   .vendor = 0x054c,
   .product_id = 0x0ce6,
   .interface_count = 1,
   .descriptors = {pad_usb_descriptor},
   .descriptor_lengths = {sizeof pad_usb_descriptor},
   .period_ms = 4,
   .report = pad_usb_report},
  {.name = "dualsense-bluetooth",
   .product = "DualSense Wireless Controller",
   .serial = "PADBLUETOOTH",
   .bus = BUS_BLUETOOTH,
   .vendor = 0x054c,
   .product_id = 0x0ce6,
   .interface_count = 1,
   .descriptors = {pad_bluetooth_descriptor},
   .descriptor_lengths = {sizeof pad_bluetooth_descriptor},
   .period_ms = 4,
   .report = pad_bluetooth_report,
   .get_feature = pad_get_feature},
};

#define DEVICE_COUNT (sizeof devices / sizeof devices[0])

/* ---- its life ---------------------------------------------------------------------------- */

int64_t stic_emulator_now_ms(void)
{
  struct timespec t;

  clock_gettime(CLOCK_MONOTONIC, &t);
  return (int64_t)t.tv_sec * 1000 + t.tv_nsec / 1000000;
}

static void send_report(stic_emulator *e, int64_t t_ms)
{
  uint8_t report[REPORT_MAX] = {0};
  int interface = 0;
  const size_t length = e->device->report(e, t_ms, &interface, report);

  if (length == 0)
    return;
  e->step++;
  stic_port_send(e, interface, report, length);
}

/* Makes the gesture: as often as ordered, or until the driver says farewell. False if no driver came, or none left. */
static bool perform(stic_emulator *e, bool until_farewell)
{
  const int64_t plugged_ms = stic_emulator_now_ms();
  int64_t begun_ms = 0;

  for (int64_t next_ms = plugged_ms;; next_ms += e->device->period_ms) {
    stic_port_serve(e, next_ms);
    if (!e->at_work)
      begun_ms = next_ms;
    else if (until_farewell ? e->farewell : next_ms - begun_ms >= e->gestures * CYCLE_MS)
      return true;
    if (next_ms - plugged_ms > PATIENCE_MS)
      return false;
    send_report(e, (next_ms - begun_ms) % CYCLE_MS);
  }
}

/* ---- program ----------------------------------------------------------------------------- */

/* As just plugged in. */
static void start(stic_emulator *e)
{
  e->open_count = e->echoes = e->idle = 0;
  e->at_work = e->farewell = e->told_grip = false;
  e->step = 0;
}

static bool live(stic_emulator *e)
{
  for (int round = 0; round < 2; round++) {
    const bool last = round == 1;

    start(e);
    if (!stic_port_plug_in(e))
      return false;
    if (!perform(e, last)) {
      fprintf(stderr, "%s: in round %d no driver %s\n", e->device->name, round + 1,
              e->at_work ? "left" : "came");
      return false;
    }
    if (!stic_port_pull_out(e))
      return false;
    if (!last)
      stic_port_serve(e, stic_emulator_now_ms() + AWAY_MS);
  }
  return true;
}

static const stic_emulated_device *find_device(const char *name)
{
  for (size_t i = 0; i < DEVICE_COUNT; i++) {
    if (strcmp(devices[i].name, name) == 0)
      return &devices[i];
  }
  return NULL;
}

static int usage(const char *program)
{
  fprintf(stderr, "usage: %s NAME [GESTURES before it is pulled out], NAME one of:", program);
  for (size_t i = 0; i < DEVICE_COUNT; i++)
    fprintf(stderr, " %s", devices[i].name);
  fputc('\n', stderr);
  return 2;
}

int main(int argc, char **argv)
{
  stic_emulator e;

  memset(&e, 0, sizeof e);
  e.device = argc == 2 || argc == 3 ? find_device(argv[1]) : NULL;
  e.gestures = argc == 3 ? atoi(argv[2]) : 1;
  if (!e.device)
    return usage(argv[0]);
  if (!stic_port_open(&e))
    return STIC_EMULATOR_SKIPPED;
  return live(&e) ? 0 : 1;
}

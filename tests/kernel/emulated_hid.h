/* Emulated HID devices: what they are, how they answer, and the gesture that they make. How they get into a kernel is
 * up to a port: /dev/uhid, or a USB gadget. One program has one port. */
#ifndef STIC_EMULATED_HID_H
#define STIC_EMULATED_HID_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define STIC_INTERFACES_MAX 2
#define STIC_EMULATOR_SKIPPED 77 /* exit code: this kernel has no such port */

typedef struct stic_emulator stic_emulator;

typedef struct stic_emulated_device {
  const char *name;    /* on the command line */
  const char *product; /* what it calls itself */
  const char *serial;
  uint16_t bus, vendor, product_id;
  int interface_count;
  const uint8_t *descriptors[STIC_INTERFACES_MAX];
  size_t descriptor_lengths[STIC_INTERFACES_MAX];
  int period_ms; /* of its reports */

  /* Makes the report that is due at `t_ms` of the gesture, before a driver is at work at 0; 0: none. */
  size_t (*report)(stic_emulator *e, int64_t t_ms, int *interface, uint8_t *out);
  void (*output)(stic_emulator *e, const uint8_t *data, size_t length);
  void (*set_feature)(stic_emulator *e, const uint8_t *data, size_t length);
  /* Fills the answer, ID first: its length; 0: refused. */
  size_t (*get_feature)(stic_emulator *e, uint8_t id, uint8_t *out);
} stic_emulated_device;

struct stic_emulator {
  const stic_emulated_device *device;
  int files[STIC_INTERFACES_MAX];
  int gestures;   /* before it is pulled out */
  int open_count; /* by drivers, of all interfaces */
  bool at_work;   /* a driver has set the device up: the gesture begins */
  bool farewell;  /* ... and has left it as it was */
  unsigned step;  /* reports made since it was plugged in */
  bool told_grip; /* what the last key report said */
  int echoes;     /* reports of rest still to send */
  int idle;       /* reports since the last driver closed it */
  uint8_t sequence;
};

/* Now, CLOCK_MONOTONIC, in ms. */
int64_t stic_emulator_now_ms(void);

/* ---- the port ---------------------------------------------------------------------------- */

/* Makes ready to plug the device in. False with a word on standard error if it cannot be, here. */
bool stic_port_open(stic_emulator *e);
bool stic_port_plug_in(stic_emulator *e);
bool stic_port_pull_out(stic_emulator *e);
/* Hands what drivers send to the device until that time. */
void stic_port_serve(stic_emulator *e, int64_t until_ms);
void stic_port_send(stic_emulator *e, int interface, const uint8_t *report, size_t length);

#endif

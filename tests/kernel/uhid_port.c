/* The port through /dev/uhid: any device, but on no USB bus. */
#include "emulated_hid.h"

#include <linux/uhid.h>

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static bool give(int file, const struct uhid_event *event)
{
  if (write(file, event, sizeof *event) == (ssize_t)sizeof *event)
    return true;
  fprintf(stderr, "uhid: event %u: %s\n", (unsigned)event->type, strerror(errno));
  return false;
}

bool stic_port_plug_in(stic_emulator *e)
{
  const stic_emulated_device *d = e->device;

  for (int i = 0; i < d->interface_count; i++) {
    struct uhid_event event;

    memset(&event, 0, sizeof event);
    event.type = UHID_CREATE2;
    snprintf((char *)event.u.create2.name, sizeof event.u.create2.name, "%s", d->product);
    snprintf((char *)event.u.create2.phys, sizeof event.u.create2.phys, "emulated/input%d", i);
    snprintf((char *)event.u.create2.uniq, sizeof event.u.create2.uniq, "%s", d->serial);
    memcpy(event.u.create2.rd_data, d->descriptors[i], d->descriptor_lengths[i]);
    event.u.create2.rd_size = (uint16_t)d->descriptor_lengths[i];
    event.u.create2.bus = d->bus;
    event.u.create2.vendor = d->vendor;
    event.u.create2.product = d->product_id;
    if (!give(e->files[i], &event))
      return false;
  }
  return true;
}

bool stic_port_pull_out(stic_emulator *e)
{
  const struct uhid_event event = {.type = UHID_DESTROY};
  bool good = true;

  for (int i = 0; i < e->device->interface_count; i++)
    good = give(e->files[i], &event) && good;
  return good;
}

static void answer_set(stic_emulator *e, int file, const struct uhid_event *asked)
{
  struct uhid_event answer;

  if (e->device->set_feature)
    e->device->set_feature(e, asked->u.set_report.data, asked->u.set_report.size);
  memset(&answer, 0, sizeof answer);
  answer.type = UHID_SET_REPORT_REPLY;
  answer.u.set_report_reply.id = asked->u.set_report.id;
  answer.u.set_report_reply.err = e->device->set_feature ? 0 : EIO;
  give(file, &answer);
}

static void answer_get(stic_emulator *e, int file, const struct uhid_event *asked)
{
  struct uhid_event answer;
  size_t length = 0;

  memset(&answer, 0, sizeof answer);
  if (e->device->get_feature)
    length = e->device->get_feature(e, asked->u.get_report.rnum, answer.u.get_report_reply.data);
  answer.type = UHID_GET_REPORT_REPLY;
  answer.u.get_report_reply.id = asked->u.get_report.id;
  answer.u.get_report_reply.size = (uint16_t)length;
  answer.u.get_report_reply.err = length > 0 ? 0 : EIO;
  give(file, &answer);
}

static void take_event(stic_emulator *e, int file)
{
  struct uhid_event event;

  if (read(file, &event, sizeof event) <= 0)
    return;
  switch (event.type) {
  case UHID_OPEN: e->open_count++; break;
  case UHID_CLOSE: e->open_count--; break;
  case UHID_OUTPUT:
    if (e->device->output)
      e->device->output(e, event.u.output.data, event.u.output.size);
    break;
  case UHID_SET_REPORT: answer_set(e, file, &event); break;
  case UHID_GET_REPORT: answer_get(e, file, &event); break;
  default: break;
  }
}

void stic_port_serve(stic_emulator *e, int64_t until_ms)
{
  for (;;) {
    struct pollfd polled[STIC_INTERFACES_MAX];
    const int64_t left_ms = until_ms - stic_emulator_now_ms();

    for (int i = 0; i < e->device->interface_count; i++)
      polled[i] = (struct pollfd){e->files[i], POLLIN, 0};
    if (poll(polled, (nfds_t)e->device->interface_count, left_ms > 0 ? (int)left_ms : 0) == 0)
      return;
    for (int i = 0; i < e->device->interface_count; i++) {
      if (polled[i].revents & POLLIN)
        take_event(e, e->files[i]);
    }
  }
}

void stic_port_send(stic_emulator *e, int interface, const uint8_t *report, size_t length)
{
  struct uhid_event event;

  memset(&event, 0, sizeof event);
  event.type = UHID_INPUT2;
  event.u.input2.size = (uint16_t)length;
  memcpy(event.u.input2.data, report, length);
  give(e->files[interface], &event);
}

bool stic_port_open(stic_emulator *e)
{
  for (int i = 0; i < e->device->interface_count; i++) {
    e->files[i] = open("/dev/uhid", O_RDWR | O_CLOEXEC);
    if (e->files[i] < 0) {
      perror("/dev/uhid");
      return false;
    }
  }
  return true;
}

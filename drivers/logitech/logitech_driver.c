#include "logitech_driver.h"

#include "../../src/error.h"
#include "../../src/io/timing.h"
#include "../raw_recording.h"
#include "../serial/tty.h"
#include "logitech_protocol.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PATH_ROOM 256
#define INPUT_ROOM 4096 /* bytes read at once: 5 s of records */

typedef struct logitech_device {
  stic_device base;
  stic_tty tty;
  stic_logitech_protocol protocol;
  stic_raw_writer *raw; /* NULL: none asked for */
  char path[PATH_ROOM];
  int64_t arrival_ns; /* of the last byte in `input` */
  size_t taken, filled;
  uint8_t input[INPUT_ROOM];
} logitech_device;

/* A serial port does not say what is behind it. */
static bool logitech_match(const stic_device_id *id)
{
  return strcmp(id->bus, "serial") == 0;
}

static bool port_write(void *context, const uint8_t *bytes, size_t length)
{
  return stic_tty_write(context, bytes, length);
}

static bool port_set_line(void *context, bool rts, bool on)
{
  return stic_tty_set_line(context, rts ? STIC_TTY_RTS : STIC_TTY_DTR, on);
}

static void logitech_close(stic_device *device)
{
  logitech_device *d = (logitech_device *)device;

  stic_raw_finish(d->raw, NULL);
  stic_logitech_end(&d->protocol);
  stic_tty_close(&d->tty);
  free(d);
}

static stic_status logitech_open(const stic_device_spec *spec, stic_device **device, stic_error *err)
{
  const char *path = stic_spec_text(spec, "port", NULL), *raw = stic_spec_text(spec, "raw", NULL);
  stic_logitech_port port = {NULL, port_write, port_set_line};
  logitech_device *d;
  stic_status status;

  if (!path || strlen(path) >= PATH_ROOM)
    return stic_error_set(err, STIC_USAGE, NULL, 0,
                          "device logitech: expected logitech:port=PORT, e.g. /dev/ttyS0");
  d = calloc(1, sizeof *d);
  if (!d)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  strcpy(d->path, path);
  d->base.driver = &stic_logitech_driver;
  status = stic_tty_open(&d->tty, path, B19200, err);
  if (status != STIC_OK) {
    free(d);
    return status;
  }
  port.context = &d->tty;
  stic_logitech_begin(&d->protocol, &port, stic_spec_flag(spec, "head"), stic_clock_ns());
  d->base.state = d->protocol.state;
  if (raw)
    status = stic_raw_create(raw, STIC_RAW_SERIAL, NULL, spec->again, &d->raw, err);
  if (status != STIC_OK) {
    logitech_close(&d->base);
    return status;
  }
  *device = &d->base;
  return STIC_OK;
}

static int lose(logitech_device *d, int result, const stic_error *why)
{
  /* The unit holds CTS while it has power. */
  const char *hint = stic_tty_cts(&d->tty) == 0 ? "; CTS is low: is the unit switched on?" : "";

  d->base.state = STIC_CONNECTION_LOST;
  d->protocol.state = STIC_CONNECTION_LOST;
  stic_error_set(&d->base.error, why->status, d->path, 0, "%s%s", why->message, hint);
  return result;
}

/* Samples of what has been read; 0 once all of it is taken. */
static int give_samples(logitech_device *d, stic_device_sample *samples, int capacity)
{
  int count = 0;

  while (count < capacity) {
    size_t used;
    const bool given = stic_logitech_receive(&d->protocol, d->input + d->taken, d->filled - d->taken,
                                             d->arrival_ns, &used, &samples[count]);

    d->taken += used;
    if (!given)
      break;
    count++;
  }
  d->base.state = d->protocol.state;
  d->base.counters.bad_records = stic_logitech_stream_bad(&d->protocol.stream);
  return count;
}

/* A recording that fails is ended; the tracker goes on. */
static void record(logitech_device *d)
{
  if (!d->raw || d->protocol.step != STIC_LOGITECH_STEP_STREAM)
    return;
  if (stic_raw_write(d->raw, 0, d->arrival_ns, d->input, d->filled, &d->base.error) != STIC_OK) {
    stic_raw_finish(d->raw, NULL);
    d->raw = NULL;
  }
}

/* Reads what is there; false if the port is gone. */
static bool read_input(logitech_device *d)
{
  const int n = stic_tty_read(&d->tty, d->input, sizeof d->input);

  d->taken = 0;
  d->filled = n > 0 ? (size_t)n : 0;
  if (n > 0) {
    d->arrival_ns = stic_clock_ns();
    stic_device_show_raw(&d->base, d->input, d->filled);
    record(d);
  }
  return n >= 0;
}

static int unplugged(logitech_device *d)
{
  stic_error err;

  stic_error_set(&err, STIC_NO_DEVICE, NULL, 0, "the serial port is gone: unplugged?");
  return lose(d, STIC_DRIVER_LOST, &err);
}

static int64_t earlier(int64_t a, int64_t b)
{
  return a < b ? a : b;
}

static int logitech_poll(stic_device *device, int64_t until_ns, stic_device_sample *samples, int capacity)
{
  logitech_device *d = (logitech_device *)device;
  int count = 0;

  for (;;) {
    int result;

    count += give_samples(d, samples + count, capacity - count);
    if (count == capacity)
      return count;
    if (!read_input(d))
      return count > 0 ? count : unplugged(d); /* told by the next call */
    if (d->filled > 0)
      continue;
    if (count > 0)
      return count;
    result = stic_logitech_advance(&d->protocol, stic_clock_ns());
    if (result != 0)
      return lose(d, result, &d->protocol.error);
    if (stic_clock_ns() >= until_ns ||
        !stic_tty_wait(&d->tty, earlier(until_ns, stic_logitech_deadline(&d->protocol))))
      return 0;
  }
}

static void logitech_describe(const stic_device *device, char *out, size_t out_size)
{
  const logitech_device *d = (const logitech_device *)device;
  const stic_logitech_protocol *p = &d->protocol;
  char firmware[32] = "";

  if (p->firmware >= 0)
    snprintf(firmware, sizeof firmware, ", firmware %d", p->firmware);
  snprintf(out, out_size, "Logitech ultrasonic tracker at %s%s%s%s%s", d->path, p->head ? ", head mode" : "",
           firmware, p->notice[0] ? ", " : "", p->notice);
}

static const stic_spec_key keys[] = {
  {"port", false, "serial port, e.g. /dev/ttyS0"},
  {"head", true, "switch to head-tracker mode"},
  {"raw", false, "record the received bytes to a file, for reports of problems"},
  {NULL, false, NULL}};

const stic_driver stic_logitech_driver = {
  .name = "logitech",
  .about = "Logitech ultrasonic 3D mouse and head tracker, serial, 50 a second",
  .keys = keys,
  .kind = STIC_DRIVER_POSE,
  .silence = STIC_SILENCE_STALE,
  .silence_ns = STIC_LOGITECH_SILENCE_NS,
  .own_time = false,
  .match = logitech_match,
  .open = logitech_open,
  .poll = logitech_poll,
  .send = NULL,
  .close = logitech_close,
  .describe = logitech_describe,
};

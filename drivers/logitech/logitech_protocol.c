#include "logitech_protocol.h"

#include "../../src/error.h"

#include <stdio.h>
#include <string.h>

#define MS 1000000 /* ns */
#define ENQ "\005"
#define ATTEMPTS 2       /* of the whole start */
#define QUESTIONS 2      /* of the diagnostics, within one attempt */
#define RECORD_SIZE_AT 4 /* in the *m reply */
/* Without these two the unit works, only out of range: cables may be plugged in later. */
#define PARTS_NOT_NEEDED (1u << STIC_LOGITECH_PART_TRANSMITTER | 1u << STIC_LOGITECH_PART_RECEIVER)
#define PARTS_ALL ((1u << STIC_LOGITECH_PARTS) - 1)

static const int64_t step_ns[] = {
  [STIC_LOGITECH_STEP_SELECT] = 200 * MS,  [STIC_LOGITECH_STEP_HOLD] = 200 * MS,
  [STIC_LOGITECH_STEP_LET_GO] = 20 * MS,   [STIC_LOGITECH_STEP_RESET] = 1200 * MS,
  [STIC_LOGITECH_STEP_DEMAND] = 300 * MS,  [STIC_LOGITECH_STEP_DIAGNOSE] = 1000 * MS,
  [STIC_LOGITECH_STEP_FORMAT] = 20 * MS,   [STIC_LOGITECH_STEP_INFORM] = 500 * MS,
  [STIC_LOGITECH_STEP_STREAM] = 1000 * MS, /* for the first record */
};

static void enter(stic_logitech_protocol *p, stic_logitech_step step, int64_t now_ns);

/* ---- what goes wrong --------------------------------------------------------------------- */

static int fail(stic_logitech_protocol *p, int result)
{
  p->state = STIC_CONNECTION_LOST;
  return result;
}

static int port_is_gone(stic_logitech_protocol *p)
{
  stic_error_set(&p->error, STIC_NO_DEVICE, NULL, 0, "the serial port takes no commands any more");
  return fail(p, STIC_DRIVER_LOST);
}

/* Starts anew, or gives up with the error already set. */
static int retry(stic_logitech_protocol *p, int64_t now_ns)
{
  if (++p->attempt >= ATTEMPTS)
    return fail(p, STIC_DRIVER_LOST);
  enter(p, STIC_LOGITECH_STEP_SELECT, now_ns);
  return 0;
}

/* ---- sending ----------------------------------------------------------------------------- */

static bool command(stic_logitech_protocol *p, const char *text)
{
  return p->port.write(p->port.context, (const uint8_t *)text, strlen(text));
}

/* Does what a step begins with; false if the port is gone. */
static bool begin_step(stic_logitech_protocol *p, int64_t now_ns)
{
  const stic_logitech_port *port = &p->port;

  switch (p->step) {
  case STIC_LOGITECH_STEP_SELECT:
    /* An open() raised DTR, which selects the two-dimensional mode at the next reset. */
    if (!port->set_line(port->context, false, false))
      enter(p, STIC_LOGITECH_STEP_RESET, now_ns);
    return true;
  case STIC_LOGITECH_STEP_HOLD: port->set_line(port->context, true, false); return true;
  case STIC_LOGITECH_STEP_LET_GO: port->set_line(port->context, true, true); return true;
  case STIC_LOGITECH_STEP_RESET: return command(p, "*R");
  case STIC_LOGITECH_STEP_DEMAND: return command(p, "*D");
  case STIC_LOGITECH_STEP_DIAGNOSE: return command(p, "*" ENQ);
  case STIC_LOGITECH_STEP_FORMAT: return command(p, p->head ? "*H*G" : "*G");
  case STIC_LOGITECH_STEP_INFORM:
    /* After the format is set: its record size is what we ask for. */
    return command(p, "*m");
  case STIC_LOGITECH_STEP_STREAM:
    p->state = STIC_CONNECTION_SYNCING;
    stic_logitech_stream_restart(&p->stream);
    return command(p, "*S");
  }
  return true;
}

/* The time of the step begins before its command: one step may go straight on to another. */
static void enter(stic_logitech_protocol *p, stic_logitech_step step, int64_t now_ns)
{
  p->state = STIC_CONNECTION_RESETTING;
  p->asked = p->asked * (p->step == step) + 1;
  p->step = step;
  p->step_end_ns = now_ns + step_ns[step];
  p->reply_count = 0;
  if (!begin_step(p, now_ns))
    port_is_gone(p);
}

void stic_logitech_begin(stic_logitech_protocol *p, const stic_logitech_port *port, bool head, int64_t now_ns)
{
  memset(p, 0, sizeof *p);
  p->port = *port;
  p->head = head;
  p->firmware = -1;
  enter(p, STIC_LOGITECH_STEP_SELECT, now_ns);
}

void stic_logitech_end(stic_logitech_protocol *p)
{
  if (p->state != STIC_CONNECTION_LOST && command(p, "*D"))
    command(p, "*O");
  p->state = STIC_CONNECTION_CLOSED;
}

/* ---- receiving --------------------------------------------------------------------------- */

/* The diagnostics reply begins with bits 10, what is before it is left over from a stream. The *m reply
 * begins so too and then uses all eight bits: the rule of bit 7 does not hold inside. */
static int reply_length(const stic_logitech_protocol *p)
{
  switch (p->step) {
  case STIC_LOGITECH_STEP_DIAGNOSE: return 2;
  case STIC_LOGITECH_STEP_INFORM: return STIC_LOGITECH_INFORMATION;
  default: return 0;
  }
}

/* Collects an answer; what comes while none is expected is dropped. */
static void take_reply(stic_logitech_protocol *p, const uint8_t *bytes, size_t length)
{
  const int wanted = reply_length(p);

  for (size_t i = 0; i < length && p->reply_count < wanted; i++) {
    if (p->reply_count > 0 || (bytes[i] & 0xc0) == 0x80)
      p->reply[p->reply_count++] = bytes[i];
  }
}

bool stic_logitech_receive(stic_logitech_protocol *p, const uint8_t *bytes, size_t length, int64_t arrival_ns,
                           size_t *used, stic_device_sample *sample)
{
  if (p->step != STIC_LOGITECH_STEP_STREAM) {
    *used = length;
    take_reply(p, bytes, length);
    return false;
  }
  if (!stic_logitech_stream_next(&p->stream, bytes, length, arrival_ns, used, sample))
    return false;
  p->state = STIC_CONNECTION_RUNNING;
  p->attempt = 0;
  return true;
}

/* ---- answers ----------------------------------------------------------------------------- */

static void name_parts(unsigned failed, char *out, size_t out_size)
{
  size_t used = 0;

  out[0] = '\0';
  for (int part = 0; part < STIC_LOGITECH_PARTS && used < out_size; part++) {
    if (failed & 1u << part) {
      const int n =
        snprintf(out + used, out_size - used, "%s%s", used > 0 ? ", " : "", stic_logitech_part_name(part));

      used += n > 0 ? (size_t)n : 0;
    }
  }
}

static int take_diagnostics(stic_logitech_protocol *p, int64_t now_ns)
{
  unsigned passed, failed;
  char names[120];

  if (!stic_logitech_unpack_diagnostics(p->reply, &passed)) {
    stic_error_set(&p->error, STIC_NO_DEVICE, NULL, 0,
                   "the diagnostics reply is garbled (%02x %02x); expected bf 3f", p->reply[0], p->reply[1]);
    if (p->asked < QUESTIONS)
      enter(p, STIC_LOGITECH_STEP_DIAGNOSE, now_ns);
    else
      return retry(p, now_ns);
    return 0;
  }
  failed = ~passed & PARTS_ALL;
  name_parts(failed, names, sizeof names);
  if (failed & ~PARTS_NOT_NEEDED) {
    stic_error_set(&p->error, STIC_NO_DEVICE, NULL, 0, "parts of the unit fail their test: %s", names);
    return retry(p, now_ns);
  }
  p->notice[0] = '\0';
  if (failed)
    snprintf(p->notice, sizeof p->notice, "fails its test: %s; plugged in?", names);
  enter(p, STIC_LOGITECH_STEP_FORMAT, now_ns);
  return 0;
}

static int take_information(stic_logitech_protocol *p, int64_t now_ns)
{
  const int size = p->reply[RECORD_SIZE_AT];

  p->firmware = p->reply[0] & 0x3f;
  if (size == STIC_LOGITECH_RECORD) {
    enter(p, STIC_LOGITECH_STEP_STREAM, now_ns);
    return 0;
  }
  /* Refused only if it says so twice: one garbled byte must not end the session. */
  if (p->refused_size != size) {
    p->refused_size = size;
    enter(p, STIC_LOGITECH_STEP_INFORM, now_ns);
    return 0;
  }
  stic_error_set(&p->error, STIC_NO_DEVICE, NULL, 0,
                 "the unit sends records of %d bytes; expected %d (Euler)", size, STIC_LOGITECH_RECORD);
  return fail(p, STIC_DRIVER_BAD_DATA);
}

static int take_answer(stic_logitech_protocol *p, int64_t now_ns)
{
  return p->step == STIC_LOGITECH_STEP_DIAGNOSE ? take_diagnostics(p, now_ns) : take_information(p, now_ns);
}

static int step_is_over(stic_logitech_protocol *p, int64_t now_ns)
{
  switch (p->step) {
  case STIC_LOGITECH_STEP_DIAGNOSE:
    stic_error_set(&p->error, STIC_NO_DEVICE, NULL, 0,
                   "no answer to the diagnostics; is the unit on and in its 3D mode?");
    return retry(p, now_ns);
  case STIC_LOGITECH_STEP_INFORM:
    /* Not all units that are known answer this; the stream decides. */
    if (!p->notice[0])
      snprintf(p->notice, sizeof p->notice, "tells no operating information");
    enter(p, STIC_LOGITECH_STEP_STREAM, now_ns);
    return 0;
  case STIC_LOGITECH_STEP_STREAM:
    stic_error_set(&p->error, STIC_NO_DEVICE, NULL, 0, "the unit answers but sends no records");
    return retry(p, now_ns);
  default: enter(p, (stic_logitech_step)(p->step + 1), now_ns); return 0;
  }
}

int stic_logitech_advance(stic_logitech_protocol *p, int64_t now_ns)
{
  const int wanted = reply_length(p);
  int result = 0;

  /* A stream that runs has no deadline here: what silence means is the same for all drivers. */
  if (p->state == STIC_CONNECTION_RUNNING)
    return 0;
  if (p->state == STIC_CONNECTION_LOST)
    return STIC_DRIVER_LOST;
  if (wanted > 0 && p->reply_count == wanted)
    result = take_answer(p, now_ns);
  else if (now_ns >= p->step_end_ns)
    result = step_is_over(p, now_ns);
  return result == 0 && p->state == STIC_CONNECTION_LOST ? STIC_DRIVER_LOST : result;
}

int64_t stic_logitech_deadline(const stic_logitech_protocol *p)
{
  return p->state == STIC_CONNECTION_RUNNING ? INT64_MAX : p->step_end_ns;
}

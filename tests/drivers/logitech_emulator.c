#define _XOPEN_SOURCE 700 /* posix_openpt() */
#include "logitech_emulator.h"

#include "../../src/angle.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#define RESET_NS 1000000000
#define ENQ 5
#define INFORMATION 30
#define BIT_OUT 0x20u
#define BIT_FRINGE 0x40u
#define BIT_LEFT 0x04u
#define BIT_RIGHT 0x01u

void emulator_pack(const emulator_record *record, uint8_t bytes[EMULATOR_RECORD])
{
  const int angles[3] = {record->pitch, record->yaw, record->roll};
  size_t at = 0;

  bytes[at++] = (uint8_t)(0x80 | record->bits);
  for (int i = 0; i < 3; i++) {
    for (int shift = 14; shift >= 0; shift -= 7)
      bytes[at++] = (uint8_t)((uint32_t)record->position[i] >> shift & 0x7f);
  }
  for (int i = 0; i < 3; i++) {
    bytes[at++] = (uint8_t)(angles[i] >> 7 & 0x7f);
    bytes[at++] = (uint8_t)(angles[i] & 0x7f);
  }
}

static void circle(void *context, int64_t t_ns, emulator_record *record)
{
  const double angle = 2 * STIC_PI * ((double)t_ns / 1e9) / 4, radius = 0.1 / 25.4e-6;

  (void)context;
  memset(record, 0, sizeof *record);
  record->position[0] = (int32_t)(radius * cos(angle));
  record->position[1] = (int32_t)(radius * sin(angle));
  record->roll = (int)(7200 * (1 - cos(angle)) / 8) % 14400;
  record->bits = t_ns / 1000000000 % 2 ? BIT_LEFT : 0;
}

void emulator_init(emulator *e)
{
  memset(e, 0, sizeof *e);
  e->motion = circle;
  e->faults.drop_at = e->faults.insert_at = e->faults.flip_at = e->faults.stall_at = EMULATOR_NEVER;
  e->faults.diagnostics[0] = 0xbf;
  e->faults.diagnostics[1] = 0x3f;
  e->faults.record_size = EMULATOR_RECORD;
}

/* ---- sending ----------------------------------------------------------------------------- */

static void put(emulator *e, uint8_t byte, int64_t due_ns)
{
  if (e->queued < EMULATOR_QUEUE) {
    e->queue[e->queued] = byte;
    e->due_ns[e->queued++] = due_ns;
  }
}

static void reply(emulator *e, const uint8_t *bytes, size_t length, int64_t now_ns)
{
  for (size_t i = 0; i < length; i++)
    put(e, bytes[i], now_ns + (int64_t)(i + 1) * EMULATOR_BYTE_NS);
}

/* One byte of the stream, as it comes through a bad line. */
static void put_stream(emulator *e, uint8_t byte, int64_t *due_ns)
{
  const emulator_faults *f = &e->faults;
  const int64_t at = e->bytes++;

  if (at == f->insert_at) {
    *due_ns += EMULATOR_BYTE_NS;
    put(e, f->insert, *due_ns);
  }
  *due_ns += EMULATOR_BYTE_NS;
  if (at != f->drop_at)
    put(e, at == f->flip_at ? byte ^ f->flip : byte, *due_ns);
}

static unsigned glitched(emulator *e, unsigned bits)
{
  const bool pressed = (bits & BIT_LEFT) != 0;

  if (pressed && !e->was_pressed)
    e->pressed_at = e->records;
  e->was_pressed = pressed;
  if (pressed && e->records - e->pressed_at < e->faults.glitch)
    bits = (bits & ~BIT_LEFT) | BIT_RIGHT;
  return bits;
}

static void put_record(emulator *e)
{
  uint8_t bytes[EMULATOR_RECORD];
  emulator_record record;
  int64_t due_ns = e->record_ns;

  e->motion(e->context, e->record_ns - e->stream_start_ns, &record);
  record.bits = glitched(e, record.bits);
  if (e->faults.never && !e->seen)
    memset(&record, 0, sizeof record);
  e->seen = e->seen || !(e->faults.out || e->faults.never);
  if (e->faults.out || e->faults.never)
    record.bits |= BIT_OUT;
  if (e->faults.fringe)
    record.bits |= BIT_FRINGE;
  emulator_pack(&record, bytes);
  for (int i = 0; i < EMULATOR_RECORD; i++)
    put_stream(e, bytes[i], &due_ns);
  e->records++;
  e->record_ns += EMULATOR_PERIOD_NS;
  if (e->records == e->faults.stall_at)
    e->record_ns += e->faults.stall_ns;
}

size_t emulator_send(emulator *e, int64_t now_ns, uint8_t *bytes, size_t size)
{
  size_t n = 0;

  if (e->streaming && e->record_ns <= now_ns && e->queued + 2 * EMULATOR_RECORD <= EMULATOR_QUEUE)
    put_record(e);
  while (n < size && n < e->queued && e->due_ns[n] <= now_ns) {
    bytes[n] = e->queue[n];
    n++;
  }
  e->queued -= n;
  memmove(e->queue, e->queue + n, e->queued);
  memmove(e->due_ns, e->due_ns + n, e->queued * sizeof e->due_ns[0]);
  return n;
}

int64_t emulator_next_ns(const emulator *e)
{
  const int64_t byte_ns = e->queued > 0 ? e->due_ns[0] : EMULATOR_NEVER;
  const int64_t record_ns = e->streaming ? e->record_ns : EMULATOR_NEVER;

  return byte_ns < record_ns ? byte_ns : record_ns;
}

/* ---- commands ---------------------------------------------------------------------------- */

static void inform(emulator *e, int64_t now_ns)
{
  uint8_t bytes[INFORMATION] = {0};

  /* Distances are whole bytes, some with bit 7. */
  for (int i = 10; i < INFORMATION; i++)
    bytes[i] = (uint8_t)(0x9c + 7 * i);
  bytes[0] = 0x80 | 12;
  bytes[1] = 3;
  bytes[4] = (uint8_t)e->faults.record_size;
  bytes[6] = 2;
  bytes[8] = bytes[9] = 14;
  if (!e->faults.no_information)
    reply(e, bytes, sizeof bytes, now_ns);
}

static void command(emulator *e, uint8_t letter, int64_t now_ns)
{
  if (e->streaming && letter != 'D' && letter != 'R') {
    e->refused++;
    return;
  }
  switch (letter) {
  case 'R':
    e->streaming = e->seen = false;
    e->queued = 0;
    e->resets++;
    e->deaf_until_ns = now_ns + RESET_NS;
    break;
  case 'D': e->streaming = false; break;
  case 'S':
    e->streaming = true;
    e->stream_start_ns = e->record_ns = now_ns + EMULATOR_PERIOD_NS;
    break;
  case ENQ: reply(e, e->faults.diagnostics, sizeof e->faults.diagnostics, now_ns); break;
  case 'm': inform(e, now_ns); break;
  case 'A':
  case 'O': e->sound_off = letter == 'O'; break;
  default: break;
  }
}

void emulator_receive(emulator *e, const uint8_t *bytes, size_t length, int64_t now_ns)
{
  for (size_t i = 0; i < length; i++) {
    if (e->faults.silent || e->wrong_format || now_ns < e->deaf_until_ns)
      continue;
    if (e->in_command)
      command(e, bytes[i], now_ns);
    e->in_command = !e->in_command && bytes[i] == '*';
  }
}

/* ---- behind a pseudo terminal ------------------------------------------------------------ */

static int64_t clock_ns(void)
{
  struct timespec now;

  clock_gettime(CLOCK_MONOTONIC, &now);
  return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

/* A pseudo terminal begins with echo and lines; what a serial port sends has neither. */
static bool set_raw(int fd)
{
  struct termios t;

  if (tcgetattr(fd, &t) != 0)
    return false;
  t.c_iflag = t.c_oflag = t.c_lflag = 0;
  t.c_cflag = CS8 | CREAD | CLOCAL;
  return cfsetispeed(&t, B1200) == 0 && cfsetospeed(&t, B1200) == 0 && tcsetattr(fd, TCSANOW, &t) == 0;
}

/* What the driver has set up, seen from this side. */
static bool format_is_right(int master)
{
  struct termios t;

  return tcgetattr(master, &t) == 0 && cfgetospeed(&t) == B19200 && (t.c_cflag & CSIZE) == CS8 &&
         !(t.c_cflag & (PARENB | CSTOPB)) && !(t.c_lflag & (ICANON | ECHO | ISIG)) &&
         !(t.c_iflag & (IXON | IXOFF | ICRNL)) && !(t.c_oflag & OPOST);
}

bool logitech_pty_open(logitech_pty *pty, emulator *unit)
{
  const char *name;

  pty->unit = unit;
  pty->slave = -1;
  pty->master = posix_openpt(O_RDWR | O_NOCTTY);
  if (pty->master < 0)
    return false;
  fcntl(pty->master, F_SETFD, FD_CLOEXEC);
  fcntl(pty->master, F_SETFL, O_NONBLOCK);
  if (grantpt(pty->master) == 0 && unlockpt(pty->master) == 0 && (name = ptsname(pty->master)) != NULL) {
    snprintf(pty->path, sizeof pty->path, "%s", name);
    /* Held open: without any reader the master would give EIO. */
    pty->slave = open(pty->path, O_RDWR | O_NOCTTY | O_CLOEXEC);
  }
  if (pty->slave >= 0 && set_raw(pty->slave))
    return true;
  logitech_pty_close(pty);
  return false;
}

static bool take_commands(logitech_pty *pty)
{
  uint8_t bytes[64];
  const ssize_t n = read(pty->master, bytes, sizeof bytes);

  if (n < 0)
    return errno == EAGAIN || errno == EINTR;
  /* A driver that closes may have put the settings back before its last commands are read here. */
  if (!pty->unit->streaming)
    pty->unit->wrong_format = !format_is_right(pty->master);
  emulator_receive(pty->unit, bytes, (size_t)n, clock_ns());
  return true;
}

static bool give_bytes(logitech_pty *pty)
{
  uint8_t bytes[64];
  size_t n;

  while ((n = emulator_send(pty->unit, clock_ns(), bytes, pty->unit->faults.split ? 1 : sizeof bytes)) > 0) {
    /* What nobody reads is lost, as on a wire. */
    if (write(pty->master, bytes, n) < 0 && errno != EAGAIN && errno != EINTR)
      return false;
  }
  return true;
}

bool logitech_pty_serve(logitech_pty *pty, int64_t limit_ns)
{
  const int64_t end_ns = clock_ns() + limit_ns;
  struct pollfd port = {pty->master, POLLIN, 0};

  while (clock_ns() < end_ns) {
    const int64_t next_ns = emulator_next_ns(pty->unit) < end_ns ? emulator_next_ns(pty->unit) : end_ns;
    const int64_t left_ms = (next_ns - clock_ns() + 999999) / 1000000;

    if (poll(&port, 1, left_ms > 0 ? (int)left_ms : 0) < 0 && errno != EINTR)
      return false;
    if (!take_commands(pty) || !give_bytes(pty))
      return false;
  }
  return true;
}

void logitech_pty_close(logitech_pty *pty)
{
  if (pty->slave >= 0)
    close(pty->slave);
  if (pty->master >= 0)
    close(pty->master);
  pty->slave = pty->master = -1;
}

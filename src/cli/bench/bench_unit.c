#define _XOPEN_SOURCE 700 /* posix_openpt() */
#include "bench_unit.h"

#include "../../error.h"
#include "../../io/timing.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

#define RECORD 16
#define METRES 25.4e-6 /* of a count */
#define CIRCLE 2000.0  /* counts, of the hand's way */
#define LOOK_MS 10     /* how soon a stop is seen */

struct stic_bench_unit {
  int master, slave;
  char port[64];
  double rate;
  int64_t count;
  int stopping;
  int64_t *sent; /* ns */
  bool started, in_command;
  pthread_t thread;
};

const char *stic_bench_unit_port(const stic_bench_unit *unit)
{
  return unit->port;
}

int64_t stic_bench_unit_index(double z)
{
  return llround(z / METRES);
}

int64_t stic_bench_unit_sent(const stic_bench_unit *unit, int64_t index)
{
  return index >= 0 && index < unit->count ? __atomic_load_n(&unit->sent[index], __ATOMIC_ACQUIRE) : 0;
}

static bool is_stopping(const stic_bench_unit *u)
{
  return __atomic_load_n(&u->stopping, __ATOMIC_ACQUIRE) != 0;
}

/* ---- what it sends ----------------------------------------------------------------------- */

/* All of it, whenever there is room. */
static void send(stic_bench_unit *u, const uint8_t *bytes, size_t length)
{
  struct pollfd room = {u->master, POLLOUT, 0};

  while (length > 0 && !is_stopping(u)) {
    const ssize_t n = write(u->master, bytes, length);

    if (n > 0) {
      bytes += n;
      length -= (size_t)n;
    } else if (n < 0 && errno != EAGAIN && errno != EINTR) {
      return;
    } else {
      poll(&room, 1, LOOK_MS);
    }
  }
}

/* A slow circle in x and y, the record's number in z. */
static void pack(int64_t index, uint8_t bytes[RECORD])
{
  const double angle = (double)index * 0.005;
  const int32_t position[3] = {(int32_t)(CIRCLE * cos(angle)), (int32_t)(CIRCLE * sin(angle)),
                               (int32_t)index};

  memset(bytes, 0, RECORD);
  bytes[0] = 0x80;
  for (int i = 0; i < 3; i++) {
    for (int k = 0; k < 3; k++)
      bytes[1 + 3 * i + k] = (uint8_t)((uint32_t)position[i] >> (14 - 7 * k) & 0x7f);
  }
}

/* Takes commands until the stream is asked for. Only the diagnostics need an answer. */
static bool wait_for_start(stic_bench_unit *u)
{
  static const uint8_t passed[2] = {0xbf, 0x3f};

  while (!is_stopping(u)) {
    struct pollfd port = {u->master, POLLIN, 0};
    uint8_t byte;

    if (poll(&port, 1, LOOK_MS) <= 0 || read(u->master, &byte, 1) != 1)
      continue;
    if (u->in_command && byte == 5)
      send(u, passed, sizeof passed);
    if (u->in_command && byte == 'S')
      return true;
    u->in_command = !u->in_command && byte == '*';
  }
  return false;
}

/* At high rates several at a time, since a sleep takes some 0.1 ms. */
static void *serve(void *context)
{
  stic_bench_unit *u = context;
  int64_t start_ns;

  if (!wait_for_start(u))
    return NULL;
  start_ns = stic_clock_ns();
  for (int64_t i = 0; i < u->count && !is_stopping(u); i++) {
    const int64_t due_ns = start_ns + (int64_t)((double)i / u->rate * 1e9);
    uint8_t bytes[RECORD];

    pack(i, bytes);
    while (stic_clock_ns() < due_ns && !is_stopping(u))
      stic_clock_sleep_until(due_ns);
    __atomic_store_n(&u->sent[i], stic_clock_ns(), __ATOMIC_RELEASE);
    send(u, bytes, sizeof bytes);
  }
  return NULL;
}

/* ---- the terminal ------------------------------------------------------------------------ */

static bool open_terminal(stic_bench_unit *u)
{
  struct termios t;
  const char *name;

  u->master = posix_openpt(O_RDWR | O_NOCTTY);
  if (u->master < 0 || grantpt(u->master) != 0 || unlockpt(u->master) != 0 || !(name = ptsname(u->master)))
    return false;
  fcntl(u->master, F_SETFL, O_NONBLOCK);
  snprintf(u->port, sizeof u->port, "%s", name);
  /* Held open: without any reader the master would give EIO. A pseudo terminal begins with echo and lines. */
  u->slave = open(u->port, O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (u->slave < 0 || tcgetattr(u->slave, &t) != 0)
    return false;
  t.c_iflag = t.c_oflag = t.c_lflag = 0;
  t.c_cflag = CS8 | CREAD | CLOCAL;
  return tcsetattr(u->slave, TCSANOW, &t) == 0;
}

stic_status stic_bench_unit_start(double rate, int64_t count, stic_bench_unit **unit, stic_error *err)
{
  stic_bench_unit *u = calloc(1, sizeof *u);

  *unit = NULL;
  if (u) {
    u->master = u->slave = -1;
    u->rate = rate;
    u->count = count;
    u->sent = calloc((size_t)count, sizeof u->sent[0]);
  }
  if (!u || !u->sent) {
    stic_bench_unit_stop(u);
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  }
  if (!open_terminal(u) || pthread_create(&u->thread, NULL, serve, u) != 0) {
    stic_error_set(err, STIC_FAILED, NULL, 0, "no pseudo terminal to measure with: %s", strerror(errno));
    stic_bench_unit_stop(u);
    return STIC_FAILED;
  }
  u->started = true;
  *unit = u;
  return STIC_OK;
}

void stic_bench_unit_stop(stic_bench_unit *u)
{
  if (!u)
    return;
  __atomic_store_n(&u->stopping, 1, __ATOMIC_RELEASE);
  if (u->started)
    pthread_join(u->thread, NULL);
  if (u->slave >= 0)
    close(u->slave);
  if (u->master >= 0)
    close(u->master);
  free(u->sent);
  free(u);
}

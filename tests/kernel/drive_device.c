/* Opens a device with its real driver and watches one emulated life of it: grip, push, letting go, loss, return,
 * and the same again.
 *
 *   drive-device SPEC             exit code 0 if all of it was seen
 *   drive-device --forbidden SPEC as an ordinary user: 0 if it is refused with advice
 */
#include "../../drivers/connection.h"
#include "../../src/io/timing.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SECOND INT64_C(1000000000)
#define PATIENCE (60 * SECOND)
#define NOBODY 65534
#define CAPACITY 64
#define FULL_SPEED 0.25 /* m/s: the rate drivers' default */
#define TRAVEL 0.15     /* m that a pose must move while gripped */
#define JUMP 0.5        /* m between two samples: a garbled one was used */

/* What one plugged-in time must show, in this order. */
typedef enum progress { NOTHING, GRIPPED, PUSHED, RELEASED } progress;

typedef struct watcher {
  const char *spec;
  stic_driver_kind kind;
  progress progress;
  double grip_x; /* where it was gripped, m */
  bool any;      /* `last` is a sample */
  stic_device_sample last;
  int losses, returns;
  bool bad;
} watcher;

static void complain(watcher *w, const char *what)
{
  fprintf(stderr, "%s: %s\n", w->spec, what);
  w->bad = true;
}

static bool pushed(const watcher *w, const stic_device_sample *sample)
{
  if (w->kind == STIC_DRIVER_RATE)
    return sample->flags & STIC_SAMPLE_VELOCITY && fabs(sample->velocity[0] - FULL_SPEED) < 1e-9;
  return sample->position[0] - w->grip_x >= TRAVEL;
}

static void judge(watcher *w, const stic_device_sample *sample)
{
  const bool grip = sample->buttons & STIC_BUTTON_GRIP;

  if (w->any && sample->t_ns <= w->last.t_ns)
    complain(w, "time does not increase");
  if (w->any && fabs(sample->position[0] - w->last.position[0]) > JUMP)
    complain(w, "the position jumps");
  if (w->progress == NOTHING && grip) {
    w->progress = GRIPPED;
    w->grip_x = sample->position[0];
  } else if (w->progress == GRIPPED && grip && pushed(w, sample)) {
    w->progress = PUSHED;
  } else if (w->progress == PUSHED && !grip) {
    w->progress = RELEASED;
  }
  w->last = *sample;
  w->any = true;
}

static void report(void *context, stic_connection state, const char *text)
{
  watcher *w = context;

  printf("%.3f %s: %s%s%s\n", (double)stic_clock_ns() / 1e9, w->spec, stic_connection_name(state),
         *text ? ": " : "", text);
  if (state == STIC_CONNECTION_LOST) {
    w->losses++;
    if (w->progress != RELEASED)
      complain(w, "lost before the gesture was seen");
    if (w->any && w->last.buttons & STIC_BUTTON_GRIP)
      complain(w, "lost with the grip held");
    w->progress = NOTHING;
  } else if (state == STIC_CONNECTION_RUNNING && w->losses > 0) {
    w->returns++;
  }
}

static stic_supervisor *open_patiently(watcher *w)
{
  const stic_supervisor_options options = {.report = report, .context = w};
  const int64_t end_ns = stic_clock_ns() + PATIENCE;
  stic_error err = {.status = STIC_OK};

  do {
    stic_supervisor *supervisor;

    if (stic_supervisor_open(w->spec, &options, &supervisor, &err) == STIC_OK)
      return supervisor;
    stic_clock_sleep_until(stic_clock_ns() + SECOND / 20);
  } while (stic_clock_ns() < end_ns);
  complain(w, err.message);
  return NULL;
}

static void watch(watcher *w, stic_supervisor *supervisor)
{
  const int64_t end_ns = stic_clock_ns() + PATIENCE;
  stic_device_sample samples[CAPACITY];

  while (!(w->returns == 1 && w->progress == RELEASED) && !w->bad) {
    const int count = stic_supervisor_poll(supervisor, stic_clock_ns() + SECOND / 31, samples, CAPACITY);

    if (count < 0)
      complain(w, stic_supervisor_error(supervisor)->message);
    for (int i = 0; i < count; i++)
      judge(w, &samples[i]);
    if (stic_clock_ns() > end_ns) {
      fprintf(stderr, "%s: lost %d times, back %d times, gesture at %d of %d\n", w->spec, w->losses,
              w->returns, (int)w->progress, (int)RELEASED);
      w->bad = true;
    }
  }
}

static int drive(const char *spec)
{
  watcher w = {.spec = spec};
  stic_supervisor *supervisor = open_patiently(&w);
  stic_device_counters counters;

  if (!supervisor)
    return 1;
  w.kind = stic_supervisor_driver(supervisor)->kind;
  watch(&w, supervisor);
  counters = stic_supervisor_counters(supervisor);
  printf("%s: samples %lld, bad %lld, gaps %lld, overruns %lld, reconnects %lld\n", spec,
         (long long)counters.samples, (long long)counters.bad_records, (long long)counters.gaps,
         (long long)counters.overruns, (long long)counters.reconnects);
  if (counters.reconnects != 1)
    complain(&w, "expected one reconnection");
  stic_supervisor_close(supervisor);
  return w.bad ? 1 : 0;
}

static int drive_forbidden(const char *spec)
{
  const int64_t end_ns = stic_clock_ns() + PATIENCE;
  stic_device *device;
  stic_error err = {.status = STIC_OK};

  if (setgid(NOBODY) != 0 || setuid(NOBODY) != 0) {
    perror("setuid");
    return 1;
  }
  do {
    if (stic_device_open(spec, &device, &err) == STIC_OK) {
      fprintf(stderr, "%s: opened without permission\n", spec);
      stic_device_close(device);
      return 1;
    }
    if (strstr(err.message, "no permission to open /dev/hidraw") && strstr(err.message, "udevadm")) {
      printf("%s: %s\n", spec, err.message);
      return 0;
    }
    stic_clock_sleep_until(stic_clock_ns() + SECOND / 20);
  } while (stic_clock_ns() < end_ns);
  fprintf(stderr, "%s: expected advice on permission, got: %s\n", spec, err.message);
  return 1;
}

int main(int argc, char **argv)
{
  setvbuf(stdout, NULL, _IOLBF, 0);
  if (argc == 2)
    return drive(argv[1]);
  if (argc == 3 && strcmp(argv[1], "--forbidden") == 0)
    return drive_forbidden(argv[2]);
  fprintf(stderr, "usage: drive-device [--forbidden] SPEC\n");
  return 2;
}

#include "connection.h"

#include "../src/error.h"
#include "../src/io/timing.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DESCRIPTION_ROOM 300

/* ---- silence and back-off ---------------------------------------------------------------- */

void stic_watch_begin(stic_watch *w, stic_silence silence, int64_t silence_ns)
{
  w->silence = silence;
  w->silence_ns = silence_ns;
  w->heard = w->told = false;
  w->heard_ns = w->retry_ns = 0;
  w->backoff_ns = STIC_BACKOFF_MIN_NS;
}

void stic_watch_heard(stic_watch *w, int64_t now_ns)
{
  w->heard = true;
  w->told = false;
  w->heard_ns = now_ns;
  w->backoff_ns = STIC_BACKOFF_MIN_NS;
}

static int64_t lost_after_ns(const stic_watch *w)
{
  return w->silence_ns > STIC_LOST_AFTER_NS ? w->silence_ns : STIC_LOST_AFTER_NS;
}

int64_t stic_watch_deadline(const stic_watch *w)
{
  /* Until the first sample a driver watches over its own start. */
  if (!w->heard || w->silence_ns == 0)
    return INT64_MAX;
  if (!w->told)
    return w->heard_ns + w->silence_ns;
  return w->silence == STIC_SILENCE_STALE ? w->heard_ns + lost_after_ns(w) : INT64_MAX;
}

stic_watch_event stic_watch_look(stic_watch *w, int64_t now_ns)
{
  if (now_ns < stic_watch_deadline(w))
    return STIC_WATCH_NONE;
  if (w->told)
    return STIC_WATCH_LOST;
  w->told = true;
  return w->silence == STIC_SILENCE_STALE ? STIC_WATCH_STALE : STIC_WATCH_REST;
}

void stic_watch_lost(stic_watch *w, int64_t now_ns)
{
  w->heard = w->told = false;
  w->retry_ns = now_ns + w->backoff_ns;
  w->backoff_ns = w->backoff_ns < STIC_BACKOFF_MAX_NS / 2 ? 2 * w->backoff_ns : STIC_BACKOFF_MAX_NS;
}

bool stic_watch_bars_grip(const stic_watch *w)
{
  return w->silence == STIC_SILENCE_STALE;
}

/* ---- the supervisor ---------------------------------------------------------------------- */

struct stic_supervisor {
  const stic_driver *driver;
  stic_device *device;           /* NULL while lost */
  int64_t (*now)(void *context); /* the device's own clock if it is a recording, else NULL */
  void *now_context;
  stic_supervisor_options options;
  stic_watch watch;
  stic_connection state, reported;
  bool losing;      /* lost and not running again yet: retries are not reported */
  int64_t lost_ns;  /* since when */
  bool grip_barred; /* until it is seen released */
  bool given;       /* `last` is a sample */
  stic_device_sample last;
  stic_device_counters closed; /* counters of devices closed since */
  stic_error error;
  char description[DESCRIPTION_ROOM];
  char spec[STIC_SPEC_MAX];
};

static void report(stic_supervisor *s, stic_connection state, const char *text)
{
  s->reported = state;
  if (s->options.report)
    s->options.report(s->options.context, state, text);
}

static void set_state(stic_supervisor *s, stic_connection state)
{
  s->state = state;
  if (state == s->reported)
    return;
  if (state == STIC_CONNECTION_RUNNING) {
    if (s->losing)
      s->closed.reconnects++;
    s->losing = false;
    stic_device_describe(s->device, s->description, sizeof s->description);
    report(s, state, s->description);
  } else if (!s->losing) {
    report(s, state, "");
  }
}

static void begin(stic_supervisor *s)
{
  s->driver = s->device->driver;
  s->reported = STIC_CONNECTION_CLOSED;
  stic_device_describe(s->device, s->description, sizeof s->description);
  stic_watch_begin(&s->watch, s->driver->silence, s->driver->silence_ns);
}

stic_status stic_supervisor_open(const char *spec_text, const stic_supervisor_options *options,
                                 stic_supervisor **supervisor, stic_error *err)
{
  stic_supervisor *s = calloc(1, sizeof *s);
  stic_status status;

  *supervisor = NULL;
  if (!s)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  status = stic_device_open(spec_text, &s->device, err);
  if (status != STIC_OK) {
    free(s);
    return status;
  }
  strcpy(s->spec, spec_text); /* it was parsed, so it fits */
  if (options)
    s->options = *options;
  begin(s);
  *supervisor = s;
  return STIC_OK;
}

stic_status stic_supervisor_adopt(stic_device *device, int64_t (*now)(void *context), void *context,
                                  stic_supervisor **supervisor, stic_error *err)
{
  stic_supervisor *s = calloc(1, sizeof *s);

  *supervisor = s;
  if (!s) {
    stic_device_close(device);
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  }
  s->device = device;
  s->now = now;
  s->now_context = context;
  begin(s);
  return STIC_OK;
}

static int64_t now_of(const stic_supervisor *s)
{
  return s->now ? s->now(s->now_context) : stic_clock_ns();
}

static void add_counters(stic_device_counters *sum, const stic_device_counters *part)
{
  sum->samples += part->samples;
  sum->bad_records += part->bad_records;
  sum->gaps += part->gaps;
  sum->overruns += part->overruns;
  sum->reconnects += part->reconnects;
}

stic_device *stic_supervisor_device(const stic_supervisor *s)
{
  return s->device;
}

stic_device_counters stic_supervisor_counters(const stic_supervisor *s)
{
  stic_device_counters sum = s->closed;

  if (s->device)
    add_counters(&sum, &s->device->counters);
  return sum;
}

/* ---- samples ----------------------------------------------------------------------------- */

static void bar_grip(stic_supervisor *s, stic_device_sample *sample)
{
  if (!(sample->buttons & STIC_BUTTON_GRIP))
    s->grip_barred = false;
  if (s->grip_barred)
    sample->buttons &= ~(uint32_t)STIC_BUTTON_GRIP;
}

/* Samples are stamped some time before they arrive, our own ones when they are made. */
static void keep_order(stic_supervisor *s, stic_device_sample *sample)
{
  if (s->given && sample->t_ns <= s->last.t_ns)
    sample->t_ns = s->last.t_ns + 1;
  if (s->given && !s->driver->own_time)
    sample->source_ns = sample->t_ns;
  s->given = true;
  s->last = *sample;
}

static int accept_samples(stic_supervisor *s, stic_device_sample *samples, int count, int64_t now_ns)
{
  stic_watch_heard(&s->watch, now_ns);
  for (int i = 0; i < count; i++) {
    bar_grip(s, &samples[i]);
    keep_order(s, &samples[i]);
  }
  set_state(s, STIC_CONNECTION_RUNNING);
  return count;
}

static int give_own(stic_supervisor *s, stic_device_sample *sample, int64_t now_ns)
{
  sample->t_ns = now_ns;
  memset(sample->velocity, 0, sizeof sample->velocity);
  memset(sample->turn_rate, 0, sizeof sample->turn_rate);
  keep_order(s, sample);
  return 1;
}

/* The last pose without anything that could move or hold; 0 if that has been said already. */
static int give_up_hand(stic_supervisor *s, stic_device_sample *sample, int64_t now_ns)
{
  const unsigned pose = STIC_SAMPLE_POSITION | STIC_SAMPLE_ORIENTATION;

  s->grip_barred = true;
  if (!s->given || (!(s->last.flags & ~pose) && s->last.buttons == 0))
    return 0;
  *sample = s->last;
  sample->buttons = 0;
  sample->flags &= pose;
  return give_own(s, sample, now_ns);
}

static bool is_moving(const stic_device_sample *sample)
{
  for (int i = 0; i < 3; i++) {
    if (sample->velocity[i] != 0 || sample->turn_rate[i] != 0)
      return true;
  }
  return false;
}

static int come_to_rest(stic_supervisor *s, stic_device_sample *sample, int64_t now_ns)
{
  if (!s->given || !is_moving(&s->last))
    return 0;
  *sample = s->last;
  return give_own(s, sample, now_ns);
}

/* ---- losing and opening again ------------------------------------------------------------ */

static int lose(stic_supervisor *s, stic_device_sample *sample, int64_t now_ns)
{
  char text[600];

  if (!s->losing)
    s->lost_ns = now_ns;
  s->losing = true;
  s->error = s->device->error;
  add_counters(&s->closed, &s->device->counters);
  stic_device_close(s->device);
  s->device = NULL;
  stic_watch_lost(&s->watch, now_ns);
  s->state = STIC_CONNECTION_LOST;
  stic_error_format(&s->error, text, sizeof text);
  if (s->reported != STIC_CONNECTION_LOST)
    report(s, STIC_CONNECTION_LOST, text);
  return give_up_hand(s, sample, now_ns);
}

static bool is_lost_for_good(const stic_supervisor *s, int64_t now_ns)
{
  return s->options.give_up_ns > 0 && s->losing && now_ns - s->lost_ns >= s->options.give_up_ns;
}

static void reopen(stic_supervisor *s)
{
  s->state = STIC_CONNECTION_OPENING;
  if (stic_device_reopen(s->spec, &s->device, &s->error) != STIC_OK) {
    stic_watch_lost(&s->watch, stic_clock_ns());
    s->state = STIC_CONNECTION_LOST;
  } else if (!stic_watch_bars_grip(&s->watch)) {
    s->grip_barred = false;
  }
}

static int64_t earlier(int64_t a, int64_t b)
{
  return a < b ? a : b;
}

/* Until there is a device again: true; false if not in time, or on a signal. */
static bool wait_for_device(stic_supervisor *s, int64_t until_ns)
{
  while (!s->device && !is_lost_for_good(s, stic_clock_ns())) {
    if (stic_clock_ns() >= s->watch.retry_ns)
      reopen(s);
    else if (stic_clock_ns() >= until_ns || !stic_clock_sleep_until(earlier(until_ns, s->watch.retry_ns)))
      return false;
  }
  return s->device != NULL;
}

static int follow_silence(stic_supervisor *s, stic_device_sample *sample, int64_t now_ns)
{
  switch (stic_watch_look(&s->watch, now_ns)) {
  case STIC_WATCH_REST: return come_to_rest(s, sample, now_ns);
  case STIC_WATCH_STALE: set_state(s, STIC_CONNECTION_STALE); return give_up_hand(s, sample, now_ns);
  case STIC_WATCH_LOST:
    stic_error_set(&s->device->error, STIC_NO_DEVICE, NULL, 0, "nothing heard for %.1f s",
                   (double)(now_ns - s->watch.heard_ns) / 1e9);
    return lose(s, sample, now_ns);
  case STIC_WATCH_NONE: break;
  }
  return 0;
}

/* A recording is not lost by its silence, so there is nothing to look for after the first event. */
static int64_t silence_deadline(const stic_supervisor *s)
{
  return s->now && s->watch.told ? INT64_MAX : stic_watch_deadline(&s->watch);
}

int stic_supervisor_poll(stic_supervisor *s, int64_t until_ns, stic_device_sample *samples, int capacity)
{
  for (;;) {
    int64_t wake_ns, now_ns;
    int count;

    if (!wait_for_device(s, until_ns))
      return is_lost_for_good(s, stic_clock_ns()) ? STIC_DRIVER_LOST : 0;
    wake_ns = earlier(until_ns, silence_deadline(s));
    /* Read first, then judge the silence: a loop that was late itself finds the samples waiting. */
    count = stic_device_poll(s->device, wake_ns, samples, capacity);
    now_ns = now_of(s);
    if (count > 0)
      return accept_samples(s, samples, count, now_ns);
    if (count == STIC_DRIVER_LOST && !s->now) {
      count = lose(s, samples, now_ns);
    } else if (count < 0 && count != STIC_DRIVER_LOST) {
      s->error = s->device->error;
      s->state = s->device->state;
      return count;
    } else {
      /* The driver knows its start, the watch what comes after; a recording that seems lost may go on. */
      if (!s->watch.heard)
        set_state(s, s->device->state);
      count = follow_silence(s, samples, now_ns);
    }
    if (count > 0 || now_ns >= until_ns || now_ns < wake_ns)
      return count;
  }
}

int stic_supervisor_send(stic_supervisor *s, const stic_device_output *output)
{
  return s->device ? stic_device_send(s->device, output) : STIC_DRIVER_LOST;
}

stic_connection stic_supervisor_state(const stic_supervisor *s)
{
  return s->state;
}

const stic_driver *stic_supervisor_driver(const stic_supervisor *s)
{
  return s->driver;
}

const stic_error *stic_supervisor_error(const stic_supervisor *s)
{
  return &s->error;
}

void stic_supervisor_describe(const stic_supervisor *s, char *out, size_t out_size)
{
  assert(out && out_size > 0);
  snprintf(out, out_size, "%s", s->description);
}

void stic_supervisor_close(stic_supervisor *s)
{
  if (!s)
    return;
  stic_device_close(s->device);
  free(s);
}

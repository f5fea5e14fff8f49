/* stiction monitor: a tracker live in the terminal. */
#include "../../drivers/connection.h"
#include "../../drivers/motion/tracker_yaml.h"
#include "../../drivers/mouse/mouse_driver.h"
#include "../error.h"
#include "../io/outfile.h"
#include "../io/timing.h"
#include "cli.h"
#include "monitor.h"

#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#define BATCH 64
#define PAGE_NS INT64_C(50000000)   /* 20 pictures a second */
#define LINE_NS INT64_C(1000000000) /* a line of plain text a second */
#define SECONDS_MAX 1e9

static const stic_cli_usage usage = {
  "monitor", "[OPTION...] --device NAME[:key=value,...]",
  "Shows pose, buttons, rate, jitter, state and counters of a tracker, and its way from the side and from above.\n"
  "Keys: q ends, r forgets the way and brings a pose made from velocities home. Where standard output is no\n"
  "terminal or a dumb one, or with --plain, a line of text a second instead.\n",
  0, 0};

typedef struct options {
  char *device, *tracker;
  double seconds; /* 0: until a key, a signal or the device's end */
  int plain, raw, ascii;
} options;

typedef struct watching {
  const options *options;
  stic_supervisor *device;
  stic_tracker_settings settings;
  stic_tracker tracker;
  stic_monitor monitor;
  bool full;            /* pages, not lines */
  struct termios found; /* of standard input, if `keys` */
  bool keys;
  bool quit;
  int failure; /* errno of a write, 0: none */
  char page[STIC_MONITOR_PAGE_MAX];
} watching;

/* ---- the terminal ------------------------------------------------------------------------ */

/* A failure ends it; false then. */
static bool put(watching *w, const char *text, size_t length)
{
  while (length > 0) {
    const ssize_t n = write(STDOUT_FILENO, text, length);

    if (n < 0 && errno == EINTR)
      continue;
    if (n <= 0) {
      w->failure = n < 0 ? errno : ENOSPC;
      w->quit = true;
      return false;
    }
    text += n;
    length -= (size_t)n;
  }
  return true;
}

static void put_text(watching *w, const char *text)
{
  put(w, text, strlen(text));
}

/* Keys come at once and unseen; Ctrl-C stays a signal, what would stop us with the terminal changed does not. */
static void take_terminal(watching *w)
{
  struct termios raw;

  put_text(w, "\033[?1049h\033[?25l\033[?7l\033[2J"); /* a screen of our own, no cursor, long lines are cut */
  if (!isatty(STDIN_FILENO) || tcgetattr(STDIN_FILENO, &w->found) != 0)
    return;
  raw = w->found;
  raw.c_lflag &= ~(tcflag_t)(ICANON | ECHO);
  raw.c_cc[VMIN] = 0;
  raw.c_cc[VTIME] = 0;
  raw.c_cc[VSUSP] = raw.c_cc[VQUIT] = _POSIX_VDISABLE;
  w->keys = tcsetattr(STDIN_FILENO, TCSANOW, &raw) == 0;
}

static void give_terminal_back(watching *w)
{
  if (!w->full)
    return;
  put_text(w, "\033[0m\033[?7h\033[?25h\033[?1049l");
  if (w->keys)
    tcsetattr(STDIN_FILENO, TCSANOW, &w->found);
}

/* Whether the terminal can do more than type. */
static bool knows_escapes(void)
{
  const char *kind = getenv("TERM");

  return kind && *kind && strcmp(kind, "dumb") != 0;
}

static bool is_utf8(void)
{
  static const char *const names[] = {"LC_ALL", "LC_CTYPE", "LANG"};

  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    const char *value = getenv(names[i]);

    if (value && value[0])
      return strstr(value, "UTF-8") || strstr(value, "utf-8") || strstr(value, "utf8") ||
             strstr(value, "UTF8");
  }
  return false;
}

static stic_monitor_look look_of_terminal(const options *o)
{
  stic_monitor_look look = {80, 24, !o->ascii && is_utf8(), !getenv("NO_COLOR")};
  struct winsize size;

  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 && size.ws_row > 0) {
    look.columns = size.ws_col;
    look.rows = size.ws_row;
  }
  return look;
}

/* ---- samples ----------------------------------------------------------------------------- */

static void begin_tracker(watching *w)
{
  stic_tracker_begin(&w->tracker, &w->settings, stic_supervisor_driver(w->device)->kind);
}

static void take_samples(watching *w, stic_device_sample *samples, int count)
{
  for (int i = 0; i < count; i++) {
    const uint32_t bits = samples[i].buttons;

    if (!stic_supervisor_driver(w->device)->in_room)
      stic_tracker_apply(&w->tracker, &samples[i]);
    stic_monitor_add(&w->monitor, &samples[i], bits);
  }
}

static void tell_connection(void *context, stic_connection state, const char *text)
{
  watching *w = context;

  if (state == STIC_CONNECTION_RUNNING)
    w->monitor.message[0] = '\0';
  else if (text[0])
    snprintf(w->monitor.message, sizeof w->monitor.message, "%s", text);
}

/* Until `until_ns`: 0, or what ended the device. */
static int read_until(watching *w, int64_t until_ns)
{
  stic_device_sample samples[BATCH];

  while (stic_clock_ns() < until_ns && stic_cli_signal() == 0) {
    const int count = stic_supervisor_poll(w->device, until_ns, samples, BATCH);

    if (count < 0)
      return count;
    take_samples(w, samples, count);
  }
  return 0;
}

static void update(watching *w)
{
  stic_monitor *m = &w->monitor;
  const stic_device *device = stic_supervisor_device(w->device);

  m->now_ns = stic_clock_ns();
  m->state = stic_supervisor_state(w->device);
  m->counters = stic_supervisor_counters(w->device);
  stic_supervisor_describe(w->device, m->device, sizeof m->device);
  if (w->options->raw && device) {
    m->raw_length = device->raw_length;
    memcpy(m->raw, device->raw, sizeof m->raw);
  }
}

/* Length of the first lines: more would scroll a small terminal. */
static size_t first_lines(const char *page, size_t length, int lines)
{
  for (size_t i = 0; i < length; i++) {
    lines -= page[i] == '\n';
    if (lines == 0)
      return i;
  }
  return length;
}

static void show(watching *w)
{
  size_t length;

  update(w);
  if (w->full) {
    const stic_monitor_look look = look_of_terminal(w->options);

    length = first_lines(w->page, stic_monitor_page(&w->monitor, &look, w->page), look.rows);
  } else {
    length = stic_monitor_line(&w->monitor, w->page, sizeof w->page);
    if (w->monitor.raw_length > 0) {
      length--; /* the line's end comes after the bytes */
      length += (size_t)snprintf(w->page + length, 8, "  raw");
      for (size_t i = 0; i < w->monitor.raw_length; i++)
        length += (size_t)snprintf(w->page + length, 4, " %02x", w->monitor.raw[i]);
      w->page[length++] = '\n';
    }
  }
  put(w, w->page, length);
}

static void follow_keys(watching *w)
{
  struct pollfd input = {STDIN_FILENO, POLLIN, 0};
  char key;

  while (w->keys && poll(&input, 1, 0) > 0) {
    if (read(STDIN_FILENO, &key, 1) != 1) { /* the terminal has gone */
      w->quit = true;
      return;
    }
    if (key == 'q' || key == 'Q')
      w->quit = true;
    if (key == 'r' || key == 'R') {
      begin_tracker(w);
      stic_monitor_reset(&w->monitor);
    }
  }
}

/* ---- the command ------------------------------------------------------------------------- */

/* What ended the device, 0 if nothing did. */
static int watch(watching *w)
{
  const int64_t step_ns = w->full ? PAGE_NS : LINE_NS;
  const int64_t end_ns =
    w->options->seconds > 0 ? w->monitor.started_ns + (int64_t)(w->options->seconds * 1e9) : INT64_MAX;
  int64_t next_ns = w->monitor.started_ns;
  int result = 0;

  while (result == 0 && !w->quit && stic_cli_signal() == 0 && next_ns < end_ns) {
    const int64_t now_ns = stic_clock_ns();

    /* After a terminal that was slow, no row of pictures in a hurry. */
    next_ns = next_ns + step_ns > now_ns ? next_ns + step_ns : now_ns + step_ns;
    result = read_until(w, next_ns < end_ns ? next_ns : end_ns);
    show(w);
    follow_keys(w);
  }
  return result;
}

static int end(watching *w, int result)
{
  stic_error err = *stic_supervisor_error(w->device);

  give_terminal_back(w);
  if (w->full && stic_monitor_line(&w->monitor, w->page, sizeof w->page) > 0)
    put_text(w, w->page);
  if (result == STIC_DRIVER_BAD_DATA)
    return stic_cli_fail(&err);
  if (result == STIC_DRIVER_LOST) {
    stic_cli_say("the device is lost%s%s", err.message[0] ? ": " : "", err.message);
    return STIC_NO_DEVICE;
  }
  if (w->failure == 0 || stic_cli_signal() != 0)
    return STIC_OK;
  stic_error_set(&err, STIC_CANNOT_WRITE, STIC_OUTFILE_STDOUT, 0, "cannot write: %s", strerror(w->failure));
  return stic_cli_fail(&err);
}

static int run(const options *o)
{
  watching *w = calloc(1, sizeof *w);
  const stic_supervisor_options supervised = {tell_connection, w, 0};
  stic_error err;
  stic_status status;
  int code;

  if (!w) {
    stic_cli_say("monitor: out of memory");
    return STIC_NO_MEMORY;
  }
  w->options = o;
  stic_tracker_settings_init(&w->settings);
  status = o->tracker ? stic_tracker_read(o->tracker, NULL, true, &w->settings, &err) : STIC_OK;
  if (status == STIC_OK)
    status = stic_supervisor_open(o->device, &supervised, &w->device, &err);
  if (status == STIC_OK && stic_supervisor_driver(w->device) == &stic_mouse_driver)
    status = stic_error_set(&err, STIC_USAGE, NULL, 0, "device mouse: it moves in the window of run --view");
  if (status != STIC_OK) {
    stic_supervisor_close(w->device);
    free(w);
    return stic_cli_fail(&err);
  }
  begin_tracker(w);
  w->monitor.sample.orientation[3] = 1;
  w->monitor.started_ns = stic_clock_ns();
  w->full = !o->plain && isatty(STDOUT_FILENO) && knows_escapes();
  if (w->full)
    take_terminal(w);
  code = end(w, watch(w));
  stic_supervisor_close(w->device);
  free(w);
  return code;
}

int stic_cmd_monitor(int argc, const char **argv)
{
  options o = {NULL, NULL, 0, 0, 0, 0};
  const struct poptOption table[] = {
    {"device", 'd', POPT_ARG_STRING, &o.device, 0, "The tracker; `stiction devices` tells what to type",
     "NAME[:key=value,...]"},
    {"tracker", '\0', POPT_ARG_STRING, &o.tracker, 0,
     "Where the tracker stands and which button does what: a tracker file, or a scene with that section",
     "FILE"},
    {"seconds", '\0', POPT_ARG_DOUBLE, &o.seconds, 0,
     "End after so long (default 0: when the device or you end it)", "N"},
    {"plain", '\0', POPT_ARG_NONE, &o.plain, 0, "A line of text a second", NULL},
    {"raw", '\0', POPT_ARG_NONE, &o.raw, 0, "Also the last bytes that came, if the driver tells", NULL},
    {"ascii", '\0', POPT_ARG_NONE, &o.ascii, 0, "No characters beyond ASCII, also where the locale has them",
     NULL},
    POPT_TABLEEND};
  stic_cli_args args;
  int code = stic_cli_parse(&usage, table, argc, argv, &args);

  if (code < 0 && !o.device) {
    stic_cli_say("monitor: no device; expected --device NAME[:key=value,...]; see stiction devices");
    code = STIC_USAGE;
  }
  if (code < 0 && !(o.seconds >= 0 && o.seconds <= SECONDS_MAX)) {
    stic_cli_say("monitor: --seconds is %g; expected 0 to %g", o.seconds, SECONDS_MAX);
    code = STIC_USAGE;
  }
  if (code < 0)
    code = run(&o);
  stic_cli_args_free(&args);
  free(o.device);
  free(o.tracker);
  return code;
}

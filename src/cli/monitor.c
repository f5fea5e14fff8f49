#include "monitor.h"

#include "../../drivers/motion/tracker_frame.h"
#include "../angle.h"
#include "../error.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define WINDOW_NS INT64_C(2000000000) /* of rate and jitter */
#define TRAIL_STEP_NS 10000000
#define SPAN_MIN 0.2 /* m, of the sketch's height at least */

enum { RED = 31, GREEN = 32, YELLOW = 33, CYAN = 36, GREY = 90 };

/* ---- samples ----------------------------------------------------------------------------- */

void stic_monitor_reset(stic_monitor *m)
{
  m->begun = false;
  m->count = m->trail_count = 0;
  m->speed = 0;
}

static void extend_trail(stic_monitor *m, const stic_device_sample *s)
{
  float *point = m->trail[m->trail_count % STIC_MONITOR_TRAIL];

  if (m->trail_count > 0 && s->t_ns - m->trail_ns < TRAIL_STEP_NS)
    return;
  for (int i = 0; i < 3; i++) {
    point[i] = (float)s->position[i];
    if (m->trail_count == 0 || s->position[i] < m->low[i])
      m->low[i] = s->position[i];
    if (m->trail_count == 0 || s->position[i] > m->high[i])
      m->high[i] = s->position[i];
  }
  m->trail_ns = s->t_ns;
  m->trail_count++;
}

void stic_monitor_add(stic_monitor *m, const stic_device_sample *s, uint32_t bits)
{
  const double seconds = (double)(s->t_ns - m->sample.t_ns) / 1e9;
  double sum = 0;

  for (int i = 0; i < 3; i++)
    sum += (s->position[i] - m->sample.position[i]) * (s->position[i] - m->sample.position[i]);
  m->speed = m->begun && seconds > 0 ? sqrt(sum) / seconds : 0;
  m->begun = true;
  m->sample = *s;
  m->bits = bits;
  m->times[m->count++ % STIC_MONITOR_TIMES] = s->t_ns;
  if (s->flags & STIC_SAMPLE_TRACKED && s->flags & STIC_SAMPLE_POSITION)
    extend_trail(m, s);
}

/* Rate in Hz and the standard deviation of the intervals in ms over the last two seconds; 0 if there are too few. */
static void find_rate(const stic_monitor *m, double *hz, double *jitter_ms)
{
  const int64_t newest = m->count > 0 ? m->times[(m->count - 1) % STIC_MONITOR_TIMES] : 0;
  double sum = 0, squares = 0, mean;
  int n = 0;

  *hz = *jitter_ms = 0;
  if (m->now_ns - newest > WINDOW_NS)
    return;
  for (int64_t i = m->count - 1; i > 0 && n < STIC_MONITOR_TIMES - 1; i--, n++) {
    const int64_t from = m->times[(i - 1) % STIC_MONITOR_TIMES];
    const double step = (double)(m->times[i % STIC_MONITOR_TIMES] - from) / 1e6;

    if (newest - from > WINDOW_NS)
      break;
    sum += step;
    squares += step * step;
  }
  if (n < 2 || sum <= 0)
    return;
  mean = sum / n;
  *hz = 1e3 / mean;
  *jitter_ms = sqrt(fmax(0, squares / n - mean * mean));
}

/* Yaw, pitch, roll in degrees: R = Ry Rx Rz. */
static void angles_of(const double q[4], double out[3])
{
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  const double sine = 2 * (w * x - y * z);

  out[0] = STIC_DEG_PER_RAD * atan2(2 * (x * z + w * y), 1 - 2 * (x * x + y * y));
  out[1] = STIC_DEG_PER_RAD * asin(fmax(-1, fmin(1, sine)));
  out[2] = STIC_DEG_PER_RAD * atan2(2 * (x * y + w * z), 1 - 2 * (x * x + z * z));
}

/* ---- text -------------------------------------------------------------------------------- */

/* Text that grows to the end of its room; `column` counts what is seen of the line. */
typedef struct page {
  const stic_monitor_look *look;
  int columns, rows, column, row;
  size_t used;
  char *text;
} page;

static void put_bytes(page *p, const char *bytes, size_t length)
{
  if (p->used + length < STIC_MONITOR_PAGE_MAX) {
    memcpy(p->text + p->used, bytes, length);
    p->used += length;
  }
}

static void colour(page *p, int code)
{
  char text[16];

  if (p->look->colour)
    put_bytes(p, text, (size_t)snprintf(text, sizeof text, "\033[%dm", code));
}

/* One column wide; what does not fit into the line is left out. */
static void glyph(page *p, const char *unicode, char ascii)
{
  if (p->column >= p->columns)
    return;
  p->column++;
  if (p->look->unicode)
    put_bytes(p, unicode, strlen(unicode));
  else
    put_bytes(p, &ascii, 1);
}

static void text(page *p, const char *format, ...) STIC_PRINTF(2, 3);

/* ASCII, but for what others told, where any byte above counts as '?'. */
static void text(page *p, const char *format, ...)
{
  char line[STIC_MONITOR_COLUMNS_MAX + 1];
  va_list args;

  va_start(args, format);
  vsnprintf(line, sizeof line, format, args);
  va_end(args);
  for (const char *c = line; *c && p->column < p->columns; c++, p->column++)
    put_bytes(p, *c >= 0x20 && *c < 0x7f ? c : "?", 1);
}

static void end_line(page *p)
{
  put_bytes(p, "\033[K", 3);
  if (++p->row < p->rows)
    put_bytes(p, "\r\n", 2);
  p->column = 0;
}

static void label(page *p, const char *name)
{
  colour(p, GREY);
  text(p, " %-9s", name);
  colour(p, 0);
}

/* ---- what is told ------------------------------------------------------------------------ */

static int state_colour(stic_connection state)
{
  switch (state) {
  case STIC_CONNECTION_RUNNING: return GREEN;
  case STIC_CONNECTION_LOST:
  case STIC_CONNECTION_CLOSED: return RED;
  default: return YELLOW;
  }
}

static const char *tracking_text(const stic_monitor *m)
{
  const unsigned flags = m->sample.flags;

  if (!m->begun)
    return "no sample yet";
  if (!(flags & STIC_SAMPLE_TRACKED))
    return flags & STIC_SAMPLE_POSITION ? "not tracked, pose held" : "not seen yet";
  return flags & STIC_SAMPLE_FRINGE ? "tracked, at the edge of the range" : "tracked";
}

static void put_state(page *p, const stic_monitor *m)
{
  double hz, jitter;

  find_rate(m, &hz, &jitter);
  label(p, "state");
  colour(p, state_colour(m->state));
  glyph(p, m->state == STIC_CONNECTION_RUNNING ? "●" : "○", '*');
  text(p, " %-9s", stic_connection_name(m->state));
  colour(p, 0);
  text(p, " %6.1f Hz  jitter %6.3f ms  %s", hz, jitter, tracking_text(m));
  end_line(p);
}

static void put_pose(page *p, const stic_monitor *m)
{
  double angles[3] = {0, 0, 0};

  label(p, "position");
  if (m->begun)
    text(p, "x %+8.4f   y %+8.4f   z %+8.4f m     %7.3f m/s", m->sample.position[0], m->sample.position[1],
         m->sample.position[2], m->speed);
  end_line(p);
  label(p, "turn");
  if (m->begun) {
    angles_of(m->sample.orientation, angles);
    text(p, "yaw %+6.1f   pitch %+6.1f   roll %+6.1f deg", angles[0], angles[1], angles[2]);
  }
  end_line(p);
}

static void put_button(page *p, const char *name, bool pressed)
{
  colour(p, pressed ? 7 : GREY);
  text(p, " %s ", name);
  colour(p, 0);
}

static void put_buttons(page *p, const stic_monitor *m)
{
  label(p, "buttons");
  put_button(p, "GRIP", m->begun && m->sample.buttons & STIC_BUTTON_GRIP);
  put_button(p, "RESET", m->begun && m->sample.buttons & STIC_BUTTON_RESET);
  put_button(p, "CLUTCH", m->begun && m->sample.buttons & STIC_BUTTON_CLUTCH);
  text(p, "  device's bits:");
  for (int bit = 0; bit < 32; bit++) {
    if (m->begun && m->bits >> bit & 1)
      text(p, " %d", bit);
  }
  end_line(p);
}

static void put_counters(page *p, const stic_monitor *m)
{
  const stic_device_counters *c = &m->counters;
  const bool trouble = c->bad_records + c->gaps + c->overruns + c->reconnects > 0;

  label(p, "counted");
  text(p, "%lld samples", (long long)c->samples);
  colour(p, trouble ? YELLOW : 0);
  text(p, "  %lld garbled  %lld gaps  %lld overruns  %lld reconnects", (long long)c->bad_records,
       (long long)c->gaps, (long long)c->overruns, (long long)c->reconnects);
  colour(p, 0);
  end_line(p);
}

static void put_raw(page *p, const stic_monitor *m)
{
  if (m->raw_length == 0)
    return;
  label(p, "raw");
  for (size_t i = 0; i < m->raw_length; i++)
    text(p, "%02x ", m->raw[i]);
  end_line(p);
}

/* ---- the sketches ------------------------------------------------------------------------ */

/* Dots in cells of 2 x 4, as Braille has them. */
typedef struct sketch {
  int columns, rows; /* cells */
  int across, up;    /* which coordinates; up is turned over if `down` */
  bool down;
  double centre[2], metres; /* of a dot */
  int hand_column, hand_row;
  uint8_t dots[STIC_MONITOR_ROWS_MAX][STIC_MONITOR_COLUMNS_MAX];
} sketch;

/* The next of 1, 2, 5, 10 ... above. */
static double round_up(double value)
{
  const double power = pow(10, floor(log10(value)));
  const double part = value / power;

  return power * (part <= 1 ? 1 : part <= 2 ? 2 : part <= 5 ? 5 : 10);
}

static bool dot_at(const sketch *s, const double position[2], int *x, int *y)
{
  const double u = floor((position[0] - s->centre[0]) / s->metres + s->columns);
  const double v = floor((position[1] - s->centre[1]) / s->metres * (s->down ? 1 : -1) + 2 * s->rows);

  if (!(u >= 0 && v >= 0 && u < 2 * s->columns && v < 4 * s->rows))
    return false;
  *x = (int)u;
  *y = (int)v;
  return true;
}

static void set_dot(sketch *s, const double position[2])
{
  static const uint8_t bits[4][2] = {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};
  int x, y;

  if (dot_at(s, position, &x, &y))
    s->dots[y / 4][x / 2] |= bits[y % 4][x % 2];
}

/* The metres that the height shows. */
static double span_of(const stic_monitor *m, int columns, int rows)
{
  double span = SPAN_MIN;

  for (int i = 0; i < 3 && m->trail_count > 0; i++) {
    const double range = (m->high[i] - m->low[i]) * 1.1;

    span = fmax(span, i == 0 ? range * (4 * rows) / (2 * columns) : range);
  }
  return round_up(span * 0.999999);
}

/* The hand's own x axis, so that a turn is seen. */
static void draw_hand(sketch *s, const stic_monitor *m)
{
  const double *q = m->sample.orientation;
  const double axis[3] = {1 - 2 * (q[1] * q[1] + q[2] * q[2]), 2 * (q[0] * q[1] + q[2] * q[3]),
                          2 * (q[0] * q[2] - q[1] * q[3])};
  const double at[2] = {m->sample.position[s->across], m->sample.position[s->up]};
  int x, y;

  for (int i = 0; i <= 12; i++) {
    const double dot[2] = {at[0] + i * s->metres * axis[s->across], at[1] + i * s->metres * axis[s->up]};

    set_dot(s, dot);
  }
  if (dot_at(s, at, &x, &y)) {
    s->hand_column = x / 2;
    s->hand_row = y / 4;
  }
}

static void draw_sketch(sketch *s, const stic_monitor *m, int columns, int rows, int up, bool down)
{
  const int64_t points = m->trail_count < STIC_MONITOR_TRAIL ? m->trail_count : STIC_MONITOR_TRAIL;

  memset(s, 0, sizeof *s);
  s->columns = columns;
  s->rows = rows;
  s->up = up;
  s->down = down;
  s->metres = span_of(m, columns, rows) / (4 * rows);
  s->hand_column = s->hand_row = -1;
  s->centre[0] = m->trail_count > 0 ? (m->low[0] + m->high[0]) / 2 : 0;
  s->centre[1] = m->trail_count > 0 ? (m->low[up] + m->high[up]) / 2 : 0;
  for (int64_t i = 0; i < points; i++) {
    const double at[2] = {m->trail[i][0], m->trail[i][up]};

    set_dot(s, at);
  }
  if (m->begun && m->sample.flags & STIC_SAMPLE_POSITION)
    draw_hand(s, m);
}

static void put_cell(page *p, const sketch *s, const stic_monitor *m, int row, int column)
{
  const unsigned dots = s->dots[row][column], code = 0x2800 + dots;
  const char braille[4] = {(char)(0xe0 | code >> 12), (char)(0x80 | (code >> 6 & 0x3f)),
                           (char)(0x80 | (code & 0x3f)), '\0'};

  if (row == s->hand_row && column == s->hand_column) {
    colour(p, m->sample.flags & STIC_SAMPLE_TRACKED ? GREEN : RED);
    if (m->sample.buttons & STIC_BUTTON_GRIP)
      glyph(p, "◆", '#');
    else
      glyph(p, "○", 'o');
    colour(p, 0);
  } else {
    glyph(p, dots ? braille : " ", dots ? '.' : ' ');
  }
}

static void put_border(page *p, int columns, const char *title, bool top)
{
  colour(p, GREY);
  glyph(p, top ? "╭" : "╰", '+');
  if (title[0])
    text(p, " %s ", title);
  for (int i = title[0] ? (int)strlen(title) + 2 : 0; i < columns; i++)
    glyph(p, "─", '-');
  glyph(p, top ? "╮" : "╯", '+');
  colour(p, 0);
}

static void put_row(page *p, const sketch *s, const stic_monitor *m, int row)
{
  colour(p, GREY);
  glyph(p, "│", '|');
  colour(p, CYAN);
  for (int column = 0; column < s->columns; column++) {
    put_cell(p, s, m, row, column);
    if (row == s->hand_row && column == s->hand_column)
      colour(p, CYAN);
  }
  colour(p, GREY);
  glyph(p, "│", '|');
  colour(p, 0);
}

static void put_sketches(page *p, const stic_monitor *m, int rows)
{
  const int columns = p->columns / 2 - 2;
  sketch side, top;
  char scale[64];

  draw_sketch(&side, m, columns, rows, 1, false);
  draw_sketch(&top, m, columns, rows, 2, true);
  snprintf(scale, sizeof scale, "height %g m", side.metres * 4 * rows);
  put_border(p, columns, "side: x right, y up", true);
  put_border(p, columns, "top: x right, z nearer", true);
  end_line(p);
  for (int row = 0; row < rows; row++) {
    put_row(p, &side, m, row);
    put_row(p, &top, m, row);
    end_line(p);
  }
  put_border(p, columns, scale, false);
  put_border(p, columns, "", false);
  end_line(p);
}

/* ---- pages ------------------------------------------------------------------------------- */

static int between(int value, int low, int high)
{
  return value < low ? low : value > high ? high : value;
}

static void put_foot(page *p, const stic_monitor *m)
{
  colour(p, GREY);
  text(p, " q quit   r reset   ");
  if (!m->message[0])
    text(p, "%.1f s", (double)(m->now_ns - m->started_ns) / 1e9);
  colour(p, YELLOW);
  text(p, "%s", m->message);
  colour(p, 0);
  end_line(p);
}

size_t stic_monitor_page(const stic_monitor *m, const stic_monitor_look *look, char *out)
{
  page p = {look,
            between(look->columns, STIC_MONITOR_COLUMNS_MIN, STIC_MONITOR_COLUMNS_MAX),
            between(look->rows, STIC_MONITOR_ROWS_MIN, STIC_MONITOR_ROWS_MAX),
            0,
            0,
            0,
            out};
  const int told = 6 + (m->raw_length > 0), frame = 3; /* lines before the sketch; its borders and the foot */

  put_bytes(&p, "\033[H", 3);
  colour(&p, 1);
  text(&p, " %s", m->device);
  colour(&p, 0);
  end_line(&p);
  put_state(&p, m);
  put_pose(&p, m);
  put_buttons(&p, m);
  put_counters(&p, m);
  put_raw(&p, m);
  if (p.rows - told - frame >= 2)
    put_sketches(&p, m, p.rows - told - frame);
  put_foot(&p, m);
  put_bytes(&p, "\033[J", 3);
  return p.used;
}

size_t stic_monitor_line(const stic_monitor *m, char *out, size_t out_size)
{
  double hz, jitter, angles[3];
  int n;

  find_rate(m, &hz, &jitter);
  angles_of(m->sample.orientation, angles);
  n = snprintf(
    out, out_size,
    "%.1f s  %s  %.1f Hz  jitter %.3f ms  x %+.4f y %+.4f z %+.4f m  yaw %+.1f pitch %+.1f roll %+.1f deg  "
    "buttons 0x%x%s  samples %lld garbled %lld gaps %lld overruns %lld reconnects %lld  %s\n",
    (double)(m->now_ns - m->started_ns) / 1e9, stic_connection_name(m->state), hz, jitter,
    m->sample.position[0], m->sample.position[1], m->sample.position[2], angles[0], angles[1], angles[2],
    (unsigned)m->bits, m->begun && m->sample.buttons & STIC_BUTTON_GRIP ? " GRIP" : "",
    (long long)m->counters.samples, (long long)m->counters.bad_records, (long long)m->counters.gaps,
    (long long)m->counters.overruns, (long long)m->counters.reconnects, tracking_text(m));
  return n < 0 ? 0 : (size_t)n < out_size ? (size_t)n : out_size - 1;
}

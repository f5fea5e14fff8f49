#include "figure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../../src/angle.h"
#include "../../src/error.h"
#include "decimate.h"

#define STATE_LABEL_MIN 0.11 /* part of the time axis from which a state's name fits */

/* Blocks of the data file, in this order; forces follow for each surface. */
enum { BLOCK_SLIPS, BLOCK_HAND, BLOCK_OBJECT, BLOCK_LANDINGS, BLOCK_FORCES };

static bool shows_forces(const stic_figure *f)
{
  return f->number == 10 || f->number == 12;
}

static const stic_plot_row *row_at(const stic_figure *f, int64_t i)
{
  return &f->plot->rows[f->from + i];
}

static int64_t row_count(const stic_figure *f)
{
  return f->to - f->from;
}

static bool slipped(const stic_figure *f, int64_t i)
{
  const int64_t before = f->from + i > 0 ? row_at(f, i - 1)->slips : 0;

  return row_at(f, i)->slips > before;
}

/* ---- data ---------------------------------------------------------------------------------- */

/* The object is shown where the spring joins it to the hand: what is between the curves is its stretch. */
static double x_of(const stic_figure *f, const stic_plot_row *r, int who)
{
  const double *b = f->plot->holding_point;

  return who == BLOCK_HAND ? r->hand_x : r->x + b[0] * cos(r->theta) - b[1] * sin(r->theta);
}

static double y_of(const stic_figure *f, const stic_plot_row *r, int who)
{
  const double *b = f->plot->holding_point;

  return who == BLOCK_HAND ? r->hand_y : r->y + b[0] * sin(r->theta) + b[1] * cos(r->theta);
}

static double angle_of(const stic_figure *f, const stic_plot_row *r, int who)
{
  (void)f;
  return STIC_DEG_PER_RAD * (who == BLOCK_HAND ? r->hand_theta : r->theta);
}

static double normal_of(const stic_figure *f, const stic_plot_row *r, int n)
{
  return stic_plot_normal(f->plot, r, n);
}

static double friction_of(const stic_figure *f, const stic_plot_row *r, int n)
{
  return stic_plot_friction(f->plot, r, n);
}

typedef double (*quantity)(const stic_figure *f, const stic_plot_row *row, int which);

/* Adds to f->keep what the curve of a quantity needs. `fresh`: starts anew. */
static void keep_for(const stic_figure *f, quantity of, int which, bool fresh, bool *scratch)
{
  for (int64_t i = 0; i < row_count(f); i++)
    f->values[i] = of(f, row_at(f, i), which);
  stic_decimate(f->values, f->jump, row_count(f), scratch);
  for (int64_t i = 0; i < row_count(f); i++)
    f->keep[i] = scratch[i] || (!fresh && f->keep[i]);
}

static void end_block(stic_outfile *out)
{
  stic_outfile_print(out, "\n\n");
}

/* Where slips happened in time; as many as a line of print can show. */
static void slip_block(const stic_figure *f, stic_outfile *out)
{
  const double first = row_at(f, 0)->t, span = row_at(f, row_count(f) - 1)->t - first;
  double last = -INFINITY;

  stic_outfile_print(out, "# slips: t/s\n");
  for (int64_t i = 0; i < row_count(f); i++) {
    const double t = row_at(f, i)->t;

    if (!slipped(f, i) || (row_count(f) > STIC_CURVE_POINTS && t - last < span / STIC_CURVE_POINTS))
      continue;
    stic_outfile_print(out, "%.9g\n", t);
    last = t;
  }
  if (isinf(last))
    stic_outfile_print(out, "NaN\n"); /* a block must not be empty */
  end_block(out);
}

static void path_block(const stic_figure *f, int who, bool *scratch, stic_outfile *out)
{
  keep_for(f, x_of, who, true, scratch);
  keep_for(f, y_of, who, false, scratch);
  keep_for(f, angle_of, who, false, scratch);
  stic_outfile_print(out, "# %s: t/s x/m y/m angle/deg\n", who == BLOCK_HAND ? "hand" : "object");
  for (int64_t i = 0; i < row_count(f); i++) {
    const stic_plot_row *r = row_at(f, i);

    if (f->keep[i])
      stic_outfile_print(out, "%.9g %.9g %.9g %.9g\n", r->t, x_of(f, r, who), y_of(f, r, who),
                         angle_of(f, r, who));
  }
  end_block(out);
}

/* Where the object came to rest after each slip. */
static void landing_block(const stic_figure *f, stic_outfile *out)
{
  int64_t count = 0;

  stic_outfile_print(out, "# rest after a slip: x/m y/m\n");
  for (int64_t i = 0; i < row_count(f) && count < STIC_CURVE_POINTS; i++) {
    if (slipped(f, i)) {
      stic_outfile_print(out, "%.9g %.9g\n", x_of(f, row_at(f, i), BLOCK_OBJECT),
                         y_of(f, row_at(f, i), BLOCK_OBJECT));
      count++;
    }
  }
  if (count == 0)
    stic_outfile_print(out, "NaN NaN\n");
  end_block(out);
}

static void surface_name(const stic_figure *f, int n, char *out, size_t size)
{
  const int index = f->plot->surfaces[n];

  if (f->plot->has_scene && index < f->plot->scene_count && f->plot->scene[index].name[0])
    stic_error_quote(f->plot->scene[index].name, strlen(f->plot->scene[index].name), out, size);
  else
    snprintf(out, size, "surface %d", index);
}

static void force_block(const stic_figure *f, int n, bool *scratch, stic_outfile *out)
{
  char name[STIC_NAME_MAX];

  surface_name(f, n, name, sizeof name);
  keep_for(f, normal_of, n, true, scratch);
  keep_for(f, friction_of, n, false, scratch);
  stic_outfile_print(out, "# forces on %s: t/s normal/N friction/N\n", name);
  for (int64_t i = 0; i < row_count(f); i++) {
    const stic_plot_row *r = row_at(f, i);

    if (f->keep[i])
      stic_outfile_print(out, "%.9g %.9g %.9g\n", r->t, normal_of(f, r, n), friction_of(f, r, n));
  }
  end_block(out);
}

void stic_figure_data(const stic_figure *f, stic_outfile *out)
{
  bool *scratch = f->keep + row_count(f);

  stic_outfile_print(out, "# figure %d; blocks are apart by two empty lines\n", f->number);
  for (int64_t i = 0; i < row_count(f); i++)
    f->jump[i] = slipped(f, i);
  slip_block(f, out);
  path_block(f, BLOCK_HAND, scratch, out);
  path_block(f, BLOCK_OBJECT, scratch, out);
  landing_block(f, out);
  for (int n = 0; n < f->plot->surface_count; n++)
    force_block(f, n, scratch, out);
}

/* ---- script -------------------------------------------------------------------------------- */

/* All lengths in mm. A figure is a stack of panels over one time axis and a strip of states. */
#define WIDTH 85.0
#define LEFT 13.5
#define RIGHT 2.5
#define BOTTOM 8.5
#define STRIP 3.6
#define GAP 2.2
#define PLANE 38.0 /* panel of the plane, and what is under it for its own axis */
#define PLANE_FOOT 10.0
#define KEY_LINE 4.2
#define KEY_TOP 3.0 /* middle of the first line of the key */
#define TIME_PANEL 20.0
#define FORCE_PANEL 32.0

static double height_of(const stic_figure *f)
{
  const double time = BOTTOM + STRIP + GAP;

  if (shows_forces(f))
    return time + f->plot->surface_count * (FORCE_PANEL + GAP) + 2 * KEY_LINE;
  return time + 3 * (TIME_PANEL + GAP) + PLANE_FOOT + PLANE + KEY_LINE;
}

/* Text in single quotes, in which gnuplot finds nothing special but the quote. */
static void quoted(const char *text, char *out, size_t size)
{
  size_t used = 0;

  for (; *text && used + 3 < size; text++) {
    if (*text == '\'')
      out[used++] = '\'';
    out[used++] = *text;
  }
  out[used] = '\0';
}

static void script_head(const stic_figure *f, stic_outfile *out)
{
  const double height = height_of(f);
  char stem[520];

  quoted(f->stem, stem, sizeof stem);
  stic_outfile_print(out, "# Figure %d. Run as: gnuplot -e \"format='pdf'\" FILE (svg, pdf or png)\n",
                     f->number);
  stic_outfile_print(out, "if (!exists('format')) format = 'svg'\n");
  stic_outfile_print(
    out,
    "if (format eq 'svg') set terminal svg size %.0f,%.0f font 'Helvetica,10.7' enhanced background 'white'\n",
    WIDTH / 25.4 * 96, height / 25.4 * 96);
  stic_outfile_print(
    out,
    "if (format eq 'pdf') set terminal pdfcairo size %.2fcm,%.2fcm font 'Helvetica,8' fontscale 0.78 linewidth 1.3 pointscale 0.6 enhanced\n",
    WIDTH / 10, height / 10);
  stic_outfile_print(
    out,
    "if (format eq 'png') set terminal pngcairo size %.0f,%.0f font 'Helvetica,8' fontscale 3.125 linewidth 3.125 pointscale 3.125 enhanced background 'white'\n",
    WIDTH / 25.4 * 300, height / 25.4 * 300);
  stic_outfile_print(out, "data = '%s.dat'\nset output '%s.'.format\n", stem, stem);
  stic_outfile_print(
    out,
    "small = format eq 'svg' ? ',9.3' : ',7'\nset encoding utf8\nset border 3 lw 0.6 lc rgb '#333333'\nset tics nomirror out scale 0.4 font small\n"
    "set xtics offset 0,0.45\nset ytics offset 0.5,0\nset grid lw 0.4 lc rgb '#dddddd' lt 1\nunset key\n"
    "set lmargin at screen %.5f\nset rmargin at screen %.5f\nset y2range [0:1]\n",
    LEFT / WIDTH, 1 - RIGHT / WIDTH);
  /* Told apart in grey print and by every kind of colour blindness: by dash and width as well as by colour. */
  stic_outfile_print(out, "set linetype 1 lc rgb '#008a64' lw 1 dt (6,3)\n"
                          "set linetype 2 lc rgb '#1f3850' lw 1.5 dt 1\n"
                          "set linetype 3 lc rgb '#0067a5' lw 0.9 dt 1\n"
                          "set linetype 4 lc rgb '#d55e00' lw 1.8 dt 1\n"
                          "set linetype 5 lc rgb '#333333' lw 0.8 dt (6,3)\n"
                          "set linetype 6 lc rgb '#333333' lw 0.8 dt (1.5,2.5)\n"
                          "set linetype 7 lc rgb '#111111' lw 0.7 dt 1\n"
                          "set linetype 8 lc rgb '#d55e00' lw 0.8 pt 6 ps 0.4\n"
                          "set multiplot\n");
}

static void place(const stic_figure *f, double from_bottom, double height, stic_outfile *out)
{
  stic_outfile_print(out, "set bmargin at screen %.5f\nset tmargin at screen %.5f\n",
                     from_bottom / height_of(f), (from_bottom + height) / height_of(f));
}

/* Low and high of a quantity of both hand and object. */
static void range_of(const stic_figure *f, quantity of, double range[2])
{
  range[0] = INFINITY;
  range[1] = -INFINITY;
  for (int64_t i = 0; i < row_count(f); i++) {
    for (int who = BLOCK_HAND; who <= BLOCK_OBJECT; who++) {
      const double v = of(f, row_at(f, i), who);

      range[0] = fmin(range[0], v);
      range[1] = fmax(range[1], v);
    }
  }
}

/* By a part of itself, but so far that its numbers need no more digits than there is room for. */
static void widen(double range[2], double part, double least)
{
  const double size = fmax(fabs(range[0]), fabs(range[1])), span = range[1] - range[0];
  const double more = span > 0 ? fmax(part * span, fmax(least, 1e-4 * size)) : fmax(0.05 * size, 1e-3);

  range[0] -= more;
  range[1] += more;
}

static void set_range(const char *axis, const double range[2], stic_outfile *out)
{
  stic_outfile_print(out, "set %srange [%.9g:%.9g]\n", axis, range[0], range[1]);
}

/* Round numbers on an axis, about `most` of them. */
static void set_tics(const char *axis, const double range[2], int most, stic_outfile *out)
{
  const double rough = (range[1] - range[0]) / most, decade = pow(10, floor(log10(rough)));
  const double step = decade * (rough > 5 * decade ? 10 : rough > 2 * decade ? 5 : rough > decade ? 2 : 1);

  stic_outfile_print(out, "set %stics %.9g\n", axis, step);
}

/* How curves are drawn: a line through one point is not to be seen. */
static const char *curves(const stic_figure *f)
{
  return row_count(f) > 1 ? "lines" : "points pt 7 ps 0.5";
}

/* Names of axes and entries of the key stand at fixed places, whatever the numbers need. */
static void axis_name(const stic_figure *f, const char *text, double x, double y, bool upright,
                      stic_outfile *out)
{
  stic_outfile_print(out, "set label '%s' at screen %.5f,%.5f center %s\n", text, x / WIDTH, y / height_of(f),
                     upright ? "rotate" : "");
}

static void key_line(const stic_figure *f, double x, int line, int linetype, const char *text,
                     stic_outfile *out)
{
  const double y = 1 - (KEY_TOP + line * KEY_LINE - 0.9) / height_of(f);

  stic_outfile_print(
    out,
    "set arrow from screen %.5f,%.5f to screen %.5f,%.5f nohead lt %d\nset label '%s' at screen %.5f,%.5f\n",
    x / WIDTH, y, (x + 7) / WIDTH, y, linetype, text, (x + 8) / WIDTH, y);
}

static void key_slip(const stic_figure *f, double x, int line, stic_outfile *out)
{
  const double y = 1 - (KEY_TOP + line * KEY_LINE - 0.9) / height_of(f), half = 0.9 / height_of(f);

  stic_outfile_print(
    out,
    "set arrow from screen %.5f,%.5f to screen %.5f,%.5f nohead lt 7\nset label 'slip' at screen %.5f,%.5f\n",
    x / WIDTH, y - half, x / WIDTH, y + half, (x + 1.2) / WIDTH, y);
}

/* What stands on the page once is drawn with the first panel and then forgotten. */
static void forget(stic_outfile *out)
{
  stic_outfile_print(out, "unset label\nunset arrow\n");
}

/* The plane with one scale for x and y, unless that would leave a line. */
static void script_plane(const stic_figure *f, double bottom, stic_outfile *out)
{
  const double panel = (WIDTH - LEFT - RIGHT) / PLANE;
  double x[2], y[2], wide, high;

  range_of(f, x_of, x);
  range_of(f, y_of, y);
  widen(x, 0.04, 1e-6);
  widen(y, 0.06, 1e-6);
  wide = x[1] - x[0];
  high = y[1] - y[0];
  if (wide < 6 * panel * high && high < 6 * wide / panel) {
    widen(x, 0, fmax(0, (panel * high - wide) / 2));
    widen(y, 0, fmax(0, (wide / panel - high) / 2));
  }
  place(f, bottom, PLANE, out);
  set_range("x", x, out);
  set_range("y", y, out);
  set_tics("x", x, 6, out);
  set_tics("y", y, 5, out);
  axis_name(f, "x / m", LEFT + (WIDTH - LEFT - RIGHT) / 2, bottom - 6.6, false, out);
  axis_name(f, "y / m", 2.2, bottom + PLANE / 2, true, out);
  key_line(f, LEFT, 0, 1, "hand", out);
  key_line(f, LEFT + 17, 0, 2, "object", out);
  key_slip(f, LEFT + 64, 0, out);
  stic_outfile_print(
    out, "set label '' at screen %.5f,%.5f point lt 8\nset label 'rest after a slip' at screen %.5f,%.5f\n",
    (LEFT + 37.5) / WIDTH, 1 - (KEY_TOP - 0.9) / height_of(f), (LEFT + 39.5) / WIDTH,
    1 - (KEY_TOP - 0.9) / height_of(f));
  stic_outfile_print(
    out,
    "set format x '%%g'\n"
    "plot data index %d using 2:3 with %s lt 1 title 'hand', data index %d using 2:3 with %s lt 2 title 'object', "
    "data index %d using 1:2 with points lt 8 title 'rest after a slip'\n",
    BLOCK_HAND, curves(f), BLOCK_OBJECT, curves(f), BLOCK_LANDINGS);
  forget(out);
}

/* Of the time axis, s; a single row has a second of its own. */
static double end_of(const stic_figure *f)
{
  return row_count(f) > 1 ? row_at(f, row_count(f) - 1)->t : row_at(f, 0)->t + 1;
}

static void time_axis(const stic_figure *f, stic_outfile *out)
{
  const double t[2] = {row_at(f, 0)->t, end_of(f)};

  set_range("x", t, out);
  set_tics("x", t, 7, out);
  stic_outfile_print(out, "set format x ''\n");
}

#define SLIP_MARKS "data index 0 using 1:(0.92):(0):(0.08) axes x1y2 with vectors nohead lt 7 title 'slips'"

static void script_time_panel(const stic_figure *f, double bottom, const char *label, int column, quantity of,
                              double least, stic_outfile *out)
{
  double range[2];

  range_of(f, of, range);
  widen(range, 0.06, least);
  range[1] += 0.1 * (range[1] - range[0]); /* room for the marks */
  place(f, bottom, TIME_PANEL, out);
  set_range("y", range, out);
  set_tics("y", range, 4, out);
  axis_name(f, label, 2.2, bottom + TIME_PANEL / 2, true, out);
  stic_outfile_print(
    out,
    "plot data index %d using 1:%d with %s lt 1 title 'hand', data index %d using 1:%d with %s lt 2 title 'object', " SLIP_MARKS
    "\n",
    BLOCK_HAND, column, curves(f), BLOCK_OBJECT, column, curves(f));
  forget(out);
}

/* Low and high of what a panel of forces shows. */
static void force_range(const stic_figure *f, int n, double mu, double range[2])
{
  range[0] = range[1] = 0;
  for (int64_t i = 0; i < row_count(f); i++) {
    const double normal = normal_of(f, row_at(f, i), n), friction = friction_of(f, row_at(f, i), n);

    if (isnan(normal))
      continue;
    range[0] = fmin(range[0], fmin(friction, -mu * normal));
    range[1] = fmax(range[1], fmax(fmax(normal, friction), mu * normal));
  }
  widen(range, 0.06, 1e-9);
  range[1] += 0.08 * (range[1] - range[0]);
}

static void force_key(const stic_figure *f, stic_outfile *out)
{
  key_line(f, LEFT, 0, 3, "normal force N", out);
  key_line(f, LEFT + 36, 0, 4, "friction T", out);
  key_slip(f, LEFT + 64, 0, out);
  if (!f->plot->has_scene)
    return;
  key_line(f, LEFT, 1, 5, "±μ_s N (static)", out);
  key_line(f, LEFT + 36, 1, 6, "±μ_d N (dynamic)", out);
}

static void script_force_panel(const stic_figure *f, double bottom, int n, stic_outfile *out)
{
  const int index = f->plot->surfaces[n], block = BLOCK_FORCES + n;
  const bool limits = f->plot->has_scene && index < f->plot->scene_count;
  const stic_friction mu = limits ? f->plot->scene[index].friction : (stic_friction){0, 0};
  char name[STIC_NAME_MAX], text[2 * STIC_NAME_MAX];
  double range[2];

  surface_name(f, n, name, sizeof name);
  quoted(name, text, sizeof text);
  force_range(f, n, mu.mu_static, range);
  place(f, bottom, FORCE_PANEL, out);
  set_range("y", range, out);
  set_tics("y", range, 6, out);
  axis_name(f, "force / N", 2.2, bottom + FORCE_PANEL / 2, true, out);
  stic_outfile_print(out, "set label '%s' at graph 0.02,0.86 noenhanced front\n", text);
  if (n == 0)
    force_key(f, out);
  stic_outfile_print(out, "mu_s = %.9g; mu_d = %.9g\nplot ", mu.mu_static, mu.mu_dynamic);
  if (limits)
    stic_outfile_print(out,
                       "data index %d using 1:(mu_s*$2) with lines lt 5 title 'static limit', "
                       "data index %d using 1:(-mu_s*$2) with lines lt 5 title 'static limit', "
                       "data index %d using 1:(mu_d*$2) with lines lt 6 title 'dynamic limit', "
                       "data index %d using 1:(-mu_d*$2) with lines lt 6 title 'dynamic limit', ",
                       block, block, block, block);
  stic_outfile_print(out,
                     "data index %d using 1:2 with %s lt 3 title 'normal force', "
                     "data index %d using 1:3 with %s lt 4 title 'friction', " SLIP_MARKS "\n",
                     block, curves(f), block, curves(f));
  forget(out);
}

/* Rows of one state as grey boxes with names where they fit. */
static void script_states(const stic_figure *f, stic_outfile *out)
{
  static const int grey[] = {0xd0, 0xf0, 0xd9, 0xc4, 0xb2, 0xa0, 0x8c};
  const double span = end_of(f) - row_at(f, 0)->t;
  int64_t start = 0;
  int number = 1;

  place(f, BOTTOM, STRIP, out);
  stic_outfile_print(
    out,
    "set yrange [0:1]\nunset ytics\nunset grid\nset border 1 lw 0.6 lc rgb '#333333'\nset format x '%%g'\n");
  axis_name(f, "time / s", LEFT + (WIDTH - LEFT - RIGHT) / 2, 1.8, false, out);
  axis_name(f, "state", LEFT / 2 + 1, BOTTOM + STRIP / 2, false, out);
  for (int64_t i = 1; i <= row_count(f); i++) {
    const int state = row_at(f, start)->state;
    const double from = row_at(f, start)->t, to = i < row_count(f) ? row_at(f, i)->t : end_of(f);

    if (i < row_count(f) && row_at(f, i)->state == state)
      continue;
    /* Boxes too thin to print would only swell the file. */
    if (to - from > span / 1000)
      stic_outfile_print(
        out,
        "set object %d rectangle from %.9g,0 to %.9g,1 fs solid noborder fc rgb '#%02x%02x%02x' behind\n",
        number++, from, to, grey[state], grey[state], grey[state]);
    if (to - from > STATE_LABEL_MIN * span)
      stic_outfile_print(out, "set label '%s' at %.9g,0.5 center\n", stic_state_name((stic_state)state),
                         (from + to) / 2);
    start = i;
  }
  stic_outfile_print(out, "plot NaN notitle\n");
}

static void script_trajectories(const stic_figure *f, stic_outfile *out)
{
  double bottom = BOTTOM + STRIP + GAP;

  script_plane(f, bottom + 3 * (TIME_PANEL + GAP) + PLANE_FOOT - GAP, out);
  time_axis(f, out);
  script_time_panel(f, bottom + 2 * (TIME_PANEL + GAP), "x / m", 2, x_of, 1e-6, out);
  script_time_panel(f, bottom + TIME_PANEL + GAP, "y / m", 3, y_of, 1e-6, out);
  script_time_panel(f, bottom, "angle / °", 4, angle_of, 1e-3, out);
}

static void script_forces(const stic_figure *f, stic_outfile *out)
{
  time_axis(f, out);
  for (int n = 0; n < f->plot->surface_count; n++)
    script_force_panel(f, BOTTOM + STRIP + GAP + (f->plot->surface_count - 1 - n) * (FORCE_PANEL + GAP), n,
                       out);
}

void stic_figure_script(const stic_figure *f, stic_outfile *out)
{
  script_head(f, out);
  if (shows_forces(f))
    script_forces(f, out);
  else
    script_trajectories(f, out);
  script_states(f, out);
  stic_outfile_print(out, "unset multiplot\nset output\n");
}

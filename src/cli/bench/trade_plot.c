/* The work-precision diagram of `stiction bench trade`, by gnuplot. */
#include "../../error.h"
#include "trade.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static const char *const LEVEL_LABELS[STIC_TRADE_LEVELS] = {"frame", "",   "4", "",    "16",
                                                            "",      "64", "",  "256", "event"};
static const char *const PRECISIONS[3] = {"f32", "f64", "f80"};
static const char *const COLOURS[3] = {"#d9772b", "#1f5fa8", "#7a7f87"};

/* For gnuplot's single quotes. */
static void print_quoted(FILE *script, const char *text)
{
  fputc('\'', script);
  for (; *text; text++) {
    if (*text == '\'')
      fputc('\'', script);
    fputc(*text >= 0 && *text < ' ' ? '?' : *text, script);
  }
  fputc('\'', script);
}

static void print_data(FILE *script, const stic_trade_panel *panel, int index)
{
  for (int p = 0; p < 3; p++) {
    fprintf(script, "$d%d_%d << EOD\n", index, p);
    for (int l = 0; l < STIC_TRADE_LEVELS && panel->has[p]; l++)
      fprintf(script, "%.9g %.9g %.9g \"%s\" %d\n", panel->points[p][l].error, panel->points[p][l].cost,
              panel->points[p][l].p99, LEVEL_LABELS[l], l == STIC_TRADE_LEVELS - 1);
    fprintf(script, "EOD\n");
  }
}

static void print_range(FILE *script, const stic_trade_panel *panel)
{
  double low = INFINITY, high = 0;

  for (int p = 0; p < 3; p++)
    for (int l = 0; l < STIC_TRADE_LEVELS && panel->has[p]; l++) {
      low = fmin(low, panel->points[p][l].cost);
      high = fmax(high, panel->points[p][l].cost);
    }
  fprintf(script, "set yrange [%g:%g]\n", low / 2, high * 2.5);
}

static void print_panel(FILE *script, const stic_trade_panel *panel, int index)
{
  const char *separator = "plot";

  fprintf(script, "set title ");
  print_quoted(script, panel->title);
  fprintf(script, " font ',13' textcolor rgb '#222222' noenhanced\n");
  print_range(script, panel);
  for (int p = 0; p < 3; p++) {
    if (!panel->has[p])
      continue;
    /* The ladder from frame to substep=256 as a line of dots, event as a diamond with a line up to its p99. */
    fprintf(script,
            "%s $d%d_%d using 1:($5==0?$2:1/0) with linespoints pt 7 ps 0.7 lw 1.6 lc rgb '%s' title '%s'",
            separator, index, p, COLOURS[p], PRECISIONS[p]);
    fprintf(script, ", '' using 1:($5==1?$2:1/0):2:3 with yerrorbars pt -1 lw 1 lc rgb '%s' notitle",
            COLOURS[p]);
    fprintf(script, ", '' using 1:($5==1?$2:1/0) with points pt 13 ps 2.2 lc rgb '%s' notitle", COLOURS[p]);
    if (p == 1)
      fprintf(script,
              ", '' using 1:($5==1?$2:1/0):4 with labels offset 0,-1.2 font ',10' tc rgb '%s' notitle"
              ", '' using 1:($5==0?$2:1/0):4 with labels left offset 1,-0.2 font ',10' tc rgb '%s' notitle",
              COLOURS[p], COLOURS[p]);
    separator = ",";
  }
  fprintf(script, "\n");
}

static void print_picture(FILE *script, const char *terminal, const char *path,
                          const stic_trade_panel *panels, int count)
{
  const int columns = count > 4 ? 3 : count > 1 ? 2 : 1, rows = (count + columns - 1) / columns;
  const bool png = strcmp(terminal, "pngcairo") == 0;

  fprintf(script, "set terminal %s size %d,%d font 'DejaVu Sans,11' background rgb '#ffffff'%s\nset output ",
          terminal, columns == 1 ? 860 : 700 * columns, columns == 1 ? 620 : 80 + 480 * rows,
          png ? "" : " enhanced");
  print_quoted(script, path);
  fprintf(
    script,
    "\nset multiplot layout %d,%d title 'What accuracy costs: dots frame, substep=2 ... 256; diamonds event' font ',16'\n",
    rows, columns);
  for (int i = 0; i < count; i++)
    print_panel(script, &panels[i], i);
  fprintf(script, "unset multiplot\nunset output\n");
}

static void print_script(FILE *script, const char *png, const char *svg, const stic_trade_panel *panels,
                         int count)
{
  for (int i = 0; i < count; i++)
    print_data(script, &panels[i], i);
  fprintf(
    script,
    "set logscale xy\nset format x '10^{%%T}'\nset format y '10^{%%T}'\n"
    "set xrange [1e-20:100]\nset xtics 1e-20,1e4,1\nset mxtics 1\n"
    "set xlabel 'position error, rms, of the object''s size'\nset ylabel 'cost of a frame, ns (median; event: line to p99)'\n"
    "set border 3 lc rgb '#888888'\nset tics nomirror tc rgb '#444444'\n"
    "set grid xtics ytics lc rgb '#e4e4e4' lw 1 lt 1\n"
    "set key top left horizontal samplen 1.5 noenhanced\n"
    "set arrow 1 from 1e-6, graph 0 to 1e-6, graph 0.88 nohead dt 3 lc rgb '#999999'\n"
    "set label 1 'a millionth' at 1e-6, graph 0.91 center font ',9' tc rgb '#777777'\n"
    "set bmargin 4\nset tmargin 3\nset lmargin 9\n");
  print_picture(script, "pngcairo", png, panels, count);
  print_picture(script, "svg", svg, panels, count);
}

static stic_status refuse(const char *path, const char *why, stic_error *err)
{
  return stic_error_set(err, STIC_CANNOT_WRITE, NULL, 0, "cannot draw '%.200s': %s", path, why);
}

stic_status stic_trade_plot(const char *path, const stic_trade_panel *panels, int count, stic_error *err)
{
  static const char *const endings[2] = {"png", "svg"};
  char made[2][1100], wanted[2][1100];
  FILE *script;
  int status;

  if (strlen(path) > 1000)
    return refuse(path, "the name is too long", err);
  for (int i = 0; i < 2; i++) {
    snprintf(wanted[i], sizeof wanted[i], "%s.%s", path, endings[i]);
    snprintf(made[i], sizeof made[i], "%s.%s.part", path, endings[i]);
  }
  script = popen("gnuplot", "w"); /* NOLINT(cert-env33-c): a fixed command */
  if (!script)
    return refuse(path, strerror(errno), err);
  print_script(script, made[0], made[1], panels, count);
  status = pclose(script);
  for (int i = 0; i < 2; i++)
    if (status == 0 && rename(made[i], wanted[i]) != 0)
      status = -1;
  if (status == 0)
    return STIC_OK;
  unlink(made[0]);
  unlink(made[1]);
  return refuse(path,
                status > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 127 ? "gnuplot is not installed"
                                                                              : "gnuplot failed, see above",
                err);
}

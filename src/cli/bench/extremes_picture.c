/* The heat maps of `stiction bench extremes`, by gnuplot. */
#include "extremes.h"

#include "../../error.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define NOT_THERE 127 /* as a shell says it */

static double exponent_of(double x)
{
  return x > 0 ? log10(x) : -1; /* "none" stands left of one */
}

/* Blocks of one a each, as gnuplot wants a matrix of points. */
static void print_data(FILE *script, const stic_heat_map *map, int index)
{
  fprintf(script, "$d%d << EOD\n", index);
  for (int i = 0; i < map->count; i++)
    fprintf(script, "%.6g %.6g %.6g\n", exponent_of(map->points[i].a), exponent_of(map->points[i].b),
            isnan(map->points[i].digits) ? -1 : map->points[i].digits); /* gnuplot drops lines with a NaN */
  fprintf(script, "EOD\n");
}

/* The least step between two values of an axis: the size of a cell, also where a quick run leaves cases out. */
static double cell(const stic_heat_map *map, bool of_a)
{
  double least = INFINITY;

  for (int i = 1; i < map->count; i++) {
    for (int j = 0; j < i; j++) {
      const stic_heat_point *p = &map->points[i], *q = &map->points[j];
      const double step = fabs(exponent_of(of_a ? p->a : p->b) - exponent_of(of_a ? q->a : q->b));

      if (step > 1e-9)
        least = fmin(least, step);
    }
  }
  return isfinite(least) ? least : 1;
}

static void print_map(FILE *script, const stic_heat_map *map, int index)
{
  const double width = cell(map, true) / 2, height = cell(map, false) / 2;

  fprintf(script, "set title '%s' font ',14' tc rgb '#222222' noenhanced\n", map->title);
  fprintf(script, "set xlabel '%s' noenhanced\nset ylabel '%s' noenhanced\n", map->label_a, map->label_b);
  fprintf(script,
          "plot $d%d using 1:2:($1-%g):($1+%g):($2-%g):($2+%g):($3<0?NaN:$3) with boxxyerror fs solid 1 "
          "noborder lc palette notitle, '' using ($3<0?$1:NaN):2 with points pt 2 ps 1 lc rgb '#888888' "
          "notitle\n",
          index, width, width, height, height);
}

static void print_script(FILE *script, const char *png, const stic_heat_map *maps, int count, int columns)
{
  int filled = 0;

  for (int i = 0; i < count; i++)
    filled += maps[i].count > 0;
  const int rows = (filled + columns - 1) / columns;

  for (int i = 0; i < count; i++)
    print_data(script, &maps[i], i);
  fprintf(
    script,
    "set terminal pngcairo size %d,%d font 'DejaVu Sans,11' background rgb '#ffffff'\nset output '%s'\n",
    560 * columns, 90 + 470 * rows, png);
  /* Even steps of lightness: readable in grey and by the colour-blind. */
  fprintf(
    script,
    "set palette defined (0 '#fde725', 3 '#b5de2b', 6 '#35b779', 9 '#26828e', 12 '#3e4989', 16 '#440154')\n"
    "set cbrange [0:16]\nset cbtics 2 tc rgb '#444444'\nset cblabel 'digits of the balance'\n"
    "set colorbox noborder\nset format x '10^{%%.0f}'\nset format y '10^{%%.0f}'\n"
    "set xtics 3 nomirror tc rgb '#444444'\nset ytics 3 nomirror tc rgb '#444444'\n"
    "set border 3 lc rgb '#888888'\nset autoscale xfix\nset autoscale yfix\nset offsets 0.6,0.6,0.6,0.6\n");
  fprintf(script,
          "set multiplot layout %d,%d title 'Digits to which force and moment balance in the worst row; "
          "crosses: refused, or no row has an answer' font ',16' noenhanced\n",
          rows, columns);
  for (int i = 0; i < count; i++)
    if (maps[i].count > 0)
      print_map(script, &maps[i], i);
  fprintf(script, "unset multiplot\nunset output\n");
}

static stic_status refuse(const char *path, const char *why, stic_error *err)
{
  return stic_error_set(err, STIC_CANNOT_WRITE, path, 0, "cannot draw the heat maps: %s", why);
}

stic_status stic_heat_picture(const char *path, const stic_heat_map *maps, int count, int columns,
                              stic_error *err)
{
  char made[1100];
  FILE *script;
  int status;

  if (strlen(path) > 1000 || strchr(path, '\''))
    return refuse(path, "its name is too long or has a quote", err);
  snprintf(made, sizeof made, "%s.part", path);
  script = popen("gnuplot -d", "w"); /* NOLINT(cert-env33-c): a fixed command */
  if (!script)
    return refuse(path, strerror(errno), err);
  print_script(script, made, maps, count, columns);
  status = pclose(script);
  if (status == 0 && rename(made, path) == 0)
    return STIC_OK;
  unlink(made);
  return refuse(path,
                status > 0 && WIFEXITED(status) && WEXITSTATUS(status) == NOT_THERE
                  ? "gnuplot is not installed; the package is gnuplot-nox"
                  : "gnuplot failed, see above",
                err);
}

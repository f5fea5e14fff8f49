/* stiction plot: figures 9 to 12 of the paper from a log. */
#include "../error.h"
#include "../number.h"
#include "cli.h"
#include "plot.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define OVERRIDES_MAX 64 /* as many as a log's reader keeps */

static const stic_cli_usage usage = {
  "plot", "[OPTION...] LOG",
  "Draws figures of the paper from a log ('-': standard input), with gnuplot, and prints their names:\n"
  "  9, 11   trajectories of hand and object: in the plane, and x, y and angle over time\n"
  "  10, 12  normal and friction force of each surface over time, with the friction limits\n"
  "9 and 10 show the stretch of single-vertex contact, 11 and 12 that of two-vertex contact; a log without\n"
  "such contact is shown whole. --out FILE.svg, .pdf or .png makes one figure, --out DIR all of them.\n"
  "The object is shown at the point where it is held, so that the spring's stretch is what is between its\n"
  "curve and the hand's. Friction limits and holding point come from --scene, else from the scene that the\n"
  "log names, with its overrides; without either, limits are left out and the object's origin is shown.\n",
  1, 1};

/* Command-line values. */
typedef struct plot_options {
  char *out, *figure, *format, *scene, *from, *to;
  int keep;
} plot_options;

typedef struct plot_run {
  const plot_options *options;
  stic_plot *plot;
  stic_plot_settings settings;
  bool figures[STIC_FIGURE_LAST + 1];
  bool chosen; /* by --figure, and not "all" */
} plot_run;

static stic_status parse_figure(plot_run *r, stic_error *err)
{
  const char *text = r->options->figure;
  int64_t number = 0;

  r->chosen = text && strcmp(text, "all") != 0;
  if (r->chosen && stic_number_parse_integer(text, strlen(text), STIC_FIGURE_FIRST, STIC_FIGURE_LAST,
                                             &number) != STIC_NUMBER_OK)
    return stic_error_set(err, STIC_USAGE, NULL, 0, "--figure %.40s: expected 9, 10, 11, 12 or all", text);
  if (r->chosen)
    r->figures[number] = true;
  return STIC_OK;
}

static stic_status parse_seconds(const char *option, const char *text, double *value, stic_error *err)
{
  if (text && stic_number_parse(text, strlen(text), value) != STIC_NUMBER_OK)
    return stic_error_set(err, STIC_USAGE, NULL, 0, "--%s %.40s: expected seconds", option, text);
  return STIC_OK;
}

static stic_status parse_stretch(plot_run *r, stic_error *err)
{
  const plot_options *o = r->options;
  stic_status status;

  r->settings.from = o->to ? -STIC_PLOT_EVER : 1;
  r->settings.to = o->from ? STIC_PLOT_EVER : 0;
  status = parse_seconds("from", o->from, &r->settings.from, err);
  if (status == STIC_OK)
    status = parse_seconds("to", o->to, &r->settings.to, err);
  if (status == STIC_OK && (o->from || o->to) && r->settings.from > r->settings.to)
    status = stic_error_set(err, STIC_USAGE, NULL, 0,
                            "--from %.40s --to %.40s: expected an earlier time first", o->from, o->to);
  return status;
}

/* Without --figure all that the log has something to show for. */
static void choose_figures(plot_run *r)
{
  bool any = r->chosen;

  for (int i = STIC_FIGURE_FIRST; !r->chosen && i <= STIC_FIGURE_LAST; i++)
    any |= r->figures[i] = stic_plot_has_state(r->plot, i);
  if (!any) {
    r->figures[9] = true;
    r->figures[10] = stic_plot_has_forces(r->plot);
  }
  for (int i = STIC_FIGURE_FIRST; i <= STIC_FIGURE_LAST; i++) {
    if (r->figures[i] && !stic_plot_has_state(r->plot, i) && r->settings.from > r->settings.to)
      stic_cli_say("the log has no %s contact: figure %d shows all of it",
                   i <= 10 ? "single-vertex" : "two-vertex", i);
  }
}

/* Reads the scene that the log names, with the overrides that it names. */
static bool read_named_scene(const plot_run *r, stic_scene *scene)
{
  stic_override *overrides = NULL;
  char *set[OVERRIDES_MAX + 1] = {NULL};
  int count = 0, n = 0;
  bool good;

  while (n < OVERRIDES_MAX && *stic_plot_provenance(r->plot, "set", n)) {
    const char *text = stic_plot_provenance(r->plot, "set", n);

    set[n] = malloc(strlen(text) + 1);
    if (!set[n])
      break;
    strcpy(set[n++], text);
  }
  good = stic_cli_overrides(set, &overrides, &count, NULL) == STIC_OK &&
         stic_scene_read(stic_plot_provenance(r->plot, "scene", 0), overrides, count, scene, NULL) == STIC_OK;
  while (n > 0)
    free(set[--n]);
  free(overrides);
  return good;
}

/* Names and friction of the surfaces. A log that names no readable scene is no fault: limits are left out. */
static stic_status find_friction(plot_run *r, stic_error *err)
{
  const char *named = stic_plot_provenance(r->plot, "scene", 0);
  stic_scene *scene = malloc(sizeof *scene);
  stic_status status = STIC_OK;

  if (!scene)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  if (r->options->scene)
    status = stic_scene_read(r->options->scene, NULL, 0, scene, err);
  if (status == STIC_OK && (r->options->scene || (*named && read_named_scene(r, scene))))
    stic_plot_set_scene(r->plot, scene);
  else if (status == STIC_OK)
    stic_cli_say(
      "friction limits are left out, and the object is shown by its origin: the scene '%s' that the log names cannot be read; --scene SCENE gives them",
      named);
  free(scene);
  return status;
}

static bool has_ending(const char *path)
{
  const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');

  return dot && (strcmp(dot, ".svg") == 0 || strcmp(dot, ".pdf") == 0 || strcmp(dot, ".png") == 0);
}

static int draw(plot_run *r, int figure, const char *path, stic_error *err)
{
  r->settings.figure = figure;
  if (stic_plot_draw(r->plot, &r->settings, path, err) != STIC_OK)
    return stic_cli_signal() != 0 ? STIC_EXIT_SIGNAL + stic_cli_signal() : stic_cli_fail(err);
  printf("%s\n", path);
  return STIC_OK;
}

static int draw_one(plot_run *r, const char *path, stic_error *err)
{
  int figure = STIC_FIGURE_FIRST;

  while (!r->figures[figure])
    figure++;
  return draw(r, figure, path, err);
}

static int draw_into(plot_run *r, const char *folder, stic_error *err)
{
  static const char *const formats[] = {"svg", "pdf", "png"};
  const char *only = r->options->format;
  char path[4096];
  const bool made = mkdir(folder, 0777) == 0;
  int code = STIC_OK;

  if (!made && errno != EEXIST) {
    stic_error_set(err, STIC_CANNOT_WRITE, folder, 0, "cannot make the folder: %s", strerror(errno));
    return stic_cli_fail(err);
  }
  for (int i = STIC_FIGURE_FIRST; i <= STIC_FIGURE_LAST; i++) {
    for (int k = 0; r->figures[i] && k < 3 && code == STIC_OK && stic_cli_signal() == 0; k++) {
      if (only && strcmp(only, formats[k]) != 0)
        continue;
      snprintf(path, sizeof path, "%.4000s/figure-%d.%s", folder, i, formats[k]);
      code = draw(r, i, path, err);
    }
  }
  if (made)
    rmdir(folder); /* if it is still empty */
  return code == STIC_OK && stic_cli_signal() != 0 ? STIC_EXIT_SIGNAL + stic_cli_signal() : code;
}

/* What --out is, and whether the other options go with it. */
static stic_status check_kind(const plot_run *r, const char *out, stic_error *err)
{
  const char *format = r->options->format;

  if (format && strcmp(format, "svg") != 0 && strcmp(format, "pdf") != 0 && strcmp(format, "png") != 0)
    return stic_error_set(err, STIC_USAGE, NULL, 0, "--format %.40s: expected svg, pdf or png", format);
  if (has_ending(out) && format)
    return stic_error_set(
      err, STIC_USAGE, NULL, 0,
      "--out %.200s is one picture, of the format that its name says; --format is for a folder", out);
  if (has_ending(out) && !r->chosen)
    return stic_error_set(err, STIC_USAGE, NULL, 0,
                          "--out %.200s is one picture; expected --figure 9, 10, 11 or 12 with it", out);
  return STIC_OK;
}

static int plot_log(plot_run *r, const char *log, stic_error *err)
{
  const char *out = r->options->out ? r->options->out : "plots";

  if (parse_figure(r, err) != STIC_OK || check_kind(r, out, err) != STIC_OK ||
      parse_stretch(r, err) != STIC_OK || stic_cli_check_paths(&log, 1, &out, 1, err) != STIC_OK ||
      stic_plot_read(log, &r->plot, err) != STIC_OK || find_friction(r, err) != STIC_OK)
    return stic_cli_fail(err);
  if (stic_plot_is_cut(r->plot))
    stic_cli_say("rows with more than four contacts show the forces of the four that the log lists");
  choose_figures(r);
  return has_ending(out) ? draw_one(r, out, err) : draw_into(r, out, err);
}

int stic_cmd_plot(int argc, const char **argv)
{
  plot_options o = {NULL, NULL, NULL, NULL, NULL, NULL, 0};
  const struct poptOption table[] = {
    {"out", 'o', POPT_ARG_STRING, &o.out, 0, "A picture, or a folder for all of them (default: plots)",
     "FILE|DIR"},
    {"figure", '\0', POPT_ARG_STRING, &o.figure, 0,
     "9, 10, 11, 12 or all (default): those that the log has contact for", "N"},
    {"format", '\0', POPT_ARG_STRING, &o.format, 0, "svg, pdf or png, for a folder (default: all three)",
     "NAME"},
    {"scene", '\0', POPT_ARG_STRING, &o.scene, 0, "Scene with the friction of the run", "SCENE"},
    {"from", '\0', POPT_ARG_STRING, &o.from, 0, "Show the log from this time on", "SECONDS"},
    {"to", '\0', POPT_ARG_STRING, &o.to, 0, "Show the log up to this time", "SECONDS"},
    {"keep", '\0', POPT_ARG_NONE, &o.keep, 0, "Leave gnuplot's script and data beside the pictures", NULL},
    POPT_TABLEEND};
  plot_run r = {.options = &o};
  stic_cli_args args;
  stic_error err;
  int code = stic_cli_parse(&usage, table, argc, argv, &args);

  if (code < 0) {
    r.settings.keep = o.keep != 0;
    code = plot_log(&r, args.positions[0], &err);
  }
  stic_plot_destroy(r.plot);
  stic_cli_args_free(&args);
  free(o.out);
  free(o.figure);
  free(o.format);
  free(o.scene);
  free(o.from);
  free(o.to);
  return code;
}

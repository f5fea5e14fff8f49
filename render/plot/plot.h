/* Figures 9 to 12 of the paper from a log: trajectories of hand and object (9, 11), normal and friction
 * forces (10, 12); 9 and 10 of the single-vertex state, 11 and 12 of the two-vertex state. Drawn by gnuplot
 * from a script and a data file, which can be kept. */
#ifndef STIC_PLOT_H
#define STIC_PLOT_H

#include "../../src/stiction.h"

#define STIC_FIGURE_FIRST 9
#define STIC_FIGURE_LAST 12

/* A log that was read. Opaque. */
typedef struct stic_plot stic_plot;

/* Reads a log whole ("-": standard input). The caller owns `*plot`. Errors: STIC_BAD_INPUT, STIC_NO_MEMORY. */
stic_status stic_plot_read(const char *path, stic_plot **plot, stic_error *err);
void stic_plot_destroy(stic_plot *plot); /* NULL allowed */

/* Value of the n-th provenance line (from 0) of a key in the log, "" if there is none. */
const char *stic_plot_provenance(const stic_plot *plot, const char *key, int n);

/* Takes names and friction of the surfaces, for the friction limits, and the holding point: trajectories are those
 * of the hand and of the point where it holds the object. Without, there are no limits, and the object is shown
 * by its origin. */
void stic_plot_set_scene(stic_plot *plot, const stic_scene *scene);

/* Whether the log has rows of the state that a figure is about; without, the figure shows all of the log. */
bool stic_plot_has_state(const stic_plot *plot, int figure);

/* Whether anything is touched in the log; without, there are no forces to show in figures 10 and 12. */
bool stic_plot_has_forces(const stic_plot *plot);

/* Whether rows have more contacts than a log lists: forces are then those of the listed ones. */
bool stic_plot_is_cut(const stic_plot *plot);

#define STIC_PLOT_EVER 1e300 /* s; as `to`, and negative as `from`: no limit */

/* What to draw. */
typedef struct stic_plot_settings {
  int figure;      /* STIC_FIGURE_FIRST..STIC_FIGURE_LAST */
  double from, to; /* s of the log; from > to: the stretch with the figure's state */
  bool keep;       /* leave script (.gp) and data (.dat) beside the picture */
} stic_plot_settings;

/* Draws a figure into `path`, which ends in .svg, .pdf or .png; it appears whole or not at all. Errors:
 * STIC_USAGE for another ending, for a stretch without rows or without gnuplot; STIC_CANNOT_WRITE;
 * STIC_NO_MEMORY. Real-time: no. */
stic_status stic_plot_draw(const stic_plot *plot, const stic_plot_settings *settings, const char *path,
                           stic_error *err);

#endif

/* The rows of a log that figures need. Internal to the plots. */
#ifndef STIC_PLOT_LOG_H
#define STIC_PLOT_LOG_H

#include "../../src/io/log_csv.h"
#include "plot.h"

#define STIC_PLOT_SURFACES 4 /* that get a panel of forces */

typedef struct stic_plot_row {
  double t, x, y, theta, hand_x, hand_y, hand_theta;
  double normal[STIC_LOG_CONTACTS], friction[STIC_LOG_CONTACTS]; /* NaN: not in contact */
  int64_t slips;
  short surface[STIC_LOG_CONTACTS]; /* -1: none */
  unsigned char state;
} stic_plot_row;

struct stic_plot {
  stic_log_reader *log; /* for its provenance */
  stic_plot_row *rows;
  int64_t count, room;
  bool cut;
  bool has_scene;
  double holding_point[2];          /* where the object is compared with the hand; the origin if not known */
  int surface_count;                /* of those met in the log, up to STIC_PLOT_SURFACES */
  int surfaces[STIC_PLOT_SURFACES]; /* their indices, ascending */
  stic_surface scene[STIC_SURFACES_MAX];
  int scene_count;
};

/* Normal and friction force on the n-th surface met in the log: sums over its vertices, as only the sum of an
 * edge's friction is determined. NaN if the row does not touch it. */
double stic_plot_normal(const stic_plot *plot, const stic_plot_row *row, int n);
double stic_plot_friction(const stic_plot *plot, const stic_plot_row *row, int n);

#endif

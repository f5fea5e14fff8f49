/* Inside of `stiction bench trade`: motions, what a setting makes of them, and how far that is from another. */
#ifndef STIC_TRADE_H
#define STIC_TRADE_H

#include "../../stiction.h"

/* ---- trade_motion.c: a scene and a hand's way through it ------------------------------------ */

typedef struct stic_motion {
  char name[96];
  stic_scene scene;
  stic_sample *samples;
  int count;
} stic_motion;

stic_status stic_motion_read(stic_motion *motion, const char *scene, const char *trace,
                             const stic_override *overrides, int override_count, stic_error *err);
/* A box that is dragged through the corner of floor and wall. */
stic_status stic_motion_built_in(stic_motion *motion, stic_error *err);
/* A hand that presses the scene's object against one surface after the other, and into the corners of neighbours:
 * three times to and fro along each, turning, with a hand's tremor. 31 samples a second. */
stic_status stic_motion_along_surfaces(stic_motion *motion, const stic_scene *scene, int count,
                                       stic_error *err);
/* The same motion at 1000 samples a second, its first minute: a smooth curve through all samples. */
stic_status stic_motion_resample(const stic_motion *from, stic_motion *to, stic_error *err);
void stic_motion_free(stic_motion *motion);

/* ---- what came out of one setting ------------------------------------------------------------ */

typedef struct stic_outcome_row {
  double x, y, theta, force_x, force_y;
} stic_outcome_row;

typedef struct stic_outcome {
  int count; /* of rows */
  stic_outcome_row *rows;
  int64_t *least_ns; /* per row: the fastest of all runs */
  int64_t *sorted;   /* room to sort them */
  int64_t worst_ns;  /* the slowest row of all runs */
  int slip_count, slip_room;
  double *slip_times; /* s */
  int64_t slips;      /* as the log counts them */
  int flagged;        /* rows with a flag of 4 or 8 */
  uint64_t hash;      /* of all rows as a log would have them */
  uint64_t contacts;  /* of the sequence of contact sets */
  uint64_t events;    /* of the sequence of touches, openings, slips and snaps, without their times */
} stic_outcome;

/* Room for that many rows, if there is none yet. On failure the outcome is empty. */
stic_status stic_outcome_reserve(stic_outcome *outcome, int count, stic_error *err);
/* Solves every stride-th sample. A second run into the same outcome adds its times; it must give the same hash
 * (else STIC_FAILED). `stride` 1 times the steps. After an error the outcome is empty. */
stic_status stic_outcome_run(stic_outcome *outcome, const stic_motion *motion, const stic_settings *settings,
                             int stride, stic_error *err);
void stic_outcome_free(stic_outcome *outcome);
/* Sorts `count` > 0 costs and gives the one that `part` (0..1] of all do not exceed. */
int64_t stic_cost_quantile(int64_t *ns, int count, double part);
/* A row's cost that `part` (0..1] of all rows do not exceed. */
int64_t stic_outcome_cost(const stic_outcome *outcome, double part);

/* Of the largest distance of any vertex, the angle, the force (relative to the largest in `reference`). */
typedef struct stic_difference {
  double position_max, position_rms; /* m */
  double angle_max, angle_rms;       /* rad */
  double force_max, force_rms;
  int64_t slips; /* more than the reference has */
  double slip_time,
    slip_time_max; /* s, from each slip to the other's nearest, both ways; NaN: one has none */
} stic_difference;

/* Row i against row i * stride of the reference. */
void stic_outcome_compare(const stic_motion *motion, const stic_outcome *reference, const stic_outcome *got,
                          int stride, stic_difference *d);

/* ---- trade_plot.c ---------------------------------------------------------------------------- */

#define STIC_TRADE_LEVELS 10 /* frame, substep=2 ... 256, event */

typedef struct stic_trade_point {
  double error;     /* rms of position, of the object's size; as drawn, above 0 */
  double cost, p99; /* ns a frame */
} stic_trade_point;

typedef struct stic_trade_panel {
  char title[96];
  stic_trade_point points[3][STIC_TRADE_LEVELS]; /* f32, f64, f80 */
  bool has[3];
} stic_trade_panel;

/* PATH.png and PATH.svg. Errors: STIC_CANNOT_WRITE. */
stic_status stic_trade_plot(const char *path, const stic_trade_panel *panels, int count, stic_error *err);

#endif

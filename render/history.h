/* What pictures remember of the results before: trails, slip marks, curves. Bounded; pure. */
#ifndef STIC_HISTORY_H
#define STIC_HISTORY_H

#include "stiction.h"

#define STIC_TRAIL_MAX 600
#define STIC_SLIPS_MAX 96
#define STIC_CURVE_MAX 1200
#define STIC_CURVE_CONTACTS 4

#define STIC_TRAIL_SECONDS 4.0
#define STIC_CURVE_SECONDS 6.0
#define STIC_SLIP_SHOWN_SECONDS 0.13 /* so long a contact looks slipping, or no eye would see it */

typedef struct stic_trail_point {
  double t;                /* s */
  double hand[3], held[3]; /* m; held is the holding point */
} stic_trail_point;

typedef struct stic_slip {
  double t; /* s */
  int vertex, surface;
  double from[2], to[2]; /* m */
  double z;              /* m, of the object */
} stic_slip;

typedef struct stic_curve_point {
  double t;                                                          /* s */
  double hand[3], held[3];                                           /* x, y (m), angle (rad) */
  int contacts;                                                      /* at most STIC_CURVE_CONTACTS */
  double normal[STIC_CURVE_CONTACTS], friction[STIC_CURVE_CONTACTS]; /* N */
  bool slipped;
} stic_curve_point;

/* Rings: item i of n, oldest first, is items[(first + i) % max]. Start with all zero. */
typedef struct stic_history {
  bool any; /* a result was added */
  stic_result newest;
  double size; /* m, of the object; set by the owner before the first result */
  int trail_first, trail_count;
  stic_trail_point trail[STIC_TRAIL_MAX];
  int slip_first, slip_count;
  stic_slip slips[STIC_SLIPS_MAX];
  int curve_first, curve_count;
  stic_curve_point curve[STIC_CURVE_MAX];
} stic_history;

void stic_history_add(stic_history *history, const stic_result *result);

const stic_trail_point *stic_history_trail(const stic_history *history, int i);
const stic_slip *stic_history_slip(const stic_history *history, int i);
const stic_curve_point *stic_history_curve(const stic_history *history, int i);

/* True if the vertex slid on the surface a moment ago (STIC_SLIP_SHOWN_SECONDS). */
bool stic_history_slipping(const stic_history *history, int vertex, int surface);

#endif

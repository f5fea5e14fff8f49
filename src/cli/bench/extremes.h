/* Inside of `stiction bench extremes`: cases at the ends of every range, and what the solver makes of them. */
#ifndef STIC_EXTREMES_H
#define STIC_EXTREMES_H

#include "../../invariants/checker.h"
#include "../../invariants/wild.h"
#include "../../stiction.h"

/* ---- extremes_cases.c: the sweeps ------------------------------------------------------------ */

typedef struct stic_extreme stic_extreme;

/* Sets the hand of frame `i` >= 0; `last` is the f64 row before it, NULL at the first. */
typedef void stic_extreme_hand(stic_extreme *e, int i, const stic_result *last);

/* One case: a scene and a hand's way through it. */
struct stic_extreme {
  double a, b; /* where in the sweep, by its axes */
  stic_scene scene;
  bool must_refuse; /* no simulation may come to be */
  bool may_refuse;  /* ... or not */
  bool must_stand;  /* rows must stay bit for bit the same from frame `stand_from` on */
  int stand_from;
  int frames;
  double unit;      /* m: lengths of the tour; near the object's size */
  double origin[2]; /* m: the corner of the tour */
  stic_extreme_hand *move;
  double parameter, pinned[2];
  /* the hand */
  double x, y, phi;
  uint32_t buttons;
  wild_case wild;           /* of a random case */
  const stic_sample *given; /* the hand as a trace has it, instead of `move`; NULL: none */
};

typedef struct stic_sweep {
  const char *name, *axis_a, *axis_b;
  int thin; /* in a quick run every thin-th case */
  /* Fills case `index` from 0 on; false past the last. `frames`: length of a long one. */
  bool (*get)(stic_extreme *e, int index, int frames);
} stic_sweep;

extern const stic_sweep stic_sweeps[];
extern const int stic_sweep_count;

/* A random case of tests/statics's kind. */
void stic_extreme_random(stic_extreme *e, uint64_t seed, int64_t number);

/* ---- extremes_dump.c: a case as files ---------------------------------------------------------- */

/* The start angle that a scene file can say. */
void stic_extreme_canonical(stic_scene *scene);

/* FOLDER/scene.yaml and FOLDER/hand.csv. */
stic_status stic_extreme_dump(const char *folder, const stic_scene *scene, const stic_sample *samples,
                              int count, stic_error *err);

/* ---- extremes_picture.c ------------------------------------------------------------------------- */

typedef struct stic_heat_point {
  double a, b, digits; /* NAN: refused or no answer at all */
} stic_heat_point;

typedef struct stic_heat_map {
  char title[96];
  const char *label_a, *label_b;
  stic_heat_point *points; /* row by row: a changes slowest */
  int count, room;
  bool lacks_memory; /* for a point */
} stic_heat_map;

/* Draws the maps that have points, `columns` a row, by gnuplot. STIC_USAGE without gnuplot, STIC_CANNOT_WRITE. */
stic_status stic_heat_picture(const char *path, const stic_heat_map *maps, int count, int columns,
                              stic_error *err);

#endif

/* What a scene can need of the model: which surfaces can be touched, which contact sets can occur, what
 * friction and rotation come down to. Only what is proven is denied; all else is "possible".
 * Internal to the library and its program. */
#ifndef STIC_NEEDS_H
#define STIC_NEEDS_H

#include "stiction.h"

/* ---- where the hand can be ----------------------------------------------------------------- */

/* Gathered from a trace sample by sample, or from a box that the hand stays in. */
typedef struct stic_hand_range {
  bool known;                        /* false: the hand may be anywhere */
  int64_t samples;                   /* 0: not from a trace */
  double low[2], high[2];            /* m, of its positions */
  double gap_min[STIC_SURFACES_MAX]; /* m, least of its positions to each surface */
  double step, turn;                 /* m, rad: the farthest from one sample to the next */
  double start_pull;                 /* m, from the start's holding point to the first position */
  double start_turn;                 /* rad, between the start's angle and the first of the hand */
  double last[2], last_angle;        /* of the last sample added */
} stic_hand_range;

/* Anywhere, at any angle. Real-time: no (nor are the others). */
void stic_hand_range_anywhere(stic_hand_range *range);
/* Anywhere in a box (corners in m), at any angle. */
void stic_hand_range_box(stic_hand_range *range, const stic_scene *scene, const double low[2],
                         const double high[2]);
/* Nowhere yet; then each sample of a trace in order. */
void stic_hand_range_begin(stic_hand_range *range);
void stic_hand_range_add(stic_hand_range *range, const stic_scene *scene, const stic_sample *sample);

/* ---- what follows -------------------------------------------------------------------------- */

typedef enum stic_reach {
  STIC_REACH_POSSIBLE, /* not ruled out */
  STIC_REACH_BEHIND,   /* never: it lies behind other surfaces, wherever the hand goes */
  STIC_REACH_FAR       /* never: the hand does not lead the object there */
} stic_reach;

typedef struct stic_surface_needs {
  stic_reach reach;
  int behind;   /* STIC_REACH_BEHIND: the surface in front of it */
  double gap;   /* STIC_REACH_FAR: m, no vertex comes closer */
  bool at_rest; /* STIC_REACH_FAR: holds as long as no row is flagged 4 or 8 */
} stic_surface_needs;

/* Two surfaces that can be touched at once. */
typedef struct stic_pair_needs {
  int first, second;
  bool two_vertex; /* different vertices on them */
  bool corner;     /* one vertex on both */
  bool slot;       /* parallel, facing each other */
  bool wedging;    /* their cones can face each other: forces of any size without a pull */
} stic_pair_needs;

#define STIC_NEEDS_PAIRS_MAX 64 /* listed; further ones are counted */

typedef struct stic_needs {
  double size;   /* m, of the object */
  double radius; /* m, farthest that a vertex can be from the holding point */
  stic_surface_needs surfaces[STIC_SURFACES_MAX];
  int behind;    /* how many surfaces are STIC_REACH_BEHIND */
  int reachable; /* how many surfaces can be touched; what follows is about these */
  int pair_count;
  stic_pair_needs pairs[STIC_NEEDS_PAIRS_MAX];
  bool vertex, edge, two_vertex, corner, multi; /* contact sets that can occur [3] */
  bool wedging;
  bool frictionless;  /* mu_static = mu_dynamic = 0 on all */
  bool jumpless;      /* mu_static = mu_dynamic on all */
  bool free_rotation; /* k_theta = 0 */
  bool fixed_angle;   /* it never turns: nothing can be touched and k_theta = 0 */
} stic_needs;

/* hidden[s]: surface s can never be touched, wherever the hand goes (STIC_REACH_BEHIND). For
 * scene->surface_count surfaces; the scene must be valid. Real-time: no. */
void stic_needs_find_hidden(const stic_scene *scene, bool *hidden);

/* The scene must be valid. Real-time: no. */
void stic_needs_find(const stic_scene *scene, const stic_hand_range *range, stic_needs *needs);

#endif

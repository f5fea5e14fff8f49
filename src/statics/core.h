/* What the statics core offers the simulation: one table of functions per precision, and the
 * collision detector that it asks which features are near. Quantities that cross here are SI doubles. */
#ifndef STIC_CORE_H
#define STIC_CORE_H

#include "../stiction.h"
#include "../collide.h"

/* The hand at one moment: position and target orientation of the object [5]. */
typedef struct stic_hand {
  double x, y, phi;
} stic_hand;

/* What RELAX and the accuracy levels report besides the pose. */
typedef struct stic_core_report {
  unsigned flags;     /* STIC_FLAG_ */
  int iterations;     /* root-finding steps */
  int relaxations;    /* RELAX calls */
  int slips;          /* RELAX calls in which a contact slid */
  int stages_worst;   /* most stages of one RELAX */
  unsigned decisions; /* bit per branch of JUDGE that was taken, STIC_DECISION_ */
} stic_core_report;

/* Branches of JUDGE and HOLD; tests use them to prove what they covered. */
enum {
  STIC_DECISION_REST = 1,
  STIC_DECISION_OPEN_SINGLE = 1 << 1,   /* 1. a single contact opens */
  STIC_DECISION_SLIDE_SINGLE = 1 << 2,  /* 1. ... slides */
  STIC_DECISION_SLIDE_EDGE = 1 << 3,    /* 2. two contacts on parallel surfaces slide */
  STIC_DECISION_SLIDE_TRAMMEL = 1 << 4, /* 2. two contacts on two surfaces slide */
  STIC_DECISION_OPEN_TURN = 1 << 5,     /* 3. the others turn about the one vertex left */
  STIC_DECISION_OPEN_PAIR = 1 << 6,     /* 3. the pair left slides */
  STIC_DECISION_OPEN_SLIDE = 1 << 7,    /* 3. the single contact left slides, the others part */
  STIC_DECISION_OPEN_ALL = 1 << 8,      /* 3. free */
  STIC_DECISION_FLOW = 1 << 9,          /* 4. viscous flow */
  STIC_DECISION_SNAP = 1 << 10,         /* a pinned equilibrium vanished */
  STIC_DECISION_SLIDE_ON = 1 << 11      /* mu_s = mu_d: slid on without events */
};

/* What a simulation evaluates of the model: all, or what its scene can need (sim.h). */
typedef struct stic_parts {
  int surface_count; /* surfaces that can be touched at all; the detector answers in their order */
  int surfaces[STIC_SURFACES_MAX];
} stic_parts;

typedef struct stic_core {
  /* Bytes that one simulation needs; init() fills them. The scene must outlive them. */
  size_t (*memory_size)(void);
  void (*init)(void *core, const stic_scene *scene, const stic_settings *settings, const stic_parts *parts,
               stic_collider *collider, stic_event *events, int event_capacity);
  /* The grip: the object's pose stays, to the last bit. Held at `holding_point` (m, body coordinates), or, if that is
   * NULL, where the hand is; the hand's angle must then be the object's. */
  void (*take)(void *core, stic_hand hand, const double *holding_point);
  /* One RELAX with the hand held still (first sample, and level `frame`). */
  void (*relax)(void *core, stic_hand hand, double t, stic_core_report *report);
  /* Follows the hand from the last judged pose to the next sample at the settings' level. */
  void (*follow)(void *core, stic_hand from, stic_hand to, double t_from, double t_to,
                 stic_core_report *report);
  /* Pose, contacts, forces, residual into the result; `held` false: no spring. */
  void (*result)(void *core, stic_hand hand, bool held, stic_result *result);
  /* From the body's origin to a place in the world, and the body's angle: as exact far from the world's origin. */
  void (*offset)(const void *core, double x, double y, double *dx, double *dy, double *theta);
  /* Events written since the last call of clear_events. */
  int (*event_count)(const void *core);
  void (*clear_events)(void *core);
  void (*add_event)(void *core, stic_event event);
} stic_core;

extern const stic_core stic_core_f32;
extern const stic_core stic_core_f64;
extern const stic_core stic_core_f80;

#endif

/* stiction: the behaviour of a hand-held object in frictional contact, by statics.
 *
 * This is the library's one public header. It implements Ikei, Takahashi and Fukuda,
 * "Statics-based Contact Behavior Simulation of a Manipulated Object" ("the paper"; numbers in
 * square brackets are its sections) and the multi-contact cases that the paper leaves out.
 *
 * Conventions, everywhere unless a field says otherwise:
 *   units       SI: m, N, N m, rad; times in whole nanoseconds (suffix _ns) or seconds
 *   axes        right-handed, x right, y up, z the depth axis (OpenXR); the statics is solved in the
 *               x-y plane, angles are counter-clockwise and unwrapped (never cut at pi)
 *   contacts    the normal points out of the solid, the tangent is the normal turned by -90 degrees
 *               (floor: normal +y, tangent +x); forces are those that act on the object
 *   errors      functions that can be refused return a stic_status and, if `err` is not NULL, say why
 *               in words; nothing is changed then
 *   real time   "Real-time: yes" means: no allocation, lock or I/O, and a bounded number of steps
 *   threads     objects are independent: different ones may be used by different threads at once,
 *               one object by one thread at a time
 */
#ifndef STIC_STICTION_H
#define STIC_STICTION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(STIC_BUILD) && defined(__GNUC__)
#define STIC_API __attribute__((visibility("default")))
#else
#define STIC_API
#endif

#define STIC_VERSION "0.1.0"

#define STIC_VERTICES_MAX 64  /* of the object's polygon */
#define STIC_SURFACES_MAX 256 /* of a scene */
#define STIC_CONTACTS_MAX 64  /* kept at once; one more sets STIC_FLAG_LIMIT */
#define STIC_NAME_MAX 64      /* bytes of a name, with its final 0 */

/* ---- status and errors ------------------------------------------------------------------- */

/* 0 is success. Numbers are the program's exit codes. */
typedef enum stic_status {
  STIC_OK = 0,
  STIC_FAILED = 1,       /* a check found something wrong */
  STIC_USAGE = 2,        /* an argument or option that cannot be meant, or that this build lacks */
  STIC_BAD_INPUT = 3,    /* a file's content; `line` says where */
  STIC_NO_DEVICE = 4,    /* absent, or lost for good */
  STIC_CANNOT_WRITE = 5, /* output could not be written, or there is no usable renderer */
  STIC_NO_MEMORY = 6     /* nor threads or file descriptors */
} stic_status;

typedef struct stic_error {
  stic_status status;
  int64_t line;      /* from 1; 0: not about a line */
  char file[256];    /* "" where no file is concerned */
  char message[512]; /* what was found and what was expected */
} stic_error;

/* Writes "FILE:LINE: message" (without what is absent) into `out`, always terminated.
 * Real-time: no. */
STIC_API void stic_error_format(const stic_error *err, char *out, size_t out_size);

/* The library's version, STIC_VERSION of its build. Real-time: yes. */
STIC_API const char *stic_version(void);

/* ---- scene ------------------------------------------------------------------------------- */

/* Coulomb's coefficients [4, eqs (5), (6)]: mu_static >= mu_dynamic >= 0. */
typedef struct stic_friction {
  double mu_static;
  double mu_dynamic;
} stic_friction;

/* A fixed half-plane: all points q with (q - point) . normal >= 0 are free. */
typedef struct stic_surface {
  char name[STIC_NAME_MAX];
  double point[2];   /* m, any point on the surface */
  double normal_deg; /* direction of the outward normal, degrees; multiples of 90 are exact */
  stic_friction friction;
  int64_t line; /* where the scene file defines it; 0: nowhere */
} stic_surface;

typedef enum stic_hold {
  STIC_HOLD_START, /* held at holding_point from the first sample on; buttons are ignored */
  STIC_HOLD_BUTTON /* taken on the grip button's press within reach, let go on its release [5] */
} stic_hold;

/* What is simulated. Fill with stic_scene_init(), then set fields; or stic_scene_read(). */
typedef struct stic_scene {
  char name[STIC_NAME_MAX];              /* default "" */
  int vertex_count;                      /* 3..64 */
  double vertices[STIC_VERTICES_MAX][2]; /* m, body coordinates, convex, counter-clockwise */
  double depth;                          /* m, along z, > 0, default 0.1; for pictures only */
  double x, y, z;                        /* m, start of the body's origin, default 0 */
  double angle;                          /* rad, start, default 0 */
  double stiffness;                      /* k_p [4, eq (3)], N/m, > 0 */
  double rotational_stiffness;           /* k_theta [4, eq (4)], N m/rad, >= 0 */
  stic_hold hold;                        /* default STIC_HOLD_START */
  double holding_point[2];               /* b, m, body coordinates, default (0, 0) */
  double reach;                          /* m, >= 0, default 0.05: largest distance from hand to polygon */
  int surface_count;                     /* 1..256 */
  stic_surface surfaces[STIC_SURFACES_MAX];
} stic_scene;

/* Sets every field to its default; stiffnesses, polygon and surfaces stay to be given. */
STIC_API void stic_scene_init(stic_scene *scene);

/* Makes the polygon of a width x height rectangle centred at the body's origin: vertices
 * 0 lower left, 1 lower right, 2 upper right, 3 upper left. */
STIC_API void stic_scene_set_box(stic_scene *scene, double width, double height);

/* The largest distance between two vertices ("object size", the length that tolerances refer to). */
STIC_API double stic_scene_size(const stic_scene *scene);

/* Unit normal of a surface direction in degrees, exact at multiples of 90. Real-time: yes. */
STIC_API void stic_normal_from_degrees(double degrees, double normal[2]);

/* One `KEY=VALUE` that overrides a scene file's value, e.g. {"friction.static", "0.6"}. */
typedef struct stic_override {
  const char *key;
  const char *value;
} stic_override;

/* Reads a scene file (YAML). All that the format demands is checked; the first problem is reported
 * with its line. `overrides` may be NULL if count is 0. Real-time: no. */
STIC_API stic_status stic_scene_read(const char *path, const stic_override *overrides, int override_count,
                                     stic_scene *scene, stic_error *err);

/* Checks ranges, convexity, friction and that the object starts outside every surface. Real-time: no. */
STIC_API stic_status stic_scene_validate(const stic_scene *scene, stic_error *err);

/* ---- tracker sample ---------------------------------------------------------------------- */

#define STIC_BUTTON_GRIP 1u

/* What a tracker says at one moment; the hand is the tracker [1]. */
typedef struct stic_sample {
  int64_t t_ns;          /* strictly increasing along a run */
  double position[3];    /* m */
  double orientation[4]; /* unit quaternion x, y, z, w; the hand angle is 2 atan2(qz, qw) */
  uint32_t buttons;      /* bit mask, bit 0 = grip */
  bool lost;             /* tracking lost: the pose is the last known one and the grip is let go */
} stic_sample;

/* ---- result of one sample ---------------------------------------------------------------- */

/* The contact states [3]; `corner` is one vertex on two surfaces, `multi` any set that the paper
 * does not name. */
typedef enum stic_state {
  STIC_RELEASED,
  STIC_FREE,       /* a) non-contact */
  STIC_VERTEX,     /* b) a single vertex on a surface */
  STIC_EDGE,       /* c) an edge on a surface */
  STIC_TWO_VERTEX, /* d) two vertices on two surfaces */
  STIC_CORNER,
  STIC_MULTI
} stic_state;

enum {
  STIC_FLAG_SLIPPED = 1,   /* a contact slid in this row */
  STIC_FLAG_WEDGED = 2,    /* the contacts hold whatever the hand does */
  STIC_FLAG_NO_ANSWER = 4, /* no admissible answer; the object stays where it was */
  STIC_FLAG_LIMIT = 8,     /* a bound on stages, events or contacts was reached */
  STIC_FLAG_LOST = 16      /* tracking lost */
};

typedef struct stic_contact {
  int vertex, surface; /* indices from 0 */
  double x, y;         /* m, its place: exactly constant while stuck */
  double normal;       /* N, >= 0 */
  double friction;     /* N, signed along the tangent */
} stic_contact;

typedef struct stic_result {
  int64_t t_ns;
  stic_state state;
  double x, y, z, theta; /* body origin and angle, m, rad */
  double hand_x, hand_y, hand_z,
    hand_theta;                /* hand; hand_theta is the target phi, while released the raw hand angle */
  double holding_x, holding_y; /* m, world: the holding point g; while released, the hand */
  double force_x, force_y,
    moment;          /* the spring's force on the object at the holding point [4]; 0 while released */
  int64_t slips;     /* since the start */
  unsigned flags;    /* sum of STIC_FLAG_ */
  int iterations;    /* root-finding steps in this row */
  double residual;   /* of force and moment balance, relative to the largest term */
  int contact_count; /* at most STIC_CONTACTS_MAX */
  stic_contact contacts[STIC_CONTACTS_MAX]; /* by vertex, then surface; only contact_count are set */
} stic_result;

/* "released", "free", "vertex", "edge", "two-vertex", "corner", "multi". Real-time: yes. */
STIC_API const char *stic_state_name(stic_state state);

typedef enum stic_event_kind {
  STIC_EVENT_TOUCH, /* a vertex reached a surface */
  STIC_EVENT_OPEN,  /* ... and left it */
  STIC_EVENT_SLIP,  /* a contact slid; length is the distance */
  STIC_EVENT_SNAP, /* a pinned object's equilibrium vanished and it turned to the next; length is the turn, rad */
  STIC_EVENT_TAKE, /* gripped */
  STIC_EVENT_RELEASE
} stic_event_kind;

typedef struct stic_event {
  double t; /* s */
  stic_event_kind kind;
  int vertex, surface; /* -1 where none is meant */
  double x, y;         /* m, where: the contact, or the hand for take and release */
  double length;       /* m (slip), rad (snap), else 0 */
} stic_event;

/* "touch", "open", "slip", "snap", "take", "release". Real-time: yes. */
STIC_API const char *stic_event_name(stic_event_kind kind);

/* ---- simulation -------------------------------------------------------------------------- */

/* How the hand's path between two samples is followed. */
typedef enum stic_level {
  STIC_LEVEL_FRAME,   /* the paper: one relaxation per sample */
  STIC_LEVEL_SUBSTEP, /* `substeps` of them, evenly along the hand's path */
  STIC_LEVEL_EVENT    /* wherever something happens on the path, located to 1e-12 of the interval */
} stic_level;

/* Of the statics' arithmetic, which counts places from near the object. What goes in and out is double. */
typedef enum stic_precision { STIC_F32, STIC_F64, STIC_F80 } stic_precision;

typedef struct stic_settings {
  stic_level level;         /* default STIC_LEVEL_EVENT */
  int substeps;             /* for STIC_LEVEL_SUBSTEP: 1..1000000, default 8 */
  stic_precision precision; /* default STIC_F64 */
  double h_min;             /* hand travel after an event before the next judgement at level event,
                              * in object sizes, (0, 1], default 1e-4; smaller follows bursts of
                              * slips more closely and costs more events */
} stic_settings;

STIC_API void stic_settings_init(stic_settings *settings);

/* Parses "frame", "event", "substep=N" into level and substeps. */
STIC_API stic_status stic_settings_set_accuracy(stic_settings *settings, const char *text, stic_error *err);
/* Parses "f32", "f64", "f80"; STIC_USAGE for what this build lacks. */
STIC_API stic_status stic_settings_set_precision(stic_settings *settings, const char *text, stic_error *err);
/* "event", "substep=8" ... into out. */
STIC_API void stic_settings_accuracy_text(const stic_settings *settings, char *out, size_t out_size);
STIC_API const char *stic_precision_name(stic_precision precision);

/* One object, its hand and the surfaces around it. Opaque. */
typedef struct stic_sim stic_sim;

/* Makes a simulation; scene and settings are copied. `*sim` is NULL on failure. The caller owns it
 * and ends it with stic_sim_destroy(). Allocates all that the simulation will ever use.
 * Real-time: no. */
STIC_API stic_status stic_sim_create(const stic_scene *scene, const stic_settings *settings, stic_sim **sim,
                                     stic_error *err);
STIC_API void stic_sim_destroy(stic_sim *sim); /* NULL allowed */

/* Advances to the sample and says where the object rests. The first sample is one relaxation from
 * the scene's pose, at every level. The sample must be finite with t_ns above the last one's.
 * Real-time: yes. */
STIC_API void stic_sim_step(stic_sim *sim, const stic_sample *sample, stic_result *result);

/* Events of the last step in order of time; valid until the next step. At most
 * STIC_EVENTS_MAX are kept per step. Real-time: yes. */
#define STIC_EVENTS_MAX 16384
STIC_API const stic_event *stic_sim_events(const stic_sim *sim, int *count);

/* Time spent by the last step on collision detection and in total, ns of CLOCK_MONOTONIC; zero
 * unless switched on, as reading the clock costs about as much as a small step. Real-time: yes. */
STIC_API void stic_sim_time_stages(stic_sim *sim, bool on);
STIC_API void stic_sim_stage_times(const stic_sim *sim, int64_t *collide_ns, int64_t *total_ns);

#ifdef __cplusplus
}
#endif
#endif

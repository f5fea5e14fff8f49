/* Inside of the statics core. statics.c includes the parts below it as one compilation per precision, so
 * everything here is static to it; each part holds one idea of the paper or of the rule RELAX.
 *
 * Scaled quantities. Lengths are in units of a power of two near the object's size, forces are divided
 * by k_p (so a force is a length: the spring's stretch), moments by k_p too (an area), and
 * kappa = k_theta / k_p. Poses therefore cannot depend on the absolute stiffness, and scaling lengths or
 * forces by powers of two leaves every bit of the computation as it was.
 *
 * Local coordinates. Places are counted from an origin near the object (core.origin), so that a scene far from the
 * world's origin costs no digits: only what comes in and goes out, in double, has the rounding of its coordinates. */
#ifndef STIC_STATICS_H
#define STIC_STATICS_H

#include "core.h"
#include "real.h"

enum {
  CONTACTS_MAX = STIC_CONTACTS_MAX,
  PAIRS_MAX = 2 * STIC_CONTACTS_MAX, /* opened pairs that have not left yet */
  STAGES_MAX = 64,                   /* of one RELAX */
  SAMPLE_EVENTS_MAX = 10000,         /* RELAX calls on one hand path at level event */
  SAMPLE_WORK_MAX = 700000,          /* ... and their work, see work_done() */
  CONES_MAX = 2 * CONTACTS_MAX,
  SLIDING_GAPS_MAX = 1024
};

/* Where judgements draw the line, in the scaled units (model: 1e-12 k_p size, 1e-14 k_p size^2). Single
 * precision cannot hold these; there they are its own rounding. */
#define TOLERANCE r_max(R(1e-12), 16 * REAL_EPSILON)
/* Angles this near to each other are the same touch. */
#define ANGLE_TIE r_max(R(1e-9), 64 * REAL_EPSILON)
#define MOMENT_ZERO r_max(R(1e-14), 4 * REAL_EPSILON)

typedef struct surface {
  vec point, n, t; /* a point on it, outward normal, tangent (n turned by -90 degrees) */
  real mu_s, mu_d;
} surface;

/* A vertex on a surface [3]; while stuck its place does not move by a single bit. */
typedef struct contact {
  int vertex, surface;
  vec place;
} contact;

typedef struct pair {
  int vertex, surface;
} pair;

/* Object and surfaces: what does not change during a run. */
typedef struct body {
  int vertex_count, surface_count;
  vec vertices[STIC_VERTICES_MAX]; /* body coordinates */
  real size;                       /* largest distance between two vertices */
  real kappa;                      /* k_theta / k_p */
  real radius;                     /* farthest vertex from the body's origin */
  surface surfaces[STIC_SURFACES_MAX];
  real world_extent; /* largest coordinate of surface points: sets rounding noise */
  real start_depth;  /* how deep it starts, by the rounding of the world's coordinates */
} body;

/* A function of an angle: k + c cos x + s sin x */
typedef struct wave {
  real k, c, s;
} wave;

/* Of a vertex that slides on: gap to another surface by the angle, and how it grows with the place. */
typedef struct sliding_gap {
  wave turn;
  real along;
} sliding_gap;

/* Hand [5]: position and target angle. */
typedef struct hand {
  vec h;
  real phi;
} hand;

/* Which pairs can touch within `reach` of the pose at which the detector was last asked. */
typedef struct near_list {
  bool valid;
  vec p;
  real theta, reach;
  int count;
  int surfaces[STIC_SURFACES_MAX];
  uint64_t vertices[STIC_SURFACES_MAX]; /* mask per listed surface */
} near_list;

/* A walk through the list; zeroed at its start. */
typedef struct near_pair {
  int vertex, surface;
  int listed;    /* surfaces begun */
  uint64_t left; /* vertices of this one */
} near_pair;

/* Contact forces as an optimisation over the cones (cone.c); kept while the contacts stay. */
enum {
  BOUND_LOW = -1,
  BOUND_NONE = 0,
  BOUND_HIGH = 1,
  BOUND_ZERO = 2
}; /* T = -mu N, inside, T = mu N, N = T = 0 */

typedef struct balance {
  bool known; /* the wrenches below are those of the contacts */
  int count;
  real wrench_n[CONTACTS_MAX][3], wrench_t[CONTACTS_MAX][3], mu[CONTACTS_MAX];
  real edge_length[CONTACTS_MAX]; /* sqrt(1 + mu^2) */
  bool bounds_known;              /* bounds and inverse are those of the last least-norm forces */
  int bound[CONTACTS_MAX];
  real inverse[3][3];
  real last_target[3], last_n[CONTACTS_MAX], last_t[CONTACTS_MAX], last_y[3];
  bool last_do; /* the bounds give forces inside the cones for last_target */
  bool wedge_known, wedged;
} balance;

typedef struct core {
  const stic_scene *scene;
  body body;
  stic_settings settings;
  double unit;       /* m per scaled length, a power of two */
  double force_unit; /* N per scaled force: k_p unit */
  double origin[2];  /* of all places here, in the world, scaled: see origin.c */
  stic_collider *collider;
  stic_parts parts;
  near_list near;

  /* state */
  vec p; /* body origin */
  real theta;
  vec rot;                        /* (cos theta, sin theta) */
  vec b;                          /* holding point, body coordinates [2] */
  hand grip;                      /* what rounding left between hand and holding point when it was taken */
  contact contacts[CONTACTS_MAX]; /* in the order in which they touched */
  int contact_count;
  pair opened[PAIRS_MAX]; /* opened and not left yet: no new touch until they have */
  int opened_count;
  balance balance;
  bool window_open;   /* the last judgement was an event: the next comes h_min further */
  bool sliding;       /* mu_s = mu_d: the contacts slide on without events, and ... */
  real sliding_sense; /* ... in this sense: along t for one contact or an edge, of theta for a trammel */

  vec forces[CONTACTS_MAX]; /* of the contacts, over k_p: those of the last row */

  /* during one RELAX */
  hand hand;
  double event_time;
  bool full;       /* no room for a further contact: nothing may move any more */
  bool opened_any; /* a contact has opened in this RELAX */
  bool turn_done;  /* the last slide reached the zero of its moment: no turn right after it */
  bool happened;   /* touch, opening, slip: an event */
  real longest_slide;
  real slid_on;                /* slid without events since the last sample */
  int flow_steps, flow_solves; /* spent on the viscous flow: bounded per sample */
  int stages;                  /* of all RELAX calls of the sample */
  bool slid_to_zero;           /* the last action was a slide that reached its balance */
  real slide_sense;            /* ... in this sense (see sliding_sense) */
  real noise;                  /* rounding of a gap at these coordinates */

  stic_core_report *report;
  stic_event *events;
  int event_count, event_capacity;
  double gap_scratch[STIC_SURFACES_MAX];
  uint64_t mask_scratch[STIC_SURFACES_MAX];
  sliding_gap gaps[SLIDING_GAPS_MAX]; /* of one slide_on() */
} core;

/* ---- origin.c: where places are counted from ---- */
static vec local_place(const core *c, double x, double y);
static void world_place(const core *c, vec place, double *x, double *y);

/* ---- spring.c: hand and object joined by a virtual spring [2, 4] ---- */
static vec rotate(vec rot, vec v);
static vec world_vertex(const core *c, int vertex);
static vec holding_point(const core *c);
static void set_angle(core *c, real theta);
static vec spring_force(const core *c);   /* at the holding point, eq (3) */
static real spring_moment(const core *c); /* eq (4) */
static real spring_moment_about(const core *c, vec point);
static real gap_of(const core *c, vec point, int s); /* signed distance from surface s, > 0 free */

/* ---- curve.c: functions of one angle, their first crossing and first zero ---- */

/* k0 + k1 x + first harmonic + second harmonic */
typedef struct curve {
  real k0, k1, c1, s1, c2, s2;
} curve;

static real wave_at(const wave *w, real x);
static real wave_rate(const wave *w, real x);
static real wave_first_down(const wave *w, real noise, real x_max); /* R_HUGE: never */
static real wave_next_zero(const wave *w, real x_max);
static real curve_at(const curve *g, real x);
static bool curve_first_zero(const curve *g, real x_max, real *x, int *iterations);
static real drift_first_down(wave w, real turn, real drift, real noise, int *iterations);

/* ---- linear.c ---- */
static bool solve_linear(int n, int width, real *m, real smallest);

/* ---- touch.c: which vertex reaches which surface first [5] ---- */
typedef struct touch {
  real at; /* R_HUGE: none */
  int vertex, surface;
} touch;

static real rounding_here(const core *c);
static real gap_noise(const core *c); /* relax.c */
static void near_update(core *c, real travel);
static bool next_near(const core *c, near_pair *k);
static bool is_contact(const core *c, int vertex, int on);
static bool is_opened(const core *c, int vertex, int on);
static void forget_opened_that_left(core *c);
static void add_contact(core *c, int vertex, int on);
static void remove_contact(core *c, int index);
static vec onto_surface(const core *c, vec place, int on);
static void add_touching(core *c); /* every vertex within tolerance of a surface becomes a contact */
static touch first_touch_moving(core *c, vec travel, real turn);

/* ---- path.c: one degree of freedom, the pose follows from the angle [5.1, 5.3] ---- */
typedef struct path {
  int vertex;            /* reference vertex */
  real dir;              /* sense of the turn; x >= 0 below is the angle turned */
  vec origin;            /* its place at x = 0 */
  vec t;                 /* it moves along this ... */
  real xi_c, xi_s;       /* ... by xi = xi_c (cos x - 1) + xi_s sin x */
  vec a, a_turn;         /* holding point from the reference vertex, and dir * perp(a) */
  wave force_x, force_y; /* the spring's force */
  curve drive;           /* dir * unbalanced moment: the turn goes on while it is positive */
} path;

static path path_pinned(const core *c, int vertex, vec place, real dir);
static path path_sliding(const core *c, int vertex, vec place, vec t, vec n, real friction, real dir);
static wave path_force_along(const path *f, vec axis);
static wave path_gap(const core *c, const path *f, int vertex, int on);
static vec path_place(const path *f, real x);
static touch path_first_touch(core *c, const path *f, real x_max);
static void path_set_pose(core *c, const path *f, real x);

/* ---- cone.c: Coulomb's cones, and which forces can balance the load [4] ---- */
typedef struct wrench {
  vec f;
  real m;
} wrench;

static wrench load_about(const core *c, vec point);
static real slack_of_load(const core *c, vec f, real turn);
static real balance_slack(const core *c);                    /* what a balance of forces may be off */
static bool is_balanced(const core *c, real moment);         /* is this moment zero? */
static int vertex_cone_planes(const core *c, vec planes[3]); /* all contacts at one vertex */
static bool loads_balance(core *c);                          /* JUDGE's question */
static bool all_at_one_vertex(const core *c);
static void least_norm_forces(core *c, vec *forces);
static bool is_wedged(core *c);

/* ---- hold.c, slide.c, judge.c, flow.c, relax.c, slide_on.c ---- */
static bool hold(core *c);
static bool turn_about(core *c, int vertex, vec place);

static void slide_vertex(core *c, int index);
static bool edge_or_slot_starts(const core *c, int first, int second, real *sense, vec *velocity);
static void slide_edge_or_slot(core *c, int first, int second, real sense);
static bool trammel_starts(const core *c, int first, int second, real *dir);
static void slide_trammel(core *c, int first, int second, real dir);
static bool are_parallel(const core *c, int first, int second);

typedef enum verdict { VERDICT_REST, VERDICT_ACTED, VERDICT_STUCK } verdict;
static verdict judge(core *c);
static bool viscous_flow(core *c);
static void relax(core *c, hand target, double t);
static bool slides_on(const core *c);

/* ---- answer.c: what a sample ends with ---- */
struct last_pose;
static void keep(const core *c, struct last_pose *k);
static void answer(core *c, hand target, const struct last_pose *before);

/* ---- follow.c: accuracy levels ---- */
static void follow_event(core *c, hand from, hand to, double t_from, double t_to);

/* ---- statics.c: SI at the border ---- */
static hand hand_in(const core *c, stic_hand h);

static void record(core *c, stic_event_kind kind, int vertex, int surface, vec where, real length);

#endif

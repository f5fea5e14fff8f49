/* Brute-force oracle of the statics model: follows RELAX in small steps, evaluating gaps, forces and
 * moments from the pose alone. Slow, simple and independent of the solver; for tests only. */
#ifndef STICTION_TESTS_ORACLE_H
#define STICTION_TESTS_ORACLE_H

#define ORC_MAX_V 64
#define ORC_MAX_S 64
#define ORC_MAX_C 32

/* Half-plane; normal out of the solid, unit length. Tangent = normal turned by -90 degrees. */
typedef struct {
  double point[2], normal[2];
  double mu_s, mu_d;
} orc_surface;

typedef struct {
  int nv;
  double v[ORC_MAX_V][2]; /* body coordinates, convex, counter-clockwise */
  double k_p, k_theta;
  double hold[2]; /* holding point b, body coordinates */
  int ns;
  orc_surface s[ORC_MAX_S];
} orc_scene;

typedef struct {
  int vertex, surface;
  double place[2]; /* anchor, world */
} orc_contact;

/* What `event` follows between events. */
enum { ORC_STUCK = 0, ORC_SLIDE_ONE = 1, ORC_SLIDE_PARALLEL = 2, ORC_SLIDE_TRAMMEL = 3 };

typedef struct {
  double x, y, theta;
  int nc;
  orc_contact c[ORC_MAX_C]; /* in the order in which they touched */

  /* Private memory of RELAX; the extended precision keeps a pose from drifting by its own rounding.
     * Poses changed from outside are not seen: use orc_init. */
  long double q[3];
  long double at[ORC_MAX_C][2];
  int n_left; /* opened pairs that have not left their surface yet */
  int left[2 * ORC_MAX_C][2];
  int pending;    /* the last RELAX was an event: its h_min window is still to come */
  int slide;      /* mu_s = mu_d: sliding goes on between samples */
  int sigma;      /* its direction: along the (first) tangent, or of the angle for a trammel */
  double hand[3]; /* last hand given */
} orc_state;

/* Bits of orc_report.rules. */
#define ORC_R_FREE (1u << 0)         /* HOLD: straight to the hand */
#define ORC_R_FREE_OPENED (1u << 1)  /* HOLD: translate, then turn (something opened before) */
#define ORC_R_TURN (1u << 2)         /* HOLD: turn about one vertex */
#define ORC_R_TURN_CORNER (1u << 3)  /* ... with more than one contact at that vertex */
#define ORC_R_TURN_SKIPPED (1u << 4) /* HOLD: no turn right after a slide that reached its zero */
#define ORC_R_HOLD_TOUCH (1u << 5)   /* HOLD: stopped by a touch */
#define ORC_R_SNAP (1u << 6)         /* HOLD: turn went through a stretch where the equilibrium is unstable */
#define ORC_R_1_OPEN (1u << 7)       /* rule 1: the single contact opened */
#define ORC_R_1_SLIDE (1u << 8)      /* rule 1: the single contact slid */
#define ORC_R_2_EDGE (1u << 9)       /* rule 2: edge slid */
#define ORC_R_2_PARALLEL (1u << 10)  /* rule 2: slide between parallel walls */
#define ORC_R_2_TRAMMEL (1u << 11)   /* rule 2: trammel slid */
#define ORC_R_3_TURN (1u << 12)      /* rule 3: opened, the rest turns about one vertex */
#define ORC_R_3_PAIR (1u << 13)      /* rule 3: opened, the rest slides as a pair */
#define ORC_R_3_SLIDE (1u << 14)     /* rule 3: opened, the one left slides */
#define ORC_R_3_ALL (1u << 15)       /* rule 3: all opened */
#define ORC_R_3_MANY (1u << 16)      /* rule 3: more than one contact opened at once */
#define ORC_R_3_SECOND (1u << 17)    /* rule 3: a second derivative decided */
#define ORC_R_3_AFTER (1u << 18)     /* rule 3: the turn after the slide (or translation) decided */
#define ORC_R_4_FLOW (1u << 19)      /* rule 4: viscous flow */
#define ORC_R_SLIDE_TOUCH (1u << 20) /* a slide ended at a touch */
#define ORC_R_SLIDE_NZERO (1u << 21) /* a slide ended at N = 0 */
#define ORC_R_SLIDE_FLIP (1u << 22)  /* friction flipped on a trammel */
#define ORC_R_SLIDE_JUMP (1u << 23)  /* a trammel ended at a sign change across such a flip */
#define ORC_R_GOES_ON (1u << 24)     /* event, mu_s = mu_d: sliding went on without events */
#define ORC_R_STICK (1u << 25)       /* event, mu_s = mu_d: a sliding contact stuck */
#define ORC_R_WINDOW (1u << 26)      /* event: judged at the end of an h_min window */
#define ORC_R_DOUBLE (1u << 27) /* event: an event and its opposite inside one step, found by its minimum */
#define ORC_R_COUNT 28

typedef struct {
  int slips, touches, opens, stages, flow_stages, limit, no_answer;
  unsigned rules;
  double hold_rise; /* largest rise of the spring energy by a HOLD, over k_p size^2 (invariant 5) */
  int events;       /* level event: RELAX calls made between the samples */
} orc_report;

/* Contacts: vertices within 1e-12 size of a surface, stuck, by vertex, then surface. */
void orc_init(const orc_scene *, orc_state *, double x, double y, double theta);
/* One RELAX with the hand held still. Reports are accumulated, never cleared. */
void orc_relax(const orc_scene *, orc_state *, double hx, double hy, double phi, orc_report *);
/* Level frame: one RELAX at the new sample. */
void orc_move_frame(const orc_scene *, orc_state *, double hx, double hy, double phi, orc_report *);
/* Level event: the hand goes on a straight line from (hx0, hy0, phi0) to (hx1, hy1, phi1). */
void orc_move_event(const orc_scene *, orc_state *, double hx0, double hy0, double phi0, double hx1,
                    double hy1, double phi1, orc_report *);
/* Do forces exist that balance the spring with N >= 0 and |T| <= mu_s N? (Rest, to 1e-12 k_p size.) */
int orc_forces_exist(const orc_scene *, const orc_state *, double hx, double hy, double phi);
/* Steps are multiplied by this (default 1): halve it to see what the step size costs. */
extern double orc_step_factor;

#endif

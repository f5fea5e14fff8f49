/* One interface to the dynamics engines that stiction is measured beside. SI units, radians, the plane of stiction.h.
 * Nothing here is for the real-time loop. */
#ifndef PEER_H
#define PEER_H

#include "stiction.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How an engine is set up; README.md says why each value is what it is. */
typedef struct peer_tuning {
  int steps;           /* of the engine per sample, > 0 */
  int iterations;      /* of its solver; 0: its direct solver, where there is one */
  double mass;         /* kg, of the object, spread evenly */
  double scale;        /* the engine's lengths per metre: some have tolerances of a fixed length */
  double firmness;     /* of its contacts: what the engine's file says */
  double damping;      /* of the hand, of the critical damping for that mass */
  double hand_damping; /* 1: the damper holds the object to the moving hand, 0: to the ground */
  double switch_speed; /* m/s of slip above which friction is mu_dynamic; 0: always mu_static */
} peer_tuning;

/* Where the object is and how fast; as the engine has it, so the angle may be cut at pi. */
typedef struct peer_motion {
  double x, y, angle;     /* of the body's origin, which is its centre of mass: m, rad */
  double vx, vy, turning; /* m/s, rad/s */
} peer_motion;

typedef struct peer_engine {
  const char *name;    /* "Box2D 2.4.1" */
  const char *package; /* what it comes from */
  const char *note;    /* what it cannot do */
  /* A box of tuning->mass (moment of inertia `inertia`, kg m^2) among the scene's half-planes, at rest, without gravity
   * or sleeping. NULL: it refuses. The caller ends it with destroy(). */
  void *(*create)(const stic_scene *scene, const peer_tuning *tuning, double inertia);
  /* One step of dt seconds under a force (N) and a moment (N m) at the centre, mu[i] on surface i. */
  void (*step)(void *world, const double force[2], double moment, const double *mu, double dt);
  void (*read)(void *world, peer_motion *motion);
  void (*destroy)(void *world);
} peer_engine;

/* NULL: not in this build. */
extern const peer_engine *const peer_ode, *const peer_chipmunk, *const peer_bullet, *const peer_box2d,
                                                                                      *const peer_mujoco;

#ifdef __cplusplus
}
#endif
#endif

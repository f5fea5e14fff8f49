/* Chipmunk. firmness: part of a penetration that is mended in a step of 1/60 s. */
#include "peer.h"

#include <chipmunk/chipmunk.h>
#include <stdlib.h>

typedef struct world {
  cpSpace *space;
  cpBody *body;
  cpShape *box, *surfaces[STIC_SURFACES_MAX];
  int surface_count;
  const double *mu; /* during a step */
} world;

/* The surface is the arbiter's second shape: its collision type is its index. */
static cpBool pre_solve(cpArbiter *arbiter, cpSpace *space, cpDataPointer data)
{
  const world *w = data;
  cpShape *box, *surface;

  (void)space;
  cpArbiterGetShapes(arbiter, &box, &surface);
  cpArbiterSetFriction(arbiter, w->mu[cpShapeGetCollisionType(surface)]);
  return cpTrue;
}

/* A thick segment whose upper side is the surface: distances to its middle line are found without Chipmunk's search
 * inside overlapping polygons, which warns. */
static void add_surface(world *w, int i, const stic_surface *s)
{
  const double half = 2, thick = 0.1; /* m */
  double n[2];

  stic_normal_from_degrees(s->normal_deg, n);
  w->surfaces[i] = cpSpaceAddShape(
    w->space,
    cpSegmentShapeNew(cpSpaceGetStaticBody(w->space),
                      cpv(s->point[0] - n[0] * thick - n[1] * half, s->point[1] - n[1] * thick + n[0] * half),
                      cpv(s->point[0] - n[0] * thick + n[1] * half, s->point[1] - n[1] * thick - n[0] * half),
                      thick));
  cpShapeSetFriction(w->surfaces[i], s->friction.mu_static);
  cpShapeSetCollisionType(w->surfaces[i], (cpCollisionType)i);
}

static void *create(const stic_scene *scene, const peer_tuning *tuning, double inertia)
{
  world *w = calloc(1, sizeof *w);
  cpVect corners[4];
  cpCollisionHandler *handler;

  if (!w)
    return NULL;
  w->space = cpSpaceNew();
  cpSpaceSetIterations(w->space, tuning->iterations);
  cpSpaceSetCollisionSlop(w->space, 1e-6);
  cpSpaceSetCollisionBias(w->space, cpfpow(1 - tuning->firmness, 60));
  w->body = cpSpaceAddBody(w->space, cpBodyNew(tuning->mass, inertia));
  cpBodySetPosition(w->body, cpv(scene->x, scene->y));
  cpBodySetAngle(w->body, scene->angle);
  for (int i = 0; i < 4; i++)
    corners[i] = cpv(scene->vertices[i][0], scene->vertices[i][1]);
  w->box = cpSpaceAddShape(w->space, cpPolyShapeNewRaw(w->body, 4, corners, 0));
  cpShapeSetFriction(w->box, 1);
  cpShapeSetCollisionType(w->box, STIC_SURFACES_MAX);
  w->surface_count = scene->surface_count;
  for (int i = 0; i < w->surface_count; i++)
    add_surface(w, i, &scene->surfaces[i]);
  if (tuning->switch_speed > 0) {
    handler = cpSpaceAddWildcardHandler(w->space, STIC_SURFACES_MAX);
    handler->preSolveFunc = pre_solve;
    handler->userData = w;
  }
  return w;
}

static void step(void *it, const double force[2], double moment, const double *mu, double dt)
{
  world *w = it;

  w->mu = mu;
  cpBodySetForce(w->body, cpv(force[0], force[1]));
  cpBodySetTorque(w->body, moment);
  cpSpaceStep(w->space, dt);
}

static void read_motion(void *it, peer_motion *m)
{
  const world *w = it;
  const cpVect p = cpBodyGetPosition(w->body), v = cpBodyGetVelocity(w->body);

  *m = (peer_motion){p.x, p.y, cpBodyGetAngle(w->body), v.x, v.y, cpBodyGetAngularVelocity(w->body)};
}

static void destroy(void *it)
{
  world *w = it;

  for (int i = 0; i < w->surface_count; i++) {
    cpSpaceRemoveShape(w->space, w->surfaces[i]);
    cpShapeFree(w->surfaces[i]);
  }
  cpSpaceRemoveShape(w->space, w->box);
  cpShapeFree(w->box);
  cpSpaceRemoveBody(w->space, w->body);
  cpBodyFree(w->body);
  cpSpaceFree(w->space);
  free(w);
}

static const peer_engine engine = {"Chipmunk",  "chipmunk-dev", "one coefficient", create, step,
                                   read_motion, destroy};
const peer_engine *const peer_chipmunk = &engine;

/* ODE's own dynamics. firmness: error reduction per step (ERP). iterations 0: dWorldStep, the direct solver. */
#include "peer.h"

#include <math.h>
#include <ode/ode.h>
#include <stdlib.h>

#define CONTACTS_MAX 8

typedef struct world {
  dWorldID world;
  dSpaceID space;
  dJointGroupID contacts;
  dBodyID body;
  dGeomID box, planes[STIC_SURFACES_MAX];
  double normals[STIC_SURFACES_MAX][2];
  int surfaces, iterations;
} world;

static void add_body(world *w, const stic_scene *scene, const peer_tuning *tuning, double inertia)
{
  const double *corner = scene->vertices[2];
  dMatrix3 rotation;
  dMass mass;

  w->body = dBodyCreate(w->world);
  dMassSetParameters(&mass, tuning->mass, 0, 0, 0, inertia, inertia, inertia, 0, 0, 0);
  dBodySetMass(w->body, &mass);
  dBodySetPosition(w->body, scene->x, scene->y, 0);
  dRFromAxisAndAngle(rotation, 0, 0, 1, scene->angle);
  dBodySetRotation(w->body, rotation);
  w->box = dCreateBox(w->space, 2 * corner[0], 2 * corner[1], scene->depth);
  dGeomSetBody(w->box, w->body);
  dJointAttach(dJointCreatePlane2D(w->world, NULL), w->body, NULL);
}

static void *create(const stic_scene *scene, const peer_tuning *tuning, double inertia)
{
  world *w = calloc(1, sizeof *w);

  if (!w)
    return NULL;
  dInitODE2(0);
  dAllocateODEDataForThread((unsigned)dAllocateMaskAll);
  w->world = dWorldCreate();
  w->space = dSimpleSpaceCreate(NULL);
  w->contacts = dJointGroupCreate(0);
  w->surfaces = scene->surface_count;
  w->iterations = tuning->iterations;
  dWorldSetERP(w->world, tuning->firmness);
  dWorldSetCFM(w->world, 1e-10);
  dWorldSetContactSurfaceLayer(w->world, 0);
  if (w->iterations > 0)
    dWorldSetQuickStepNumIterations(w->world, w->iterations);
  add_body(w, scene, tuning, inertia);
  for (int i = 0; i < w->surfaces; i++) {
    const stic_surface *s = &scene->surfaces[i];
    double *n = w->normals[i];

    stic_normal_from_degrees(s->normal_deg, n);
    w->planes[i] = dCreatePlane(NULL, n[0], n[1], 0, n[0] * s->point[0] + n[1] * s->point[1]);
  }
  return w;
}

/* The box has depth: of each vertex's two contacts the one in front will do, as the body stays in the plane. */
static void add_contacts(world *w, int surface, double mu)
{
  dContact contact = {.surface = {.mode = dContactApprox1 | dContactFDir1, .mu = mu}};
  dContactGeom found[CONTACTS_MAX];
  const int count = dCollide(w->box, w->planes[surface], CONTACTS_MAX, found, sizeof *found);

  contact.fdir1[0] = w->normals[surface][1];
  contact.fdir1[1] = -w->normals[surface][0];
  for (int i = 0; i < count; i++) {
    if (found[i].pos[2] < 0)
      continue;
    contact.geom = found[i];
    dJointAttach(dJointCreateContact(w->world, w->contacts, &contact), w->body, NULL);
  }
}

static void step(void *it, const double force[2], double moment, const double *mu, double dt)
{
  world *w = it;

  for (int i = 0; i < w->surfaces; i++)
    add_contacts(w, i, mu[i]);
  dBodyAddForce(w->body, force[0], force[1], 0);
  dBodyAddTorque(w->body, 0, 0, moment);
  if (w->iterations > 0)
    dWorldQuickStep(w->world, dt);
  else
    dWorldStep(w->world, dt);
  dJointGroupEmpty(w->contacts);
}

static void read_motion(void *it, peer_motion *m)
{
  const world *w = it;
  const dReal *p = dBodyGetPosition(w->body), *r = dBodyGetRotation(w->body);
  const dReal *v = dBodyGetLinearVel(w->body), *turning = dBodyGetAngularVel(w->body);

  *m = (peer_motion){p[0], p[1], atan2(r[4], r[0]), v[0], v[1], turning[2]};
}

static void destroy(void *it)
{
  world *w = it;

  dJointGroupDestroy(w->contacts);
  for (int i = 0; i < w->surfaces; i++)
    dGeomDestroy(w->planes[i]);
  dSpaceDestroy(w->space);
  dWorldDestroy(w->world);
  dCloseODE();
  free(w);
}

static const peer_engine engine = {"ODE",       "libode-dev", "one coefficient", create, step,
                                   read_motion, destroy};
const peer_engine *const peer_ode = &engine;

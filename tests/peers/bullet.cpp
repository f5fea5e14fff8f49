/* Bullet in double precision, sequential impulses. firmness: the share of a penetration, and of a friction anchor's
 * stretch, that is mended in a step (ERP). */
#include "peer.h"

#include <btBulletDynamicsCommon.h>
#include <cmath>
#include <memory>
#include <vector>

namespace
{

struct world {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btSimpleBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld space{&dispatcher, &broadphase, &solver, &configuration};
  std::unique_ptr<btCollisionShape> box;
  std::unique_ptr<btRigidBody> body;
  btBoxShape ground{btVector3(1, 1, 1)};
  std::vector<std::unique_ptr<btCollisionObject>> surfaces;
  double scale;
};

void tune(world *w, const peer_tuning *tuning)
{
  btContactSolverInfo &info = w->space.getSolverInfo();

  w->space.setGravity(btVector3(0, 0, 0));
  info.m_numIterations = tuning->iterations;
  info.m_erp = info.m_erp2 = info.m_frictionERP = tuning->firmness;
  info.m_splitImpulse = 1;
  info.m_splitImpulsePenetrationThreshold = 0; /* all penetration is mended apart from velocities */
  info.m_linearSlop = 0;
  info.m_warmstartingFactor = 1;
  info.m_leastSquaresResidualThreshold = 0;
  info.m_solverMode = SOLVER_USE_WARMSTARTING | SOLVER_USE_2_FRICTION_DIRECTIONS |
                      SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION |
                      SOLVER_ENABLE_FRICTION_DIRECTION_CACHING |
                      SOLVER_INTERLEAVE_CONTACT_AND_FRICTION_CONSTRAINTS;
}

/* Box against box finds both vertices of an edge at once; its plane finds one a step. */
void add_surface(world *w, const stic_surface &s)
{
  const double deep = w->ground.getHalfExtentsWithMargin().y();
  auto surface = std::make_unique<btCollisionObject>();
  double n[2];

  stic_normal_from_degrees(s.normal_deg, n);
  surface->setCollisionShape(&w->ground);
  surface->setWorldTransform(
    btTransform(btMatrix3x3(n[1], n[0], 0, -n[0], n[1], 0, 0, 0, 1),
                btVector3(s.point[0] * w->scale - n[0] * deep, s.point[1] * w->scale - n[1] * deep, 0)));
  surface->setFriction(s.friction.mu_static);
  surface->setCollisionFlags(surface->getCollisionFlags() | btCollisionObject::CF_STATIC_OBJECT |
                             btCollisionObject::CF_HAS_FRICTION_ANCHOR);
  w->space.addCollisionObject(surface.get());
  w->surfaces.push_back(std::move(surface));
}

void *create(const stic_scene *scene, const peer_tuning *tuning, double inertia)
{
  const double *corner = scene->vertices[2], scale = tuning->scale, i = inertia * scale * scale;
  world *w = new world;

  w->scale = scale;
  tune(w, tuning);
  w->box =
    std::make_unique<btBoxShape>(btVector3(corner[0] * scale, corner[1] * scale, scene->depth / 2 * scale));
  w->body = std::make_unique<btRigidBody>(tuning->mass, nullptr, w->box.get(), btVector3(i, i, i));
  w->body->setWorldTransform(btTransform(btQuaternion(btVector3(0, 0, 1), scene->angle),
                                         btVector3(scene->x * scale, scene->y * scale, 0)));
  w->body->setFriction(1);
  w->body->setActivationState(DISABLE_DEACTIVATION);
  w->body->setLinearFactor(btVector3(1, 1, 0));
  w->body->setAngularFactor(btVector3(0, 0, 1));
  w->body->setCollisionFlags(w->body->getCollisionFlags() | btCollisionObject::CF_HAS_FRICTION_ANCHOR);
  w->space.addRigidBody(w->body.get());
  w->ground = btBoxShape(btVector3(2 * scale, scale, scale));
  for (int k = 0; k < scene->surface_count; k++)
    add_surface(w, scene->surfaces[k]);
  return w;
}

void step(void *it, const double force[2], double moment, const double *mu, double dt)
{
  world *w = static_cast<world *>(it);

  for (size_t i = 0; i < w->surfaces.size(); i++)
    w->surfaces[i]->setFriction(mu[i]);
  w->body->applyCentralForce(btVector3(force[0], force[1], 0) * w->scale);
  w->body->applyTorque(btVector3(0, 0, moment) * (w->scale * w->scale));
  w->space.stepSimulation(dt, 0);
}

void read_motion(void *it, peer_motion *m)
{
  const world *w = static_cast<world *>(it);
  const btTransform &t = w->body->getWorldTransform();
  const btVector3 p = t.getOrigin() / w->scale, v = w->body->getLinearVelocity() / w->scale;

  *m = {p.x(), p.y(), std::atan2(t.getBasis()[1][0], t.getBasis()[0][0]),
        v.x(), v.y(), w->body->getAngularVelocity().z()};
}

void destroy(void *it)
{
  world *w = static_cast<world *>(it);

  w->space.removeRigidBody(w->body.get());
  for (auto &surface : w->surfaces)
    w->space.removeCollisionObject(surface.get());
  delete w;
}

const peer_engine engine = {"Bullet", "libbullet-dev", "one coefficient", create, step, read_motion, destroy};

} // namespace

extern "C" const peer_engine *const peer_bullet = &engine;

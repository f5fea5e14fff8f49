/* Box2D. firmness: unused, its share of mending (0.2) and its slop are fixed. Its polygons rest 3 slops apart (their
 * skins overlap by one), so the surfaces lie that much deeper. */
#include "peer.h"

#include <box2d/box2d.h>
#include <cstdint>

namespace
{

struct world : b2ContactListener {
  b2World space{b2Vec2(0, 0)};
  b2Body *body = nullptr;
  double scale;
  int iterations;
  const double *mu = nullptr; /* during a step */

  /* Fixture A is the surface: it was made first, and its user data are its index. */
  void PreSolve(b2Contact *contact, const b2Manifold *) override
  {
    b2Fixture *a = contact->GetFixtureA(), *b = contact->GetFixtureB();

    contact->SetFriction(float(mu[(a->GetBody() == body ? b : a)->GetUserData().pointer]));
  }
};

void add_surface(world *w, uintptr_t index, const stic_surface &s)
{
  const double half = 2 * w->scale, deep = w->scale, gap = 3.0 * b2_linearSlop;
  double n[2];
  b2Vec2 corners[4];
  b2PolygonShape shape;
  b2FixtureDef fixture;
  b2BodyDef ground;

  stic_normal_from_degrees(s.normal_deg, n);
  for (int k = 0; k < 4; k++) {
    const double along = k == 0 || k == 3 ? -half : half, down = gap + (k < 2 ? deep : 0);

    corners[k].Set(float(s.point[0] * w->scale + n[1] * along - n[0] * down),
                   float(s.point[1] * w->scale - n[0] * along - n[1] * down));
  }
  shape.Set(corners, 4);
  fixture.shape = &shape;
  fixture.friction = float(s.friction.mu_static);
  fixture.userData.pointer = index;
  w->space.CreateBody(&ground)->CreateFixture(&fixture);
}

void *create(const stic_scene *scene, const peer_tuning *tuning, double inertia)
{
  const double *corner = scene->vertices[2], scale = tuning->scale;
  world *w = new world;
  b2MassData mass;
  b2BodyDef body;
  b2PolygonShape box;

  w->scale = scale;
  w->iterations = tuning->iterations;
  w->space.SetContactListener(w);
  for (int i = 0; i < scene->surface_count; i++)
    add_surface(w, uintptr_t(i), scene->surfaces[i]);
  body.type = b2_dynamicBody;
  body.allowSleep = false;
  body.position.Set(float(scene->x * scale), float(scene->y * scale));
  body.angle = float(scene->angle);
  w->body = w->space.CreateBody(&body);
  box.SetAsBox(float(corner[0] * scale), float(corner[1] * scale));
  w->body->CreateFixture(&box, 1);
  mass.mass = float(tuning->mass);
  mass.center.SetZero();
  mass.I = float(inertia * scale * scale);
  w->body->SetMassData(&mass);
  return w;
}

void step(void *it, const double force[2], double moment, const double *mu, double dt)
{
  world *w = static_cast<world *>(it);

  w->mu = mu;
  w->body->ApplyForceToCenter(b2Vec2(float(force[0] * w->scale), float(force[1] * w->scale)), true);
  w->body->ApplyTorque(float(moment * w->scale * w->scale), true);
  w->space.Step(float(dt), w->iterations, w->iterations);
}

void read_motion(void *it, peer_motion *m)
{
  const world *w = static_cast<world *>(it);
  const b2Vec2 p = w->body->GetPosition(), v = w->body->GetLinearVelocity();

  *m = {p.x / w->scale, p.y / w->scale, w->body->GetAngle(),
        v.x / w->scale, v.y / w->scale, w->body->GetAngularVelocity()};
}

void destroy(void *it)
{
  delete static_cast<world *>(it);
}

const peer_engine engine = {"Box2D",     "libbox2d-dev", "one coefficient; float", create, step,
                            read_motion, destroy};

} // namespace

extern "C" const peer_engine *const peer_box2d = &engine;

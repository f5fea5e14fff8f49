/* Hand and object joined by a virtual spring [2, 4]. */
#include "statics.h"

static vec rotate(vec rot, vec v)
{
  return v_make(rot.x * v.x - rot.y * v.y, rot.y * v.x + rot.x * v.y);
}

static void set_angle(core *c, real theta)
{
  c->theta = theta;
  c->rot = v_make(r_cos(theta), r_sin(theta));
}

static vec world_vertex(const core *c, int vertex)
{
  return v_add(c->p, rotate(c->rot, c->body.vertices[vertex]));
}

static vec holding_point(const core *c)
{
  return v_add(c->p, rotate(c->rot, c->b));
}

/* Eq (3), over k_p. */
static vec spring_force(const core *c)
{
  return v_sub(c->hand.h, holding_point(c));
}

/* Eq (4), over k_p. */
static real spring_moment(const core *c)
{
  return c->body.kappa * (c->hand.phi - c->theta);
}

static real spring_moment_about(const core *c, vec point)
{
  return v_cross(v_sub(holding_point(c), point), spring_force(c)) + spring_moment(c);
}

static real gap_of(const core *c, vec point, int s)
{
  return v_dot(v_sub(point, c->body.surfaces[s].point), c->body.surfaces[s].n);
}

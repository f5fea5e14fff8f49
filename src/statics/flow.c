/* Rule 4, for the few cases in which no contact set can go on alone: the viscous flow
 * k_p dg/ds = net force, k_theta dtheta/ds = net moment about g, with sliding contacts at mu_d, stuck ones inside
 * mu_s and open ones free, to the next event or to rest. The one place where a motion is integrated:
 * embedded Runge-Kutta steps (Dormand and Prince, orders 5 and 4), events located by bisection. */
#include "statics.h"

enum {
  FLOW_CONTACTS_MAX = 6,
  FLOW_UNKNOWNS = 3 + 2 * FLOW_CONTACTS_MAX,
  FLOW_STEPS_MAX = 2000,
  FLOW_SOLVES_MAX = 40000,
  FLOW_BISECTIONS = 60
};

/* What a contact does during the flow, in the order in which combinations are tried. */
typedef enum flow_mode { FLOW_STUCK, FLOW_FORWARD, FLOW_BACK, FLOW_OPEN, FLOW_MODES } flow_mode;

typedef struct flow {
  core *c;
  int count;
  contact contacts[FLOW_CONTACTS_MAX];
  flow_mode modes[FLOW_CONTACTS_MAX];
} flow;

typedef struct flow_rates {
  vec g;
  real theta;
  vec forces[FLOW_CONTACTS_MAX];
} flow_rates;

typedef struct flow_pose {
  vec p;
  real theta;
} flow_pose;

static void set_flow_pose(core *c, flow_pose q)
{
  set_angle(c, q.theta);
  c->p = q.p;
}

static vec flow_direction(const flow *f, int i)
{
  const surface *s = &f->c->body.surfaces[f->contacts[i].surface];
  if (f->modes[i] == FLOW_STUCK)
    return s->n;
  return v_mix(s->n, f->modes[i] == FLOW_FORWARD ? -s->mu_d : s->mu_d, s->t);
}

/* Velocities and contact forces at the present pose, from the mobility of the flow and the contacts'
 * constraints: unknowns are dg/ds, dtheta/ds and one or two force components per closed contact. */
static bool flow_solve(const flow *f, flow_rates *r)
{
  core *c = f->c;
  c->flow_solves++;
  real m[FLOW_UNKNOWNS][FLOW_UNKNOWNS + 1] = {{0}};
  vec force = spring_force(c), g = holding_point(c);
  int n = 3;
  m[0][0] = m[1][1] = 1;
  m[2][2] = c->body.kappa;
  int first_unknown[FLOW_CONTACTS_MAX];
  for (int i = 0; i < f->count; i++) {
    first_unknown[i] = n;
    if (f->modes[i] == FLOW_OPEN)
      continue;
    const surface *s = &c->body.surfaces[f->contacts[i].surface];
    vec e = v_sub(world_vertex(c, f->contacts[i].vertex), g);
    vec directions[2] = {flow_direction(f, i), s->t}, constraints[2] = {s->n, s->t};
    for (int k = 0; k < (f->modes[i] == FLOW_STUCK ? 2 : 1); k++, n++) {
      m[0][n] = -directions[k].x;
      m[1][n] = -directions[k].y;
      m[2][n] = -v_cross(e, directions[k]);
      m[n][0] = constraints[k].x;
      m[n][1] = constraints[k].y;
      m[n][2] = v_dot(constraints[k], v_perp(e));
    }
  }
  if (n == 3 && c->body.kappa == 0)
    m[2][2] = 1; /* free without a rotational spring: the angle stays */
  for (int i = 0; i < n; i++)
    m[i][n] = 0;
  m[0][n] = force.x;
  m[1][n] = force.y;
  m[2][n] = spring_moment(c);
  if (!solve_linear(n, FLOW_UNKNOWNS + 1, m[0], 1024 * REAL_EPSILON))
    return false;
  r->g = v_make(m[0][n], m[1][n]);
  r->theta = m[2][n];
  for (int i = 0; i < f->count; i++) {
    int k = first_unknown[i];
    r->forces[i] = v_make(0, 0);
    if (f->modes[i] == FLOW_OPEN)
      continue;
    r->forces[i] = v_scale(flow_direction(f, i), m[k][n]);
    if (f->modes[i] == FLOW_STUCK)
      r->forces[i] = v_mix(r->forces[i], m[k + 1][n], c->body.surfaces[f->contacts[i].surface].t);
  }
  return true;
}

static vec flow_velocity(const core *c, const flow_rates *r, int vertex)
{
  return v_mix(r->g, r->theta, v_perp(v_sub(world_vertex(c, vertex), holding_point(c))));
}

/* A motion counts however slow it is: of what a balance may be off, only the load's rounding makes a speed, and that of
 * the angles, which after many turns is the larger one. */
static real speed_rounding(const core *c)
{
  real angles = 4 * REAL_EPSILON * (r_abs(c->theta) + r_abs(c->hand.phi));
  return balance_slack(c) + (angles - TOLERANCE) * c->body.size;
}

/* Does every contact stay in its mode at these rates? */
static bool modes_hold(const flow *f, const flow_rates *r)
{
  const core *c = f->c;
  real slack = balance_slack(c), still = speed_rounding(c);
  for (int i = 0; i < f->count; i++) {
    const surface *s = &c->body.surfaces[f->contacts[i].surface];
    vec v = flow_velocity(c, r, f->contacts[i].vertex);
    real normal = v_dot(r->forces[i], s->n), tangential = v_dot(r->forces[i], s->t), speed = v_dot(v, s->t);
    switch (f->modes[i]) {
    case FLOW_STUCK:
      if (normal < -slack || r_abs(tangential) > s->mu_s * normal + slack)
        return false;
      break;
    case FLOW_FORWARD:
    case FLOW_BACK:
      if (normal < -slack || (f->modes[i] == FLOW_FORWARD ? speed : -speed) < -still)
        return false;
      break;
    default:
      if (v_dot(v, s->n) < -still)
        return false;
    }
  }
  return true;
}

static real flow_speed(const core *c, const flow_rates *r)
{
  return v_length(r->g) + c->body.size * r_abs(r->theta);
}

/* The first consistent combination of modes in which anything moves. */
static bool find_modes(flow *f)
{
  int combinations = 1;
  for (int i = 0; i < f->count; i++)
    combinations *= FLOW_MODES;
  for (int k = 0; k < combinations && f->c->flow_solves < FLOW_SOLVES_MAX; k++) {
    for (int i = f->count - 1, rest = k; i >= 0; i--, rest /= FLOW_MODES)
      f->modes[i] = (flow_mode)(rest % FLOW_MODES);
    flow_rates r;
    if (flow_solve(f, &r) && flow_speed(f->c, &r) > TOLERANCE * f->c->body.size && modes_hold(f, &r))
      return true;
  }
  return false;
}

static bool flow_derivative(flow *f, flow_pose q, flow_pose *d)
{
  core *c = f->c;
  flow_rates r;
  set_flow_pose(c, q);
  if (!flow_solve(f, &r))
    return false;
  /* p = g - R b */
  d->p = v_mix(r.g, -r.theta, v_perp(rotate(c->rot, c->b)));
  d->theta = r.theta;
  return true;
}

/* Takes the integration's error off the constraints. */
static flow_pose onto_surfaces(flow *f, flow_pose q)
{
  core *c = f->c;
  set_flow_pose(c, q);
  const surface *first = NULL;
  real first_gap = 0;
  for (int i = 0; i < f->count; i++) {
    const contact *k = &f->contacts[i];
    const surface *s = &c->body.surfaces[k->surface];
    vec at = world_vertex(c, k->vertex);
    if (f->modes[i] == FLOW_OPEN)
      continue;
    if (f->modes[i] == FLOW_STUCK)
      return (flow_pose){v_add(q.p, v_sub(k->place, at)), q.theta};
    real gap = gap_of(c, at, k->surface);
    if (!first) {
      first = s, first_gap = gap;
      continue;
    }
    real det = v_cross(first->n, s->n);
    if (r_abs(det) < R(1e-3))
      continue;
    vec shift =
      v_make((first_gap * s->n.y - gap * first->n.y) / det, (first->n.x * gap - s->n.x * first_gap) / det);
    return (flow_pose){v_sub(q.p, shift), q.theta};
  }
  if (first)
    q.p = v_mix(q.p, -first_gap, first->n);
  return q;
}

/* One Dormand-Prince step; returns the error estimate, negative if the modes became singular. */
static real flow_step(flow *f, flow_pose q, real h, flow_pose *out)
{
  static const real a[6][6] = {
    {R(1.0) / 5},
    {R(3.0) / 40, R(9.0) / 40},
    {R(44.0) / 45, -R(56.0) / 15, R(32.0) / 9},
    {R(19372.0) / 6561, -R(25360.0) / 2187, R(64448.0) / 6561, -R(212.0) / 729},
    {R(9017.0) / 3168, -R(355.0) / 33, R(46732.0) / 5247, R(49.0) / 176, -R(5103.0) / 18656},
    {R(35.0) / 384, 0, R(500.0) / 1113, R(125.0) / 192, -R(2187.0) / 6784, R(11.0) / 84}};
  static const real e[7] = {
    R(71.0) / 57600, 0, -R(71.0) / 16695, R(71.0) / 1920, -R(17253.0) / 339200, R(22.0) / 525, -R(1.0) / 40};
  flow_pose k[7], at = q;
  if (!flow_derivative(f, q, &k[0]))
    return -1;
  for (int i = 0; i < 6; i++) {
    at = q;
    for (int j = 0; j <= i; j++) {
      at.p = v_mix(at.p, h * a[i][j], k[j].p);
      at.theta += h * a[i][j] * k[j].theta;
    }
    if (!flow_derivative(f, at, &k[i + 1]))
      return -1;
  }
  vec error = v_make(0, 0);
  real turn_error = 0;
  for (int j = 0; j < 7; j++) {
    error = v_mix(error, h * e[j], k[j].p);
    turn_error += h * e[j] * k[j].theta;
  }
  *out = onto_surfaces(f, at);
  return v_length(error) + f->c->body.size * r_abs(turn_error);
}

/* Is the flow still regular at q: modes hold and no vertex is below a surface? *t names the one that is. */
static bool flow_goes_on(flow *f, flow_pose q, touch *t)
{
  core *c = f->c;
  flow_rates r;
  set_flow_pose(c, q);
  near_update(c, 0);
  for (near_pair k = {0}; next_near(c, &k);)
    if (gap_of(c, world_vertex(c, k.vertex), k.surface) < -c->noise) {
      *t = (touch){0, k.vertex, k.surface};
      return false;
    }
  t->at = R_HUGE;
  return flow_solve(f, &r) && modes_hold(f, &r);
}

/* Follows the modes to rest or to the end of the step in which something happens, located. */
static flow_pose flow_along(flow *f, flow_pose q, touch *t)
{
  core *c = f->c;
  const real tolerance = r_max(R(1e-13), 16 * REAL_EPSILON) * c->body.size;
  real h = R(0.01);
  t->at = R_HUGE;
  while (c->flow_steps++ < FLOW_STEPS_MAX) {
    flow_pose next;
    real error = flow_step(f, q, h, &next);
    c->report->iterations++;
    if (error < 0 || error > tolerance) {
      h *= error < 0 ? R(0.25) : r_max(R(0.2), R(0.9) * r_sqrt(r_sqrt(tolerance / error)));
      if (h < 16 * REAL_EPSILON)
        return q;
      continue;
    }
    if (!flow_goes_on(f, next, t)) {
      real good = 0, bad = h;
      touch found = *t;
      for (int k = 0; k < FLOW_BISECTIONS; k++) {
        real middle = (good + bad) / 2;
        if (!(middle > good && middle < bad))
          break;
        if (flow_step(f, q, middle, &next) >= 0 && flow_goes_on(f, next, t))
          good = middle;
        else
          bad = middle, found = *t;
      }
      flow_step(f, q, found.at < R_HUGE ? good : bad, &next);
      *t = found;
      return next;
    }
    q = next;
    flow_rates r;
    set_flow_pose(c, q);
    if (!flow_solve(f, &r) || flow_speed(c, &r) <= r_max(tolerance, speed_rounding(c)))
      return q;
    if (error < tolerance / 64)
      h = r_min(R(0.5), h * R(1.5));
  }
  c->report->flags |= STIC_FLAG_LIMIT;
  return q;
}

/* Something moved, or a contact opened; false: no combination of modes is consistent. */
static bool viscous_flow(core *c)
{
  flow f = {.c = c, .count = c->contact_count};
  if (f.count > FLOW_CONTACTS_MAX)
    return false;
  for (int i = 0; i < f.count; i++)
    f.contacts[i] = c->contacts[i];
  if (!find_modes(&f))
    return false;
  touch t = {R_HUGE, -1, -1};
  flow_pose q = flow_along(&f, (flow_pose){c->p, c->theta}, &t);
  set_flow_pose(c, q);
  for (int i = f.count - 1; i >= 0; i--)
    if (f.modes[i] == FLOW_OPEN)
      remove_contact(c, i);
  for (int i = 0; i < c->contact_count; i++) {
    bool stuck = false;
    for (int k = 0; k < f.count; k++)
      stuck |= f.modes[k] == FLOW_STUCK && f.contacts[k].vertex == c->contacts[i].vertex;
    if (!stuck)
      slide_to(c, &c->contacts[i], world_vertex(c, c->contacts[i].vertex));
  }
  if (t.at < R_HUGE)
    add_contact(c, t.vertex, t.surface);
  add_touching(c);
  return true;
}

/* Coulomb's law as cones [4, eqs (5), (6)], and the question of JUDGE: are there contact forces inside
 * their cones that balance the load, eqs (1), (2)? Where they are not unique the least-norm member is
 * shown: it is unique and continuous in time. The choice never moves the object. */
#include "statics.h"

enum { BALANCE_STEPS_MAX = 64, NORM_STEPS_MAX = 64 };

/* The spring's wrench on the object about a point; the contacts have to supply its negative. */
static wrench load_about(const core *c, vec point)
{
  wrench w = {spring_force(c), spring_moment_about(c, point)};
  return w;
}

/* What a balance of forces may be off: the model's 1e-12 k_p size, and the rounding of large loads and of
 * coordinates far from the origin. */
static real slack_of_load(const core *c, vec f, real turn)
{
  real turning = c->body.kappa * turn / c->body.size;
  return TOLERANCE * c->body.size + c->noise / 4 +
         16 * REAL_EPSILON * (r_abs(f.x) + r_abs(f.y) + r_abs(turning));
}

static real balance_slack(const core *c)
{
  return slack_of_load(c, spring_force(c), c->hand.phi - c->theta);
}

/* Is this moment zero? */
static bool is_balanced(const core *c, real moment)
{
  vec f = spring_force(c);
  real turning = c->body.kappa * (r_abs(c->hand.phi) + r_abs(c->theta));
  real rounding = 2 * REAL_EPSILON * (c->body.size * (r_abs(f.x) + r_abs(f.y)) + turning);
  return r_abs(moment) <= (MOMENT_ZERO * c->body.size + c->noise / 8) * c->body.size + rounding;
}

/* Two vertices may coincide to rounding (a thin rod far from the origin); they are then one place. */
static bool is_pair(const core *c)
{
  return c->contact_count == 2 && c->contacts[0].vertex != c->contacts[1].vertex &&
         v_length(v_sub(c->contacts[1].place, c->contacts[0].place)) > 8 * c->noise;
}

static bool all_at_one_vertex(const core *c)
{
  for (int i = 1; i < c->contact_count; i++)
    if (c->contacts[i].vertex != c->contacts[0].vertex)
      return false;
  return c->contact_count > 0;
}

static vec cone_ray(const surface *s, int side)
{
  return v_mix(s->n, side ? s->mu_s : -s->mu_s, s->t);
}

/* The planes w . f >= 0 that bound the sum of the cones at the one vertex that has all contacts. A single
 * contact's are scaled so that w . f is mu_s N -+ T (and N); a corner's are of unit length. */
static int vertex_cone_planes(const core *c, vec planes[3])
{
  if (c->contact_count == 1) {
    const surface *s = &c->body.surfaces[c->contacts[0].surface];
    planes[0] = v_mix(v_neg(s->t), s->mu_s, s->n);
    planes[1] = v_mix(s->t, s->mu_s, s->n);
    planes[2] = s->n;
    return 3;
  }
  vec rays[CONES_MAX];
  int count = 0, found = 0;
  for (int i = 0; i < c->contact_count; i++)
    for (int side = 0; side < 2; side++) {
      vec r = cone_ray(&c->body.surfaces[c->contacts[i].surface], side);
      rays[count++] = v_scale(r, 1 / v_length(r));
    }
  for (int i = 0; i < count && found < 3; i++)
    for (int side = 0; side < 2 && found < 3; side++) {
      vec w = side ? v_perp(rays[i]) : v_neg(v_perp(rays[i]));
      bool bounds = true;
      for (int k = 0; k < count && bounds; k++)
        bounds = v_dot(w, rays[k]) >= -4 * REAL_EPSILON;
      for (int k = 0; k < found && bounds; k++) /* not twice */
        bounds = v_length(v_sub(w, planes[k])) > 8 * REAL_EPSILON;
      if (bounds)
        planes[found++] = w;
    }
  return found;
}

/* ---- two contacts at different vertices: the forces that balance are a line [5.3] ---- */

/* Force of the second contact = second + x d, of the first = -load - that; d joins the two places. */
typedef struct force_line {
  vec first, second, d; /* at x = 0; d is of unit length */
  const surface *a, *b;
} force_line;

static force_line two_contact_forces(const core *c, wrench load_about_first, int i, int k)
{
  force_line l;
  l.a = &c->body.surfaces[c->contacts[i].surface];
  l.b = &c->body.surfaces[c->contacts[k].surface];
  vec d = v_sub(c->contacts[k].place, c->contacts[i].place);
  real length = v_length(d);
  l.d = v_scale(d, 1 / length);
  l.second = v_scale(v_perp(l.d), -load_about_first.m / length);
  l.first = v_neg(v_add(load_about_first.f, l.second));
  return l;
}

/* The six constraints value + slope x >= 0 on the line: mu N -+ T >= -slack/2 and N >= -slack/2 for both, as
 * the two share what the balance may be off. */
typedef struct line_constraints {
  real value[6], slope[6];
} line_constraints;

static line_constraints constraints_of(const force_line *l, real slack)
{
  line_constraints q;
  for (int side = 0; side < 2; side++) {
    const surface *s = side ? l->b : l->a;
    vec at = side ? l->second : l->first, along = side ? l->d : v_neg(l->d);
    vec planes[3] = {v_mix(v_neg(s->t), s->mu_s, s->n), v_mix(s->t, s->mu_s, s->n), s->n};
    for (int k = 0; k < 3; k++) {
      real slope = v_dot(planes[k], along);
      q.value[3 * side + k] = v_dot(planes[k], at) + slack / 2;
      q.slope[3 * side + k] = r_abs(slope) <= 4 * REAL_EPSILON * (1 + s->mu_s) ? 0 : slope;
    }
  }
  return q;
}

/* The part of the line inside both cones; the tightest constraints in tightest[], -1 for none. False if it
 * is empty; the constraints in conflict are then the tightest two, or twice one that no x can meet. */
static bool feasible_interval(const line_constraints *q, real *low, real *high, int tightest[2])
{
  *low = -R_HUGE;
  *high = R_HUGE;
  tightest[0] = tightest[1] = -1;
  for (int k = 0; k < 6; k++) {
    if (q->slope[k] > 0 && -q->value[k] / q->slope[k] > *low) {
      *low = -q->value[k] / q->slope[k];
      tightest[0] = k;
    } else if (q->slope[k] < 0 && q->value[k] / -q->slope[k] < *high) {
      *high = q->value[k] / -q->slope[k];
      tightest[1] = k;
    }
  }
  for (int k = 0; k < 6; k++)
    if (q->slope[k] == 0 && q->value[k] < 0) {
      tightest[0] = tightest[1] = k;
      return false;
    }
  return *low <= *high;
}

/* How far constraints i (from below) and k (from above) are from conflict; linear in the load. */
static real agreement(const line_constraints *q, const int pair_of[2])
{
  int i = pair_of[0], k = pair_of[1];
  return i == k ? q->value[i] : q->value[k] * q->slope[i] - q->value[i] * q->slope[k];
}

/* ---- any number of contacts ---- */

/* What the contacts' wrenches are about their first place, in units of force (moment over size). They stay
 * as long as the contacts do, and so do the pieces that only depend on them. */
static balance *current_balance(core *c)
{
  balance *q = &c->balance;
  if (q->known)
    return q;
  q->known = true;
  q->bounds_known = q->wedge_known = false;
  q->count = c->contact_count;
  for (int i = 0; i < q->count; i++) {
    const surface *s = &c->body.surfaces[c->contacts[i].surface];
    vec arm = v_sub(c->contacts[i].place, c->contacts[0].place);
    q->mu[i] = s->mu_s;
    q->edge_length[i] = r_sqrt(1 + s->mu_s * s->mu_s);
    q->wrench_n[i][0] = s->n.x, q->wrench_n[i][1] = s->n.y,
    q->wrench_n[i][2] = v_cross(arm, s->n) / c->body.size;
    q->wrench_t[i][0] = s->t.x, q->wrench_t[i][1] = s->t.y,
    q->wrench_t[i][2] = v_cross(arm, s->t) / c->body.size;
  }
  return q;
}

/* The two edges of each contact's cone as wrenches of unit force. */
typedef struct generators {
  int count;
  real column[CONES_MAX][3];
} generators;

static void cone_generators(const balance *q, generators *g)
{
  g->count = 2 * q->count;
  for (int i = 0; i < g->count; i++) {
    real mu = i & 1 ? q->mu[i / 2] : -q->mu[i / 2], scale = 1 / q->edge_length[i / 2];
    for (int k = 0; k < 3; k++)
      g->column[i][k] = (q->wrench_n[i / 2][k] + mu * q->wrench_t[i / 2][k]) * scale;
  }
}

static real dot3(const real *a, const real *b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Solves for the passive columns' weights once. Three columns span the space; their own equations then give the target
 * to rounding, however flat they lie (a thin rod's moments are small), while normal equations square that flatness. */
static bool solve_columns(const generators *g, const int *passive, int n, const real target[3], real *weights)
{
  real m[3][4];
  for (int i = 0; i < n; i++) {
    for (int k = 0; k < n; k++)
      m[i][k] = n == 3 ? g->column[passive[k]][i] : dot3(g->column[passive[i]], g->column[passive[k]]);
    m[i][n] = n == 3 ? target[i] : dot3(g->column[passive[i]], target);
  }
  if (!solve_linear(n, 4, m[0], 64 * REAL_EPSILON))
    return false;
  for (int i = 0; i < n; i++)
    weights[i] = m[i][n];
  return true;
}

/* What the passive columns leave of the target. */
static void remainder_of(const generators *g, const int *passive, int n, const real target[3],
                         const real *weights, real left[3])
{
  for (int k = 0; k < 3; k++) {
    left[k] = target[k];
    for (int i = 0; i < n; i++)
      left[k] -= weights[i] * g->column[passive[i]][k];
  }
}

/* Least squares over the passive columns: weights that come nearest to the target, with some steps of refinement. */
static bool fit_columns(const generators *g, const int *passive, int n, const real target[3], real *weights)
{
  enum { REFINEMENTS = 2 };
  real left[3], more[3];
  if (!solve_columns(g, passive, n, target, weights))
    return false;
  for (int pass = 0; pass < REFINEMENTS; pass++) {
    remainder_of(g, passive, n, target, weights, left);
    solve_columns(g, passive, n, left, more);
    for (int i = 0; i < n; i++)
      weights[i] += more[i];
  }
  return true;
}

/* The point of the cone of generators nearest to the target (non-negative least squares; the passive set
 * never exceeds three columns, as the space has three dimensions). Returns the distance; `weights` has
 * one entry per generator; `away` points from the nearest point to the target. */
static real nearest_in_cone(const generators *g, const real target[3], real *weights, real away[3])
{
  int passive[4], n = 0;
  real scale = r_sqrt(dot3(target, target));
  for (int i = 0; i < g->count; i++)
    weights[i] = 0;
  for (int k = 0; k < 3; k++)
    away[k] = target[k];
  for (int step = 0; step < BALANCE_STEPS_MAX; step++) {
    int best = -1;
    real size = scale;
    for (int k = 0; k < n; k++)
      size += weights[passive[k]];
    real best_gain = 8 * REAL_EPSILON * size; /* less is the weights' rounding */
    for (int i = 0; i < g->count; i++) {
      bool used = false;
      for (int k = 0; k < n; k++)
        used |= passive[k] == i;
      real gain = dot3(g->column[i], away);
      if (!used && gain > best_gain)
        best_gain = gain, best = i;
    }
    if (best < 0 || n == 3)
      break;
    passive[n++] = best;
    real trial[4] = {0};
    while (n > 0) {
      if (!fit_columns(g, passive, n, target, trial)) {
        n--; /* the new column depends on the others: it can give nothing */
        if (n == 0 || !fit_columns(g, passive, n, target, trial))
          break;
      }
      real step_length = 1;
      int leaving = -1;
      for (int k = 0; k < n; k++)
        if (trial[k] <= 0) {
          real drop = weights[passive[k]] - trial[k], part = drop > 0 ? weights[passive[k]] / drop : 0;
          if (leaving < 0 || part < step_length)
            step_length = part, leaving = k;
        }
      for (int k = 0; k < n; k++)
        weights[passive[k]] += step_length * (trial[k] - weights[passive[k]]);
      if (leaving < 0)
        break;
      weights[passive[leaving]] = 0;
      passive[leaving] = passive[--n];
    }
    for (int k = 0; k < n; k++)
      trial[k] = weights[passive[k]];
    remainder_of(g, passive, n, target, trial, away);
    if (dot3(away, away) <= REAL_EPSILON * REAL_EPSILON * scale * scale)
      break;
  }
  return r_sqrt(dot3(away, away));
}

static void needed_wrench(const core *c, real target[3])
{
  wrench load = load_about(c, c->contacts[0].place);
  target[0] = -load.f.x, target[1] = -load.f.y, target[2] = -load.m / c->body.size;
}

/* Direction of freedom of a bound force: wrench columns per contact, 0 to 2 of them. */
static int free_columns(const balance *q, int i, real columns[2][3], real basis[2][2])
{
  if (q->bound[i] == BOUND_ZERO)
    return 0;
  if (q->bound[i] != BOUND_NONE) {
    basis[0][0] = 1 / q->edge_length[i], basis[0][1] = (real)q->bound[i] * q->mu[i] / q->edge_length[i];
    for (int k = 0; k < 3; k++)
      columns[0][k] = basis[0][0] * q->wrench_n[i][k] + basis[0][1] * q->wrench_t[i][k];
    return 1;
  }
  for (int k = 0; k < 3; k++)
    columns[0][k] = q->wrench_n[i][k], columns[1][k] = q->wrench_t[i][k];
  basis[0][0] = 1, basis[0][1] = 0, basis[1][0] = 0, basis[1][1] = 1;
  return 2;
}

static void gram_of(const balance *q, real gram[3][3])
{
  real columns[2][3], basis[2][2];
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++)
      gram[a][b] = 0;
  for (int i = 0; i < q->count; i++) {
    int free = free_columns(q, i, columns, basis);
    for (int k = 0; k < free; k++)
      for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
          gram[a][b] += columns[k][a] * columns[k][b];
  }
}

/* A generalised inverse of the Gram matrix A B B^T A^T of the forces that the bounds leave free: sweeps with
 * diagonal pivots, stopping where the rest is rounding. Directions that no free force has stay out of it. */
static bool invert_gram(balance *q)
{
  real g[3][3], trace;
  bool swept[3] = {false, false, false};
  gram_of(q, g);
  trace = g[0][0] + g[1][1] + g[2][2];
  for (int rank = 0; rank < 3; rank++) {
    int k = -1;
    for (int a = 0; a < 3; a++)
      if (!swept[a] && (k < 0 || g[a][a] > g[k][k]))
        k = a;
    if (g[k][k] <= 1024 * REAL_EPSILON * trace)
      break;
    swept[k] = true;
    real pivot = g[k][k];
    for (int a = 0; a < 3; a++)
      for (int b = 0; b < 3; b++)
        if (a != k && b != k)
          g[a][b] -= g[a][k] * g[k][b] / pivot;
    for (int a = 0; a < 3; a++)
      if (a != k) {
        g[a][k] /= pivot;
        g[k][a] = g[a][k];
      }
    g[k][k] = -1 / pivot;
  }
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++)
      q->inverse[a][b] = swept[a] && swept[b] ? -g[a][b] : 0;
  return swept[0] || swept[1] || swept[2];
}

/* Least norm under the bounds: f = B B^T A^T y with A f = target, with some steps of refinement. Returns what is
 * left of the target. */
static real bounded_least_norm(const balance *q, const real target[3], real *n, real *t, real y[3])
{
  enum { REFINEMENTS = 4 };
  real columns[2][3], basis[2][2], left[3] = {target[0], target[1], target[2]};
  real scale = dot3(target, target);
  for (int i = 0; i < q->count; i++)
    n[i] = t[i] = 0;
  y[0] = y[1] = y[2] = 0;
  for (int pass = 0; pass < REFINEMENTS; pass++) {
    real dy[3];
    for (int a = 0; a < 3; a++)
      dy[a] = dot3(q->inverse[a], left);
    for (int a = 0; a < 3; a++)
      y[a] += dy[a];
    for (int i = 0; i < q->count; i++) {
      int free = free_columns(q, i, columns, basis);
      for (int k = 0; k < free; k++) {
        real along = dot3(columns[k], dy);
        n[i] += along * basis[k][0];
        t[i] += along * basis[k][1];
        for (int a = 0; a < 3; a++)
          left[a] -= along * columns[k][a];
      }
    }
    if (dot3(left, left) <= 64 * REAL_EPSILON * REAL_EPSILON * scale)
      break;
  }
  return r_sqrt(dot3(left, left));
}

/* How far contact i's force is inside the side k of its cone. */
static real inside_side(const balance *q, int i, int k, real n, real t)
{
  return q->mu[i] == 0 ? n : q->mu[i] * n - (real)k * t;
}

static bool all_inside(const balance *q, const real *n, const real *t)
{
  for (int i = 0; i < q->count; i++)
    for (int k = -1; k <= 1; k += 2)
      if (q->bound[i] != BOUND_ZERO && q->bound[i] != k && inside_side(q, i, k, n[i], t[i]) < 0)
        return false;
  for (int i = 0; i < q->count; i++)
    if (n[i] < 0)
      return false;
  return true;
}

/* The bound whose force would rather go inside its cone most, or -1 if the norm is least. */
static int worst_bound(const balance *q, const real *n, const real *t, const real y[3], const real target[3],
                       int *to)
{
  int worst = -1;
  real best = 64 * REAL_EPSILON * r_sqrt(dot3(target, target));
  for (int i = 0; i < q->count; i++) {
    if (q->bound[i] == BOUND_NONE)
      continue;
    real pull_n = dot3(q->wrench_n[i], y) - n[i], pull_t = dot3(q->wrench_t[i], y) - t[i];
    real length = q->edge_length[i];
    if (q->bound[i] == BOUND_ZERO) {
      for (int k = -1; k <= 1; k += 2) {
        real gain = (pull_n + (real)k * q->mu[i] * pull_t) / length;
        if (gain > best)
          best = gain, worst = i, *to = k;
      }
    } else if (q->mu[i] > 0) {
      real gain = (q->mu[i] * pull_n - (real)q->bound[i] * pull_t) / length;
      if (gain > best)
        best = gain, worst = i, *to = BOUND_NONE;
    }
  }
  return worst;
}

/* Most often the bounds of the forces shown last give forces for this load too. */
static bool last_bounds_do(const core *c, balance *q, const real target[3])
{
  if (!q->bounds_known)
    return false;
  bool same =
    q->last_target[0] == target[0] && q->last_target[1] == target[1] && q->last_target[2] == target[2];
  if (!same) {
    for (int k = 0; k < 3; k++)
      q->last_target[k] = target[k];
    q->last_do = bounded_least_norm(q, target, q->last_n, q->last_t, q->last_y) <= balance_slack(c) / 4 &&
                 all_inside(q, q->last_n, q->last_t);
  }
  return q->last_do;
}

static bool cones_balance(core *c)
{
  balance *q = current_balance(c);
  real target[3], weights[CONES_MAX], away[3];
  needed_wrench(c, target);
  if (last_bounds_do(c, q, target))
    return true;
  generators g;
  cone_generators(q, &g);
  return nearest_in_cone(&g, target, weights, away) <= balance_slack(c);
}

/* JUDGE: forces exist that balance with N >= 0 and |T| <= mu_s N. */
static bool loads_balance(core *c)
{
  real slack = balance_slack(c);
  if (c->contact_count == 0)
    return true;
  if (all_at_one_vertex(c)) { /* its moment is zero: HOLD or a slide has seen to that */
    vec planes[3], f = v_neg(spring_force(c));
    int count = vertex_cone_planes(c, planes);
    for (int k = 0; k < count; k++)
      if (v_dot(planes[k], f) < -slack)
        return false;
    return true;
  }
  if (is_pair(c)) {
    real low, high;
    int tightest[2];
    force_line l = two_contact_forces(c, load_about(c, c->contacts[0].place), 0, 1);
    line_constraints q = constraints_of(&l, slack);
    return feasible_interval(&q, &low, &high, tightest);
  }
  return cones_balance(c);
}

/* ---- the forces that are shown ---- */

/* Into the cone, for what the tolerances of JUDGE let stand a little outside. */
static vec clamp_to_cone(const surface *s, vec f)
{
  real n = r_max(0, v_dot(f, s->n)), t = v_dot(f, s->t);
  if (s->mu_s > 1) { /* there N is the smaller one: mu_s times its rounding would be much of T */
    n = r_max(n, r_abs(t) / s->mu_s);
  } else {
    real limit = s->mu_s * n;
    t = r_max(-limit, r_min(limit, t));
  }
  return v_add(v_scale(s->n, n), v_scale(s->t, t));
}

static void least_norm_of_two(const core *c, vec *forces)
{
  force_line l = two_contact_forces(c, load_about(c, c->contacts[0].place), 0, 1);
  real low, high, x = v_dot(v_sub(l.first, l.second), l.d) / 2; /* least |first|^2 + |second|^2 */
  int tightest[2];
  line_constraints q = constraints_of(&l, 0);
  if (!feasible_interval(&q, &low, &high, tightest)) {
    q = constraints_of(&l, balance_slack(c));
    feasible_interval(&q, &low, &high, tightest);
  }
  /* Crossed by rounding (N = 0 at a large mu_s): the member that is least outside. */
  x = low <= high ? r_max(low, r_min(high, x)) : (low + high) / 2;
  forces[0] = v_mix(l.first, -x, l.d);
  forces[1] = v_mix(l.second, x, l.d);
}

/* A basic solution inside the cones, and the bounds that it has active. */
static void start_inside(balance *q, real target[3], real *n, real *t)
{
  generators g;
  real away[3], weights[CONES_MAX] = {0};
  cone_generators(q, &g);
  nearest_in_cone(&g, target, weights, away);
  for (int k = 0; k < 3; k++)
    target[k] -= away[k]; /* what the cones can give: within tolerance all of it */
  for (int i = 0; i < q->count; i++) {
    real scale = 1 / q->edge_length[i], low = weights[2 * i], high = weights[2 * i + 1];
    n[i] = (low + high) * scale;
    t[i] = (high - low) * q->mu[i] * scale;
    q->bound[i] = low > 0 && high > 0 ? BOUND_NONE : high > 0 ? BOUND_HIGH : low > 0 ? BOUND_LOW : BOUND_ZERO;
    if (q->mu[i] == 0 && q->bound[i] == BOUND_NONE)
      q->bound[i] = BOUND_HIGH;
  }
}

/* The least-norm member of the set { f_i in cone i, sum of wrenches = target }: a primal active set method.
 * Every iterate is inside the cones, so whatever ends it leaves an admissible answer. */
static void least_norm_of_many(core *c, vec *forces)
{
  balance *q = current_balance(c);
  real target[3], n[CONTACTS_MAX], t[CONTACTS_MAX], y[3], *now_n = q->last_n, *now_t = q->last_t;
  int to = BOUND_NONE;
  needed_wrench(c, target);
  bool done = last_bounds_do(c, q, target) && worst_bound(q, now_n, now_t, q->last_y, target, &to) < 0;
  if (!done) {
    q->bounds_known = false;
    start_inside(q, target, now_n, now_t);
  }
  for (int step = 0; step < NORM_STEPS_MAX && !done; step++) {
    /* Where the free forces are all but dependent they may miss the target: what balances stays. */
    if (!invert_gram(q) || bounded_least_norm(q, target, n, t, y) > balance_slack(c) / 4)
      break;
    real part = 1;
    int hit = -1, side = 0;
    for (int i = 0; i < q->count; i++)
      for (int k = -1; k <= 1; k += 2) {
        if (q->bound[i] == BOUND_ZERO || q->bound[i] == k)
          continue;
        real now = inside_side(q, i, k, now_n[i], now_t[i]), then = inside_side(q, i, k, n[i], t[i]);
        if (then >= 0 || now - then <= 0)
          continue;
        real reach = r_max(0, now) / (now - then);
        if (reach < part)
          part = reach, hit = i, side = k;
      }
    for (int i = 0; i < q->count; i++) {
      now_n[i] += part * (n[i] - now_n[i]);
      now_t[i] += part * (t[i] - now_t[i]);
    }
    if (hit >= 0) {
      q->bound[hit] = q->bound[hit] == BOUND_NONE && q->mu[hit] > 0 ? side : BOUND_ZERO;
      continue;
    }
    int release = worst_bound(q, now_n, now_t, y, target, &to);
    done = release < 0;
    if (!done)
      q->bound[release] = to;
  }
  if (done && !q->bounds_known) {
    q->bounds_known = true;
    q->last_target[0] = NAN; /* solved for no load yet */
  }
  for (int i = 0; i < q->count; i++) {
    const surface *s = &c->body.surfaces[c->contacts[i].surface];
    forces[i] = v_add(v_scale(s->n, now_n[i]), v_scale(s->t, now_t[i]));
  }
}

/* Contact forces in the order of the contacts, over k_p. */
static void least_norm_forces(core *c, vec *forces)
{
  if (c->contact_count == 1)
    forces[0] = v_neg(spring_force(c));
  else if (is_pair(c))
    least_norm_of_two(c, forces);
  else if (c->contact_count > 0)
    least_norm_of_many(c, forces);
  for (int i = 0; i < c->contact_count; i++)
    forces[i] = clamp_to_cone(&c->body.surfaces[c->contacts[i].surface], forces[i]);
}

/* The contacts hold whatever the hand does: their cones span every wrench. For two contacts this is when
 * the line that joins them runs inside both cones. */
static bool cones_span_all(const core *c, const balance *q)
{
  if (is_pair(c)) {
    vec d = v_sub(c->contacts[1].place, c->contacts[0].place);
    const surface *a = &c->body.surfaces[c->contacts[0].surface],
                  *b = &c->body.surfaces[c->contacts[1].surface];
    for (int sense = 0; sense < 2; sense++, d = v_neg(d)) {
      bool inside_a = a->mu_s * v_dot(a->n, d) > r_abs(v_dot(a->t, d));
      bool inside_b = b->mu_s * -v_dot(b->n, d) > r_abs(v_dot(b->t, d));
      if (inside_a && inside_b)
        return true;
    }
    return false;
  }
  generators g;
  real weights[CONES_MAX], away[3];
  cone_generators(q, &g);
  for (int axis = 0; axis < 3; axis++)
    for (int sense = -1; sense <= 1; sense += 2) {
      real target[3] = {0, 0, 0};
      target[axis] = (real)sense;
      if (nearest_in_cone(&g, target, weights, away) > TOLERANCE)
        return false;
    }
  return true;
}

static bool is_wedged(core *c)
{
  if (c->contact_count < 2 || all_at_one_vertex(c))
    return false;
  balance *q = current_balance(c);
  if (!q->wedge_known)
    q->wedged = cones_span_all(c, q);
  q->wedge_known = true;
  return q->wedged;
}

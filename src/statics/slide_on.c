/* mu_s = mu_d: no jumps. Once a slide has reached its balance, the contacts slide on with the hand without
 * events; a contact sticks when its place would move back. It is the limit of the rule for h_min -> 0.
 *
 * Along the hand's path every unbalanced moment is again linear in the hand's time, so the angle moves one
 * way only until a fold. What may end the sliding - a normal force, the place's speed, a gap - is held
 * against bounds on how fast it can change, piece by piece. */
#include "statics.h"

enum { GUARDS_MAX = 3 };

#define GRAZING_PIECE (R(1.0) / 1024)

/* How a stretch of sliding ended. */
typedef enum slide_end {
  SLIDE_ON_TO_SAMPLE,
  SLIDE_ON_STUCK, /* the place would move back: no event */
  SLIDE_ON_EVENT, /* a touch, N = 0 or a fold comes next */
  SLIDE_ON_UNSURE /* nothing more could be proven in the steps allowed */
} slide_end;

/* Sliding with one degree of freedom from the pose at s = 0 on; s runs from 0 to 1 over the rest of the
 * hand's path. Waves and curves are those of the hand at s = 0 and at s = 1. */
typedef struct sliding_branch {
  core *c;
  int contact_count;
  path paths[2];
  curve drives[2];
  wave normals[2][2]; /* [hand][contact] */
  real shifts[2];     /* of the place at the present angle: balance before turning */
  bool single;
  real slack; /* what a balance may be off */
  vec w;      /* single: t + sigma mu n, the place is w . (h - r) */
  real sigma;
  int gap_count; /* single: gaps to other surfaces that depend on the place as well, in c->gaps */
  real x_max;
} sliding_branch;

typedef struct sliding_point {
  real s, x;
  real stiffness;          /* -(d drive / dx), positive */
  real pull;               /* d drive / ds */
  real guards[GUARDS_MAX]; /* all positive while the sliding goes on */
} sliding_point;

static real mix(real a, real s, real b)
{
  return a + s * (b - a);
}

static curve curve_between(const curve *a, real s, const curve *b)
{
  curve r = {mix(a->k0, s, b->k0), mix(a->k1, s, b->k1), mix(a->c1, s, b->c1),
             mix(a->s1, s, b->s1), mix(a->c2, s, b->c2), mix(a->s2, s, b->s2)};
  return r;
}

static real curve_rate(const curve *g, real x)
{
  real c = r_cos(x), s = r_sin(x);
  return g->k1 - g->c1 * s + g->s1 * c + 2 * (g->s2 * (c * c - s * s) - g->c2 * (2 * s * c));
}

static int guard_count(const sliding_branch *b)
{
  return b->contact_count + (b->single ? 1 : 0);
}

static sliding_point sliding_at(sliding_branch *b, real s)
{
  core *c = b->c;
  sliding_point p = {.s = s};
  curve g = curve_between(&b->drives[0], s, &b->drives[1]);
  if (curve_at(&g, 0) > 0)
    curve_first_zero(&g, b->x_max, &p.x, &c->report->iterations);
  p.stiffness = -curve_rate(&g, p.x);
  p.pull = curve_at(&b->drives[1], p.x) - curve_at(&b->drives[0], p.x);
  for (int k = 0; k < b->contact_count; k++)
    p.guards[k] = mix(wave_at(&b->normals[0][k], p.x), s, wave_at(&b->normals[1][k], p.x)) + b->slack;
  if (!b->single)
    return p;
  const path *f = &b->paths[0];
  real turn_rate = p.stiffness > 0 ? p.pull / p.stiffness : 0; /* of x */
  real place_rate = f->xi_s * r_cos(p.x) - f->xi_c * r_sin(p.x);
  p.guards[1] = b->sigma * (b->shifts[1] - b->shifts[0] + place_rate * turn_rate);
  return p;
}

static real sliding_gap_at(const sliding_branch *b, const sliding_gap *g, const sliding_point *p)
{
  return wave_at(&g->turn, p->x) + mix(b->shifts[0], p->s, b->shifts[1]) * g->along;
}

/* Largest rates of the guards and of the turn over a piece; false if a fold cannot be excluded. */
static bool sliding_rates(const sliding_branch *b, const sliding_point *p, const sliding_point *q,
                          real *rates, real *turn)
{
  const curve *g = b->drives;
  real first =
    r_max(r_sqrt(g[0].c1 * g[0].c1 + g[0].s1 * g[0].s1), r_sqrt(g[1].c1 * g[1].c1 + g[1].s1 * g[1].s1));
  real second =
    r_max(r_sqrt(g[0].c2 * g[0].c2 + g[0].s2 * g[0].s2), r_sqrt(g[1].c2 * g[1].c2 + g[1].s2 * g[1].s2));
  real d1 = r_abs(g[1].c1 - g[0].c1) + r_abs(g[1].s1 - g[0].s1),
       d2 = r_abs(g[1].c2 - g[0].c2) + r_abs(g[1].s2 - g[0].s2);
  real bend = first + 4 * second, cross = d1 + 2 * d2 + r_abs(g[1].k1 - g[0].k1);
  real ds = q->s - p->s, dx = r_abs(q->x - p->x);
  real least = (p->stiffness + q->stiffness - bend * dx - cross * ds) / 2;
  if (!(least > 0))
    return false;
  real pull = r_max(r_abs(p->pull), r_abs(q->pull)) + cross * dx;
  real turn_rate = *turn = pull / least, turn_bend = (bend * turn_rate + 2 * cross) * turn_rate / least;
  for (int k = 0; k < b->contact_count; k++) {
    const wave *n0 = &b->normals[0][k], *n1 = &b->normals[1][k];
    real amplitude = r_max(r_abs(n0->c) + r_abs(n0->s), r_abs(n1->c) + r_abs(n1->s));
    real change = r_abs(n1->k - n0->k) + r_abs(n1->c - n0->c) + r_abs(n1->s - n0->s);
    rates[k] = amplitude * turn_rate + change;
  }
  if (!b->single)
    return true;
  const path *f = &b->paths[0];
  real xi = r_abs(f->xi_c) + r_abs(f->xi_s);
  rates[1] = xi * (turn_rate * turn_rate + turn_bend);
  return true;
}

/* Do all gaps stay open over a piece? *closed: one is closed at its end. */
static bool gaps_stay_open(const sliding_branch *b, const sliding_point *p, const sliding_point *q,
                           real turn_rate, bool *closed)
{
  bool open = true;
  for (int k = 0; k < b->gap_count; k++) {
    const sliding_gap *g = &b->c->gaps[k];
    real start = sliding_gap_at(b, g, p), end = sliding_gap_at(b, g, q);
    real rate =
      (r_abs(g->turn.c) + r_abs(g->turn.s)) * turn_rate + r_abs((b->shifts[1] - b->shifts[0]) * g->along);
    *closed |= end < 0;
    open = open && start + end > rate * (q->s - p->s);
  }
  return open;
}

/* What ends a proven stretch, besides the index of a guard. */
enum { LOST_NONE = -1, LOST_FOLD = -2, LOST_STEPS = -3, LOST_GAP = -4 };

/* The last s up to which all guards are proven positive. */
static real last_sliding(sliding_branch *b, real s_end, int *lost)
{
  enum { DEPTH_MAX = 64, PIECES = 1024 };
  sliding_point stack[DEPTH_MAX], p = sliding_at(b, 0);
  int depth = 0, count = guard_count(b);
  stack[depth++] = sliding_at(b, s_end);
  *lost = LOST_NONE;
  for (int piece = 0; piece < PIECES && depth > 0; piece++) {
    sliding_point q = stack[depth - 1];
    real rates[GUARDS_MAX] = {0}, turn_rate = 0, ds = q.s - p.s, middle = (p.s + q.s) / 2;
    bool quiet = sliding_rates(b, &p, &q, rates, &turn_rate), closed = false;
    int bad = quiet ? LOST_NONE : LOST_FOLD;
    for (int k = 0; k < count; k++) {
      if (q.guards[k] < 0 && (p.guards[k] > 0 || k != 1 || !b->single))
        bad = k;
      /* A normal force may stay at zero (k_theta = 0, the vertex rolled along): no bound proves that. */
      bool grazes = k < b->contact_count && ds <= GRAZING_PIECE && p.guards[k] >= 0 && q.guards[k] >= 0;
      quiet = quiet && (grazes || p.guards[k] + q.guards[k] > rates[k] * ds);
    }
    quiet = gaps_stay_open(b, &p, &q, turn_rate, &closed) && quiet;
    bad = closed ? LOST_GAP : bad;
    if (b->single && p.s == 0 && p.guards[1] < 0) { /* it moves back at once */
      *lost = 1;
      return 0;
    }
    if (!quiet && ds > R(1e-12) && depth < DEPTH_MAX && middle > p.s && middle < q.s) {
      stack[depth++] = sliding_at(b, middle);
      continue;
    }
    if (!quiet && bad != LOST_NONE) {
      *lost = bad;
      return p.s;
    }
    p = q;
    depth--;
  }
  if (depth == 0)
    return s_end;
  *lost = LOST_STEPS;
  return p.s;
}

/* Brings a contact to where the sliding has come; recorded as a slip, but no event that starts a window. */
static void advance_contact(core *c, contact *k, vec place)
{
  vec on_surface = onto_surface(c, place, k->surface);
  real length = v_length(v_sub(on_surface, k->place));
  k->place = on_surface;
  c->balance.known = false;
  c->slid_on += length;
  if (length > R(1e-12) * c->body.size)
    record(c, STIC_EVENT_SLIP, k->vertex, k->surface, on_surface, length);
}

/* ---- one vertex ---- */

static void single_branch(core *c, const hand *from, const hand *to, sliding_branch *b)
{
  contact *k = &c->contacts[0];
  const surface *s = &c->body.surfaces[k->surface];
  const hand *hands[2] = {from, to};
  real friction = c->sliding_sense * s->mu_d, dir = 0;
  b->single = true;
  b->contact_count = 1;
  b->sigma = c->sliding_sense;
  for (int i = 1; i >= 0; i--) {
    c->hand = *hands[i];
    vec force = spring_force(c);
    b->shifts[i] = v_dot(force, s->t) + friction * v_dot(force, s->n);
    vec place = v_mix(k->place, b->shifts[i], s->t);
    vec arm = v_sub(holding_point(c), k->place);
    if (i == 1)
      dir = r_sign(v_cross(arm, v_mix(force, -b->shifts[i], s->t)) + spring_moment(c));
    b->paths[i] = path_sliding(c, k->vertex, place, s->t, s->n, friction, dir);
    b->drives[i] = b->paths[i].drive;
    b->normals[i][0] = path_force_along(&b->paths[i], v_neg(s->n));
  }
}

/* Gaps that depend on the place too: those to surfaces that the sliding one is not parallel to. False: too many. */
static bool single_gaps(core *c, sliding_branch *b)
{
  path at_rest = b->paths[0];
  at_rest.origin = c->contacts[0].place;
  real reach = r_abs(b->shifts[0]) + r_abs(b->shifts[1]) +
               b->x_max * (2 * c->body.radius + r_abs(at_rest.xi_c) + r_abs(at_rest.xi_s));
  near_update(c, reach);
  for (near_pair k = {0}; next_near(c, &k);) {
    if (v_dot(c->body.surfaces[k.surface].n, at_rest.t) == 0)
      continue;
    wave gap = path_gap(c, &at_rest, k.vertex, k.surface);
    if (gap.k + gap.c > reach + c->noise)
      continue;
    if (b->gap_count == SLIDING_GAPS_MAX)
      return false;
    c->gaps[b->gap_count++] = (sliding_gap){gap, v_dot(c->body.surfaces[k.surface].n, at_rest.t)};
  }
  return true;
}

/* ---- two vertices on two surfaces ---- */

static bool trammel_branch(core *c, const hand *from, const hand *to, sliding_branch *b)
{
  const hand *hands[2] = {from, to};
  b->contact_count = 2;
  for (int i = 0; i < 2; i++) {
    c->hand = *hands[i];
    trammel m = trammel_path(c, 0, 1, c->sliding_sense);
    b->paths[i] = m.path;
    if (!trammel_forces(c, &m, 0, 1, 0, &b->normals[i][0], &b->normals[i][1], &b->drives[i]))
      return false;
    real reversal =
      r_min(wave_next_zero(&m.speed_first, 2 * R_PI), wave_next_zero(&m.speed_second, 2 * R_PI));
    b->x_max = r_min(reversal, 2 * R_PI);
  }
  return true;
}

/* The first touch up to x of those that depend on the angle alone. False: the other gaps are too many. */
static bool touch_by_turning(core *c, sliding_branch *b, real x, touch *t)
{
  *t = (touch){R_HUGE, 0, 0};
  if (!b->single) {
    *t = path_first_touch(c, &b->paths[0], x);
    return true;
  }
  if (!single_gaps(c, b))
    return false;
  near_update(c, x * 2 * c->body.radius);
  for (near_pair k = {0}; next_near(c, &k);) {
    if (v_dot(c->body.surfaces[k.surface].n, b->paths[0].t) != 0)
      continue;
    wave gap = path_gap(c, &b->paths[0], k.vertex, k.surface);
    keep_earlier(t, wave_first_down(&gap, c->noise, x), k.vertex, k.surface);
  }
  return true;
}

/* The s at which the angle comes to *x_stop; 1, and *x_stop huge, if the branch folds before. */
static real s_of_angle(sliding_branch *b, real *x_stop)
{
  real before = curve_at(&b->drives[0], *x_stop), after = curve_at(&b->drives[1], *x_stop);
  real s = after > before ? r_max(0, r_min(1, -before / (after - before))) : 1;
  if (sliding_at(b, s).x >= *x_stop - ANGLE_TIE)
    return s;
  *x_stop = R_HUGE;
  return 1;
}

static void advance_to(core *c, sliding_branch *b, real s)
{
  sliding_point p = sliding_at(b, s);
  path f = b->paths[0];
  if (!(s > 0))
    return;
  if (b->single)
    f.origin = v_mix(c->contacts[0].place, mix(b->shifts[0], s, b->shifts[1]), f.t);
  path_set_pose(c, &f, p.x);
  advance_contact(c, &c->contacts[0], path_place(&f, p.x));
  if (!b->single)
    advance_contact(c, &c->contacts[1], world_vertex(c, c->contacts[1].vertex));
}

/* Slides along the turning branch as far as it goes; *part is how far along the rest of the path. */
static slide_end slide_on_turning(core *c, const hand *from, const hand *to, real *part)
{
  sliding_branch b = {.c = c, .x_max = 2 * R_PI};
  c->hand = *to;
  b.slack = balance_slack(c);
  *part = 0;
  if (c->contact_count == 1)
    single_branch(c, from, to, &b);
  else if (!trammel_branch(c, from, to, &b))
    return SLIDE_ON_EVENT;
  bool moves = curve_at(&b.drives[1], 0) > 0;
  if (!moves && !b.single)
    return SLIDE_ON_STUCK;
  real x = 0;
  bool reverses = false; /* one contact of a trammel */
  if (moves)
    reverses = !curve_first_zero(&b.drives[1], b.x_max, &x, &c->report->iterations) && b.x_max < 2 * R_PI;
  b.x_max = x;
  touch t;
  if (!touch_by_turning(c, &b, x, &t))
    return SLIDE_ON_UNSURE;
  real x_stop = t.at < R_HUGE ? t.at : reverses ? x : R_HUGE;
  real s_end = x_stop < R_HUGE ? s_of_angle(&b, &x_stop) : 1;
  int lost;
  *part = last_sliding(&b, s_end, &lost);
  advance_to(c, &b, *part);
  if (b.single && lost == 1)
    return SLIDE_ON_STUCK;
  if (lost == LOST_STEPS)
    return SLIDE_ON_UNSURE;
  return lost != LOST_NONE || x_stop < R_HUGE ? SLIDE_ON_EVENT : SLIDE_ON_TO_SAMPLE;
}

/* An edge, or the walls of a slot: everything is linear. */
static slide_end slide_on_along(core *c, const hand *from, const hand *to, real *part)
{
  pair_normals start, end;
  real sense = c->sliding_sense;
  *part = 0;
  c->hand = *from;
  if (!normals_along_walls(c, 0, 1, sense, &start))
    return SLIDE_ON_EVENT;
  c->hand = *to;
  if (!normals_along_walls(c, 0, 1, sense, &end) || end.drive_rate >= 0)
    return SLIDE_ON_EVENT;
  real length = end.drive / -end.drive_rate;
  if (length < 0)
    return SLIDE_ON_STUCK;
  real first = end.first + end.first_rate * length, second = end.second + end.second_rate * length;
  vec travel = v_scale(c->body.surfaces[c->contacts[0].surface].t, sense * length);
  touch t = first_touch_moving(c, travel, 0);
  real stop = r_min(1, t.at);
  if (first < 0)
    stop = r_min(stop, start.first / (start.first - first));
  if (second < 0)
    stop = r_min(stop, start.second / (start.second - second));
  *part = r_max(0, stop);
  if (*part == 0)
    return SLIDE_ON_EVENT;
  travel = v_scale(travel, *part);
  c->p = v_add(c->p, travel);
  for (int i = 0; i < 2; i++)
    advance_contact(c, &c->contacts[i], v_add(c->contacts[i].place, travel));
  return *part < 1 ? SLIDE_ON_EVENT : SLIDE_ON_TO_SAMPLE;
}

static slide_end slide_on(core *c, const hand *from, const hand *to, real *part)
{
  bool along = c->contact_count == 2 && are_parallel(c, 0, 1);
  c->noise = gap_noise(c);
  slide_end e = along ? slide_on_along(c, from, to, part) : slide_on_turning(c, from, to, part);
  c->report->decisions |= STIC_DECISION_SLIDE_ON;
  forget_opened_that_left(c);
  return e;
}

/* After a RELAX whose last slide reached its balance: does the sliding go on without events? */
static bool slides_on(const core *c)
{
  if (c->contact_count < 1 || c->contact_count > 2 || (c->contact_count == 2 && all_at_one_vertex(c)))
    return false;
  for (int i = 0; i < c->contact_count; i++) {
    const surface *s = &c->body.surfaces[c->contacts[i].surface];
    if (s->mu_s > s->mu_d)
      return false;
  }
  return true;
}

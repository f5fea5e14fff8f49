/* Accuracy levels. Between two samples the hand moves on a straight line in position and evenly in angle;
 * at level event a RELAX comes wherever something happens on that path.
 *
 * Why double events cannot be missed: while the contacts stick, the load is linear in the hand's time tau.
 * With two or more vertices held the pose is fixed, the loads that the cones can balance form a convex set,
 * and so do the times: one end, found exactly. With one vertex held the moment A(theta) + tau B(theta) is
 * linear in tau, so the angle moves one way only until a fold; the margins to the cone are bracketed by
 * bounds on their second derivative along that branch. */
#include "statics.h"

enum { PIECES_MAX = 4096, ROOT_STEPS_MAX = 100, ESCALATIONS_MAX = 24 };

/* A stretch of the hand's path, tau in [0, 1]. */
typedef struct hand_path {
  hand from, to;
  vec travel;
  real turn;
} hand_path;

static hand hand_at(const hand_path *w, real tau)
{
  if (tau >= 1)
    return w->to;
  hand r = {v_mix(w->from.h, tau, w->travel), w->from.phi + tau * w->turn};
  return r;
}

typedef struct next_event {
  real at; /* last good tau; R_HUGE: none up to the end */
  bool snap;
} next_event;

static const next_event NO_EVENT = {R_HUGE, false};

#define LOCATED R(1e-12) /* of the sample interval */
#define AFTER_EVENT r_max(LOCATED, 2 * REAL_EPSILON)

/* ---- free: the object follows the hand exactly, so an event is a touch ---- */
static next_event event_free(core *c, const hand_path *w, real tau)
{
  c->hand = w->to;
  vec travel = v_sub(w->to.h, holding_point(c));
  real turn = c->body.kappa > 0 ? w->to.phi - c->theta : 0;
  touch t = first_touch_moving(c, travel, turn);
  next_event e = {t.at == R_HUGE ? R_HUGE : tau + t.at * (1 - tau), false};
  return e;
}

/* ---- one vertex held: the angle follows the hand along one branch of equilibria ---- */

typedef struct branch_point {
  real tau, x;    /* x: angle turned since the start, >= 0 */
  real margin[3]; /* to the planes of the cone, + tolerance; negative: slips or opens */
  real stiffness; /* -(d moment / d angle): positive on a stable branch, zero at a fold */
  real rate[3];   /* of the margins in tau */
} branch_point;

typedef struct branch {
  core *c;
  const hand_path *way;
  vec place, a, a_turn; /* stuck vertex; holding point from it at the start */
  int vertex;
  real dir, arm; /* sense of the turn; |a| */
  vec planes[3];
  int plane_count;
  real plane_length; /* the longest of them */
} branch;

static branch_point branch_at(branch *b, real tau, real x_max)
{
  core *c = b->c;
  branch_point p = {.tau = tau};
  hand at = hand_at(b->way, tau);
  c->hand = at;
  vec d = v_sub(at.h, b->place);
  if (b->dir != 0) {
    path f = path_pinned(c, b->vertex, b->place, b->dir);
    if (curve_at(&f.drive, 0) > 0)
      curve_first_zero(&f.drive, x_max, &p.x, &c->report->iterations);
  }
  real cosine = r_cos(p.x), sine = r_sin(p.x);
  vec r = v_add(v_scale(b->a, cosine), v_scale(b->a_turn, sine));
  vec f = v_sub(r, d); /* the contact's force */
  p.stiffness = v_dot(r, d) + c->body.kappa;
  p.stiffness = b->dir != 0 ? p.stiffness : 0;
  real pull = v_cross(r, b->way->travel) + c->body.kappa * b->way->turn; /* d moment / d tau */
  real theta_rate = p.stiffness > 0 ? pull / p.stiffness : 0;
  vec f_rate = v_mix(v_neg(b->way->travel), theta_rate, v_perp(r));
  real slack = slack_of_load(c, f, at.phi - c->theta - b->dir * p.x);
  for (int k = 0; k < b->plane_count; k++) {
    p.margin[k] = v_dot(b->planes[k], f) + slack;
    p.rate[k] = v_dot(b->planes[k], f_rate);
  }
  return p;
}

/* Bounds over a piece of the branch: the least stiffness, and the largest second derivative of a margin. */
static bool branch_bounds(const branch *b, const branch_point *p, const branch_point *q, real *bend)
{
  const hand_path *w = b->way;
  *bend = 0;
  if (b->dir == 0)
    return true; /* the angle does not change: margins are linear */
  real dtau = q->tau - p->tau, dx = r_abs(q->x - p->x);
  real reach =
    r_max(v_length(v_sub(hand_at(w, p->tau).h, b->place)), v_length(v_sub(hand_at(w, q->tau).h, b->place)));
  real speed = v_length(w->travel);
  real least = (p->stiffness + q->stiffness) / 2 - b->arm * (reach * dx + speed * dtau) / 2;
  if (!(least > 0))
    return false;
  real theta_rate = (b->arm * speed + b->c->body.kappa * r_abs(w->turn)) / least;
  real theta_bend = (b->arm * reach * theta_rate + 2 * b->arm * speed) * theta_rate / least;
  *bend = b->plane_length * b->arm * (theta_bend + theta_rate * theta_rate);
  return true;
}

/* The margin k changes sign once in (p, q): brackets it to LOCATED and returns the good side. */
static real locate_loss(branch *b, branch_point p, branch_point q, int k, real x_max)
{
  real weight_p = p.margin[k], weight_q = q.margin[k];
  int side = 0;
  for (int i = 0; i < ROOT_STEPS_MAX && q.tau - p.tau > LOCATED; i++) {
    real guess = p.tau + (q.tau - p.tau) * weight_p / (weight_p - weight_q);
    real inset = r_min(LOCATED / 2, (q.tau - p.tau) / 4); /* so that one step more closes the bracket */
    guess = r_max(p.tau + inset, r_min(q.tau - inset, guess));
    if (i > 30 || !(guess > p.tau && guess < q.tau))
      guess = (p.tau + q.tau) / 2;
    if (!(guess > p.tau && guess < q.tau))
      break;
    branch_point m = branch_at(b, guess, x_max);
    if (m.margin[k] >= 0) {
      p = m, weight_p = m.margin[k];
      if (side == 1)
        weight_q /= 2;
      side = 1;
    } else {
      q = m, weight_q = m.margin[k];
      if (side == -1)
        weight_p /= 2;
      side = -1;
    }
  }
  return p.tau;
}

/* First event on the branch between p and q: pieces are halved until each is proven quiet, or monotone
 * with a change of sign, or so short that it is the event. */
static next_event scan_branch(branch *b, branch_point p, branch_point end, real x_max)
{
  enum { DEPTH_MAX = 64 };
  branch_point stack[DEPTH_MAX];
  int depth = 0;
  stack[depth++] = end;
  for (int piece = 0; piece < PIECES_MAX && depth > 0; piece++) {
    branch_point q = stack[depth - 1];
    real dtau = q.tau - p.tau, bend = 0;
    bool smooth = branch_bounds(b, &p, &q, &bend), quiet = smooth;
    int lost = -1, losses = 0;
    for (int k = 0; k < b->plane_count; k++) {
      if (p.margin[k] < 0)
        return (next_event){p.tau, false};
      if (r_min(p.margin[k], q.margin[k]) > bend * dtau * dtau / 8)
        continue;
      /* Monotone pieces: a rising margin is quiet, a falling one ends quiet or is lost once. */
      if (smooth && r_abs(p.rate[k]) > bend * dtau) {
        if (q.margin[k] < 0)
          lost = k, losses++;
      } else {
        quiet = false;
      }
    }
    if (quiet && losses == 0) {
      p = q;
      depth--;
      continue;
    }
    if (quiet && losses == 1)
      return (next_event){locate_loss(b, p, q, lost, x_max), false};
    real middle = (p.tau + q.tau) / 2;
    if (dtau <= LOCATED || depth == DEPTH_MAX || !(middle > p.tau && middle < q.tau)) {
      bool bad = !smooth;
      for (int k = 0; k < b->plane_count; k++)
        bad |= q.margin[k] < 0;
      if (bad)
        return (next_event){p.tau, !smooth && losses == 0};
      p = q;
      depth--;
      continue;
    }
    stack[depth++] = branch_at(b, middle, x_max);
  }
  return depth > 0 ? (next_event){p.tau, false} : NO_EVENT;
}

static next_event event_pinned(core *c, const hand_path *w, real tau)
{
  branch b = {.c = c, .way = w, .vertex = c->contacts[0].vertex, .place = c->contacts[0].place};
  b.a = rotate(c->rot, v_sub(c->b, c->body.vertices[b.vertex]));
  b.arm = v_length(b.a);
  b.plane_count = vertex_cone_planes(c, b.planes);
  for (int k = 0; k < b.plane_count; k++)
    b.plane_length = r_max(b.plane_length, v_length(b.planes[k]));
  c->hand = w->to;
  real moment = spring_moment_about(c, b.place), x = 0, x_max = 0, touch_tau = R_HUGE, touch_x = 0;
  if (!is_balanced(c, moment)) {
    b.dir = r_sign(moment);
    b.a_turn = turn_of(b.a, b.dir);
    path f = path_pinned(c, b.vertex, b.place, b.dir);
    curve_first_zero(&f.drive, 2 * R_PI, &x, &c->report->iterations);
    x_max = x;
    touch t = path_first_touch(c, &f, x);
    if (t.at < R_HUGE) {
      touch_x = t.at;
      /* At the touch angle the moment is linear in tau. */
      c->hand = hand_at(w, tau);
      path g = path_pinned(c, b.vertex, b.place, b.dir);
      real before = curve_at(&g.drive, t.at), after = curve_at(&f.drive, t.at);
      real part = after > before ? -before / (after - before) : 1;
      touch_tau = tau + (1 - tau) * r_max(0, r_min(1, part));
    }
  }
  branch_point p = branch_at(&b, tau, x_max), q = branch_at(&b, r_min(1, touch_tau), x_max);
  if (touch_tau < R_HUGE && q.x < touch_x - ANGLE_TIE) {
    /* The branch folds before it reaches that angle. */
    touch_tau = R_HUGE;
    q = branch_at(&b, 1, x_max);
  }
  next_event e = q.tau > p.tau ? scan_branch(&b, p, q, x_max) : NO_EVENT;
  return e.at < touch_tau ? e : (next_event){touch_tau, false};
}

/* ---- two vertices or more held: the pose is fixed, the times without an event are an interval ---- */

static line_constraints constraints_at(core *c, const hand_path *w, real tau)
{
  c->hand = hand_at(w, tau);
  force_line l = two_contact_forces(c, load_about(c, c->contacts[0].place), 0, 1);
  return constraints_of(&l, balance_slack(c));
}

/* The conflict of two constraints is linear in tau, so each root found cuts the bad end off for good. */
static real last_good_of_two(core *c, const hand_path *w, real tau)
{
  line_constraints start = constraints_at(c, w, tau);
  real bad = 1;
  for (int i = 0; i < ROOT_STEPS_MAX; i++) {
    real low, high;
    int tightest[2];
    line_constraints q = constraints_at(c, w, bad);
    if (feasible_interval(&q, &low, &high, tightest))
      break;
    real good_agreement = agreement(&start, tightest), bad_agreement = agreement(&q, tightest);
    if (good_agreement <= 0)
      return tau;
    real cut = tau + (bad - tau) * good_agreement / (good_agreement - bad_agreement);
    bad = r_max(tau, r_min(cut, bad - 2 * REAL_EPSILON)); /* rounding must not hide a second conflict */
  }
  return bad;
}

static next_event event_fixed(core *c, const hand_path *w, real tau)
{
  c->hand = w->to;
  if (loads_balance(c))
    return NO_EVENT;
  if (is_pair(c))
    return (next_event){last_good_of_two(c, w, tau), false};
  real good = tau, bad = 1;
  for (int i = 0; i < ROOT_STEPS_MAX && bad - good > LOCATED; i++) {
    real middle = (good + bad) / 2;
    c->hand = hand_at(w, middle);
    if (loads_balance(c))
      good = middle;
    else
      bad = middle;
  }
  return (next_event){good, false};
}

static next_event find_event(core *c, const hand_path *w, real tau)
{
  if (c->contact_count == 0)
    return event_free(c, w, tau);
  if (all_at_one_vertex(c))
    return event_pinned(c, w, tau);
  return event_fixed(c, w, tau);
}

/* ---- level event ---- */

/* Sliding on without events counts as one slip per sample. */
static void count_slide_on(core *c)
{
  if (c->slid_on > R(1e-12) * c->body.size) {
    c->report->flags |= STIC_FLAG_SLIPPED;
    c->report->slips++;
  }
  c->slid_on = 0;
}

/* Work of the sample so far, about in units of a step of root finding (30 to 70 ns in f64): events that each need many
 * stages or a flow must not hold up the loop. Of 70,000 samples of wild hands none that ends well needs more than
 * 644,000, and a recorded hand's hardly 10,000. */
static int work_done(const core *c)
{
  return c->report->iterations + 16 * c->stages + 4 * c->flow_solves;
}

static void record_snap(core *c, real turn)
{
  bool held = c->contact_count > 0;
  c->report->decisions |= STIC_DECISION_SNAP;
  record(c, STIC_EVENT_SNAP, held ? c->contacts[0].vertex : -1, held ? c->contacts[0].surface : -1,
         held ? c->contacts[0].place : holding_point(c), turn);
}

/* RELAX just after an event. Located to rounding, the judgement may still see rest: a little later it does not.
 * Returns where on the path. */
static real relax_after(core *c, const hand_path *w, real tau, real next, bool snap, double t_from,
                        double t_to)
{
  real offset = AFTER_EVENT;
  for (int i = 0; i < ESCALATIONS_MAX; i++) {
    next = r_min(1, r_max(next, tau + REAL_EPSILON));
    relax(c, hand_at(w, next), t_from + (double)next * (t_to - t_from));
    c->happened |= snap;
    if (c->window_open || c->happened || next >= 1)
      break;
    offset *= 4;
    next += offset;
  }
  return next;
}

static void follow_event(core *c, hand from, hand to, double t_from, double t_to)
{
  hand_path w = {from, to, v_sub(to.h, from.h), to.phi - from.phi};
  real path_length = v_length(w.travel) + c->body.size * r_abs(w.turn);
  real window = path_length > 0 ? (real)c->settings.h_min * c->body.size / path_length : R(1.0);
  real tau = 0;
  for (int events = 0; tau < 1; events++) {
    if (events == SAMPLE_EVENTS_MAX || c->report->relaxations >= SAMPLE_EVENTS_MAX ||
        work_done(c) > SAMPLE_WORK_MAX) {
      c->report->flags |= STIC_FLAG_LIMIT;
      relax(c, to, t_to);
      c->window_open = c->happened && !c->sliding;
      break;
    }
    next_event e = NO_EVENT;
    real next = tau + window;
    if (c->sliding) {
      real part;
      hand start = hand_at(&w, tau);
      c->event_time = t_to;
      slide_end end = slide_on(c, &start, &to, &part);
      tau += part * (1 - tau);
      if (end == SLIDE_ON_TO_SAMPLE)
        break;
      if (end == SLIDE_ON_STUCK) {
        c->sliding = false;
        continue;
      }
      next = tau + (end == SLIDE_ON_UNSURE ? window : AFTER_EVENT);
    } else if (!c->window_open) {
      c->noise = gap_noise(c);
      e = find_event(c, &w, tau);
      next = e.at < R_HUGE ? e.at + AFTER_EVENT : 1;
    }
    real theta = c->theta;
    next = relax_after(c, &w, tau, next, e.snap, t_from, t_to);
    if (e.snap)
      record_snap(c, r_abs(c->theta - theta));
    c->window_open = c->happened && !c->sliding;
    tau = next;
  }
  count_slide_on(c);
}

/* Without those up to `done` of the way; the hand is at `from` there. */
static void follow_substeps(core *c, hand from, hand to, double t_from, double t_to, double done)
{
  hand_path w = {from, to, v_sub(to.h, from.h), to.phi - from.phi};
  for (int i = 1; i <= c->settings.substeps; i++) {
    double part = (double)i / c->settings.substeps, left = part - done;
    if (part < 1 && left <= 0)
      continue;
    relax(c, hand_at(&w, (real)(part < 1 ? left / (1 - done) : 1)), t_from + part * (t_to - t_from));
  }
}

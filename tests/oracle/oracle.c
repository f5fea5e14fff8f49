/* Brute-force oracle of the statics model. Every motion of RELAX is followed in small steps of its own parameter
 * (0.002 rad; distances, along which all watched quantities are linear, in sixteenths), with bisection on whatever
 * stops it and a golden-section search where a watched quantity passes a minimum near its limit. Forces and gaps are
 * always evaluated from the pose. Internally long double.
 *
 * Where the model leaves room, this is what is done here:
 *
 * HOLD
 *  A1  Free, no contact since before: the holding point g goes straight to the hand while the angle goes linearly with
 *      the same parameter; not the body origin. k_theta = 0: the angle stays in every free motion, also after opening.
 *  A2  The moment's zero is reached where its sign has changed; a zero that is only touched counts if it is <= 0 at the
 *      minimum found. |moment| <= 1e-14 k_p size^2 at the start: no turn, even at an unstable equilibrium.
 *  A3  Several vertices arriving together in a HOLD: only the first (by vertex, then surface) becomes a contact; the
 *      others follow at once in the next stage if the turn drives them in. There is no JUDGE in a stage that ended at a
 *      touch.
 *  A4  The turn is left out only in the stage right after a slide that reached its zero (with the same one vertex);
 *      after a slide that ended by touch or N = 0, after an opening, and after the flow it is done.
 *  A5  A corner (several contacts, one vertex) turns like a single contact.
 * JUDGE
 *  A6  "To 1e-12": Euclidean distance of (F_x, F_y, M/size), M about g, from the cone, over k_p size.
 *  A7  Rule 1, no condition on the gap of the opened contact; N <= 0 is exact, without a tolerance.
 *  A8  Rules 2 and 3: N > 0 and "driven" mean beyond 1e-14 k_p size (a trammel's moment: 1e-14 k_p size^2); otherwise
 *      a slide that ended at N = 0 would be taken up again for ever.
 *  A9  Edge: N_1, N_2 from normal balance and the moment about a point of the surface (friction drops out: the split of
 *      statics at every place). So a pair that must tip cannot slide first (V13), and N changes during the slide. With
 *      the moment about g and friction at mu_d instead, V13 fails for mu_s > b/h_p > mu_d. Driven: |F_t| > mu_d (N_1+N_2).
 *  A10 Parallel walls: the moment is taken about g with friction mu_d N_i at both walls; sigma = sign of F_t.
 *  A11 Trammel: friction at mu_d also at the start, signs from each contact's own motion; the moment about g. The
 *      direction tried is that of the spring's power: friction only takes power away, so the other one is not possible.
 *  A12 Rule 3 is for two and more contacts. Choices of k contacts run in lexicographic order of touching order.
 *      What the others "do alone": one vertex (also a corner) left turns; two at different vertices slide under the
 *      conditions of rule 2; three or more at different vertices do nothing (not possible); none: free.
 *  A13 The turn of one vertex left is possible whatever its N is. "No possible turn": the moment is zero, or some opened
 *      gap does not grow. Then the slide, which is done in the same stage; a turn is done by the next HOLD.
 *  A14 Rates: > 1e-12 size per rad (or 1e-12 per unit of length) grows, < -1e-12 shrinks, between: the second
 *      derivative, which must exceed 1e-9 size per rad^2. Each opened gap is judged alone. If first and second are zero it does not grow.
 *  A15 The slide of the one left: the gap's rate along the translation decides; if that is zero, the turn after it, at
 *      the place where the translation would end (first or second derivative). A negative rate is not repaired.
 *      All opened: likewise the translation to the hand, then the turn to phi about the hand.
 *  A16 A contact opened by rule 1 or 3 whose gap starts to shrink after all without having left (within 1e-12 size)
 *      touches again: otherwise it could sink into the surface. "Left" = gap > 1e-12 size at the end of a motion;
 *      the memory is kept between RELAX calls.
 *  A17 Rule 4: modes are tried in the order stuck, sliding +t, sliding -t, open, the last contact fastest; the first
 *      consistent combination with motion is followed until a touch or until any contact leaves its mode, or to rest.
 *      Redundant (singular) combinations are left out. No combination: no_answer, pose as reached so far.
 * SLIDE
 *  A18 The slide of one contact: "N = 0" is also watched during the translation (where N is constant). The place may go
 *      back against sigma during the turn. "Reached its zero" also where the moment is zero after the translation.
 *  A19 After any slide, also one that ended by N = 0, vertices within 1e-12 size become contacts, but not opened ones
 *      that have not left. The contact that ended a slide comes first in the order, the others by vertex, surface.
 *  A20 A trammel on which N jumps below zero at a friction reversal ends there (as N = 0).
 *  A21 slid "further than 1e-12 size": straight distance of the contact point from the start of the stage, looked at
 *      after each part; the flow's sliding contacts count too.
 * STAGES
 *  A22 A stage is one HOLD with its JUDGE and what follows; the last one, which ends at rest, is counted. At the limit
 *      and without an answer the pose is kept as reached, not taken back to the start of RELAX.
 * EVENT
 *  A23 The last good time is found to better than 1e-15; a time is good if HOLD from the last good pose reaches its
 *      zero without a touch and without crossing angles where the moment grows with the angle (a snap), and then rests.
 *  A24 A RELAX is an event if it did anything but HOLD and rest (touch, slide, opening, flow) or its HOLD snapped. Then
 *      h_min must pass; no touch is looked for in between, the RELAX at its end meets it. A RELAX at the end of a window
 *      or at a sample that is not an event ends the window. A first sample (orc_relax) that was an event opens one.
 *      h_min does not run through a sample: at the sample RELAX is done, and a new window starts if it was an event.
 *  A25 mu_s = mu_d: if RELAX ended at the zero of a slide and all contacts have mu_s = mu_d, sliding goes on from there
 *      with no h_min window. At the turning point of the place (angle, for a trammel) the contact sticks; that is no
 *      RELAX and starts no window. N = 0, touch or fold: RELAX 1e-12 later, as for other events. A sample that ends in
 *      sliding is not judged by a RELAX. Slides in it count as one slip.
 *  A26 A hand that does not move from sample to sample: one RELAX (none while sliding at mu_s = mu_d).
 */
#include "oracle.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

typedef long double real;
typedef struct {
  real x, y;
} vec;
typedef struct {
  real x, y, th;
} pose;
typedef struct {
  int v, s;
  vec at;
} con;

/* One RELAX in the making: pose, contacts, opened pairs and the hand. */
typedef struct {
  const orc_scene *sc;
  real size, kp, kt;
  pose q;
  int nc;
  con c[ORC_MAX_C];
  int n_left;
  int left[2 * ORC_MAX_C][2];
  vec h;
  real phi;
} sim;

double orc_step_factor = 1.0;

#define PI 3.14159265358979323846264338327950288L
#define ANGLE_STEP 0.002L
#define MAX_STAGES 64
#define MAX_EVENTS 10000
#define TOL_REST 1e-12L   /* balance and cones, over k_p size */
#define TOL_MOMENT 1e-14L /* a smaller moment is zero, over k_p size^2 */
#define TOL_NEAR 1e-12L /* a vertex this near is a contact after a slide; beyond it an opened one has left */
#define TOL_POSITIVE 1e-14L /* "N > 0" when a slide is to start, over k_p size */
#define H_MIN 1e-4L
#define STILL 1e-16L /* less motion than this, over size, is rounding */

/* ---- plane vectors and the scene ---- */

static vec mk(real x, real y)
{
  vec r;
  r.x = x;
  r.y = y;
  return r;
}
static vec add(vec a, vec b)
{
  return mk(a.x + b.x, a.y + b.y);
}
static vec sub(vec a, vec b)
{
  return mk(a.x - b.x, a.y - b.y);
}
static vec mul(real k, vec a)
{
  return mk(k * a.x, k * a.y);
}
static real dot(vec a, vec b)
{
  return a.x * b.x + a.y * b.y;
}
static real cross(vec a, vec b)
{
  return a.x * b.y - a.y * b.x;
}
static vec perp(vec a)
{
  return mk(-a.y, a.x);
} /* turned by +90 degrees */
static real len(vec a)
{
  return sqrtl(dot(a, a));
}

static vec rot(real th, vec a)
{
  real c = cosl(th), s = sinl(th);
  return mk(c * a.x - s * a.y, s * a.x + c * a.y);
}

static vec body_v(const sim *s, int v)
{
  return mk(s->sc->v[v][0], s->sc->v[v][1]);
}
static vec body_b(const sim *s)
{
  return mk(s->sc->hold[0], s->sc->hold[1]);
}
static vec normal(const sim *s, int k)
{
  return mk(s->sc->s[k].normal[0], s->sc->s[k].normal[1]);
}
static vec tangent(const sim *s, int k)
{
  return mk(s->sc->s[k].normal[1], -(real)s->sc->s[k].normal[0]);
}
static vec spoint(const sim *s, int k)
{
  return mk(s->sc->s[k].point[0], s->sc->s[k].point[1]);
}
static real mu_d(const sim *s, int k)
{
  return s->sc->s[k].mu_d;
}
static real mu_s(const sim *s, int k)
{
  return s->sc->s[k].mu_s;
}

static vec origin(pose q)
{
  return mk(q.x, q.y);
}
static vec world(pose q, vec body)
{
  return add(origin(q), rot(q.th, body));
}
static vec vertex_at(const sim *s, pose q, int v)
{
  return world(q, body_v(s, v));
}
static vec holding(const sim *s, pose q)
{
  return world(q, body_b(s));
}
static real gap(const sim *s, pose q, int v, int k)
{
  return dot(normal(s, k), sub(vertex_at(s, q, v), spoint(s, k)));
}

/* Pose in which body point `body` lies at world point w. */
static pose pose_at(real th, vec body, vec w)
{
  vec o = sub(w, rot(th, body));
  pose q;
  q.x = o.x;
  q.y = o.y;
  q.th = th;
  return q;
}

static vec spring_force(const sim *s, pose q)
{
  return mul(s->kp, sub(s->h, holding(s, q)));
}
static real spring_moment(const sim *s, pose q)
{
  return s->kt * (s->phi - q.th);
}
static real moment_about(const sim *s, pose q, vec w)
{
  return spring_moment(s, q) + cross(sub(holding(s, q), w), spring_force(s, q));
}

static real energy(const sim *s, pose q)
{
  vec d = sub(s->h, holding(s, q));
  return s->kp / 2 * dot(d, d) + s->kt / 2 * (s->phi - q.th) * (s->phi - q.th);
}

static int find_contact(const sim *s, int v, int k)
{
  int i;
  for (i = 0; i < s->nc; i++)
    if (s->c[i].v == v && s->c[i].s == k)
      return i;
  return -1;
}

static int find_left(const sim *s, int v, int k)
{
  int i;
  for (i = 0; i < s->n_left; i++)
    if (s->left[i][0] == v && s->left[i][1] == k)
      return i;
  return -1;
}

static void drop_left(sim *s, int i)
{
  s->n_left--;
  s->left[i][0] = s->left[s->n_left][0];
  s->left[i][1] = s->left[s->n_left][1];
}

static void add_contact(sim *s, int v, int k, orc_report *rep)
{
  int i = find_left(s, v, k);
  if (i >= 0)
    drop_left(s, i);
  if (s->nc >= ORC_MAX_C || find_contact(s, v, k) >= 0)
    return;
  s->c[s->nc].v = v;
  s->c[s->nc].s = k;
  s->c[s->nc].at = vertex_at(s, s->q, v);
  s->nc++;
  rep->touches++;
}

/* Opens the contacts whose bit is set. */
static void open_contacts(sim *s, unsigned set, orc_report *rep)
{
  int i, n = 0;
  for (i = 0; i < s->nc; i++) {
    if (set >> i & 1u) {
      if (s->n_left < 2 * ORC_MAX_C && find_left(s, s->c[i].v, s->c[i].s) < 0) {
        s->left[s->n_left][0] = s->c[i].v;
        s->left[s->n_left][1] = s->c[i].s;
        s->n_left++;
      }
      rep->opens++;
    } else {
      s->c[n++] = s->c[i];
    }
  }
  s->nc = n;
}

static void forget_left(sim *s)
{
  int i;
  for (i = s->n_left - 1; i >= 0; i--)
    if (gap(s, s->q, s->left[i][0], s->left[i][1]) > TOL_NEAR * s->size)
      drop_left(s, i);
}

static void reanchor(sim *s)
{
  int i;
  for (i = 0; i < s->nc; i++)
    s->c[i].at = vertex_at(s, s->q, s->c[i].v);
}

static int one_vertex(const sim *s)
{
  int i;
  for (i = 1; i < s->nc; i++)
    if (s->c[i].v != s->c[0].v)
      return 0;
  return s->nc > 0;
}

static int is_parallel(const sim *s, const con *a, const con *b)
{
  return fabsl(cross(normal(s, a->s), normal(s, b->s))) < 1e-12L;
}

static real gap_tolerance(const sim *s)
{
  real far = fabsl(s->q.x) + fabsl(s->q.y) + fabsl(s->h.x) + fabsl(s->h.y);
  return 1e-17L * s->size + 1e-18L * far;
}

/* ---- rest: distance of the load from the cone of contact forces ---- */

typedef struct {
  real a[3];
} vec3;

static real dot3(vec3 a, vec3 b)
{
  return a.a[0] * b.a[0] + a.a[1] * b.a[1] + a.a[2] * b.a[2];
}
static vec3 axpy3(real k, vec3 a, vec3 b)
{
  int i;
  for (i = 0; i < 3; i++)
    b.a[i] += k * a.a[i];
  return b;
}

/* Distance of b from the cone of the generators: the nearest point is a combination with positive weights of at
 * most three independent generators, so trying all such subsets finds it. */
static real cone_distance(const vec3 *g, int n, vec3 b)
{
  real best = sqrtl(dot3(b, b));
  int i, j, k;
  for (i = 0; i < n; i++) {
    real ai = dot3(g[i], b);
    vec3 ri = axpy3(-ai, g[i], b);
    real d = sqrtl(dot3(ri, ri));
    if (ai >= 0 && d < best)
      best = d;
    for (j = i + 1; j < n; j++) {
      /* orthonormal e2 from g[j]; weights by back substitution */
      real gij = dot3(g[i], g[j]), l2, aj;
      vec3 e2 = axpy3(-gij, g[i], g[j]), rj;
      l2 = sqrtl(dot3(e2, e2));
      if (l2 < 1e-15L)
        continue;
      e2 = axpy3(1 / l2 - 1, e2, e2);
      aj = dot3(e2, b);
      rj = axpy3(-aj, e2, ri);
      if (aj >= 0 && ai - aj / l2 * gij >= 0) {
        d = sqrtl(dot3(rj, rj));
        if (d < best)
          best = d;
      }
      for (k = j + 1; k < n; k++) {
        real gik = dot3(g[i], g[k]), gjk = dot3(e2, g[k]), l3, ak, wj, wi;
        vec3 e3 = axpy3(-gjk, e2, axpy3(-gik, g[i], g[k]));
        l3 = sqrtl(dot3(e3, e3));
        if (l3 < 1e-15L)
          continue;
        e3 = axpy3(1 / l3 - 1, e3, e3);
        ak = dot3(e3, b) / l3;
        wj = (aj - ak * gjk) / l2;
        wi = ai - wj * gij - ak * gik;
        if (ak >= 0 && wj >= 0 && wi >= 0) {
          vec3 r = axpy3(-ak * l3, e3, rj);
          d = sqrtl(dot3(r, r));
          if (d < best)
            best = d;
        }
      }
    }
  }
  return best;
}

static int rests(const sim *s)
{
  vec3 g[2 * ORC_MAX_C], b;
  vec hold = holding(s, s->q), f = spring_force(s, s->q);
  int i, e, n = 0;
  for (i = 0; i < s->nc; i++) {
    real m = mu_s(s, s->c[i].s);
    vec r = sub(vertex_at(s, s->q, s->c[i].v), hold);
    for (e = -1; e <= 1; e += 2) {
      vec d = add(normal(s, s->c[i].s), mul(e * m, tangent(s, s->c[i].s)));
      vec3 w;
      real l;
      w.a[0] = d.x;
      w.a[1] = d.y;
      w.a[2] = cross(r, d) / s->size;
      l = sqrtl(dot3(w, w));
      g[n++] = axpy3(1 / l - 1, w, w);
      if (m == 0)
        break;
    }
  }
  b.a[0] = -f.x / (s->kp * s->size);
  b.a[1] = -f.y / (s->kp * s->size);
  b.a[2] = -spring_moment(s, s->q) / (s->kp * s->size * s->size);
  if (s->nc == 0 && s->kt == 0)
    b.a[2] = 0;
  return cone_distance(g, n, b) <= TOL_REST;
}

/* ---- motions ---- */

enum motion_kind { M_STRAIGHT, M_TURN, M_ALONG, M_ARC, M_PARALLEL, M_TRAMMEL };

/* A motion with one parameter u >= 0: fraction of the way (STRAIGHT), angle turned (TURN, ARC, TRAMMEL) or
 * distance (ALONG, PARALLEL). */
typedef struct {
  enum motion_kind kind;
  pose q0;
  con c[2];
  real dir;   /* of the angle, or along the first tangent */
  real sigma; /* ARC: sign of the hand's tangential force, fixed for the stage */
  vec g1;     /* STRAIGHT: where the holding point and the angle go */
  real th1;
} motion;

static int is_angular(const motion *m)
{
  return m->kind == M_TURN || m->kind == M_ARC || m->kind == M_TRAMMEL;
}

/* Pose of a trammel at angle th: each vertex on its surface. */
static pose trammel_pose(const sim *s, const motion *m, real th)
{
  vec n1 = normal(s, m->c[0].s), n2 = normal(s, m->c[1].s);
  vec r1 = rot(th, body_v(s, m->c[0].v)), r2 = rot(th, body_v(s, m->c[1].v));
  real d1 = dot(n1, sub(m->c[0].at, r1)), d2 = dot(n2, sub(m->c[1].at, r2)), det = cross(n1, n2);
  pose q;
  q.x = (d1 * n2.y - d2 * n1.y) / det;
  q.y = (n1.x * d2 - n2.x * d1) / det;
  q.th = th;
  return q;
}

static pose motion_pose(const sim *s, const motion *m, real u)
{
  switch (m->kind) {
  case M_STRAIGHT: {
    vec g0 = holding(s, m->q0);
    return pose_at(m->q0.th + u * (m->th1 - m->q0.th), body_b(s), add(g0, mul(u, sub(m->g1, g0))));
  }
  case M_TURN: return pose_at(m->q0.th + m->dir * u, body_v(s, m->c[0].v), m->c[0].at);
  case M_ARC: {
    /* vertex on the surface, and the tangential force at its dynamic limit */
    vec n = normal(s, m->c[0].s), t = tangent(s, m->c[0].s);
    real th = m->q0.th + m->dir * u;
    vec rel = rot(th, sub(body_b(s), body_v(s, m->c[0].v)));
    real gn = dot(n, m->c[0].at) + dot(n, rel);
    real nf = s->kp * (gn - dot(n, s->h));
    real gt = dot(t, s->h) - m->sigma * mu_d(s, m->c[0].s) * nf / s->kp;
    return pose_at(th, body_b(s), add(mul(gn, n), mul(gt, t)));
  }
  case M_TRAMMEL: return trammel_pose(s, m, m->q0.th + m->dir * u);
  default: {
    pose q = m->q0;
    vec d = mul(m->dir * u, tangent(s, m->c[0].s));
    q.x += d.x;
    q.y += d.y;
    return q;
  }
  }
}

/* Velocity of the body origin per unit angle on a trammel. */
static vec trammel_velocity(const sim *s, const motion *m, real th)
{
  vec n1 = normal(s, m->c[0].s), n2 = normal(s, m->c[1].s);
  real d1 = -dot(n1, perp(rot(th, body_v(s, m->c[0].v))));
  real d2 = -dot(n2, perp(rot(th, body_v(s, m->c[1].v)))), det = cross(n1, n2);
  return mk((d1 * n2.y - d2 * n1.y) / det, (n1.x * d2 - n2.x * d1) / det);
}

static void trammel_signs(const sim *s, const motion *m, real th, real sg[2])
{
  int i;
  for (i = 0; i < 2; i++) {
    real look = 0, vt = 0;
    /* exactly at a reversal: the way it is about to move */
    while (look < 1e-3L) {
      vec r = rot(th + m->dir * look, body_v(s, m->c[i].v));
      vt = dot(add(trammel_velocity(s, m, th + m->dir * look), perp(r)), tangent(s, m->c[i].s));
      if (fabsl(vt) > 1e-17L * s->size)
        break;
      look = look == 0 ? 1e-9L : look * 10;
    }
    sg[i] = m->dir * vt > 0 ? 1 : -1;
  }
}

/* Normal forces of a sliding pair and the moment about g that is left; 0 if there is no such balance. */
static int pair_forces(const sim *s, const motion *m, pose q, real nf[2], real *left)
{
  vec f = spring_force(s, q), hold = holding(s, q), dirs[2], arm[2];
  real mh = spring_moment(s, q), sg[2], det;
  int i;
  if (m->kind == M_TRAMMEL) {
    trammel_signs(s, m, q.th, sg);
  } else {
    /* motion along the first tangent, whichever way the second one points */
    sg[0] = m->dir;
    sg[1] = dot(tangent(s, m->c[0].s), tangent(s, m->c[1].s)) > 0 ? m->dir : -m->dir;
  }
  for (i = 0; i < 2; i++) {
    int k = m->c[i].s;
    dirs[i] = sub(normal(s, k), mul(sg[i] * mu_d(s, k), tangent(s, k)));
    arm[i] = sub(vertex_at(s, q, m->c[i].v), hold);
  }
  if (m->kind == M_TRAMMEL) {
    det = cross(dirs[0], dirs[1]);
    if (fabsl(det) < 1e-15L)
      return 0;
    nf[0] = -cross(f, dirs[1]) / det;
    nf[1] = -cross(dirs[0], f) / det;
    *left = mh + nf[0] * cross(arm[0], dirs[0]) + nf[1] * cross(arm[1], dirs[1]);
  } else {
    vec n = normal(s, m->c[0].s);
    real c2 = dot(n, normal(s, m->c[1].s)) > 0 ? 1 : -1, fn = dot(f, n);
    if (c2 > 0) {
      /* edge: friction has no moment about a point of the surface, so the split is that of statics */
      vec w2 = vertex_at(s, q, m->c[1].v);
      det = cross(sub(vertex_at(s, q, m->c[0].v), w2), n);
      if (fabsl(det) < 1e-15L * s->size)
        return 0;
      nf[0] = -moment_about(s, q, w2) / det;
      nf[1] = -fn - nf[0];
    } else {
      real m1 = cross(arm[0], dirs[0]), m2 = cross(arm[1], dirs[1]);
      det = m2 - c2 * m1;
      if (fabsl(det) < 1e-15L * s->size)
        return 0;
      nf[0] = (-fn * m2 + c2 * mh) / det;
      nf[1] = (-mh + m1 * fn) / det;
    }
    *left = 0;
  }
  return 1;
}

/* The quantity whose zero stops the motion (positive while it is driven), and normal forces. */
static pose motion_eval(const sim *s, const motion *m, real u, real *drive, real nf[2])
{
  pose q = motion_pose(s, m, u);
  real left = 0;
  nf[0] = nf[1] = 1;
  *drive = 1;
  switch (m->kind) {
  case M_STRAIGHT: break;
  case M_TURN: *drive = m->dir * moment_about(s, q, m->c[0].at); break;
  case M_ALONG: {
    vec f = spring_force(s, q);
    nf[0] = -dot(f, normal(s, m->c[0].s));
    *drive = m->sigma * dot(f, tangent(s, m->c[0].s)) - mu_d(s, m->c[0].s) * nf[0];
    break;
  }
  case M_ARC: {
    vec f = spring_force(s, q), n = normal(s, m->c[0].s), t = tangent(s, m->c[0].s);
    nf[0] = -dot(f, n);
    f = mul(nf[0], sub(n, mul(m->sigma * mu_d(s, m->c[0].s), t)));
    *drive = m->dir * (spring_moment(s, q) + cross(sub(vertex_at(s, q, m->c[0].v), holding(s, q)), f));
    break;
  }
  case M_PARALLEL:
    if (!pair_forces(s, m, q, nf, &left))
      nf[0] = nf[1] = -1;
    *drive = m->dir * dot(spring_force(s, q), tangent(s, m->c[0].s)) - mu_d(s, m->c[0].s) * nf[0] -
             mu_d(s, m->c[1].s) * nf[1];
    break;
  case M_TRAMMEL:
    if (!pair_forces(s, m, q, nf, &left))
      nf[0] = nf[1] = -1;
    *drive = m->dir * left;
    break;
  }
  return q;
}

/* ---- marching along a motion ---- */

enum stop_kind { STOP_END, STOP_ZERO, STOP_NZERO, STOP_TOUCH };
typedef struct {
  enum stop_kind why;
  int v, s;
  real u;
  int jump;
} stop;

#define MAX_WATCH (3 + ORC_MAX_V * ORC_MAX_S)

/* What is watched on the way: 0 the drive, 1 and 2 normal forces, then gaps. */
typedef struct {
  int n;
  int v[MAX_WATCH], s[MAX_WATCH];
  real limit[MAX_WATCH];
} watch;

static void watch_eval(const sim *s, const motion *m, const watch *w, real u, real *val)
{
  int i;
  real nf[2];
  pose q = motion_eval(s, m, u, &val[0], nf);
  vec vert[ORC_MAX_V];
  real c = cosl(q.th), sn = sinl(q.th);
  val[1] = nf[0];
  val[2] = nf[1];
  for (i = 0; i < s->sc->nv; i++) {
    vec b = body_v(s, i);
    vert[i] = mk(q.x + c * b.x - sn * b.y, q.y + sn * b.x + c * b.y);
  }
  for (i = 3; i < w->n; i++)
    val[i] = dot(normal(s, w->s[i]), sub(vert[w->v[i]], spoint(s, w->s[i])));
}

static int fired(const watch *w, const real *val)
{
  int i;
  for (i = 3; i < w->n; i++)
    if (val[i] < w->limit[i])
      return i;
  for (i = 1; i < 3; i++)
    if (val[i] <= 0)
      return i;
  return val[0] <= 0 ? 0 : -1;
}

/* Is value b, between a and c at equal or nearly equal steps, near a minimum that may pass the limit? */
static int may_dip(real a, real b, real c, real limit)
{
  real spread = (a > c ? a : c) - b;
  return b < a && b <= c && b - limit < 2 * spread;
}

/* Goes along m to the first event or to u_end; leaves the pose there, just past the event: a vertex stops on its
 * surface to about 1e-17 of the size. */
static stop march(sim *s, const motion *m, real u_end, real step)
{
  static watch w;
  static real buf[3][MAX_WATCH], val[MAX_WATCH];
  real *old = buf[0], *cur = buf[1], *next = buf[2], *tmp;
  real u_old = 0, u_cur = 0, u_next, lo = 0, hi = -1, tol = gap_tolerance(s), sg_lo[2] = {0, 0},
       sg_hi[2] = {0, 0};
  int i, j, f, have_old = 0;
  stop r;

  w.n = 3;
  for (i = 0; i < s->sc->nv; i++)
    for (j = 0; j < s->sc->ns; j++)
      if (find_contact(s, i, j) < 0) {
        real g = gap(s, m->q0, i, j);
        w.v[w.n] = i;
        w.s[w.n] = j;
        w.limit[w.n] = (g < 0 ? g : 0) - tol;
        w.n++;
      }
  r.v = r.s = -1;
  r.u = 0;
  r.jump = 0;
  r.why = STOP_END;
  if (u_end <= 0)
    return r;
  watch_eval(s, m, &w, 0, cur);
  f = fired(&w, cur);
  if (f >= 0) {
    if (f >= 3) { /* only when following a moving hand; treated as a touch here and now */
      r.why = STOP_TOUCH;
      r.v = w.v[f];
      r.s = w.s[f];
    } else {
      r.why = f == 0 ? STOP_ZERO : STOP_NZERO;
    }
    s->q = motion_pose(s, m, 0);
    return r;
  }
  while (u_cur < u_end && hi < 0) {
    /* short first and last steps show a minimum at either end */
    u_next = u_cur == 0 ? 1e-3L * step : u_cur + step;
    if (u_cur < u_end - 1e-3L * step && u_next > u_end - 1e-3L * step)
      u_next = u_end - 1e-3L * step;
    if (u_next > u_end || u_next <= u_cur)
      u_next = u_end;
    watch_eval(s, m, &w, u_next, next);
    if (have_old) {
      for (i = 0; i < w.n && hi < 0; i++) {
        real a, b, x1, x2, f1, f2, lim = i < 3 ? 0 : w.limit[i];
        int it;
        if (!may_dip(old[i], cur[i], next[i], lim))
          continue;
        if (fired(&w, next) >= 0 && next[i] < lim)
          continue;
        a = u_old;
        b = u_next;
        x1 = a + 0.381966011250105L * (b - a);
        x2 = a + 0.618033988749895L * (b - a);
        watch_eval(s, m, &w, x1, val);
        f1 = val[i];
        watch_eval(s, m, &w, x2, val);
        f2 = val[i];
        for (it = 0; it < 60 && f1 >= lim && f2 >= lim; it++) {
          if (f1 < f2) {
            b = x2;
            x2 = x1;
            f2 = f1;
            x1 = a + 0.381966011250105L * (b - a);
            watch_eval(s, m, &w, x1, val);
            f1 = val[i];
          } else {
            a = x1;
            x1 = x2;
            f1 = f2;
            x2 = a + 0.618033988749895L * (b - a);
            watch_eval(s, m, &w, x2, val);
            f2 = val[i];
          }
        }
        if (f1 < lim || f2 < lim) {
          lo = u_old;
          hi = f1 < lim ? x1 : x2;
        }
      }
      if (hi >= 0)
        break;
    }
    if (fired(&w, next) >= 0) {
      lo = u_cur;
      hi = u_next;
      break;
    }
    tmp = old;
    old = cur;
    cur = next;
    next = tmp;
    u_old = u_cur;
    u_cur = u_next;
    have_old = 1;
  }
  if (hi < 0) {
    s->q = motion_pose(s, m, u_end);
    r.u = u_end;
    return r;
  }
  for (i = 0; i < 90; i++) {
    real mid = (lo + hi) / 2;
    if (mid <= lo || mid >= hi || hi - lo < 1e-20L)
      break;
    watch_eval(s, m, &w, mid, val);
    if (fired(&w, val) >= 0)
      hi = mid;
    else
      lo = mid;
  }
  watch_eval(s, m, &w, hi, val);
  f = fired(&w, val);
  r.u = hi;
  if (f >= 3) {
    r.why = STOP_TOUCH;
    r.v = w.v[f];
    r.s = w.s[f];
  } else {
    r.why = f == 0 ? STOP_ZERO : STOP_NZERO;
  }
  s->q = motion_pose(s, m, hi);
  if (m->kind == M_TRAMMEL) {
    trammel_signs(s, m, m->q0.th + m->dir * lo, sg_lo);
    trammel_signs(s, m, m->q0.th + m->dir * hi, sg_hi);
    r.jump = sg_lo[0] != sg_hi[0] || sg_lo[1] != sg_hi[1];
  }
  return r;
}

static stop march_angle(sim *s, const motion *m)
{
  /* beyond the target angle and a few turns there is always a zero unless there is no force at all */
  return march(s, m, fabsl(s->phi - m->q0.th) * (s->kt > 0) + 8 * PI, ANGLE_STEP * (real)orc_step_factor);
}

/* Distances: everything watched is linear in the distance, so few steps miss nothing. */
static stop march_distance(sim *s, const motion *m)
{
  real d = len(sub(s->h, holding(s, m->q0))) + s->size;
  return march(s, m, 2 * d, d / 16);
}

static stop march_straight(sim *s, const motion *m)
{
  real n = 8 + ceill(fabsl(m->th1 - m->q0.th) / (ANGLE_STEP * (real)orc_step_factor));
  return march(s, m, 1, 1 / n);
}

static void new_motion(const sim *s, motion *m, enum motion_kind kind)
{
  memset(m, 0, sizeof *m);
  m->kind = kind;
  m->q0 = s->q;
  m->dir = m->sigma = 1;
}

static real moment_zero(const sim *s)
{
  return TOL_MOMENT * s->kp * s->size * s->size;
}

/* Does the turn from th0 to th1 about contact c cross a stretch where df/dtheta > 0? Only a snap does. */
static int turn_snaps(const sim *s, const motion *m, real u_end)
{
  int i, n = 4 + (int)(u_end / (ANGLE_STEP * 4));
  for (i = 0; i < n; i++) {
    real u = u_end * (i + 0.5L) / n, e = 1e-5L, a, b, nf[2];
    motion_eval(s, m, u - e, &a, nf);
    motion_eval(s, m, u + e, &b, nf);
    if ((b - a) / (2 * e) > 1e-10L * (s->kp * s->size * s->size))
      return 1;
  }
  return 0;
}

/* ---- does an opened gap start to grow? ---- */

enum { SHRINKS = -1, STAYS = 0, GROWS = 1 };

static int gap_growth(const sim *s, const motion *m, const con *c, int second_too, orc_report *rep)
{
  real d = m->kind == M_ALONG || m->kind == M_PARALLEL ? 1e-3L * s->size : 1e-3L;
  real scale = is_angular(m) ? s->size : 1, g[5], r1, r2;
  int i;
  if (m->kind == M_STRAIGHT)
    scale = len(sub(m->g1, holding(s, m->q0))) + s->size * fabsl(m->th1 - m->q0.th);
  for (i = 0; i < 5; i++)
    g[i] = gap(s, motion_pose(s, m, (i - 2) * d), c->v, c->s);
  r1 = (8 * (g[3] - g[1]) - (g[4] - g[0])) / (12 * d);
  r2 = (16 * (g[3] + g[1]) - (g[4] + g[0]) - 30 * g[2]) / (12 * d * d);
  if (r1 > 1e-12L * scale)
    return GROWS;
  if (r1 < -1e-12L * scale)
    return SHRINKS;
  if (!second_too || !is_angular(m))
    return STAYS;
  if (r2 > 1e-9L * scale) {
    rep->rules |= ORC_R_3_SECOND;
    return GROWS;
  }
  if (r2 < -1e-9L * scale)
    return SHRINKS;
  return STAYS;
}

/* ---- slides ---- */

typedef struct {
  int slid;  /* a contact slid further than 1e-12 of size */
  int acted; /* anything but a plain HOLD that ended at rest */
  int snapped;
  int slide; /* at rest at the zero of such a slide (ORC_SLIDE_*) */
  int sigma;
} outcome;

static void slide_ends(sim *s, stop r, orc_report *rep)
{
  int i, j;
  if (r.why == STOP_TOUCH)
    rep->rules |= ORC_R_SLIDE_TOUCH;
  if (r.why == STOP_NZERO)
    rep->rules |= ORC_R_SLIDE_NZERO;
  if (r.jump && r.why == STOP_ZERO)
    rep->rules |= ORC_R_SLIDE_JUMP;
  reanchor(s);
  forget_left(s);
  if (r.why == STOP_TOUCH)
    add_contact(s, r.v, r.s, rep);
  for (i = 0; i < s->sc->nv; i++)
    for (j = 0; j < s->sc->ns; j++)
      if (find_contact(s, i, j) < 0 && find_left(s, i, j) < 0 && gap(s, s->q, i, j) <= TOL_NEAR * s->size)
        add_contact(s, i, j, rep);
}

static void note_travel(const sim *s, const con *was, int n, outcome *o)
{
  int i;
  for (i = 0; i < n; i++)
    if (len(sub(vertex_at(s, s->q, was[i].v), was[i].at)) > 1e-12L * s->size)
      o->slid = 1;
}

/* Moment about g that is left when contact c slides in direction sigma in tangential balance. */
static real arc_moment(const sim *s, const con *c, real sigma)
{
  motion m;
  real drive, nf[2];
  new_motion(s, &m, M_ARC);
  m.c[0] = *c;
  m.sigma = sigma;
  motion_eval(s, &m, 0, &drive, nf);
  return drive;
}

/* SLIDE of the single contact s->c[0]; returns whether it reached its zero. */
static int slide_one(sim *s, orc_report *rep, outcome *o)
{
  motion m;
  stop r;
  con was = s->c[0];
  int reached = 0;
  real mom;

  new_motion(s, &m, M_ALONG);
  m.c[0] = s->c[0];
  m.sigma = dot(spring_force(s, s->q), tangent(s, s->c[0].s)) < 0 ? -1 : 1;
  m.dir = m.sigma;
  o->sigma = (int)m.sigma;
  r = march_distance(s, &m);
  note_travel(s, &was, 1, o);
  if (r.why == STOP_ZERO) {
    s->c[0].at = vertex_at(s, s->q, s->c[0].v);
    m.kind = M_ARC;
    m.q0 = s->q;
    m.c[0] = s->c[0];
    mom = arc_moment(s, &s->c[0], m.sigma);
    reached = 1;
    if (fabsl(mom) > moment_zero(s)) {
      m.dir = mom > 0 ? 1 : -1;
      r = march_angle(s, &m);
      reached = r.why == STOP_ZERO;
      note_travel(s, &was, 1, o);
    }
  }
  slide_ends(s, r, rep);
  return reached;
}

/* Prepares the slide of a pair; 0 if it is not possible: both N > 0 and the unbalanced force drives it. */
static int pair_motion(const sim *s, const con *a, const con *b, motion *m)
{
  real nf[2], drive, lim = TOL_POSITIVE * s->kp * s->size;
  if (a->v == b->v)
    return 0;
  if (is_parallel(s, a, b)) {
    new_motion(s, m, M_PARALLEL);
    m->c[0] = *a;
    m->c[1] = *b;
    m->dir = dot(spring_force(s, s->q), tangent(s, a->s)) < 0 ? -1 : 1;
  } else {
    vec vel;
    new_motion(s, m, M_TRAMMEL);
    m->c[0] = *a;
    m->c[1] = *b;
    /* friction only takes power away, so the motion can only go the way the spring drives it */
    vel = add(trammel_velocity(s, m, s->q.th), perp(rot(s->q.th, body_b(s))));
    m->dir = dot(spring_force(s, s->q), vel) + spring_moment(s, s->q) < 0 ? -1 : 1;
  }
  motion_eval(s, m, 0, &drive, nf);
  if (!(nf[0] > lim && nf[1] > lim))
    return 0;
  return drive > (m->kind == M_TRAMMEL ? moment_zero(s) : lim);
}

static int slide_pair(sim *s, motion *m, orc_report *rep, outcome *o)
{
  stop r;
  con was[2];
  was[0] = m->c[0];
  was[1] = m->c[1];
  o->sigma = (int)m->dir;
  if (m->kind == M_TRAMMEL) {
    real a[2], b[2];
    trammel_signs(s, m, s->q.th, a);
    r = march_angle(s, m);
    trammel_signs(s, m, s->q.th, b);
    if (a[0] != b[0] || a[1] != b[1])
      rep->rules |= ORC_R_SLIDE_FLIP;
  } else {
    r = march_distance(s, m);
  }
  note_travel(s, was, 2, o);
  slide_ends(s, r, rep);
  return r.why == STOP_ZERO;
}

/* ---- rule 3 ---- */

/* Motion of everything opened. First translate, then turn. */
static int all_part(const sim *s, orc_report *rep)
{
  motion tr, tu;
  int i;
  real far = len(sub(s->h, holding(s, s->q)));
  int turns = s->kt > 0 && fabsl(s->phi - s->q.th) > 1e-14L;
  new_motion(s, &tr, M_STRAIGHT);
  tr.g1 = s->h;
  tr.th1 = s->q.th;
  new_motion(s, &tu, M_TURN); /* about the holding point: a turn about a vertex put at b */
  tu.dir = s->phi > s->q.th ? 1 : -1;
  for (i = 0; i < s->nc; i++) {
    int k = far > 1e-14L * s->size ? gap_growth(s, &tr, &s->c[i], 1, rep) : STAYS;
    if (k == SHRINKS)
      return 0;
    if (k == STAYS) {
      vec r, n = normal(s, s->c[i].s);
      real rate;
      if (!turns)
        return 0;
      r = rot(s->q.th, sub(body_v(s, s->c[i].v), body_b(s)));
      rate = tu.dir * dot(n, perp(r));
      if (rate < -1e-12L * s->size)
        return 0;
      if (rate <= 1e-12L * s->size) {
        if (!(dot(n, r) < -1e-9L * s->size))
          return 0;
        rep->rules |= ORC_R_3_SECOND;
      }
      rep->rules |= ORC_R_3_AFTER;
    }
  }
  return 1;
}

/* Tries to open the set; on success the stage is done. */
static int try_open(sim *s, unsigned set, orc_report *rep, outcome *o, int *reached)
{
  con rest[ORC_MAX_C], opened[ORC_MAX_C];
  int i, nr = 0, no = 0, same = 1;
  motion m;
  for (i = 0; i < s->nc; i++) {
    if (set >> i & 1u)
      opened[no++] = s->c[i];
    else
      rest[nr++] = s->c[i];
  }
  for (i = 1; i < nr; i++)
    if (rest[i].v != rest[0].v)
      same = 0;

  if (nr == 0) {
    if (!all_part(s, rep))
      return 0;
    open_contacts(s, set, rep);
    rep->rules |= ORC_R_3_ALL;
    return 1;
  }
  if (same) {
    real mom = moment_about(s, s->q, vertex_at(s, s->q, rest[0].v));
    if (fabsl(mom) > moment_zero(s)) {
      new_motion(s, &m, M_TURN);
      m.c[0] = rest[0];
      m.c[0].at = vertex_at(s, s->q, rest[0].v);
      m.dir = mom > 0 ? 1 : -1;
      for (i = 0; i < no; i++)
        if (gap_growth(s, &m, &opened[i], 1, rep) != GROWS)
          break;
      if (i == no) {
        open_contacts(s, set, rep);
        rep->rules |= ORC_R_3_TURN | (no > 1 ? ORC_R_3_MANY : 0);
        return 1; /* the next HOLD turns */
      }
    }
    if (nr == 1) {
      vec f = spring_force(s, s->q);
      real nf = -dot(f, normal(s, rest[0].s)), ft = dot(f, tangent(s, rest[0].s)), mom2;
      real sg = ft < 0 ? -1 : 1, lim = TOL_POSITIVE * s->kp * s->size;
      sim after;
      if (!(nf > lim) || !(fabsl(ft) - mu_d(s, rest[0].s) * nf > lim))
        return 0;
      new_motion(s, &m, M_ALONG);
      m.c[0] = rest[0];
      m.dir = m.sigma = sg;
      /* where the translation would end, for the turn that follows it */
      after = *s;
      after.q = motion_pose(s, &m, (fabsl(ft) - mu_d(s, rest[0].s) * nf) / s->kp);
      mom2 = arc_moment(&after, &rest[0], sg);
      for (i = 0; i < no; i++) {
        int k = gap_growth(s, &m, &opened[i], 0, rep);
        if (k == SHRINKS)
          return 0;
        if (k == STAYS) {
          motion arc;
          if (fabsl(mom2) <= moment_zero(s))
            return 0;
          new_motion(&after, &arc, M_ARC);
          arc.c[0] = rest[0];
          arc.sigma = sg;
          arc.dir = mom2 > 0 ? 1 : -1;
          if (gap_growth(&after, &arc, &opened[i], 1, rep) != GROWS)
            return 0;
          rep->rules |= ORC_R_3_AFTER;
        }
      }
      open_contacts(s, set, rep);
      rep->rules |= ORC_R_3_SLIDE | (no > 1 ? ORC_R_3_MANY : 0);
      *reached = slide_one(s, rep, o);
      if (*reached)
        o->slide = ORC_SLIDE_ONE;
      return 1;
    }
    return 0;
  }
  if (nr == 2 && pair_motion(s, &rest[0], &rest[1], &m)) {
    for (i = 0; i < no; i++)
      if (gap_growth(s, &m, &opened[i], 1, rep) != GROWS)
        return 0;
    open_contacts(s, set, rep);
    rep->rules |= ORC_R_3_PAIR | (no > 1 ? ORC_R_3_MANY : 0);
    *reached = slide_pair(s, &m, rep, o);
    if (*reached)
      o->slide = m.kind == M_TRAMMEL ? ORC_SLIDE_TRAMMEL : ORC_SLIDE_PARALLEL;
    return 1;
  }
  return 0;
}

/* All choices of k contacts, in lexicographic order of the order of touching. */
static int open_some(sim *s, orc_report *rep, outcome *o, int *reached)
{
  int k, n = s->nc, pick[ORC_MAX_C], i;
  for (k = 1; k <= n; k++) {
    for (i = 0; i < k; i++)
      pick[i] = i;
    for (;;) {
      unsigned set = 0;
      for (i = 0; i < k; i++)
        set |= 1u << pick[i];
      if (try_open(s, set, rep, o, reached))
        return 1;
      for (i = k - 1; i >= 0 && pick[i] == n - k + i; i--)
        continue;
      if (i < 0)
        break;
      pick[i]++;
      for (i++; i < k; i++)
        pick[i] = pick[i - 1] + 1;
    }
  }
  return 0;
}

/* ---- rule 4: viscous flow ---- */

enum { F_STUCK, F_PLUS, F_MINUS, F_OPEN };

typedef struct {
  int nc;
  con c[ORC_MAX_C];
  int mode[ORC_MAX_C];
} flow_set;
typedef struct {
  vec g;
  real th;
  real nf[ORC_MAX_C], tf[ORC_MAX_C];
} flow_rate; /* dg/ds, dtheta/ds, forces */

static int solve_linear(real *a, real *x, int n)
{
  int i, j, k;
  for (i = 0; i < n; i++) {
    int p = i;
    for (j = i + 1; j < n; j++)
      if (fabsl(a[j * n + i]) > fabsl(a[p * n + i]))
        p = j;
    if (fabsl(a[p * n + i]) < 1e-13L)
      return 0;
    for (k = 0; k < n; k++) {
      real t = a[i * n + k];
      a[i * n + k] = a[p * n + k];
      a[p * n + k] = t;
    }
    {
      real t = x[i];
      x[i] = x[p];
      x[p] = t;
    }
    for (j = i + 1; j < n; j++) {
      real f = a[j * n + i] / a[i * n + i];
      for (k = i; k < n; k++)
        a[j * n + k] -= f * a[i * n + k];
      x[j] -= f * x[i];
    }
  }
  for (i = n - 1; i >= 0; i--) {
    for (k = i + 1; k < n; k++)
      x[i] -= a[i * n + k] * x[k];
    x[i] /= a[i * n + i];
  }
  return 1;
}

#define FLOW_ROWS 6

/* Velocity and contact forces of the flow in given modes, lengths over size and forces over k_p size. */
static int flow_velocity(const sim *s, const flow_set *fs, pose q, flow_rate *out)
{
  real a[(3 + FLOW_ROWS) * (3 + FLOW_ROWS)], x[3 + FLOW_ROWS];
  vec f = spring_force(s, q), hold = holding(s, q);
  real rot_k = s->kt / (s->kp * s->size * s->size);
  int i, r = 3, n = 3, row_n[ORC_MAX_C], row_t[ORC_MAX_C];
  for (i = 0; i < fs->nc; i++) {
    row_n[i] = row_t[i] = -1;
    if (fs->mode[i] != F_OPEN)
      row_n[i] = n++;
    if (fs->mode[i] == F_STUCK)
      row_t[i] = n++;
    if (n > 3 + FLOW_ROWS)
      return 0;
  }
  memset(a, 0, sizeof a);
  a[0] = a[n + 1] = 1;
  a[2 * n + 2] = rot_k;
  x[0] = f.x / (s->kp * s->size);
  x[1] = f.y / (s->kp * s->size);
  x[2] = spring_moment(s, q) / (s->kp * s->size * s->size);
  for (i = 3; i < n; i++)
    x[i] = 0;
  for (i = 0; i < fs->nc; i++) {
    vec nn = normal(s, fs->c[i].s), t = tangent(s, fs->c[i].s), d = nn;
    vec arm = mul(1 / s->size, sub(vertex_at(s, q, fs->c[i].v), hold));
    if (fs->mode[i] == F_OPEN)
      continue;
    if (fs->mode[i] == F_PLUS)
      d = sub(nn, mul(mu_d(s, fs->c[i].s), t));
    if (fs->mode[i] == F_MINUS)
      d = add(nn, mul(mu_d(s, fs->c[i].s), t));
    r = row_n[i];
    a[0 * n + r] = -d.x;
    a[1 * n + r] = -d.y;
    a[2 * n + r] = -cross(arm, d);
    a[r * n + 0] = nn.x;
    a[r * n + 1] = nn.y;
    a[r * n + 2] = dot(nn, perp(arm));
    if (row_t[i] >= 0) {
      r = row_t[i];
      a[0 * n + r] = -t.x;
      a[1 * n + r] = -t.y;
      a[2 * n + r] = -cross(arm, t);
      a[r * n + 0] = t.x;
      a[r * n + 1] = t.y;
      a[r * n + 2] = dot(t, perp(arm));
    }
  }
  if (!solve_linear(a, x, n))
    return 0;
  out->g = mul(s->size, mk(x[0], x[1]));
  out->th = x[2];
  for (i = 0; i < fs->nc; i++) {
    out->nf[i] = row_n[i] >= 0 ? x[row_n[i]] : 0;
    out->tf[i] = row_t[i] >= 0 ? x[row_t[i]] : 0;
    if (fs->mode[i] == F_PLUS)
      out->tf[i] = -mu_d(s, fs->c[i].s) * out->nf[i];
    if (fs->mode[i] == F_MINUS)
      out->tf[i] = mu_d(s, fs->c[i].s) * out->nf[i];
  }
  return 1;
}

static real flow_speed(const sim *s, const flow_rate *r)
{
  return len(r->g) / s->size + fabsl(r->th);
}

/* Least slack of the conditions of the modes; negative = some contact leaves its mode. */
static real flow_slack(const sim *s, const flow_set *fs, pose q, const flow_rate *r, int at_start)
{
  real low = 1, eps = at_start ? 1e-12L * flow_speed(s, r) : 0;
  vec hold = holding(s, q);
  int i;
  for (i = 0; i < fs->nc; i++) {
    vec arm = sub(vertex_at(s, q, fs->c[i].v), hold), vel = add(r->g, mul(r->th, perp(arm)));
    real vn = dot(vel, normal(s, fs->c[i].s)) / s->size, vt = dot(vel, tangent(s, fs->c[i].s)) / s->size, k;
    switch (fs->mode[i]) {
    case F_STUCK:
      k = mu_s(s, fs->c[i].s) * r->nf[i] - fabsl(r->tf[i]);
      if (r->nf[i] < k)
        k = r->nf[i];
      k += at_start ? 1e-15L : 0;
      break;
    case F_PLUS:
    case F_MINUS:
      k = (fs->mode[i] == F_PLUS ? vt : -vt) - eps;
      if (r->nf[i] + (at_start ? 1e-15L : 0) < k)
        k = r->nf[i] + (at_start ? 1e-15L : 0);
      break;
    default:
      k = at_start ? vn - eps : 1; /* an open one is watched as a gap */
      break;
    }
    if (k < low)
      low = k;
  }
  return low;
}

static pose flow_moved(const sim *s, pose q, const flow_rate *r, real h)
{
  return pose_at(q.th + h * r->th, body_b(s), add(holding(s, q), mul(h, r->g)));
}

/* One Runge-Kutta step and the return to the surfaces and anchors that the modes keep. */
static int flow_step(const sim *s, const flow_set *fs, pose q, real h, pose *out)
{
  flow_rate k[4], sum;
  int i, it;
  if (!flow_velocity(s, fs, q, &k[0]))
    return 0;
  if (!flow_velocity(s, fs, flow_moved(s, q, &k[0], h / 2), &k[1]))
    return 0;
  if (!flow_velocity(s, fs, flow_moved(s, q, &k[1], h / 2), &k[2]))
    return 0;
  if (!flow_velocity(s, fs, flow_moved(s, q, &k[2], h), &k[3]))
    return 0;
  sum.g = mul(1 / 6.0L, add(add(k[0].g, k[3].g), mul(2, add(k[1].g, k[2].g))));
  sum.th = (k[0].th + k[3].th + 2 * k[1].th + 2 * k[2].th) / 6;
  *out = flow_moved(s, q, &sum, h);
  for (it = 0; it < 4; it++) {
    /* least-norm correction: rows J of the kept constraints, solve J J^T l = -e */
    real j[FLOW_ROWS][3], e[FLOW_ROWS], a[FLOW_ROWS * FLOW_ROWS];
    int n = 0, r, c;
    for (i = 0; i < fs->nc && n + 2 <= FLOW_ROWS; i++) {
      vec w = vertex_at(s, *out, fs->c[i].v), d;
      vec arm = sub(w, holding(s, *out));
      int which;
      for (which = 0; which < (fs->mode[i] == F_STUCK ? 2 : fs->mode[i] == F_OPEN ? 0 : 1); which++) {
        d = which ? tangent(s, fs->c[i].s) : normal(s, fs->c[i].s);
        j[n][0] = d.x;
        j[n][1] = d.y;
        j[n][2] = dot(d, perp(arm)) / s->size;
        e[n++] = -dot(d, sub(w, fs->c[i].at));
      }
    }
    for (r = 0; r < n; r++)
      for (c = 0; c < n; c++)
        a[r * n + c] = j[r][0] * j[c][0] + j[r][1] * j[c][1] + j[r][2] * j[c][2];
    if (n == 0 || !solve_linear(a, e, n))
      break;
    {
      flow_rate fix;
      memset(&fix, 0, sizeof fix);
      for (r = 0; r < n; r++) {
        fix.g.x += j[r][0] * e[r];
        fix.g.y += j[r][1] * e[r];
        fix.th += j[r][2] * e[r] / s->size;
      }
      *out = flow_moved(s, *out, &fix, 1);
    }
  }
  return 1;
}

/* Did anything end the flow at pose q? Fills v, k with a touching pair (or -1). */
static int flow_ended(const sim *s, const flow_set *fs, pose q, const real *limit, int *v, int *k)
{
  flow_rate r;
  int i, j;
  *v = *k = -1;
  for (i = 0; i < s->sc->nv; i++)
    for (j = 0; j < s->sc->ns; j++)
      if (find_contact(s, i, j) < 0 && gap(s, q, i, j) < limit[i * ORC_MAX_S + j]) {
        *v = i;
        *k = j;
        return 1;
      }
  if (!flow_velocity(s, fs, q, &r))
    return 1;
  return flow_slack(s, fs, q, &r, 0) < 0;
}

/* Follows the flow to its next event or to rest; 0 if no combination of modes is consistent. */
static int flow(sim *s, orc_report *rep, outcome *o)
{
  static real limit[ORC_MAX_V * ORC_MAX_S];
  flow_set fs;
  flow_rate r;
  con was[ORC_MAX_C];
  unsigned code, codes, opened = 0;
  int i, j, n, found = 0, v = -1, k = -1, nwas = 0;
  real tol = gap_tolerance(s);

  if (s->nc > 6)
    return 0;
  fs.nc = s->nc;
  for (i = 0; i < s->nc; i++)
    fs.c[i] = s->c[i];
  codes = 1u << (2 * s->nc);
  for (code = 0; code < codes && !found; code++) {
    for (i = 0; i < fs.nc; i++)
      fs.mode[i] = (int)(code >> (2 * (fs.nc - 1 - i)) & 3u);
    if (!flow_velocity(s, &fs, s->q, &r))
      continue;
    if (flow_speed(s, &r) < 1e-13L)
      continue;
    found = flow_slack(s, &fs, s->q, &r, 1) >= 0;
  }
  if (!found)
    return 0;
  rep->flow_stages++;
  rep->rules |= ORC_R_4_FLOW;
  for (i = 0; i < fs.nc; i++) {
    if (fs.mode[i] == F_OPEN)
      opened |= 1u << i;
    if (fs.mode[i] == F_PLUS || fs.mode[i] == F_MINUS)
      was[nwas++] = fs.c[i];
  }
  open_contacts(s, opened, rep);
  for (i = 0; i < s->sc->nv; i++)
    for (j = 0; j < s->sc->ns; j++) {
      real g = gap(s, s->q, i, j);
      limit[i * ORC_MAX_S + j] = (g < 0 ? g : 0) - tol;
    }
  for (n = 0; n < 200000; n++) {
    pose next;
    real speed, h, stiff;
    vec arm = rot(s->q.th, body_b(s));
    if (!flow_velocity(s, &fs, s->q, &r))
      break;
    speed = flow_speed(s, &r);
    if (speed < 1e-15L)
      break;
    /* short in distance, and stable for the stiffest direction of the spring */
    stiff = 4 + (s->kt > 0 ? 4 * s->kp * (s->size * s->size + dot(arm, arm)) / s->kt : 1000);
    if (stiff > 4000)
      stiff = 4000;
    h = ANGLE_STEP * (real)orc_step_factor / speed;
    if (h > 1 / stiff)
      h = 1 / stiff;
    if (!flow_step(s, &fs, s->q, h, &next))
      break;
    if (flow_ended(s, &fs, next, limit, &v, &k)) {
      real lo = 0, hi = h;
      for (i = 0; i < 80; i++) {
        real mid = (lo + hi) / 2;
        pose p;
        if (!flow_step(s, &fs, s->q, mid, &p) || flow_ended(s, &fs, p, limit, &v, &k))
          hi = mid;
        else
          lo = mid;
      }
      if (flow_step(s, &fs, s->q, hi, &next)) {
        flow_ended(s, &fs, next, limit, &v, &k);
        s->q = next;
      }
      break;
    }
    s->q = next;
  }
  note_travel(s, was, nwas, o);
  reanchor(s);
  forget_left(s);
  if (v >= 0)
    add_contact(s, v, k, rep);
  return 1;
}

/* ---- RELAX ---- */

/* HOLD. Returns 1 if a vertex touched (next stage). */
static int hold(sim *s, int opened_before, int skip_turn, orc_report *rep, outcome *o)
{
  motion m;
  stop r;
  real u0 = energy(s, s->q), rise;
  r.why = STOP_END;
  r.v = r.s = -1;
  if (s->nc == 0) {
    new_motion(s, &m, M_STRAIGHT);
    m.g1 = s->h;
    m.th1 = opened_before || s->kt == 0 ? s->q.th : s->phi;
    rep->rules |= opened_before ? ORC_R_FREE_OPENED : ORC_R_FREE;
    r = march_straight(s, &m);
    if (r.why == STOP_END && opened_before && s->kt > 0) {
      m.q0 = s->q;
      m.th1 = s->phi;
      r = march_straight(s, &m);
    }
  } else if (one_vertex(s)) {
    real mom = moment_about(s, s->q, s->c[0].at);
    if (skip_turn) {
      rep->rules |= ORC_R_TURN_SKIPPED;
    } else if (fabsl(mom) > moment_zero(s)) {
      new_motion(s, &m, M_TURN);
      m.c[0] = s->c[0];
      m.dir = mom > 0 ? 1 : -1;
      rep->rules |= ORC_R_TURN | (s->nc > 1 ? ORC_R_TURN_CORNER : 0);
      r = march_angle(s, &m);
      if (turn_snaps(s, &m, r.u)) {
        o->snapped = 1;
        rep->rules |= ORC_R_SNAP;
      }
    }
  }
  rise = (energy(s, s->q) - u0) / (s->kp * s->size * s->size);
  if ((double)rise > rep->hold_rise)
    rep->hold_rise = (double)rise;
  forget_left(s);
  if (r.why == STOP_TOUCH) {
    rep->rules |= ORC_R_HOLD_TOUCH;
    add_contact(s, r.v, r.s, rep);
    return 1;
  }
  return 0;
}

static int equal_friction(const sim *s)
{
  int i;
  for (i = 0; i < s->nc; i++)
    if (mu_s(s, s->c[i].s) != mu_d(s, s->c[i].s))
      return 0;
  return 1;
}

static void relax(sim *s, orc_report *rep, outcome *o)
{
  int stage, had_contact = s->nc > 0, opens0 = rep->opens, skip_turn = 0, done = 0;
  memset(o, 0, sizeof *o);
  for (stage = 0; stage < MAX_STAGES && !done; stage++) {
    int reached = 0;
    motion m;
    rep->stages++;
    if (hold(s, rep->opens > opens0 || (s->nc == 0 && had_contact), skip_turn, rep, o)) {
      had_contact = 1;
      o->acted = 1;
      o->slide = ORC_STUCK;
      skip_turn = 0;
      continue;
    }
    skip_turn = 0;
    if (s->nc == 0 || rests(s)) {
      done = 1;
      break;
    }
    o->acted = 1;
    o->slide = ORC_STUCK;
    if (s->nc == 1) {
      vec f = spring_force(s, s->q);
      if (-dot(f, normal(s, s->c[0].s)) <= 0) {
        rep->rules |= ORC_R_1_OPEN;
        open_contacts(s, 1u, rep);
      } else {
        rep->rules |= ORC_R_1_SLIDE;
        reached = slide_one(s, rep, o);
        if (reached)
          o->slide = ORC_SLIDE_ONE;
      }
    } else if (s->nc == 2 && pair_motion(s, &s->c[0], &s->c[1], &m)) {
      rep->rules |= m.kind == M_TRAMMEL    ? ORC_R_2_TRAMMEL
                    : m.c[0].s == m.c[1].s ? ORC_R_2_EDGE
                                           : ORC_R_2_PARALLEL;
      reached = slide_pair(s, &m, rep, o);
      if (reached)
        o->slide = m.kind == M_TRAMMEL ? ORC_SLIDE_TRAMMEL : ORC_SLIDE_PARALLEL;
    } else if (!open_some(s, rep, o, &reached)) {
      if (!flow(s, rep, o)) {
        rep->no_answer++;
        break;
      }
    }
    reanchor(s);
    skip_turn = reached;
    had_contact = 1;
  }
  if (!done) {
    if (stage >= MAX_STAGES)
      rep->limit++;
    o->slide = ORC_STUCK;
  }
  if (o->snapped)
    o->acted = 1;
  if (o->slide != ORC_STUCK) {
    int want = o->slide == ORC_SLIDE_ONE ? 1 : 2;
    if (s->nc != want || !equal_friction(s))
      o->slide = ORC_STUCK;
  }
  if (o->slid)
    rep->slips++;
}

/* ---- state in and out ---- */

static real object_size(const orc_scene *sc)
{
  real best = 0;
  int i, j;
  for (i = 0; i < sc->nv; i++)
    for (j = 0; j < i; j++) {
      real d = len(mk((real)sc->v[i][0] - sc->v[j][0], (real)sc->v[i][1] - sc->v[j][1]));
      if (d > best)
        best = d;
    }
  return best;
}

static void load(const orc_scene *sc, const orc_state *st, sim *s)
{
  int i;
  memset(s, 0, sizeof *s);
  s->sc = sc;
  s->size = object_size(sc);
  s->kp = sc->k_p;
  s->kt = sc->k_theta;
  s->q.x = st->q[0];
  s->q.y = st->q[1];
  s->q.th = st->q[2];
  s->nc = st->nc;
  for (i = 0; i < st->nc; i++) {
    s->c[i].v = st->c[i].vertex;
    s->c[i].s = st->c[i].surface;
    s->c[i].at = mk(st->at[i][0], st->at[i][1]);
  }
  s->n_left = st->n_left;
  memcpy(s->left, st->left, sizeof s->left);
}

static void store(const sim *s, orc_state *st)
{
  int i;
  st->q[0] = s->q.x;
  st->q[1] = s->q.y;
  st->q[2] = s->q.th;
  st->x = (double)s->q.x;
  st->y = (double)s->q.y;
  st->theta = (double)s->q.th;
  st->nc = s->nc;
  for (i = 0; i < s->nc; i++) {
    st->c[i].vertex = s->c[i].v;
    st->c[i].surface = s->c[i].s;
    st->at[i][0] = s->c[i].at.x;
    st->at[i][1] = s->c[i].at.y;
    st->c[i].place[0] = (double)s->c[i].at.x;
    st->c[i].place[1] = (double)s->c[i].at.y;
  }
  st->n_left = s->n_left;
  memcpy(st->left, s->left, sizeof s->left);
  st->hand[0] = (double)s->h.x;
  st->hand[1] = (double)s->h.y;
  st->hand[2] = (double)s->phi;
}

void orc_init(const orc_scene *sc, orc_state *st, double x, double y, double theta)
{
  sim s;
  orc_report rep;
  int i, j;
  memset(st, 0, sizeof *st);
  memset(&rep, 0, sizeof rep);
  st->q[0] = x;
  st->q[1] = y;
  st->q[2] = theta;
  load(sc, st, &s);
  for (i = 0; i < sc->nv; i++)
    for (j = 0; j < sc->ns; j++)
      if (gap(&s, s.q, i, j) <= TOL_NEAR * s.size)
        add_contact(&s, i, j, &rep);
  s.h = holding(&s, s.q);
  s.phi = theta;
  store(&s, st);
}

void orc_relax(const orc_scene *sc, orc_state *st, double hx, double hy, double phi, orc_report *rep)
{
  sim s;
  outcome o;
  load(sc, st, &s);
  s.h = mk(hx, hy);
  s.phi = phi;
  relax(&s, rep, &o);
  store(&s, st);
  st->pending = o.acted && o.slide == ORC_STUCK;
  st->slide = o.slide;
  st->sigma = o.sigma;
}

void orc_move_frame(const orc_scene *sc, orc_state *st, double hx, double hy, double phi, orc_report *rep)
{
  orc_relax(sc, st, hx, hy, phi, rep);
}

int orc_forces_exist(const orc_scene *sc, const orc_state *st, double hx, double hy, double phi)
{
  sim s;
  load(sc, st, &s);
  s.h = mk(hx, hy);
  s.phi = phi;
  return rests(&s);
}

/* ---- level event ---- */

typedef struct {
  real h0[3], h1[3];
} path;

static void hand_at(sim *s, const path *p, real lam)
{
  s->h = mk(p->h0[0] + lam * (p->h1[0] - p->h0[0]), p->h0[1] + lam * (p->h1[1] - p->h0[1]));
  s->phi = p->h0[2] + lam * (p->h1[2] - p->h0[2]);
  if (lam == 1) {
    s->h = mk(p->h1[0], p->h1[1]);
    s->phi = p->h1[2];
  }
}

#define MAX_MARGIN (4 + ORC_MAX_V * ORC_MAX_S)
typedef struct {
  int n;
  real m[MAX_MARGIN];
  real progress;
} margins;

/* How far the forces and gaps are from an event; for finding minima between steps. */
static void take_margins(const sim *s, int slide, margins *mg)
{
  int i, j;
  vec f = spring_force(s, s->q);
  mg->n = 0;
  if (slide == ORC_STUCK) {
    /* contact force -f between the two outer rays of the cone at the vertex */
    vec ray[2 * ORC_MAX_C], need = mul(-1, f);
    int n = 0, a, b, k;
    for (i = 0; i < s->nc; i++) {
      vec t = mul(mu_s(s, s->c[i].s), tangent(s, s->c[i].s));
      ray[n++] = add(normal(s, s->c[i].s), t);
      ray[n++] = sub(normal(s, s->c[i].s), t);
    }
    mg->m[mg->n++] = 0;
    mg->m[mg->n++] = 0;
    for (a = 0; a < n; a++)
      for (b = 0; b < n; b++) {
        if (cross(ray[a], ray[b]) <= 0)
          continue;
        for (k = 0; k < n; k++)
          if (cross(ray[a], ray[k]) < -1e-15L || cross(ray[k], ray[b]) < -1e-15L)
            break;
        if (k < n)
          continue;
        mg->m[0] = cross(ray[a], need) / s->kp;
        mg->m[1] = cross(need, ray[b]) / s->kp;
      }
  } else if (slide == ORC_SLIDE_ONE) {
    mg->m[mg->n++] = -dot(f, normal(s, s->c[0].s)) / s->kp;
  }
  for (i = 0; i < s->sc->nv; i++)
    for (j = 0; j < s->sc->ns; j++)
      if (find_contact(s, i, j) < 0)
        mg->m[mg->n++] = gap(s, s->q, i, j);
}

static int any_gap_below(const sim *s)
{
  int i, j;
  real tol = 2 * gap_tolerance(s);
  for (i = 0; i < s->sc->nv; i++)
    for (j = 0; j < s->sc->ns; j++)
      if (find_contact(s, i, j) < 0 && gap(s, s->q, i, j) < -tol)
        return 1;
  return 0;
}

/* Takes the state `a`, at rest, to the hand at lam without any event; 0 if an event comes between. `slide` says
 * what to follow; mg->progress is how far a sliding contact got in its direction (-1 and event 0: it would have to
 * move back). */
static int follow(const sim *a, const path *p, real lam, int slide, int sigma, sim *out, margins *mg)
{
  orc_report scrap;
  outcome o;
  motion m;
  stop r;
  memset(&scrap, 0, sizeof scrap);
  memset(&o, 0, sizeof o);
  *out = *a;
  mg->progress = 0;
  hand_at(out, p, lam);
  if (slide == ORC_STUCK) {
    if (hold(out, 0, 0, &scrap, &o) || o.snapped || !(out->nc == 0 || rests(out)))
      return 0;
  } else if (slide == ORC_SLIDE_ONE) {
    real mom = arc_moment(out, &out->c[0], sigma);
    new_motion(out, &m, M_ARC);
    m.c[0] = out->c[0];
    m.sigma = sigma;
    m.dir = mom > 0 ? 1 : -1;
    if (fabsl(mom) > moment_zero(out) * 1e-3L) {
      r = march_angle(out, &m);
      if (r.why != STOP_ZERO || turn_snaps(out, &m, r.u))
        return 0;
    } else {
      out->q = motion_pose(out, &m, 0);
    }
    if (-dot(spring_force(out, out->q), normal(out, out->c[0].s)) <= 0 || any_gap_below(out))
      return 0;
    mg->progress =
      sigma * dot(tangent(out, out->c[0].s), sub(vertex_at(out, out->q, out->c[0].v), a->c[0].at));
    reanchor(out);
    forget_left(out);
  } else {
    real nf[2], drive;
    new_motion(out, &m, slide == ORC_SLIDE_TRAMMEL ? M_TRAMMEL : M_PARALLEL);
    m.c[0] = out->c[0];
    m.c[1] = out->c[1];
    m.dir = sigma;
    motion_eval(out, &m, 0, &drive, nf);
    if (nf[0] <= 0 || nf[1] <= 0)
      return 0;
    if (drive < -(slide == ORC_SLIDE_TRAMMEL ? moment_zero(out) : TOL_MOMENT * out->kp * out->size) * 1e-3L) {
      mg->progress = -1;
    } else if (drive > 0) {
      r = slide == ORC_SLIDE_TRAMMEL ? march_angle(out, &m) : march_distance(out, &m);
      if (r.why != STOP_ZERO || r.jump)
        return 0;
      if (slide == ORC_SLIDE_TRAMMEL && turn_snaps(out, &m, r.u))
        return 0;
      mg->progress = r.u;
      reanchor(out);
      forget_left(out);
    }
  }
  take_margins(out, slide, mg);
  return 1;
}

/* Between lo (good, state *s) and hi (bad): moves *s to the last good time and returns it. */
static real last_good(sim *s, const path *p, real lo, real hi, int slide, int sigma)
{
  static margins mg;
  int i;
  for (i = 0; i < 80 && hi - lo > 1e-17L; i++) {
    real mid = (lo + hi) / 2;
    sim t;
    if (follow(s, p, mid, slide, sigma, &t, &mg) && mg.progress >= -STILL * s->size) {
      *s = t;
      lo = mid;
    } else {
      hi = mid;
    }
  }
  return lo;
}

/* The time of greatest progress of a slide from state p0 at lo; ties (back already) go to the left. */
static real turning_time(const sim *p0, const path *p, real lo, real hi, int slide, int sigma, sim *out)
{
  static margins mg;
  real a = lo, b = hi;
  int i;
  for (i = 0; i < 90 && b - a > 1e-12L * (hi - lo); i++) {
    real x1 = a + 0.381966011250105L * (b - a), x2 = a + 0.618033988749895L * (b - a), f1, f2;
    f1 = follow(p0, p, x1, slide, sigma, out, &mg) ? mg.progress : -1;
    f2 = follow(p0, p, x2, slide, sigma, out, &mg) ? mg.progress : -1;
    if (f1 < f2)
      a = x1;
    else
      b = x2;
  }
  if (!follow(p0, p, a, slide, sigma, out, &mg) || mg.progress < 0) {
    *out = *p0;
    return lo;
  }
  return a;
}

typedef struct {
  int slid; /* mu_s = mu_d: something slid in this sample without being counted yet */
} sample_note;

/* Follows from *lam until the next event or the end of the sample. Returns 1 for an event: then *s, *lam are the
 * last good state and time. *slide becomes ORC_STUCK where a sliding contact sticks. */
static int follow_to_event(sim *s, const path *p, real *lam, real step, int *slide, int sigma,
                           orc_report *rep, sample_note *note)
{
  static margins buf[3], probe;
  margins *old = &buf[0], *cur = &buf[1], *next = &buf[2], *tmp;
  sim s_old, s_next, t;
  real l_old = *lam, start = *lam;
  int have_old = 0, have_cur, i;

  if (s->nc == 0) {
    /* the free object goes with the hand: its path is the hand's */
    motion m;
    stop r;
    sim f = *s;
    hand_at(&f, p, 1);
    new_motion(&f, &m, M_STRAIGHT);
    m.g1 = f.h;
    m.th1 = f.kt > 0 ? f.phi : f.q.th;
    r = march_straight(&f, &m);
    if (r.why != STOP_TOUCH) {
      *s = f;
      forget_left(s);
      *lam = 1;
      return 0;
    }
    s->q = motion_pose(s, &m, r.u * (1 - 1e-18L));
    forget_left(s);
    *lam += r.u * (1 - *lam);
    return 1;
  }
  if (*slide == ORC_STUCK && !one_vertex(s)) {
    /* nothing moves, the load is linear in time and the cone convex: one change at most */
    t = *s;
    hand_at(&t, p, 1);
    if (rests(&t)) {
      *lam = 1;
      return 0;
    }
    *lam = last_good(s, p, *lam, 1, *slide, sigma);
    return 1;
  }
  have_cur = follow(s, p, *lam, *slide, sigma, &t, cur);
  s_old = *s;
  while (*lam < 1) {
    real to = *lam == start ? *lam + 1e-3L * step : *lam + step;
    if (*lam < 1 - 1e-3L * step && to > 1 - 1e-3L * step)
      to = 1 - 1e-3L * step;
    if (to > 1 || to <= *lam)
      to = 1;
    if (!follow(s, p, to, *slide, sigma, &s_next, next)) {
      *lam = last_good(s, p, *lam, to, *slide, sigma);
      return 1;
    }
    if (next->progress < -STILL * s->size) {
      /* moved back: the turning point lies in the last two steps */
      real from = have_old ? l_old : *lam, at;
      sim base = have_old ? s_old : *s;
      at = turning_time(&base, p, from, to, *slide, sigma, &s_next);
      *s = s_next;
      *lam = at;
      *slide = ORC_STUCK;
      rep->rules |= ORC_R_STICK;
      return 0;
    }
    if (have_old && have_cur && old->n == cur->n && cur->n == next->n) {
      for (i = 0; i < cur->n; i++) {
        real a, b;
        int it, bad = 0;
        if (!may_dip(old->m[i], cur->m[i], next->m[i], 0))
          continue;
        a = l_old;
        b = to;
        for (it = 0; it < 45 && !bad; it++) {
          real x1 = a + 0.381966011250105L * (b - a), x2 = a + 0.618033988749895L * (b - a), f1, f2;
          if (!follow(&s_old, p, x1, *slide, sigma, &t, &probe)) {
            b = x1;
            bad = 1;
            break;
          }
          f1 = probe.m[i];
          if (!follow(&s_old, p, x2, *slide, sigma, &t, &probe)) {
            b = x2;
            bad = 1;
            break;
          }
          f2 = probe.m[i];
          if (f1 < f2)
            b = x2;
          else
            a = x1;
        }
        if (bad) {
          rep->rules |= ORC_R_DOUBLE;
          *s = s_old;
          *lam = last_good(s, p, l_old, b, *slide, sigma);
          return 1;
        }
      }
    }
    if (*slide != ORC_STUCK) {
      rep->rules |= ORC_R_GOES_ON;
      if (next->progress > 0)
        note->slid = 1;
    }
    tmp = old;
    old = cur;
    cur = next;
    next = tmp;
    s_old = *s;
    l_old = *lam;
    have_old = have_cur;
    have_cur = 1;
    *s = s_next;
    *lam = to;
  }
  return 0;
}

/* One RELAX at lam. Returns whether it was an event after which h_min must pass. */
static int judge_at(sim *s, const path *p, real lam, int *slide, int *sigma, orc_report *rep,
                    sample_note *note)
{
  outcome o;
  hand_at(s, p, lam);
  relax(s, rep, &o);
  if (o.slide != ORC_STUCK) {
    /* mu_s = mu_d: counted once per sample */
    if (o.slid) {
      rep->slips--;
      note->slid = 1;
    }
    *slide = o.slide;
    *sigma = o.sigma;
    return 0;
  }
  *slide = ORC_STUCK;
  return o.acted;
}

void orc_move_event(const orc_scene *sc, orc_state *st, double hx0, double hy0, double phi0, double hx1,
                    double hy1, double phi1, orc_report *rep)
{
  sim s;
  path p;
  sample_note note;
  real lam = 0, length, step;
  int pending = st->pending, slide = st->slide, sigma = st->sigma, events = 0;

  load(sc, st, &s);
  note.slid = 0;
  p.h0[0] = hx0;
  p.h0[1] = hy0;
  p.h0[2] = phi0;
  p.h1[0] = hx1;
  p.h1[1] = hy1;
  p.h1[2] = phi1;
  length = len(mk(p.h1[0] - p.h0[0], p.h1[1] - p.h0[1])) + s.size * fabsl(p.h1[2] - p.h0[2]);
  if (length > 0) {
    step = 0.005L * (real)orc_step_factor * s.size / length;
    if (step > 0.125L)
      step = 0.125L;
    while (lam < 1) {
      if (pending) {
        real to = lam + H_MIN * s.size / length;
        if (to >= 1)
          break;
        lam = to;
        rep->rules |= ORC_R_WINDOW;
      } else {
        if (!follow_to_event(&s, &p, &lam, step, &slide, sigma, rep, &note))
          continue;
        lam += 1e-12L;
        if (lam >= 1)
          break;
      }
      if (++events > MAX_EVENTS) {
        rep->limit++;
        break;
      }
      rep->events++;
      pending = judge_at(&s, &p, lam, &slide, &sigma, rep, &note);
    }
  }
  if (slide != ORC_STUCK && lam >= 1 && events <= MAX_EVENTS && length > 0) {
    /* still sliding: the pose at the sample is the mu_d equilibrium already */
    hand_at(&s, &p, 1);
    pending = 0;
  } else if (slide == ORC_STUCK || length > 0) {
    pending = judge_at(&s, &p, 1, &slide, &sigma, rep, &note);
  } else {
    hand_at(&s, &p, 1);
  }
  if (note.slid)
    rep->slips++;
  store(&s, st);
  st->pending = pending;
  st->slide = slide;
  st->sigma = sigma;
}

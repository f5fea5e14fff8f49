/* What is proven here, and how. "Margin" is far above all rounding, also that of single precision.
 *
 * R is the largest distance between holding point g and a vertex. Held at the scene's point b, it is the
 * farthest vertex from b; taken by the button, b is within reach of the polygon, so R <= size + reach. The hand h
 * goes straight between samples, so the least gap of its positions to a surface holds for all of its way.
 *
 * BEHIND. No vertex is ever below a surface (invariant 1). A vertex on surface s is therefore on the part of the
 * line s that all other surfaces leave free; if that part is empty, s is never touched.
 *
 * FAR. Let `near` be a set of surfaces, and suppose that so far only those have been touched. Every motion of the
 * object is one of two kinds:
 *   - without contact: g goes along the straight way from where it is to h, so that its gap to s is no less than
 *     the smaller one of both ends;
 *   - with a contact on some j of `near`, at P on the free part of line j: |g - P| <= R. So the gap of g to s is
 *     at least (a) the least gap of that part of line j to s, minus R; or, where it is proven below that
 *     |h - g| <= D, at least (b) the least gap of the hand to s, minus D.
 * A vertex has at most R less gap than g. If what is left is above zero for every s outside of `near`, none of
 * those can be the first to be touched. `near` starts empty (but for what is touched at the start) and grows by
 * each s for which this fails; the bounds only get worse as it grows, so the order does not matter.
 *
 * D for one near surface, k_theta > 0; U is the spring's energy over k_p, kappa = k_theta/k_p, and the hand is at
 * most `depth` below the surface.
 *   At rest all contact forces are in one cone about n: N = k_p (g_n - h_n) <= k_p (R + depth), so that
 *   |h - g| <= B = sqrt(1 + mu_s^2) (R + depth). They act at a point of the surface within R of g, so
 *   kappa |phi - theta| <= R B. Free, both are zero.
 *   RELAX begins where the last one rested, the hand at most one step and one turn on, or at the start:
 *   U_0 <= (B + step)^2/2 + kappa (R B/kappa + turn)^2/2.
 *   Within RELAX only the slide of a single vertex can raise U: HOLD goes the way the moment points; an edge
 *   slides towards the hand; in the viscous flow the spring's power is the speed squared plus what friction
 *   takes. When a single vertex slides, its force balance makes |h - g| <= B, and its moment about the vertex drives
 *   the turn: where it turns away from phi, kappa |phi - theta| <= R B. So after it
 *   U <= B^2/2 + max(U before, (R B)^2/(2 kappa)), and after the 64 stages that RELAX has
 *   |h - g|^2/2 <= max(U_0, (R B)^2/(2 kappa)) + 32 B^2. Rows flagged 4 or 8 did not come to rest: there this fails.
 *
 * D for k_theta = 0 and any near surfaces without a slot: U is |h - g|^2/2 alone. A slide of one vertex ends with
 * |h - g| <= B; contacts on two surfaces that are not parallel are within L = size/sin(angle) of where their lines
 * cross, so that g is within L + R of there, whatever the forces; nothing else raises U. */
#include "needs.h"

#include "angle.h"

#include <math.h>
#include <string.h>

#define MARGIN 1e-5   /* of the largest coordinate */
#define PARALLEL 1e-9 /* rad */
#define LEVEL 1e-15   /* rad: rounding of a normal; such lines meet 1e10 scenes away */
#define STAGES 64     /* of one RELAX */

typedef struct vector {
  double x, y;
} vector;

/* The part of a surface's line that the others leave free: point + along * tangent, low <= along <= high. */
typedef struct part {
  vector point, tangent, normal;
  double low, high;
} part;

typedef struct analysis {
  const stic_scene *scene;
  const stic_hand_range *range;
  stic_needs *needs;
  double margin, kappa;
  vector holding; /* start's holding point */
  part parts[STIC_SURFACES_MAX];
  bool near[STIC_SURFACES_MAX];
  bool together[STIC_SURFACES_MAX][STIC_SURFACES_MAX]; /* [i][j], i < j: both can be touched at once */
} analysis;

/* ---- hand -------------------------------------------------------------------------------- */

static vector normal_of(const stic_scene *scene, int s)
{
  double n[2];

  stic_normal_from_degrees(scene->surfaces[s].normal_deg, n);
  return (vector){n[0], n[1]};
}

static double gap_of(const stic_scene *scene, int s, double x, double y)
{
  const stic_surface *surface = &scene->surfaces[s];
  const vector n = normal_of(scene, s);

  return (x - surface->point[0]) * n.x + (y - surface->point[1]) * n.y;
}

static vector body_to_world(const stic_scene *scene, const double v[2])
{
  const double c = cos(scene->angle), s = sin(scene->angle);

  return (vector){scene->x + c * v[0] - s * v[1], scene->y + s * v[0] + c * v[1]};
}

void stic_hand_range_anywhere(stic_hand_range *range)
{
  memset(range, 0, sizeof *range);
}

void stic_hand_range_begin(stic_hand_range *range)
{
  memset(range, 0, sizeof *range);
  range->known = true;
}

static void widen(stic_hand_range *range, const stic_scene *scene, double x, double y, bool first)
{
  const double at[2] = {x, y};

  for (int k = 0; k < 2; k++) {
    range->low[k] = first ? at[k] : fmin(range->low[k], at[k]);
    range->high[k] = first ? at[k] : fmax(range->high[k], at[k]);
  }
  for (int s = 0; s < scene->surface_count; s++) {
    const double gap = gap_of(scene, s, x, y);

    range->gap_min[s] = first ? gap : fmin(range->gap_min[s], gap);
  }
}

void stic_hand_range_box(stic_hand_range *range, const stic_scene *scene, const double low[2],
                         const double high[2])
{
  const vector g = body_to_world(scene, scene->holding_point);

  stic_hand_range_begin(range);
  for (int i = 0; i < 4; i++) {
    const double x = i & 1 ? high[0] : low[0], y = i & 2 ? high[1] : low[1];

    widen(range, scene, x, y, i == 0);
    range->start_pull = fmax(range->start_pull, hypot(x - g.x, y - g.y));
  }
  range->step = hypot(high[0] - low[0], high[1] - low[1]);
  range->turn = STIC_PI; /* the tracker's angle is taken to the nearest turn */
  range->start_turn = fabs(scene->angle) + STIC_PI;
}

void stic_hand_range_add(stic_hand_range *range, const stic_scene *scene, const stic_sample *sample)
{
  const double x = sample->position[0], y = sample->position[1], *q = sample->orientation;
  const bool first = range->samples == 0;
  double angle = q[2] == 0 && q[3] == 0 ? range->last_angle : 2 * atan2(q[2], q[3]);

  widen(range, scene, x, y, first);
  if (first) {
    const vector g = body_to_world(scene, scene->holding_point);

    angle = remainder(angle, 2 * STIC_PI);
    range->start_pull = hypot(x - g.x, y - g.y);
    range->start_turn = fabs(angle - scene->angle) + MARGIN;
  } else {
    range->step = fmax(range->step, hypot(x - range->last[0], y - range->last[1]));
    range->turn = fmax(range->turn, fabs(remainder(angle - range->last_angle, 2 * STIC_PI)) + MARGIN);
  }
  range->last[0] = x;
  range->last[1] = y;
  range->last_angle = angle;
  range->samples++;
}

/* ---- free parts of the surfaces ----------------------------------------------------------- */

static double dot(vector a, vector b)
{
  return a.x * b.x + a.y * b.y;
}

static double cross(vector a, vector b)
{
  return a.x * b.y - a.y * b.x;
}

static vector at(const part *p, double along)
{
  return (vector){p->point.x + along * p->tangent.x, p->point.y + along * p->tangent.y};
}

/* Between two normals, 0..pi. */
static double angle_between(vector a, vector b)
{
  return atan2(fabs(cross(a, b)), dot(a, b));
}

static bool is_empty(const part *p)
{
  return !(p->low <= p->high);
}

/* Keeps of the part what surface i leaves free, the margin included. */
static void clip(const analysis *a, part *p, int i)
{
  const part *by = &a->parts[i];
  const vector from = {p->point.x - by->point.x, p->point.y - by->point.y};
  const double gap = dot(from, by->normal) + a->margin, slope = dot(by->normal, p->tangent);

  if (fabs(slope) < LEVEL) {
    if (gap < 0)
      p->low = INFINITY, p->high = -INFINITY;
  } else if (slope > 0) {
    p->low = fmax(p->low, -gap / slope);
  } else {
    p->high = fmin(p->high, -gap / slope);
  }
}

static void find_parts(analysis *a)
{
  for (int s = 0; s < a->scene->surface_count; s++) {
    const double *point = a->scene->surfaces[s].point;
    const vector n = normal_of(a->scene, s);

    a->parts[s] = (part){{point[0], point[1]}, {n.y, -n.x}, n, -INFINITY, INFINITY};
  }
  for (int s = 0; s < a->scene->surface_count; s++) {
    stic_surface_needs *needs = &a->needs->surfaces[s];
    part *p = &a->parts[s];

    for (int i = 0; i < a->scene->surface_count && !is_empty(p); i++) {
      if (i == s)
        continue;
      clip(a, p, i);
      needs->behind = i;
    }
    if (is_empty(p))
      needs->reach = STIC_REACH_BEHIND;
  }
}

/* Least gap of a part to surface s. */
static double part_gap(const analysis *a, const part *p, int s)
{
  const double gap = gap_of(a->scene, s, p->point.x, p->point.y),
               slope = dot(normal_of(a->scene, s), p->tangent);

  if (fabs(slope) < PARALLEL)
    return isinf(p->low) || isinf(p->high) ? (fabs(slope) > 0 ? -INFINITY : gap)
                                           : fmin(gap + slope * p->low, gap + slope * p->high);
  return slope > 0 ? gap + slope * p->low : gap + slope * p->high;
}

/* ---- how far the object can be from the hand ------------------------------------------------ */

/* B: |h - g| at rest with all contacts on surface s. */
static double rest_pull(const analysis *a, int s)
{
  const double mu = a->scene->surfaces[s].friction.mu_static, depth = fmax(0, -a->range->gap_min[s]);

  return sqrt(1 + mu * mu) * (a->needs->radius + depth) + a->margin;
}

static double farthest_hand(const stic_hand_range *range, vector p)
{
  double farthest = 0;

  for (int i = 0; i < 4; i++)
    farthest = fmax(farthest, hypot((i & 1 ? range->high[0] : range->low[0]) - p.x,
                                    (i & 2 ? range->high[1] : range->low[1]) - p.y));
  return farthest;
}

/* With contacts on both surfaces: the pull that their place allows; infinite for a slot. */
static double pair_pull(const analysis *a, int i, int j)
{
  const part *p = &a->parts[i], *q = &a->parts[j];
  const double sine = fabs(cross(p->normal, q->normal));
  double along;

  if (sine < PARALLEL) {
    /* Facing each other farther apart than the object is large, they are never touched at once; facing the
     * same way they act as one. */
    const double apart = gap_of(a->scene, i, q->point.x, q->point.y);
    const bool facing = dot(p->normal, q->normal) < 0;

    return facing && apart <= a->needs->size + 2 * a->margin ? INFINITY : 0;
  }
  along = -gap_of(a->scene, j, p->point.x, p->point.y) / dot(q->normal, p->tangent);
  return farthest_hand(a->range, at(p, along)) + a->needs->size / sine + a->needs->radius;
}

/* D for the near surfaces; infinite where nothing is proven. */
static double farthest_pull(const analysis *a)
{
  const double radius = a->needs->radius, step = a->range->step;
  const bool by_start = a->scene->hold == STIC_HOLD_START;
  double pull = by_start ? a->range->start_pull : 0, u, turned, b;
  int count = 0, only = -1;

  for (int s = 0; s < a->scene->surface_count; s++) {
    if (!a->near[s])
      continue;
    count++;
    only = s;
    pull = fmax(pull, rest_pull(a, s) + step);
    for (int i = 0; i < s; i++)
      if (a->near[i])
        pull = fmax(pull, pair_pull(a, s, i) + step);
  }
  if (a->kappa == 0 || count == 0)
    return pull;
  if (count > 1)
    return INFINITY;
  b = rest_pull(a, only);
  turned = radius * b / a->kappa;
  u = fmax((b + step) * (b + step) / 2 + a->kappa * (turned + a->range->turn) * (turned + a->range->turn) / 2,
           radius * b * turned / 2);
  if (by_start)
    u = fmax(u, a->range->start_pull * a->range->start_pull / 2 +
                  a->kappa * a->range->start_turn * a->range->start_turn / 2);
  return sqrt(2 * u + STAGES * b * b);
}

/* ---- which surfaces can be touched ---------------------------------------------------------- */

static bool touches_at_start(const analysis *a, int s)
{
  for (int v = 0; v < a->scene->vertex_count; v++) {
    const vector p = body_to_world(a->scene, a->scene->vertices[v]);

    if (gap_of(a->scene, s, p.x, p.y) <= a->margin)
      return true;
  }
  return false;
}

/* Least gap that any vertex can have to s while only near surfaces are touched; `*at_rest`: only if every RELAX
 * comes to rest. */
static double least_gap(const analysis *a, int s, double pull, bool *at_rest)
{
  const double radius = a->needs->radius, hand = a->range->gap_min[s];
  double held = hand, by_place;

  *at_rest = false;
  if (a->scene->hold == STIC_HOLD_START)
    held = fmin(held, gap_of(a->scene, s, a->holding.x, a->holding.y));
  by_place = held;
  for (int j = 0; j < a->scene->surface_count; j++) {
    double place;

    if (!a->near[j])
      continue;
    place = part_gap(a, &a->parts[j], s) - radius;
    by_place = fmin(by_place, place);
    held = fmin(held, fmax(place, hand - pull));
  }
  *at_rest = by_place - radius <= a->margin;
  return held - radius;
}

static void find_far(analysis *a)
{
  bool grown = true;
  double pull = 0;

  for (int s = 0; s < a->scene->surface_count; s++)
    a->near[s] = a->needs->surfaces[s].reach == STIC_REACH_POSSIBLE && touches_at_start(a, s);
  while (grown) {
    grown = false;
    pull = farthest_pull(a);
    for (int s = 0; s < a->scene->surface_count && !grown; s++) {
      bool at_rest;

      if (a->near[s] || a->needs->surfaces[s].reach != STIC_REACH_POSSIBLE)
        continue;
      if (!(least_gap(a, s, pull, &at_rest) > a->margin))
        a->near[s] = grown = true;
    }
  }
  for (int s = 0; s < a->scene->surface_count; s++) {
    stic_surface_needs *n = &a->needs->surfaces[s];

    if (a->near[s] || n->reach != STIC_REACH_POSSIBLE)
      continue;
    n->reach = STIC_REACH_FAR;
    n->gap = least_gap(a, s, pull, &n->at_rest);
  }
}

/* ---- contact sets --------------------------------------------------------------------------- */

static double friction_angle(const analysis *a, int s)
{
  return atan(a->scene->surfaces[s].friction.mu_static);
}

static double distance_to_part(const part *p, vector point)
{
  const vector from = {point.x - p->point.x, point.y - p->point.y};
  const double along = fmax(p->low, fmin(p->high, dot(from, p->tangent)));
  const vector foot = at(p, along);

  return hypot(point.x - foot.x, point.y - foot.y);
}

static double distance_of_parts(const part *p, const part *q)
{
  double least = INFINITY;

  if (fabs(cross(p->normal, q->normal)) >= PARALLEL) {
    const vector from = {q->point.x - p->point.x, q->point.y - p->point.y};
    const double across = cross(p->tangent, q->tangent);
    const double x = cross(from, q->tangent) / across, y = cross(from, p->tangent) / across;

    if (x >= p->low && x <= p->high && y >= q->low && y <= q->high)
      return 0;
  } else if (isinf(p->low) && isinf(p->high)) {
    return distance_to_part(p, isinf(q->low) ? isinf(q->high) ? q->point : at(q, q->high) : at(q, q->low));
  }
  if (!isinf(p->low))
    least = fmin(least, distance_to_part(q, at(p, p->low)));
  if (!isinf(p->high))
    least = fmin(least, distance_to_part(q, at(p, p->high)));
  if (!isinf(q->low))
    least = fmin(least, distance_to_part(p, at(q, q->low)));
  if (!isinf(q->high))
    least = fmin(least, distance_to_part(p, at(q, q->high)));
  return least;
}

/* Smallest inner angle of the polygon. */
static double sharpest_vertex(const stic_scene *scene)
{
  double sharpest = STIC_PI;
  const int n = scene->vertex_count;

  for (int i = 0; i < n; i++) {
    const double *v = scene->vertices[i], *p = scene->vertices[(i + n - 1) % n],
                 *q = scene->vertices[(i + 1) % n];
    const vector to_p = {p[0] - v[0], p[1] - v[1]}, to_q = {q[0] - v[0], q[1] - v[1]};

    sharpest = fmin(sharpest, angle_between(to_p, to_q));
  }
  return sharpest;
}

/* Between parallel walls a pair of vertices wedges if the line through it is inside both cones: if the vertices
 * are D to D sqrt(1 + mu^2) apart. */
static bool slot_wedges(const analysis *a, int i, int j, double width)
{
  const double mu = tan(fmin(friction_angle(a, i), friction_angle(a, j))),
               longest = width * sqrt(1 + mu * mu);

  for (int v = 0; v < a->scene->vertex_count; v++)
    for (int w = 0; w < v; w++) {
      const double *p = a->scene->vertices[v], *q = a->scene->vertices[w],
                   apart = hypot(p[0] - q[0], p[1] - q[1]);

      if (apart >= width - 2 * a->margin && apart <= longest + 2 * a->margin)
        return true;
    }
  return false;
}

static bool find_pair(const analysis *a, int i, int j, stic_pair_needs *pair)
{
  const part *p = &a->parts[i], *q = &a->parts[j];
  const double between = angle_between(p->normal, q->normal),
               apart = gap_of(a->scene, i, q->point.x, q->point.y);
  const vector opposite = {-q->normal.x, -q->normal.y};

  memset(pair, 0, sizeof *pair);
  pair->first = i;
  pair->second = j;
  if (distance_of_parts(p, q) > a->needs->size + 4 * a->margin)
    return false;
  pair->slot = between > STIC_PI - PARALLEL && apart > a->margin;
  pair->two_vertex = true;
  pair->corner = !pair->slot && distance_of_parts(p, q) <= 4 * a->margin &&
                 sharpest_vertex(a->scene) <= STIC_PI - between + 1e-6;
  pair->wedging = angle_between(p->normal, opposite) <= friction_angle(a, i) + friction_angle(a, j) + 1e-6 &&
                  (!pair->slot || slot_wedges(a, i, j, apart));
  return true;
}

/* Do these three cones together hold every direction? No half-plane is without a ray of theirs then. */
static bool cones_surround(const analysis *a, const int surfaces[3])
{
  double rays[6], widest;

  for (int i = 0; i < 6; i++) {
    const vector n = a->parts[surfaces[i / 2]].normal;
    const double ray =
      remainder(atan2(n.y, n.x) + (i & 1 ? 1 : -1) * friction_angle(a, surfaces[i / 2]), 2 * STIC_PI);
    int k = i;

    for (; k > 0 && rays[k - 1] > ray; k--)
      rays[k] = rays[k - 1];
    rays[k] = ray;
  }
  widest = rays[0] + 2 * STIC_PI - rays[5];
  for (int i = 1; i < 6; i++)
    widest = fmax(widest, rays[i] - rays[i - 1]);
  return widest <= STIC_PI + 1e-6;
}

/* Where no two cones face each other, it takes three to hold every direction (Steinitz). */
static bool triple_wedges(const analysis *a)
{
  const int n = a->scene->surface_count;

  for (int i = 0; i < n; i++)
    for (int j = i + 1; j < n; j++)
      for (int k = j + 1; a->together[i][j] && k < n; k++) {
        const int surfaces[3] = {i, j, k};

        if (a->together[i][k] && a->together[j][k] && cones_surround(a, surfaces))
          return true;
      }
  return false;
}

static void find_contact_sets(analysis *a)
{
  stic_needs *n = a->needs;
  bool wedging_pair = false;

  n->vertex = n->edge = n->reachable > 0;
  for (int i = 0; i < a->scene->surface_count; i++)
    for (int j = i + 1; j < a->scene->surface_count; j++) {
      stic_pair_needs pair;

      if (n->surfaces[i].reach != STIC_REACH_POSSIBLE || n->surfaces[j].reach != STIC_REACH_POSSIBLE ||
          !find_pair(a, i, j, &pair))
        continue;
      a->together[i][j] = true;
      if (n->pair_count < STIC_NEEDS_PAIRS_MAX)
        n->pairs[n->pair_count] = pair;
      n->pair_count++;
      n->two_vertex |= pair.two_vertex;
      n->corner |= pair.corner;
      wedging_pair |= pair.wedging;
    }
  n->multi = n->pair_count > 0; /* an edge on the one, a vertex on the other */
  n->wedging = wedging_pair || triple_wedges(a);
}

static void find_friction(const stic_scene *scene, stic_needs *n)
{
  n->frictionless = n->jumpless = true;
  for (int s = 0; s < scene->surface_count; s++) {
    const stic_friction *f = &scene->surfaces[s].friction;

    if (n->surfaces[s].reach != STIC_REACH_POSSIBLE)
      continue;
    n->frictionless &= f->mu_static == 0;
    n->jumpless &= f->mu_static == f->mu_dynamic;
  }
}

/* ---- all ------------------------------------------------------------------------------------- */

static double holding_radius(const stic_scene *scene, double size)
{
  double radius = 0;

  if (scene->hold == STIC_HOLD_BUTTON)
    return size + scene->reach;
  for (int v = 0; v < scene->vertex_count; v++)
    radius = fmax(radius, hypot(scene->vertices[v][0] - scene->holding_point[0],
                                scene->vertices[v][1] - scene->holding_point[1]));
  return radius;
}

static double find_margin(const analysis *a)
{
  double largest = a->needs->size + fabs(a->scene->x) + fabs(a->scene->y);

  for (int s = 0; s < a->scene->surface_count; s++)
    largest = fmax(largest, fabs(a->scene->surfaces[s].point[0]) + fabs(a->scene->surfaces[s].point[1]));
  for (int k = 0; k < 2 && a->range->known; k++)
    largest = fmax(largest, fmax(fabs(a->range->low[k]), fabs(a->range->high[k])));
  return MARGIN * largest;
}

static void begin(analysis *a, const stic_scene *scene, const stic_hand_range *range, stic_needs *needs)
{
  memset(needs, 0, sizeof *needs);
  memset(a, 0, sizeof *a);
  a->scene = scene;
  a->range = range;
  a->needs = needs;
  needs->size = stic_scene_size(scene);
  needs->radius = holding_radius(scene, needs->size);
  a->kappa = scene->rotational_stiffness / scene->stiffness;
  a->holding = body_to_world(scene, scene->holding_point);
  a->margin = find_margin(a);
  find_parts(a);
}

void stic_needs_find_hidden(const stic_scene *scene, bool *hidden)
{
  analysis a;
  stic_needs needs;
  stic_hand_range anywhere;

  stic_hand_range_anywhere(&anywhere);
  begin(&a, scene, &anywhere, &needs);
  for (int s = 0; s < scene->surface_count; s++)
    hidden[s] = needs.surfaces[s].reach == STIC_REACH_BEHIND;
}

void stic_needs_find(const stic_scene *scene, const stic_hand_range *range, stic_needs *needs)
{
  analysis a;

  begin(&a, scene, range, needs);
  if (range->known)
    find_far(&a);
  for (int s = 0; s < scene->surface_count; s++) {
    const stic_reach reach = needs->surfaces[s].reach;

    needs->behind += reach == STIC_REACH_BEHIND;
    needs->reachable += reach == STIC_REACH_POSSIBLE;
  }
  find_contact_sets(&a);
  find_friction(scene, needs);
  needs->free_rotation = scene->rotational_stiffness == 0;
  needs->fixed_angle = needs->free_rotation && needs->reachable == 0;
}

#include "checker.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

void stic_checker_init(stic_checker *k, const stic_scene *scene, stic_precision precision)
{
  memset(k, 0, sizeof *k);
  k->scene = scene;
  k->ulp = precision == STIC_F32 ? FLT_EPSILON : precision == STIC_F64 ? DBL_EPSILON : (double)LDBL_EPSILON;
  k->size = stic_scene_size(scene);
  k->free[0] = scene->x, k->free[1] = scene->y;
  k->first = true;
}

/* Sizes between the object's start and what its coordinates are counted from, and from there to a surface's point. */
enum { LOCAL = 64 };

#define COMPLAIN(...)                                                                                        \
  do {                                                                                                       \
    if (!k->complaint[0])                                                                                    \
      snprintf(k->complaint, sizeof k->complaint, __VA_ARGS__);                                              \
  } while (0)

static double largest_of(double a, double b)
{
  return a > b ? a : b;
}

double stic_checker_rounding(const stic_checker *k, const stic_result *r)
{
  const stic_scene *s = k->scene;
  double turned = k->size * (1 + fabs(r->theta)),
         far = turned + fabs(r->x) + fabs(r->y) + fabs(r->hand_x) + fabs(r->hand_y);
  for (int i = 0; i < s->surface_count; i++)
    far = largest_of(far, fabs(s->surfaces[i].point[0]) + fabs(s->surfaces[i].point[1]));
  if (k->ulp <= DBL_EPSILON)
    return 4 * DBL_EPSILON * far;
  double moved = turned + fabs(r->x - k->free[0]) + fabs(r->y - k->free[1]) + fabs(r->hand_x - k->free[0]) +
                 fabs(r->hand_y - k->free[1]) + LOCAL * k->size;
  return 4 * (k->ulp * moved + DBL_EPSILON * far);
}

bool stic_same_contact(const stic_contact *a, const stic_contact *b)
{
  return a->vertex == b->vertex && a->surface == b->surface;
}

/* A row being checked, and what is needed of it often. */
typedef struct row {
  const stic_result *r;
  double cosine, sine;
  double rounding; /* m: of a place */
  double eps;      /* m: how far off a place may be */
} row;

static bool judged(const stic_result *r)
{
  return r->state != STIC_RELEASED && !(r->flags & (STIC_FLAG_NO_ANSWER | STIC_FLAG_LIMIT));
}

static bool is_finite(const stic_result *r)
{
  return isfinite(r->x) && isfinite(r->y) && isfinite(r->theta) && isfinite(r->force_x) &&
         isfinite(r->force_y) && isfinite(r->moment) && isfinite(r->residual) && r->contact_count >= 0 &&
         r->contact_count <= STIC_CONTACTS_MAX;
}

/* From `from` to vertex `v`. */
static void vertex_from(const stic_checker *k, const row *w, int v, const double from[2], double out[2])
{
  const double *b = k->scene->vertices[v];
  out[0] = w->r->x + w->cosine * b[0] - w->sine * b[1] - from[0];
  out[1] = w->r->y + w->sine * b[0] + w->cosine * b[1] - from[1];
}

/* 1. No vertex below a surface. */
static void check_depths(stic_checker *k, const row *w)
{
  const stic_result *r = w->r;
  const stic_scene *s = k->scene;
  for (int i = 0; i < s->surface_count; i++) {
    double n[2], at[2];
    stic_normal_from_degrees(s->surfaces[i].normal_deg, n);
    for (int v = 0; v < s->vertex_count; v++) {
      vertex_from(k, w, v, s->surfaces[i].point, at);
      double depth = -(at[0] * n[0] + at[1] * n[1]);
      double deep = w->eps; /* contacts are told from gaps to 1e-12 size */
      for (int q = 0; q < r->contact_count; q++)
        if (r->contacts[q].vertex == v && r->contacts[q].surface == i)
          deep = w->eps + 1e-12 * k->size;
      k->worst_depth = largest_of(k->worst_depth, depth / deep);
      if (!(depth <= deep))
        COMPLAIN("1: vertex %d is %.3g below surface %d, allowed %.3g (size %.3g)", v, depth, i, deep,
                 k->size);
    }
  }
}

/* Sum of spring and contacts about the holding point, and the largest terms in it. */
typedef struct load {
  double fx, fy, moment, largest, reach;
} load;

/* 3. A contact's force is inside its cone. False if there is no such contact. */
static bool check_contact(stic_checker *k, const row *w, int i, load *sum)
{
  const stic_scene *s = k->scene;
  const stic_result *r = w->r;
  const stic_contact *q = &r->contacts[i];
  double n[2], off[2];
  if (q->vertex < 0 || q->vertex >= s->vertex_count || q->surface < 0 || q->surface >= s->surface_count) {
    COMPLAIN("contact of vertex %d and surface %d", q->vertex, q->surface);
    return false;
  }
  double mu = s->surfaces[q->surface].friction.mu_static;
  stic_normal_from_degrees(s->surfaces[q->surface].normal_deg, n);
  k->contacts++;
  if (!(q->normal >= 0))
    COMPLAIN("3: N = %g at vertex %d", q->normal, q->vertex);
  /* N and T are components of one rounded force */
  double rounded = 16 * largest_of(k->ulp, DBL_EPSILON) * (1 + mu) * (q->normal + fabs(q->friction));
  if (!(fabs(q->friction) <= mu * q->normal + rounded))
    COMPLAIN("3: |T| = %.17g, mu_s N = %.17g at vertex %d", fabs(q->friction), mu * q->normal, q->vertex);
  double x = n[0] * q->normal + n[1] * q->friction, y = n[1] * q->normal - n[0] * q->friction;
  double arm_x = q->x - r->holding_x, arm_y = q->y - r->holding_y;
  sum->fx += x, sum->fy += y, sum->moment += arm_x * y - arm_y * x;
  sum->largest = largest_of(sum->largest, hypot(x, y));
  sum->reach = largest_of(sum->reach, hypot(arm_x, arm_y));
  /* The vertex is where its anchor is. */
  vertex_from(k, w, q->vertex, (const double[2]){q->x, q->y}, off);
  double distance = hypot(off[0], off[1]);
  double near = w->eps + 1e-12 * k->size; /* a touch at the end of a slide counts from 1e-12 size on */
  k->worst_anchor = largest_of(k->worst_anchor, distance / near);
  if (!(distance <= near))
    COMPLAIN("vertex %d is %.3g from its anchor, allowed %.3g (size %.3g)", q->vertex, distance, near,
             k->size);
  if (i && (q[-1].vertex > q->vertex || (q[-1].vertex == q->vertex && q[-1].surface >= q->surface)))
    COMPLAIN("contacts out of order");
  return true;
}

/* 2. Forces and moments balance. A place wrong by its rounding is a force wrong by k_p times that; JUDGE itself looks
 * to 1e-12 k_p size. */
static void check_balance(stic_checker *k, const row *w, const load *sum)
{
  const stic_result *r = w->r;
  const double k_p = k->scene->stiffness, k_theta = k->scene->rotational_stiffness, largest = sum->largest;
  /* The angle's rounding times k_theta, also in forces of contacts, which follow from the moment. */
  double angle = 8 * largest_of(k->ulp, DBL_EPSILON) * (fabs(r->theta) + fabs(r->hand_theta));
  double stiff = k_theta * angle / k->size;
  double allowed = largest_of(4096 * k->ulp, 16 * DBL_EPSILON) * largest + k_p * w->rounding +
                   1e-12 * k_p * k->size + (r->contact_count > 0 ? stiff : 0);
  double off = hypot(sum->fx, sum->fy), off_moment = fabs(sum->moment) / largest_of(k->size, sum->reach);
  /* The arm's rounding times the force. */
  double allowed_moment = allowed + largest * w->rounding / k->size + (r->contact_count > 0 ? 0 : stiff);
  if (r->state == STIC_FREE && k_theta == 0)
    off_moment = 0;
  k->worst_relative_residual = largest_of(k->worst_relative_residual, largest_of(off, off_moment) / largest);
  k->worst_residual = largest_of(k->worst_residual, largest_of(off / allowed, off_moment / allowed_moment));
  if (!(off <= allowed))
    COMPLAIN("2: force residual %.3g, allowed %.3g (largest %.3g)", off, allowed, largest);
  if (!(off_moment <= allowed_moment))
    COMPLAIN("2: moment residual %.3g, allowed %.3g (largest %.3g)", off_moment, allowed_moment, largest);
  if (!(r->residual <= (4096 * k->ulp + 2e-12 + allowed_moment / largest) * sum->reach / k->size))
    COMPLAIN("2: the row says a residual of %.3g", r->residual);
}

/* 2, 3. Forces inside the cones, in balance about the holding point. False if a contact is none. */
static bool check_forces(stic_checker *k, const row *w)
{
  const stic_result *r = w->r;
  load sum = {r->force_x, r->force_y, r->moment, k->scene->stiffness * k->size, k->size};
  sum.largest = largest_of(sum.largest, largest_of(hypot(sum.fx, sum.fy), fabs(sum.moment) / k->size));
  for (int i = 0; i < r->contact_count; i++)
    if (!check_contact(k, w, i, &sum))
      return false;
  if (judged(r))
    check_balance(k, w, &sum);
  return true;
}

/* 4. A stuck anchor does not move by a bit, unless an event says so. A slide below 1e-12 size is none in the model's
 * count, and no event; f80's are rounded when they are written. Sliding on (mu_s = mu_d) is no choice of JUDGE's and
 * may end with its own rounding. */
static void check_moved(stic_checker *k, const stic_contact *now, const stic_contact *then, bool said,
                        bool may_slide, double rounding)
{
  const stic_friction *f = &k->scene->surfaces[now->surface].friction;
  double slid = hypot(now->x - then->x, now->y - then->y);
  double written = k->ulp < DBL_EPSILON ? DBL_EPSILON * (fabs(now->x) + fabs(now->y)) : 0;
  bool slides_on = f->mu_static == f->mu_dynamic;
  if (said || slid == 0)
    return;
  if ((slides_on || may_slide) && slid <= 1e-12 * k->size + (slides_on ? rounding : written))
    k->tiny_slides++;
  else
    COMPLAIN("4: the anchor of vertex %d on surface %d moved by %.3g, %.3g without a slip", now->vertex,
             now->surface, now->x - then->x, now->y - then->y);
}

static void check_anchors(stic_checker *k, const row *w, const stic_event *events, int event_count,
                          bool may_slide)
{
  const stic_result *r = w->r;
  for (int i = 0; i < r->contact_count; i++)
    for (int j = 0; j < k->last.contact_count; j++) {
      bool said = event_count == STIC_EVENTS_MAX;
      if (!stic_same_contact(&r->contacts[i], &k->last.contacts[j]))
        continue;
      for (int n = 0; n < event_count && !said; n++)
        said = events[n].vertex == r->contacts[i].vertex && events[n].kind != STIC_EVENT_SNAP;
      check_moved(k, &r->contacts[i], &k->last.contacts[j], said, may_slide, w->rounding);
    }
}

/* 7. What must not move since the last row: all of it, or beyond rounding. */
static void check_rest(stic_checker *k, const row *w)
{
  const stic_result *r = w->r;
  const stic_result *last = &k->last;
  const bool moved =
    r->x != last->x || r->y != last->y || r->theta != last->theta || r->contact_count != last->contact_count;
  const bool hand_stands =
    r->hand_x == last->hand_x && r->hand_y == last->hand_y && r->hand_theta == last->hand_theta;
  const double off = hypot(r->x - last->x, r->y - last->y) + k->size * fabs(r->theta - last->theta);
  if ((r->flags & STIC_FLAG_NO_ANSWER) && last->state != STIC_RELEASED && moved)
    COMPLAIN("no answer, but moved");
  if (r->state == STIC_RELEASED && moved)
    COMPLAIN("7: moved while released");
  if (judged(r) && judged(last) && hand_stands && !(off <= w->eps))
    COMPLAIN("7: moved by %.3g under a hand that stands still", off);
  /* Taken again: the spring starts slack. */
  if (r->state != STIC_RELEASED && last->state == STIC_RELEASED && moved)
    COMPLAIN("7: moved by %.3g when taken", off);
}

void stic_checker_row(stic_checker *k, const stic_result *r, const stic_event *events, int event_count,
                      bool may_slide)
{
  row w = {r, cos(r->theta), sin(r->theta), stic_checker_rounding(k, r), 0};
  if (!k->first && r->x == k->last.x && r->y == k->last.y && r->theta == k->last.theta)
    w.rounding = largest_of(w.rounding, k->last_rounding);
  w.eps = 4096 * k->ulp * k->size + w.rounding;
  k->rows++;
  if (r->flags & (STIC_FLAG_NO_ANSWER | STIC_FLAG_LIMIT))
    k->flagged++;
  if (!is_finite(r)) {
    COMPLAIN("not finite");
    return;
  }
  check_depths(k, &w);
  if (r->state == STIC_RELEASED && (r->force_x != 0 || r->force_y != 0 || r->moment != 0))
    COMPLAIN("released, but the spring pulls");
  if (!check_forces(k, &w))
    return;
  if (!k->first) {
    check_anchors(k, &w, events, event_count, may_slide);
    check_rest(k, &w);
  }
  if (r->contact_count == 0)
    k->free[0] = r->x, k->free[1] = r->y;
  k->last = *r;
  k->last_rounding = w.rounding;
  k->first = false;
}

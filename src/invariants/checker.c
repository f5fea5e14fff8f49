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
  k->first = true;
}

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
  double ulp = largest_of(k->ulp, DBL_EPSILON),
         far = fabs(r->x) + fabs(r->y) + k->size * (1 + fabs(r->theta));
  far += fabs(r->hand_x) + fabs(r->hand_y);
  for (int i = 0; i < k->scene->surface_count; i++)
    far = largest_of(far, fabs(k->scene->surfaces[i].point[0]) + fabs(k->scene->surfaces[i].point[1]));
  return 4 * ulp * far;
}

bool stic_same_contact(const stic_contact *a, const stic_contact *b)
{
  return a->vertex == b->vertex && a->surface == b->surface;
}

void stic_checker_row(stic_checker *k, const stic_result *r, const stic_event *events, int event_count,
                      bool may_slide)
{
  const stic_scene *s = k->scene;
  double c = cos(r->theta), si = sin(r->theta), k_p = s->stiffness, rounding = stic_checker_rounding(k, r);
  if (!k->first && r->x == k->last.x && r->y == k->last.y && r->theta == k->last.theta)
    rounding = largest_of(rounding, k->last_rounding);
  double eps = 4096 * k->ulp * k->size + rounding;
  k->rows++;
  if (r->flags & (STIC_FLAG_NO_ANSWER | STIC_FLAG_LIMIT))
    k->flagged++;
  if (!isfinite(r->x) || !isfinite(r->y) || !isfinite(r->theta) || !isfinite(r->force_x) ||
      !isfinite(r->force_y) || !isfinite(r->moment) || !isfinite(r->residual) || r->contact_count < 0 ||
      r->contact_count > STIC_CONTACTS_MAX) {
    COMPLAIN("not finite");
    return;
  }
  /* 1. No vertex below a surface. */
  for (int i = 0; i < s->surface_count; i++) {
    double n[2];
    stic_normal_from_degrees(s->surfaces[i].normal_deg, n);
    for (int v = 0; v < s->vertex_count; v++) {
      const double *b = s->vertices[v], *p = s->surfaces[i].point;
      double x = r->x + c * b[0] - si * b[1] - p[0], y = r->y + si * b[0] + c * b[1] - p[1],
             depth = -(x * n[0] + y * n[1]);
      double deep = eps; /* contacts are told from gaps to 1e-12 size */
      for (int q = 0; q < r->contact_count; q++)
        if (r->contacts[q].vertex == v && r->contacts[q].surface == i)
          deep = eps + 1e-12 * k->size;
      k->worst_depth = largest_of(k->worst_depth, depth / deep);
      if (!(depth <= deep))
        COMPLAIN("1: vertex %d is %.3g below surface %d, allowed %.3g (size %.3g)", v, depth, i, deep,
                 k->size);
    }
  }
  if (r->state == STIC_RELEASED) {
    if (r->force_x != 0 || r->force_y != 0 || r->moment != 0)
      COMPLAIN("released, but the spring pulls");
  }
  /* 2, 3. Forces inside the cones, in balance about the holding point. */
  double fx = r->force_x, fy = r->force_y, moment = r->moment, largest = k_p * k->size, reach = k->size;
  largest = largest_of(largest, largest_of(hypot(fx, fy), fabs(moment) / k->size));
  for (int i = 0; i < r->contact_count; i++) {
    const stic_contact *q = &r->contacts[i];
    double n[2], mu;
    if (q->vertex < 0 || q->vertex >= s->vertex_count || q->surface < 0 || q->surface >= s->surface_count) {
      COMPLAIN("contact of vertex %d and surface %d", q->vertex, q->surface);
      return;
    }
    mu = s->surfaces[q->surface].friction.mu_static;
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
    fx += x, fy += y, moment += arm_x * y - arm_y * x;
    largest = largest_of(largest, hypot(x, y));
    reach = largest_of(reach, hypot(arm_x, arm_y));
    /* The vertex is where its anchor is. */
    const double *b = s->vertices[q->vertex];
    double off = hypot(r->x + c * b[0] - si * b[1] - q->x, r->y + si * b[0] + c * b[1] - q->y);
    double near = eps + 1e-12 * k->size; /* a touch at the end of a slide counts from 1e-12 size on */
    k->worst_anchor = largest_of(k->worst_anchor, off / near);
    if (!(off <= near))
      COMPLAIN("vertex %d is %.3g from its anchor, allowed %.3g (size %.3g)", q->vertex, off, near, k->size);
    if (i && (q[-1].vertex > q->vertex || (q[-1].vertex == q->vertex && q[-1].surface >= q->surface)))
      COMPLAIN("contacts out of order");
  }
  bool judged = r->state != STIC_RELEASED && !(r->flags & (STIC_FLAG_NO_ANSWER | STIC_FLAG_LIMIT));
  if (judged) {
    /* A place wrong by its rounding is a force wrong by k_p times that; JUDGE itself looks to 1e-12 k_p size. */
    double allowed =
      largest_of(4096 * k->ulp, 16 * DBL_EPSILON) * largest + k_p * rounding + 1e-12 * k_p * k->size;
    double off = hypot(fx, fy), off_moment = fabs(moment) / largest_of(k->size, reach);
    /* The arm's rounding times the force, and the angle's times k_theta. */
    double angle = 8 * largest_of(k->ulp, DBL_EPSILON) * (fabs(r->theta) + fabs(r->hand_theta));
    double allowed_moment =
      allowed + largest * rounding / k->size + s->rotational_stiffness * angle / k->size;
    if (r->state == STIC_FREE && s->rotational_stiffness == 0)
      off_moment = 0;
    k->worst_relative_residual =
      largest_of(k->worst_relative_residual, largest_of(off, off_moment) / largest);
    k->worst_residual = largest_of(k->worst_residual, largest_of(off / allowed, off_moment / allowed_moment));
    if (!(off <= allowed))
      COMPLAIN("2: force residual %.3g, allowed %.3g (largest %.3g)", off, allowed, largest);
    if (!(off_moment <= allowed_moment))
      COMPLAIN("2: moment residual %.3g, allowed %.3g (largest %.3g)", off_moment, allowed_moment, largest);
    if (!(r->residual <= (4096 * k->ulp + 2e-12 + allowed_moment / largest) * reach / k->size))
      COMPLAIN("2: the row says a residual of %.3g", r->residual);
  }
  /* 4. A stuck anchor does not move by a bit. */
  for (int i = 0; !k->first && i < r->contact_count; i++)
    for (int j = 0; j < k->last.contact_count; j++) {
      const stic_contact *now = &r->contacts[i], *then = &k->last.contacts[j];
      const stic_friction *f = &s->surfaces[now->surface].friction;
      bool moved = now->x != then->x || now->y != then->y, said = false;
      if (!stic_same_contact(now, then) || !moved)
        continue;
      for (int n = 0; n < event_count && !said; n++)
        said = events[n].vertex == now->vertex && events[n].kind != STIC_EVENT_SNAP;
      said |= event_count == STIC_EVENTS_MAX;
      /* A slide below 1e-12 size is none in the model's count, and no event; f80's are rounded when they are
       * written. Sliding on (mu_s = mu_d) is no choice of JUDGE's and may end with its own rounding. */
      double slid = hypot(now->x - then->x, now->y - then->y);
      double written = k->ulp < DBL_EPSILON ? DBL_EPSILON * (fabs(now->x) + fabs(now->y)) : 0;
      bool slides_on = f->mu_static == f->mu_dynamic;
      if (!said && (slides_on || may_slide) && slid <= 1e-12 * k->size + (slides_on ? rounding : written))
        k->tiny_slides++, said = true;
      if (!said)
        COMPLAIN("4: the anchor of vertex %d on surface %d moved by %.3g, %.3g without a slip", now->vertex,
                 now->surface, now->x - then->x, now->y - then->y);
    }
  /* No answer: the object is where it last was. */
  if (!k->first && (r->flags & STIC_FLAG_NO_ANSWER) && k->last.state != STIC_RELEASED &&
      (r->x != k->last.x || r->y != k->last.y || r->theta != k->last.theta ||
       r->contact_count != k->last.contact_count))
    COMPLAIN("no answer, but moved");
  /* 7. Released, nothing moves. */
  if (!k->first && r->state == STIC_RELEASED &&
      (r->x != k->last.x || r->y != k->last.y || r->theta != k->last.theta ||
       r->contact_count != k->last.contact_count))
    COMPLAIN("7: moved while released");
  /* The hand stands still: nothing moves beyond rounding. */
  if (!k->first && judged && k->last.state != STIC_RELEASED && r->hand_x == k->last.hand_x &&
      r->hand_y == k->last.hand_y && r->hand_theta == k->last.hand_theta &&
      !(k->last.flags & (STIC_FLAG_NO_ANSWER | STIC_FLAG_LIMIT))) {
    double off = hypot(r->x - k->last.x, r->y - k->last.y) + k->size * fabs(r->theta - k->last.theta);
    if (!(off <= eps))
      COMPLAIN("7: moved by %.3g under a hand that stands still", off);
  }
  /* Taken again: the spring starts slack, so nothing moves either. */
  if (!k->first && r->state != STIC_RELEASED && k->last.state == STIC_RELEASED) {
    double off = hypot(r->x - k->last.x, r->y - k->last.y) + k->size * fabs(r->theta - k->last.theta);
    if (!(off <= eps))
      COMPLAIN("7: moved by %.3g when taken", off);
  }
  k->last = *r;
  k->last_rounding = rounding;
  k->first = false;
}

#include "collide.h"

#include "clock.h"

#include <assert.h>
#include <math.h>
#include <ode/ode.h>
#include <stdlib.h>
#include <string.h>

struct stic_collider {
  bool by_ode;
  dGeomID object;                      /* the polygon, extruded along z */
  dGeomID surfaces[STIC_SURFACES_MAX]; /* one plane each, moved out by the reach at every query */
  double normals[STIC_SURFACES_MAX][2];
  int vertex_count, surface_count;
  double unit, radius; /* radius: farthest vertex from the centre, in units */
  double centre[2];    /* mean of the vertices: ODE wants its origin inside */
  bool clock_on;
  int64_t elapsed_ns;
  /* ODE keeps pointers to these. */
  dReal points[2 * STIC_VERTICES_MAX * 3];
  dReal planes[(STIC_VERTICES_MAX + 2) * 4];
  unsigned polygons[2 * (STIC_VERTICES_MAX + 1) + 5 * STIC_VERTICES_MAX];
  dContactGeom contacts[2 * STIC_VERTICES_MAX];
};

/* The prism over the polygon: ODE's convex geom wants points, face planes and face outlines. */
static void extrude(stic_collider *c, const stic_scene *scene)
{
  int n = scene->vertex_count;
  unsigned *face = c->polygons;
  for (int i = 0; i < n; i++)
    for (int k = 0; k < 2; k++)
      c->centre[k] += scene->vertices[i][k] / c->unit / n;
  for (int i = 0; i < n; i++) {
    double x = scene->vertices[i][0] / c->unit - c->centre[0],
           y = scene->vertices[i][1] / c->unit - c->centre[1];
    const double *next = scene->vertices[(i + 1) % n];
    double ex = next[0] / c->unit - c->centre[0] - x, ey = next[1] / c->unit - c->centre[1] - y;
    double length = sqrt(ex * ex + ey * ey);
    dReal *side = c->planes + 4 * i;
    side[0] = ey / length, side[1] = -ex / length, side[2] = 0, side[3] = (ey * x - ex * y) / length;
    for (int k = 0; k < 2; k++) {
      dReal *point = c->points + 3 * (i + k * n);
      point[0] = x, point[1] = y, point[2] = k == 0 ? -0.5 : 0.5;
    }
    c->radius = fmax(c->radius, sqrt(x * x + y * y));
  }
  for (int k = 0; k < 2; k++) {
    dReal *cap = c->planes + 4 * (n + k);
    cap[0] = cap[1] = 0, cap[2] = k == 0 ? -1 : 1, cap[3] = 0.5;
  }
  for (int i = 0; i < n; i++) {
    unsigned a = (unsigned)i, b = (unsigned)((i + 1) % n), m = (unsigned)n;
    *face++ = 4, *face++ = a, *face++ = b, *face++ = b + m, *face++ = a + m;
  }
  for (int k = 0; k < 2; k++) {
    *face++ = (unsigned)n;
    for (int i = 0; i < n; i++)
      *face++ = (unsigned)(k == 0 ? n - 1 - i : n + i);
  }
}

static bool make_geoms(stic_collider *c)
{
  unsigned n = (unsigned)c->vertex_count;
  c->object = dCreateConvex(0, c->planes, n + 2, c->points, 2 * n, c->polygons);
  bool good = c->object != NULL;
  for (int s = 0; good && s < c->surface_count; s++) {
    c->surfaces[s] = dCreatePlane(0, c->normals[s][0], c->normals[s][1], 0, 0);
    good = c->surfaces[s] != NULL;
  }
  return good;
}

stic_collider *stic_collider_create(const stic_scene *scene, double unit, const int *surfaces, int count,
                                    bool by_ode)
{
  stic_collider *c = calloc(1, sizeof *c);
  if (!c)
    return NULL;
  c->unit = unit;
  c->vertex_count = scene->vertex_count;
  c->surface_count = count;
  for (int s = 0; s < count; s++)
    stic_normal_from_degrees(scene->surfaces[surfaces[s]].normal_deg, c->normals[s]);
  extrude(c, scene);
  /* ODE counts its own initialisations, so several simulations may do this. */
  c->by_ode = by_ode && dInitODE2(0);
  if (by_ode && !(c->by_ode && make_geoms(c))) {
    stic_collider_destroy(c);
    return NULL;
  }
  return c;
}

void stic_collider_destroy(stic_collider *c)
{
  if (!c)
    return;
  for (int s = 0; s < c->surface_count && c->surfaces[s]; s++)
    dGeomDestroy(c->surfaces[s]);
  if (c->object)
    dGeomDestroy(c->object);
  if (c->by_ode)
    dCloseODE();
  free(c);
}

/* Which vertex of the prism ODE's contact point is; it is one of them, up to its own rounding. */
static int nearest_vertex(const stic_collider *c, const dReal *point, double cosine, double sine)
{
  int best = 0;
  double best_distance = INFINITY;
  for (int i = 0; i < c->vertex_count; i++) {
    const dReal *v = c->points + 3 * i;
    double dx = cosine * v[0] - sine * v[1] - point[0], dy = sine * v[0] + cosine * v[1] - point[1];
    double distance = dx * dx + dy * dy;
    if (distance < best_distance)
      best_distance = distance, best = i;
  }
  return best;
}

/* Those whose gap is at most `reach`; `gap` is that of the centre. */
static uint64_t near_by_gaps(const stic_collider *c, int s, double gap, double cosine, double sine,
                             double reach)
{
  const double nx = cosine * c->normals[s][0] + sine * c->normals[s][1],
               ny = cosine * c->normals[s][1] - sine * c->normals[s][0];
  uint64_t mask = 0;
  for (int i = 0; i < c->vertex_count; i++) {
    const dReal *v = c->points + 3 * i;
    mask |= (uint64_t)(gap + nx * v[0] + ny * v[1] <= reach) << i;
  }
  return mask;
}

static uint64_t near_by_ode(stic_collider *c, int s, double gap, double cosine, double sine, double reach)
{
  const uint64_t all = c->vertex_count == 64 ? ~UINT64_C(0) : (UINT64_C(1) << c->vertex_count) - 1;
  /* ODE's convex-plane test reports nothing for an object that lies entirely behind the plane. */
  if (gap <= reach - c->radius)
    return all;
  dGeomPlaneSetParams(c->surfaces[s], c->normals[s][0], c->normals[s][1], 0, reach - gap);
  int count = dCollide(c->object, c->surfaces[s], 2 * c->vertex_count, c->contacts, sizeof c->contacts[0]);
  if (count == 0) {
    /* Either side of the moved plane: the deepest and the highest vertex agree in sign. */
    return dGeomPlanePointDepth(c->surfaces[s], c->points[0] * cosine - c->points[1] * sine,
                                c->points[0] * sine + c->points[1] * cosine, 0) > 0
             ? all
             : 0;
  }
  uint64_t mask = 0;
  for (int i = 0; i < count; i++)
    mask |= UINT64_C(1) << nearest_vertex(c, c->contacts[i].pos, cosine, sine);
  return mask;
}

int stic_collide_near(stic_collider *c, const double *gaps, double cosine, double sine, double reach,
                      uint64_t *masks)
{
  int64_t start = c->clock_on ? stic_clock_ns() : 0;
  if (c->by_ode) {
    const dMatrix3 rotation = {cosine, -sine, 0, 0, sine, cosine, 0, 0, 0, 0, 1, 0};
    dGeomSetRotation(c->object, rotation);
  }
  double widened = reach / c->unit * (1 + 1e-7) + 1e-7;
  double cx = cosine * c->centre[0] - sine * c->centre[1], cy = sine * c->centre[0] + cosine * c->centre[1];
  int found = 0;
  for (int s = 0; s < c->surface_count; s++) {
    double gap = gaps[s] / c->unit + c->normals[s][0] * cx + c->normals[s][1] * cy;
    masks[s] = gap > c->radius + widened ? 0
               : c->by_ode               ? near_by_ode(c, s, gap, cosine, sine, widened)
                                         : near_by_gaps(c, s, gap, cosine, sine, widened);
    found += masks[s] != 0;
  }
  if (c->clock_on)
    c->elapsed_ns += stic_clock_ns() - start;
  return found;
}

void stic_collider_clock(stic_collider *c, bool on)
{
  c->clock_on = on;
}

int64_t stic_collider_take_ns(stic_collider *c)
{
  int64_t elapsed = c->elapsed_ns;
  c->elapsed_ns = 0;
  return elapsed;
}

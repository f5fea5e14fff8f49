/* What stays: slabs with their grid. Built once per camera. */
#include "view.h"

#include <math.h>
#include <stdio.h>

#define STRIPS 12
#define HATCH_MAX 4000
#define GRID_MAX 2000

static stic_color fog(const stic_view *v, stic_color color, double z)
{
  double near = v->z_front - 0.45 * (v->z_front - v->z_back);
  double t = fmin(fmax((near - z) / (near - v->z_back), 0), 1);

  return stic_color_mix(color, v->theme->background, t * t * (3 - 2 * t));
}

static double strip_z(const stic_view *v, int i)
{
  return v->z_front + (v->z_back - v->z_front) * i / STRIPS;
}

/* The wall of an extruded polygon over one of its edges, fading into the distance. */
static void extrude_edge(const stic_view *v, stic_mesh *mesh, const double a[2], const double b[2],
                         stic_color color)
{
  double length = hypot(b[0] - a[0], b[1] - a[1]), normal[3] = {0, 0, 0};
  stic_color lit;

  if (!(length > 0))
    return;
  normal[0] = (b[1] - a[1]) / length;
  normal[1] = (a[0] - b[0]) / length;
  lit = stic_mesh_lit(color, normal);
  for (int i = 0; i < STRIPS; i++) {
    double near = strip_z(v, i), far = strip_z(v, i + 1);

    stic_mesh_quad(mesh, (double[3]){a[0], a[1], near}, (double[3]){b[0], b[1], near},
                   (double[3]){b[0], b[1], far}, (double[3]){a[0], a[1], far}, fog(v, lit, near),
                   fog(v, lit, far));
  }
}

/* Clips the line p + t d to a convex counter-clockwise polygon; false if it misses. */
static bool clip_line(const stic_slab *slab, const double p[2], const double d[2], double *t0, double *t1)
{
  *t0 = -1e300;
  *t1 = 1e300;
  for (int i = 0; i < slab->count; i++) {
    const double *a = slab->points[i], *b = slab->points[(i + 1) % slab->count];
    double inward[2] = {a[1] - b[1], b[0] - a[0]};
    double at = (p[0] - a[0]) * inward[0] + (p[1] - a[1]) * inward[1];
    double slope = d[0] * inward[0] + d[1] * inward[1];

    if (fabs(slope) < 1e-15) {
      if (at < 0)
        return false;
    } else if (slope > 0) {
      *t0 = fmax(*t0, -at / slope);
    } else {
      *t1 = fmin(*t1, -at / slope);
    }
  }
  return *t0 < *t1;
}

/* Slanted strokes on the cut front: the mark of fixed ground in textbooks. */
static void hatch(const stic_view *v, stic_mesh *mesh, const stic_slab *slab)
{
  double step = 0.075 * v->size, z = v->z_front + 0.001 * v->size, low = 1e300, high = -1e300, first;
  const double d[2] = {0.70710678118654752, 0.70710678118654752};
  int count;

  for (int i = 0; i < slab->count; i++) {
    double along = slab->points[i][0] - slab->points[i][1];

    low = fmin(low, along);
    high = fmax(high, along);
  }
  count = stic_multiples(low, high, step, HATCH_MAX, &first);
  for (int i = 0; i < count; i++) {
    double p[2] = {(first + i) * step, 0}, t0, t1;

    if (clip_line(slab, p, d, &t0, &t1))
      stic_mesh_line(mesh, &v->camera, (double[3]){p[0] + t0 * d[0], p[1] + t0 * d[1], z},
                     (double[3]){p[0] + t1 * d[0], p[1] + t1 * d[1], z}, 1.1 * v->unit, v->theme->hatch,
                     v->theme->hatch);
  }
}

static void face_point(const stic_view *v, const stic_slab *slab, double c, double z, double lift,
                       double p[3])
{
  const stic_surface *s = &v->scene->surfaces[slab->surface];
  double n[2], d;

  stic_normal_from_degrees(s->normal_deg, n);
  p[0] = (c + slab->offset) * slab->axis[0];
  p[1] = (c + slab->offset) * slab->axis[1];
  d = (p[0] - s->point[0]) * n[0] + (p[1] - s->point[1]) * n[1];
  p[0] += (lift - d) * n[0];
  p[1] += (lift - d) * n[1];
  p[2] = z;
}

static void grid_line(const stic_view *v, stic_mesh *mesh, const double a[3], const double b[3], bool major)
{
  stic_color color = major ? v->theme->grid_major : v->theme->grid;

  stic_mesh_line(mesh, &v->camera, a, b, (major ? 1.3 : 0.8) * v->unit, fog(v, color, a[2]),
                 fog(v, color, b[2]));
}

static void grid_across(const stic_view *v, stic_mesh *mesh, const stic_slab *slab, double lift)
{
  double first;
  int count = stic_multiples(slab->face[0], slab->face[1], v->grid, GRID_MAX, &first);

  for (int i = 0; i < count; i++) {
    for (int k = 0; k < STRIPS; k++) {
      double a[3], b[3];

      face_point(v, slab, (first + i) * v->grid, strip_z(v, k), lift, a);
      face_point(v, slab, (first + i) * v->grid, strip_z(v, k + 1), lift, b);
      grid_line(v, mesh, a, b, fmod(first + i, v->grid_major) == 0);
    }
  }
}

static void grid_along(const stic_view *v, stic_mesh *mesh, const stic_slab *slab, double lift)
{
  double first;
  int count = stic_multiples(v->z_back, v->z_front, v->grid, GRID_MAX, &first);

  for (int i = 0; i < count; i++) {
    double a[3], b[3];

    face_point(v, slab, slab->face[0], (first + i) * v->grid, lift, a);
    face_point(v, slab, slab->face[1], (first + i) * v->grid, lift, b);
    grid_line(v, mesh, a, b, fmod(first + i, v->grid_major) == 0);
  }
}

/* The rim between surface and cut front, where contacts are read off. */
static void rim(const stic_view *v, stic_mesh *mesh, const stic_slab *slab)
{
  double a[3], b[3];

  face_point(v, slab, slab->face[0], v->z_front, 0.002 * v->size, a);
  face_point(v, slab, slab->face[1], v->z_front, 0.002 * v->size, b);
  stic_mesh_line(mesh, &v->camera, a, b, 1.8 * v->unit, v->theme->muted, v->theme->muted);
}

static void build_slab(const stic_view *v, stic_mesh *mesh, const stic_slab *slab)
{
  const stic_theme *t = v->theme;
  double n[2];

  stic_normal_from_degrees(v->scene->surfaces[slab->surface].normal_deg, n);
  stic_mesh_begin(mesh, STIC_DRAW_SOLID, STIC_ID_SURFACE + (unsigned)slab->surface);
  for (int i = 0; i < slab->count; i++) {
    const double *a = slab->points[i], *b = slab->points[(i + 1) % slab->count];
    double facing = (b[1] - a[1]) * n[0] + (a[0] - b[0]) * n[1];
    bool top = facing > 0.999 * hypot(b[0] - a[0], b[1] - a[1]);

    extrude_edge(v, mesh, a, b, top ? t->surface : t->section);
  }
  stic_mesh_polygon(mesh, (const double(*)[2])slab->points, slab->count, v->z_front, t->section);
  hatch(v, mesh, slab);
}

void stic_stage_build(const stic_view *v, stic_mesh *mesh)
{
  for (int i = 0; i < v->slab_count; i++)
    build_slab(v, mesh, &v->slabs[i]);
  for (int i = 0; i < v->slab_count; i++) {
    const stic_slab *slab = &v->slabs[i];

    if (!slab->has_face)
      continue;
    stic_mesh_begin(mesh, STIC_DRAW_SOLID, STIC_ID_SURFACE + (unsigned)slab->surface);
    grid_across(v, mesh, slab, 0.0008 * v->size);
    grid_along(v, mesh, slab, 0.0008 * v->size);
    rim(v, mesh, slab);
  }
}

void stic_stage_labels(const stic_view *v, stic_labels *labels)
{
  double step = v->grid * v->grid_major;
  int decimals = stic_decimals(step);

  for (int i = 0; i < v->slab_count; i++) {
    const stic_slab *slab = &v->slabs[i];
    double n[2], first;
    int count = slab->has_face ? stic_multiples(slab->face[0], slab->face[1], step, GRID_MAX, &first) : 0;

    stic_normal_from_degrees(v->scene->surfaces[slab->surface].normal_deg, n);
    for (int j = 0; j < count; j++) {
      double p[3], pixel[2], k = first + j;
      char text[32];

      face_point(v, slab, k * step, v->z_front, 0, p);
      stic_camera_project(&v->camera, p, pixel);
      /* In a corner two numbers would meet. */
      if (fmin(k * step - slab->face[0], slab->face[1] - k * step) < 0.4 * step)
        continue;
      if (pixel[0] < 0 || pixel[1] < 0 || pixel[0] > v->width || pixel[1] > v->height)
        continue;
      snprintf(text, sizeof text, "%.*f m", decimals, k == 0 ? 0.0 : k * step);
      /* Below level ground one line is left free for forces. */
      stic_labels_add_number(labels, pixel, -n[0], n[1], (3 + 23 * fabs(n[1])) * v->unit, v->theme->muted,
                             text);
    }
  }
}

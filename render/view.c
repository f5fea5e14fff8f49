#include "view.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Slabs are this thick, in object sizes. */
#define THICKNESS 0.25
#define FRONT_MARGIN 0.05
#define BACK_MARGIN 3.2
/* A surface farther than this from the object's start is shown only if the run goes there. */
#define NEAR_SIZES 3.0
/* The hand is kept in sight up to this far from the object. */
#define HAND_SIZES 2.0

static double dot2(const double a[2], const double b[2])
{
  return a[0] * b[0] + a[1] * b[1];
}

double stic_round_up_125(double value)
{
  double power = pow(10, floor(log10(value)));

  for (int i = 0; i < 4; i++) {
    static const double steps[4] = {1, 2, 5, 10};

    if (steps[i] * power >= value * (1 - 1e-9))
      return steps[i] * power;
  }
  return 10 * power;
}

int stic_decimals(double step)
{
  return (int)fmin(fmax(ceil(-log10(step) - 1e-9), 0), 9);
}

int stic_multiples(double low, double high, double step, int most, double *first)
{
  double count;

  *first = ceil(low / step - 1e-9);
  count = floor(high / step + 1e-9) - *first + 1;
  return count >= 1 ? (int)fmin(count, most) : 0;
}

void stic_force_text(double newton, char *out, size_t out_size)
{
  double size = fabs(newton);

  if (size > 0 && size < 0.0995)
    snprintf(out, out_size, "%.2g", newton);
  else
    snprintf(out, out_size, "%.*f", size < 9.995 ? 2 : size < 99.95 ? 1 : 0, newton);
}

void stic_labels_add(stic_labels *labels, const double at[2], double away_x, double away_y, double gap,
                     stic_color color, bool strong, const char *text)
{
  double length = hypot(away_x, away_y);
  stic_label *l;

  /* What is that far away is out of sight, and no int. */
  if (labels->count >= STIC_LABELS_MAX || !(length > 0) || !(fabs(at[0]) < 1e6 && fabs(at[1]) < 1e6))
    return;
  l = &labels->items[labels->count++];
  *l = (stic_label){.at = {at[0], at[1]},
                    .away = {away_x / length, away_y / length},
                    .gap = gap,
                    .color = color,
                    .strong = strong};
  strncpy(l->text, text, sizeof l->text - 1);
}

void stic_labels_add_number(stic_labels *labels, const double at[2], double away_x, double away_y, double gap,
                            stic_color color, const char *text)
{
  int count = labels->count;

  stic_labels_add(labels, at, away_x, away_y, gap, color, false, text);
  if (labels->count > count)
    labels->items[count].firm = true;
}

void stic_labels_keep_clear(stic_labels *labels, const double at[2])
{
  if (labels->sign_count >= STIC_LABELS_MAX)
    return;
  labels->signs[labels->sign_count][0] = at[0];
  labels->signs[labels->sign_count++][1] = at[1];
}

void stic_view_project(const stic_view *view, double x, double y, double z, double pixel[2])
{
  stic_camera_project(&view->camera, (double[3]){x, y, z}, pixel);
}

/* ---- what must be in sight ----------------------------------------------------------------- */

static void include(double low[3], double high[3], double x, double y, double z)
{
  double p[3] = {x, y, z};

  for (int k = 0; k < 3; k++) {
    low[k] = fmin(low[k], p[k]);
    high[k] = fmax(high[k], p[k]);
  }
}

static void include_object(double low[3], double high[3], const stic_scene *scene, double x, double y,
                           double z, double angle)
{
  double c = cos(angle), s = sin(angle);

  for (int i = 0; i < scene->vertex_count; i++) {
    const double *v = scene->vertices[i];

    include(low, high, x + c * v[0] - s * v[1], y + s * v[0] + c * v[1], z);
  }
}

/* The hand, unless it is so far away (a lost tracker) that showing it would make the object tiny. */
static void include_hand(double low[3], double high[3], const stic_result *r, double size)
{
  double dx = r->hand_x - r->x, dy = r->hand_y - r->y, reach = HAND_SIZES * size;

  include(low, high, r->x + fmin(fmax(dx, -reach), reach), r->y + fmin(fmax(dy, -reach), reach), r->z);
}

static void forget(double low[3], double high[3])
{
  for (int k = 0; k < 3; k++) {
    low[k] = 1e300;
    high[k] = -1e300;
  }
}

void stic_extent_init(stic_extent *e)
{
  memset(e, 0, sizeof *e);
  forget(e->low, e->high);
  for (int k = 0; k < 2; k++) {
    e->point_low[k] = 1e300;
    e->point_high[k] = -1e300;
  }
  e->angle[0] = 1e300;
  e->angle[1] = -1e300;
}

static double largest_force(const stic_result *r)
{
  double force = 0;

  for (int i = 0; i < r->contact_count; i++)
    force = fmax(force, fmax(r->contacts[i].normal, fabs(r->contacts[i].friction)));
  return force;
}

void stic_extent_add(stic_extent *e, const stic_scene *scene, const stic_result *r)
{
  include_object(e->low, e->high, scene, r->x, r->y, r->z, r->theta);
  include_hand(e->low, e->high, r, stic_scene_size(scene));
  if (r->contact_count) {
    e->point_low[0] = fmin(e->point_low[0], r->holding_x);
    e->point_low[1] = fmin(e->point_low[1], r->holding_y);
    e->point_high[0] = fmax(e->point_high[0], r->holding_x);
    e->point_high[1] = fmax(e->point_high[1], r->holding_y);
    e->angle[0] = fmin(e->angle[0], r->theta);
    e->angle[1] = fmax(e->angle[1], r->theta);
  }
  e->force = fmax(e->force, largest_force(r));
  for (int i = 0; i < r->contact_count; i++) {
    /* Room for the bars of the normal forces. */
    double n[2], length = STIC_FORCE_SIZES * stic_scene_size(scene);

    stic_normal_from_degrees(scene->surfaces[r->contacts[i].surface].normal_deg, n);
    include(e->low, e->high, r->contacts[i].x + length * n[0], r->contacts[i].y + length * n[1], r->z);
  }
}

/* Surfaces near the object's start, so that a picture before the first touch shows them too. */
static void include_surfaces(stic_view *v)
{
  double center[2] = {v->scene->x, v->scene->y};

  for (int i = 0; i < v->scene->surface_count; i++) {
    const stic_surface *s = &v->scene->surfaces[i];
    double n[2], d;

    stic_normal_from_degrees(s->normal_deg, n);
    d = (center[0] - s->point[0]) * n[0] + (center[1] - s->point[1]) * n[1];
    if (d < NEAR_SIZES * v->size)
      include(v->low, v->high, center[0] - d * n[0], center[1] - d * n[1], v->scene->z);
  }
}

static void first_bounds(stic_view *v, const stic_extent *extent)
{
  const stic_scene *s = v->scene;

  forget(v->low, v->high);
  if (extent && extent->low[0] <= extent->high[0]) {
    memcpy(v->low, extent->low, sizeof v->low);
    memcpy(v->high, extent->high, sizeof v->high);
    v->force_full = 1.05 * extent->force;
  } else {
    include_object(v->low, v->high, s, s->x, s->y, s->z, s->angle);
    for (int k = 0; k < 2; k++) {
      v->low[k] -= 0.5 * v->size;
      v->high[k] += 0.5 * v->size;
    }
  }
  include_surfaces(v);
  /* A guess that a moderate push of a tenth of the object's size makes. */
  if (!(v->force_full > 0))
    v->force_full = stic_round_up_125(0.1 * v->size * s->stiffness);
  v->force_length = STIC_FORCE_SIZES * v->size;
}

/* ---- slabs --------------------------------------------------------------------------------- */

/* Keeps the part of a convex polygon where (q - point) . normal >= -margin. */
static int clip(double points[][2], int count, const double point[2], const double normal[2], double margin)
{
  double kept[STIC_SLAB_CORNERS_MAX + 2][2];
  int n = 0;

  for (int i = 0; i < count; i++) {
    const double *a = points[i], *b = points[(i + 1) % count];
    double da = (a[0] - point[0]) * normal[0] + (a[1] - point[1]) * normal[1] + margin;
    double db = (b[0] - point[0]) * normal[0] + (b[1] - point[1]) * normal[1] + margin;

    if (da >= 0)
      memcpy(kept[n++], a, sizeof kept[0]);
    if ((da < 0) != (db < 0)) {
      kept[n][0] = a[0] + (b[0] - a[0]) * da / (da - db);
      kept[n][1] = a[1] + (b[1] - a[1]) * da / (da - db);
      n++;
    }
    if (n >= STIC_SLAB_CORNERS_MAX)
      break;
  }
  memcpy(points, kept, (size_t)n * sizeof kept[0]);
  return n;
}

/* Grid coordinates are world x or y where the surface is level or upright, else the distance from its point. */
static void set_axis(stic_slab *slab, const stic_surface *s, const double n[2])
{
  slab->axis[0] = fabs(n[1]);
  slab->axis[1] = fabs(n[0]);
  if (n[0] * n[1] > 0)
    slab->axis[1] = -slab->axis[1];
  slab->offset = n[0] != 0 && n[1] != 0 ? dot2(s->point, slab->axis) : 0;
}

/* The part of the surface that no other slab covers. */
static void find_face(const stic_view *v, stic_slab *slab, const stic_surface *s)
{
  double low = 1e300, high = -1e300;

  for (int i = 0; i < slab->count; i++) {
    double c = dot2(slab->points[i], slab->axis) - slab->offset;

    low = fmin(low, c);
    high = fmax(high, c);
  }
  for (int j = 0; j < v->scene->surface_count; j++) {
    const stic_surface *o = &v->scene->surfaces[j];
    double m[2], d, slope, base[2];

    if (j == slab->surface)
      continue;
    stic_normal_from_degrees(o->normal_deg, m);
    base[0] = s->point[0] - dot2(s->point, slab->axis) * slab->axis[0] + slab->offset * slab->axis[0];
    base[1] = s->point[1] - dot2(s->point, slab->axis) * slab->axis[1] + slab->offset * slab->axis[1];
    d = (base[0] - o->point[0]) * m[0] + (base[1] - o->point[1]) * m[1];
    slope = dot2(slab->axis, m);
    if (slope > 1e-9)
      low = fmax(low, -d / slope);
    else if (slope < -1e-9)
      high = fmin(high, -d / slope);
    else if (d < 0)
      high = -1e300;
  }
  slab->face[0] = low;
  slab->face[1] = high;
  slab->has_face = low < high;
}

static void make_slab(stic_view *v, int surface)
{
  const stic_surface *s = &v->scene->surfaces[surface];
  double w = 2.2 * fmax(v->high[0] - v->low[0], v->high[1] - v->low[1]) + 2 * v->size, n[2], back[2];
  double x0 = v->low[0] - w, x1 = v->high[0] + w, y0 = v->low[1] - w, y1 = v->high[1] + w;
  stic_slab *slab = &v->slabs[v->slab_count];
  double corners[4][2] = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};

  memset(slab, 0, sizeof *slab);
  slab->surface = surface;
  slab->count = 4;
  memcpy(slab->points, corners, sizeof corners);
  stic_normal_from_degrees(s->normal_deg, n);
  back[0] = -n[0];
  back[1] = -n[1];
  slab->count = clip(slab->points, slab->count, s->point, back, 0);
  for (int j = 0; j < v->scene->surface_count && slab->count >= 3; j++) {
    double m[2];

    stic_normal_from_degrees(v->scene->surfaces[j].normal_deg, m);
    slab->count = clip(slab->points, slab->count, v->scene->surfaces[j].point, m, THICKNESS * v->size);
  }
  if (slab->count < 3)
    return;
  set_axis(slab, s, n);
  find_face(v, slab, s);
  v->slab_count++;
}

/* ---- camera -------------------------------------------------------------------------------- */

/* The side from which no upright wall is in the way. */
static double open_side(const stic_scene *scene)
{
  double sum = 0;

  for (int i = 0; i < scene->surface_count; i++) {
    double n[2];

    stic_normal_from_degrees(scene->surfaces[i].normal_deg, n);
    if (fabs(n[0]) > 0.8)
      sum += n[0];
  }
  return sum < -0.5 ? -1 : 1;
}

static void place_camera(stic_view *v, const double low[3], const double high[3])
{
  double aside[2] = {0.42 * open_side(v->scene), 0.34};

  if (v->preset == STIC_CAMERA_FRONT) {
    aside[0] = 0;
    aside[1] = 0.16;
  }
  stic_camera_fit(&v->camera, aside, low, high, v->width, v->height, 0.03);
}

static void choose_grid(stic_view *v)
{
  double middle[3];

  for (int k = 0; k < 3; k++)
    middle[k] = (v->low[k] + v->high[k]) / 2;
  /* Numbers stand at every major line, this many px apart at 480 px height. */
  v->grid = stic_round_up_125(stic_camera_pixel_size(&v->camera, middle) * 65 * v->unit) / v->grid_major;
}

static void reframe(stic_view *v)
{
  double low[3], high[3], pad = 0.28 * v->size;

  memcpy(low, v->low, sizeof low);
  memcpy(high, v->high, sizeof high);
  low[0] -= pad;
  low[1] -= pad;
  high[0] += pad;
  high[1] += pad;
  low[2] -= v->scene->depth / 2;
  high[2] += v->scene->depth / 2;
  v->z_front = high[2] + FRONT_MARGIN * v->size;
  v->z_back = low[2] - BACK_MARGIN * v->size;
  place_camera(v, low, high);
  choose_grid(v);
  v->slab_count = 0;
  for (int i = 0; i < v->scene->surface_count; i++)
    make_slab(v, i);
}

bool stic_view_init(stic_view *v, const stic_scene *scene, const stic_render_settings *settings,
                    const stic_theme *theme, int width, int height)
{
  memset(v, 0, sizeof *v);
  v->scene = scene;
  v->theme = theme;
  v->preset = settings->camera;
  v->grid_major = 2;
  v->width = width;
  v->height = height;
  v->unit = fmin(settings->height, settings->width * 0.75) / 480.0;
  v->size = stic_scene_size(scene);
  v->slabs = calloc((size_t)scene->surface_count, sizeof *v->slabs);
  if (!v->slabs)
    return false;
  first_bounds(v, settings->extent);
  reframe(v);
  return true;
}

void stic_view_continue(stic_view *v, const stic_view *from)
{
  memcpy(v->low, from->low, sizeof v->low);
  memcpy(v->high, from->high, sizeof v->high);
  v->force_full = from->force_full;
  v->no_trails = from->no_trails;
  reframe(v);
}

double stic_view_face_z(const stic_view *v, const stic_result *r)
{
  return r->z + v->scene->depth / 2 + 0.01 * v->size;
}

double stic_view_hand_z(const stic_view *v, const stic_result *r)
{
  return stic_view_face_z(v, r) + 0.082 * v->size;
}

void stic_view_free(stic_view *v)
{
  free(v->slabs);
  v->slabs = NULL;
}

/* Near the object, as wide as a few of it. */
static void follow(stic_view *v, const stic_result *r)
{
  double reach = 1.1 * v->size;
  double low[3] = {r->x - 1.3 * reach, r->y - 0.9 * reach, r->z - v->scene->depth / 2};
  double high[3] = {r->x + 1.3 * reach, r->y + 0.8 * reach, r->z + v->scene->depth / 2};

  place_camera(v, low, high);
}

bool stic_view_include(stic_view *v, const stic_result *r)
{
  double low[3], high[3], force = largest_force(r);
  bool grown = false;

  if (force > v->force_full)
    v->force_full = stic_round_up_125(1.1 * force);
  forget(low, high);
  include_object(low, high, v->scene, r->x, r->y, r->z, r->theta);
  include_hand(low, high, r, v->size);
  for (int k = 0; k < 3; k++) {
    /* In steps, so that the camera does not creep. */
    double step = k < 2 ? 0.8 * v->size : 0.5 * v->size;

    if (low[k] < v->low[k]) {
      v->low[k] = low[k] - step;
      grown = true;
    }
    if (high[k] > v->high[k]) {
      v->high[k] = high[k] + step;
      grown = true;
    }
  }
  if (grown)
    reframe(v);
  if (v->preset == STIC_CAMERA_FOLLOW) {
    follow(v, r);
    return true;
  }
  return grown;
}

/* Scenes in memory: made, measured, and examined for what no solver can take (stiction.h, scene_keys.h). */
#include "angle.h"
#include "error.h"
#include "scene_keys.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define SIZE_MIN 1e-9 /* m */
#define SIZE_MAX_M 1e9
/* An object that begins this deep (relative to its size) is taken as touching. */
#define START_DEPTH 1e-12
/* A corner must stand out from the line through its neighbours by this part of the object's size. */
#define CORNER_MIN 1e-9

void stic_scene_init(stic_scene *scene)
{
  assert(scene);
  memset(scene, 0, sizeof *scene);
  scene->depth = 0.1;
  scene->hold = STIC_HOLD_START;
  scene->reach = 0.05;
}

void stic_scene_set_box(stic_scene *scene, double width, double height)
{
  const double x = width / 2, y = height / 2;
  const double corners[4][2] = {{-x, -y}, {x, -y}, {x, y}, {-x, y}};

  assert(scene);
  memset(scene->vertices, 0, sizeof scene->vertices);
  memcpy(scene->vertices, corners, sizeof corners);
  scene->vertex_count = 4;
}

double stic_scene_size(const stic_scene *scene)
{
  double largest = 0;

  assert(scene && scene->vertex_count <= STIC_VERTICES_MAX);
  for (int i = 0; i < scene->vertex_count; i++) {
    for (int j = 0; j < i; j++) {
      const double dx = scene->vertices[i][0] - scene->vertices[j][0];
      const double dy = scene->vertices[i][1] - scene->vertices[j][1];

      largest = fmax(largest, dx * dx + dy * dy);
    }
  }
  return sqrt(largest);
}

void stic_normal_from_degrees(double degrees, double normal[2])
{
  static const double quarter[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  /* fmod is exact, so whole turns and quarters cost no precision. */
  double turn = fmod(degrees, 360.0);

  if (turn < 0)
    turn += 360.0;
  if (fmod(turn, 90.0) == 0) {
    memcpy(normal, quarter[(int)(turn / 90.0) & 3], sizeof quarter[0]);
    return;
  }
  normal[0] = cos(turn / 180.0 * STIC_PI);
  normal[1] = sin(turn / 180.0 * STIC_PI);
}

/* ---- examination ------------------------------------------------------------------------- */

typedef struct examination {
  const stic_scene *scene;
  stic_scene_problem *problem;
  void *context;
} examination;

static void complain(const examination *e, stic_key key, int index, const char *format, ...)
  STIC_PRINTF(4, 5);

static void complain(const examination *e, stic_key key, int index, const char *format, ...)
{
  char message[400];
  va_list args;

  va_start(args, format);
  vsnprintf(message, sizeof message, format, args);
  va_end(args);
  e->problem(e->context, key, index, message);
}

static void examine_numbers(const examination *e, stic_key key, int surface)
{
  const stic_key_row *row = stic_key_get(key);
  /* Read only; the accessor serves the file reader too. */
  const double *numbers = stic_key_numbers(key, (stic_scene *)(uintptr_t)e->scene, surface);
  char path[96], expected[128];

  for (int i = 0; numbers && i < row->count; i++) {
    const double v = row->degrees ? numbers[i] / STIC_PI * 180.0 : numbers[i];

    if (v >= row->low && v <= row->high && !(row->above_low && v == row->low))
      continue;
    complain(e, key, surface, "%s is %g; expected %s", stic_key_path(key, surface, path, sizeof path), v,
             stic_key_expected(key, expected, sizeof expected));
    return;
  }
}

static void examine_name(const examination *e, stic_key key, int surface, const char *name)
{
  char path[96], expected[64];

  if (!memchr(name, '\0', STIC_NAME_MAX))
    complain(e, key, surface, "%s has no end; expected %s", stic_key_path(key, surface, path, sizeof path),
             stic_key_expected(key, expected, sizeof expected));
}

static double cross(const double a[2], const double b[2], const double c[2])
{
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static double doubled_area(const stic_scene *s)
{
  double area = 0;

  for (int i = 1; i + 1 < s->vertex_count; i++)
    area += cross(s->vertices[0], s->vertices[i], s->vertices[i + 1]);
  return area;
}

static bool vertices_are_numbers(const examination *e)
{
  const stic_key_row *row = stic_key_get(STIC_KEY_POLYGON);

  for (int i = 0; i < e->scene->vertex_count; i++) {
    const double *v = e->scene->vertices[i];

    if (!(fabs(v[0]) <= row->high && fabs(v[1]) <= row->high)) {
      complain(e, STIC_KEY_POLYGON, i, "vertex %d is (%g, %g); expected coordinates within +-%g m", i, v[0],
               v[1], row->high);
      return false;
    }
  }
  return true;
}

/* Every vertex must lie left of every edge: this also refuses stars, which turn left all along. */
static bool polygon_is_convex(const examination *e, double size)
{
  const stic_scene *s = e->scene;
  const int n = s->vertex_count;

  if (doubled_area(s) < 0) {
    complain(e, STIC_KEY_POLYGON, 0, "the polygon is clockwise; expected counter-clockwise order");
    return false;
  }
  for (int i = 0; i < n; i++) {
    const int next = (i + 1) % n;
    const double *a = s->vertices[i], *b = s->vertices[next];
    const double length = hypot(b[0] - a[0], b[1] - a[1]);

    if (length < CORNER_MIN * size) {
      complain(e, STIC_KEY_POLYGON, next, "vertex %d is the same as vertex %d; expected different ones", next,
               i);
      return false;
    }
    for (int k = 2; k < n; k++) {
      const int j = (i + k) % n;

      if (!(cross(a, b, s->vertices[j]) > CORNER_MIN * size * length)) {
        complain(e, STIC_KEY_POLYGON, k == 2 ? next : j,
                 "the polygon is not convex: vertex %d is not left of the edge from %d to %d; expected "
                 "convex, counter-clockwise",
                 j, i, next);
        return false;
      }
    }
  }
  return true;
}

static bool examine_polygon(const examination *e)
{
  const stic_scene *s = e->scene;
  double size;

  if (s->vertex_count < 3 || s->vertex_count > STIC_VERTICES_MAX) {
    complain(e, STIC_KEY_POLYGON, -1, "the polygon has %d vertices; expected 3 to %d", s->vertex_count,
             STIC_VERTICES_MAX);
    return false;
  }
  if (!vertices_are_numbers(e))
    return false;
  size = stic_scene_size(s);
  if (!(size >= SIZE_MIN && size <= SIZE_MAX_M)) {
    complain(e, STIC_KEY_POLYGON, -1, "the object is %g m large; expected %g to %g m", size, SIZE_MIN,
             SIZE_MAX_M);
    return false;
  }
  return polygon_is_convex(e, size);
}

static const char *surface_text(const stic_scene *s, int i, char *out, size_t out_size)
{
  if (s->surfaces[i].name[0])
    snprintf(out, out_size, "surface %d (%.*s)", i, STIC_NAME_MAX - 1, s->surfaces[i].name);
  else
    snprintf(out, out_size, "surface %d", i);
  return out;
}

static void examine_start(const examination *e, int surface)
{
  const stic_scene *s = e->scene;
  const stic_surface *plane = &s->surfaces[surface];
  const double c = cos(s->angle), si = sin(s->angle), size = stic_scene_size(s);
  double n[2], deepest = 0;
  int deepest_vertex = -1;
  char text[STIC_NAME_MAX + 32];

  stic_normal_from_degrees(plane->normal_deg, n);
  for (int i = 0; i < s->vertex_count; i++) {
    const double *v = s->vertices[i];
    const double x = s->x + c * v[0] - si * v[1], y = s->y + si * v[0] + c * v[1];
    const double gap = (x - plane->point[0]) * n[0] + (y - plane->point[1]) * n[1];
    /* Far from the origin the coordinates' own rounding is more than the rule's 1e-12. */
    const double largest = fmax(fmax(fabs(x), fabs(y)), fmax(fabs(plane->point[0]), fabs(plane->point[1])));
    const double allowed = START_DEPTH * size + 8 * DBL_EPSILON * largest;

    if (gap < -allowed && gap < deepest) {
      deepest = gap;
      deepest_vertex = i;
    }
  }
  if (deepest_vertex >= 0)
    complain(e, STIC_KEY_SURFACE, surface,
             "the object starts inside %s: vertex %d is %.6g m below it; expected it outside or touching",
             surface_text(s, surface, text, sizeof text), deepest_vertex, -deepest);
}

static void examine_surface(const examination *e, int surface)
{
  const stic_friction *f = &e->scene->surfaces[surface].friction;
  char text[STIC_NAME_MAX + 32];

  examine_name(e, STIC_KEY_SURFACE_NAME, surface, e->scene->surfaces[surface].name);
  for (stic_key key = STIC_KEY_SURFACE; key < STIC_KEY_COUNT; key++)
    examine_numbers(e, key, surface);
  if (f->mu_dynamic > f->mu_static)
    complain(e, STIC_KEY_SURFACE_DYNAMIC, surface,
             "dynamic friction %g of %s is above the static %g; expected static >= dynamic", f->mu_dynamic,
             surface_text(e->scene, surface, text, sizeof text), f->mu_static);
}

void stic_scene_examine(const stic_scene *scene, stic_scene_problem *problem, void *context)
{
  const examination e = {scene, problem, context};
  bool polygon_good;

  assert(scene && problem);
  examine_name(&e, STIC_KEY_NAME, -1, scene->name);
  polygon_good = examine_polygon(&e);
  for (stic_key key = STIC_KEY_ROOT; key < STIC_KEY_SURFACE; key++)
    examine_numbers(&e, key, -1);
  if (scene->hold != STIC_HOLD_START && scene->hold != STIC_HOLD_BUTTON)
    complain(&e, STIC_KEY_HOLD, -1, "hold is %d; expected start or button", (int)scene->hold);
  if (scene->surface_count < 1 || scene->surface_count > STIC_SURFACES_MAX) {
    complain(&e, STIC_KEY_SURFACES, -1, "there are %d surfaces; expected 1 to %d", scene->surface_count,
             STIC_SURFACES_MAX);
    return;
  }
  for (int i = 0; i < scene->surface_count; i++) {
    examine_surface(&e, i);
    if (polygon_good)
      examine_start(&e, i);
  }
}

typedef struct first_problem {
  stic_error *err;
  bool found;
} first_problem;

static void keep_first(void *context, stic_key key, int index, const char *message)
{
  first_problem *first = context;

  (void)key;
  (void)index;
  if (!first->found)
    stic_error_set(first->err, STIC_BAD_INPUT, NULL, 0, "%s", message);
  first->found = true;
}

stic_status stic_scene_validate(const stic_scene *scene, stic_error *err)
{
  first_problem first = {err, false};

  assert(scene);
  stic_scene_examine(scene, keep_first, &first);
  return first.found ? STIC_BAD_INPUT : STIC_OK;
}

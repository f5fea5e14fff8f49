#include "mesh.h"

#include "../src/angle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TUBE_SIDES 8
#define TUBE_POINTS_MAX 512

/* From above, a little from the right and from the viewer; unit length. */
static const double lamp[3] = {0.28, 0.80, 0.53};

static bool grow(void **items, int *capacity, int wanted, size_t size)
{
  int larger = *capacity ? *capacity : 256;
  void *moved;

  while (larger < wanted)
    larger *= 2;
  if (larger == *capacity)
    return true;
  moved = realloc(*items, (size_t)larger * size);
  if (!moved)
    return false;
  *items = moved;
  *capacity = larger;
  return true;
}

void stic_mesh_clear(stic_mesh *mesh)
{
  mesh->count = mesh->draw_count = 0;
  mesh->failed = false;
}

void stic_mesh_free(stic_mesh *mesh)
{
  free(mesh->vertices);
  free(mesh->draws);
  mesh->vertices = NULL;
  mesh->draws = NULL;
  mesh->count = mesh->capacity = mesh->draw_count = mesh->draw_capacity = 0;
}

void stic_mesh_begin(stic_mesh *mesh, stic_draw_kind kind, unsigned id)
{
  void *draws = mesh->draws;

  if (!grow(&draws, &mesh->draw_capacity, mesh->draw_count + 1, sizeof *mesh->draws)) {
    mesh->failed = true;
    return;
  }
  mesh->draws = draws;
  mesh->draws[mesh->draw_count++] = (stic_draw){kind, id, mesh->count, 0};
}

static void put(stic_mesh *mesh, const double p[3], stic_color c)
{
  stic_vertex *vertex = &mesh->vertices[mesh->count++];

  for (int k = 0; k < 3; k++)
    vertex->position[k] = (float)((p[k] - mesh->origin[k]) / mesh->scale);
  memcpy(vertex->rgba, (uint8_t[4]){c.r, c.g, c.b, c.a}, 4);
}

void stic_mesh_triangle(stic_mesh *mesh, const double a[3], const double b[3], const double c[3],
                        stic_color color_a, stic_color color_b, stic_color color_c)
{
  void *vertices = mesh->vertices;

  if (mesh->failed || !mesh->draw_count)
    return;
  if (!grow(&vertices, &mesh->capacity, mesh->count + 3, sizeof *mesh->vertices)) {
    mesh->failed = true;
    return;
  }
  mesh->vertices = vertices;
  put(mesh, a, color_a);
  put(mesh, b, color_b);
  put(mesh, c, color_c);
  mesh->draws[mesh->draw_count - 1].count += 3;
}

void stic_mesh_quad(stic_mesh *mesh, const double a[3], const double b[3], const double c[3],
                    const double d[3], stic_color color_ab, stic_color color_cd)
{
  stic_mesh_triangle(mesh, a, b, c, color_ab, color_ab, color_cd);
  stic_mesh_triangle(mesh, a, c, d, color_ab, color_cd, color_cd);
}

void stic_mesh_polygon(stic_mesh *mesh, const double (*points)[2], int count, double z, stic_color color)
{
  for (int i = 2; i < count; i++) {
    double a[3] = {points[0][0], points[0][1], z}, b[3] = {points[i - 1][0], points[i - 1][1], z},
           c[3] = {points[i][0], points[i][1], z};

    stic_mesh_triangle(mesh, a, b, c, color, color, color);
  }
}

static void cross(const double a[3], const double b[3], double out[3])
{
  double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];

  out[0] = x;
  out[1] = y;
  out[2] = z;
}

/* False if the vector has no direction. */
static bool normalise(double v[3])
{
  double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);

  if (!(length > 0))
    return false;
  for (int k = 0; k < 3; k++)
    v[k] /= length;
  return true;
}

void stic_mesh_line(stic_mesh *mesh, const stic_camera *camera, const double a[3], const double b[3],
                    double pixels, stic_color color_a, stic_color color_b)
{
  double along[3], view[3], side[3], half_a, half_b, corners[4][3];

  for (int k = 0; k < 3; k++) {
    along[k] = b[k] - a[k];
    view[k] = camera->eye[k] - a[k];
  }
  cross(along, view, side);
  if (!normalise(side))
    return;
  half_a = stic_camera_pixel_size(camera, a) * pixels / 2;
  half_b = stic_camera_pixel_size(camera, b) * pixels / 2;
  for (int k = 0; k < 3; k++) {
    corners[0][k] = a[k] - half_a * side[k];
    corners[1][k] = a[k] + half_a * side[k];
    corners[2][k] = b[k] + half_b * side[k];
    corners[3][k] = b[k] - half_b * side[k];
  }
  stic_mesh_quad(mesh, corners[0], corners[1], corners[2], corners[3], color_a, color_b);
}

/* Arrow outline grown by `rim` on all sides: shaft rectangle and head triangle. */
static void arrow_shape(stic_mesh *mesh, const double from[2], const double along[2], double length,
                        double width, double rim, double z, stic_color color)
{
  double head = fmin(2.2 * width, 0.6 * length), half = width / 2 * head / (2.2 * width), wing = head * 0.55;
  double across[2] = {-along[1], along[0]}, corner[7][2];
  double steps[7][2] = {{-rim, -half - rim},
                        {length - head, -half - rim},
                        {length - head, half + rim},
                        {-rim, half + rim},
                        {length - head - rim, -wing - 1.9 * rim},
                        {length + 2.1 * rim, 0},
                        {length - head - rim, wing + 1.9 * rim}};

  for (int i = 0; i < 7; i++) {
    for (int k = 0; k < 2; k++)
      corner[i][k] = from[k] + along[k] * steps[i][0] + across[k] * steps[i][1];
  }
  stic_mesh_polygon(mesh, (const double(*)[2])corner, 4, z, color);
  stic_mesh_polygon(mesh, (const double(*)[2])corner + 4, 3, z, color);
}

void stic_mesh_arrow(stic_mesh *mesh, const double from[2], const double to[2], double z, double width,
                     double rim, stic_color color, stic_color rim_color)
{
  double along[2] = {to[0] - from[0], to[1] - from[1]}, length = hypot(along[0], along[1]);

  if (!(length > 1e-3 * width))
    return;
  along[0] /= length;
  along[1] /= length;
  if (rim > 0)
    arrow_shape(mesh, from, along, length, width, rim, z, rim_color);
  arrow_shape(mesh, from, along, length, width, 0, z + rim * 0.05, color);
}

stic_color stic_mesh_lit(stic_color color, const double n[3])
{
  double light = 0.70 + 0.30 * fmax(n[0] * lamp[0] + n[1] * lamp[1] + n[2] * lamp[2], 0) / 0.85;

  light = fmin(light, 1.08);
  color.r = (uint8_t)fmin(color.r * light + 0.5, 255);
  color.g = (uint8_t)fmin(color.g * light + 0.5, 255);
  color.b = (uint8_t)fmin(color.b * light + 0.5, 255);
  return color;
}

typedef struct ring {
  double point[TUBE_SIDES][3];
  stic_color color[TUBE_SIDES];
} ring;

/* The cross section at `center`, at right angles to `along`, turned the same way for all. */
static void make_ring(const double center[3], double along[3], double radius, stic_color color, ring *out)
{
  double first[3], second[3], helper[3] = {0, 0, 1};

  if (!normalise(along))
    along[0] = 1;
  if (fabs(along[2]) > 0.9) {
    helper[1] = 1;
    helper[2] = 0;
  }
  cross(along, helper, first);
  normalise(first);
  cross(along, first, second);
  for (int i = 0; i < TUBE_SIDES; i++) {
    double c = cos(2 * STIC_PI * i / TUBE_SIDES), s = sin(2 * STIC_PI * i / TUBE_SIDES), n[3];

    for (int k = 0; k < 3; k++) {
      n[k] = c * first[k] + s * second[k];
      out->point[i][k] = center[k] + radius * n[k];
    }
    out->color[i] = stic_mesh_lit(color, n);
  }
}

void stic_mesh_tube(stic_mesh *mesh, const double (*points)[3], int count, double radius, stic_color color)
{
  ring rings[2];

  for (int i = 0; i < count && i < TUBE_POINTS_MAX; i++) {
    const double *before = points[i > 0 ? i - 1 : 0], *after = points[i + 1 < count ? i + 1 : i];
    double along[3] = {after[0] - before[0], after[1] - before[1], after[2] - before[2]};
    ring *now = &rings[i & 1], *last = &rings[~i & 1];

    make_ring(points[i], along, radius, color, now);
    for (int k = 0; i > 0 && k < TUBE_SIDES; k++) {
      int l = (k + 1) % TUBE_SIDES;

      stic_mesh_triangle(mesh, last->point[k], last->point[l], now->point[l], last->color[k], last->color[l],
                         now->color[l]);
      stic_mesh_triangle(mesh, last->point[k], now->point[l], now->point[k], last->color[k], now->color[l],
                         now->color[k]);
    }
  }
}

static void ball_point(const double center[3], double radius, int i, int j, int rows, int columns,
                       stic_color color, double p[3], stic_color *lit)
{
  double latitude = STIC_PI * i / rows - STIC_PI / 2, longitude = 2 * STIC_PI * j / columns;
  double n[3] = {cos(latitude) * cos(longitude), sin(latitude), cos(latitude) * sin(longitude)};

  for (int k = 0; k < 3; k++)
    p[k] = center[k] + radius * n[k];
  *lit = stic_mesh_lit(color, n);
}

void stic_mesh_ball(stic_mesh *mesh, const double center[3], double radius, stic_color color)
{
  enum { ROWS = 10, COLUMNS = 16 };

  for (int i = 0; i < ROWS; i++) {
    for (int j = 0; j < COLUMNS; j++) {
      double p[4][3];
      stic_color c[4];

      ball_point(center, radius, i, j, ROWS, COLUMNS, color, p[0], &c[0]);
      ball_point(center, radius, i, j + 1, ROWS, COLUMNS, color, p[1], &c[1]);
      ball_point(center, radius, i + 1, j + 1, ROWS, COLUMNS, color, p[2], &c[2]);
      ball_point(center, radius, i + 1, j, ROWS, COLUMNS, color, p[3], &c[3]);
      stic_mesh_triangle(mesh, p[0], p[1], p[2], c[0], c[1], c[2]);
      stic_mesh_triangle(mesh, p[0], p[2], p[3], c[0], c[2], c[3]);
    }
  }
}

void stic_mesh_disc(stic_mesh *mesh, double x, double y, double z, double radius, stic_color color)
{
  enum { CORNERS = 24 };
  double points[CORNERS][2];

  for (int i = 0; i < CORNERS; i++) {
    points[i][0] = x + radius * cos(2 * STIC_PI * i / CORNERS);
    points[i][1] = y + radius * sin(2 * STIC_PI * i / CORNERS);
  }
  stic_mesh_polygon(mesh, (const double(*)[2])points, CORNERS, z, color);
}

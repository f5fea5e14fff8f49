/* What moves. The world first, then a layer of signs in the plane of the object's front, which nothing
 * hides: as in a textbook's free-body diagram. */
#include "../src/angle.h"
#include "view.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define PRISM_MAX STIC_VERTICES_MAX
#define COIL_TURNS 6
#define COIL_STEPS 14

typedef struct pose {
  double c, s, x, y;
} pose;

/* One picture's worth of what the parts below share. */
typedef struct actors {
  const stic_view *view;
  const stic_theme *theme;
  const stic_history *history;
  const stic_result *now;
  stic_mesh *mesh;
  stic_labels *labels;
  double size; /* m, of the object */
  double z;    /* m, plane of signs */
  pose body;
  double outline[STIC_VERTICES_MAX][2]; /* m, the object's corners */
} actors;

static void place(const pose *p, const double v[2], double out[2])
{
  out[0] = p->x + p->c * v[0] - p->s * v[1];
  out[1] = p->y + p->s * v[0] + p->c * v[1];
}

/* Layers of signs lie a little in front of each other. */
static double layer(const actors *a, int i)
{
  return a->z + i * 0.004 * a->size;
}

/* ---- the object ---------------------------------------------------------------------------- */

/* Lines lie on faces: drawn a little nearer, so that they win. */
static void edge_line(const actors *a, const double from[2], double z0, const double to[2], double z1,
                      double pixels, stic_color color)
{
  const double *eye = a->view->camera.eye;
  double p[3] = {from[0], from[1], z0}, q[3] = {to[0], to[1], z1};

  for (int k = 0; k < 3; k++) {
    p[k] += 0.002 * (eye[k] - p[k]);
    q[k] += 0.002 * (eye[k] - q[k]);
  }
  stic_mesh_line(a->mesh, &a->view->camera, p, q, pixels, color, color);
}

/* True where the outline turns enough to show a crease. */
static bool is_crease(const actors *a, int i)
{
  int n = a->view->scene->vertex_count;
  const double *p = a->outline[(i + n - 1) % n], *q = a->outline[i], *r = a->outline[(i + 1) % n];
  double u[2] = {q[0] - p[0], q[1] - p[1]}, v[2] = {r[0] - q[0], r[1] - q[1]};

  return fabs(u[0] * v[1] - u[1] * v[0]) > 0.34 * hypot(u[0], u[1]) * hypot(v[0], v[1]);
}

static void draw_object(const actors *a)
{
  int n = a->view->scene->vertex_count;
  double z0 = a->now->z - a->view->scene->depth / 2, z1 = a->now->z + a->view->scene->depth / 2;
  double unit = a->view->unit;
  const stic_theme *t = a->theme;

  stic_mesh_begin(a->mesh, STIC_DRAW_SOLID, STIC_ID_OBJECT);
  for (int i = 0; i < n; i++) {
    const double *p = a->outline[i], *q = a->outline[(i + 1) % n];
    double length = hypot(q[0] - p[0], q[1] - p[1]);
    stic_color c = stic_mesh_lit(t->object, (double[3]){(q[1] - p[1]) / length, (p[0] - q[0]) / length, 0});

    stic_mesh_quad(a->mesh, (double[3]){p[0], p[1], z1}, (double[3]){q[0], q[1], z1},
                   (double[3]){q[0], q[1], z0}, (double[3]){p[0], p[1], z0}, c, c);
  }
  stic_mesh_polygon(a->mesh, (const double(*)[2])a->outline, n, z1,
                    stic_mesh_lit(t->object, (double[3]){0, 0, 1}));
  stic_mesh_polygon(a->mesh, (const double(*)[2])a->outline, n, z0,
                    stic_mesh_lit(t->object, (double[3]){0, 0, -1}));
  for (int i = 0; i < n; i++) {
    const double *p = a->outline[i], *q = a->outline[(i + 1) % n];

    edge_line(a, p, z1, q, z1, 2.2 * unit, t->outline);
    edge_line(a, p, z0, q, z0, 1.3 * unit, t->outline);
    if (is_crease(a, i))
      edge_line(a, p, z0, p, z1, 1.3 * unit, t->outline);
  }
}

/* ---- shadow -------------------------------------------------------------------------------- */

typedef struct shade_point {
  double c, z;   /* m on the surface: along its grid axis, and depth */
  double height; /* m over it */
} shade_point;

static int compare_shade(const void *a, const void *b)
{
  const shade_point *p = a, *q = b;

  if (p->c != q->c)
    return p->c < q->c ? -1 : 1;
  return (p->z > q->z) - (p->z < q->z);
}

static double turn_of(const shade_point *o, const shade_point *p, const shade_point *q)
{
  return (p->c - o->c) * (q->z - o->z) - (p->z - o->z) * (q->c - o->c);
}

/* Convex hull (Andrew), counter-clockwise in (c, z); points are sorted in place. */
static int hull_of(shade_point *points, int count, shade_point *hull)
{
  int n = 0;

  qsort(points, (size_t)count, sizeof *points, compare_shade);
  for (int pass = 0; pass < 2; pass++) {
    int floor_at = n + (pass ? 1 : 2);

    for (int k = 0; k < count; k++) {
      const shade_point *p = &points[pass ? count - 1 - k : k];

      if (pass && k == 0)
        continue;
      while (n >= floor_at && turn_of(&hull[n - 2], &hull[n - 1], p) <= 0)
        n--;
      hull[n++] = *p;
    }
  }
  return n - 1; /* the first point came back */
}

typedef struct shade {
  const actors *a;
  const stic_slab *slab;
  const stic_surface *surface;
  double normal[2];
} shade;

static void shade_vertex(const shade *s, double c, double z, double out[3])
{
  double limit = s->a->view->z_front, d;

  c = fmin(fmax(c, s->slab->face[0]), s->slab->face[1]) + s->slab->offset;
  out[0] = c * s->slab->axis[0];
  out[1] = c * s->slab->axis[1];
  d = (out[0] - s->surface->point[0]) * s->normal[0] + (out[1] - s->surface->point[1]) * s->normal[1];
  for (int k = 0; k < 2; k++)
    out[k] += (0.0016 * s->a->size - d) * s->normal[k];
  out[2] = fmin(z, limit);
}

/* Full inside, fading outwards over a margin that grows with the height of what throws it. */
static void shade_rings(const shade *s, const shade_point *hull, int n, double strength)
{
  enum { RINGS = 4 };
  static const double reach[RINGS] = {-1, -0.35, 0.35, 1}, opacity[RINGS] = {1, 0.74, 0.26, 0};
  double center[2] = {0, 0}, ring[RINGS][2 * PRISM_MAX + 1][3];
  stic_mesh *mesh = s->a->mesh;

  for (int i = 0; i < n; i++) {
    center[0] += hull[i].c / n;
    center[1] += hull[i].z / n;
  }
  for (int i = 0; i < n; i++) {
    double out[2] = {hull[i].c - center[0], hull[i].z - center[1]}, far = hypot(out[0], out[1]);
    double soft = 0.02 * s->a->size + 0.16 * hull[i].height;

    for (int r = 0; r < RINGS && far > 0; r++) {
      double move = fmax(reach[r] * soft, -0.7 * far) / far;

      shade_vertex(s, hull[i].c + out[0] * move, hull[i].z + out[1] * move, ring[r][i]);
    }
  }
  for (int i = 0; i < n; i++) {
    int k = (i + 1) % n;
    double middle[3];
    stic_color full = stic_color_fade(s->a->theme->shadow, strength);

    shade_vertex(s, center[0], center[1], middle);
    stic_mesh_triangle(mesh, middle, ring[0][i], ring[0][k], full, full, full);
    for (int r = 0; r + 1 < RINGS; r++)
      stic_mesh_quad(mesh, ring[r][i], ring[r][k], ring[r + 1][k], ring[r + 1][i],
                     stic_color_fade(full, strength * opacity[r]),
                     stic_color_fade(full, strength * opacity[r + 1]));
  }
}

/* The object's shadow on one surface, from a lamp above, a little to the right and in front. */
static void draw_shadow(const actors *a, const stic_slab *slab)
{
  static const double sun[3] = {0.16, 0.95, 0.27};
  shade s = {a, slab, &a->view->scene->surfaces[slab->surface], {0, 0}};
  shade_point points[2 * PRISM_MAX], hull[2 * PRISM_MAX + 1];
  int n = a->view->scene->vertex_count, count;
  double facing, nearest = 1e300;

  stic_normal_from_degrees(s.surface->normal_deg, s.normal);
  facing = s.normal[0] * sun[0] + s.normal[1] * sun[1];
  if (facing < 0.12)
    return;
  for (int i = 0; i < 2 * n; i++) {
    const double *p = a->outline[i % n];
    double d = (p[0] - s.surface->point[0]) * s.normal[0] + (p[1] - s.surface->point[1]) * s.normal[1];
    double q[2] = {p[0] - sun[0] * d / facing, p[1] - sun[1] * d / facing};

    points[i].c = q[0] * slab->axis[0] + q[1] * slab->axis[1] - slab->offset;
    points[i].z = a->now->z + (i < n ? -0.5 : 0.5) * a->view->scene->depth - sun[2] * d / facing;
    points[i].height = fmax(d, 0);
    nearest = fmin(nearest, points[i].height);
  }
  if (nearest > 6 * a->size)
    return;
  count = hull_of(points, 2 * n, hull);
  if (count < 3)
    return;
  stic_mesh_begin(a->mesh, STIC_DRAW_BLEND, STIC_ID_SHADOW);
  shade_rings(&s, hull, count, 0.42 * fmin(1, 1.6 * facing) / (1 + 0.25 * nearest / a->size));
}

/* ---- slip marks and trails ----------------------------------------------------------------- */

/* Skid marks on the surface, as deep as the object, each slip closed by a line where it began. */
static void draw_slips(const actors *a)
{
  double half = a->view->scene->depth / 2, lift = 0.0013 * a->size;

  stic_mesh_begin(a->mesh, STIC_DRAW_BLEND, STIC_ID_SLIP);
  for (int i = 0; i < a->history->slip_count; i++) {
    const stic_slip *s = stic_history_slip(a->history, i);
    double n[2], p[2], q[2], front = fmin(s->z + half + 0.16 * a->size, a->view->z_front);
    double young = (i + 1.0) / a->history->slip_count;
    stic_color fill = stic_color_fade(a->theme->friction, 0.08 + 0.14 * young);
    stic_color line = stic_color_fade(a->theme->friction, 0.15 + 0.75 * young);

    stic_normal_from_degrees(a->view->scene->surfaces[s->surface].normal_deg, n);
    for (int k = 0; k < 2; k++) {
      p[k] = s->from[k] + lift * n[k];
      q[k] = s->to[k] + lift * n[k];
    }
    stic_mesh_quad(a->mesh, (double[3]){p[0], p[1], front}, (double[3]){p[0], p[1], s->z - half},
                   (double[3]){q[0], q[1], s->z - half}, (double[3]){q[0], q[1], front}, fill, fill);
    stic_mesh_line(a->mesh, &a->view->camera, (double[3]){p[0], p[1], s->z - half},
                   (double[3]){p[0], p[1], front}, 1.4 * a->view->unit, line, line);
  }
}

static void trail(const actors *a, unsigned id, bool hand, stic_color color)
{
  double newest = (double)a->now->t_ns * 1e-9;

  stic_mesh_begin(a->mesh, STIC_DRAW_BLEND, id);
  for (int i = 1; i <= a->history->trail_count; i++) {
    const stic_trail_point *p = stic_history_trail(a->history, i - 1);
    const stic_trail_point *q = i < a->history->trail_count ? stic_history_trail(a->history, i) : NULL;
    const double *from = hand ? p->hand : p->held;
    double here[2] = {hand ? a->now->hand_x : a->now->holding_x, hand ? a->now->hand_y : a->now->holding_y};
    const double *to = q ? (hand ? q->hand : q->held) : here;
    double age = fmin((newest - p->t) / STIC_TRAIL_SECONDS, 1), young = 1 - age;

    stic_mesh_line(a->mesh, &a->view->camera, (double[3]){from[0], from[1], layer(a, 1)},
                   (double[3]){to[0], to[1], layer(a, 1)}, (1.2 + 2.2 * young) * a->view->unit,
                   stic_color_fade(color, 0.1 + 0.8 * young), stic_color_fade(color, 0.1 + 0.8 * young));
  }
}

/* ---- hand and spring ----------------------------------------------------------------------- */

/* Where the object would be if nothing held it back: dashed. */
static void draw_ghost(const actors *a)
{
  const stic_result *r = a->now;
  int n = a->view->scene->vertex_count;
  double offset[2] = {r->holding_x - r->x, r->holding_y - r->y}, turn = r->hand_theta - r->theta;
  pose ghost = {cos(r->hand_theta), sin(r->hand_theta), 0, 0};
  double corners[STIC_VERTICES_MAX][2], z = layer(a, 0);

  ghost.x = r->hand_x - (cos(turn) * offset[0] - sin(turn) * offset[1]);
  ghost.y = r->hand_y - (sin(turn) * offset[0] + cos(turn) * offset[1]);
  for (int i = 0; i < n; i++)
    place(&ghost, a->view->scene->vertices[i], corners[i]);
  stic_mesh_begin(a->mesh, STIC_DRAW_BLEND, STIC_ID_GHOST);
  stic_mesh_polygon(a->mesh, (const double(*)[2])corners, n, z, stic_color_fade(a->theme->hand, 0.10));
  for (int i = 0; i < n; i++) {
    const double *p = corners[i], *q = corners[(i + 1) % n];
    int dashes = (int)fmin(fmax(hypot(q[0] - p[0], q[1] - p[1]) / (0.055 * a->size), 1), 40);

    for (int k = 0; k < dashes; k++) {
      double t0 = (k + 0.2) / dashes, t1 = (k + 0.8) / dashes;

      stic_mesh_line(a->mesh, &a->view->camera,
                     (double[3]){p[0] + (q[0] - p[0]) * t0, p[1] + (q[1] - p[1]) * t0, z},
                     (double[3]){p[0] + (q[0] - p[0]) * t1, p[1] + (q[1] - p[1]) * t1, z},
                     1.8 * a->view->unit, a->theme->hand, a->theme->hand);
    }
  }
}

/* A coil from the holding point to the hand: longer, thicker and stronger in colour under load. */
static void draw_spring(const actors *a)
{
  const stic_result *r = a->now;
  double from[2] = {r->holding_x, r->holding_y}, d[2] = {r->hand_x - from[0], r->hand_y - from[1]};
  double length = hypot(d[0], d[1]), z = layer(a, 8) + 0.05 * a->size, points[COIL_TURNS * COIL_STEPS + 3][3];
  double load = fmin(hypot(r->force_x, r->force_y) / a->view->force_full, 1), radius, start, span;
  int n = 0;

  if (length < 0.004 * a->size)
    return;
  radius = fmin(0.042 * a->size, 0.35 * length);
  start = fmin(0.08 * a->size, 0.2 * length);
  span = length - 2 * start;
  for (int i = -1; i <= COIL_TURNS * COIL_STEPS + 1; i++, n++) {
    bool lead = i < 0 || i > COIL_TURNS * COIL_STEPS;
    double along = i < 0 ? 0 : lead ? length : start + span * i / (COIL_TURNS * COIL_STEPS);
    double angle = 2 * STIC_PI * i / COIL_STEPS, side = lead ? 0 : radius * sin(angle);

    points[n][0] = from[0] + (d[0] * along - d[1] * side) / length;
    points[n][1] = from[1] + (d[1] * along + d[0] * side) / length;
    points[n][2] = z + (lead ? 0 : radius * cos(angle));
  }
  stic_mesh_begin(a->mesh, STIC_DRAW_SOLID, STIC_ID_SPRING);
  stic_mesh_tube(a->mesh, (const double(*)[3])points, n,
                 fmin((0.006 + 0.006 * load) * a->size, 0.04 * length),
                 stic_color_mix(a->theme->slack, a->theme->spring, sqrt(load)));
}

/* The twist between object and hand: a wedge from the object's direction to the hand's. */
static void draw_twist(const actors *a)
{
  enum { STEPS = 24 };
  const stic_result *r = a->now;
  double from = r->theta, turn = fmin(fmax(r->hand_theta - r->theta, -2 * STIC_PI), 2 * STIC_PI),
         radius = 0.24 * a->size;
  double x = r->holding_x, y = r->holding_y, z = layer(a, 5), tip[2], unit = a->view->unit;
  stic_color fill = stic_color_fade(a->theme->spring, 0.30), line = a->theme->spring;

  if (fabs(turn) < 0.02)
    return;
  stic_mesh_begin(a->mesh, STIC_DRAW_BLEND, STIC_ID_TWIST);
  for (int i = 0; i < STEPS; i++) {
    double a0 = from + turn * i / STEPS, a1 = from + turn * (i + 1) / STEPS;
    double p[3] = {x + radius * cos(a0), y + radius * sin(a0), z},
           q[3] = {x + radius * cos(a1), y + radius * sin(a1), z};

    stic_mesh_triangle(a->mesh, (double[3]){x, y, z}, p, q, fill, fill, fill);
    stic_mesh_line(a->mesh, &a->view->camera, p, q, 2.4 * unit, line, line);
  }
  for (int i = 0; i < 2; i++) {
    double angle = from + i * turn;

    stic_mesh_line(a->mesh, &a->view->camera, (double[3]){x, y, z},
                   (double[3]){x + 1.25 * radius * cos(angle), y + 1.25 * radius * sin(angle), z}, 1.5 * unit,
                   line, line);
  }
  tip[0] = x + radius * cos(from + turn);
  tip[1] = y + radius * sin(from + turn);
  {
    double s = turn > 0 ? 1 : -1, h = fmin(0.05 * a->size, radius * fabs(turn));
    double along[2] = {-s * sin(from + turn), s * cos(from + turn)};
    double head[3][2] = {
      {tip[0], tip[1]},
      {tip[0] - h * along[0] - 0.5 * h * along[1], tip[1] - h * along[1] + 0.5 * h * along[0]},
      {tip[0] - h * along[0] + 0.5 * h * along[1], tip[1] - h * along[1] - 0.5 * h * along[0]}};

    stic_mesh_polygon(a->mesh, (const double(*)[2])head, 3, z, line);
  }
}

static void ring(const actors *a, unsigned id, double x, double y, int at, double radius, stic_color inside,
                 stic_color rim)
{
  stic_mesh_begin(a->mesh, STIC_DRAW_SOLID, id);
  stic_mesh_disc(a->mesh, x, y, layer(a, at), radius, rim);
  stic_mesh_disc(a->mesh, x, y, layer(a, at) + 0.001 * a->size, 0.62 * radius, inside);
}

static void draw_hand(const actors *a)
{
  const stic_result *r = a->now;
  double ball[3] = {r->hand_x, r->hand_y, stic_view_hand_z(a->view, r)}, arm = 0.15 * a->size, pixel[2];
  double tip[3] = {ball[0] + arm * cos(r->hand_theta), ball[1] + arm * sin(r->hand_theta), ball[2]};
  const double bar[2][3] = {{ball[0], ball[1], ball[2]}, {tip[0], tip[1], tip[2]}};

  stic_mesh_begin(a->mesh, STIC_DRAW_SOLID, STIC_ID_HAND);
  stic_mesh_ball(a->mesh, ball, 0.042 * a->size, a->theme->hand);
  stic_mesh_tube(a->mesh, bar, 2, 0.012 * a->size, a->theme->hand);
  stic_camera_project(&a->view->camera, ball, pixel);
  stic_labels_keep_clear(a->labels, pixel);
  stic_labels_add(a->labels, pixel, 0.2, 1, 11 * a->view->unit, a->theme->hand, true, "hand");
}

/* ---- contacts ------------------------------------------------------------------------------ */

typedef struct touch {
  const stic_contact *contact;
  const stic_friction *friction;
  double n[2], t[2]; /* normal and tangent */
  double used;       /* |T| / (mu_s N), 0 without a normal force */
  int index;
} touch;

static touch touch_of(const actors *a, int i)
{
  const stic_contact *c = &a->now->contacts[i];
  const stic_surface *s = &a->view->scene->surfaces[c->surface];
  touch k = {.contact = c, .friction = &s->friction, .index = i};
  double limit = s->friction.mu_static * c->normal;

  stic_normal_from_degrees(s->normal_deg, k.n);
  k.t[0] = k.n[1];
  k.t[1] = -k.n[0];
  k.used = limit > 0 ? fabs(c->friction) / limit : 0;
  return k;
}

static void cone_point(const touch *k, double slope, double length, double out[2])
{
  double norm = length / sqrt(1 + slope * slope);

  out[0] = k->contact->x + norm * (k->n[0] + slope * k->t[0]);
  out[1] = k->contact->y + norm * (k->n[1] + slope * k->t[1]);
}

static void cone_side(const actors *a, const touch *k, double slope, double length, double pixels,
                      stic_color color)
{
  double p[2];

  cone_point(k, slope, length, p);
  stic_mesh_line(a->mesh, &a->view->camera, (double[3]){k->contact->x, k->contact->y, layer(a, 3)},
                 (double[3]){p[0], p[1], layer(a, 3)}, pixels, color, color);
}

/* The static cone filled, the dynamic one thin inside it; the side that the force has reached is bold. */
static void draw_cone(const actors *a, const touch *k)
{
  double mu = k->friction->mu_static, length = 0.62 * a->size, corners[14][2], unit = a->view->unit;
  bool at_edge = k->used > 0.97;
  double reached = k->contact->friction > 0 ? 1 : -1;

  corners[0][0] = k->contact->x;
  corners[0][1] = k->contact->y;
  for (int i = 0; i <= 12; i++)
    cone_point(k, tan(atan(mu) * (i - 6) / 6), length, corners[i + 1]);
  stic_mesh_begin(a->mesh, STIC_DRAW_BLEND, STIC_ID_CONE);
  stic_mesh_polygon(a->mesh, (const double(*)[2])corners, 14, layer(a, 2),
                    stic_color_fade(a->theme->cone, at_edge ? 0.36 : 0.20));
  for (int s = -1; s <= 1; s += 2) {
    bool bold = at_edge && s == reached;

    cone_side(a, k, s * mu, length, (bold ? 4 : 1.5) * unit, bold ? a->theme->edge : a->theme->cone);
    cone_side(a, k, s * k->friction->mu_dynamic, 0.85 * length, 0.8 * unit, a->theme->cone);
  }
}

/* Beside the tip of a bar; `down` leans it into the surface, where nothing else is. */
static void force_label(const actors *a, const double tip[2], const double from[2], const double down[2],
                        const char *name, double value, stic_color color)
{
  double p[2], q[2], length;
  char text[40], force[24];

  stic_view_project(a->view, tip[0], tip[1], a->z, p);
  stic_view_project(a->view, from[0], from[1], a->z, q);
  stic_labels_keep_clear(a->labels, p);
  stic_labels_keep_clear(a->labels, q);
  if (hypot(p[0] - q[0], p[1] - q[1]) < 3 * a->view->unit)
    return;
  stic_force_text(value, force, sizeof force);
  snprintf(text, sizeof text, "%s %s N", name, force);
  length = hypot(p[0] - q[0], p[1] - q[1]);
  stic_labels_add(a->labels, p, (p[0] - q[0]) / length + down[0], (p[1] - q[1]) / length - down[1],
                  9 * a->view->unit, color, true, text);
}

static void draw_forces(const actors *a, const touch *k)
{
  double scale = a->view->force_length / a->view->force_full, width = 0.05 * a->size, rim = 0.008 * a->size;
  const stic_contact *c = k->contact;
  double at[2] = {c->x, c->y}, normal[2], friction[2], sum[2];
  unsigned i = (unsigned)k->index;

  for (int d = 0; d < 2; d++) {
    normal[d] = at[d] + scale * c->normal * k->n[d];
    friction[d] = at[d] + scale * c->friction * k->t[d];
    sum[d] = normal[d] + friction[d] - at[d];
  }
  stic_mesh_begin(a->mesh, STIC_DRAW_SOLID, STIC_ID_FRICTION + i);
  stic_mesh_arrow(a->mesh, at, friction, layer(a, 5), width, rim, a->theme->friction, a->theme->panel);
  stic_mesh_begin(a->mesh, STIC_DRAW_SOLID, STIC_ID_NORMAL + i);
  stic_mesh_arrow(a->mesh, at, normal, layer(a, 4), width, rim, a->theme->normal, a->theme->panel);
  stic_mesh_begin(a->mesh, STIC_DRAW_BLEND, STIC_ID_CONE);
  stic_mesh_arrow(a->mesh, at, sum, layer(a, 6), 0.016 * a->size, 0, a->theme->text, a->theme->text);
  force_label(a, normal, at, (double[2]){0, 0}, "normal", c->normal, a->theme->normal);
  force_label(a, friction, at, (double[2]){-1.2 * k->n[0], -1.2 * k->n[1]}, "friction", fabs(c->friction),
              a->theme->friction);
}

/* A dot where it sticks, a bright diamond where it slips. */
static void draw_contact(const actors *a, const touch *k)
{
  const stic_contact *c = k->contact;
  unsigned id = STIC_ID_CONTACT + (unsigned)k->index;
  double r = 0.036 * a->size;

  if (!stic_history_slipping(a->history, c->vertex, c->surface)) {
    ring(a, id, c->x, c->y, 14, r, a->theme->stick, a->theme->panel);
    return;
  }
  stic_mesh_begin(a->mesh, STIC_DRAW_SOLID, id);
  for (int i = 0; i < 2; i++) {
    double s = i ? 1.45 * r : 2.0 * r;
    double corners[4][2] = {{c->x - s, c->y}, {c->x, c->y - s}, {c->x + s, c->y}, {c->x, c->y + s}};

    stic_mesh_polygon(a->mesh, (const double(*)[2])corners, 4, layer(a, 14 + i),
                      i ? a->theme->slip : a->theme->stick);
  }
}

static void draw_contacts(const actors *a)
{
  for (int i = 0; i < a->now->contact_count; i++) {
    touch k = touch_of(a, i);

    draw_cone(a, &k);
  }
  for (int i = 0; i < a->now->contact_count; i++) {
    touch k = touch_of(a, i);

    draw_forces(a, &k);
    draw_contact(a, &k);
  }
}

void stic_actors_build(const stic_view *view, const stic_history *history, stic_mesh *mesh,
                       stic_labels *labels)
{
  const stic_result *r = &history->newest;
  actors a = {.view = view,
              .theme = view->theme,
              .history = history,
              .now = r,
              .mesh = mesh,
              .labels = labels,
              .size = view->size,
              .z = stic_view_face_z(view, r),
              .body = {cos(r->theta), sin(r->theta), r->x, r->y}};
  double holding[2];

  for (int i = 0; i < view->scene->vertex_count; i++)
    place(&a.body, view->scene->vertices[i], a.outline[i]);
  draw_slips(&a);
  for (int i = 0; i < view->slab_count; i++) {
    if (view->slabs[i].has_face)
      draw_shadow(&a, &view->slabs[i]);
  }
  draw_object(&a);
  stic_mesh_begin(mesh, STIC_DRAW_ON_TOP, STIC_ID_NONE);
  if (!view->no_trails) {
    trail(&a, STIC_ID_TRAIL_OBJECT, false, view->theme->outline);
    trail(&a, STIC_ID_TRAIL_HAND, true, view->theme->hand);
  }
  if (r->state != STIC_RELEASED) {
    if (r->contact_count)
      draw_ghost(&a);
    draw_contacts(&a);
    draw_twist(&a);
    draw_spring(&a);
    stic_camera_project(&view->camera, (double[3]){r->holding_x, r->holding_y, a.z}, holding);
    stic_labels_keep_clear(labels, holding);
    ring(&a, STIC_ID_HOLDING, r->holding_x, r->holding_y, 7, 0.034 * a.size, view->theme->panel,
         view->theme->outline);
  } else {
    draw_contacts(&a);
  }
  draw_hand(&a);
}

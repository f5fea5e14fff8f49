/* Random scenes and hand paths for tests and benches: boxes and polygons among floors, walls, slopes, corners and
 * slots, hands that press, drag, turn, jump and come back. The same seed gives the same case everywhere. */
#ifndef STIC_RANDOM_SCENE_H
#define STIC_RANDOM_SCENE_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "../stiction.h"

typedef struct rng {
  uint64_t state;
} rng;

static inline uint64_t rng_next(rng *r)
{ /* splitmix64 */
  uint64_t z = (r->state += UINT64_C(0x9E3779B97F4A7C15));
  z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
  z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
  return z ^ (z >> 31);
}
static inline double rng_unit(rng *r)
{
  return (double)(rng_next(r) >> 11) * 0x1p-53;
}
static inline double rng_range(rng *r, double a, double b)
{
  return a + (b - a) * rng_unit(r);
}
static inline int rng_below(rng *r, int n)
{
  return (int)(rng_next(r) % (uint64_t)n);
}

static inline void random_surface(stic_scene *s, double x, double y, double deg, double mu_s, double mu_d)
{
  stic_surface *f = &s->surfaces[s->surface_count++];
  memset(f, 0, sizeof *f);
  f->point[0] = x, f->point[1] = y, f->normal_deg = deg;
  f->friction.mu_static = mu_s, f->friction.mu_dynamic = mu_d;
}

/* Convex polygon with n vertices on an ellipse at jittered angles. */
static inline void random_polygon(stic_scene *s, rng *r, int n, double a, double b)
{
  s->vertex_count = n;
  double phase = rng_range(r, 0, 6.28);
  for (int i = 0; i < n; i++) {
    double t = phase + 2 * 3.14159265358979 * (i + rng_range(r, -0.3, 0.3)) / n;
    s->vertices[i][0] = a * cos(t), s->vertices[i][1] = b * sin(t);
  }
}

/* A case: scene, a start pose in the free region, and a hand that wanders near the surfaces. */
typedef struct random_case {
  stic_scene scene;
  double x, y, phi;  /* hand */
  double step, turn; /* size of its moves */
  int kind;
} random_case;

/* Moves the object out of every surface. */
static inline void random_free_start(stic_scene *s)
{
  for (int k = 0; k < 200; k++) {
    double worst = 1e9, n[2] = {0, 0};
    for (int i = 0; i < s->surface_count; i++) {
      double m[2];
      stic_normal_from_degrees(s->surfaces[i].normal_deg, m);
      for (int v = 0; v < s->vertex_count; v++) {
        double px = s->x + cos(s->angle) * s->vertices[v][0] - sin(s->angle) * s->vertices[v][1];
        double py = s->y + sin(s->angle) * s->vertices[v][0] + cos(s->angle) * s->vertices[v][1];
        double gap = (px - s->surfaces[i].point[0]) * m[0] + (py - s->surfaces[i].point[1]) * m[1];
        if (gap < worst)
          worst = gap, n[0] = m[0], n[1] = m[1];
      }
    }
    if (worst > 0.001)
      break;
    s->x += n[0] * 0.003, s->y += n[1] * 0.003, s->angle *= 0.97;
  }
}

static inline void random_case_init(random_case *c, uint64_t seed)
{
  rng r = {seed * UINT64_C(7919) + 12345};
  stic_scene *s = &c->scene;
  stic_scene_init(s);
  for (int i = 0; i < 3; i++)
    rng_next(&r);
  double w = rng_range(&r, 0.08, 0.2), h = rng_range(&r, 0.04, 0.15);
  if (rng_below(&r, 3))
    stic_scene_set_box(s, w, h);
  else
    random_polygon(s, &r, 3 + rng_below(&r, 5), w / 2, h / 2);
  s->stiffness = 200;
  s->rotational_stiffness = rng_below(&r, 8) ? pow(10, rng_range(&r, -1.5, 0.7)) : 0;
  s->holding_point[0] = rng_range(&r, -0.03, 0.03);
  s->holding_point[1] = rng_range(&r, -0.02, 0.02);
  if (!rng_below(&r, 4))
    s->holding_point[0] = s->holding_point[1] = 0;
  double mu_s = rng_range(&r, 0.1, 1.0), mu_d = mu_s * rng_range(&r, 0.3, 0.98);
  double mu_s2 = rng_range(&r, 0.1, 1.0), mu_d2 = mu_s2 * rng_range(&r, 0.3, 0.98);
  if (!rng_below(&r, 12))
    mu_d = mu_s;
  c->kind = rng_below(&r, 6);
  random_surface(s, 0, 0, 90, mu_s, mu_d);
  if (c->kind == 1 || c->kind == 2)
    random_surface(s, -0.1, 0, 0, mu_s2, mu_d2); /* floor and wall */
  if (c->kind == 3)
    random_surface(s, 0, 0, rng_range(&r, 20, 160), mu_s2, mu_d2); /* slopes */
  if (c->kind == 4)
    random_surface(s, 0, rng_range(&r, 1.05, 1.6) * hypot(w, h), 270, mu_s2, mu_d2); /* slot */
  if (c->kind == 5) {
    random_surface(s, -0.15, 0, 0, mu_s2, mu_d2);
    random_surface(s, 0.15, 0, rng_range(&r, 120, 180), mu_s2, mu_d2);
  }
  s->angle = rng_range(&r, -0.6, 0.6);
  s->x = 0;
  s->y = 0.12;
  random_free_start(s);
  c->x = s->x + cos(s->angle) * s->holding_point[0] - sin(s->angle) * s->holding_point[1];
  c->y = s->y + sin(s->angle) * s->holding_point[0] + cos(s->angle) * s->holding_point[1];
  c->phi = s->angle;
  c->step = pow(10, rng_range(&r, -2.7, -1.3));
  c->turn = pow(10, rng_range(&r, -2.5, -0.3));
}

/* A box that is turned between parallel walls until two opposite corners touch, and pulled along them. */
static inline void random_slot_init(random_case *c, uint64_t seed)
{
  rng r = {seed * UINT64_C(104729) + 7};
  stic_scene *s = &c->scene;
  stic_scene_init(s);
  double w = rng_range(&r, 0.1, 0.2), h = rng_range(&r, 0.03, 0.08), angle = rng_range(&r, 0.1, 0.5);
  double mu_s = rng_range(&r, 0.1, 0.6), mu_d = mu_s * rng_range(&r, 0.3, 0.95);
  double half = (w * sin(angle) + h * cos(angle)) / 2;
  stic_scene_set_box(s, w, h);
  s->stiffness = 200;
  s->rotational_stiffness = pow(10, rng_range(&r, -1, 0.7));
  random_surface(s, 0, -half, 90, mu_s, mu_d);
  random_surface(s, 0, half, 270, mu_s, mu_d);
  c->kind = 6;
  c->x = c->y = 0;
  c->phi = angle + rng_range(&r, 0.02, 0.3);
  c->step = pow(10, rng_range(&r, -2.7, -1.3));
  c->turn = pow(10, rng_range(&r, -2.5, -1));
}

/* A sliver stands on its tip, held below it, and is turned until its equilibrium vanishes and it snaps. */
static inline void random_snap_init(random_case *c, uint64_t seed)
{
  rng r = {seed * UINT64_C(130363) + 3};
  stic_scene *s = &c->scene;
  stic_scene_init(s);
  double e = rng_range(&r, 1.15, 3.5), fold = acos(-1 / e), a = rng_range(&r, 0.05, 0.09),
         d = rng_range(&r, 0.1, 0.14);
  double upright = 1.5707963267948966 - fold - 0.2,
         start = fold - 1.2; /* body angle of the sliver's middle */
  s->vertex_count = 3;
  for (int i = 1; i < 3; i++) {
    double at = upright + (i == 1 ? -0.01 : 0.01);
    s->vertices[i][0] = 0.1 * cos(at), s->vertices[i][1] = 0.1 * sin(at);
  }
  s->holding_point[1] = -a;
  s->stiffness = 200;
  s->rotational_stiffness = 200 * a * d / e;
  random_surface(s, 0, 0, 90, 100, rng_range(&r, 1, 90));
  s->angle = start;
  c->kind = 7;
  c->x = 0, c->y = -d;
  c->phi = start + e * sin(start);
  c->step = 0;
  c->turn = rng_range(&r, 0.1, 0.4);
}

/* One of these, by its number: mostly the random ones. */
static inline void random_any_init(random_case *c, uint64_t seed)
{
  if (seed % 20 == 19)
    random_slot_init(c, seed);
  else if (seed % 20 == 18)
    random_snap_init(c, seed);
  else
    random_case_init(c, seed);
}

/* The hand's next sample: a drift towards the surfaces and along them, with turns. */
static inline void random_case_move(random_case *c, rng *r)
{
  double pull = 0.12;
  if (c->kind == 7) {
    c->phi += c->turn * rng_unit(r);
    return;
  }
  c->x += c->step * (rng_range(r, -1, 1)) - 0.02 * c->x;
  c->y += c->step * (rng_range(r, -1, 1)) - pull * (c->y - 0.01);
  c->phi += c->turn * rng_range(r, -1, 1) - 0.05 * c->phi;
}

#endif

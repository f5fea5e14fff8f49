/* Scenes and hand paths that look for trouble: acute wedges, slots, many surfaces, up to 64 vertices, no, equal and
 * huge friction, no and huge rotational stiffness, far from the origin, very small and very large; hands that jump,
 * creep, stand still, come back, and stop exactly on an anchor or on a friction limit. A seed names a case. */
#ifndef STIC_WILD_H
#define STIC_WILD_H

#include "random_scene.h"

typedef struct wild_case {
  stic_scene scene;
  rng r;
  double size;      /* of the object */
  double x, y, phi; /* hand */
  unsigned buttons;
  int mode, left; /* what the hand is at, and for how many samples yet */
  double step, turn;
  double home[2]; /* between the surfaces */
} wild_case;

static inline void wild_friction(rng *r, double mu[2])
{
  switch (rng_below(r, 8)) {
  case 0: mu[0] = mu[1] = 0; break;
  case 1: mu[0] = mu[1] = rng_range(r, 0.05, 1.5); break;
  case 2: mu[0] = pow(10, rng_range(r, 0, 3)), mu[1] = mu[0] * rng_unit(r); break;
  case 3: mu[0] = rng_range(r, 0.1, 1), mu[1] = 0; break;
  case 4: mu[0] = rng_range(r, 0.1, 1), mu[1] = mu[0] * (1 - 1e-9); break;
  default: mu[0] = rng_range(r, 0.05, 1.2), mu[1] = mu[0] * rng_range(r, 0.2, 0.98);
  }
}

static inline void wild_surface(wild_case *c, double x, double y, double deg)
{
  double mu[2];
  wild_friction(&c->r, mu);
  random_surface(&c->scene, x, y, deg, mu[0], mu[1]);
}

/* Moves and turns the start until it is outside of every surface. */
static inline void wild_free_start(wild_case *c)
{
  stic_scene *s = &c->scene;
  for (int k = 0; k < 400; k++) {
    double worst = INFINITY, out[2] = {0, 0}, cosine = cos(s->angle), sine = sin(s->angle);
    for (int i = 0; i < s->surface_count; i++) {
      double n[2];
      stic_normal_from_degrees(s->surfaces[i].normal_deg, n);
      for (int v = 0; v < s->vertex_count; v++) {
        double x = s->x + cosine * s->vertices[v][0] - sine * s->vertices[v][1] - s->surfaces[i].point[0];
        double y = s->y + sine * s->vertices[v][0] + cosine * s->vertices[v][1] - s->surfaces[i].point[1];
        if (x * n[0] + y * n[1] < worst)
          worst = x * n[0] + y * n[1], out[0] = n[0], out[1] = n[1];
      }
    }
    if (worst > 1e-6 * c->size)
      return;
    s->x += out[0] * (1e-5 * c->size - worst), s->y += out[1] * (1e-5 * c->size - worst), s->angle *= 0.9;
  }
}

/* Scales a case and moves it as a whole. */
static inline void wild_place(wild_case *c, double scale, double dx, double dy)
{
  stic_scene *s = &c->scene;
  for (int i = 0; i < s->vertex_count; i++)
    s->vertices[i][0] *= scale, s->vertices[i][1] *= scale;
  for (int i = 0; i < s->surface_count; i++)
    s->surfaces[i].point[0] = s->surfaces[i].point[0] * scale + dx,
    s->surfaces[i].point[1] = s->surfaces[i].point[1] * scale + dy;
  s->x = s->x * scale + dx, s->y = s->y * scale + dy;
  s->holding_point[0] *= scale, s->holding_point[1] *= scale;
  s->rotational_stiffness *= scale * scale;
  s->reach *= scale;
  c->x = c->x * scale + dx, c->y = c->y * scale + dy;
  c->home[0] = c->home[0] * scale + dx, c->home[1] = c->home[1] * scale + dy;
  c->size *= scale;
}

/* A polygon, or a box, also a thin one; about `width` by `height`. */
static inline void wild_body(wild_case *c, double width, double height)
{
  stic_scene *s = &c->scene;
  switch (rng_below(&c->r, 5)) {
  case 0: random_polygon(s, &c->r, 3 + rng_below(&c->r, 6), width / 2, height / 2); break;
  case 1: random_polygon(s, &c->r, 9 + rng_below(&c->r, 56), width / 2, height / 2); break;
  case 2: stic_scene_set_box(s, width, width * 1e-3); break;
  default: stic_scene_set_box(s, width, height);
  }
  c->size = stic_scene_size(s);
}

/* How stiff, where and when it is held. */
static inline void wild_hold(wild_case *c, double width, double height)
{
  stic_scene *s = &c->scene;
  s->stiffness = rng_below(&c->r, 4) ? 200 : pow(10, rng_range(&c->r, -6, 6));
  switch (rng_below(&c->r, 6)) {
  case 0: s->rotational_stiffness = 0; break;
  case 1: s->rotational_stiffness = s->stiffness * pow(10, rng_range(&c->r, -9, 9)); break;
  default: s->rotational_stiffness = s->stiffness * pow(10, rng_range(&c->r, -4, -1.5));
  }
  switch (rng_below(&c->r, 4)) {
  case 0: s->holding_point[0] = s->holding_point[1] = 0; break;
  case 1: { /* on a vertex: no arm about it */
    const double *v = s->vertices[rng_below(&c->r, s->vertex_count)];
    s->holding_point[0] = v[0], s->holding_point[1] = v[1];
    break;
  }
  default:
    s->holding_point[0] = rng_range(&c->r, -width, width) * 0.6,
    s->holding_point[1] = rng_range(&c->r, -height, height) * 0.6;
  }
  s->hold = rng_below(&c->r, 3) ? STIC_HOLD_START : STIC_HOLD_BUTTON;
  s->angle = rng_below(&c->r, 3) ? rng_range(&c->r, -3, 3) : 0;
}

static inline void wild_room(wild_case *c, double width)
{
  stic_scene *s = &c->scene;
  s->x = 0, s->y = 0.6;
  c->home[0] = 0, c->home[1] = 0.05;
  switch (rng_below(&c->r, 9)) {
  case 0: wild_surface(c, 0, 0, 90); break;
  case 1: wild_surface(c, 0, 0, 90), wild_surface(c, -0.1, 0, 0); break;
  case 2: wild_surface(c, -0.1, 0, 0), wild_surface(c, 0, 0, 90), wild_surface(c, 0.15, 0, 180); break;
  case 3: { /* acute wedge, opening upwards */
    double half = pow(10, rng_range(&c->r, -1, 1.8));
    wild_surface(c, 0, 0, half), wild_surface(c, 0, 0, 180 - half);
    break;
  }
  case 4: { /* slot, wider than the object can turn */
    double gap = c->size * rng_range(&c->r, 1.001, 1.3);
    wild_surface(c, -gap / 2, 0, 0), wild_surface(c, gap / 2, 0, 180);
    break;
  }
  case 5: { /* slot with a floor, narrower than the object is long */
    double gap = rng_range(&c->r, 1.001, 1.1) * width;
    for (int i = 0; i < s->vertex_count; i++)
      gap = fmax(gap, 2.002 * fabs(s->vertices[i][0]));
    s->angle = 0;
    wild_surface(c, 0, 0, 90), wild_surface(c, -gap / 2, 0, 0), wild_surface(c, gap / 2, 0, 180);
    break;
  }
  case 6: { /* a bowl of many planes */
    int n = 5 + rng_below(&c->r, 60);
    for (int i = 0; i < n; i++) {
      double at = 3.14159265358979 * (1 + (i + rng_unit(&c->r)) / n), radius = rng_range(&c->r, 0.3, 0.32);
      wild_surface(c, radius * cos(at), 0.3 + radius * sin(at), at * 57.29577951308232 - 180);
    }
    break;
  }
  case 7: { /* slopes, one the other's neighbour by very little */
    double a = rng_range(&c->r, 20, 160);
    wild_surface(c, 0, 0, a), wild_surface(c, 0, 0, a + pow(10, rng_range(&c->r, -9, 1)));
    wild_surface(c, 0, -0.01, 90);
    break;
  }
  default: /* the same floor twice, and its copy a rounding below */
    wild_surface(c, 0, 0, 90), wild_surface(c, 1, 0, 90), wild_surface(c, 0, -1e-16, 90),
      wild_surface(c, -0.1, 0, 0);
  }
}

static inline void wild_init(wild_case *c, uint64_t seed)
{
  memset(c, 0, sizeof *c);
  rng r = {seed * UINT64_C(0x2545F4914F6CDD1D) + 99};
  c->r = r;
  stic_scene *s = &c->scene;
  stic_scene_init(s);
  double width = rng_range(&c->r, 0.05, 0.2), height = rng_range(&c->r, 0.02, 0.2);
  wild_body(c, width, height);
  wild_hold(c, width, height);
  wild_room(c, width);
  wild_free_start(c);
  double cosine = cos(s->angle), sine = sin(s->angle);
  c->x = s->x + cosine * s->holding_point[0] - sine * s->holding_point[1];
  c->y = s->y + sine * s->holding_point[0] + cosine * s->holding_point[1];
  c->phi = s->angle;
  c->buttons = STIC_BUTTON_GRIP;
  s->reach = 2 * c->size;
  if (!rng_below(&c->r, 5))
    wild_place(c, pow(10, rng_range(&c->r, -4, 4)), 0, 0);
  if (!rng_below(&c->r, 6)) {
    double far = c->size * pow(10, rng_range(&c->r, 0, 5));
    double dy = rng_range(&c->r, -far, far), dx = rng_range(&c->r, -far, far);
    wild_place(c, 1, dx, dy);
  }
}

/* The hand's next place, given what the last row said. */
static inline void wild_move(wild_case *c, const stic_result *last)
{
  rng *r = &c->r;
  if (c->left-- <= 0) {
    c->mode = rng_below(r, 10);
    c->left = 1 + rng_below(r, 12);
    c->step = c->size * pow(10, rng_range(r, -3, -0.3));
    c->turn = pow(10, rng_range(r, -3, -0.3));
  }
  double hx = c->x, hy = c->y, phi = c->phi;
  switch (c->mode) {
  case 0:
  case 1:
  case 2: /* wander, drawn home */
    hx += c->step * rng_range(r, -1, 1) - 0.1 * (hx - c->home[0]);
    hy += c->step * rng_range(r, -1, 1) - 0.1 * (hy - c->home[1]);
    phi += c->turn * rng_range(r, -1, 1);
    break;
  case 3: { /* jump, a little or very far */
    double far = c->size * pow(10, rng_range(r, -2, 3));
    hx = c->home[0] + far * rng_range(r, -1, 1), hy = c->home[1] + far * rng_range(r, -1, 1);
    phi += rng_range(r, -3, 3);
    break;
  }
  case 4: /* hardly move */
    hx += c->size * pow(10, rng_range(r, -18, -8)), phi += pow(10, rng_range(r, -18, -8));
    break;
  case 5: break; /* stand still */
  case 6:        /* onto an anchor */
    if (last->contact_count) {
      const stic_contact *k = &last->contacts[rng_below(r, last->contact_count)];
      hx = k->x, hy = k->y;
    }
    break;
  case 7: /* onto the friction limit of a contact, to the rounding */
    if (last->contact_count) {
      const stic_contact *k = &last->contacts[rng_below(r, last->contact_count)];
      const stic_surface *s = &c->scene.surfaces[k->surface];
      double n[2], depth = c->size * rng_range(r, 0.01, 0.3), side = rng_below(r, 2) ? 1 : -1;
      stic_normal_from_degrees(s->normal_deg, n);
      double along = fmin(side * s->friction.mu_static * depth, 10 * c->size);
      hx = last->holding_x - depth * n[0] + along * n[1], hy = last->holding_y - depth * n[1] - along * n[0];
    }
    break;
  case 8: /* back and forth */
    hx += (c->left & 1 ? 1 : -1) * c->step, hy += (c->left & 1 ? -0.3 : 0.3) * c->step;
    break;
  default: /* push into the surfaces */
    hy -= c->step * rng_unit(r), hx += 0.3 * c->step * rng_range(r, -1, 1),
      phi += c->turn * rng_range(r, -1, 1);
  }
  c->x = hx, c->y = hy, c->phi = phi;
  if (!rng_below(r, 25))
    c->buttons ^= STIC_BUTTON_GRIP;
}

/* The hand as the tracker would say it. */
static inline stic_sample wild_sample(const wild_case *c, int frame)
{
  stic_sample s = {
    (int64_t)frame * 32258065, {c->x, c->y, 0}, {0, 0, sin(c->phi / 2), cos(c->phi / 2)}, c->buttons, false};
  return s;
}

#endif

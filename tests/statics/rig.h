/* A simulation under test: a scene that is easy to write down, and a hand that goes from place to place. */
#ifndef STICTION_TESTS_RIG_H
#define STICTION_TESTS_RIG_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "angle.h"
#include "stiction.h"

typedef struct rig {
  stic_scene scene;
  stic_settings settings;
  stic_sim *sim;
  stic_result r;    /* of the last sample */
  double x, y, phi; /* hand at the last sample */
  int64_t t_ns;
} rig;

static inline void rig_init(rig *g, double k_p, double k_theta)
{
  memset(g, 0, sizeof *g);
  stic_scene_init(&g->scene);
  g->scene.stiffness = k_p;
  g->scene.rotational_stiffness = k_theta;
  stic_settings_init(&g->settings);
}

static inline void rig_surface(rig *g, double x, double y, double normal_deg, double mu_s, double mu_d)
{
  stic_surface *s = &g->scene.surfaces[g->scene.surface_count++];
  s->point[0] = x, s->point[1] = y, s->normal_deg = normal_deg;
  s->friction.mu_static = mu_s, s->friction.mu_dynamic = mu_d;
}

static inline void rig_vertex(rig *g, double x, double y)
{
  double *v = g->scene.vertices[g->scene.vertex_count++];
  v[0] = x, v[1] = y;
}

static inline void rig_pose(rig *g, double x, double y, double angle)
{
  g->scene.x = x, g->scene.y = y, g->scene.angle = angle;
}

static inline void rig_start(rig *g)
{
  stic_error err;
  if (stic_sim_create(&g->scene, &g->settings, &g->sim, &err) == STIC_OK)
    return;
  fprintf(stderr, "a test's own scene was refused: %s\n", err.message);
  exit(3);
}

static inline void rig_end(rig *g)
{
  stic_sim_destroy(g->sim);
  g->sim = NULL;
}

static inline void rig_step(rig *g, double x, double y, double phi, unsigned buttons, int64_t after_ns)
{
  g->t_ns += after_ns;
  stic_sample s = {g->t_ns, {x, y, 0}, {0, 0, sin(phi / 2), cos(phi / 2)}, buttons, false};
  stic_sim_step(g->sim, &s, &g->r);
  g->x = x, g->y = y, g->phi = phi;
}

/* One sample, a second after the last one: times of events then read as parts of the hand's way. */
static inline void rig_to(rig *g, double x, double y, double phi)
{
  rig_step(g, x, y, phi, 0, 1000000000);
}

/* In even samples along a straight line. */
static inline void rig_along(rig *g, double x, double y, double phi, int samples)
{
  double x0 = g->x, y0 = g->y, phi0 = g->phi;
  for (int i = 1; i <= samples; i++) {
    double s = (double)i / samples;
    rig_to(g, x0 + s * (x - x0), y0 + s * (y - y0), phi0 + s * (phi - phi0));
  }
}

/* The first event of a kind in the last sample, NULL if there was none. */
static inline const stic_event *rig_event(const rig *g, stic_event_kind kind)
{
  int count;
  const stic_event *e = stic_sim_events(g->sim, &count);
  for (int i = 0; i < count; i++)
    if (e[i].kind == kind)
      return &e[i];
  return NULL;
}

/* How far the hand was on its way from the sample before, at an event of the last sample. */
static inline double rig_part(const rig *g, const stic_event *e)
{
  return e->t - (double)g->t_ns * 1e-9 + 1;
}

/* Depth of the deepest vertex below any surface; below zero if none is. */
static inline double rig_depth(const rig *g)
{
  double deepest = -INFINITY, c = cos(g->r.theta), s = sin(g->r.theta);
  for (int i = 0; i < g->scene.surface_count; i++) {
    double n[2];
    stic_normal_from_degrees(g->scene.surfaces[i].normal_deg, n);
    for (int v = 0; v < g->scene.vertex_count; v++) {
      const double *b = g->scene.vertices[v], *p = g->scene.surfaces[i].point;
      double x = g->r.x + c * b[0] - s * b[1], y = g->r.y + s * b[0] + c * b[1];
      deepest = fmax(deepest, -((x - p[0]) * n[0] + (y - p[1]) * n[1]));
    }
  }
  return deepest;
}

#endif

#include "scenes.h"

#include <math.h>
#include <string.h>

#define STIFFNESS 200.0

void stic_test_scene(stic_scene *s, bool wall)
{
  static const double corners[4][2] = {{-0.08, -0.04}, {0.08, -0.04}, {0.08, 0.04}, {-0.08, 0.04}};

  memset(s, 0, sizeof *s);
  s->depth = 0.1;
  s->reach = 0.05;
  s->vertex_count = 4;
  memcpy(s->vertices, corners, sizeof corners);
  s->stiffness = STIFFNESS;
  s->rotational_stiffness = 0.5;
  s->x = 0.2;
  s->y = 0.1;
  s->surface_count = wall ? 2 : 1;
  s->surfaces[0].normal_deg = 90;
  s->surfaces[0].friction = s->surfaces[1].friction = (stic_friction){0.5, 0.3};
}

void stic_test_edge(stic_result *r, int64_t t_ns, double x, double share)
{
  memset(r, 0, sizeof *r);
  r->t_ns = t_ns;
  r->state = STIC_EDGE;
  r->x = r->holding_x = x;
  r->y = r->holding_y = 0.04;
  r->hand_y = 0.02;
  r->hand_theta = 0.04;
  r->force_y = -0.02 * STIFFNESS;
  r->force_x = share * 0.5 * r->force_y;
  r->hand_x = x + r->force_x / STIFFNESS;
  r->moment = 0.02;
  r->contact_count = 2;
  for (int i = 0; i < 2; i++)
    r->contacts[i] =
      (stic_contact){i, 0, x + (i ? 0.08 : -0.08), 0, i ? 1.5 : 2.5, share * 0.5 * (i ? 1.5 : 2.5)};
}

void stic_test_two_vertex(stic_result *r, int64_t t_ns, double angle)
{
  double c = cos(angle), s = sin(angle);
  double low[2] = {-0.08 * c + 0.04 * s, -0.08 * s - 0.04 * c},
         left[2] = {-0.08 * c - 0.04 * s, -0.08 * s + 0.04 * c};

  memset(r, 0, sizeof *r);
  r->t_ns = t_ns;
  r->state = STIC_TWO_VERTEX;
  r->theta = angle;
  r->x = r->holding_x = -left[0];
  r->y = r->holding_y = -low[1];
  r->hand_x = r->x - 0.02;
  r->hand_y = r->y - 0.015;
  r->hand_theta = angle + 0.3;
  r->force_x = -0.02 * STIFFNESS;
  r->force_y = -0.015 * STIFFNESS;
  r->moment = 0.15;
  r->slips = 3;
  r->contact_count = 2;
  r->contacts[0] = (stic_contact){0, 0, r->x + low[0], 0, 3.6, 1.7};
  r->contacts[1] = (stic_contact){3, 1, 0, r->y + left[1], 5.7, -0.6};
}

void stic_test_free(stic_result *r, int64_t t_ns, double x, double y, double angle)
{
  memset(r, 0, sizeof *r);
  r->t_ns = t_ns;
  r->state = STIC_FREE;
  r->x = r->hand_x = r->holding_x = x;
  r->y = r->hand_y = r->holding_y = y;
  r->theta = r->hand_theta = angle;
}

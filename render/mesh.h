/* What is drawn, as triangles with final colours: light and fog are worked out here, by the CPU, so that
 * one trivial shader draws everything. Pure: nothing here knows OpenGL. */
#ifndef STIC_MESH_H
#define STIC_MESH_H

#include <stdbool.h>
#include <stdint.h>

#include "camera.h"
#include "canvas.h"

typedef struct stic_vertex {
  float position[3]; /* in the mesh's own coordinates */
  uint8_t rgba[4];
} stic_vertex;

typedef enum stic_draw_kind {
  STIC_DRAW_SOLID, /* hides what is behind it */
  STIC_DRAW_BLEND, /* mixed by opacity, hidden by what is in front of it */
  STIC_DRAW_ON_TOP /* starts the layer of signs, which the world cannot hide; nothing is drawn */
} stic_draw_kind;

/* Who a triangle belongs to; written into the object-id buffer by solids. */
enum {
  STIC_ID_NONE,
  STIC_ID_OBJECT,
  STIC_ID_SPRING,
  STIC_ID_TWIST,
  STIC_ID_HAND,
  STIC_ID_HOLDING,
  STIC_ID_GHOST,
  STIC_ID_TRAIL_HAND,
  STIC_ID_TRAIL_OBJECT,
  STIC_ID_SHADOW,
  STIC_ID_SLIP,
  STIC_ID_CONE,
  STIC_ID_NORMAL = 100,   /* + index of the contact */
  STIC_ID_FRICTION = 200, /* + index of the contact */
  STIC_ID_CONTACT = 300,  /* + index of the contact */
  STIC_ID_SURFACE = 1000  /* + index of the surface */
};

typedef struct stic_draw {
  stic_draw_kind kind;
  unsigned id;      /* STIC_ID_ */
  int first, count; /* vertices, three a triangle */
} stic_draw;

/* A growing list of draws. Start with all zero but `scale`. */
typedef struct stic_mesh {
  double origin[3], scale; /* m; position v stands for the place origin + scale v */
  stic_vertex *vertices;   /* owned */
  int count, capacity;
  stic_draw *draws; /* owned */
  int draw_count, draw_capacity;
  bool failed; /* memory ran out: the list is incomplete */
} stic_mesh;

void stic_mesh_clear(stic_mesh *mesh); /* keeps the memory */
void stic_mesh_free(stic_mesh *mesh);

/* What follows belongs to `id` and is drawn as `kind`. */
void stic_mesh_begin(stic_mesh *mesh, stic_draw_kind kind, unsigned id);

/* A triangle with a colour at each corner. */
void stic_mesh_triangle(stic_mesh *mesh, const double a[3], const double b[3], const double c[3],
                        stic_color color_a, stic_color color_b, stic_color color_c);
/* A quadrilateral a, b, c, d in order around; a and b in the one colour, c and d in the other. */
void stic_mesh_quad(stic_mesh *mesh, const double a[3], const double b[3], const double c[3],
                    const double d[3], stic_color color_ab, stic_color color_cd);
/* A convex polygon in the plane z. */
void stic_mesh_polygon(stic_mesh *mesh, const double (*points)[2], int count, double z, stic_color color);
/* A stroke that is `pixels` wide on the screen, facing the camera, its ends coloured. */
void stic_mesh_line(stic_mesh *mesh, const stic_camera *camera, const double a[3], const double b[3],
                    double pixels, stic_color color_a, stic_color color_b);
/* A flat arrow in the plane z from `from` to `to`, shaft `width` m wide; its head shrinks with it when
 * the arrow is short. `rim` m of the rim's colour around it, 0 for none. */
void stic_mesh_arrow(stic_mesh *mesh, const double from[2], const double to[2], double z, double width,
                     double rim, stic_color color, stic_color rim_color);
/* A lit tube around a chain of points (at most 512). */
void stic_mesh_tube(stic_mesh *mesh, const double (*points)[3], int count, double radius, stic_color color);
/* A lit ball. */
void stic_mesh_ball(stic_mesh *mesh, const double center[3], double radius, stic_color color);
/* A flat disc in the plane z. */
void stic_mesh_disc(stic_mesh *mesh, double x, double y, double z, double radius, stic_color color);

/* The colour under the lamp for a unit normal. */
stic_color stic_mesh_lit(stic_color color, const double normal[3]);

#endif

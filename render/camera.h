/* A perspective camera with a shifted lens, as architects use: it looks straight at the x-y plane from a
 * place to the side and above. So the floor stays level, walls stay upright and lengths in that plane are
 * to scale, and yet the depth is seen. Pure arithmetic. */
#ifndef STIC_CAMERA_H
#define STIC_CAMERA_H

/* The camera looks against z, with x right and y up; pixels count from the upper left corner. */
typedef struct stic_camera {
  int width, height; /* px of the picture */
  double eye[3];     /* m */
  double focal;      /* px: something of 1 m at 1 m distance is this tall */
  double shift[2];   /* px, added to the projection: the shifted lens */
  double near, far;  /* m along the line of sight */
} stic_camera;

/* Moves a camera until the box fills the picture but for a margin (fraction of its size). The eye lies
 * aside[0] to the right and aside[1] above, per unit of its distance. */
void stic_camera_fit(stic_camera *camera, const double aside[2], const double low[3], const double high[3],
                     int width, int height, double margin);

/* Column-major matrix to clip coordinates from v, where origin + scale v is a place in the world: floats
 * are enough for such v wherever and however large the scene is. y points down in it, so that the rows of
 * the framebuffer come top down. */
void stic_camera_matrix(const stic_camera *camera, const double origin[3], double scale, float matrix[16]);

/* Where a point appears, px. The point must be in front of the camera. */
void stic_camera_project(const stic_camera *camera, const double point[3], double pixel[2]);

/* The other way round: the point (x, y) at depth z that appears at a pixel. */
void stic_camera_unproject(const stic_camera *camera, const double pixel[2], double z, double point[2]);

/* The size of a pixel at a point, m. */
double stic_camera_pixel_size(const stic_camera *camera, const double point[3]);

#endif

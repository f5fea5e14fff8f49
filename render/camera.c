#include "camera.h"

#include <math.h>
#include <string.h>

/* Long focal length: little perspective, so that depth does not distort. */
#define FOCAL_HEIGHTS 3.2

void stic_camera_project(const stic_camera *c, const double point[3], double pixel[2])
{
  double distance = c->eye[2] - point[2];

  pixel[0] = c->width / 2.0 + c->shift[0] + c->focal * (point[0] - c->eye[0]) / distance;
  pixel[1] = c->height / 2.0 + c->shift[1] - c->focal * (point[1] - c->eye[1]) / distance;
}

void stic_camera_unproject(const stic_camera *c, const double pixel[2], double z, double point[2])
{
  double size = (c->eye[2] - z) / c->focal;

  point[0] = c->eye[0] + size * (pixel[0] - c->width / 2.0 - c->shift[0]);
  point[1] = c->eye[1] - size * (pixel[1] - c->height / 2.0 - c->shift[1]);
}

double stic_camera_pixel_size(const stic_camera *c, const double point[3])
{
  return (c->eye[2] - point[2]) / c->focal;
}

/* The rectangle of pixels that holds the box. */
static void outline(const stic_camera *c, const double low[3], const double high[3], double min[2],
                    double max[2])
{
  for (int i = 0; i < 8; i++) {
    double p[3], pixel[2];

    for (int k = 0; k < 3; k++)
      p[k] = i >> k & 1 ? high[k] : low[k];
    stic_camera_project(c, p, pixel);
    for (int k = 0; k < 2; k++) {
      min[k] = i ? fmin(min[k], pixel[k]) : pixel[k];
      max[k] = i ? fmax(max[k], pixel[k]) : pixel[k];
    }
  }
}

void stic_camera_fit(stic_camera *c, const double aside[2], const double low[3], const double high[3],
                     int width, int height, double margin)
{
  double target[3] = {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, high[2]}, min[2] = {0, 0},
         max[2] = {0, 0};
  double distance = 10 * (high[0] - low[0] + high[1] - low[1] + high[2] - low[2]);

  memset(c, 0, sizeof *c);
  c->width = width;
  c->height = height;
  c->focal = FOCAL_HEIGHTS * (width < height ? width : height);
  for (int i = 0; i < 24; i++) {
    double wide, tall;

    c->eye[0] = target[0] + distance * aside[0];
    c->eye[1] = target[1] + distance * aside[1];
    c->eye[2] = target[2] + distance;
    outline(c, low, high, min, max);
    wide = (max[0] - min[0]) / (width * (1 - 2 * margin));
    tall = (max[1] - min[1]) / (height * (1 - 2 * margin));
    distance *= fmax(wide, tall);
  }
  c->shift[0] = width / 2.0 - (min[0] + max[0]) / 2;
  c->shift[1] = height / 2.0 - (min[1] + max[1]) / 2;
  c->near = 0.3 * distance;
  c->far = 3 * (distance + high[2] - low[2]);
}

void stic_camera_matrix(const stic_camera *c, const double origin[3], double scale, float m[16])
{
  double sx = 2 * c->focal / c->width, sy = -2 * c->focal / c->height;
  double hx = 2 * c->shift[0] / c->width, hy = 2 * c->shift[1] / c->height;
  double near = c->near / scale, far = c->far / scale;
  double a = (far + near) / (far - near), b = -2 * far * near / (far - near), eye[3];

  for (int k = 0; k < 3; k++)
    eye[k] = (c->eye[k] - origin[k]) / scale;

  memset(m, 0, 16 * sizeof *m);
  m[0] = (float)sx;
  m[5] = (float)sy;
  m[8] = (float)-hx;
  m[9] = (float)-hy;
  m[10] = (float)-a;
  m[11] = -1;
  m[12] = (float)(hx * eye[2] - sx * eye[0]);
  m[13] = (float)(hy * eye[2] - sy * eye[1]);
  m[14] = (float)(a * eye[2] + b);
  m[15] = (float)eye[2];
}

#include "canvas.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

static int min_int(int a, int b)
{
  return a < b ? a : b;
}

static int max_int(int a, int b)
{
  return a > b ? a : b;
}

bool stic_rect_empty(stic_rect r)
{
  return r.x0 >= r.x1 || r.y0 >= r.y1;
}

stic_rect stic_rect_union(stic_rect a, stic_rect b)
{
  if (stic_rect_empty(a))
    return b;
  if (stic_rect_empty(b))
    return a;
  return (stic_rect){min_int(a.x0, b.x0), min_int(a.y0, b.y0), max_int(a.x1, b.x1), max_int(a.y1, b.y1)};
}

stic_rect stic_rect_intersect(stic_rect a, stic_rect b)
{
  return (stic_rect){max_int(a.x0, b.x0), max_int(a.y0, b.y0), min_int(a.x1, b.x1), min_int(a.y1, b.y1)};
}

stic_color stic_color_fade(stic_color color, double opacity)
{
  color.a = (uint8_t)(255 * opacity + 0.5);
  return color;
}

static uint8_t mix_byte(uint8_t a, uint8_t b, double t)
{
  return (uint8_t)(a + (b - a) * t + 0.5);
}

stic_color stic_color_mix(stic_color a, stic_color b, double t)
{
  return (stic_color){mix_byte(a.r, b.r, t), mix_byte(a.g, b.g, t), mix_byte(a.b, b.b, t),
                      mix_byte(a.a, b.a, t)};
}

void stic_pixel_blend(uint8_t *pixel, stic_color c, int coverage)
{
  /* 0..256, so that a shift divides. */
  int a = (c.a * coverage * 257 + 32768) >> 16, rest;

  a += a >> 7;
  rest = 256 - a;
  pixel[0] = (uint8_t)((pixel[0] * rest + c.r * a) >> 8);
  pixel[1] = (uint8_t)((pixel[1] * rest + c.g * a) >> 8);
  pixel[2] = (uint8_t)((pixel[2] * rest + c.b * a) >> 8);
}

static uint8_t *pixel_at(const stic_canvas *canvas, int x, int y)
{
  return canvas->pixels + ((size_t)y * (size_t)canvas->width + (size_t)x) * 4;
}

void stic_canvas_fill(const stic_canvas *canvas, stic_rect area, stic_color color)
{
  stic_rect r = stic_rect_intersect(area, canvas->clip);

  for (int y = r.y0; y < r.y1; y++) {
    uint8_t *pixel = pixel_at(canvas, r.x0, y);

    for (int x = r.x0; x < r.x1; x++, pixel += 4) {
      if (color.a == 255)
        memcpy(pixel, &color, 4);
      else
        stic_pixel_blend(pixel, color, 255);
    }
  }
}

void stic_canvas_frame(const stic_canvas *canvas, stic_rect area, int thickness, stic_color color)
{
  stic_rect r = area;

  stic_canvas_fill(canvas, (stic_rect){r.x0, r.y0, r.x1, r.y0 + thickness}, color);
  stic_canvas_fill(canvas, (stic_rect){r.x0, r.y1 - thickness, r.x1, r.y1}, color);
  stic_canvas_fill(canvas, (stic_rect){r.x0, r.y0 + thickness, r.x0 + thickness, r.y1 - thickness}, color);
  stic_canvas_fill(canvas, (stic_rect){r.x1 - thickness, r.y0 + thickness, r.x1, r.y1 - thickness}, color);
}

/* The pixels that a shape within [x0, x1] x [y0, y1] can touch. */
static stic_rect touched(const stic_canvas *canvas, double x0, double y0, double x1, double y1)
{
  double far = 1e6; /* keeps the conversions to int defined */

  return stic_rect_intersect(canvas->clip,
                             (stic_rect){(int)floor(fmax(x0, -far)) - 1, (int)floor(fmax(y0, -far)) - 1,
                                         (int)ceil(fmin(x1, far)) + 1, (int)ceil(fmin(y1, far)) + 1});
}

/* Narrows a row of pixels to those near the line through (x0, y0) along (dx, dy), `reach` px to either side. */
static void narrow(double dx, double dy, double length, double reach, double x0, double row, int *from,
                   int *to)
{
  double middle, side;

  if (fabs(dy) <= 1e-6 * length)
    return;
  middle = x0 + row * dx / dy;
  side = fabs(reach * length / dy);
  /* Compared as doubles: far outside the picture they are no ints. */
  if (middle - side > *from)
    *from = middle - side < *to ? (int)(middle - side) : *to;
  if (middle + side + 1 < *to)
    *to = middle + side + 1 > *from ? (int)(middle + side + 1) : *from;
}

/* Coverage of a pixel whose centre is `distance` px outside the border (negative: inside). */
static int coverage_at(double distance)
{
  double c = 0.5 - distance;

  return c <= 0 ? 0 : c >= 1 ? 255 : (int)(c * 255 + 0.5);
}

void stic_canvas_line(const stic_canvas *canvas, double x0, double y0, double x1, double y1, double width,
                      stic_color color)
{
  double half = width / 2, dx = x1 - x0, dy = y1 - y0, length2 = dx * dx + dy * dy;
  stic_rect r =
    touched(canvas, fmin(x0, x1) - half, fmin(y0, y1) - half, fmax(x0, x1) + half, fmax(y0, y1) + half);

  for (int y = r.y0; y < r.y1; y++) {
    int from = r.x0, to = r.x1;

    narrow(dx, dy, sqrt(length2), half + 1, x0, y + 0.5 - y0, &from, &to);
    for (int x = from; x < to; x++) {
      double px = x + 0.5 - x0, py = y + 0.5 - y0;
      double t = length2 > 0 ? fmin(fmax((px * dx + py * dy) / length2, 0), 1) : 0;
      double ex = px - t * dx, ey = py - t * dy;
      int cover = coverage_at(sqrt(ex * ex + ey * ey) - half);

      if (cover > 0)
        stic_pixel_blend(pixel_at(canvas, x, y), color, cover);
    }
  }
}

void stic_canvas_dashes(const stic_canvas *canvas, double x0, double y0, double x1, double y1, double width,
                        double dash, stic_color color)
{
  double length = hypot(x1 - x0, y1 - y0);

  for (double at = 0; at < length; at += 2 * dash) {
    double a = at / length, b = fmin(at + dash, length) / length;

    stic_canvas_line(canvas, x0 + (x1 - x0) * a, y0 + (y1 - y0) * a, x0 + (x1 - x0) * b, y0 + (y1 - y0) * b,
                     width, color);
  }
}

void stic_canvas_disc(const stic_canvas *canvas, double x, double y, double radius, stic_color color)
{
  stic_canvas_line(canvas, x, y, x, y, 2 * radius, color);
}

void stic_canvas_diamond(const stic_canvas *canvas, double x, double y, double radius, stic_color color)
{
  stic_rect r = touched(canvas, x - radius, y - radius, x + radius, y + radius);

  for (int py = r.y0; py < r.y1; py++) {
    for (int px = r.x0; px < r.x1; px++) {
      double distance = (fabs(px + 0.5 - x) + fabs(py + 0.5 - y) - radius) * 0.70710678118654752;
      int cover = coverage_at(distance);

      if (cover > 0)
        stic_pixel_blend(pixel_at(canvas, px, py), color, cover);
    }
  }
}

/* Drawing into a picture in memory by the CPU: rectangles, antialiased lines and discs, text. The head-up
 * display and all labels are made with it, so they are the same on every machine. Coordinates are in
 * pixels from the upper left corner, x right, y down; pixel (0, 0) covers 0..1. Nothing is drawn
 * outside the clip. Real-time: yes, but for stic_font_create(). */
#ifndef STIC_CANVAS_H
#define STIC_CANVAS_H

#include <stdbool.h>
#include <stdint.h>

typedef struct stic_color {
  uint8_t r, g, b;
  uint8_t a; /* 255 is opaque */
} stic_color;

/* x0 <= x < x1, y0 <= y < y1; empty unless x0 < x1 and y0 < y1. */
typedef struct stic_rect {
  int x0, y0, x1, y1;
} stic_rect;

typedef struct stic_canvas {
  uint8_t *pixels;   /* R, G, B, 255 per pixel, rows top down without gaps; not owned */
  int width, height; /* px */
  stic_rect clip;    /* inside the picture */
} stic_canvas;

bool stic_rect_empty(stic_rect r);
stic_rect stic_rect_union(stic_rect a,
                          stic_rect b); /* the smallest that holds both; empty ones count for nothing */
stic_rect stic_rect_intersect(stic_rect a, stic_rect b);

/* The colour with its opacity replaced, 0..1. */
stic_color stic_color_fade(stic_color color, double opacity);
/* a at t = 0, b at t = 1; opacity included. */
stic_color stic_color_mix(stic_color a, stic_color b, double t);

/* Blends one pixel (R, G, B, ...) with the colour; coverage 0..255. */
void stic_pixel_blend(uint8_t *pixel, stic_color color, int coverage);

void stic_canvas_fill(const stic_canvas *canvas, stic_rect area, stic_color color);
/* A frame of the given thickness (px) inside the area's border. */
void stic_canvas_frame(const stic_canvas *canvas, stic_rect area, int thickness, stic_color color);
/* A straight stroke with round ends; width in px. */
void stic_canvas_line(const stic_canvas *canvas, double x0, double y0, double x1, double y1, double width,
                      stic_color color);
/* Dashes of `dash` px with equal gaps. */
void stic_canvas_dashes(const stic_canvas *canvas, double x0, double y0, double x1, double y1, double width,
                        double dash, stic_color color);
void stic_canvas_disc(const stic_canvas *canvas, double x, double y, double radius, stic_color color);
/* A square on its corner. */
void stic_canvas_diamond(const stic_canvas *canvas, double x, double y, double radius, stic_color color);

/* One typeface in one size. Opaque. */
typedef struct stic_font stic_font;

/* Bakes an embedded typeface, `pixels` tall (6..200); NULL without memory. The caller owns it. */
stic_font *stic_font_create(bool bold, double pixels);
void stic_font_destroy(stic_font *font); /* NULL allowed */

int stic_font_height(const stic_font *font);                  /* px from one line to the next */
int stic_font_width(const stic_font *font, const char *text); /* px; UTF-8, unknown characters show as '?' */

/* Text with the upper left corner of its line at (x, y). */
void stic_canvas_text(const stic_canvas *canvas, const stic_font *font, int x, int y, const char *text,
                      stic_color color);
/* The same with a rim, so that it can be read on any ground. */
void stic_canvas_text_rimmed(const stic_canvas *canvas, const stic_font *font, int x, int y, const char *text,
                             stic_color color, stic_color rim);

#endif

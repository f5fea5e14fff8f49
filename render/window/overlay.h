/* What the live view writes over a picture: badges, the help page. By the CPU, into a copy of the picture. */
#ifndef STIC_OVERLAY_H
#define STIC_OVERLAY_H

#include "canvas.h"
#include "render.h"
#include "theme.h"

typedef struct stic_overlay {
  const stic_theme *theme;
  stic_font *text, *strong; /* owned */
  double unit;              /* px that stand for one px of a picture 480 px tall */
} stic_overlay;

/* For pictures of that size. False without memory. Free in either case. */
bool stic_overlay_init(stic_overlay *overlay, int width, int height, stic_look look);
void stic_overlay_free(stic_overlay *overlay); /* a zeroed one is allowed */

/* A pill with words in the upper middle of the area, the `row`-th from above; an alarm is loud. */
void stic_overlay_badge(const stic_overlay *overlay, const stic_canvas *canvas, stic_rect area, int row,
                        bool alarm, const char *text);

/* Quiet words in the area's upper right corner. */
void stic_overlay_hint(const stic_overlay *overlay, const stic_canvas *canvas, stic_rect area,
                       const char *text);

/* The keys, and the mouse's part of the hand if it is one. */
void stic_overlay_help(const stic_overlay *overlay, const stic_canvas *canvas, bool mouse);

#endif

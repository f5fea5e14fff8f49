/* The colours of a picture. After Okabe and Ito: told apart with every kind of colour blindness; what
 * means something also differs in shape or place, for print in grey. */
#ifndef STIC_THEME_H
#define STIC_THEME_H

#include "canvas.h"

typedef struct stic_theme {
  stic_color background, panel, line, text, muted;      /* paper, head-up display, frames, words */
  stic_color surface, section, hatch, grid, grid_major; /* top of a slab, its cut front, lines on them */
  stic_color object, outline;                           /* the held object and its edges */
  stic_color hand, spring, slack;                       /* ghost and trail; spring under load and at rest */
  stic_color normal, friction, cone, edge;              /* forces; the cone, and at its limit */
  stic_color stick, slip;                               /* contacts */
  stic_color shadow;                                    /* opaque; its strength is the scene's */
} stic_theme;

extern const stic_theme stic_theme_light;
extern const stic_theme stic_theme_dark;

#endif

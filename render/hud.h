/* The head-up display: a legend above the 3-D view; below it state, forces and two plots. And where
 * labels of the view go so that they do not cover each other. All by the CPU. */
#ifndef STIC_HUD_H
#define STIC_HUD_H

#include "canvas.h"
#include "history.h"
#include "render.h"
#include "theme.h"
#include "view.h"

typedef struct stic_hud {
  const stic_theme *theme;           /* borrowed */
  stic_font *small, *strong, *large; /* owned */
  double unit;                       /* px that stand for one px of a picture 480 px tall */
  int width, height;                 /* px of the picture */
  int view_top, view_bottom;         /* px, rows of the 3-D view */
  stic_rect values, cone_plot, time_plot;
  uint8_t *cone_ground; /* owned: what stays of cone_plot */
  double cone_full;     /* N, the scale that cone_ground is for; 0: none yet */
  stic_plot plot;       /* never STIC_PLOT_AUTO */
  char note[64];
} stic_hud;

/* False without memory. */
bool stic_hud_init(stic_hud *hud, const stic_render_settings *settings, const stic_scene *scene,
                   const stic_theme *theme);
void stic_hud_free(stic_hud *hud);

/* Legend and frames: what stays. Drawn on a picture already filled with the background. */
void stic_hud_draw_fixed(const stic_hud *hud, const stic_canvas *canvas);

/* Time, state, forces, plots. */
void stic_hud_draw(stic_hud *hud, const stic_canvas *canvas, const stic_view *view,
                   const stic_history *history);

/* Where the note goes, in the corner of the view that the scale bar leaves. */
stic_rect stic_hud_note_area(const stic_hud *hud);
/* The bar that says how long a newton is drawn; within the view. */
void stic_hud_draw_scale(const stic_hud *hud, const stic_canvas *canvas, const stic_view *view);

/* Chooses places inside the view (px of the picture); areas[i] is empty if label i finds none. Those before
 * `first` keep the areas that they have and are kept clear of. */
void stic_hud_place_labels(const stic_hud *hud, const stic_labels *labels, int first, stic_rect *areas);
void stic_hud_draw_labels(const stic_hud *hud, const stic_canvas *canvas, const stic_labels *labels,
                          const stic_rect *areas);

#endif

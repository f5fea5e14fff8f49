/* A contact sheet: a run at a glance. Above, its states over time with the pictures' places marked; below, the
 * pictures with their captions. Drawn by the CPU alone, so it looks the same everywhere. */
#ifndef STIC_SHEET_H
#define STIC_SHEET_H

#include "render.h"

#define STIC_SHEET_SIZE_MAX 16384 /* px, of either side of the sheet */

typedef struct stic_sheet_settings {
  int columns, count;   /* pictures side by side, pictures in all; both >= 1 */
  int width, height;    /* px of one picture, within the renderer's limits */
  stic_look look;       /* of the pictures */
  const char *title;    /* borrowed during creation; what does not fit ends with an ellipsis */
  const char *subtitle; /* the same */
} stic_sheet_settings;

/* One row of the run for the band of states. */
typedef struct stic_sheet_row {
  int64_t t_ns; /* increasing */
  stic_state state;
  bool slipped;
} stic_sheet_row;

typedef struct stic_sheet_caption {
  int64_t t_ns;
  const char *title, *text; /* borrowed during the call */
} stic_sheet_caption;

/* Opaque. */
typedef struct stic_sheet stic_sheet;

/* Makes an empty sheet. STIC_USAGE for one larger than STIC_SHEET_SIZE_MAX, STIC_NO_MEMORY. The caller owns
 * `*sheet`. */
stic_status stic_sheet_create(const stic_sheet_settings *settings, stic_sheet **sheet, stic_error *err);
void stic_sheet_destroy(stic_sheet *sheet); /* NULL allowed */

/* Draws the band of states over `count` >= 1 rows, and the numbers 1 to `mark_count` (at most the pictures') at
 * their times, which increase. */
void stic_sheet_draw_band(stic_sheet *sheet, const stic_sheet_row *rows, size_t count,
                          const int64_t *marks_ns, int mark_count);

/* Puts a picture of the size given at creation with its caption in place `index`, 0 and up. */
void stic_sheet_place(stic_sheet *sheet, int index, const stic_image *image,
                      const stic_sheet_caption *caption);

/* The sheet as it is so far; valid as long as the sheet. */
stic_image stic_sheet_image(const stic_sheet *sheet);

#endif

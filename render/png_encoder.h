/* Pictures to PNG in memory: RGB, no filter, which for flat colour is both the quickest and the smallest.
 * The container is a few bytes around libdeflate's output. */
#ifndef STIC_PNG_ENCODER_H
#define STIC_PNG_ENCODER_H

#include "render.h"

#define STIC_PNG_QUICK 1 /* for sequences */
#define STIC_PNG_SMALL 9 /* for single pictures: six times the time, a tenth off the size */

/* Keeps its memory from picture to picture; for one thread. Opaque. */
typedef struct stic_png_encoder stic_png_encoder;

/* `effort` is 1 to 12. The caller owns it; NULL without memory. */
stic_png_encoder *stic_png_encoder_create(int effort);
void stic_png_encoder_destroy(stic_png_encoder *encoder); /* NULL allowed */

/* The whole file, `*length` bytes, valid until the next call; NULL without memory. The same picture gives the
 * same bytes. */
const uint8_t *stic_png_encode(stic_png_encoder *encoder, const stic_image *image, size_t *length);

#endif

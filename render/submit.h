/* Meshes to pixels by OpenGL. What stays (the stage) is drawn once and copied; only the part of the
 * picture that changes is drawn and read back, with several samples per pixel if wanted. */
#ifndef STIC_SUBMIT_H
#define STIC_SUBMIT_H

#include "canvas.h"
#include "gl.h"
#include "mesh.h"

/* A colour and a depth buffer to draw into. */
typedef struct stic_target {
  GLuint framebuffer, color, depth;
} stic_target;

typedef struct stic_submit {
  const stic_gl *gl; /* borrowed */
  int width, height; /* px of the picture */
  int samples;       /* per pixel and direction: 1, 2 or 4 */
  stic_target stage, frame, identity;
  GLuint program, identity_program, vertex_array, buffer;
  GLint matrix_at, identity_matrix_at, identity_id_at;
  uint32_t *readback; /* owned, samples^2 * width * height */
} stic_submit;

/* Makes programs and buffers in the current context. `samples` is lowered for pictures too large for
 * that many. Nothing is left on failure (STIC_CANNOT_WRITE, STIC_NO_MEMORY). */
stic_status stic_submit_init(stic_submit *submit, const stic_gl *gl, int width, int height, int samples,
                             stic_error *err);
void stic_submit_free(stic_submit *submit); /* a zeroed one is allowed */

/* Draws the stage anew. */
void stic_submit_stage(stic_submit *submit, const stic_mesh *mesh, const float matrix[16],
                       stic_color background);

/* Draws the mesh over the stage inside `area` (px of the picture, not empty) and waits for it. */
void stic_submit_frame(stic_submit *submit, const stic_mesh *mesh, const float matrix[16], stic_rect area);

/* Reads the area back, averaged, into a picture of `stride` pixels a row at (0, top) of which the view
 * starts. */
void stic_submit_read(stic_submit *submit, stic_rect area, uint8_t *pixels, int stride, int top);

/* Object ids and depths of stage and mesh together; each buffer has width * height entries. */
stic_status stic_submit_identify(stic_submit *submit, const stic_mesh *stage, const stic_mesh *mesh,
                                 const float matrix[16], uint16_t *ids, uint16_t *depths, stic_error *err);

/* STIC_CANNOT_WRITE if OpenGL has met an error since the last call. */
stic_status stic_submit_check(const stic_submit *submit, stic_error *err);

#endif

/* PNG files of pictures: one at a time, or a numbered sequence by worker threads. RGB, no filter, fastest
 * compression: for pictures of flat colour that is both the quickest and the smallest. */
#ifndef STIC_PNG_WRITER_H
#define STIC_PNG_WRITER_H

#include "render.h"

/* Writes one picture, complete or not at all: beside its place, then renamed. STIC_CANNOT_WRITE. */
stic_status stic_png_write(const char *path, const stic_image *image, stic_error *err);

/* Writes FOLDER/frame_000000.png ... by threads of its own behind a bounded queue. Opaque. */
typedef struct stic_png_writer stic_png_writer;

#define STIC_PNG_WORKERS_MAX 16

/* Starts the threads (1..STIC_PNG_WORKERS_MAX). The folder must exist; its name is copied. The caller
 * owns `*writer`. STIC_NO_MEMORY. */
stic_status stic_png_writer_create(const char *folder, int width, int height, int workers,
                                   stic_png_writer **writer, stic_error *err);

/* Copies the picture, of the size given at creation, into the queue as number `index` (0 and up); waits
 * while the queue is full. The first failure of any thread so far is reported, and from then on nothing
 * more is written. */
stic_status stic_png_writer_add(stic_png_writer *writer, int64_t index, const stic_image *image,
                                stic_error *err);

/* Waits until all is written and reports the first failure. */
stic_status stic_png_writer_finish(stic_png_writer *writer, stic_error *err);

/* Drops what is still queued and ends the threads. NULL allowed. */
void stic_png_writer_destroy(stic_png_writer *writer);

/* The name of a picture of a sequence in its folder, "frame_000000.png". */
#define STIC_PNG_NAME_MAX 40
void stic_png_sequence_name(int64_t index, char name[STIC_PNG_NAME_MAX]);

#endif

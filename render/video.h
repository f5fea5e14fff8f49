/* Video files through libav: .mp4 is H.264, .mkv lossless H.264 in RGB, .webm VP9. BT.709, limited range;
 * one thread, so that the same pictures give the same file. The file appears whole or not at all. A build
 * without libav refuses everything. */
#ifndef STIC_VIDEO_H
#define STIC_VIDEO_H

#include "render.h"

/* Opaque. */
typedef struct stic_video stic_video;

/* True if this build can write video. */
bool stic_video_available(void);

/* The licence of the libav that writes video, as libav names it ("GPL version 2 or later", if x264 is in it), into
 * `text` of `size` bytes, size > 0: "" if this build cannot write video. Not real-time: loads libav. */
void stic_video_licence(char *text, size_t size);

/* Starts a video of pictures width x height (px, even), `fps` of them a second; the kind follows from the
 * path's ending. `live` trades size for speed (H.264 only). The path is copied. STIC_USAGE for another
 * ending, a build without libav or a libav without the encoder; STIC_CANNOT_WRITE; STIC_NO_MEMORY. The
 * caller owns `*video`. */
stic_status stic_video_create(const char *path, int width, int height, int fps, bool live, stic_video **video,
                              stic_error *err);

/* Appends a picture of the size given at creation. STIC_CANNOT_WRITE, STIC_NO_MEMORY. */
stic_status stic_video_add(stic_video *video, const stic_image *image, stic_error *err);

/* Writes what the encoder still holds and closes the file, which is not in its place yet. */
stic_status stic_video_finish(stic_video *video, stic_error *err);

/* After finish: moves the file to its place. */
stic_status stic_video_keep(stic_video *video, stic_error *err);

/* Ends; what was not kept leaves nothing. NULL allowed. */
void stic_video_destroy(stic_video *video);

#endif

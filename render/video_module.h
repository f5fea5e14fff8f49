/* What the module that writes video offers to the program. */
#ifndef STIC_VIDEO_MODULE_H
#define STIC_VIDEO_MODULE_H

#include "render.h"

/* Changes with the table below: a module of another build is not used. */
#define STIC_VIDEO_MODULE 2

typedef struct stic_video_writer stic_video_writer;

/* As the functions of video.h. */
typedef struct stic_video_module {
  int version;
  const char *(*licence)(void); /* of libav as it was built; static */
  stic_status (*create)(const char *path, int width, int height, int fps, bool live,
                        stic_video_writer **writer, stic_error *err);
  stic_status (*add)(stic_video_writer *writer, const stic_image *image, stic_error *err);
  stic_status (*finish)(stic_video_writer *writer, stic_error *err);
  stic_status (*keep)(stic_video_writer *writer, stic_error *err);
  void (*destroy)(stic_video_writer *writer);
} stic_video_module;

/* The module's one symbol. */
extern STIC_API const stic_video_module stic_video_libav;

#endif

/* Pictures of a run: made beside the loop, in a thread of their own, as far as they keep up. */
#ifndef STIC_RUN_PICTURES_H
#define STIC_RUN_PICTURES_H

#include "../live/live.h"
#include "pictures.h"

typedef struct stic_run_pictures {
  /* Command-line values; strings are popt's copies, freed by the function below. */
  char *folder, *video; /* NULL: none of that kind */
  int fps, force;
  stic_picture_options options;

  const stic_scene *scene;
  stic_movie *movie;
  stic_timing timing;
  int64_t count, dropped; /* when it has ended */
} stic_run_pictures;

/* Rows of a popt table for the values above. */
#define STIC_RUN_PICTURE_OPTIONS(p)                                                                           \
  {"frames", '\0', POPT_ARG_STRING, &(p)->folder, 0, "Write pictures DIR/frame_000000.png ...", "DIR"},       \
    {"video",     '\0', POPT_ARG_STRING,                                                                      \
     &(p)->video, 0,    "Write a video: .mp4 (H.264), .mkv (lossless) or .webm (VP9)",                        \
     "FILE"},                                                                                                 \
    {"fps", '\0', POPT_ARG_INT, &(p)->fps, 0, "Pictures per second of the run, 1 to 1000 (default 31)", "N"}, \
    {"force", '\0', POPT_ARG_NONE, &(p)->force, 0, "Remove older pictures from DIR", NULL},                   \
    STIC_PICTURE_OPTIONS(&(p)->options)

void stic_run_pictures_init(stic_run_pictures *pictures);
void stic_run_pictures_free(stic_run_pictures *pictures);

/* Whether any are wanted. */
bool stic_run_pictures_wanted(const stic_run_pictures *pictures);

/* The functions that the loop calls; `pictures` must outlive it. Afterwards `timing`, `count` and `dropped` hold. */
stic_live_pictures stic_run_pictures_calls(stic_run_pictures *pictures, const stic_scene *scene);

#endif

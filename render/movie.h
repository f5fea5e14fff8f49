/* The pictures of a run at a steady rate, into a folder of PNG files, a
 * video, or both: picture i shows the newest result
 * at t_0 + i / fps, where t_0 is the first result's time; floor(T fps) + 1 pictures for T seconds.
 * Nothing appears under its final name before stic_movie_keep(). */
#ifndef STIC_MOVIE_H
#define STIC_MOVIE_H

#include "render.h"

typedef enum stic_movie_stage {
  STIC_MOVIE_RENDER, /* drawing a picture */
  STIC_MOVIE_ENCODE  /* handing it over; the threads' own time is not in it */
} stic_movie_stage;

/* Fill with stic_movie_settings_init(). Strings are copied. */
typedef struct stic_movie_settings {
  stic_render_settings render;
  const char *folder; /* DIR/frame_000000.png ...; NULL (default): none. Made if it is absent */
  const char *video;  /* .mp4, .mkv or .webm (video.h); NULL (default): none */
  bool live;          /* quick rather than small video, default false */
  int fps;            /* 1..1000, default 31 */
  bool force;         /* replace older pictures, default false: they are refused */
  int workers;        /* threads that write PNG files, 1..16, default 2 */
  /* Called after each stage with its wall time, in the caller's thread; NULL (default): not. */
  void (*timed)(void *user, stic_movie_stage stage, int64_t ns);
  void *user;
  bool (*stopped)(void); /* asked before each picture: true ends the drawing early; NULL (default): never */
} stic_movie_settings;

void stic_movie_settings_init(stic_movie_settings *settings);

/* Opaque. */
typedef struct stic_movie stic_movie;

/* Makes the renderer and prepares the outputs. STIC_USAGE for settings that cannot be meant,
 * STIC_CANNOT_WRITE for a folder that cannot be written or has older pictures, or without a usable
 * renderer; STIC_NO_MEMORY. The caller owns `*movie`. */
stic_status stic_movie_open(const stic_movie_settings *settings, const stic_scene *scene, stic_movie **movie,
                            stic_error *err);

/* Draws the pictures that are due before time t_ns: call it before each result but the first. */
stic_status stic_movie_before(stic_movie *movie, int64_t t_ns, stic_error *err);

/* While `late`, pictures that are due show the one drawn last again instead of being drawn; the first one is
 * always drawn. So the timeline stays true where drawing cannot keep up. Default false. */
void stic_movie_set_late(stic_movie *movie, bool late);
/* Pictures that were not drawn for that. */
int64_t stic_movie_dropped(const stic_movie *movie);

/* Notes a result. Cheap. */
void stic_movie_observe(stic_movie *movie, const stic_result *result);

/* Draws the pictures that are left, up to the last result, and waits until all is written. */
stic_status stic_movie_finish(stic_movie *movie, stic_error *err);

/* After finish: moves the outputs to their places, instead of older ones. STIC_CANNOT_WRITE as well if another run
 * has put pictures into the folder meanwhile, unless forced. */
stic_status stic_movie_keep(stic_movie *movie, stic_error *err);

/* Pictures so far. */
int64_t stic_movie_count(const stic_movie *movie);

/* The renderer, for its rasteriser, times and note. */
stic_render *stic_movie_renderer(stic_movie *movie);

/* Ends; what was not kept leaves nothing. NULL allowed. */
void stic_movie_close(stic_movie *movie);

#endif

/* Options of the commands that make pictures, and what a picture's frame and scales need to know beforehand. */
#ifndef STIC_PICTURES_H
#define STIC_PICTURES_H

#include "cli.h"
#include "movie.h"

/* Command-line values; strings are popt's copies (NULL: not given), freed by the function below. */
typedef struct stic_picture_options {
  char *size, *camera, *theme, *quality, *plot;
} stic_picture_options;

/* Rows of a popt table for the options above. */
#define STIC_PICTURE_OPTIONS(o)                                                                              \
  {"size", '\0', POPT_ARG_STRING, &(o)->size, 0, "Size of pictures in pixels (default 1280x720)", "WxH"},    \
    {"camera", '\0', POPT_ARG_STRING, &(o)->camera, 0, "three-quarter (default), front or follow", "NAME"},  \
    {"theme", '\0', POPT_ARG_STRING, &(o)->theme, 0, "light (default) or dark", "NAME"},                     \
    {"quality", '\0', POPT_ARG_STRING, &(o)->quality, 0, "fast, good (default) or best", "NAME"},            \
  {                                                                                                          \
    "plot-of", '\0', POPT_ARG_STRING, &(o)->plot, 0,                                                         \
      "What the plot over time shows: auto (default), x, y or angle", "NAME"                                 \
  }

void stic_picture_options_free(stic_picture_options *options);

/* Puts the values into `settings`; STIC_USAGE for what they cannot be. */
stic_status stic_pictures_apply(const stic_picture_options *options, stic_render_settings *settings,
                                stic_error *err);

/* Solves the trace once without writing anything, so that pictures can have a frame and scales that fit all of
 * it. Bad lines are left for the run itself to tell: what was read up to there counts. What can be read once only,
 * standard input and pipes, is left alone, and `*measured` false. A signal ends it early. `*seconds`: from the first
 * sample to the last. */
stic_status stic_pictures_measure(const stic_scene *scene, const stic_settings *settings, const char *trace,
                                  bool lenient, stic_extent *extent, bool *measured, double *seconds,
                                  stic_error *err);

#endif

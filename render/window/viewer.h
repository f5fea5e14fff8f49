/* The live view: a window that shows the newest frame of the real-time loop. It only reads the loop's cell and so
 * never holds it up: frames that come faster than pictures are skipped, and the time plot and the trails have one
 * point per picture then (a slip between two pictures is still marked). It draws when there is something new, at
 * most 60 times a second, in the calling thread alone. All for one thread, none real-time. */
#ifndef STIC_VIEWER_H
#define STIC_VIEWER_H

#include "../../src/live/live.h"
#include "render.h"

typedef struct stic_viewer_settings {
  const stic_scene *scene;      /* copied */
  stic_render_settings picture; /* its size is the window's first one */
  stic_device *mouse; /* of the driver `mouse`: pointer and wheel are the hand; NULL (default): none.
                                 * Must live as long as the viewer */
} stic_viewer_settings;

typedef struct stic_viewer stic_viewer;

/* Opens the window with a picture of the scene's start. STIC_USAGE for a build without SDL; STIC_CANNOT_WRITE if
 * there is no display or no usable renderer; STIC_NO_MEMORY. Call it before the loop starts, so that the loop's
 * threads do not share the view's low priority. The caller owns `*viewer`. */
stic_status stic_viewer_open(const stic_viewer_settings *settings, stic_viewer **viewer, stic_error *err);

/* Does what the user asks for, and shows the newest value of the loop's cell if it is time for a picture. Waits up
 * to 5 ms for something to do. `*ended`: the user has closed the window. An error means that the window cannot
 * be used any more. */
stic_status stic_viewer_turn(stic_viewer *viewer, stic_latest *newest, bool *ended, stic_error *err);

/* Pictures shown so far. */
int64_t stic_viewer_pictures(const stic_viewer *viewer);

void stic_viewer_close(stic_viewer *viewer); /* NULL allowed */

#endif

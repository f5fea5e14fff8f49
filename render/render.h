/* Pictures of a run: the scene in three dimensions with its forces, and a head-up display. Drawn without
 * a window by Mesa's llvmpipe; the same calls give the same picture on the same machine and Mesa.
 * What does not change from picture to picture is not drawn again. */
#ifndef STIC_RENDER_H
#define STIC_RENDER_H

#include <stdint.h>

#include "canvas.h"
#include "gl.h"
#include "stiction.h"

typedef enum stic_camera_preset {
  STIC_CAMERA_THREE_QUARTER, /* from above and from the side that walls leave open */
  STIC_CAMERA_FRONT,         /* straight at the x-y plane, a little from above */
  STIC_CAMERA_FOLLOW         /* as three-quarter, near the object and moving with it */
} stic_camera_preset;

typedef enum stic_look { STIC_LOOK_LIGHT, STIC_LOOK_DARK } stic_look;

typedef enum stic_quality {
  STIC_QUALITY_FAST, /* one sample per pixel */
  STIC_QUALITY_GOOD, /* 2 x 2 samples per pixel */
  STIC_QUALITY_BEST  /* 4 x 4 samples per pixel */
} stic_quality;

/* What the plot over time shows, of the hand and of the object. */
typedef enum stic_plot {
  STIC_PLOT_AUTO, /* whichever of x, y and angle moves most in contact, by `extent`; x without one */
  STIC_PLOT_X,    /* of hand and holding point, m */
  STIC_PLOT_Y,
  STIC_PLOT_ANGLE /* degrees */
} stic_plot;

/* What a run reaches, gathered beforehand so that the camera need not be moved and scales need not be
 * changed on the way. Start with stic_extent_init(). */
typedef struct stic_extent {
  double low[3], high[3];             /* m, of object and hand; low > high: nothing yet */
  double point_low[2], point_high[2]; /* m, of the holding point while in contact; low > high: never */
  double angle[2];                    /* rad, lowest and highest of the object while in contact */
  double force;                       /* N, largest normal or friction force of a contact */
} stic_extent;

void stic_extent_init(stic_extent *extent);
void stic_extent_add(stic_extent *extent, const stic_scene *scene, const stic_result *result);

/* Sizes of a picture in px; both are even for the sake of video. */
#define STIC_PICTURE_WIDTH_MIN 160
#define STIC_PICTURE_HEIGHT_MIN 120
#define STIC_PICTURE_SIZE_MAX 4096

/* Fill with stic_render_settings_init(). */
typedef struct stic_render_settings {
  int width, height;          /* px, default 1280 x 720; 160 x 120 to 4096 x 4096, even */
  stic_look look;             /* default STIC_LOOK_LIGHT */
  stic_camera_preset camera;  /* default STIC_CAMERA_THREE_QUARTER */
  stic_quality quality;       /* default STIC_QUALITY_GOOD */
  stic_plot plot;             /* default STIC_PLOT_AUTO */
  const stic_extent *extent;  /* borrowed during creation; NULL (default): guessed from the scene, and
                               * the camera steps back when something leaves the view */
  stic_gl_backend backend;    /* default STIC_GL_AUTO */
  const char *osmesa_library; /* borrowed during creation; NULL (default): the system's */
} stic_render_settings;

void stic_render_settings_init(stic_render_settings *settings);

/* Set a field by the name that the command line uses; false, and nothing changed, for any other name.
 * "light", "dark"; "three-quarter", "front", "follow"; "fast", "good", "best"; "auto", "x", "y", "angle". */
bool stic_look_from_name(const char *name, stic_look *look);
bool stic_camera_from_name(const char *name, stic_camera_preset *camera);
bool stic_quality_from_name(const char *name, stic_quality *quality);
bool stic_plot_from_name(const char *name, stic_plot *plot);

/* Refuses sizes outside the limits and enumeration values that do not exist, with STIC_USAGE. */
stic_status stic_render_settings_validate(const stic_render_settings *settings, stic_error *err);

/* A picture. The pixels belong to whoever gives it and stay valid as long as that says. */
typedef struct stic_image {
  int width, height;     /* px */
  const uint8_t *pixels; /* R, G, B, 255 per pixel; rows top down without gaps */
} stic_image;

/* CPU time of the calling thread per stage of the last picture, ns. */
typedef struct stic_render_times {
  int64_t build_ns; /* triangles and labels from the result */
  int64_t draw_ns;  /* OpenGL, up to glFinish; all of it only with LP_NUM_THREADS=0 in the environment */
  int64_t read_ns;  /* reading back and averaging samples */
  int64_t hud_ns;   /* labels, head-up display */
} stic_render_times;

/* A renderer of one scene. Opaque. */
typedef struct stic_render stic_render;

/* Makes a renderer; scene and settings are copied, `*render` is NULL on failure. The caller owns it.
 * STIC_USAGE for settings that cannot be meant, STIC_CANNOT_WRITE if there is no usable renderer,
 * STIC_NO_MEMORY. It belongs to the thread that created it. Real-time: no. */
stic_status stic_render_create(const stic_scene *scene, const stic_render_settings *settings,
                               stic_render **render, stic_error *err);
void stic_render_destroy(stic_render *render); /* NULL allowed */

/* The rasteriser in use, e.g. "llvmpipe (LLVM 15.0.6, 256 bits), 4.5 (Core Profile) Mesa 22.3.6": golden
 * images belong to it. Valid as long as the renderer. */
const char *stic_render_rasteriser(const stic_render *render);

/* Notes a result for trails, slip marks, plots and the next picture; in order of time, every row, also
 * those that no picture shows. Cheap. Real-time: yes. */
void stic_render_observe(stic_render *render, const stic_result *result);

/* Draws the newest result that was observed, at least one. `image` stays valid until the next call.
 * STIC_CANNOT_WRITE if OpenGL fails, STIC_NO_MEMORY. Real-time: no. */
stic_status stic_render_draw(stic_render *render, stic_image *image, stic_error *err);

/* Draws a line of text into the lower left corner of the view of the following pictures, for clock values that
 * pictures otherwise never show; NULL or "" (the default): none. At most 63 bytes are copied. */
void stic_render_set_note(stic_render *render, const char *note);

/* Whether the trails of hand and object are drawn; default true. */
void stic_render_set_trails(stic_render *render, bool shown);

/* Takes over from a renderer of the same scene what it has observed, how far its camera had stepped back and its
 * scale of forces: for a picture of another size or look. Before the first stic_render_draw(). */
void stic_render_continue(stic_render *render, const stic_render *from);

/* Forgets everything that was observed. */
void stic_render_forget(stic_render *render);

/* The part of the picture that shows the scene, px; nothing moves outside it but the head-up display. */
stic_rect stic_render_scene_area(const stic_render *render);

/* What is seen at a pixel (kept inside the scene's area) of the last picture: the ray from the eye through a point
 * at the depth at which the hand is drawn, m. */
void stic_render_ray(const stic_render *render, const double pixel[2], double eye[3], double through[3]);
/* The pixel at which the last picture has the hand. */
void stic_render_hand_pixel(const stic_render *render, double pixel[2]);

/* CPU time of the last stic_render_draw(). */
stic_render_times stic_render_last_times(const stic_render *render);

/* For tests: what the 3-D view's pixels show, without antialiasing: ids[y * width + x] is a STIC_ID_
 * value (mesh.h) of solids, depth[] the depth buffer's upper 16 bits (65535: nothing). Each has room for
 * `count` pixels, at least the view's width x height, which are written to *width and *height. */
stic_status stic_render_identify(stic_render *render, uint16_t *ids, uint16_t *depth, size_t count,
                                 int *width, int *height, stic_error *err);

#endif

/* How a scene is shown: camera, the slabs that stand for half-planes, scales, labels. Pure arithmetic. */
#ifndef STIC_VIEW_H
#define STIC_VIEW_H

#include "camera.h"
#include "history.h"
#include "mesh.h"
#include "render.h"
#include "stiction.h"
#include "theme.h"

#define STIC_SLAB_CORNERS_MAX 24
#define STIC_LABELS_MAX 96
/* The longest force is drawn this long, in object sizes. */
#define STIC_FORCE_SIZES 0.85

/* A surface as a thick slab, cut open in front; a convex polygon in the x-y plane. */
typedef struct stic_slab {
  int surface;
  int count;
  double points[STIC_SLAB_CORNERS_MAX][2]; /* m, counter-clockwise */
  bool has_face;                           /* part of the surface itself is in sight */
  double axis[2];                          /* unit vector along the surface in which the grid counts */
  double offset;                           /* m: the grid coordinate of q is q . axis - offset */
  double face[2];                          /* m, lowest and highest grid coordinate of the part in sight */
} stic_slab;

/* Words beside something. */
typedef struct stic_label {
  double at[2];   /* px, what the label is about */
  double away[2]; /* unit vector on the screen: where the label would best be */
  double gap;     /* px between the two */
  char text[40];
  stic_color color;
  bool strong; /* bold */
  bool firm;   /* there or nowhere */
} stic_label;

typedef struct stic_labels {
  int count;
  stic_label items[STIC_LABELS_MAX];
  int sign_count;
  double signs[STIC_LABELS_MAX][2]; /* px, what no label may cover */
} stic_labels;

typedef struct stic_view {
  const stic_scene *scene; /* borrowed */
  const stic_theme *theme; /* borrowed */
  stic_camera_preset preset;
  int width, height;      /* px of the 3-D part of the picture */
  double unit;            /* px that stand for one px of a picture 480 px tall */
  double size;            /* m, of the object */
  double low[3], high[3]; /* m, what must be in sight */
  stic_camera camera;
  double z_front, z_back; /* m, of the slabs */
  double grid;            /* m between grid lines */
  int grid_major;         /* every so many lines one is stronger and has its number */
  double force_full;      /* N, drawn force_length m long; only ever grows */
  double force_length;    /* m */
  bool no_trails;         /* trails are left out */
  int slab_count;
  stic_slab *slabs; /* owned, one per surface */
} stic_view;

/* Prepares a view of what the extent holds, or of the scene's start. False without memory. */
bool stic_view_init(stic_view *view, const stic_scene *scene, const stic_render_settings *settings,
                    const stic_theme *theme, int width, int height);
void stic_view_free(stic_view *view);

/* Makes room for a result: true if the camera had to change, so that nothing drawn before fits. */
bool stic_view_include(stic_view *view, const stic_result *result);

/* Takes over what another view of the same scene has in sight, and its scale of forces. */
void stic_view_continue(stic_view *view, const stic_view *from);

/* The depths of the object's drawn face and of the hand's ball, which is in front of everything. */
double stic_view_face_z(const stic_view *view, const stic_result *result);
double stic_view_hand_z(const stic_view *view, const stic_result *result);

/* Adds to labels what stays: numbers along the grid. */
void stic_stage_labels(const stic_view *view, stic_labels *labels);
/* Slabs and grid. */
void stic_stage_build(const stic_view *view, stic_mesh *mesh);

/* What moves: object, shadow, forces, spring, hand, trails, slip marks; and its labels. */
void stic_actors_build(const stic_view *view, const stic_history *history, stic_mesh *mesh,
                       stic_labels *labels);

/* Adds a label; silently none when there are too many. */
void stic_labels_add(stic_labels *labels, const double at[2], double away_x, double away_y, double gap,
                     stic_color color, bool strong, const char *text);
/* The same, but plain and firm. */
void stic_labels_add_number(stic_labels *labels, const double at[2], double away_x, double away_y, double gap,
                            stic_color color, const char *text);

/* Marks a place (px) that no label may cover. */
void stic_labels_keep_clear(stic_labels *labels, const double at[2]);

/* m -> px of the screen for a point of the x-y plane at depth z. */
void stic_view_project(const stic_view *view, double x, double y, double z, double pixel[2]);

/* A force in N with as many digits as make sense: "0.0012", "1.23", "12.3", "1234". */
void stic_force_text(double newton, char *out, size_t out_size);

/* Decimals that tell multiples of `step` apart, 0..9. */
int stic_decimals(double step);

/* Multiples k step within low..high: the first k, and how many there are but at most `most`. Counted, as
 * adding up never ends where numbers are too large for the step to matter. */
int stic_multiples(double low, double high, double step, int most, double *first);

/* The smallest of ..., 1, 2, 5, 10, 20, ... that is at least `value`. */
double stic_round_up_125(double value);

#endif

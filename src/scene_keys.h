/* The one table of a scene's keys: file reader, overrides and validation all go through it. Internal. */
#ifndef STIC_SCENE_KEYS_H
#define STIC_SCENE_KEYS_H

#include "stiction.h"

typedef enum stic_key {
  STIC_KEY_ROOT, /* the file's mapping itself */
  STIC_KEY_VERSION,
  STIC_KEY_NAME,
  STIC_KEY_OBJECT,
  STIC_KEY_SIZE,
  STIC_KEY_POLYGON,
  STIC_KEY_DEPTH,
  STIC_KEY_POSE,
  STIC_KEY_X,
  STIC_KEY_Y,
  STIC_KEY_Z,
  STIC_KEY_ANGLE,
  STIC_KEY_HAND,
  STIC_KEY_STIFFNESS,
  STIC_KEY_ROTATIONAL_STIFFNESS,
  STIC_KEY_HOLD,
  STIC_KEY_HOLDING_POINT,
  STIC_KEY_REACH,
  STIC_KEY_FRICTION,
  STIC_KEY_STATIC,
  STIC_KEY_DYNAMIC,
  STIC_KEY_TRACKER,
  STIC_KEY_SURFACES,
  STIC_KEY_SURFACE, /* one item of the list; from here on keys belong to a surface */
  STIC_KEY_SURFACE_NAME,
  STIC_KEY_SURFACE_POINT,
  STIC_KEY_SURFACE_NORMAL,
  STIC_KEY_SURFACE_FRICTION,
  STIC_KEY_SURFACE_STATIC,
  STIC_KEY_SURFACE_DYNAMIC,
  STIC_KEY_COUNT
} stic_key;

typedef enum stic_key_type {
  STIC_TYPE_MAPPING,
  STIC_TYPE_SURFACES, /* list of mappings */
  STIC_TYPE_VERSION,
  STIC_TYPE_NAME,
  STIC_TYPE_NUMBERS, /* `count` of them; 1: a bare number, else a list */
  STIC_TYPE_SIZE,    /* width, height, depth */
  STIC_TYPE_POLYGON, /* list of points */
  STIC_TYPE_HOLD,
  STIC_TYPE_ELSEWHERE /* a mapping that the reader of trackers reads */
} stic_key_type;

typedef struct stic_key_row {
  const char *name; /* as written in the file */
  stic_key parent;
  stic_key_type type;
  int count;        /* of numbers */
  size_t offset;    /* of the first double (or the name) in stic_scene, or stic_surface for its keys;
                         * STIC_NO_OFFSET where the value is not kept as it is */
  double low, high; /* allowed range in the file's unit */
  bool above_low;   /* `low` itself is refused */
  bool degrees;     /* the file has degrees, the scene radians */
  bool required;    /* wherever its parent is present; else the default stays */
  const char *unit;
} stic_key_row;

#define STIC_NO_OFFSET ((size_t)-1)

const stic_key_row *stic_key_get(stic_key key);

/* "a number > 0 and <= 1e+12 N/m", "3 numbers, each ..." ... Returns out. */
const char *stic_key_expected(stic_key key, char *out, size_t out_size);

/* "object.pose.x", "surfaces.2.point"; `surface` matters for keys of a surface only. Returns out. */
const char *stic_key_path(stic_key key, int surface, char *out, size_t out_size);

/* The numbers of one key: where it keeps them in the scene; NULL if it keeps none. */
double *stic_key_numbers(stic_key key, stic_scene *scene, int surface);

/* Told about one thing that is wrong with a scene. `index`: the surface for keys of a surface, the
 * vertex for STIC_KEY_POLYGON, else -1. */
typedef void stic_scene_problem(void *context, stic_key key, int index, const char *message);

/* Reports all that stic_scene_validate() refuses; values that are NaN are reported once and take no
 * part in later checks. */
void stic_scene_examine(const stic_scene *scene, stic_scene_problem *problem, void *context);

#endif

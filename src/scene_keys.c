#include "scene_keys.h"

#include "number.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#define LENGTH_LOW 1e-9
#define LENGTH_HIGH 1e9
#define PLACE 1e15 /* m, largest coordinate */
#define ANGLE 1e6  /* degrees */
#define STIFF 1e12
#define SCENE(field) offsetof(stic_scene, field)
#define SURFACE(field) offsetof(stic_surface, field)

static const stic_key_row rows[STIC_KEY_COUNT] = {
  [STIC_KEY_ROOT] = {"", STIC_KEY_ROOT, STIC_TYPE_MAPPING, 0, STIC_NO_OFFSET, 0, 0, false, false, false, ""},
  [STIC_KEY_VERSION] = {"stiction", STIC_KEY_ROOT, STIC_TYPE_VERSION, 0, STIC_NO_OFFSET, 1, 1, false, false,
                        true, ""},
  [STIC_KEY_NAME] = {"name", STIC_KEY_ROOT, STIC_TYPE_NAME, 0, SCENE(name), 0, 0, false, false, false, ""},
  [STIC_KEY_OBJECT] = {"object", STIC_KEY_ROOT, STIC_TYPE_MAPPING, 0, STIC_NO_OFFSET, 0, 0, false, false,
                       true, ""},
  [STIC_KEY_SIZE] = {"size", STIC_KEY_OBJECT, STIC_TYPE_SIZE, 3, STIC_NO_OFFSET, LENGTH_LOW, LENGTH_HIGH,
                     false, false, false, "m"},
  [STIC_KEY_POLYGON] = {"polygon", STIC_KEY_OBJECT, STIC_TYPE_POLYGON, 2, STIC_NO_OFFSET, -LENGTH_HIGH,
                        LENGTH_HIGH, false, false, false, "m"},
  [STIC_KEY_DEPTH] = {"depth", STIC_KEY_OBJECT, STIC_TYPE_NUMBERS, 1, SCENE(depth), LENGTH_LOW, LENGTH_HIGH,
                      false, false, false, "m"},
  [STIC_KEY_POSE] = {"pose", STIC_KEY_OBJECT, STIC_TYPE_MAPPING, 0, STIC_NO_OFFSET, 0, 0, false, false, false,
                     ""},
  [STIC_KEY_X] = {"x", STIC_KEY_POSE, STIC_TYPE_NUMBERS, 1, SCENE(x), -PLACE, PLACE, false, false, false,
                  "m"},
  [STIC_KEY_Y] = {"y", STIC_KEY_POSE, STIC_TYPE_NUMBERS, 1, SCENE(y), -PLACE, PLACE, false, false, false,
                  "m"},
  [STIC_KEY_Z] = {"z", STIC_KEY_POSE, STIC_TYPE_NUMBERS, 1, SCENE(z), -PLACE, PLACE, false, false, false,
                  "m"},
  [STIC_KEY_ANGLE] = {"angle_deg", STIC_KEY_POSE, STIC_TYPE_NUMBERS, 1, SCENE(angle), -ANGLE, ANGLE, false,
                      true, false, "degrees"},
  [STIC_KEY_HAND] = {"hand", STIC_KEY_ROOT, STIC_TYPE_MAPPING, 0, STIC_NO_OFFSET, 0, 0, false, false, true,
                     ""},
  [STIC_KEY_STIFFNESS] = {"stiffness", STIC_KEY_HAND, STIC_TYPE_NUMBERS, 1, SCENE(stiffness), 0, STIFF, true,
                          false, true, "N/m"},
  [STIC_KEY_ROTATIONAL_STIFFNESS] = {"rotational_stiffness", STIC_KEY_HAND, STIC_TYPE_NUMBERS, 1,
                                     SCENE(rotational_stiffness), 0, STIFF, false, false, true, "N m/rad"},
  [STIC_KEY_HOLD] = {"hold", STIC_KEY_HAND, STIC_TYPE_HOLD, 0, STIC_NO_OFFSET, 0, 0, false, false, false, ""},
  [STIC_KEY_HOLDING_POINT] = {"holding_point", STIC_KEY_HAND, STIC_TYPE_NUMBERS, 2, SCENE(holding_point),
                              -LENGTH_HIGH, LENGTH_HIGH, false, false, false, "m"},
  [STIC_KEY_REACH] = {"reach", STIC_KEY_HAND, STIC_TYPE_NUMBERS, 1, SCENE(reach), 0, LENGTH_HIGH, false,
                      false, false, "m"},
  [STIC_KEY_FRICTION] = {"friction", STIC_KEY_ROOT, STIC_TYPE_MAPPING, 0, STIC_NO_OFFSET, 0, 0, false, false,
                         false, ""},
  [STIC_KEY_STATIC] = {"static", STIC_KEY_FRICTION, STIC_TYPE_NUMBERS, 1, STIC_NO_OFFSET, 0, 1e6, false,
                       false, false, ""},
  [STIC_KEY_DYNAMIC] = {"dynamic", STIC_KEY_FRICTION, STIC_TYPE_NUMBERS, 1, STIC_NO_OFFSET, 0, 1e6, false,
                        false, false, ""},
  [STIC_KEY_TRACKER] = {"tracker", STIC_KEY_ROOT, STIC_TYPE_ELSEWHERE, 0, STIC_NO_OFFSET, 0, 0, false, false,
                        false, ""},
  [STIC_KEY_SURFACES] = {"surfaces", STIC_KEY_ROOT, STIC_TYPE_SURFACES, 0, STIC_NO_OFFSET, 1,
                         STIC_SURFACES_MAX, false, false, true, ""},
  [STIC_KEY_SURFACE] = {"*", STIC_KEY_SURFACES, STIC_TYPE_MAPPING, 0, STIC_NO_OFFSET, 0, 0, false, false,
                        false, ""},
  [STIC_KEY_SURFACE_NAME] = {"name", STIC_KEY_SURFACE, STIC_TYPE_NAME, 0, SURFACE(name), 0, 0, false, false,
                             false, ""},
  [STIC_KEY_SURFACE_POINT] = {"point", STIC_KEY_SURFACE, STIC_TYPE_NUMBERS, 2, SURFACE(point), -PLACE, PLACE,
                              false, false, true, "m"},
  [STIC_KEY_SURFACE_NORMAL] = {"normal_deg", STIC_KEY_SURFACE, STIC_TYPE_NUMBERS, 1, SURFACE(normal_deg),
                               -ANGLE, ANGLE, false, false, true, "degrees"},
  [STIC_KEY_SURFACE_FRICTION] = {"friction", STIC_KEY_SURFACE, STIC_TYPE_MAPPING, 0, STIC_NO_OFFSET, 0, 0,
                                 false, false, false, ""},
  [STIC_KEY_SURFACE_STATIC] = {"static", STIC_KEY_SURFACE_FRICTION, STIC_TYPE_NUMBERS, 1,
                               SURFACE(friction.mu_static), 0, 1e6, false, false, false, ""},
  [STIC_KEY_SURFACE_DYNAMIC] = {"dynamic", STIC_KEY_SURFACE_FRICTION, STIC_TYPE_NUMBERS, 1,
                                SURFACE(friction.mu_dynamic), 0, 1e6, false, false, false, ""},
};

const stic_key_row *stic_key_get(stic_key key)
{
  assert((unsigned)key < STIC_KEY_COUNT);
  return &rows[key];
}

const char *stic_key_path(stic_key key, int surface, char *out, size_t out_size)
{
  stic_key chain[8];
  int depth = 0;
  size_t used = 0;

  assert(out_size > 0);
  out[0] = '\0';
  for (; key != STIC_KEY_ROOT && depth < 8; key = rows[key].parent)
    chain[depth++] = key;
  while (depth-- > 0 && used < out_size) {
    const char *dot = used > 0 ? "." : "";
    int n = chain[depth] == STIC_KEY_SURFACE
              ? snprintf(out + used, out_size - used, "%s%d", dot, surface)
              : snprintf(out + used, out_size - used, "%s%s", dot, rows[chain[depth]].name);

    used += n > 0 ? (size_t)n : 0;
  }
  return out;
}

static const char *range_text(const stic_key_row *row, char *out, size_t out_size)
{
  return stic_number_range_text(row->low, row->high, row->above_low, row->unit, out, out_size);
}

const char *stic_key_expected(stic_key key, char *out, size_t out_size)
{
  const stic_key_row *row = stic_key_get(key);
  char range[64];

  switch (row->type) {
  case STIC_TYPE_MAPPING:
  case STIC_TYPE_ELSEWHERE: snprintf(out, out_size, "a mapping of keys"); break;
  case STIC_TYPE_SURFACES: snprintf(out, out_size, "a list of 1 to %d surfaces", STIC_SURFACES_MAX); break;
  case STIC_TYPE_VERSION: snprintf(out, out_size, "the format version, 1"); break;
  case STIC_TYPE_NAME:
    snprintf(out, out_size, "printable text of at most %d bytes", STIC_NAME_MAX - 1);
    break;
  case STIC_TYPE_HOLD: snprintf(out, out_size, "start or button"); break;
  case STIC_TYPE_SIZE:
    snprintf(out, out_size, "[width, height, depth], each %s", range_text(row, range, sizeof range));
    break;
  case STIC_TYPE_POLYGON:
    snprintf(out, out_size, "a list of 3 to %d points [x, y] in m", STIC_VERTICES_MAX);
    break;
  case STIC_TYPE_NUMBERS:
    range_text(row, range, sizeof range);
    if (row->count == 1)
      snprintf(out, out_size, "a number %s", range);
    else
      snprintf(out, out_size, "a list of %d numbers, each %s", row->count, range);
    break;
  }
  return out;
}

double *stic_key_numbers(stic_key key, stic_scene *scene, int surface)
{
  const stic_key_row *row = stic_key_get(key);
  char *base = (char *)scene;

  if (row->type != STIC_TYPE_NUMBERS || row->offset == STIC_NO_OFFSET)
    return NULL;
  if (key >= STIC_KEY_SURFACE) {
    assert(surface >= 0 && surface < STIC_SURFACES_MAX);
    base = (char *)&scene->surfaces[surface];
  }
  return (double *)(void *)(base + row->offset);
}

#include "scene_yaml.h"

#include "angle.h"
#include "error.h"
#include "number.h"
#include "scene_keys.h"
#include "yaml_text.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FORMAT_VERSION 1
#define SURFACE_KEYS (STIC_KEY_COUNT - STIC_KEY_SURFACE)

/* Where a value came from. */
typedef struct origin {
  int64_t line; /* 0: not from the file */
  bool given;
  bool bad;        /* already complained about: later checks must not repeat it */
  bool overridden; /* by --set */
} origin;

typedef struct reading {
  const char *path;
  const stic_override *override; /* being applied; NULL while the file is read */
  stic_yaml yaml;
  stic_scene *scene;
  stic_friction friction; /* of the scene; NaN: not given */
  origin origins[STIC_KEY_SURFACE];
  origin surface_origins[STIC_SURFACES_MAX][SURFACE_KEYS];
  int64_t vertex_lines[STIC_VERTICES_MAX];
  stic_scene_report *report;
  void *context;
  stic_status status; /* of the first error */
} reading;

static origin *origin_of(reading *r, stic_key key, int surface)
{
  if (key < STIC_KEY_SURFACE)
    return &r->origins[key];
  assert(surface >= 0 && surface < STIC_SURFACES_MAX);
  return &r->surface_origins[surface < 0 ? 0 : surface][key - STIC_KEY_SURFACE];
}

/* ---- telling ----------------------------------------------------------------------------- */

static void tell(reading *r, bool warning, stic_status status, int64_t line, const char *format, ...)
  STIC_PRINTF(5, 6);

static void tell(reading *r, bool warning, stic_status status, int64_t line, const char *format, ...)
{
  char message[480];
  stic_error problem;
  va_list args;

  va_start(args, format);
  vsnprintf(message, sizeof message, format, args);
  va_end(args);
  if (r->override) {
    char value[64];

    stic_error_set(&problem, status == STIC_NO_MEMORY ? status : STIC_USAGE, NULL, 0,
                   "--set %.100s=%s: %.340s", r->override->key,
                   stic_error_quote(r->override->value, strlen(r->override->value), value, sizeof value),
                   message);
  } else {
    stic_error_set(&problem, status, r->path, line, "%s", message);
  }
  if (!warning && r->status == STIC_OK)
    r->status = problem.status;
  r->report(r->context, warning, &problem);
}

#define BAD(r, line, ...) tell(r, false, STIC_BAD_INPUT, line, __VA_ARGS__)

/* The usual refusal: this key's value is that, expected what the table says. */
static void bad_value(reading *r, stic_key key, int surface, const yaml_node_t *node)
{
  char path[96], found[80], expected[160];

  origin_of(r, key, surface)->bad = true;
  BAD(r, stic_yaml_line(node), "%s is %s; expected %s", stic_key_path(key, surface, path, sizeof path),
      stic_yaml_found(node, found, sizeof found), stic_key_expected(key, expected, sizeof expected));
}

/* ---- values ------------------------------------------------------------------------------ */

/* A list of exactly `count` numbers; complains about the list or about the number in it. */
static bool read_numbers(reading *r, stic_key key, int surface, const yaml_node_t *node, int count,
                         double *values)
{
  char path[96], found[80];

  if (node->type != YAML_SEQUENCE_NODE || stic_yaml_count(node) != count) {
    bad_value(r, key, surface, node);
    return false;
  }
  for (int i = 0; i < count; i++) {
    const yaml_node_t *number = stic_yaml_item(&r->yaml, node, i);

    if (stic_yaml_number(number, &values[i]))
      continue;
    origin_of(r, key, surface)->bad = true;
    BAD(r, stic_yaml_line(number), "%s has %s; expected a plain finite number",
        stic_key_path(key, surface, path, sizeof path), stic_yaml_found(number, found, sizeof found));
    return false;
  }
  return true;
}

static bool in_range(const stic_key_row *row, double v)
{
  return v >= row->low && v <= row->high && !(row->above_low && v == row->low);
}

static void read_numbers_key(reading *r, stic_key key, int surface, const yaml_node_t *node)
{
  const stic_key_row *row = stic_key_get(key);
  double *kept = stic_key_numbers(key, r->scene, surface);
  double values[2] = {NAN, NAN};

  assert(row->count <= 2);
  if (key == STIC_KEY_STATIC)
    kept = &r->friction.mu_static;
  else if (key == STIC_KEY_DYNAMIC)
    kept = &r->friction.mu_dynamic;
  assert(kept);
  if (row->count > 1) {
    if (!read_numbers(r, key, surface, node, row->count, values))
      return;
  } else if (!stic_yaml_number(node, &values[0])) {
    bad_value(r, key, surface, node);
    return;
  }
  for (int i = 0; i < row->count; i++) {
    if (!in_range(row, values[i])) {
      bad_value(r, key, surface, row->count > 1 ? stic_yaml_item(&r->yaml, node, i) : node);
      return;
    }
  }
  for (int i = 0; i < row->count; i++)
    kept[i] = row->degrees ? values[i] / 180.0 * STIC_PI : values[i];
}

static void read_size(reading *r, const yaml_node_t *node)
{
  const stic_key_row *row = stic_key_get(STIC_KEY_SIZE);
  double size[3];

  if (!read_numbers(r, STIC_KEY_SIZE, -1, node, 3, size))
    return;
  for (int i = 0; i < 3; i++) {
    if (!in_range(row, size[i])) {
      bad_value(r, STIC_KEY_SIZE, -1, stic_yaml_item(&r->yaml, node, i));
      return;
    }
  }
  stic_scene_set_box(r->scene, size[0], size[1]);
  /* --set object.depth before --set object.size: the later one counts, as for every key. */
  r->scene->depth = size[2];
  if (r->override)
    r->origins[STIC_KEY_POLYGON].given = false;
}

static void read_polygon(reading *r, const yaml_node_t *node)
{
  stic_scene *s = r->scene;
  int count;

  if (node->type != YAML_SEQUENCE_NODE || stic_yaml_count(node) < 3) {
    bad_value(r, STIC_KEY_POLYGON, -1, node);
    return;
  }
  count = stic_yaml_count(node);
  if (count > STIC_VERTICES_MAX) {
    r->origins[STIC_KEY_POLYGON].bad = true;
    BAD(r, stic_yaml_line(stic_yaml_item(&r->yaml, node, STIC_VERTICES_MAX)),
        "object.polygon has %d vertices; expected 3 to %d", count, STIC_VERTICES_MAX);
    return;
  }
  for (int i = 0; i < count; i++) {
    const yaml_node_t *point = stic_yaml_item(&r->yaml, node, i);

    r->vertex_lines[i] = stic_yaml_line(point);
    if (point->type != YAML_SEQUENCE_NODE || stic_yaml_count(point) != 2) {
      char found[80];

      r->origins[STIC_KEY_POLYGON].bad = true;
      BAD(r, stic_yaml_line(point), "vertex %d of object.polygon is %s; expected [x, y] in m", i,
          stic_yaml_found(point, found, sizeof found));
      return;
    }
    if (!read_numbers(r, STIC_KEY_POLYGON, -1, point, 2, s->vertices[i]))
      return;
  }
  s->vertex_count = count;
  if (r->override)
    r->origins[STIC_KEY_SIZE].given = false;
}

static void read_name(reading *r, stic_key key, int surface, const yaml_node_t *node)
{
  char *name = (key == STIC_KEY_NAME ? (char *)r->scene : (char *)&r->scene->surfaces[surface]) +
               stic_key_get(key)->offset;

  if (node->type != YAML_SCALAR_NODE || node->data.scalar.length >= STIC_NAME_MAX) {
    bad_value(r, key, surface, node);
    return;
  }
  for (size_t i = 0; i < node->data.scalar.length; i++) {
    const unsigned char c = node->data.scalar.value[i];

    /* Names are printed in messages, comment lines of logs and pictures: one line each. */
    if (c < 0x20 || c == 0x7f) {
      bad_value(r, key, surface, node);
      return;
    }
  }
  memset(name, 0, STIC_NAME_MAX);
  memcpy(name, node->data.scalar.value, node->data.scalar.length);
}

static void read_hold(reading *r, const yaml_node_t *node)
{
  const char *text = node->type == YAML_SCALAR_NODE ? (const char *)node->data.scalar.value : "";

  if (strcmp(text, "start") == 0)
    r->scene->hold = STIC_HOLD_START;
  else if (strcmp(text, "button") == 0)
    r->scene->hold = STIC_HOLD_BUTTON;
  else
    bad_value(r, STIC_KEY_HOLD, -1, node);
}

static void read_version(reading *r, const yaml_node_t *node)
{
  const char *text = node->type == YAML_SCALAR_NODE ? (const char *)node->data.scalar.value : "";
  int64_t version;

  if (stic_number_parse_integer(text, strlen(text), 0, INT64_MAX, &version) != STIC_NUMBER_OK)
    bad_value(r, STIC_KEY_VERSION, -1, node);
  else if (version != FORMAT_VERSION)
    BAD(r, stic_yaml_line(node), "the scene has format version %lld; expected %d, which this program reads",
        (long long)version, FORMAT_VERSION);
}

/* ---- structure --------------------------------------------------------------------------- */

static void read_value(reading *r, stic_key key, int surface, const yaml_node_t *node);

static stic_key child_named(stic_key parent, const char *name, size_t length)
{
  for (stic_key key = STIC_KEY_VERSION; key < STIC_KEY_COUNT; key++) {
    const stic_key_row *row = stic_key_get(key);

    if (row->parent == parent && strlen(row->name) == length && memcmp(row->name, name, length) == 0)
      return key;
  }
  return STIC_KEY_ROOT;
}

static const char *children_text(stic_key parent, char *out, size_t out_size)
{
  size_t used = 0;

  out[0] = '\0';
  for (stic_key key = STIC_KEY_VERSION; key < STIC_KEY_COUNT && used < out_size; key++) {
    int n;

    if (stic_key_get(key)->parent != parent)
      continue;
    n = snprintf(out + used, out_size - used, "%s%s", used > 0 ? ", " : "", stic_key_get(key)->name);
    used += n > 0 ? (size_t)n : 0;
  }
  return out;
}

static const char *where_text(stic_key key, int surface, char *out, size_t out_size)
{
  if (key == STIC_KEY_ROOT)
    snprintf(out, out_size, "the scene");
  else
    stic_key_path(key, surface, out, out_size);
  return out;
}

static void unknown_key(reading *r, stic_key parent, int surface, const yaml_node_t *name)
{
  char found[80], where[96], names[128];

  BAD(r, stic_yaml_line(name), "unknown key %s in %s; expected %s",
      stic_yaml_found(name, found, sizeof found), where_text(parent, surface, where, sizeof where),
      children_text(parent, names, sizeof names));
}

static void report_missing(reading *r, stic_key parent, int surface, const yaml_node_t *node,
                           const int64_t *seen)
{
  char path[96], expected[160];

  if (r->override)
    return; /* what the file gave still stands */
  for (stic_key key = STIC_KEY_VERSION; key < STIC_KEY_COUNT; key++) {
    const stic_key_row *row = stic_key_get(key);

    if (row->parent != parent || !row->required || seen[key] || key < STIC_KEY_SURFACE)
      continue; /* those outside surfaces may still come from --set: see report_absent() */
    origin_of(r, key, surface)->bad = true;
    BAD(r, stic_yaml_line(node), "%s is missing; expected %s", stic_key_path(key, surface, path, sizeof path),
        stic_key_expected(key, expected, sizeof expected));
  }
}

static void read_mapping(reading *r, stic_key key, int surface, const yaml_node_t *node)
{
  int64_t seen[STIC_KEY_COUNT] = {0};

  if (node->type != YAML_MAPPING_NODE) {
    char where[96], found[80];

    origin_of(r, key, surface)->bad = true;
    BAD(r, stic_yaml_line(node), "%s is %s; expected a mapping of keys",
        where_text(key, surface, where, sizeof where), stic_yaml_found(node, found, sizeof found));
    return;
  }
  for (yaml_node_pair_t *pair = node->data.mapping.pairs.start; pair < node->data.mapping.pairs.top; pair++) {
    const yaml_node_t *name = stic_yaml_node(&r->yaml, pair->key);
    const yaml_node_t *value = stic_yaml_node(&r->yaml, pair->value);
    stic_key child = STIC_KEY_ROOT;
    char path[96];

    if (name->type == YAML_SCALAR_NODE)
      child = child_named(key, (const char *)name->data.scalar.value, name->data.scalar.length);
    if (child == STIC_KEY_ROOT || child == STIC_KEY_SURFACE) {
      unknown_key(r, key, surface, name);
    } else if (seen[child]) {
      BAD(r, stic_yaml_line(name), "%s is given again, first in line %lld; expected it once",
          stic_key_path(child, surface, path, sizeof path), (long long)seen[child]);
    } else {
      seen[child] = stic_yaml_line(name);
      read_value(r, child, surface, value);
      /* A mapping in block style begins in its first key's line; its own name says more. */
      if (value->type == YAML_MAPPING_NODE && !r->override)
        origin_of(r, child, surface)->line = stic_yaml_line(name);
    }
  }
  report_missing(r, key, surface, node, seen);
}

static void surface_init(reading *r, int surface)
{
  stic_surface *s = &r->scene->surfaces[surface];

  memset(s, 0, sizeof *s);
  s->friction.mu_static = s->friction.mu_dynamic = NAN;
  memset(r->surface_origins[surface], 0, sizeof r->surface_origins[surface]);
}

static void read_surfaces(reading *r, const yaml_node_t *node)
{
  int count;

  if (node->type != YAML_SEQUENCE_NODE || stic_yaml_count(node) < 1) {
    bad_value(r, STIC_KEY_SURFACES, -1, node);
    return;
  }
  count = stic_yaml_count(node);
  if (count > STIC_SURFACES_MAX) {
    r->origins[STIC_KEY_SURFACES].bad = true;
    BAD(r, stic_yaml_line(stic_yaml_item(&r->yaml, node, STIC_SURFACES_MAX)),
        "surfaces has %d items; expected 1 to %d", count, STIC_SURFACES_MAX);
    count = STIC_SURFACES_MAX;
  }
  r->scene->surface_count = count;
  for (int i = 0; i < count; i++) {
    const yaml_node_t *surface = stic_yaml_item(&r->yaml, node, i);

    surface_init(r, i);
    r->scene->surfaces[i].line = r->override ? 0 : stic_yaml_line(surface);
    read_value(r, STIC_KEY_SURFACE, i, surface);
  }
}

static void read_value(reading *r, stic_key key, int surface, const yaml_node_t *node)
{
  origin *o = origin_of(r, key, surface);

  *o = (origin){r->override ? 0 : stic_yaml_line(node), true, false, r->override != NULL};
  switch (stic_key_get(key)->type) {
  case STIC_TYPE_MAPPING: read_mapping(r, key, surface, node); break;
  case STIC_TYPE_SURFACES: read_surfaces(r, node); break;
  case STIC_TYPE_VERSION: read_version(r, node); break;
  case STIC_TYPE_NAME: read_name(r, key, surface, node); break;
  case STIC_TYPE_NUMBERS: read_numbers_key(r, key, surface, node); break;
  case STIC_TYPE_SIZE: read_size(r, node); break;
  case STIC_TYPE_POLYGON: read_polygon(r, node); break;
  case STIC_TYPE_HOLD: read_hold(r, node); break;
  case STIC_TYPE_ELSEWHERE: break;
  }
}

/* ---- documents --------------------------------------------------------------------------- */

static void on_yaml_problem(void *context, stic_status status, int64_t line, const char *message)
{
  tell(context, false, status, line, "%s", message);
}

static void read_text(reading *r, const char *text, size_t length)
{
  const yaml_node_t *root;

  if (!stic_yaml_begin(&r->yaml, text, length))
    return;
  root = stic_yaml_root(&r->yaml);
  if (root) {
    read_value(r, STIC_KEY_ROOT, -1, root);
    stic_yaml_refuse_more(&r->yaml);
  } else {
    r->origins[STIC_KEY_ROOT].bad = true;
    BAD(r, 1, "the file is empty; expected a scene that begins with 'stiction: %d'", FORMAT_VERSION);
  }
  stic_yaml_end(&r->yaml);
}

static void read_file(reading *r, char **kept)
{
  size_t length;
  char *text = stic_yaml_read_file(&r->yaml, r->path, &length);

  if (text)
    read_text(r, text, length);
  if (kept)
    *kept = text;
  else
    free(text);
}

/* ---- overrides --------------------------------------------------------------------------- */

/* The surface that one part of a key names, by index or by name; -1: none or several. */
static int find_surface(const reading *r, const char *part, size_t length)
{
  int64_t index;
  int found = -1;

  if (stic_number_parse_integer(part, length, 0, r->scene->surface_count - 1, &index) == STIC_NUMBER_OK)
    return (int)index;
  for (int i = 0; i < r->scene->surface_count; i++) {
    const char *name = r->scene->surfaces[i].name;

    if (strlen(name) != length || memcmp(name, part, length) != 0)
      continue;
    if (found >= 0)
      return -1;
    found = i;
  }
  return found;
}

static bool find_key(reading *r, const char *text, stic_key *key, int *surface)
{
  *key = STIC_KEY_ROOT;
  *surface = -1;
  for (;;) {
    const size_t length = strcspn(text, ".");
    char part[64], where[96], names[128];

    stic_error_quote(text, length, part, sizeof part);
    if (*key == STIC_KEY_SURFACES) {
      *surface = find_surface(r, text, length);
      *key = STIC_KEY_SURFACE;
      if (*surface < 0) {
        BAD(r, 0, "no single surface '%s'; expected a name or 0 to %d", part, r->scene->surface_count - 1);
        return false;
      }
    } else {
      const stic_key parent = *key;

      *key = child_named(parent, text, length);
      if (*key == STIC_KEY_ROOT) {
        BAD(r, 0, "unknown key '%s' in %s; expected %s", part,
            where_text(parent, *surface, where, sizeof where),
            stic_key_get(parent)->type == STIC_TYPE_MAPPING ? children_text(parent, names, sizeof names)
                                                            : "nothing more");
        return false;
      }
    }
    if (!text[length])
      return true;
    text += length + 1;
  }
}

static void apply_override(reading *r)
{
  const char *value = r->override->value;
  const yaml_node_t *root;
  stic_key key;
  int surface;

  if (!find_key(r, r->override->key, &key, &surface) || !stic_yaml_begin(&r->yaml, value, strlen(value)))
    return;
  root = stic_yaml_root(&r->yaml);
  if (root)
    read_value(r, key, surface, root);
  else
    BAD(r, 0, "no value; expected KEY=VALUE");
  stic_yaml_end(&r->yaml);
}

/* ---- the whole --------------------------------------------------------------------------- */

/* Required values that neither the file nor --set gave. */
static void report_absent(reading *r)
{
  char path[96], expected[160];
  const bool shape = r->origins[STIC_KEY_SIZE].given || r->origins[STIC_KEY_POLYGON].given;

  for (stic_key key = STIC_KEY_VERSION; key < STIC_KEY_SURFACE; key++) {
    const stic_key_row *row = stic_key_get(key);
    const origin *parent = &r->origins[row->parent];

    if (!row->required || r->origins[key].given || parent->bad || !parent->given)
      continue;
    r->origins[key].bad = true;
    BAD(r, parent->line, "%s is missing; expected %s", stic_key_path(key, -1, path, sizeof path),
        stic_key_expected(key, expected, sizeof expected));
  }
  if (!shape && r->origins[STIC_KEY_OBJECT].given && !r->origins[STIC_KEY_OBJECT].bad)
    BAD(r, r->origins[STIC_KEY_OBJECT].line,
        "object.size is missing; expected size: [width, height, depth] or polygon: [[x, y], ...] with depth");
}

static void report_conflicts(reading *r)
{
  const origin *size = &r->origins[STIC_KEY_SIZE], *polygon = &r->origins[STIC_KEY_POLYGON];
  const origin *depth = &r->origins[STIC_KEY_DEPTH];

  if (size->given && polygon->given)
    BAD(r, size->line > polygon->line ? size->line : polygon->line,
        "object has both size and polygon; expected one of them");
  else if (size->given && depth->given && !depth->overridden && !size->overridden)
    BAD(r, depth->line, "object.depth beside size; expected the depth as the third number of size");
}

/* Gives each surface the scene's friction where it has none of its own. */
static void resolve_friction(reading *r)
{
  stic_scene *s = r->scene;
  const bool scene_static = !isnan(r->friction.mu_static) || r->origins[STIC_KEY_STATIC].bad;
  const bool scene_dynamic = !isnan(r->friction.mu_dynamic) || r->origins[STIC_KEY_DYNAMIC].bad;

  for (int i = 0; i < s->surface_count; i++) {
    stic_friction *f = &s->surfaces[i].friction;
    origin *o_static = origin_of(r, STIC_KEY_SURFACE_STATIC, i);
    origin *o_dynamic = origin_of(r, STIC_KEY_SURFACE_DYNAMIC, i);
    const bool lacks_static = !o_static->given && !scene_static;
    const bool lacks_dynamic = !o_dynamic->given && !scene_dynamic;

    if ((lacks_static || lacks_dynamic) && !origin_of(r, STIC_KEY_SURFACE, i)->bad &&
        !origin_of(r, STIC_KEY_SURFACE_FRICTION, i)->bad && !r->origins[STIC_KEY_FRICTION].bad) {
      BAD(r, s->surfaces[i].line,
          "surface %d has no %s friction; expected friction: {static: .., dynamic: ..} here or for the scene",
          i, lacks_static ? "static" : "dynamic");
    }
    if (!o_static->given)
      f->mu_static = r->friction.mu_static;
    if (!o_dynamic->given)
      f->mu_dynamic = r->friction.mu_dynamic;
    /* What is still unknown was told above, or where it was read. */
    o_static->bad |= isnan(f->mu_static);
    o_dynamic->bad |= isnan(f->mu_dynamic);
  }
}

/* The line to show for a finding: that of the value, else of the nearest thing around it. */
static int64_t finding_line(reading *r, stic_key key, int surface)
{
  for (; key != STIC_KEY_ROOT; key = stic_key_get(key)->parent) {
    const origin *o = origin_of(r, key, surface);

    if (o->given)
      return o->line;
  }
  return r->origins[STIC_KEY_ROOT].line;
}

static bool shape_is_known(const reading *r)
{
  const origin *size = &r->origins[STIC_KEY_SIZE], *polygon = &r->origins[STIC_KEY_POLYGON];

  return (size->given && !size->bad) || (polygon->given && !polygon->bad);
}

/* Where a whole pose is read and a surface too, whether one is inside the other can be said. */
static bool start_is_known(const reading *r, int surface)
{
  const origin *s = r->surface_origins[surface];

  for (stic_key key = STIC_KEY_POSE; key <= STIC_KEY_ANGLE; key++) {
    if (r->origins[key].bad)
      return false;
  }
  for (stic_key key = STIC_KEY_SURFACE; key <= STIC_KEY_SURFACE_NORMAL; key++) {
    if (s[key - STIC_KEY_SURFACE].bad)
      return false;
  }
  return shape_is_known(r);
}

static void on_finding(void *context, stic_key key, int index, const char *message)
{
  reading *r = context;
  int64_t line;

  if (key == STIC_KEY_POLYGON) {
    const bool box = r->origins[STIC_KEY_SIZE].given;

    if (!shape_is_known(r))
      return;
    line = box ? r->origins[STIC_KEY_SIZE].line : r->origins[STIC_KEY_POLYGON].line;
    if (!box && index >= 0 && line > 0)
      line = r->vertex_lines[index];
  } else if (key == STIC_KEY_SURFACE) {
    if (!start_is_known(r, index))
      return;
    line = r->origins[STIC_KEY_POSE].given ? r->origins[STIC_KEY_POSE].line : r->scene->surfaces[index].line;
  } else {
    const int surface = key > STIC_KEY_SURFACE ? index : -1;

    if (key < STIC_KEY_SURFACE && (r->origins[key].bad || r->origins[stic_key_get(key)->parent].bad))
      return;
    if (!r->origins[key < STIC_KEY_SURFACE ? key : STIC_KEY_SURFACES].given)
      return; /* told as missing */
    if (surface >= 0 && origin_of(r, key, surface)->bad)
      return;
    if (key == STIC_KEY_SURFACE_DYNAMIC && !origin_of(r, key, surface)->given &&
        !origin_of(r, STIC_KEY_SURFACE_STATIC, surface)->given) {
      /* The scene's pair, told once and not for every surface. */
      if (r->origins[STIC_KEY_DYNAMIC].bad)
        return;
      r->origins[STIC_KEY_DYNAMIC].bad = true;
      line = finding_line(r, STIC_KEY_DYNAMIC, -1);
    } else if (key == STIC_KEY_SURFACE_DYNAMIC && !origin_of(r, key, surface)->given) {
      line = finding_line(r, STIC_KEY_SURFACE_STATIC, surface);
    } else {
      line = finding_line(r, key, surface);
    }
  }
  BAD(r, line, "%s", message);
}

static void warn(reading *r, stic_key key, int surface, const char *text)
{
  tell(r, true, STIC_OK, finding_line(r, key, surface), "%s", text);
}

/* Things that are allowed but seldom meant. */
static void report_warnings(reading *r)
{
  const stic_scene *s = r->scene;
  bool scene_friction_used = false;

  if (stic_scene_size(s) > 10)
    warn(r, r->origins[STIC_KEY_SIZE].given ? STIC_KEY_SIZE : STIC_KEY_POLYGON, -1,
         "the object is larger than 10 m; lengths are in m, not mm");
  for (int i = 0; i < s->surface_count; i++) {
    if (!origin_of(r, STIC_KEY_SURFACE_STATIC, i)->given || !origin_of(r, STIC_KEY_SURFACE_DYNAMIC, i)->given)
      scene_friction_used = true;
    for (int j = 0; j < i; j++) {
      if (s->surfaces[i].name[0] && strcmp(s->surfaces[i].name, s->surfaces[j].name) == 0) {
        warn(r, STIC_KEY_SURFACE_NAME, i, "this surface has the name of an earlier one");
        break;
      }
    }
  }
  if (!scene_friction_used && r->origins[STIC_KEY_FRICTION].given)
    warn(r, STIC_KEY_FRICTION, -1, "friction has no effect: every surface has its own");
}

static void apply_overrides(reading *r, const stic_override *overrides, int count)
{
  for (int i = 0; i < count; i++) {
    r->override = &overrides[i];
    apply_override(r);
  }
  r->override = NULL;
}

stic_status stic_scene_read_all(const char *path, const stic_override *overrides, int override_count,
                                stic_scene *scene, char **text, stic_scene_report *report, void *context)
{
  reading *r = calloc(1, sizeof *r);
  stic_scene *draft = malloc(sizeof *draft);
  stic_status status = STIC_NO_MEMORY;
  stic_error no_memory;

  assert(path && scene && report && (overrides || override_count == 0));
  if (text)
    *text = NULL;
  if (!r || !draft) {
    stic_error_set(&no_memory, STIC_NO_MEMORY, path, 0, "out of memory");
    report(context, false, &no_memory);
    goto done;
  }
  stic_scene_init(draft);
  r->path = path;
  r->yaml.what = "scene";
  r->yaml.problem = on_yaml_problem;
  r->yaml.context = r;
  r->scene = draft;
  r->report = report;
  r->context = context;
  r->friction.mu_static = r->friction.mu_dynamic = NAN;
  read_file(r, text);
  /* After a text that is no scene at all nothing more can be said. */
  if (r->origins[STIC_KEY_ROOT].given && !r->origins[STIC_KEY_ROOT].bad) {
    apply_overrides(r, overrides, override_count);
    report_absent(r);
    report_conflicts(r);
    resolve_friction(r);
    stic_scene_examine(draft, on_finding, r);
    if (r->status == STIC_OK)
      report_warnings(r);
  }
  status = r->status;
  if (status == STIC_OK)
    *scene = *draft;
done:
  free(draft);
  free(r);
  return status;
}

typedef struct first_error {
  stic_error *err;
  bool found;
} first_error;

static void keep_first(void *context, bool warning, const stic_error *problem)
{
  first_error *first = context;

  if (warning || first->found)
    return;
  first->found = true;
  if (first->err)
    *first->err = *problem;
}

stic_status stic_scene_read_text(const char *path, const stic_override *overrides, int override_count,
                                 stic_scene *scene, char **text, stic_error *err)
{
  first_error first = {err, false};

  return stic_scene_read_all(path, overrides, override_count, scene, text, keep_first, &first);
}

stic_status stic_scene_read(const char *path, const stic_override *overrides, int override_count,
                            stic_scene *scene, stic_error *err)
{
  return stic_scene_read_text(path, overrides, override_count, scene, NULL, err);
}

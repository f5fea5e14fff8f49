#include "tracker_yaml.h"

#include "../../src/error.h"
#include "../../src/io/trace_csv.h"
#include "../../src/number.h"
#include "../../src/yaml_text.h"

#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FORMAT_VERSION 1
#define PLACE 1e6 /* m, largest coordinate, as in scenes */
#define NUMBERS_MAX 9
#define FIELD(field) offsetof(stic_tracker_settings, field)

typedef enum key {
  KEY_TRACKER,
  KEY_AXES,
  KEY_HAND_AXES,
  KEY_SCALE,
  KEY_OFFSET,
  KEY_BUTTONS,
  KEY_GRIP,
  KEY_RESET,
  KEY_CLUTCH,
  KEY_FILTER,
  KEY_MIN_CUTOFF,
  KEY_BETA,
  KEY_DERIVATIVE_CUTOFF,
  KEY_RATE,
  KEY_LINEAR,
  KEY_ANGULAR,
  KEY_DEAD_ZONE,
  KEY_AUTO_ZERO,
  KEY_HOME,
  KEY_COUNT
} key;

typedef enum key_type { TYPE_MAPPING, TYPE_NUMBERS, TYPE_AXES, TYPE_BUTTON, TYPE_SWITCH } key_type;

typedef struct key_row {
  const char *path; /* "tracker.filter.beta" */
  key parent;
  key_type type;
  size_t offset; /* of the value in stic_tracker_settings */
  int count;     /* of numbers */
  double low, high;
  bool above_low; /* `low` itself is refused */
  const char *unit;
} key_row;

static const key_row rows[KEY_COUNT] = {
  [KEY_TRACKER] = {"tracker", KEY_COUNT, TYPE_MAPPING, 0, 0, 0, 0, false, ""},
  [KEY_AXES] = {"tracker.axes", KEY_TRACKER, TYPE_AXES, FIELD(frame.axes), 9, -1, 1, false, ""},
  [KEY_HAND_AXES] = {"tracker.hand_axes", KEY_TRACKER, TYPE_AXES, FIELD(frame.hand_axes), 9, -1, 1, false,
                     ""},
  [KEY_SCALE] = {"tracker.scale", KEY_TRACKER, TYPE_NUMBERS, FIELD(frame.scale), 1, 1e-3, 1e3, false, ""},
  [KEY_OFFSET] = {"tracker.offset", KEY_TRACKER, TYPE_NUMBERS, FIELD(frame.offset), 3, -PLACE, PLACE, false,
                  "m"},
  [KEY_BUTTONS] = {"tracker.buttons", KEY_TRACKER, TYPE_MAPPING, 0, 0, 0, 0, false, ""},
  [KEY_GRIP] = {"tracker.buttons.grip", KEY_BUTTONS, TYPE_BUTTON, FIELD(frame.buttons[0]), 1, 0, 31, false,
                ""},
  [KEY_RESET] = {"tracker.buttons.reset", KEY_BUTTONS, TYPE_BUTTON, FIELD(frame.buttons[1]), 1, 0, 31, false,
                 ""},
  [KEY_CLUTCH] = {"tracker.buttons.clutch", KEY_BUTTONS, TYPE_BUTTON, FIELD(frame.buttons[2]), 1, 0, 31,
                  false, ""},
  [KEY_FILTER] = {"tracker.filter", KEY_TRACKER, TYPE_MAPPING, 0, 0, 0, 0, false, ""},
  [KEY_MIN_CUTOFF] = {"tracker.filter.min_cutoff", KEY_FILTER, TYPE_NUMBERS, FIELD(filter.min_cutoff), 2, 0,
                      1e3, true, "Hz"},
  [KEY_BETA] = {"tracker.filter.beta", KEY_FILTER, TYPE_NUMBERS, FIELD(filter.beta), 2, 0, 1e3, false, ""},
  [KEY_DERIVATIVE_CUTOFF] = {"tracker.filter.derivative_cutoff", KEY_FILTER, TYPE_NUMBERS,
                             FIELD(filter.derivative_cutoff), 2, 0, 1e3, true, "Hz"},
  [KEY_RATE] = {"tracker.rate", KEY_TRACKER, TYPE_MAPPING, 0, 0, 0, 0, false, ""},
  [KEY_LINEAR] = {"tracker.rate.linear", KEY_RATE, TYPE_NUMBERS, FIELD(rate.linear), 1, 0, 1e3, false, ""},
  [KEY_ANGULAR] = {"tracker.rate.angular", KEY_RATE, TYPE_NUMBERS, FIELD(rate.angular), 1, 0, 1e3, false, ""},
  [KEY_DEAD_ZONE] = {"tracker.rate.dead_zone", KEY_RATE, TYPE_NUMBERS, FIELD(rate.dead_zone), 2, 0, 10, false,
                     ""},
  [KEY_AUTO_ZERO] = {"tracker.rate.auto_zero", KEY_RATE, TYPE_SWITCH, FIELD(rate.auto_zero), 0, 0, 0, false,
                     ""},
  [KEY_HOME] = {"tracker.rate.home", KEY_RATE, TYPE_NUMBERS, FIELD(rate.home_position), 3, -PLACE, PLACE,
                false, "m"},
};

typedef struct reading {
  stic_yaml yaml;
  const char *path;
  stic_tracker_settings *settings;
  int64_t lines[KEY_COUNT]; /* where each was given, 0: nowhere */
  stic_status status;       /* of the first problem, which `err` tells */
  stic_error *err;
} reading;

void stic_tracker_settings_init(stic_tracker_settings *settings)
{
  stic_tracker_frame_init(&settings->frame);
  settings->filtered = false;
  stic_one_euro_settings_init(&settings->filter);
  stic_rate_settings_init(&settings->rate);
  settings->rate.clutch = STIC_BUTTON_CLUTCH;
  settings->rate.reset = STIC_BUTTON_RESET;
}

/* ---- telling ----------------------------------------------------------------------------- */

static void on_problem(void *context, stic_status status, int64_t line, const char *message)
{
  reading *r = context;

  if (r->status == STIC_OK)
    r->status = stic_error_set(r->err, status, r->path, line, "%s", message);
}

static void bad(reading *r, int64_t line, const char *format, ...) STIC_PRINTF(3, 4);

static void bad(reading *r, int64_t line, const char *format, ...)
{
  char message[480];
  va_list args;

  va_start(args, format);
  vsnprintf(message, sizeof message, format, args);
  va_end(args);
  on_problem(r, STIC_BAD_INPUT, line, message);
}

static const char *expected_text(const key_row *row, char *out, size_t out_size)
{
  char range[64];

  stic_number_range_text(row->low, row->high, row->above_low, row->unit, range, sizeof range);
  switch (row->type) {
  case TYPE_MAPPING: snprintf(out, out_size, "a mapping of keys"); break;
  case TYPE_NUMBERS:
    if (row->count == 1)
      snprintf(out, out_size, "a number %s", range);
    else
      snprintf(out, out_size, "a list of %d numbers, each %s", row->count, range);
    break;
  case TYPE_AXES:
    snprintf(out, out_size,
             "three of x, y, z, -x, -y, -z, or nine numbers row by row, that make a rotation and no mirror");
    break;
  case TYPE_BUTTON: snprintf(out, out_size, "a bit from 0 to 31, or none"); break;
  case TYPE_SWITCH: snprintf(out, out_size, "true or false"); break;
  }
  return out;
}

static void bad_value(reading *r, key k, const yaml_node_t *node)
{
  char found[80], expected[160];

  bad(r, stic_yaml_line(node), "%s is %s; expected %s", rows[k].path,
      stic_yaml_found(node, found, sizeof found), expected_text(&rows[k], expected, sizeof expected));
}

/* ---- values ------------------------------------------------------------------------------ */

static void *place(reading *r, key k)
{
  return (char *)r->settings + rows[k].offset;
}

static bool in_range(const key_row *row, double v)
{
  return v >= row->low && v <= row->high && !(row->above_low && v == row->low);
}

static void read_numbers(reading *r, key k, const yaml_node_t *node)
{
  const key_row *row = &rows[k];
  double values[NUMBERS_MAX];

  if (row->count > 1 && (node->type != YAML_SEQUENCE_NODE || stic_yaml_count(node) != row->count)) {
    bad_value(r, k, node);
    return;
  }
  for (int i = 0; i < row->count; i++) {
    const yaml_node_t *number = row->count > 1 ? stic_yaml_item(&r->yaml, node, i) : node;

    if (!stic_yaml_number(number, &values[i]) || !in_range(row, values[i])) {
      bad_value(r, k, number);
      return;
    }
  }
  memcpy(place(r, k), values, (size_t)row->count * sizeof values[0]);
}

static bool is_text(const yaml_node_t *node, const char *text)
{
  return node->type == YAML_SCALAR_NODE && strcmp((const char *)node->data.scalar.value, text) == 0;
}

/* One row of the matrix from "x" ... "-z". */
static bool read_axis(const yaml_node_t *node, double row[3])
{
  static const char *const names[6] = {"x", "y", "z", "-x", "-y", "-z"};

  for (int i = 0; i < 6; i++) {
    if (is_text(node, names[i])) {
      row[0] = row[1] = row[2] = 0;
      row[i % 3] = i < 3 ? 1 : -1;
      return true;
    }
  }
  return false;
}

/* `hand_axes` names the hand's axes in the moving part's, which are the matrix's columns. */
static void transpose(double m[9])
{
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < i; j++) {
      const double kept = m[3 * i + j];

      m[3 * i + j] = m[3 * j + i];
      m[3 * j + i] = kept;
    }
  }
}

static void read_axes(reading *r, key k, const yaml_node_t *node)
{
  double *m = place(r, k);
  bool good = node->type == YAML_SEQUENCE_NODE && (stic_yaml_count(node) == 3 || stic_yaml_count(node) == 9);
  const bool named = good && stic_yaml_count(node) == 3;

  for (int i = 0; good && i < stic_yaml_count(node); i++) {
    const yaml_node_t *item = stic_yaml_item(&r->yaml, node, i);

    good = named ? read_axis(item, m + 3 * i) : stic_yaml_number(item, &m[i]);
    if (!good) {
      bad_value(r, k, item);
      return;
    }
  }
  if (!good || !stic_is_proper_rotation(m))
    bad_value(r, k, node);
  else if (named && k == KEY_HAND_AXES)
    transpose(m);
}

static void read_button(reading *r, key k, const yaml_node_t *node)
{
  int *bit = place(r, k);
  const char *text = node->type == YAML_SCALAR_NODE ? (const char *)node->data.scalar.value : "";
  int64_t value;

  if (is_text(node, "none"))
    *bit = -1;
  else if (stic_number_parse_integer(text, strlen(text), 0, 31, &value) == STIC_NUMBER_OK)
    *bit = (int)value;
  else
    bad_value(r, k, node);
}

static void read_switch(reading *r, key k, const yaml_node_t *node)
{
  if (!is_text(node, "true") && !is_text(node, "false"))
    bad_value(r, k, node);
  *(bool *)place(r, k) = is_text(node, "true");
}

/* ---- structure --------------------------------------------------------------------------- */

static const char *last_name(key k)
{
  const char *dot = strrchr(rows[k].path, '.');

  return dot ? dot + 1 : rows[k].path;
}

static key child_named(key parent, const yaml_node_t *name)
{
  for (key k = KEY_TRACKER; k < KEY_COUNT; k++) {
    if (rows[k].parent == parent && is_text(name, last_name(k)))
      return k;
  }
  return KEY_COUNT;
}

static void unknown_key(reading *r, key parent, const yaml_node_t *name)
{
  char found[80], names[160] = "";
  size_t used = 0;

  for (key k = KEY_TRACKER; k < KEY_COUNT && used < sizeof names; k++) {
    if (rows[k].parent == parent)
      used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", used > 0 ? ", " : "", last_name(k));
  }
  bad(r, stic_yaml_line(name), "unknown key %s in %s; expected %s",
      stic_yaml_found(name, found, sizeof found), rows[parent].path, names);
}

static void read_value(reading *r, key k, const yaml_node_t *node);

static void read_child(reading *r, key k, const yaml_node_t *name, const yaml_node_t *value)
{
  if (r->lines[k]) {
    bad(r, stic_yaml_line(name), "%s is given again, first in line %lld; expected it once", rows[k].path,
        (long long)r->lines[k]);
    return;
  }
  r->lines[k] = stic_yaml_line(name);
  read_value(r, k, value);
}

static void read_mapping(reading *r, key k, const yaml_node_t *node)
{
  if (node->type != YAML_MAPPING_NODE) {
    bad_value(r, k, node);
    return;
  }
  for (const yaml_node_pair_t *pair = node->data.mapping.pairs.start; pair < node->data.mapping.pairs.top;
       pair++) {
    const yaml_node_t *name = stic_yaml_node(&r->yaml, pair->key);
    const key child = child_named(k, name);

    if (child == KEY_COUNT)
      unknown_key(r, k, name);
    else
      read_child(r, child, name, stic_yaml_node(&r->yaml, pair->value));
  }
}

static void read_value(reading *r, key k, const yaml_node_t *node)
{
  switch (rows[k].type) {
  case TYPE_MAPPING: read_mapping(r, k, node); break;
  case TYPE_NUMBERS: read_numbers(r, k, node); break;
  case TYPE_AXES: read_axes(r, k, node); break;
  case TYPE_BUTTON: read_button(r, k, node); break;
  case TYPE_SWITCH: read_switch(r, k, node); break;
  }
}

static void read_version(reading *r, const yaml_node_t *node)
{
  char found[80];

  if (!is_text(node, "1"))
    bad(r, stic_yaml_line(node), "stiction is %s; expected the format version, %d",
        stic_yaml_found(node, found, sizeof found), FORMAT_VERSION);
}

/* The file's own mapping: what is not ours belongs to the scene. */
static void read_root(reading *r, const yaml_node_t *root)
{
  bool versioned = false;

  if (root->type != YAML_MAPPING_NODE) {
    bad(r, stic_yaml_line(root), "expected a mapping with stiction: %d and tracker:", FORMAT_VERSION);
    return;
  }
  for (const yaml_node_pair_t *pair = root->data.mapping.pairs.start; pair < root->data.mapping.pairs.top;
       pair++) {
    const yaml_node_t *name = stic_yaml_node(&r->yaml, pair->key),
                      *value = stic_yaml_node(&r->yaml, pair->value);

    if (is_text(name, "stiction")) {
      versioned = true;
      read_version(r, value);
    } else if (is_text(name, rows[KEY_TRACKER].path)) {
      read_child(r, KEY_TRACKER, name, value);
    }
  }
  if (!versioned)
    bad(r, stic_yaml_line(root), "stiction is missing; expected the format version, %d", FORMAT_VERSION);
}

static void read_text(reading *r, const char *text, size_t length, bool required)
{
  const yaml_node_t *root;

  if (!stic_yaml_begin(&r->yaml, text, length))
    return;
  root = stic_yaml_root(&r->yaml);
  if (root)
    read_root(r, root);
  if (required && !r->lines[KEY_TRACKER])
    bad(r, 1, "there is no tracker section; expected tracker: with %s ...", last_name(KEY_AXES));
  if (root)
    stic_yaml_refuse_more(&r->yaml);
  stic_yaml_end(&r->yaml);
}

static void complete(reading *r)
{
  stic_tracker_frame *frame = &r->settings->frame;

  r->settings->filtered = r->lines[KEY_FILTER] != 0;
  if (!r->lines[KEY_HAND_AXES]) {
    memcpy(frame->hand_axes, frame->axes, sizeof frame->axes);
    transpose(frame->hand_axes);
  }
}

stic_status stic_tracker_read(const char *path, const char *text, bool required,
                              stic_tracker_settings *settings, stic_error *err)
{
  reading r;
  char *own = NULL;
  size_t length = text ? strlen(text) : 0;

  assert(path && settings);
  memset(&r, 0, sizeof r);
  r.yaml.what = "tracker";
  r.yaml.problem = on_problem;
  r.yaml.context = &r;
  r.path = path;
  r.settings = settings;
  r.err = err;
  stic_tracker_settings_init(settings);
  if (!text)
    text = own = stic_yaml_read_file(&r.yaml, path, &length);
  if (text)
    read_text(&r, text, length, required);
  free(own);
  if (r.status == STIC_OK)
    complete(&r);
  else
    stic_tracker_settings_init(settings);
  return r.status;
}

/* ---- the way of a sample ----------------------------------------------------------------- */

void stic_tracker_begin(stic_tracker *t, const stic_tracker_settings *settings, stic_driver_kind kind)
{
  t->settings = *settings;
  t->rate = kind == STIC_DRIVER_RATE;
  stic_rate_begin(&t->integrator, &settings->rate);
  stic_one_euro_begin(&t->filter, &settings->filter);
}

void stic_tracker_apply(stic_tracker *t, stic_device_sample *sample)
{
  /* A rate device has no pose of its own to be brought into the room; it starts at home there. */
  stic_tracker_frame_apply(&t->settings.frame, sample);
  if (t->rate)
    stic_rate_apply(&t->integrator, sample);
  if (t->settings.filtered)
    stic_one_euro_apply(&t->filter, sample);
}

bool stic_tracker_solvable(const stic_device_sample *from, stic_sample *to)
{
  const unsigned known = STIC_SAMPLE_POSITION | STIC_SAMPLE_ORIENTATION;

  if ((from->flags & known) != known)
    return false;
  memset(to, 0, sizeof *to);
  memcpy(to->position, from->position, sizeof to->position);
  memcpy(to->orientation, from->orientation, sizeof to->orientation);
  to->buttons = from->buttons & ~STIC_TRACE_BUTTON_LOST;
  to->lost = !(from->flags & STIC_SAMPLE_TRACKED);
  return true;
}

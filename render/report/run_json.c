/* What the page knows of the run, as JSON: scene, settings, files, version. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "../../src/error.h"
#include "../../src/io/json.h"
#include "../../src/io/sha256.h"
#include "report_data.h"

static json_t *text_json(const char *text)
{
  char *clean = stic_utf8_clean(text, strlen(text));
  json_t *json = clean ? json_string(clean) : NULL;

  free(clean);
  return json;
}

static json_t *point_json(const double point[2])
{
  return json_pack("[f, f]", point[0], point[1]);
}

static json_t *surface_json(const stic_surface *s)
{
  double normal[2];

  stic_normal_from_degrees(s->normal_deg, normal);
  return json_pack("{s:o, s:o, s:o, s:f, s:f, s:f}", "name", text_json(s->name), "point",
                   point_json(s->point), "normal", point_json(normal), "normal_deg", s->normal_deg,
                   "mu_static", s->friction.mu_static, "mu_dynamic", s->friction.mu_dynamic);
}

static json_t *scene_json(const stic_scene *s)
{
  json_t *vertices = json_array(), *surfaces = json_array();

  for (int i = 0; i < s->vertex_count; i++)
    vertices = stic_json_append(vertices, point_json(s->vertices[i]));
  for (int i = 0; i < s->surface_count; i++)
    surfaces = stic_json_append(surfaces, surface_json(&s->surfaces[i]));
  return json_pack("{s:o, s:o, s:o, s:f, s:f, s:f, s:s, s:o, s:f}", "name", text_json(s->name), "vertices",
                   vertices, "surfaces", surfaces, "depth", s->depth, "stiffness", s->stiffness,
                   "rotational_stiffness", s->rotational_stiffness, "hold",
                   s->hold == STIC_HOLD_START ? "start" : "button", "holding_point",
                   point_json(s->holding_point), "reach", s->reach);
}

static json_t *solver_json(const stic_report_settings *s)
{
  json_t *set = json_array();
  char accuracy[32], text[512];

  stic_settings_accuracy_text(s->solver, accuracy, sizeof accuracy);
  for (int i = 0; i < s->override_count; i++) {
    snprintf(text, sizeof text, "%s=%s", s->overrides[i].key, s->overrides[i].value);
    set = stic_json_append(set, text_json(text));
  }
  return json_pack("{s:s, s:s, s:f, s:o}", "accuracy", accuracy, "precision",
                   stic_precision_name(s->solver->precision), "h_min", s->solver->h_min, "set", set);
}

/* SHA-256 of a regular file; "" for all else, which cannot be read again. */
static stic_status hash_file(const char *path, char text[STIC_SHA256_TEXT], stic_error *err)
{
  unsigned char bytes[16384];
  struct stat st;
  stic_sha256 sha;
  size_t n;
  FILE *file;
  bool bad;

  text[0] = '\0';
  if (stat(path, &st) != 0 || !S_ISREG(st.st_mode))
    return STIC_OK;
  file = fopen(path, "rb");
  stic_sha256_begin(&sha);
  while (file && (n = fread(bytes, 1, sizeof bytes, file)) > 0)
    stic_sha256_add(&sha, bytes, n);
  bad = !file || ferror(file);
  if (file)
    fclose(file);
  if (bad)
    return stic_error_set(err, STIC_BAD_INPUT, path, 0, "cannot read: %s", strerror(errno));
  stic_sha256_end(&sha, text);
  return STIC_OK;
}

static json_t *columns_json(const stic_report *r)
{
  static const char *const names[] = {
#define X(name, kind) #name, kind,
    STIC_REPORT_COLUMNS(X)
#undef X
  };
  json_t *list = json_array();

  for (int i = 0; i < STIC_REPORT_COLUMN_COUNT; i++)
    list = stic_json_append(
      list, json_pack("[s, s, I]", names[2 * i], names[2 * i + 1], (json_int_t)r->columns[i].size));
  return list;
}

static json_t *timing_json(const stic_timing *timing)
{
  static const char *const names[] = {"read", "collide", "solve", "render", "encode", "write", "frame"};
  json_t *stages;
  char machine[512];

  if (!timing)
    return json_null();
  stages = json_array();
  for (int i = 0; i <= STIC_STAGE_FRAME; i++) {
    const stic_histogram *h = &timing->stages[i];

    if (h->count > 0)
      stages = stic_json_append(
        stages, json_pack("{s:s, s:I, s:I, s:I, s:I, s:I}", "name", names[i], "count", (json_int_t)h->count,
                          "p50", (json_int_t)stic_histogram_quantile(h, 0.5), "p99",
                          (json_int_t)stic_histogram_quantile(h, 0.99), "p999",
                          (json_int_t)stic_histogram_quantile(h, 0.999), "max", (json_int_t)h->max_ns));
  }
  return json_pack("{s:i, s:I, s:o, s:o}", "target_hz", STIC_TARGET_HZ, "missed", (json_int_t)timing->missed,
                   "machine", text_json(stic_machine_text(machine, sizeof machine)), "stages", stages);
}

static json_t *video_json(const stic_report_video *video)
{
  if (!video->path)
    return json_pack("{s:n, s:o}", "mime", "why", text_json(video->why ? video->why : ""));
  return json_pack("{s:s, s:I}", "mime", video->mime, "size", (json_int_t)video->size);
}

static json_t *names_json(int count, const char *(*name)(int))
{
  json_t *list = json_array();

  for (int i = 0; i < count; i++)
    list = stic_json_append(list, json_string(name(i)));
  return list;
}

static const char *state_name(int state)
{
  return stic_state_name((stic_state)state);
}

static const char *event_name(int kind)
{
  return stic_event_name((stic_event_kind)kind);
}

static json_t *run_json(const stic_report *r, const stic_report_video *video, const stic_timing *timing,
                        const char *sha256)
{
  const stic_report_settings *s = &r->settings;

  return json_pack(
    "{s:s, s:o, s:o, s:s, s:o, s:s, s:o, s:o, s:o, s:o, s:i, s:I, s:I, s:f, s:f, s:o, s:o, s:o, s:o}",
    "version", stic_version(), "command", text_json(s->command), "scene_path", text_json(s->scene_path),
    "scene_text", r->scene_text, "input", text_json(s->input), "input_kind", s->input_kind, "sha256",
    json_string(sha256), "solver", solver_json(s), "scene", scene_json(s->scene), "video", video_json(video),
    "fps", s->fps, "rows", (json_int_t)r->rows, "events", (json_int_t)r->events, "start",
    (double)r->first_ns / 1e9, "seconds", (double)(r->last_ns - r->first_ns) / 1e9, "timing",
    timing_json(timing), "columns", columns_json(r), "states", names_json(STIC_MULTI + 1, state_name),
    "kinds", names_json(STIC_EVENT_RELEASE + 1, event_name));
}

/* "<" could end the script element that holds the text; it only occurs inside of strings. */
static char *escape_markup(const char *text)
{
  size_t count = 0;
  char *escaped, *at;

  for (const char *c = text; *c; c++)
    count += *c == '<';
  at = escaped = malloc(strlen(text) + 5 * count + 1);
  for (const char *c = text; escaped && *c; c++) {
    if (*c == '<') {
      memcpy(at, "\\u003c", 6);
      at += 6;
    } else {
      *at++ = *c;
    }
  }
  if (escaped)
    *at = '\0';
  return escaped;
}

stic_status stic_report_json(const stic_report *r, const stic_report_video *video, const stic_timing *timing,
                             char **json, stic_error *err)
{
  char sha256[STIC_SHA256_TEXT] = "";
  const bool is_file = strcmp(r->settings.input_kind, "trace") == 0 && strcmp(r->settings.input, "-") != 0;
  stic_status status = is_file ? hash_file(r->settings.input, sha256, err) : STIC_OK;
  json_t *run;
  char *text;

  *json = NULL;
  if (status != STIC_OK)
    return status;
  run = run_json(r, video, timing, sha256);
  text = stic_json_text(run, JSON_COMPACT);
  json_decref(run);
  *json = text ? escape_markup(text) : NULL;
  free(text);
  return *json ? STIC_OK : stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
}

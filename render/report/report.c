#include "report.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "../../src/error.h"
#include "report_data.h"

/* ---- gathering ----------------------------------------------------------------------------- */

/* A hidden name in the page's folder; none for a page that goes to a pipe. False without memory. */
static bool choose_video_path(stic_report *r)
{
  const char *path = r->settings.path, *slash = strrchr(path, '/');
  const char *name = slash ? slash + 1 : path;
  const size_t room = strlen(path) + 48;
  struct stat st;

  if (strcmp(path, "-") == 0 || (stat(path, &st) == 0 && !S_ISREG(st.st_mode)))
    return true;
  r->video_path = malloc(room);
  if (r->video_path)
    snprintf(r->video_path, room, "%.*s.%.200s.%ld.mp4", (int)(name - path), path, name, (long)getpid());
  return r->video_path != NULL;
}

stic_status stic_report_open(const stic_report_settings *settings, stic_report **report, stic_error *err)
{
  stic_report *r = calloc(1, sizeof *r);
  stic_status status;

  *report = NULL;
  assert(settings->path && settings->scene && settings->solver && settings->fps > 0);
  if (r) {
    r->settings = *settings;
    r->scene_text = stic_utf8_clean(settings->scene_text, strlen(settings->scene_text));
  }
  if (!r || !r->scene_text || !choose_video_path(r))
    status = stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  else
    status = stic_outfile_open(settings->path, &r->out, err);
  if (status != STIC_OK) {
    stic_report_close(r);
    return status;
  }
  *report = r;
  return STIC_OK;
}

const char *stic_report_video_path(const stic_report *report)
{
  return report->video_path;
}

#define COLUMN(r, name) (&(r)->columns[STIC_REPORT_##name])

static void add_contacts(stic_report *r, const stic_result *result)
{
  for (int i = 0; i < result->contact_count; i++) {
    const stic_contact *c = &result->contacts[i];

    stic_column_integer(COLUMN(r, c_vertex), c->vertex, 1);
    stic_column_integer(COLUMN(r, c_surface), c->surface, 1);
    stic_column_f32(COLUMN(r, c_x), c->x);
    stic_column_f32(COLUMN(r, c_y), c->y);
    stic_column_f32(COLUMN(r, c_normal), c->normal);
    stic_column_f32(COLUMN(r, c_friction), c->friction);
  }
}

static void add_event(stic_report *r, const stic_event *e)
{
  stic_column_f64(COLUMN(r, e_t), e->t - (double)r->first_ns / 1e9);
  stic_column_integer(COLUMN(r, e_kind), e->kind, 1);
  stic_column_integer(COLUMN(r, e_vertex), e->vertex, 2);
  stic_column_integer(COLUMN(r, e_surface), e->surface, 2);
  stic_column_f32(COLUMN(r, e_x), e->x);
  stic_column_f32(COLUMN(r, e_y), e->y);
  stic_column_f32(COLUMN(r, e_length), e->length);
}

void stic_report_add(stic_report *r, const stic_result *result, const stic_event *events, int count,
                     int64_t frame_ns)
{
  if (r->rows == 0)
    r->first_ns = result->t_ns;
  r->last_ns = result->t_ns;
  r->rows++;
  r->events += count;
  stic_column_f64(COLUMN(r, t), (double)(result->t_ns - r->first_ns) / 1e9);
  stic_column_f32(COLUMN(r, x), result->x);
  stic_column_f32(COLUMN(r, y), result->y);
  stic_column_f32(COLUMN(r, theta), result->theta);
  stic_column_f32(COLUMN(r, hand_x), result->hand_x);
  stic_column_f32(COLUMN(r, hand_y), result->hand_y);
  stic_column_f32(COLUMN(r, hand_theta), result->hand_theta);
  stic_column_f32(COLUMN(r, hold_x), result->holding_x);
  stic_column_f32(COLUMN(r, hold_y), result->holding_y);
  stic_column_f32(COLUMN(r, force_x), result->force_x);
  stic_column_f32(COLUMN(r, force_y), result->force_y);
  stic_column_f32(COLUMN(r, moment), result->moment);
  stic_column_integer(COLUMN(r, slips), result->slips, 4);
  stic_column_integer(COLUMN(r, state), result->state, 1);
  stic_column_integer(COLUMN(r, flags), (int64_t)result->flags, 1);
  stic_column_integer(COLUMN(r, contacts), result->contact_count, 1);
  if (frame_ns > 0)
    stic_column_f32(COLUMN(r, frame_us), (double)frame_ns / 1e3);
  add_contacts(r, result);
  for (int i = 0; i < count; i++)
    add_event(r, &events[i]);
}

/* ---- writing ------------------------------------------------------------------------------- */

/* What the parts of the page need. */
typedef struct page_context {
  const stic_report *report;
  const char *json;
  FILE *video; /* NULL: none */
  bool video_failed;
} page_context;

/* All columns, one after the other, each filled up to whole 8 bytes. */
static void write_data(const stic_report *r, stic_outfile *out)
{
  static const unsigned char zeros[8];
  stic_base64 state = {{0}, 0};

  for (int i = 0; i < STIC_REPORT_COLUMN_COUNT; i++) {
    stic_base64_add(&state, r->columns[i].bytes, r->columns[i].size, out);
    stic_base64_add(&state, zeros, (8 - r->columns[i].size % 8) % 8, out);
  }
  stic_base64_end(&state, out);
}

static void write_video(page_context *c, stic_outfile *out)
{
  unsigned char bytes[16384];
  stic_base64 state = {{0}, 0};
  size_t n;

  while (c->video && (n = fread(bytes, 1, sizeof bytes, c->video)) > 0)
    stic_base64_add(&state, bytes, n, out);
  c->video_failed = c->video && ferror(c->video);
  stic_base64_end(&state, out);
}

static void write_title(const stic_report *r, stic_outfile *out)
{
  const char *name = r->settings.scene->name, *slash = strrchr(r->settings.scene_path, '/');

  stic_page_text(out, *name ? name : slash ? slash + 1 : r->settings.scene_path);
}

static bool write_part(void *user, const char *name, stic_outfile *out)
{
  page_context *c = user;

  if (strcmp(name, "title") == 0)
    write_title(c->report, out);
  else if (strcmp(name, "run") == 0)
    stic_outfile_write(out, c->json, strlen(c->json));
  else if (strcmp(name, "data") == 0)
    write_data(c->report, out);
  else if (strcmp(name, "video") == 0)
    write_video(c, out);
  else
    return false;
  return true;
}

static bool ends_with(const char *text, const char *end)
{
  const size_t length = strlen(text), tail = strlen(end);

  return length >= tail && strcmp(text + length - tail, end) == 0;
}

/* Looks at the video; one that a page cannot hold is left out with a reason. */
static stic_status look_at_video(stic_report_video *v, stic_error *err)
{
  struct stat st;

  if (!v->path)
    return STIC_OK;
  if (stat(v->path, &st) != 0)
    return stic_error_set(err, STIC_BAD_INPUT, v->path, 0, "cannot read: %s", strerror(errno));
  v->size = (int64_t)st.st_size;
  v->mime = ends_with(v->path, ".webm") ? "video/webm" : ends_with(v->path, ".mp4") ? "video/mp4" : NULL;
  if (!v->mime)
    v->why = "no browser shows this kind of video";
  else if (v->size > STIC_REPORT_VIDEO_MAX)
    v->why = "the video is too large for a page";
  if (v->why)
    v->path = NULL;
  return STIC_OK;
}

static bool out_of_memory(const stic_report *r)
{
  for (int i = 0; i < STIC_REPORT_COLUMN_COUNT; i++) {
    if (r->columns[i].failed)
      return true;
  }
  return false;
}

stic_status stic_report_finish(stic_report *r, const char *video, const char *why_no_video,
                               const stic_timing *timing, stic_error *err)
{
  stic_report_video v = {video, video ? NULL : why_no_video, NULL, 0};
  page_context context = {r, NULL, NULL, false};
  stic_status status = look_at_video(&v, err);
  char *json = NULL;

  if (status == STIC_OK && out_of_memory(r))
    status = stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  if (status == STIC_OK)
    status = stic_report_json(r, &v, timing, &json, err);
  if (status == STIC_OK && v.path && !(context.video = fopen(v.path, "rb")))
    status = stic_error_set(err, STIC_BAD_INPUT, v.path, 0, "cannot read: %s", strerror(errno));
  if (status == STIC_OK) {
    context.json = json;
    stic_page_write(r->out, "page.html", write_part, &context);
    stic_outfile_flush(r->out);
    if (context.video_failed)
      status = stic_error_set(err, STIC_BAD_INPUT, v.path, 0, "cannot read the video");
  }
  if (context.video)
    fclose(context.video);
  free(json);
  return status;
}

stic_status stic_report_keep(stic_report *r, stic_error *err)
{
  stic_outfile *out = r->out;

  r->out = NULL;
  return stic_outfile_commit(out, err);
}

void stic_report_close(stic_report *r)
{
  if (!r)
    return;
  stic_outfile_abort(r->out);
  if (r->video_path)
    unlink(r->video_path);
  for (int i = 0; i < STIC_REPORT_COLUMN_COUNT; i++)
    stic_column_free(&r->columns[i]);
  free(r->video_path);
  free(r->scene_text);
  free(r);
}

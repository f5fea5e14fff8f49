#include "render.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clock.h"
#include "error.h"
#include "hud.h"
#include "submit.h"

struct stic_render {
  stic_scene scene;
  stic_gl gl;
  stic_submit submit;
  stic_view view;
  stic_hud hud;
  stic_history history;
  stic_mesh stage, actors;
  stic_labels labels; /* first those that stay, then those of the newest result */
  int stage_labels;
  stic_rect areas[STIC_LABELS_MAX]; /* of the labels, px of the picture */
  stic_rect drawn;                  /* px of the view: where the last picture differs from the bare stage */
  bool stage_valid;
  bool noted;         /* the last picture has a note */
  double force_full;  /* N, of the scale bar in the picture */
  stic_canvas canvas; /* pixels owned */
  float matrix[16];
  stic_render_times times;
  char rasteriser[272];
};

void stic_render_settings_init(stic_render_settings *s)
{
  memset(s, 0, sizeof *s);
  s->width = 1280;
  s->height = 720;
  s->quality = STIC_QUALITY_GOOD;
}

stic_status stic_render_settings_validate(const stic_render_settings *s, stic_error *err)
{
  if (s->width < STIC_PICTURE_WIDTH_MIN || s->height < STIC_PICTURE_HEIGHT_MIN ||
      s->width > STIC_PICTURE_SIZE_MAX || s->height > STIC_PICTURE_SIZE_MAX || s->width % 2 || s->height % 2)
    return stic_error_set(err, STIC_USAGE, NULL, 0,
                          "a picture cannot be %d x %d; expected even numbers from %d x %d to %d x %d",
                          s->width, s->height, STIC_PICTURE_WIDTH_MIN, STIC_PICTURE_HEIGHT_MIN,
                          STIC_PICTURE_SIZE_MAX, STIC_PICTURE_SIZE_MAX);
  if ((unsigned)s->look > STIC_LOOK_DARK || (unsigned)s->camera > STIC_CAMERA_FOLLOW ||
      (unsigned)s->quality > STIC_QUALITY_BEST || (unsigned)s->plot > STIC_PLOT_ANGLE ||
      (unsigned)s->backend > STIC_GL_EGL)
    return stic_error_set(err, STIC_USAGE, NULL, 0, "a picture setting has a value that does not exist");
  return STIC_OK;
}

/* The index of a name in a list that ends with NULL, or -1. */
static int index_of(const char *name, const char *const *names)
{
  for (int i = 0; names[i]; i++) {
    if (!strcmp(name, names[i]))
      return i;
  }
  return -1;
}

bool stic_look_from_name(const char *name, stic_look *look)
{
  static const char *const names[] = {"light", "dark", NULL};
  int i = index_of(name, names);

  if (i >= 0)
    *look = (stic_look)i;
  return i >= 0;
}

bool stic_camera_from_name(const char *name, stic_camera_preset *camera)
{
  static const char *const names[] = {"three-quarter", "front", "follow", NULL};
  int i = index_of(name, names);

  if (i >= 0)
    *camera = (stic_camera_preset)i;
  return i >= 0;
}

bool stic_quality_from_name(const char *name, stic_quality *quality)
{
  static const char *const names[] = {"fast", "good", "best", NULL};
  int i = index_of(name, names);

  if (i >= 0)
    *quality = (stic_quality)i;
  return i >= 0;
}

bool stic_plot_from_name(const char *name, stic_plot *plot)
{
  static const char *const names[] = {"auto", "x", "y", "angle", NULL};
  int i = index_of(name, names);

  if (i >= 0)
    *plot = (stic_plot)i;
  return i >= 0;
}

static int samples_of(stic_quality quality)
{
  return quality == STIC_QUALITY_FAST ? 1 : quality == STIC_QUALITY_GOOD ? 2 : 4;
}

/* All parts but OpenGL's. */
static bool make_parts(stic_render *r, const stic_render_settings *settings)
{
  const stic_theme *theme = settings->look == STIC_LOOK_DARK ? &stic_theme_dark : &stic_theme_light;

  if (!stic_hud_init(&r->hud, settings, &r->scene, theme) ||
      !stic_view_init(&r->view, &r->scene, settings, theme, settings->width,
                      r->hud.view_bottom - r->hud.view_top))
    return false;
  r->history.size = r->view.size;
  r->canvas.width = settings->width;
  r->canvas.height = settings->height;
  r->canvas.pixels = malloc((size_t)settings->width * (size_t)settings->height * 4);
  return r->canvas.pixels != NULL;
}

stic_status stic_render_create(const stic_scene *scene, const stic_render_settings *settings,
                               stic_render **render, stic_error *err)
{
  stic_status status = stic_render_settings_validate(settings, err);
  stic_render *r;

  *render = NULL;
  if (status)
    return status;
  r = calloc(1, sizeof *r);
  if (r)
    r->scene = *scene;
  if (!r || !make_parts(r, settings)) {
    stic_render_destroy(r);
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "no memory for pictures of %d x %d", settings->width,
                          settings->height);
  }
  status = stic_gl_open(&r->gl, settings->backend, settings->osmesa_library, err);
  if (!status)
    status =
      stic_submit_init(&r->submit, &r->gl, r->view.width, r->view.height, samples_of(settings->quality), err);
  if (status) {
    stic_render_destroy(r);
    return status;
  }
  snprintf(r->rasteriser, sizeof r->rasteriser, "%s, %s", r->gl.renderer, r->gl.version);
  *render = r;
  return STIC_OK;
}

void stic_render_destroy(stic_render *r)
{
  if (!r)
    return;
  if (r->gl.context && stic_gl_make_current(&r->gl))
    stic_submit_free(&r->submit);
  stic_gl_close(&r->gl);
  stic_mesh_free(&r->stage);
  stic_mesh_free(&r->actors);
  stic_view_free(&r->view);
  stic_hud_free(&r->hud);
  free(r->canvas.pixels);
  free(r);
}

const char *stic_render_rasteriser(const stic_render *r)
{
  return r->rasteriser;
}

void stic_render_observe(stic_render *r, const stic_result *result)
{
  stic_history_add(&r->history, result);
}

void stic_render_set_note(stic_render *r, const char *note)
{
  snprintf(r->hud.note, sizeof r->hud.note, "%s", note ? note : "");
}

void stic_render_set_trails(stic_render *r, bool shown)
{
  r->view.no_trails = !shown;
}

void stic_render_continue(stic_render *r, const stic_render *from)
{
  r->history = from->history;
  stic_view_continue(&r->view, &from->view);
}

void stic_render_forget(stic_render *r)
{
  memset(&r->history, 0, sizeof r->history);
  r->history.size = r->view.size;
}

stic_rect stic_render_scene_area(const stic_render *r)
{
  return (stic_rect){0, r->hud.view_top, r->view.width, r->hud.view_bottom};
}

void stic_render_ray(const stic_render *r, const double pixel[2], double eye[3], double through[3])
{
  const double at[2] = {fmin(fmax(pixel[0], 0), r->view.width),
                        fmin(fmax(pixel[1] - r->hud.view_top, 0), r->view.height)};

  memcpy(eye, r->view.camera.eye, sizeof r->view.camera.eye);
  through[2] = stic_view_hand_z(&r->view, &r->history.newest);
  stic_camera_unproject(&r->view.camera, at, through[2], through);
}

void stic_render_hand_pixel(const stic_render *r, double pixel[2])
{
  const stic_result *now = &r->history.newest;

  stic_view_project(&r->view, now->hand_x, now->hand_y, stic_view_hand_z(&r->view, now), pixel);
  pixel[1] += r->hud.view_top;
}

stic_render_times stic_render_last_times(const stic_render *r)
{
  return r->times;
}

/* What stays has to be made anew: the camera moved, or this is the first picture. */
static void build_stage(stic_render *r)
{
  for (int k = 0; k < 3; k++)
    r->stage.origin[k] = r->actors.origin[k] = (r->view.low[k] + r->view.high[k]) / 2;
  r->stage.scale = r->actors.scale = r->view.size;
  stic_mesh_clear(&r->stage);
  stic_stage_build(&r->view, &r->stage);
  stic_camera_matrix(&r->view.camera, r->stage.origin, r->stage.scale, r->matrix);
  r->labels.count = r->labels.sign_count = 0;
  stic_stage_labels(&r->view, &r->labels);
  stic_hud_place_labels(&r->hud, &r->labels, 0, r->areas);
  r->stage_labels = r->labels.count;
}

static void build(stic_render *r)
{
  if (stic_view_include(&r->view, &r->history.newest))
    r->stage_valid = false;
  if (!r->stage_valid)
    build_stage(r);
  r->labels.count = r->stage_labels;
  r->labels.sign_count = 0;
  stic_mesh_clear(&r->actors);
  stic_actors_build(&r->view, &r->history, &r->actors, &r->labels);
  stic_hud_place_labels(&r->hud, &r->labels, r->stage_labels, r->areas);
}

static stic_rect whole_view(const stic_render *r)
{
  return (stic_rect){0, 0, r->view.width, r->view.height};
}

/* The pixels of the view that the moving parts can touch. */
static stic_rect moving_area(const stic_render *r)
{
  double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
  stic_rect area;

  for (int i = 0; i < r->actors.count; i++) {
    double p[3], pixel[2];

    for (int k = 0; k < 3; k++)
      p[k] = r->actors.origin[k] + r->actors.scale * r->actors.vertices[i].position[k];
    stic_camera_project(&r->view.camera, p, pixel);
    for (int k = 0; k < 2; k++) {
      low[k] = fmin(low[k], pixel[k]);
      high[k] = fmax(high[k], pixel[k]);
    }
  }
  for (int k = 0; k < 2; k++) {
    low[k] = fmax(low[k], -10);
    high[k] = fmin(high[k], STIC_PICTURE_SIZE_MAX + 10.0);
  }
  area = (stic_rect){(int)floor(low[0]) - 1, (int)floor(low[1]) - 1, (int)ceil(high[0]) + 2,
                     (int)ceil(high[1]) + 2};
  for (int i = r->stage_labels; i < r->labels.count; i++) {
    stic_rect label = r->areas[i];

    if (!stic_rect_empty(label))
      area = stic_rect_union(area, (stic_rect){label.x0 - 1, label.y0 - 1 - r->hud.view_top, label.x1 + 1,
                                               label.y1 + 1 - r->hud.view_top});
  }
  return stic_rect_intersect(area, whole_view(r));
}

/* px of the view */
static stic_rect note_area(const stic_render *r)
{
  stic_rect area = stic_hud_note_area(&r->hud);

  area.y0 -= r->hud.view_top;
  area.y1 -= r->hud.view_top;
  return area;
}

/* Everything outside the 3-D view that never changes. */
static void draw_fixed(stic_render *r)
{
  stic_rect all = {0, 0, r->canvas.width, r->canvas.height};

  for (size_t i = 3; i < (size_t)r->canvas.width * (size_t)r->canvas.height * 4; i += 4)
    r->canvas.pixels[i] = 255;
  r->canvas.clip = all;
  stic_canvas_fill(&r->canvas, all, r->view.theme->background);
  stic_hud_draw_fixed(&r->hud, &r->canvas);
}

static void draw_overlays(stic_render *r, stic_rect changed)
{
  int top = r->hud.view_top;

  r->canvas.clip = (stic_rect){changed.x0, changed.y0 + top, changed.x1, changed.y1 + top};
  stic_hud_draw_labels(&r->hud, &r->canvas, &r->labels, r->areas);
  stic_hud_draw_scale(&r->hud, &r->canvas, &r->view);
  r->canvas.clip = (stic_rect){0, 0, r->canvas.width, r->canvas.height};
  stic_hud_draw(&r->hud, &r->canvas, &r->view, &r->history);
}

stic_status stic_render_draw(stic_render *r, stic_image *image, stic_error *err)
{
  int64_t start = stic_clock_thread_ns(), built, drawn, read;
  stic_rect now, changed;
  stic_status status;

  if (!r->history.any)
    return stic_error_set(err, STIC_USAGE, NULL, 0, "there is no result to draw");
  if (!stic_gl_make_current(&r->gl))
    return stic_error_set(err, STIC_CANNOT_WRITE, NULL, 0, "no usable renderer: its context cannot be used");
  build(r);
  if (r->stage.failed || r->actors.failed)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "no memory for a picture's triangles");
  now = moving_area(r);
  changed = stic_rect_union(now, r->drawn);
  if (!r->stage_valid || r->view.force_full != r->force_full)
    changed = whole_view(r);
  if (r->hud.note[0] || r->noted)
    changed = stic_rect_union(changed, note_area(r));
  built = stic_clock_thread_ns();
  if (!r->stage_valid) {
    stic_submit_stage(&r->submit, &r->stage, r->matrix, r->view.theme->background);
    draw_fixed(r);
  }
  if (!stic_rect_empty(changed))
    stic_submit_frame(&r->submit, &r->actors, r->matrix, changed);
  drawn = stic_clock_thread_ns();
  if (!stic_rect_empty(changed))
    stic_submit_read(&r->submit, changed, r->canvas.pixels, r->canvas.width, r->hud.view_top);
  status = stic_submit_check(&r->submit, err);
  if (status)
    return status;
  read = stic_clock_thread_ns();
  draw_overlays(r, changed);
  r->stage_valid = true;
  r->drawn = now;
  r->force_full = r->view.force_full;
  r->noted = r->hud.note[0] != '\0';
  r->times = (stic_render_times){built - start, drawn - built, read - drawn, stic_clock_thread_ns() - read};
  *image = (stic_image){r->canvas.width, r->canvas.height, r->canvas.pixels};
  return STIC_OK;
}

stic_status stic_render_identify(stic_render *r, uint16_t *ids, uint16_t *depth, size_t count, int *width,
                                 int *height, stic_error *err)
{
  *width = r->view.width;
  *height = r->view.height;
  if (!r->history.any || count < (size_t)r->view.width * (size_t)r->view.height)
    return stic_error_set(err, STIC_USAGE, NULL, 0, "there is no result to draw, or no room for it");
  if (!stic_gl_make_current(&r->gl))
    return stic_error_set(err, STIC_CANNOT_WRITE, NULL, 0, "no usable renderer: its context cannot be used");
  build(r);
  /* The camera may have moved without a picture having been drawn. */
  r->stage_valid = false;
  return stic_submit_identify(&r->submit, &r->stage, &r->actors, r->matrix, ids, depth, err);
}

#include "viewer.h"

#include "../../drivers/mouse/mouse_driver.h"
#include "clock.h"
#include "error.h"
#include "overlay.h"
#include "png_writer.h"
#include "window.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#define PICTURE_NS INT64_C(16666667) /* between two pictures, at least */
#define SETTLE_NS INT64_C(150000000) /* a window that is being resized is not drawn anew all the time */
#define TOLD_NS INT64_C(2500000000)  /* how long a message stays */
#define WAIT_MS 5                    /* how often the cell is looked at */
#define LOW_PRIORITY 10              /* nice */
#define LARGE_PICTURE (1920 * 1200)  /* px: above that one sample per pixel must do */
#define NEAR_HAND 0.25               /* object sizes: so near the pointer takes the hand over */
#define SLIDE_MOST 0.5               /* object sizes in depth at once */
#define MOUSE_ROOM 1.2               /* object sizes around the object for the mouse to move in */
#define SCREENSHOTS_MAX 9999

struct stic_viewer {
  stic_scene scene;
  stic_render_settings picture; /* of `render`; no extent */
  void *library;
  const stic_window_module *module;
  stic_window *window;
  stic_render *render;
  stic_overlay overlay;
  uint8_t *pixels; /* the picture with what is written over it; of picture.width x height */

  stic_live_view_item newest; /* as observed by `render` */
  bool heard;                 /* `newest` is from the loop */
  int64_t slips;              /* that the last picture knew of */

  bool ended, paused, help, no_trails;
  bool dirty; /* there is something to draw */
  bool low_priority;
  int64_t drawn_ns, resized_ns, told_ns; /* 0: never */
  int64_t pictures;
  char told[160], title[STIC_NAME_MAX + 100];

  stic_device *mouse; /* NULL: the hand is another device's */
  stic_mouse_hand hand;
  bool parked; /* the hand waits for the pointer to come to it */
};

/* ---- pictures ---------------------------------------------------------------------------- */

/* The window's size within what a renderer can do. */
static int picture_side(int pixels, int least)
{
  const int side = pixels < least ? least : pixels > STIC_PICTURE_SIZE_MAX ? STIC_PICTURE_SIZE_MAX : pixels;

  return side / 2 * 2;
}

/* A hand at rest in the object's start: what there is to see before the first frame. */
static void set_start(stic_viewer *v)
{
  const stic_scene *s = &v->scene;
  const double c = cos(s->angle), n = sin(s->angle), *b = s->holding_point;
  stic_result *r = &v->newest.result;

  memset(&v->newest, 0, sizeof v->newest);
  r->state = STIC_RELEASED;
  r->x = s->x;
  r->y = s->y;
  r->z = r->hand_z = s->z;
  r->theta = r->hand_theta = s->angle;
  r->hand_x = r->holding_x = s->x + c * b[0] - n * b[1];
  r->hand_y = r->holding_y = s->y + n * b[0] + c * b[1];
  v->newest.state = STIC_CONNECTION_OPENING;
  v->hand = (stic_mouse_hand){{r->hand_x, r->hand_y, r->hand_z}, s->angle, 0};
}

/* Room for the mouse, so that the camera need not step back at once. */
static void widen(const stic_viewer *v, stic_extent *extent)
{
  const double room = MOUSE_ROOM * stic_scene_size(&v->scene);

  stic_extent_init(extent);
  stic_extent_add(extent, &v->scene, &v->newest.result);
  for (int k = 0; k < 2; k++) {
    extent->low[k] -= room * (k ? 0.55 : 1);
    extent->high[k] += room * (k ? 0.5 : 1);
  }
}

/* Makes the renderer anew for the window's size and the settings; `keep`: with what the old one has seen. */
static stic_status make_render(stic_viewer *v, bool keep, stic_error *err)
{
  stic_render_settings settings = v->picture;
  stic_render *render;
  stic_extent extent;
  stic_status status;
  uint8_t *pixels;

  v->module->size(v->window, &settings.width, &settings.height);
  settings.width = picture_side(settings.width, STIC_PICTURE_WIDTH_MIN);
  settings.height = picture_side(settings.height, STIC_PICTURE_HEIGHT_MIN);
  v->picture = settings;
  if (settings.width * settings.height > LARGE_PICTURE)
    settings.quality = STIC_QUALITY_FAST;
  widen(v, &extent);
  if (v->mouse)
    settings.extent = &extent;
  pixels = realloc(v->pixels, (size_t)settings.width * (size_t)settings.height * 4);
  if (!pixels)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "no memory for pictures of %d x %d", settings.width,
                          settings.height);
  v->pixels = pixels;
  stic_overlay_free(&v->overlay);
  if (!stic_overlay_init(&v->overlay, settings.width, settings.height, settings.look))
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  status = stic_render_create(&v->scene, &settings, &render, err);
  if (status != STIC_OK)
    return status;
  if (keep && v->render)
    stic_render_continue(render, v->render);
  else
    stic_render_observe(render, &v->newest.result);
  stic_render_destroy(v->render);
  v->render = render;
  stic_render_set_trails(render, !v->no_trails);
  v->resized_ns = 0;
  v->dirty = true;
  return STIC_OK;
}

/* What is wrong or unusual, for a badge; "" for nothing. */
static const char *trouble(const stic_viewer *v)
{
  if (!v->heard)
    return v->mouse ? "move the pointer into the picture" : "waiting for the tracker";
  switch (v->newest.state) {
  case STIC_CONNECTION_STALE: return "tracker silent: the hand has let go";
  case STIC_CONNECTION_LOST:
  case STIC_CONNECTION_OPENING:
  case STIC_CONNECTION_CLOSED: return "tracker unplugged: looking for it";
  case STIC_CONNECTION_RESETTING:
  case STIC_CONNECTION_SYNCING: return "tracker starting";
  case STIC_CONNECTION_RUNNING: break;
  }
  return v->newest.result.flags & STIC_FLAG_LOST ? "tracking lost: the hand has let go" : "";
}

static void draw_over(const stic_viewer *v, int64_t now_ns)
{
  const int width = v->picture.width, height = v->picture.height;
  const stic_canvas canvas = {v->pixels, width, height, {0, 0, width, height}};
  const stic_rect area = stic_render_scene_area(v->render);
  int row = 0;

  stic_overlay_hint(&v->overlay, &canvas, area, "h: help");
  if (v->paused)
    stic_overlay_badge(&v->overlay, &canvas, area, row++, false, "picture held; the simulation runs on");
  if (trouble(v)[0])
    stic_overlay_badge(&v->overlay, &canvas, area, row++, v->heard, trouble(v));
  else if (v->parked)
    stic_overlay_badge(&v->overlay, &canvas, area, row++, false, "point at the hand to take it over");
  if (v->told[0] && now_ns < v->told_ns + TOLD_NS)
    stic_overlay_badge(&v->overlay, &canvas, area, row++, false, v->told);
  if (v->help)
    stic_overlay_help(&v->overlay, &canvas, v->mouse != NULL);
}

static void set_title(stic_viewer *v)
{
  const char *name = v->scene.name[0] ? v->scene.name : "scene";
  const char *state = trouble(v)[0] ? trouble(v) : stic_state_name(v->newest.result.state);
  char title[sizeof v->title];

  snprintf(title, sizeof title, "stiction: %s: %s%s", name, state, v->paused ? " (held)" : "");
  if (strcmp(title, v->title) == 0)
    return;
  strcpy(v->title, title);
  v->module->set_title(v->window, title);
}

static stic_status draw(stic_viewer *v, int64_t now_ns, stic_error *err)
{
  stic_image image;
  stic_status status = stic_render_draw(v->render, &image, err);

  if (status != STIC_OK)
    return status;
  memcpy(v->pixels, image.pixels, (size_t)image.width * (size_t)image.height * 4);
  draw_over(v, now_ns);
  image.pixels = v->pixels;
  v->drawn_ns = now_ns;
  v->dirty = false;
  v->pictures++;
  set_title(v);
  return v->module->show(v->window, &image, err);
}

/* ---- frames ------------------------------------------------------------------------------ */

static void observe(stic_viewer *v, const stic_live_view_item *item)
{
  if (item->state != v->newest.state)
    v->dirty = true;
  if (v->heard && item->result.t_ns <= v->newest.result.t_ns) {
    v->newest.state = item->state; /* no new frame, but news of the device */
    return;
  }
  if (!v->heard)
    stic_render_forget(v->render);
  v->newest = *item;
  /* A slip in a frame that no picture shows must not go unseen. */
  if (item->result.slips != v->slips)
    v->newest.result.flags |= STIC_FLAG_SLIPPED;
  v->slips = item->result.slips;
  v->heard = true;
  stic_render_observe(v->render, &v->newest.result);
  v->dirty = true;
}

/* ---- the mouse as the hand --------------------------------------------------------------- */

/* The ray under the pointer, moved in depth so that the hand's own z is where the picture draws the hand. */
static void ray_at(const stic_viewer *v, const stic_window_event *e, double eye[3], double through[3])
{
  const stic_result *now = &v->newest.result;
  const double pixel[2] = {e->x, e->y};
  double shift;

  stic_render_ray(v->render, pixel, eye, through);
  shift = (now->state != STIC_RELEASED ? now->hand_z : v->hand.position[2]) - through[2];
  eye[2] += shift;
  through[2] += shift;
}

static bool near_hand(const stic_viewer *v, const double through[3])
{
  return hypot(through[0] - v->hand.position[0], through[1] - v->hand.position[1]) <
         NEAR_HAND * stic_scene_size(&v->scene);
}

static void move_hand(stic_viewer *v, const stic_window_event *e)
{
  const double size = stic_scene_size(&v->scene);
  const bool held = v->newest.result.state != STIC_RELEASED;
  double eye[3], through[3];

  if (!v->mouse)
    return;
  ray_at(v, e, eye, through);
  if (v->parked && !near_hand(v, through) && !(e->buttons & STIC_POINTER_LEFT))
    return;
  v->parked = false;
  v->dirty = true;
  if (e->kind == STIC_WINDOW_WHEEL && e->modifiers & STIC_MODIFIER_CTRL)
    stic_mouse_hand_push(&v->hand, e->wheel, size);
  else if (e->kind == STIC_WINDOW_WHEEL)
    stic_mouse_hand_turn(&v->hand, e->wheel, (e->modifiers & STIC_MODIFIER_SHIFT) != 0);
  if (e->kind == STIC_WINDOW_MOTION && e->buttons & STIC_POINTER_MIDDLE && held)
    stic_mouse_hand_slide(&v->hand, eye, through, SLIDE_MOST * size);
  else
    stic_mouse_hand_point(&v->hand, eye, through);
  v->hand.buttons = e->buttons & STIC_POINTER_LEFT ? STIC_BUTTON_GRIP : 0;
  stic_mouse_feed(v->mouse, &v->hand);
}

/* Held from the start: the hand rests where it holds until the pointer comes, or the object would leap to it. */
static void start_mouse(stic_viewer *v)
{
  if (!v->mouse || v->scene.hold != STIC_HOLD_START)
    return;
  v->parked = true;
  stic_mouse_feed(v->mouse, &v->hand);
}

/* ---- keys -------------------------------------------------------------------------------- */

static void tell(stic_viewer *v, const char *text)
{
  snprintf(v->told, sizeof v->told, "%s", text);
  v->told_ns = stic_clock_ns();
  v->dirty = true;
}

/* The picture without what is written over it, under the first free name. */
static void save_picture(stic_viewer *v)
{
  char name[32], text[100];
  stic_image image;
  stic_error err;

  for (int i = 1; i <= SCREENSHOTS_MAX; i++) {
    snprintf(name, sizeof name, "stiction-%04d.png", i);
    if (access(name, F_OK) != 0)
      break;
  }
  if (stic_render_draw(v->render, &image, &err) == STIC_OK && stic_png_write(name, &image, &err) == STIC_OK)
    snprintf(text, sizeof text, "saved as %s", name);
  else
    snprintf(text, sizeof text, "not saved: %.80s", err.message);
  tell(v, text);
}

static stic_status press(stic_viewer *v, int key, stic_error *err)
{
  static const char *const cameras[] = {"camera: three-quarter", "camera: front", "camera: follow"};

  v->dirty = true;
  switch (key) {
  case STIC_KEY_ESCAPE:
  case 'q': v->ended = true; break;
  case ' ': v->paused = !v->paused; break;
  case 'h':
  case STIC_KEY_F1: v->help = !v->help; break;
  case 'f':
  case STIC_KEY_F11: v->module->toggle_full_screen(v->window); break;
  case 's': save_picture(v); break;
  case 't':
    v->no_trails = !v->no_trails;
    stic_render_set_trails(v->render, !v->no_trails);
    tell(v, v->no_trails ? "trails off" : "trails on");
    break;
  case 'c':
    v->picture.camera = (stic_camera_preset)((v->picture.camera + 1) % 3);
    tell(v, cameras[v->picture.camera]);
    return make_render(v, true, err);
  case 'd':
    v->picture.look = v->picture.look == STIC_LOOK_DARK ? STIC_LOOK_LIGHT : STIC_LOOK_DARK;
    return make_render(v, true, err);
  case 'r': tell(v, "camera and trails anew"); return make_render(v, false, err);
  default: break;
  }
  return STIC_OK;
}

static stic_status handle(stic_viewer *v, const stic_window_event *e, stic_error *err)
{
  int width, height;

  switch (e->kind) {
  case STIC_WINDOW_CLOSE: v->ended = true; break;
  case STIC_WINDOW_KEY: return press(v, e->key, err);
  case STIC_WINDOW_MOTION:
  case STIC_WINDOW_BUTTON:
  case STIC_WINDOW_WHEEL: move_hand(v, e); break;
  case STIC_WINDOW_LEAVE:
    if (v->scene.hold == STIC_HOLD_START && v->mouse && v->heard)
      v->parked = v->dirty = true;
    break;
  case STIC_WINDOW_LOST:
    return stic_error_set(err, STIC_CANNOT_WRITE, NULL, 0, "the window's display is gone");
  case STIC_WINDOW_SHOWN:
    v->dirty = true;
    v->module->size(v->window, &width, &height);
    if (picture_side(width, STIC_PICTURE_WIDTH_MIN) != v->picture.width ||
        picture_side(height, STIC_PICTURE_HEIGHT_MIN) != v->picture.height)
      v->resized_ns = stic_clock_ns();
    break;
  }
  return STIC_OK;
}

/* ---- the view ---------------------------------------------------------------------------- */

stic_status stic_viewer_open(const stic_viewer_settings *settings, stic_viewer **viewer, stic_error *err)
{
  stic_viewer *v = calloc(1, sizeof *v);
  stic_status status;

  *viewer = NULL;
  if (!v)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  v->scene = *settings->scene;
  v->picture = settings->picture;
  v->mouse = settings->mouse;
  set_start(v);
  /* Mesa then draws in this thread, whose priority is low, and not in threads of its own. */
  setenv("LP_NUM_THREADS", "0", 0);
  status = stic_window_load(&v->module, &v->library, err);
  if (status == STIC_OK)
    status = v->module->open("stiction", v->picture.width, v->picture.height, &v->window, err);
  if (status == STIC_OK)
    status = make_render(v, false, err);
  if (status == STIC_OK)
    status = draw(v, stic_clock_ns(), err);
  if (status != STIC_OK) {
    stic_viewer_close(v);
    return status;
  }
  start_mouse(v);
  *viewer = v;
  return STIC_OK;
}

/* What is left of the CPU is enough for pictures. On Linux this is the calling thread's alone. */
static void lower_priority(stic_viewer *v)
{
  if (!v->low_priority)
    setpriority(PRIO_PROCESS, 0, LOW_PRIORITY);
  v->low_priority = true;
}

stic_status stic_viewer_turn(stic_viewer *v, stic_latest *newest, bool *ended, stic_error *err)
{
  const stic_live_view_item *item;
  stic_status status = STIC_OK;
  stic_window_event event;
  int64_t now_ns;
  bool fresh;

  lower_priority(v);
  for (bool any = v->module->next(v->window, WAIT_MS, &event); any && status == STIC_OK && !v->ended;
       any = v->module->next(v->window, 0, &event))
    status = handle(v, &event, err);
  *ended = v->ended;
  item = stic_latest_read(newest, &fresh);
  /* `fresh` would forget the newest frame of a pause. */
  if (item && !v->paused && (fresh || item->result.t_ns != v->newest.result.t_ns))
    observe(v, item);
  now_ns = stic_clock_ns();
  if (v->told[0] && now_ns >= v->told_ns + TOLD_NS) {
    v->told[0] = '\0';
    v->dirty = true;
  }
  if (status == STIC_OK && v->resized_ns && now_ns >= v->resized_ns + SETTLE_NS)
    status = make_render(v, true, err);
  if (status == STIC_OK && v->dirty && now_ns >= v->drawn_ns + PICTURE_NS)
    status = draw(v, now_ns, err);
  return status;
}

int64_t stic_viewer_pictures(const stic_viewer *v)
{
  return v->pictures;
}

void stic_viewer_close(stic_viewer *v)
{
  if (!v)
    return;
  stic_render_destroy(v->render);
  stic_overlay_free(&v->overlay);
  if (v->window)
    v->module->close(v->window);
  stic_window_unload(v->library);
  free(v->pixels);
  free(v);
}

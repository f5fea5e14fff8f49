/* The module that opens a window, by SDL 2. */
#include "window_module.h"

#include "error.h"

#include <SDL.h>
#if defined(STIC_WITH_XLIB)
#include <SDL_syswm.h>
#endif
#include <stdlib.h>
#include <string.h>

struct stic_window {
  SDL_Window *window;
  SDL_Renderer *renderer;
  SDL_Texture *texture; /* of the last picture's size; NULL before the first */
  int width, height;    /* px, of the texture */
  bool lost;            /* the display is gone */

  /* The pointer as of the last event taken; SDL itself is ahead of its queue. */
  int x, y;         /* in the desktop's units */
  Uint32 buttons;   /* SDL_BUTTON() */
  Uint16 modifiers; /* KMOD_ */
};

/* ---- a display that goes away -------------------------------------------------------------- */

#if defined(STIC_WITH_XLIB)
static int say_nothing(Display *display)
{
  (void)display;
  return 0;
}

static void note_loss(Display *display, void *window)
{
  (void)display;
  ((stic_window *)window)->lost = true;
}

/* Xlib would end the program, and with it what is still to be written. */
static void survive_loss(stic_window *w)
{
  SDL_SysWMinfo info;

  SDL_VERSION(&info.version);
  if (!SDL_GetWindowWMInfo(w->window, &info) || info.subsystem != SDL_SYSWM_X11)
    return;
  XSetIOErrorHandler(say_nothing);
  XSetIOErrorExitHandler(info.info.x11.display, note_loss, w);
}
#else
static void survive_loss(stic_window *w)
{
  (void)w;
}
#endif

/* ---- the window ---------------------------------------------------------------------------- */

static void window_close(stic_window *w)
{
  if (!w)
    return;
  if (w->lost) { /* SDL has a second connection, on which Xlib would still end the program */
    free(w);
    return;
  }
  if (w->texture)
    SDL_DestroyTexture(w->texture);
  if (w->renderer)
    SDL_DestroyRenderer(w->renderer);
  if (w->window)
    SDL_DestroyWindow(w->window);
  SDL_QuitSubSystem(SDL_INIT_VIDEO);
  free(w);
}

static stic_status window_open(const char *title, int width, int height, stic_window **window,
                               stic_error *err)
{
  stic_window *w = calloc(1, sizeof *w);

  *window = NULL;
  if (!w)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  /* X11 (or XWayland): where SDL finds none it would draw on the bare console, or nowhere. And pictures come from
   * the CPU: shared memory is their shortest way to the screen, without a second OpenGL in this thread. */
  SDL_SetHint(SDL_HINT_VIDEODRIVER, "x11");
  SDL_SetHint(SDL_HINT_FRAMEBUFFER_ACCELERATION, "0");
  SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1"); /* the program has its own */
  SDL_SetHint(SDL_HINT_VIDEO_X11_NET_WM_BYPASS_COMPOSITOR, "0");
  SDL_SetHint(SDL_HINT_MOUSE_FOCUS_CLICKTHROUGH, "1");
  if (SDL_InitSubSystem(SDL_INIT_VIDEO) == 0) {
    SDL_StopTextInput();
    w->window = SDL_CreateWindow(title, SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED, width, height,
                                 SDL_WINDOW_RESIZABLE | SDL_WINDOW_ALLOW_HIGHDPI);
  }
  if (w->window)
    w->renderer = SDL_CreateRenderer(w->window, -1, SDL_RENDERER_SOFTWARE);
  if (!w->renderer) {
    stic_error_set(err, STIC_CANNOT_WRITE, NULL, 0,
                   "cannot open a window: %s; set DISPLAY or leave out --view", SDL_GetError());
    window_close(w);
    return STIC_CANNOT_WRITE;
  }
  SDL_SetWindowMinimumSize(w->window, STIC_PICTURE_WIDTH_MIN, STIC_PICTURE_HEIGHT_MIN);
  survive_loss(w);
  *window = w;
  return STIC_OK;
}

static void window_size(const stic_window *w, int *width, int *height)
{
  if (SDL_GetRendererOutputSize(w->renderer, width, height) != 0)
    SDL_GetWindowSize(w->window, width, height);
}

/* ---- events ------------------------------------------------------------------------------ */

/* Mouse coordinates are those of the desktop, which may be coarser than pixels. */
static void set_place(const stic_window *w, stic_window_event *event)
{
  int width, height, wide, tall;

  SDL_GetWindowSize(w->window, &width, &height);
  window_size(w, &wide, &tall);
  event->x = (w->x + 0.5) * wide / (width > 0 ? width : 1);
  event->y = (w->y + 0.5) * tall / (height > 0 ? height : 1);
}

static void set_pointer(const stic_window *w, stic_window_kind kind, stic_window_event *event)
{
  event->kind = kind;
  set_place(w, event);
  event->buttons = ((w->buttons & SDL_BUTTON_LMASK) ? STIC_POINTER_LEFT : 0u) |
                   ((w->buttons & SDL_BUTTON_MMASK) ? STIC_POINTER_MIDDLE : 0u) |
                   ((w->buttons & SDL_BUTTON_RMASK) ? STIC_POINTER_RIGHT : 0u);
  event->modifiers = ((w->modifiers & KMOD_SHIFT) ? STIC_MODIFIER_SHIFT : 0u) |
                     ((w->modifiers & KMOD_CTRL) ? STIC_MODIFIER_CTRL : 0u);
}

static void set_wheel(const SDL_MouseWheelEvent *wheel, stic_window_event *event)
{
  /* Some systems turn the wheel sideways while shift is down. */
  event->wheel = (double)wheel->preciseY;
  if (event->wheel == 0 && event->modifiers & STIC_MODIFIER_SHIFT)
    event->wheel = (double)wheel->preciseX;
  if (wheel->direction == SDL_MOUSEWHEEL_FLIPPED)
    event->wheel = -event->wheel;
}

static bool set_window_event(const SDL_WindowEvent *window, stic_window_event *event)
{
  switch (window->event) {
  case SDL_WINDOWEVENT_CLOSE: event->kind = STIC_WINDOW_CLOSE; return true;
  case SDL_WINDOWEVENT_LEAVE: event->kind = STIC_WINDOW_LEAVE; return true;
  case SDL_WINDOWEVENT_EXPOSED:
  case SDL_WINDOWEVENT_SIZE_CHANGED:
  case SDL_WINDOWEVENT_DISPLAY_CHANGED: event->kind = STIC_WINDOW_SHOWN; return true;
  default: return false;
  }
}

static bool set_key(const SDL_KeyboardEvent *key, stic_window_event *event)
{
  const SDL_Keycode code = key->keysym.sym;

  if (key->repeat || key->keysym.mod & (KMOD_CTRL | KMOD_ALT | KMOD_GUI))
    return false;
  event->kind = STIC_WINDOW_KEY;
  event->key = code == SDLK_ESCAPE ? STIC_KEY_ESCAPE
               : code == SDLK_F1   ? STIC_KEY_F1
               : code == SDLK_F11  ? STIC_KEY_F11
                                   : (int)code;
  return event->key > 0 && event->key <= STIC_KEY_F11;
}

static void take_pointer(stic_window *w, const SDL_Event *from)
{
  switch (from->type) {
  case SDL_KEYDOWN:
  case SDL_KEYUP: w->modifiers = from->key.keysym.mod; break;
  case SDL_MOUSEMOTION:
    w->x = from->motion.x;
    w->y = from->motion.y;
    w->buttons = from->motion.state;
    break;
  case SDL_MOUSEBUTTONDOWN:
  case SDL_MOUSEBUTTONUP:
    w->x = from->button.x;
    w->y = from->button.y;
    if (from->type == SDL_MOUSEBUTTONDOWN)
      w->buttons |= (Uint32)SDL_BUTTON(from->button.button);
    else
      w->buttons &= ~(Uint32)SDL_BUTTON(from->button.button);
    break;
  default: break;
  }
}

/* False for what is of no concern. */
static bool translate(stic_window *w, const SDL_Event *from, stic_window_event *event)
{
  memset(event, 0, sizeof *event);
  take_pointer(w, from);
  switch (from->type) {
  case SDL_QUIT: event->kind = STIC_WINDOW_CLOSE; return true;
  case SDL_WINDOWEVENT: return set_window_event(&from->window, event);
  case SDL_KEYDOWN: return set_key(&from->key, event);
  case SDL_MOUSEMOTION: set_pointer(w, STIC_WINDOW_MOTION, event); return true;
  case SDL_MOUSEBUTTONDOWN:
  case SDL_MOUSEBUTTONUP: set_pointer(w, STIC_WINDOW_BUTTON, event); return true;
  case SDL_MOUSEWHEEL:
    set_pointer(w, STIC_WINDOW_WHEEL, event);
    set_wheel(&from->wheel, event);
    return event->wheel != 0;
  default: return false;
  }
}

static bool window_next(stic_window *w, int wait_ms, stic_window_event *event)
{
  SDL_Event from;
  const bool any = !w->lost && SDL_WaitEventTimeout(&from, wait_ms); /* it may be lost meanwhile */

  if (w->lost) {
    memset(event, 0, sizeof *event);
    event->kind = STIC_WINDOW_LOST;
    return true;
  }
  if (!any)
    return false;
  do {
    if (translate(w, &from, event))
      return true;
  } while (SDL_PollEvent(&from));
  return false;
}

/* ---- pictures ---------------------------------------------------------------------------- */

static bool make_texture(stic_window *w, const stic_image *image)
{
  if (w->texture && w->width == image->width && w->height == image->height)
    return true;
  if (w->texture)
    SDL_DestroyTexture(w->texture);
  w->texture = SDL_CreateTexture(w->renderer, SDL_PIXELFORMAT_RGBA32, SDL_TEXTUREACCESS_STREAMING,
                                 image->width, image->height);
  if (!w->texture)
    return false;
  SDL_SetTextureBlendMode(w->texture, SDL_BLENDMODE_NONE);
  SDL_SetTextureScaleMode(w->texture, SDL_ScaleModeLinear);
  w->width = image->width;
  w->height = image->height;
  return true;
}

static stic_status window_show(stic_window *w, const stic_image *image, stic_error *err)
{
  if (!make_texture(w, image) || SDL_UpdateTexture(w->texture, NULL, image->pixels, image->width * 4) != 0 ||
      SDL_RenderCopy(w->renderer, w->texture, NULL, NULL) != 0)
    return stic_error_set(err, STIC_CANNOT_WRITE, NULL, 0, "cannot draw into the window: %s", SDL_GetError());
  SDL_RenderPresent(w->renderer);
  return STIC_OK;
}

static void window_set_title(stic_window *w, const char *title)
{
  SDL_SetWindowTitle(w->window, title);
}

static void window_toggle_full_screen(stic_window *w)
{
  const bool full = (SDL_GetWindowFlags(w->window) & SDL_WINDOW_FULLSCREEN) != 0;

  SDL_SetWindowFullscreen(w->window, full ? 0 : SDL_WINDOW_FULLSCREEN_DESKTOP);
}

const stic_window_module stic_window_sdl = {
  .version = STIC_WINDOW_MODULE,
  .open = window_open,
  .next = window_next,
  .size = window_size,
  .show = window_show,
  .set_title = window_set_title,
  .toggle_full_screen = window_toggle_full_screen,
  .close = window_close,
};

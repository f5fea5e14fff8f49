/* What the module that opens a window offers to the program: pictures out, keys and pointer in. It knows nothing
 * of scenes. All functions are for the thread that opened the window; none is real-time. */
#ifndef STIC_WINDOW_MODULE_H
#define STIC_WINDOW_MODULE_H

#include "render.h"

/* Changes with what follows: a module of another build is not used. */
#define STIC_WINDOW_MODULE 2

/* Keys without a character of their own. */
enum { STIC_KEY_ESCAPE = 0x100, STIC_KEY_F1, STIC_KEY_F11 };

enum { STIC_POINTER_LEFT = 1, STIC_POINTER_MIDDLE = 2, STIC_POINTER_RIGHT = 4 };
enum { STIC_MODIFIER_SHIFT = 1, STIC_MODIFIER_CTRL = 2 };

typedef enum stic_window_kind {
  STIC_WINDOW_CLOSE,  /* the user wants it closed */
  STIC_WINDOW_SHOWN,  /* sizes may have changed, or its content is gone: show the picture again */
  STIC_WINDOW_KEY,    /* a key went down; `key` is its lower-case ASCII character or a STIC_KEY_ */
  STIC_WINDOW_MOTION, /* the pointer moved */
  STIC_WINDOW_BUTTON, /* `buttons` changed */
  STIC_WINDOW_WHEEL,  /* `wheel` notches, up is positive */
  STIC_WINDOW_LEAVE,  /* the pointer left the window */
  STIC_WINDOW_LOST    /* the display is gone; the window is only to be closed */
} stic_window_kind;

/* One thing that happened. The pointer's fields hold for MOTION, BUTTON and WHEEL. */
typedef struct stic_window_event {
  stic_window_kind kind;
  int key;
  double x, y;        /* px of the window's content from the upper left corner; pixel (0, 0) covers 0..1 */
  unsigned buttons;   /* those down, STIC_POINTER_ */
  unsigned modifiers; /* STIC_MODIFIER_ */
  double wheel;
} stic_window_event;

typedef struct stic_window stic_window;

typedef struct stic_window_module {
  int version;

  /* Opens a window of about width x height. STIC_CANNOT_WRITE with one message if there is no display,
   * STIC_NO_MEMORY. The caller owns `*window`. */
  stic_status (*open)(const char *title, int width, int height, stic_window **window, stic_error *err);

  /* Waits up to `wait_ms` for something to happen: false if nothing did. LOST is told until the window is closed. */
  bool (*next)(stic_window *window, int wait_ms, stic_window_event *event);

  /* Size of the content, px of the screen. */
  void (*size)(const stic_window *window, int *width, int *height);

  /* Fills the window with a picture, scaled if it is of another size. STIC_CANNOT_WRITE, STIC_NO_MEMORY. */
  stic_status (*show)(stic_window *window, const stic_image *image, stic_error *err);

  void (*set_title)(stic_window *window, const char *title);
  void (*toggle_full_screen)(stic_window *window);
  void (*close)(stic_window *window); /* NULL allowed */
} stic_window_module;

/* The module's one symbol. */
extern STIC_API const stic_window_module stic_window_sdl;

#endif

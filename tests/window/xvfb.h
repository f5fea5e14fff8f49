/* A display in memory with a user at it: Xvfb, keys and pointer by XTest, and what is to be seen. */
#ifndef STIC_TEST_XVFB_H
#define STIC_TEST_XVFB_H

#include <X11/Xlib.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdbool.h>
#include <sys/types.h>

typedef struct stic_xvfb {
  pid_t server;
  Display *display;
  Window window; /* the program's; 0 until found */
} stic_xvfb;

/* Starts a server with a screen of 1600 x 1200 and sets DISPLAY. False where there is none; in CI that fails. */
bool stic_xvfb_start(stic_xvfb *x);
void stic_xvfb_stop(stic_xvfb *x);

/* Waits up to a minute for a window to be there and gives it the keyboard. */
bool stic_xvfb_find_window(stic_xvfb *x);
void stic_xvfb_window_size(stic_xvfb *x, int *width, int *height);

/* Keys by their X names ("space", "Escape"), buttons by number (4 and 5: the wheel up and down). */
void stic_xvfb_key(stic_xvfb *x, const char *name);
void stic_xvfb_hold_key(stic_xvfb *x, const char *name, bool down);
void stic_xvfb_point(stic_xvfb *x, int px, int py); /* px of the window */
void stic_xvfb_button(stic_xvfb *x, unsigned button, bool down);

/* What the window shows: R, G, B, 255 per pixel, to be freed; NULL if it cannot be read. */
uint8_t *stic_xvfb_grab(stic_xvfb *x, int *width, int *height);

#endif

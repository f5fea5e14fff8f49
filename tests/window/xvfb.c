#include "xvfb.h"

#include <X11/Xutil.h>
#include <X11/extensions/XTest.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static void pause_ms(int ms)
{
  nanosleep(&(struct timespec){ms / 1000, ms % 1000 * 1000000L}, NULL);
}

static void run_server(int tell)
{
  char fd[16];
  const int nowhere = open("/dev/null", O_RDWR);

  snprintf(fd, sizeof fd, "%d", tell);
  dup2(nowhere, 1);
  dup2(nowhere, 2);
  execlp("Xvfb", "Xvfb", "-displayfd", fd, "-screen", "0", "1600x1200x24", "-nolisten", "tcp", "-noreset",
         (char *)NULL);
  _exit(127);
}

bool stic_xvfb_start(stic_xvfb *x)
{
  char number[16] = "", name[20];
  size_t length = 0;
  ssize_t got;
  int tell[2];

  memset(x, 0, sizeof *x);
  assert_int_equal(pipe(tell), 0);
  x->server = fork();
  if (x->server == 0)
    run_server(tell[1]);
  close(tell[1]);
  while (length < sizeof number - 1 && !strchr(number, '\n') &&
         (got = read(tell[0], number + length, sizeof number - 1 - length)) > 0)
    length += (size_t)got;
  close(tell[0]);
  snprintf(name, sizeof name, ":%d", atoi(number));
  setenv("DISPLAY", name, 1);
  x->display = length ? XOpenDisplay(name) : NULL;
  if (!x->display && getenv("CI") && strcmp(getenv("CI"), "true") == 0)
    fail_msg("no Xvfb; install the packages of the line test in the file packages");
  if (!x->display)
    stic_xvfb_stop(x);
  return x->display != NULL;
}

void stic_xvfb_stop(stic_xvfb *x)
{
  if (x->display)
    XCloseDisplay(x->display);
  if (x->server > 0) {
    kill(x->server, SIGTERM);
    waitpid(x->server, NULL, 0);
  }
  memset(x, 0, sizeof *x);
}

static Window largest_window(Display *display)
{
  Window root, parent, *children = NULL, found = 0;
  unsigned count = 0;
  int most = 0;

  XQueryTree(display, DefaultRootWindow(display), &root, &parent, &children, &count);
  for (unsigned i = 0; i < count; i++) {
    XWindowAttributes a;

    if (XGetWindowAttributes(display, children[i], &a) && a.map_state == IsViewable &&
        a.width * a.height > most) {
      found = children[i];
      most = a.width * a.height;
    }
  }
  if (children)
    XFree(children);
  return found;
}

bool stic_xvfb_find_window(stic_xvfb *x)
{
  for (int i = 0; i < 1200 && !x->window; i++) {
    x->window = largest_window(x->display);
    if (!x->window)
      pause_ms(50);
  }
  if (!x->window)
    return false;
  XSetInputFocus(x->display, x->window, RevertToPointerRoot, CurrentTime);
  XSync(x->display, False);
  return true;
}

void stic_xvfb_window_size(stic_xvfb *x, int *width, int *height)
{
  XWindowAttributes a;

  assert_true(XGetWindowAttributes(x->display, x->window, &a));
  *width = a.width;
  *height = a.height;
}

void stic_xvfb_hold_key(stic_xvfb *x, const char *name, bool down)
{
  const KeyCode code = XKeysymToKeycode(x->display, XStringToKeysym(name));

  assert_int_not_equal(code, 0);
  XTestFakeKeyEvent(x->display, code, down, CurrentTime);
  XSync(x->display, False);
}

void stic_xvfb_key(stic_xvfb *x, const char *name)
{
  stic_xvfb_hold_key(x, name, true);
  stic_xvfb_hold_key(x, name, false);
}

void stic_xvfb_point(stic_xvfb *x, int px, int py)
{
  Window child;
  int root_x, root_y;

  XTranslateCoordinates(x->display, x->window, DefaultRootWindow(x->display), px, py, &root_x, &root_y,
                        &child);
  XTestFakeMotionEvent(x->display, -1, root_x, root_y, CurrentTime);
  XSync(x->display, False);
}

void stic_xvfb_button(stic_xvfb *x, unsigned button, bool down)
{
  XTestFakeButtonEvent(x->display, button, down, CurrentTime);
  XSync(x->display, False);
}

uint8_t *stic_xvfb_grab(stic_xvfb *x, int *width, int *height)
{
  XImage *image;
  uint8_t *pixels, *p;

  stic_xvfb_window_size(x, width, height);
  image = XGetImage(x->display, x->window, 0, 0, (unsigned)*width, (unsigned)*height, AllPlanes, ZPixmap);
  p = pixels = image ? malloc((size_t)*width * (size_t)*height * 4) : NULL;
  for (int i = 0; pixels && i < *width * *height; i++, p += 4) {
    const unsigned long value = XGetPixel(image, i % *width, i / *width);

    p[0] = (uint8_t)(value >> 16);
    p[1] = (uint8_t)(value >> 8);
    p[2] = (uint8_t)value;
    p[3] = 255;
  }
  if (image)
    XDestroyImage(image);
  return pixels;
}

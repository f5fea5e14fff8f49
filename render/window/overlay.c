#include "overlay.h"

#include <math.h>
#include <string.h>

bool stic_overlay_init(stic_overlay *o, int width, int height, stic_look look)
{
  double size;

  o->theme = look == STIC_LOOK_DARK ? &stic_theme_dark : &stic_theme_light;
  o->unit = fmin(height, width * 0.75) / 480.0;
  size = fmax(14.5 * pow(o->unit, 0.9), 8); /* as in the head-up display */
  o->text = stic_font_create(false, size);
  o->strong = stic_font_create(true, size);
  return o->text && o->strong;
}

void stic_overlay_free(stic_overlay *o)
{
  stic_font_destroy(o->text);
  stic_font_destroy(o->strong);
  memset(o, 0, sizeof *o);
}

static int px(const stic_overlay *o, double design)
{
  return (int)floor(design * o->unit + 0.5);
}

/* A filled box with round corners. */
static void fill_round(const stic_canvas *c, stic_rect r, int radius, stic_color color)
{
  for (int y = r.y0; y < r.y1; y++) {
    const int from_end = y - r.y0 < r.y1 - 1 - y ? y - r.y0 : r.y1 - 1 - y;
    const double up = radius - from_end - 0.5;
    const int in = up > 0 ? (int)(radius - sqrt(radius * radius - up * up) + 0.5) : 0;

    stic_canvas_fill(c, (stic_rect){r.x0 + in, y, r.x1 - in, y + 1}, color);
  }
}

static void panel(const stic_overlay *o, const stic_canvas *c, stic_rect r, int radius, stic_color inside,
                  stic_color rim)
{
  const int edge = px(o, 1) > 0 ? px(o, 1) : 1;

  fill_round(c, (stic_rect){r.x0 - edge, r.y0 - edge, r.x1 + edge, r.y1 + edge}, radius + edge, rim);
  fill_round(c, r, radius, inside);
}

void stic_overlay_badge(const stic_overlay *o, const stic_canvas *c, stic_rect area, int row, bool alarm,
                        const char *text)
{
  const int line = stic_font_height(o->strong), tall = line + px(o, 8);
  const int wide = stic_font_width(o->strong, text) + 2 * px(o, 12);
  const int x = (area.x0 + area.x1 - wide) / 2, y = area.y0 + px(o, 10) + row * (tall + px(o, 6));
  const stic_color inside = alarm ? o->theme->edge : o->theme->panel;

  panel(o, c, (stic_rect){x, y, x + wide, y + tall}, tall / 2, inside, alarm ? inside : o->theme->muted);
  stic_canvas_text(c, o->strong, x + px(o, 12), y + px(o, 4), text, alarm ? o->theme->panel : o->theme->text);
}

void stic_overlay_hint(const stic_overlay *o, const stic_canvas *c, stic_rect area, const char *text)
{
  stic_canvas_text_rimmed(c, o->text, area.x1 - px(o, 10) - stic_font_width(o->text, text),
                          area.y0 + px(o, 4), text, o->theme->muted, o->theme->background);
}

/* ---- help -------------------------------------------------------------------------------- */

typedef struct help_line {
  const char *key, *words; /* a NULL key: a heading */
} help_line;

static const help_line view_help[] = {{NULL, "The view"},
                                      {"space", "hold the picture; the simulation runs on"},
                                      {"c", "camera: three-quarter, front, follow"},
                                      {"t", "trails on or off"},
                                      {"r", "camera and trails anew; the simulation is not touched"},
                                      {"d", "dark or light"},
                                      {"f", "full screen or window"},
                                      {"s", "save the picture as PNG in this folder"},
                                      {"h, F1", "this page"},
                                      {"q, Esc", "end the run; everything is written"},
                                      {NULL, NULL}};

static const help_line mouse_help[] = {{NULL, "The mouse is the hand"},
                                       {"move", "the hand follows the pointer"},
                                       {"left button", "grip, where the scene holds by button"},
                                       {"wheel", "turn by 2\xc2\xb0; with shift by 0.25\xc2\xb0"},
                                       {"ctrl + wheel", "away and near"},
                                       {"middle button", "drag away and near"},
                                       {NULL, NULL}};

static int widest(const stic_font *font, const help_line *lines, bool keys)
{
  int most = 0;

  for (; lines->words; lines++) {
    const char *text = keys ? lines->key : lines->key ? lines->words : NULL;
    const int wide = text ? stic_font_width(font, text) : 0;

    most = wide > most ? wide : most;
  }
  return most;
}

static int count_lines(const help_line *lines)
{
  int count = 0;

  while (lines[count].words)
    count++;
  return count;
}

/* From (x, y) down; returns where it ended. */
static int draw_lines(const stic_overlay *o, const stic_canvas *c, const help_line *lines, int x, int words_x,
                      int y)
{
  const int step = stic_font_height(o->text) + px(o, 5);

  for (; lines->words; lines++, y += step) {
    if (!lines->key) {
      stic_canvas_text(c, o->strong, x, y, lines->words, o->theme->text);
      continue;
    }
    stic_canvas_text(c, o->strong, x, y, lines->key, o->theme->normal);
    stic_canvas_text(c, o->text, words_x, y, lines->words, o->theme->text);
  }
  return y;
}

void stic_overlay_help(const stic_overlay *o, const stic_canvas *c, bool mouse)
{
  const int step = stic_font_height(o->text) + px(o, 5), pad = px(o, 18), gap = px(o, 14);
  const int rows = count_lines(view_help) + (mouse ? count_lines(mouse_help) : 0);
  int keys = widest(o->strong, view_help, true), words = widest(o->text, view_help, false), x, y;
  stic_rect box;

  if (mouse && widest(o->strong, mouse_help, true) > keys)
    keys = widest(o->strong, mouse_help, true);
  box.x0 = (c->width - keys - gap - words) / 2 - pad;
  box.x1 = box.x0 + keys + gap + words + 2 * pad;
  box.y0 = (c->height - rows * step - (mouse ? gap : 0)) / 2 - pad;
  box.y1 = box.y0 + rows * step + (mouse ? gap : 0) + 2 * pad;
  stic_canvas_fill(c, (stic_rect){0, 0, c->width, c->height}, stic_color_fade(o->theme->background, 0.55));
  panel(o, c, box, px(o, 10), o->theme->panel, o->theme->line);
  x = box.x0 + pad;
  y = draw_lines(o, c, view_help, x, x + keys + gap, box.y0 + pad);
  if (mouse)
    draw_lines(o, c, mouse_help, x, x + keys + gap, y + gap);
}

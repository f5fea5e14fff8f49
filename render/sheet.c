#include "sheet.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "canvas.h"
#include "error.h"
#include "theme.h"
#include "view.h"

#define STATE_COUNT (STIC_MULTI + 1)
#define TICKS_MAX 64

struct stic_sheet {
  stic_sheet_settings settings; /* strings are not kept */
  const stic_theme *theme;
  double unit;                       /* px that stand for one px of a picture 480 px tall */
  stic_font *small, *strong, *large; /* owned */
  stic_canvas canvas;                /* pixels owned */
  int margin, gap, caption, line;    /* px */
  stic_rect band;                    /* the states' */
  int cells_top;                     /* px */
};

static int px(const stic_sheet *s, double design)
{
  return (int)floor(design * s->unit + 0.5);
}

/* ---- words --------------------------------------------------------------------------------- */

/* Text that ends with an ellipsis where it would be wider than `room` px. */
static void draw_fitting(const stic_sheet *s, const stic_font *font, int x, int y, int room, const char *text,
                         stic_color color)
{
  char cut[256];
  size_t length = strlen(text);
  const size_t most = sizeof cut - 4;

  snprintf(cut, sizeof cut, "%s", text);
  if (length > most)
    length = most + 1;
  while (length > 0 && (length > most || stic_font_width(font, cut) > room)) {
    do
      length--;
    while (length > 0 && ((unsigned char)text[length] & 0xc0) == 0x80); /* never inside a character */
    snprintf(cut, sizeof cut, "%.*s\xe2\x80\xa6", (int)length, text);
  }
  if (length > 0)
    stic_canvas_text(&s->canvas, font, x, y, cut, color);
}

/* A number in a disc; (x, y) is its centre. */
static void draw_badge(const stic_sheet *s, double x, double y, int number)
{
  char text[12];

  snprintf(text, sizeof text, "%d", number);
  stic_canvas_disc(&s->canvas, x, y, 10.5 * s->unit, s->theme->text);
  stic_canvas_text(&s->canvas, s->strong, (int)floor(x - stic_font_width(s->strong, text) / 2.0 + 0.5),
                   (int)floor(y - stic_font_height(s->strong) / 2.0 + 0.5), text, s->theme->panel);
}

/* ---- making -------------------------------------------------------------------------------- */

static void layout(stic_sheet *s, int *width, int *height)
{
  const stic_sheet_settings *o = &s->settings;
  const int small = stic_font_height(s->small), large = stic_font_height(s->large);
  const int rows = (o->count + o->columns - 1) / o->columns;
  int y;

  s->margin = px(s, 18);
  s->gap = px(s, 16);
  s->line = px(s, 1) > 0 ? px(s, 1) : 1;
  s->caption = 2 * small + px(s, 12);
  *width = 2 * s->margin + o->columns * o->width + (o->columns - 1) * s->gap;
  y = s->margin + large + small + px(s, 44);
  s->band = (stic_rect){s->margin, y, *width - s->margin, y + px(s, 22)};
  s->cells_top = s->band.y1 + px(s, 30) + small;
  *height = s->cells_top + rows * (s->caption + o->height) + (rows - 1) * s->gap + s->margin;
}

static bool make_parts(stic_sheet *s)
{
  s->unit = fmin(s->settings.height, s->settings.width * 0.75) / 480.0;
  s->small = stic_font_create(false, fmax(15 * s->unit, 8));
  s->strong = stic_font_create(true, fmax(15 * s->unit, 8));
  s->large = stic_font_create(true, fmax(24 * s->unit, 10));
  return s->small && s->strong && s->large;
}

static stic_status make_canvas(stic_sheet *s, stic_error *err)
{
  stic_canvas *c = &s->canvas;

  layout(s, &c->width, &c->height);
  if (c->width > STIC_SHEET_SIZE_MAX || c->height > STIC_SHEET_SIZE_MAX)
    return stic_error_set(
      err, STIC_USAGE, NULL, 0,
      "the sheet would be %d x %d pixels; expected at most %d x %d: fewer or smaller pictures", c->width,
      c->height, STIC_SHEET_SIZE_MAX, STIC_SHEET_SIZE_MAX);
  c->pixels = malloc((size_t)c->width * (size_t)c->height * 4);
  if (!c->pixels)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "no memory for a sheet of %d x %d pixels", c->width,
                          c->height);
  c->clip = (stic_rect){0, 0, c->width, c->height};
  stic_canvas_fill(c, c->clip, s->theme->background);
  return STIC_OK;
}

stic_status stic_sheet_create(const stic_sheet_settings *settings, stic_sheet **sheet, stic_error *err)
{
  stic_sheet *s = calloc(1, sizeof *s);
  stic_status status;
  int room;

  *sheet = NULL;
  if (!s)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  s->settings = *settings;
  s->theme = settings->look == STIC_LOOK_DARK ? &stic_theme_dark : &stic_theme_light;
  status =
    make_parts(s) ? make_canvas(s, err) : stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  if (status) {
    stic_sheet_destroy(s);
    return status;
  }
  room = s->canvas.width - 2 * s->margin;
  draw_fitting(s, s->large, s->margin, s->margin, room, settings->title, s->theme->text);
  draw_fitting(s, s->small, s->margin, s->margin + stic_font_height(s->large), room, settings->subtitle,
               s->theme->muted);
  *sheet = s;
  return STIC_OK;
}

void stic_sheet_destroy(stic_sheet *s)
{
  if (!s)
    return;
  stic_font_destroy(s->small);
  stic_font_destroy(s->strong);
  stic_font_destroy(s->large);
  free(s->canvas.pixels);
  free(s);
}

/* ---- band ---------------------------------------------------------------------------------- */

/* Light enough to write on. */
static stic_color state_color(const stic_theme *t, stic_state state)
{
  const stic_color colors[STATE_COUNT] = {t->line, t->panel, t->normal, t->hand, t->cone, t->spring, t->edge};

  return stic_color_mix(t->panel, colors[state], state == STIC_RELEASED || state == STIC_FREE ? 1 : 0.45);
}

typedef struct axis {
  int64_t first_ns, last_ns;
  double left, width; /* px */
} axis;

static double axis_place(const axis *a, int64_t t_ns)
{
  const double length = (double)(a->last_ns - a->first_ns);

  return a->left + (length > 0 ? (double)(t_ns - a->first_ns) / length : 0.5) * a->width;
}

/* Any state is seen, however short it is. */
static void draw_span(const stic_sheet *s, double x0, double x1, stic_state state)
{
  const int from = (int)floor(x0), to = (int)floor(x1) > from ? (int)floor(x1) : from + 1;
  const char *name = stic_state_name(state);
  const int width = stic_font_width(s->small, name);

  stic_canvas_fill(&s->canvas, (stic_rect){from, s->band.y0, to, s->band.y1}, state_color(s->theme, state));
  stic_canvas_fill(&s->canvas, (stic_rect){from, s->band.y0, from + s->line, s->band.y1}, s->theme->muted);
  if (width + px(s, 8) <= to - from)
    stic_canvas_text(&s->canvas, s->small, (from + to - width) / 2,
                     (s->band.y0 + s->band.y1 - stic_font_height(s->small)) / 2, name, s->theme->text);
}

static void draw_states(const stic_sheet *s, const axis *a, const stic_sheet_row *rows, size_t count)
{
  for (size_t i = 0, next; i < count; i = next) {
    for (next = i + 1; next < count && rows[next].state == rows[i].state;)
      next++;
    draw_span(s, axis_place(a, rows[i].t_ns), next < count ? axis_place(a, rows[next].t_ns) : s->band.x1,
              rows[i].state);
  }
  stic_canvas_frame(&s->canvas, s->band, s->line, s->theme->muted);
}

static void draw_slips(const stic_sheet *s, const axis *a, const stic_sheet_row *rows, size_t count)
{
  for (size_t i = 0; i < count; i++) {
    const double x = axis_place(a, rows[i].t_ns);

    if (rows[i].slipped)
      stic_canvas_line(&s->canvas, x, s->band.y1 + 2 * s->unit, x, s->band.y1 + 7 * s->unit, fmax(s->unit, 1),
                       s->theme->friction);
  }
}

static void draw_times(const stic_sheet *s, const axis *a)
{
  const double low = (double)a->first_ns * 1e-9, high = (double)a->last_ns * 1e-9;
  const double step = stic_round_up_125((high - low) * 80 * s->unit / a->width);
  const int decimals = high > low ? stic_decimals(step) : 0;
  const int y = s->band.y1 + px(s, 10);
  double first;
  const int count = high > low ? stic_multiples(low, high, step, TICKS_MAX, &first) : 0;

  for (int i = 0; i < count; i++) {
    const double t = (first + i) * step, x = a->left + (t - low) / (high - low) * a->width;
    char text[48];
    int left;

    snprintf(text, sizeof text, "%.*f s", decimals, t);
    left = (int)x - stic_font_width(s->small, text) / 2;
    if (left < s->margin)
      left = s->margin;
    if (left + stic_font_width(s->small, text) > s->band.x1)
      left = s->band.x1 - stic_font_width(s->small, text);
    stic_canvas_text(&s->canvas, s->small, left, y, text, s->theme->muted);
  }
}

/* Where the number of a mark goes, px: as near to its time as the numbers before and after it let it. */
static double mark_place(const stic_sheet *s, const axis *a, const int64_t *marks_ns, int count, int index)
{
  const double radius = 10.5 * s->unit, apart = 2 * radius + 2 * s->unit;
  double x = s->band.x0 + radius - apart;

  for (int i = 0; i <= index; i++) {
    const double most = s->band.x1 - radius - (count - 1 - i) * apart;

    x = fmin(fmax(axis_place(a, marks_ns[i]), x + apart), most);
  }
  return x;
}

static void draw_marks(const stic_sheet *s, const axis *a, const int64_t *marks_ns, int count)
{
  const double y = s->band.y0 - 24 * s->unit;

  for (int i = 0; i < count; i++) {
    const double x = mark_place(s, a, marks_ns, count, i), at = axis_place(a, marks_ns[i]);

    stic_canvas_line(&s->canvas, x, y, at, s->band.y0 - 3 * s->unit, 1.2 * s->unit, s->theme->text);
    stic_canvas_line(&s->canvas, at, s->band.y0 - 3 * s->unit, at, s->band.y1, 1.2 * s->unit, s->theme->text);
    draw_badge(s, x, y, i + 1);
  }
}

void stic_sheet_draw_band(stic_sheet *s, const stic_sheet_row *rows, size_t count, const int64_t *marks_ns,
                          int mark_count)
{
  const axis a = {rows[0].t_ns, rows[count - 1].t_ns, s->band.x0, s->band.x1 - s->band.x0};

  draw_states(s, &a, rows, count);
  draw_slips(s, &a, rows, count);
  draw_times(s, &a);
  draw_marks(s, &a, marks_ns, mark_count);
}

/* ---- pictures ------------------------------------------------------------------------------ */

static void copy_picture(const stic_sheet *s, int x, int y, const stic_image *image)
{
  const size_t length = (size_t)image->width * 4;

  for (int row = 0; row < image->height; row++)
    memcpy(s->canvas.pixels + ((size_t)(y + row) * (size_t)s->canvas.width + (size_t)x) * 4,
           image->pixels + (size_t)row * length, length);
}

static void draw_caption(const stic_sheet *s, int x, int y, int index, const stic_sheet_caption *caption)
{
  const int small = stic_font_height(s->small), top = y + px(s, 5), right = x + s->settings.width - px(s, 10);
  int left = x + px(s, 36);
  char time[32];

  draw_badge(s, x + 19 * s->unit, y + s->caption / 2.0, index + 1);
  snprintf(time, sizeof time, "%.3f s", (double)caption->t_ns * 1e-9);
  stic_canvas_text(&s->canvas, s->strong, left, top, time, s->theme->text);
  draw_fitting(s, s->small, left, top + small, right - left, caption->text, s->theme->text);
  left += stic_font_width(s->strong, time) + px(s, 14);
  draw_fitting(s, s->strong, left, top, right - left, caption->title, s->theme->normal);
}

void stic_sheet_place(stic_sheet *s, int index, const stic_image *image, const stic_sheet_caption *caption)
{
  const stic_sheet_settings *o = &s->settings;
  const int x = s->margin + index % o->columns * (o->width + s->gap);
  const int y = s->cells_top + index / o->columns * (s->caption + o->height + s->gap);
  const stic_rect card = {x - s->line, y - s->line, x + o->width + s->line,
                          y + s->caption + o->height + s->line};

  stic_canvas_fill(&s->canvas, card, s->theme->panel);
  stic_canvas_frame(&s->canvas, card, s->line, s->theme->line);
  stic_canvas_fill(&s->canvas, (stic_rect){x, y + s->caption - s->line, x + o->width, y + s->caption},
                   s->theme->line);
  draw_caption(s, x, y, index, caption);
  copy_picture(s, x, y + s->caption, image);
}

stic_image stic_sheet_image(const stic_sheet *s)
{
  return (stic_image){s->canvas.width, s->canvas.height, s->canvas.pixels};
}

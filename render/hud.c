#include "hud.h"

#include "../src/angle.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TICKS_MAX 12

static int px(const stic_hud *h, double design)
{
  return (int)floor(design * h->unit + 0.5);
}

/* ---- layout -------------------------------------------------------------------------------- */

/* The coordinate in which the run moves most, an angle counting as the way of a corner. */
static stic_plot choose_plot(const stic_render_settings *settings, const stic_scene *scene)
{
  const stic_extent *e = settings->extent;
  double x, y, turn;

  if (settings->plot != STIC_PLOT_AUTO)
    return settings->plot;
  if (!e || e->point_low[0] > e->point_high[0])
    return STIC_PLOT_X;
  x = e->point_high[0] - e->point_low[0];
  y = e->point_high[1] - e->point_low[1];
  turn = (e->angle[1] - e->angle[0]) * stic_scene_size(scene) / 2;
  if (turn > x && turn > y)
    return STIC_PLOT_ANGLE;
  return x >= y ? STIC_PLOT_X : STIC_PLOT_Y;
}

static void layout(stic_hud *h)
{
  int line = stic_font_height(h->small), pad = px(h, 6), strip, top, left, rest;

  strip = stic_font_height(h->large) + 7 * line + px(h, 5) + 2 * pad;
  h->view_top = line + px(h, 5);
  h->view_bottom = h->height - strip;
  top = h->view_bottom + pad;
  left = 3 * pad + stic_font_width(h->small, "spring moment") + stic_font_width(h->strong, "-00.000 N m");
  h->values = (stic_rect){pad, top, left, h->height - pad};
  rest = h->width - left - 3 * pad;
  h->cone_plot = (stic_rect){left + pad, top, left + pad + rest * 45 / 100, h->height - pad};
  h->time_plot = (stic_rect){h->cone_plot.x1 + pad, top, h->width - pad, h->height - pad};
}

bool stic_hud_init(stic_hud *h, const stic_render_settings *settings, const stic_scene *scene,
                   const stic_theme *theme)
{
  stic_rect box;

  memset(h, 0, sizeof *h);
  h->theme = theme;
  h->width = settings->width;
  h->height = settings->height;
  h->unit = fmin(settings->height, settings->width * 0.75) / 480.0;
  /* Text grows a little less than the picture: large pictures are seen on large screens. */
  h->small = stic_font_create(false, fmax(14.5 * pow(h->unit, 0.9), 8));
  h->strong = stic_font_create(true, fmax(14.5 * pow(h->unit, 0.9), 8));
  h->large = stic_font_create(true, fmax(20 * pow(h->unit, 0.9), 10));
  if (!h->small || !h->strong || !h->large) {
    stic_hud_free(h);
    return false;
  }
  h->plot = choose_plot(settings, scene);
  layout(h);
  box = h->cone_plot;
  h->cone_ground = malloc((size_t)(box.x1 - box.x0) * (size_t)(box.y1 - box.y0) * 4);
  return h->cone_ground != NULL;
}

void stic_hud_free(stic_hud *h)
{
  stic_font_destroy(h->small);
  stic_font_destroy(h->strong);
  stic_font_destroy(h->large);
  free(h->cone_ground);
  memset(h, 0, sizeof *h);
}

/* ---- legend -------------------------------------------------------------------------------- */

/* A sign's drawing around (x, y), and the room that it takes in px of a picture 480 px tall. */
typedef struct legend_entry {
  void (*draw)(const stic_hud *, const stic_canvas *, double x, double y);
  double room;
  const char *word;
} legend_entry;

#define SIGN_RADIUS 4.2

static void draw_stick(const stic_hud *h, const stic_canvas *c, double x, double y, double r)
{
  stic_canvas_disc(c, x, y, 1.25 * r, h->theme->panel);
  stic_canvas_disc(c, x, y, r, h->theme->stick);
}

static void draw_slip(const stic_hud *h, const stic_canvas *c, double x, double y, double r)
{
  stic_canvas_diamond(c, x, y, 1.6 * r, h->theme->stick);
  stic_canvas_diamond(c, x, y, 1.1 * r, h->theme->slip);
}

static void legend_stick(const stic_hud *h, const stic_canvas *c, double x, double y)
{
  draw_stick(h, c, x + SIGN_RADIUS * h->unit, y, SIGN_RADIUS * h->unit);
}

static void legend_slip(const stic_hud *h, const stic_canvas *c, double x, double y)
{
  draw_slip(h, c, x + 1.6 * SIGN_RADIUS * h->unit, y, SIGN_RADIUS * h->unit);
}

static void legend_cone(const stic_hud *h, const stic_canvas *c, double x, double y)
{
  double r = 1.2 * SIGN_RADIUS * h->unit, middle = x + 6 * h->unit;

  for (int s = -1; s <= 1; s += 2)
    stic_canvas_line(c, middle, y + r, middle + s * r, y - r, 2 * h->unit, h->theme->cone);
}

static void legend_force(const stic_hud *h, const stic_canvas *c, double x, double y)
{
  double r = SIGN_RADIUS * h->unit, u = h->unit, tip[2] = {x + 11 * u, y - r};

  stic_canvas_line(c, x + u, y + r, tip[0], tip[1], 2 * u, h->theme->text);
  stic_canvas_line(c, tip[0], tip[1], tip[0] - 5 * u, tip[1] + 0.5 * u, 2 * u, h->theme->text);
  stic_canvas_line(c, tip[0], tip[1], tip[0] - 1.5 * u, tip[1] + 5 * u, 2 * u, h->theme->text);
}

static void legend_target(const stic_hud *h, const stic_canvas *c, double x, double y)
{
  stic_canvas_dashes(c, x, y, x + 19 * h->unit, y, 2 * h->unit, 4 * h->unit, h->theme->hand);
}

static void legend_slipped(const stic_hud *h, const stic_canvas *c, double x, double y)
{
  int left = (int)x, top = (int)(y - SIGN_RADIUS * h->unit), bottom = (int)(y + SIGN_RADIUS * h->unit);

  stic_canvas_fill(c, (stic_rect){left, top, left + px(h, 13), bottom},
                   stic_color_fade(h->theme->friction, 0.3));
  stic_canvas_fill(c, (stic_rect){left, top, left + px(h, 2), bottom}, h->theme->friction);
}

/* The width that the time at the right end of the legend may take. */
static int time_room(const stic_hud *h)
{
  return stic_font_width(h->strong, "t = 00000.00 s") + px(h, 10);
}

void stic_hud_draw_fixed(const stic_hud *h, const stic_canvas *c)
{
  static const legend_entry entries[] = {
    {legend_stick, 12, "sticks"},         {legend_slip, 17, "slips"},
    {legend_cone, 15, "friction cone"},   {legend_force, 15, "contact force"},
    {legend_target, 23, "hand's target"}, {legend_slipped, 17, "slipped"}};
  double y = px(h, 3) + stic_font_height(h->small) / 2.0;
  int x = px(h, 6), line = px(h, 1) > 0 ? px(h, 1) : 1;

  for (size_t i = 0; i < sizeof entries / sizeof entries[0]; i++) {
    int word = x + px(h, entries[i].room), end = word + stic_font_width(h->small, entries[i].word);

    if (end > h->width - time_room(h))
      break;
    entries[i].draw(h, c, x, y);
    stic_canvas_text(c, h->small, word, px(h, 3), entries[i].word, h->theme->text);
    x = end + px(h, 12);
  }
  stic_canvas_fill(c, (stic_rect){0, h->view_bottom, h->width, h->height}, h->theme->panel);
  stic_canvas_fill(c, (stic_rect){0, h->view_bottom, h->width, h->view_bottom + line}, h->theme->line);
}

/* ---- values -------------------------------------------------------------------------------- */

static const char *state_words(stic_state state)
{
  switch (state) {
  case STIC_RELEASED: return "Released";
  case STIC_FREE: return "Free";
  case STIC_VERTEX: return "One vertex";
  case STIC_EDGE: return "Edge";
  case STIC_TWO_VERTEX: return "Two vertices";
  case STIC_CORNER: return "In the corner";
  case STIC_MULTI: return "Several contacts";
  }
  return "";
}

/* Sums over the contacts, and the largest share of a friction limit that one of them uses. */
typedef struct totals {
  double normal, friction, used;
} totals;

static totals total_of(const stic_scene *scene, const stic_result *r)
{
  totals t = {0, 0, 0};

  for (int i = 0; i < r->contact_count; i++) {
    const stic_contact *c = &r->contacts[i];
    double limit = scene->surfaces[c->surface].friction.mu_static * c->normal;

    t.normal += c->normal;
    t.friction += fabs(c->friction);
    if (limit > 0)
      t.used = fmax(t.used, fabs(c->friction) / limit);
  }
  return t;
}

static bool is_slipping(const stic_history *history)
{
  for (int i = 0; i < history->newest.contact_count; i++) {
    const stic_contact *c = &history->newest.contacts[i];

    if (stic_history_slipping(history, c->vertex, c->surface))
      return true;
  }
  return false;
}

static const char *doing_words(const stic_history *history, const totals *t)
{
  const stic_result *r = &history->newest;

  if (r->flags & STIC_FLAG_LOST)
    return "tracking lost";
  if (r->flags & STIC_FLAG_NO_ANSWER)
    return "no answer, kept";
  if (r->flags & STIC_FLAG_WEDGED)
    return "wedged";
  if (!r->contact_count)
    return "none";
  if (is_slipping(history))
    return "slips";
  return t->used > 0.95 ? "about to slip" : "sticks";
}

static void row(const stic_hud *h, const stic_canvas *c, int i, const char *name, const char *value,
                stic_color color)
{
  int line = stic_font_height(h->small), y = h->values.y0 + stic_font_height(h->large) + px(h, 3) + i * line;

  stic_canvas_text(c, h->small, h->values.x0 + px(h, 4), y, name, h->theme->muted);
  stic_canvas_text(c, h->strong, h->values.x1 - px(h, 4) - stic_font_width(h->strong, value), y, value,
                   color);
}

/* In the legend's line, on the right. */
static void draw_time(const stic_hud *h, const stic_canvas *c, const stic_result *r)
{
  char text[32];
  int w, right = h->width - px(h, 10), room = time_room(h);

  snprintf(text, sizeof text, "t = %.2f s", (double)r->t_ns * 1e-9);
  w = stic_font_width(h->strong, text);
  stic_canvas_fill(
    c, (stic_rect){h->width - (w + px(h, 10) > room ? w + px(h, 10) : room), 0, h->width, h->view_top},
    h->theme->background);
  stic_canvas_text(c, h->strong, right - w, px(h, 3), text, h->theme->text);
}

static void force_text(double newton, char *text, size_t size)
{
  stic_force_text(newton, text, size);
  strncat(text, " N", size - strlen(text) - 1);
}

/* What is only the rounding of a balance is shown as the zero that it is. */
static double without_rounding(double value, double scale)
{
  return fabs(value) > 1e-9 * scale ? value : 0;
}

static void draw_values(const stic_hud *h, const stic_canvas *c, const stic_scene *scene,
                        const stic_history *history)
{
  const stic_theme *theme = h->theme;
  const stic_result *r = &history->newest;
  totals t = total_of(scene, r);
  double size = stic_scene_size(scene), force_scale = scene->stiffness * size;
  double moment = without_rounding(r->moment, force_scale * size);
  const char *doing = doing_words(history, &t);
  bool moving = is_slipping(history) || t.used > 0.95;
  char text[64];

  stic_canvas_fill(c, h->values, theme->panel);
  stic_canvas_text(c, h->large, h->values.x0 + px(h, 4), h->values.y0, state_words(r->state), theme->text);
  row(h, c, 0, "contact", doing, moving ? theme->friction : theme->text);
  force_text(without_rounding(t.normal, force_scale), text, sizeof text);
  row(h, c, 1, "normal force", r->contact_count ? text : "\xe2\x80\x93", theme->normal);
  force_text(without_rounding(t.friction, force_scale), text, sizeof text);
  row(h, c, 2, "friction", r->contact_count ? text : "\xe2\x80\x93", theme->friction);
  snprintf(text, sizeof text, "%.0f %%", 100 * t.used);
  row(h, c, 3, "friction limit used", r->contact_count ? text : "\xe2\x80\x93",
      moving ? theme->friction : theme->text);
  force_text(without_rounding(hypot(r->force_x, r->force_y), force_scale), text, sizeof text);
  row(h, c, 4, "spring force", text, theme->spring);
  snprintf(text, sizeof text, moment != 0 && fabs(moment) < 0.0005 ? "%.0e N m" : "%.3f N m", moment);
  row(h, c, 5, "spring moment", text, theme->spring);
  snprintf(text, sizeof text, "%lld", (long long)r->slips);
  row(h, c, 6, "slips", text, theme->text);
}

/* ---- plots --------------------------------------------------------------------------------- */

typedef struct axes {
  stic_rect area;        /* px, inside the axes */
  double x0, x1, y0, y1; /* values at its borders */
} axes;

static double to_x(const axes *a, double value)
{
  return a->area.x0 + (value - a->x0) / (a->x1 - a->x0) * (a->area.x1 - a->area.x0);
}

static double to_y(const axes *a, double value)
{
  return a->area.y1 - (value - a->y0) / (a->y1 - a->y0) * (a->area.y1 - a->area.y0);
}

static void tick_text(double value, double step, char *text, size_t size)
{
  snprintf(text, size, "%.*f", stic_decimals(step), fabs(value) < step / 2 ? 0.0 : value);
}

static void draw_ticks(const stic_hud *h, const stic_canvas *c, const axes *a)
{
  double step = stic_round_up_125((a->x1 - a->x0) / 5), half = stic_font_height(h->small) / 2.0, first;
  int count = stic_multiples(a->x0, a->x1, step, TICKS_MAX, &first);
  char text[32];

  for (int i = 0; i < count; i++) {
    int x = (int)to_x(a, (first + i) * step), w;

    tick_text((first + i) * step, step, text, sizeof text);
    w = stic_font_width(h->small, text);
    stic_canvas_fill(c, (stic_rect){x, a->area.y0, x + 1, a->area.y1}, stic_color_fade(h->theme->line, 0.6));
    if (x - w / 2 >= a->area.x0 - px(h, 14) && x + w / 2 <= a->area.x1 + px(h, 6))
      stic_canvas_text(c, h->small, x - w / 2, a->area.y1 + px(h, 1), text, h->theme->muted);
  }
  step = stic_round_up_125((a->y1 - a->y0) / 5);
  count = stic_multiples(a->y0, a->y1, step, TICKS_MAX, &first);
  for (int i = 0; i < count; i++) {
    int y = (int)to_y(a, (first + i) * step);

    tick_text((first + i) * step, step, text, sizeof text);
    stic_canvas_fill(c, (stic_rect){a->area.x0, y, a->area.x1, y + 1}, stic_color_fade(h->theme->line, 0.6));
    stic_canvas_text(c, h->small, a->area.x0 - px(h, 4) - stic_font_width(h->small, text), (int)(y - half),
                     text, h->theme->muted);
  }
}

static axes make_axes(const stic_hud *h, stic_rect box, double x0, double x1, double y0, double y1)
{
  int line = stic_font_height(h->small);

  return (axes){{box.x0 +
                   stic_font_width(h->small, "\xe2\x88\x92"
                                             "0.00") +
                   px(h, 4),
                 box.y0 + line + px(h, 2), box.x1 - px(h, 6), box.y1 - line - px(h, 1)},
                x0,
                x1,
                y0,
                y1};
}

static void draw_axes(const stic_hud *h, const stic_canvas *c, stic_rect box, const axes *a)
{
  stic_canvas_fill(c, box, h->theme->panel);
  draw_ticks(h, c, a);
  stic_canvas_frame(c, a->area, 1, h->theme->line);
}

static stic_canvas clipped(const stic_canvas *c, stic_rect area)
{
  stic_canvas inside = *c;

  inside.clip = stic_rect_intersect(c->clip, area);
  return inside;
}

/* Words in colours one after the other. */
static int title(const stic_hud *h, const stic_canvas *c, int x, int y, const char *text, stic_color color,
                 bool strong)
{
  const stic_font *font = strong ? h->strong : h->small;

  stic_canvas_text(c, font, x, y, text, color);
  return x + stic_font_width(font, text);
}

/* Tints what friction allows and draws its limits. */
static void draw_limits(const stic_hud *h, const stic_canvas *c, const axes *a, const stic_friction *f)
{
  stic_color cone = h->theme->cone;
  double n = a->x1;

  for (int x = a->area.x0 + 1; x < a->area.x1; x++) {
    double normal = (x + 0.5 - a->area.x0) / (a->area.x1 - a->area.x0) * n;

    stic_canvas_fill(
      c, (stic_rect){x, (int)to_y(a, f->mu_static * normal), x + 1, (int)to_y(a, -f->mu_static * normal)},
      stic_color_fade(cone, 0.16));
  }
  for (int s = -1; s <= 1; s += 2) {
    stic_canvas_line(c, to_x(a, 0), to_y(a, 0), to_x(a, n), to_y(a, s * f->mu_static * n), 1.6 * h->unit,
                     cone);
    stic_canvas_dashes(c, to_x(a, 0), to_y(a, 0), to_x(a, n), to_y(a, s * f->mu_dynamic * n), 1.2 * h->unit,
                       4 * h->unit, cone);
  }
}

static void draw_cone_curve(const stic_hud *h, const stic_canvas *c, const axes *a,
                            const stic_history *history)
{
  const stic_theme *t = h->theme;
  double newest = (double)history->newest.t_ns * 1e-9;

  for (int i = 0; i < history->curve_count; i++) {
    const stic_curve_point *p = stic_history_curve(history, i);
    double young = 1 - (newest - p->t) / STIC_CURVE_SECONDS;

    for (int k = 0; k < p->contacts; k++)
      stic_canvas_disc(c, to_x(a, p->normal[k]), to_y(a, p->friction[k]), 1.4 * h->unit,
                       stic_color_fade(p->slipped ? t->friction : t->muted, 0.15 + 0.65 * fmax(young, 0)));
  }
  for (int k = 0; k < history->newest.contact_count; k++) {
    const stic_contact *now = &history->newest.contacts[k];
    bool slips = stic_history_slipping(history, now->vertex, now->surface);

    (slips ? draw_slip : draw_stick)(h, c, to_x(a, now->normal), to_y(a, now->friction),
                                     SIGN_RADIUS * h->unit);
  }
}

/* Axes, limits and title: they change with the scale only. */
static void draw_cone_ground(const stic_hud *h, const stic_canvas *c, const axes *a, const stic_scene *scene)
{
  stic_rect box = h->cone_plot;
  stic_canvas inside = clipped(c, a->area);
  int x;

  draw_axes(h, c, box, a);
  for (int i = 0; i < scene->surface_count; i++) {
    const stic_friction *f = &scene->surfaces[i].friction,
                        *before = i ? &scene->surfaces[i - 1].friction : NULL;

    /* Neighbours with the same numbers are one and the same pair of lines. */
    if (!before || before->mu_static != f->mu_static || before->mu_dynamic != f->mu_dynamic)
      draw_limits(h, &inside, a, f);
  }
  x = title(h, c, a->area.x0, box.y0, "friction", h->theme->friction, true);
  x = title(h, c, x, box.y0, " by ", h->theme->muted, false);
  x = title(h, c, x, box.y0, "normal", h->theme->normal, true);
  title(h, c, x, box.y0, " (N)", h->theme->muted, false);
}

/* Copies the box between the picture and its store, row by row. */
static void copy_box(const stic_canvas *c, stic_rect box, uint8_t *store, bool into_store)
{
  size_t row = (size_t)(box.x1 - box.x0) * 4;

  for (int y = box.y0; y < box.y1; y++, store += row) {
    uint8_t *pixels = c->pixels + ((size_t)y * (size_t)c->width + (size_t)box.x0) * 4;

    memcpy(into_store ? store : pixels, into_store ? pixels : store, row);
  }
}

static void draw_cone_plot(stic_hud *h, const stic_canvas *c, const stic_view *view,
                           const stic_history *history)
{
  double full = view->force_full, mu = 0.05;
  stic_canvas inside;
  axes a;

  for (int i = 0; i < view->scene->surface_count; i++)
    mu = fmax(mu, view->scene->surfaces[i].friction.mu_static);
  a = make_axes(h, h->cone_plot, 0, full, -1.15 * mu * full, 1.15 * mu * full);
  if (h->cone_full != full)
    draw_cone_ground(h, c, &a, view->scene);
  copy_box(c, h->cone_plot, h->cone_ground, h->cone_full != full);
  h->cone_full = full;
  inside = clipped(c, a.area);
  draw_cone_curve(h, &inside, &a, history);
}

static double curve_value(const stic_hud *h, const double of[3])
{
  return h->plot == STIC_PLOT_X ? of[0] : h->plot == STIC_PLOT_Y ? of[1] : of[2] * STIC_DEG_PER_RAD;
}

static void value_range(const stic_hud *h, const stic_history *history, double least, double *low,
                        double *high)
{
  double step;

  *low = 1e300;
  *high = -1e300;
  for (int i = 0; i < history->curve_count; i++) {
    const stic_curve_point *p = stic_history_curve(history, i);
    double hand = curve_value(h, p->hand), held = curve_value(h, p->held);

    *low = fmin(*low, fmin(hand, held));
    *high = fmax(*high, fmax(hand, held));
  }
  step = stic_round_up_125(fmax(*high - *low, least) / 3);
  *low = floor(*low / step - 0.05) * step;
  *high = ceil(*high / step + 0.05) * step;
  /* Far from the origin the step may be lost. */
  if (!(*high > *low))
    *high = *low + fmax(step, 1e-9 * fabs(*low));
}

static void draw_curves(const stic_hud *h, const stic_canvas *c, const axes *a, const stic_history *history)
{
  const stic_theme *t = h->theme;

  for (int i = 1; i < history->curve_count; i++) {
    const stic_curve_point *p = stic_history_curve(history, i - 1), *q = stic_history_curve(history, i);

    stic_canvas_line(c, to_x(a, p->t), to_y(a, curve_value(h, p->hand)), to_x(a, q->t),
                     to_y(a, curve_value(h, q->hand)), 1.4 * h->unit, t->hand);
    stic_canvas_line(c, to_x(a, p->t), to_y(a, curve_value(h, p->held)), to_x(a, q->t),
                     to_y(a, curve_value(h, q->held)), 2.2 * h->unit, t->outline);
    if (q->slipped)
      stic_canvas_fill(
        c, (stic_rect){(int)to_x(a, q->t), a->area.y1 - px(h, 7), (int)to_x(a, q->t) + px(h, 2), a->area.y1},
        t->friction);
  }
}

static void draw_time_plot(const stic_hud *h, const stic_canvas *c, const stic_view *view,
                           const stic_history *history)
{
  static const char *const names[] = {"", "x", "y", "angle"};
  double now = (double)history->newest.t_ns * 1e-9, start = stic_history_curve(history, 0)->t, low, high;
  double end = fmax(now, start + STIC_CURVE_SECONDS);
  stic_rect box = h->time_plot;
  stic_canvas inside;
  axes a;
  int x;

  value_range(h, history, h->plot == STIC_PLOT_ANGLE ? 3 : 0.3 * view->size, &low, &high);
  a = make_axes(h, box, end - STIC_CURVE_SECONDS, end, low, high);
  draw_axes(h, c, box, &a);
  inside = clipped(c, a.area);
  draw_curves(h, &inside, &a, history);
  x = title(h, c, a.area.x0, box.y0, names[h->plot], h->theme->text, false);
  x = title(h, c, x, box.y0, " of ", h->theme->muted, false);
  x = title(h, c, x, box.y0, "object", h->theme->outline, true);
  x = title(h, c, x, box.y0, ", ", h->theme->muted, false);
  x = title(h, c, x, box.y0, "hand", h->theme->hand, true);
  title(h, c, x, box.y0, h->plot == STIC_PLOT_ANGLE ? " (\xc2\xb0)" : " (m)", h->theme->muted, false);
}

void stic_hud_draw(stic_hud *h, const stic_canvas *c, const stic_view *view, const stic_history *history)
{
  draw_time(h, c, &history->newest);
  draw_values(h, c, view->scene, history);
  draw_cone_plot(h, c, view, history);
  draw_time_plot(h, c, view, history);
}

/* ---- scale bar ----------------------------------------------------------------------------- */

static stic_rect scale_area(const stic_hud *h)
{
  int w = px(h, 190), line = stic_font_height(h->small);

  return (stic_rect){h->width - w, h->view_bottom - line - px(h, 10), h->width, h->view_bottom};
}

stic_rect stic_hud_note_area(const stic_hud *h)
{
  stic_rect scale = scale_area(h);

  return (stic_rect){0, scale.y0, scale.x0, scale.y1};
}

static void draw_note(const stic_hud *h, const stic_canvas *c, int top)
{
  int left = px(h, 10), w = stic_font_width(h->small, h->note), line = stic_font_height(h->small);

  stic_canvas_fill(c, (stic_rect){left - px(h, 4), top, left + w + px(h, 4), top + line}, h->theme->panel);
  stic_canvas_text(c, h->small, left, top, h->note, h->theme->muted);
}

void stic_hud_draw_scale(const stic_hud *h, const stic_canvas *c, const stic_view *view)
{
  double middle[3], newton, force;
  int line = stic_font_height(h->small), right = h->width - px(h, 10),
      y = h->view_bottom - line / 2 - px(h, 6), length;
  char text[48];

  for (int k = 0; k < 3; k++)
    middle[k] = (view->low[k] + view->high[k]) / 2;
  newton = view->force_length / view->force_full / stic_camera_pixel_size(&view->camera, middle);
  force = stic_round_up_125(35 * h->unit / newton);
  length = (int)(force * newton + 0.5);
  snprintf(text, sizeof text, "force %g N", force);
  for (int i = 1; i >= 0; i--) {
    stic_color color = i ? h->theme->panel : h->theme->text;
    double width = (i ? 5 : 2) * h->unit;

    stic_canvas_line(c, right - length, y, right, y, width, color);
    stic_canvas_line(c, right - length, y - px(h, 4), right - length, y + px(h, 4), width, color);
    stic_canvas_line(c, right, y - px(h, 4), right, y + px(h, 4), width, color);
  }
  stic_canvas_text_rimmed(c, h->small, right - length - px(h, 7) - stic_font_width(h->small, text),
                          y - line / 2, text, h->theme->text, h->theme->panel);
  if (h->note[0])
    draw_note(h, c, y - line / 2);
}

/* ---- labels -------------------------------------------------------------------------------- */

static bool overlaps(const stic_rect *areas, int count, stic_rect r)
{
  for (int i = 0; i < count; i++) {
    if (!stic_rect_empty(stic_rect_intersect(areas[i], r)))
      return true;
  }
  return false;
}

/* The label's box when it lies in direction `away` from what it is about. */
static stic_rect label_box(const stic_hud *h, const stic_label *l, const double away[2], double gap)
{
  const stic_font *font = l->strong ? h->strong : h->small;
  int w = stic_font_width(font, l->text) + 2, line = stic_font_height(font);
  double x = l->at[0] + away[0] * (w / 2.0 + gap), y = l->at[1] + away[1] * (line / 2.0 + gap) + h->view_top;
  int left = (int)floor(x - w / 2.0 + 0.5), top = (int)floor(y - line / 2.0 + 0.5);

  return (stic_rect){left, top, left + w, top + line};
}

/* True if the box covers something that must be seen, such as the head of an arrow. */
static bool covers_sign(const stic_hud *h, const stic_labels *labels, stic_rect r)
{
  for (int i = 0; i < labels->sign_count; i++) {
    const double *at = labels->signs[i];
    double reach = 7 * h->unit, y = at[1] + h->view_top;

    if (at[0] > r.x0 - reach && at[0] < r.x1 + reach && y > r.y0 - reach && y < r.y1 + reach)
      return true;
  }
  return false;
}

static stic_rect find_place(const stic_hud *h, const stic_labels *labels, const stic_label *l,
                            const stic_rect *taken, int count)
{
  /* cos and sin of 0, 45, -45, 90, -90, 135, -135, 180 degrees */
  static const double turns[8][2] = {{1, 0},  {0.7071, 0.7071},  {0.7071, -0.7071},  {0, 1},
                                     {0, -1}, {-0.7071, 0.7071}, {-0.7071, -0.7071}, {-1, 0}};
  stic_rect scale = scale_area(h);

  for (int i = 0; i < (l->firm ? 1 : 16); i++) {
    const double *turn = turns[i % 8];
    double away[2] = {l->away[0] * turn[0] - l->away[1] * turn[1],
                      l->away[0] * turn[1] + l->away[1] * turn[0]};
    stic_rect r = label_box(h, l, away, l->gap * (i < 8 ? 1 : 2.5));

    if (r.x0 >= 2 && r.x1 <= h->width - 2 && r.y0 >= h->view_top + 1 && r.y1 <= h->view_bottom - 2 &&
        !overlaps(taken, count, r) && !overlaps(&scale, 1, r) && !covers_sign(h, labels, r))
      return r;
  }
  return (stic_rect){0, 0, 0, 0};
}

void stic_hud_place_labels(const stic_hud *h, const stic_labels *labels, int first, stic_rect *areas)
{
  for (int i = first; i < labels->count; i++)
    areas[i] = find_place(h, labels, &labels->items[i], areas, i);
}

void stic_hud_draw_labels(const stic_hud *h, const stic_canvas *c, const stic_labels *labels,
                          const stic_rect *areas)
{
  for (int i = 0; i < labels->count; i++) {
    const stic_label *l = &labels->items[i];

    if (!stic_rect_empty(stic_rect_intersect(areas[i], c->clip)))
      stic_canvas_text_rimmed(c, l->strong ? h->strong : h->small, areas[i].x0 + 1, areas[i].y0, l->text,
                              l->color, h->theme->panel);
  }
}

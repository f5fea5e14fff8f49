#include "moments.h"

#include "../angle.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEEDS_MAX 6 /* told of one row; more could not be read */

/* ---- events in words --------------------------------------------------------------------- */

/* Events of one row that are alike, taken together. */
typedef struct deed {
  stic_event_kind kind;
  int vertex, surface, times;
  double length; /* sum */
} deed;

static int gather(const stic_event *events, int count, deed *deeds)
{
  int n = 0;

  for (int i = 0; i < count; i++) {
    const stic_event *e = &events[i];
    int k = 0;

    while (k < n &&
           (deeds[k].kind != e->kind || deeds[k].vertex != e->vertex || deeds[k].surface != e->surface))
      k++;
    if (k == DEEDS_MAX)
      continue;
    if (k == n)
      deeds[n++] = (deed){e->kind, e->vertex, e->surface, 0, 0};
    deeds[k].times++;
    deeds[k].length += fabs(e->length);
  }
  return n;
}

static void surface_text(const stic_scene *scene, int surface, char *out, size_t out_size)
{
  if (surface >= 0 && surface < scene->surface_count && scene->surfaces[surface].name[0])
    snprintf(out, out_size, "%s", scene->surfaces[surface].name);
  else
    snprintf(out, out_size, "surface %d", surface);
}

static void deed_text(const stic_scene *scene, const deed *d, char *out, size_t out_size)
{
  char on[STIC_NAME_MAX], times[24] = "";

  surface_text(scene, d->surface, on, sizeof on);
  if (d->times > 1)
    snprintf(times, sizeof times, " in %d slips", d->times);
  switch (d->kind) {
  case STIC_EVENT_TOUCH: snprintf(out, out_size, "vertex %d touches %s", d->vertex, on); break;
  case STIC_EVENT_OPEN: snprintf(out, out_size, "vertex %d leaves %s", d->vertex, on); break;
  case STIC_EVENT_SLIP:
    snprintf(out, out_size, "vertex %d slips %.3g mm on %s%s", d->vertex, d->length * 1e3, on, times);
    break;
  case STIC_EVENT_SNAP:
    snprintf(out, out_size, "snaps round by %.3g\xc2\xb0", d->length * STIC_DEG_PER_RAD);
    break;
  case STIC_EVENT_TAKE: snprintf(out, out_size, "taken"); break;
  case STIC_EVENT_RELEASE: snprintf(out, out_size, "let go"); break;
  }
}

static void row_text(const stic_scene *scene, const stic_event *events, int count, char *out)
{
  deed deeds[DEEDS_MAX];
  const int n = gather(events, count, deeds);
  size_t used = 0;

  out[0] = '\0';
  for (int i = 0; i < n && used + 1 < STIC_MOMENT_TEXT_MAX; i++) {
    char text[128];

    deed_text(scene, &deeds[i], text, sizeof text);
    snprintf(out + used, STIC_MOMENT_TEXT_MAX - used, "%s%s", i > 0 ? ", " : "", text);
    used = strlen(out);
  }
}

/* ---- gathering --------------------------------------------------------------------------- */

static bool add_change(stic_moments *m, const stic_moment *moment)
{
  if (m->change_count == m->change_room) {
    const int room = m->change_room > 0 ? 2 * m->change_room : 64;
    stic_moment *changes = realloc(m->changes, (size_t)room * sizeof *changes);

    if (!changes)
      return false;
    m->changes = changes;
    m->change_room = room;
  }
  m->changes[m->change_count++] = *moment;
  return true;
}

static void keep(stic_moment *place, const stic_moment *moment, unsigned why)
{
  *place = *moment;
  place->why = why;
}

static void add_events(stic_moments *m, const stic_moment *now, const stic_event *events, int count)
{
  for (int i = 0; i < count; i++) {
    const double length = fabs(events[i].length);

    if (events[i].kind == STIC_EVENT_SLIP && !m->first_slip.why)
      keep(&m->first_slip, now, STIC_MOMENT_FIRST_SLIP);
    if (events[i].kind == STIC_EVENT_SLIP && length > m->slip) {
      m->slip = length;
      keep(&m->largest_slip, now, STIC_MOMENT_LARGEST_SLIP);
    }
    if (events[i].kind == STIC_EVENT_SNAP && length > m->snap) {
      m->snap = length;
      keep(&m->largest_snap, now, STIC_MOMENT_LARGEST_SNAP);
    }
  }
}

bool stic_moments_add(stic_moments *m, const stic_scene *scene, const stic_result *r,
                      const stic_event *events, int event_count)
{
  stic_moment now = {.row = m->rows, .t_ns = r->t_ns, .before = m->state, .state = r->state};

  if (m->rows == 0)
    now.before = r->state;
  row_text(scene, events, event_count, now.what);
  if (m->rows == 0)
    keep(&m->start, &now, STIC_MOMENT_START);
  keep(&m->end, &now, STIC_MOMENT_END);
  add_events(m, &now, events, event_count);
  m->rows++;
  m->state = r->state;
  now.why = STIC_MOMENT_CHANGE;
  return now.before == now.state || add_change(m, &now);
}

void stic_moments_free(stic_moments *m)
{
  free(m->changes);
  memset(m, 0, sizeof *m);
}

/* ---- choosing ---------------------------------------------------------------------------- */

/* Puts a moment in its place by time; one of the same row only gets a further reason. */
static int insert(stic_moment *list, int count, const stic_moment *moment)
{
  int at = count;

  while (at > 0 && list[at - 1].row > moment->row)
    at--;
  if (at > 0 && list[at - 1].row == moment->row) {
    list[at - 1].why |= moment->why;
    return count;
  }
  memmove(list + at + 1, list + at, (size_t)(count - at) * sizeof *list);
  list[at] = *moment;
  return count + 1;
}

static int64_t distance_ns(const stic_moment *a, const stic_moment *b)
{
  return a->t_ns > b->t_ns ? a->t_ns - b->t_ns : b->t_ns - a->t_ns;
}

/* The change farthest in time from all that are chosen, 0 away from those already there; NULL: all are there. */
static const stic_moment *loneliest(const stic_moments *m, const stic_moment *chosen, int count)
{
  const stic_moment *found = NULL;
  int64_t most = 0;

  for (int i = 0; i < m->change_count; i++) {
    int64_t least = INT64_MAX;

    for (int k = 0; k < count; k++) {
      const int64_t d = distance_ns(&m->changes[i], &chosen[k]);

      least = d < least ? d : least;
    }
    if (least > most) {
      most = least;
      found = &m->changes[i];
    }
  }
  return found;
}

/* A chosen row that is also a change says so, whatever it was chosen for. */
static void tell_changes(const stic_moments *m, stic_moment *chosen, int count)
{
  for (int i = 0, k = 0; i < m->change_count && k < count; i++) {
    while (k < count && chosen[k].row < m->changes[i].row)
      k++;
    if (k < count && chosen[k].row == m->changes[i].row)
      chosen[k].why |= STIC_MOMENT_CHANGE;
  }
}

int stic_moments_choose(const stic_moments *m, int most, stic_moment *out)
{
  const stic_moment *const firm[] = {&m->largest_slip, &m->end, &m->first_slip, &m->largest_snap, &m->start};
  int count = 0;

  for (size_t i = 0; i < sizeof firm / sizeof firm[0]; i++) {
    bool there = false;

    for (int k = 0; k < count; k++)
      there = there || out[k].row == firm[i]->row;
    if (firm[i]->why && (there || count < most))
      count = insert(out, count, firm[i]);
  }
  while (count < most) {
    const stic_moment *change = loneliest(m, out, count);

    if (!change)
      break;
    count = insert(out, count, change);
  }
  tell_changes(m, out, count);
  return count;
}

/* ---- captions ---------------------------------------------------------------------------- */

void stic_moment_title(const stic_moment *m, char *out, size_t out_size)
{
  if (m->why & STIC_MOMENT_CHANGE)
    snprintf(out, out_size, "%s \xe2\x86\x92 %s", stic_state_name(m->before), stic_state_name(m->state));
  else
    snprintf(out, out_size, "%s", stic_state_name(m->state));
}

void stic_moment_text(const stic_moment *m, char *out, size_t out_size)
{
  static const struct {
    unsigned why;
    const char *words;
  } reasons[] = {{STIC_MOMENT_START, "start"},
                 {STIC_MOMENT_FIRST_SLIP | STIC_MOMENT_LARGEST_SLIP, "first and largest slip"},
                 {STIC_MOMENT_FIRST_SLIP, "first slip"},
                 {STIC_MOMENT_LARGEST_SLIP, "largest slip"},
                 {STIC_MOMENT_LARGEST_SNAP, "largest snap"},
                 {STIC_MOMENT_END, "end"}};
  unsigned told = 0;
  size_t used = 0;

  out[0] = '\0';
  for (size_t i = 0; i < sizeof reasons / sizeof reasons[0] && used < out_size; i++) {
    const unsigned why = reasons[i].why;

    if ((m->why & why) != why || (told & why) == why)
      continue;
    snprintf(out + used, out_size - used, "%s%s", used > 0 ? ", " : "", reasons[i].words);
    used = strlen(out);
    told |= why;
  }
  if (m->what[0] && used < out_size)
    snprintf(out + used, out_size - used, "%s%s", used > 0 ? ": " : "", m->what);
}

/* Which vertex reaches which surface first [5, first paragraph], and the list of contacts. */
#include "statics.h"

/* Well above what a place can be off by rounding where the object is, however far away the hand is. */
static real rounding_here(const core *c)
{
  return 16 * REAL_EPSILON * (c->body.world_extent + r_abs(c->p.x) + r_abs(c->p.y) + c->body.size);
}

static bool is_contact(const core *c, int vertex, int on)
{
  for (int i = 0; i < c->contact_count; i++)
    if (c->contacts[i].vertex == vertex && c->contacts[i].surface == on)
      return true;
  return false;
}

static bool is_opened(const core *c, int vertex, int on)
{
  for (int i = 0; i < c->opened_count; i++)
    if (c->opened[i].vertex == vertex && c->opened[i].surface == on)
      return true;
  return false;
}

static void forget_opened_that_left(core *c)
{
  int kept = 0;
  for (int i = 0; i < c->opened_count; i++) {
    pair o = c->opened[i];
    if (gap_of(c, world_vertex(c, o.vertex), o.surface) <= TOLERANCE * c->body.size + c->noise)
      c->opened[kept++] = o;
  }
  c->opened_count = kept;
}

/* Takes rounding off a place, so that it cannot add up over many slides. A contact that is farther off (it may be by
 * 1e-12 of size) keeps its gap: pulling it onto the surface would move the object. */
static vec onto_surface(const core *c, vec place, int on)
{
  real gap = gap_of(c, place, on);
  return r_abs(gap) <= 4 * c->noise ? v_mix(place, -gap, c->body.surfaces[on].n) : place;
}

static void add_contact(core *c, int vertex, int on)
{
  if (c->contact_count == CONTACTS_MAX) {
    c->report->flags |= STIC_FLAG_LIMIT;
    c->full = true;
    return;
  }
  vec place = onto_surface(c, world_vertex(c, vertex), on);
  /* A vertex that already rests on another surface has one place. */
  for (int i = 0; i < c->contact_count; i++)
    if (c->contacts[i].vertex == vertex)
      place = c->contacts[i].place;
  contact k = {vertex, on, place};
  c->contacts[c->contact_count++] = k;
  c->balance.known = false;
  c->happened = true;
  record(c, STIC_EVENT_TOUCH, vertex, on, place, 0);
}

static void remove_contact(core *c, int index)
{
  contact k = c->contacts[index];
  for (int i = index; i + 1 < c->contact_count; i++)
    c->contacts[i] = c->contacts[i + 1];
  c->contact_count--;
  c->balance.known = false;
  if (!is_opened(c, k.vertex, k.surface) && c->opened_count < PAIRS_MAX) {
    pair o = {k.vertex, k.surface};
    c->opened[c->opened_count++] = o;
  }
  c->opened_any = true;
  c->happened = true;
  record(c, STIC_EVENT_OPEN, k.vertex, k.surface, k.place, 0);
}

/* Asks the detector again when the object can leave the region for which the last answer holds. */
static void near_update(core *c, real travel)
{
  near_list *near = &c->near;
  real slack = 8 * c->noise + TOLERANCE * c->body.size;
  if (near->valid) {
    vec moved = v_sub(c->p, near->p);
    real turned = r_min(r_abs(c->theta - near->theta), 2);
    if (v_length(moved) + turned * c->body.radius + travel + slack <= near->reach)
      return;
  }
  near->reach = R(1.5) * travel + c->body.size / 4 + slack;
  near->p = c->p;
  near->theta = c->theta;
  near->valid = true;
  near->count = 0;
  for (int i = 0; i < c->parts.surface_count; i++)
    c->gap_scratch[i] = (double)(gap_of(c, c->p, c->parts.surfaces[i])) * c->unit;
  double widened = (double)near->reach * c->unit * (1 + 64 * (double)REAL_EPSILON);
  stic_collide_near(c->collider, c->gap_scratch, (double)c->rot.x, (double)c->rot.y, widened,
                    c->mask_scratch);
  for (int i = 0; i < c->parts.surface_count; i++) {
    if (!c->mask_scratch[i])
      continue;
    near->surfaces[near->count] = c->parts.surfaces[i];
    near->vertices[near->count++] = c->mask_scratch[i];
  }
}

/* Keeps the earlier touch; of two at once the lower vertex, then the lower surface. */
static void keep_earlier(touch *best, real at, int vertex, int on)
{
  bool tie = at == best->at && at < R_HUGE &&
             (vertex < best->vertex || (vertex == best->vertex && on < best->surface));
  if (at < best->at || tie) {
    touch t = {at, vertex, on};
    *best = t;
  }
}

/* The next near pair that is no contact; false: no more. Begins with a zeroed `k`. */
static bool next_near(const core *c, near_pair *k)
{
  for (;;) {
    while (k->left == 0) {
      if (k->listed == c->near.count)
        return false;
      k->surface = c->near.surfaces[k->listed];
      k->left = c->near.vertices[k->listed++];
      k->vertex = -1;
    }
    do {
      k->vertex++;
      bool found = k->left & 1;
      k->left >>= 1;
      if (found && !is_contact(c, k->vertex, k->surface))
        return true;
    } while (k->left);
  }
}

static void add_touching(core *c)
{
  near_update(c, 0);
  for (near_pair k = {0}; next_near(c, &k);)
    if (!is_opened(c, k.vertex, k.surface) &&
        gap_of(c, world_vertex(c, k.vertex), k.surface) <= TOLERANCE * c->body.size + c->noise)
      add_contact(c, k.vertex, k.surface);
}

/* The object goes straight by `travel` (of its holding point) and turns by `turn` about it, both evenly:
 * the first touch as a fraction of the way. */
static touch first_touch_moving(core *c, vec travel, real turn)
{
  touch best = {R_HUGE, 0, 0};
  real radius = c->body.radius + v_length(c->b);
  near_update(c, v_length(travel) + r_min(r_abs(turn), 2) * radius);
  vec g = holding_point(c);
  for (near_pair k = {0}; next_near(c, &k);) {
    vec n = c->body.surfaces[k.surface].n;
    real base = gap_of(c, g, k.surface), drift = v_dot(n, travel);
    if (r_min(base, base + drift) > radius + c->noise) {
      k.left = 0; /* nor can the others on this surface */
      continue;
    }
    vec e = rotate(c->rot, v_sub(c->body.vertices[k.vertex], c->b));
    real w_c = v_dot(n, e);
    if (turn == 0 && r_min(base, base + drift) + w_c > c->noise)
      continue;
    wave w = {base, w_c, v_dot(n, v_perp(e))};
    keep_earlier(&best, drift_first_down(w, turn, drift, c->noise, &c->report->iterations), k.vertex,
                 k.surface);
  }
  return best;
}

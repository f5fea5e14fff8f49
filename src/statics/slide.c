/* SLIDE: "the slip motion itself is not calculated ...; we calculate only the endpoint of the slip motion
 * that occurs after the equilibrium under a dynamic friction stood" (5.1). A touch, or a normal force
 * that vanishes, ends it earlier. */
#include "statics.h"

enum { REVERSALS_MAX = 8 };

/* The contact has come to a new place on its surface. */
static void slide_to(core *c, contact *k, vec place)
{
  /* Coming back from far away, the place has the rounding of where it was. */
  vec at = world_vertex(c, k->vertex);
  if (v_length(v_sub(at, place)) > rounding_here(c))
    place = at;
  vec on_surface = onto_surface(c, place, k->surface);
  real length = v_length(v_sub(on_surface, k->place));
  k->place = on_surface;
  c->balance.known = false;
  if (length <= R(1e-12) * c->body.size)
    return;
  c->longest_slide = r_max(c->longest_slide, length);
  c->happened = true;
  record(c, STIC_EVENT_SLIP, k->vertex, k->surface, on_surface, length);
}

static void slide_ended(core *c, bool at_zero, real sense)
{
  c->slid_to_zero = at_zero;
  c->slide_sense = sense;
}

static void finish_slide(core *c, touch t)
{
  if (t.at < R_HUGE)
    add_contact(c, t.vertex, t.surface);
  add_touching(c);
}

/* 5.1: "a friction force directed opposing to the direction of hand's tangential force": the sense in which
 * a contact slips. Of the four end points that the paper counts this leaves the one with less energy. */
static real slip_sense(const core *c, const surface *s)
{
  return r_sign(v_dot(spring_force(c), s->t));
}

/* ---- one vertex [5.1] ---- */

static void slide_vertex(core *c, int index)
{
  contact *k = &c->contacts[index];
  const surface *s = &c->body.surfaces[k->surface];
  vec force = spring_force(c);
  real sigma = slip_sense(c, s), friction = sigma * s->mu_d;
  /* First along the surface at the present angle. */
  vec travel = v_scale(s->t, v_dot(force, s->t) + friction * v_dot(force, s->n));
  touch t = first_touch_moving(c, travel, 0);
  if (t.at < R_HUGE)
    travel = v_scale(travel, t.at);
  c->p = v_add(c->p, travel);
  vec place = v_add(k->place, travel);
  if (t.at == R_HUGE) {
    /* Then the angle, the place following from it. */
    real moment = spring_moment_about(c, place);
    c->turn_done = true;
    if (!is_balanced(c, moment)) {
      path f = path_sliding(c, k->vertex, place, s->t, s->n, friction, r_sign(moment));
      wave normal = path_force_along(&f, v_neg(s->n));
      real x, x_normal = wave_first_down(&normal, 0, 2 * R_PI);
      bool zero = curve_first_zero(&f.drive, r_min(x_normal, 2 * R_PI), &x, &c->report->iterations);
      t = path_first_touch(c, &f, x);
      c->turn_done = zero && t.at == R_HUGE;
      if (!zero && x_normal == R_HUGE && t.at == R_HUGE)
        c->report->flags |= STIC_FLAG_LIMIT;
      if (t.at < R_HUGE)
        x = t.at;
      path_set_pose(c, &f, x);
      place = path_place(&f, x);
    }
  }
  slide_to(c, k, place);
  slide_ended(c, c->turn_done, sigma);
  finish_slide(c, t);
}

/* ---- two contacts on parallel surfaces: an edge [5.2], or the walls of a slot ---- */

static bool are_parallel(const core *c, int first, int second)
{
  const surface *a = &c->body.surfaces[c->contacts[first].surface];
  const surface *b = &c->body.surfaces[c->contacts[second].surface];
  return r_abs(v_cross(a->n, b->n)) <= 16 * REAL_EPSILON;
}

/* Normal forces while both contacts slide in `sense` along the first one's tangent, and their change per
 * distance slid. While the tangential force is not balanced yet, moments depend on the point they are taken about.
 * In an edge that is a point of the surface: friction drops out, and the split is that of statics. Between the walls
 * of a slot it is the holding point, where the spring's force acts; the normal forces then stay as they are. */
typedef struct pair_normals {
  real first, second, first_rate, second_rate;
  real drive, drive_rate; /* unbalanced tangential force along the motion */
} pair_normals;

static bool normals_along_walls(const core *c, int first, int second, real sense, pair_normals *p)
{
  const contact *i = &c->contacts[first], *k = &c->contacts[second];
  const surface *a = &c->body.surfaces[i->surface], *b = &c->body.surfaces[k->surface];
  vec force = spring_force(c), g = holding_point(c), d = v_sub(k->place, i->place);
  real pressed = -v_dot(force, a->n), facing = r_sign(v_dot(a->n, b->n)), lever, scale;
  const bool is_edge = facing > 0;
  if (is_edge) {
    scale = v_length(d);
    lever = v_cross(d, b->n);
  } else {
    real lever_first = v_cross(v_sub(i->place, g), v_mix(a->n, -sense * a->mu_d, a->t));
    real lever_second = v_cross(v_sub(k->place, g), v_mix(b->n, -sense * b->mu_d, a->t));
    scale = (r_abs(lever_first) + r_abs(lever_second)) + v_length(d);
    lever = lever_first + lever_second;
    p->second = -(spring_moment(c) + lever_first * pressed) / lever;
    p->second_rate = 0;
  }
  if (r_abs(lever) <= 16 * REAL_EPSILON * scale)
    return false;
  if (is_edge) {
    p->second = -spring_moment_about(c, i->place) / lever;
    p->second_rate = sense * v_cross(v_sub(g, i->place), a->t) / lever;
  }
  p->first = pressed - facing * p->second;
  p->first_rate = -facing * p->second_rate;
  p->drive = sense * v_dot(force, a->t) - a->mu_d * p->first - b->mu_d * p->second;
  p->drive_rate = -1 - a->mu_d * p->first_rate - b->mu_d * p->second_rate;
  return true;
}

static bool edge_or_slot_starts(const core *c, int first, int second, real *sense, vec *velocity)
{
  const surface *a = &c->body.surfaces[c->contacts[first].surface];
  pair_normals p;
  *sense = slip_sense(c, a);
  *velocity = v_scale(a->t, *sense);
  real above = balance_slack(c);
  return normals_along_walls(c, first, second, *sense, &p) && p.first > above && p.second > above &&
         p.drive > above;
}

static real falls_to_zero(real value, real rate)
{
  return rate < 0 ? value / -rate : R_HUGE;
}

static void slide_edge_or_slot(core *c, int first, int second, real sense)
{
  contact *i = &c->contacts[first], *k = &c->contacts[second];
  pair_normals p;
  if (!normals_along_walls(c, first, second, sense, &p))
    return;
  real rest = falls_to_zero(p.drive, p.drive_rate);
  real lift = r_min(falls_to_zero(p.first, p.first_rate), falls_to_zero(p.second, p.second_rate));
  real length = r_min(rest, lift);
  vec travel = v_scale(c->body.surfaces[i->surface].t, sense * length);
  touch t = first_touch_moving(c, travel, 0);
  if (t.at < R_HUGE)
    travel = v_scale(travel, t.at);
  c->p = v_add(c->p, travel);
  slide_to(c, i, v_add(i->place, travel));
  slide_to(c, k, v_add(k->place, travel));
  slide_ended(c, rest <= lift && t.at == R_HUGE, sense);
  finish_slide(c, t);
}

/* ---- two vertices on two surfaces: an ellipse trammel [5.3] ---- */

/* Both contacts slide; each one's friction opposes its own motion. */
typedef struct trammel {
  path path;                      /* reference vertex: the first contact's */
  vec e, e_turn;                  /* second contact from the first, and dir * perp(e) */
  wave speed_first, speed_second; /* of the contacts along their tangents, per angle turned */
} trammel;

static trammel trammel_path(const core *c, int first, int second, real dir)
{
  const contact *i = &c->contacts[first], *k = &c->contacts[second];
  const surface *a = &c->body.surfaces[i->surface], *b = &c->body.surfaces[k->surface];
  trammel m;
  real across = v_dot(b->n, a->t);
  m.e = rotate(c->rot, v_sub(c->body.vertices[k->vertex], c->body.vertices[i->vertex]));
  m.e_turn = turn_of(m.e, dir);
  m.path = path_start(c, i->vertex, i->place, a->t, dir);
  /* Takes back the rounding of earlier slides, so that it cannot add up. */
  real off = gap_of(c, v_add(i->place, m.e), k->surface);
  if (r_abs(across) > R(1e-3) && r_abs(off) <= 4 * c->noise)
    m.path.origin = v_mix(i->place, -off / across, a->t);
  m.path.xi_c = -v_dot(b->n, m.e) / across;
  m.path.xi_s = -v_dot(b->n, m.e_turn) / across;
  finish_path(c, &m.path);
  real along = v_dot(b->t, a->t);
  m.speed_first = (wave){0, m.path.xi_s, -m.path.xi_c};
  m.speed_second =
    (wave){0, along * m.path.xi_s + v_dot(b->t, m.e_turn), -along * m.path.xi_c - v_dot(b->t, m.e)};
  return m;
}

/* Sense of a contact's own motion at x, just after a reversal by its acceleration. */
static real sense_at(const wave *speed, real x)
{
  real v = wave_at(speed, x), still = 64 * REAL_EPSILON * (r_abs(speed->c) + r_abs(speed->s));
  return r_sign(r_abs(v) > still ? v : wave_rate(speed, x));
}

/* Normal forces from the force balance and the drive, with friction as the motion at x has it. */
static bool trammel_forces(const core *c, const trammel *m, int first, int second, real x, wave *normal_first,
                           wave *normal_second, curve *drive)
{
  const surface *a = &c->body.surfaces[c->contacts[first].surface];
  const surface *b = &c->body.surfaces[c->contacts[second].surface];
  vec qa = v_mix(a->n, -sense_at(&m->speed_first, x) * a->mu_d, a->t);
  vec qb = v_mix(b->n, -sense_at(&m->speed_second, x) * b->mu_d, b->t);
  real det = v_cross(qa, qb);
  if (r_abs(det) <= 16 * REAL_EPSILON * (1 + a->mu_d) * (1 + b->mu_d))
    return false;
  *normal_first = path_force_along(&m->path, v_scale(v_make(-qb.y, qb.x), 1 / det));
  *normal_second = path_force_along(&m->path, v_scale(v_make(qa.y, -qa.x), 1 / det));
  *drive = m->path.drive;
  /* The second contact's moment about the first: (e cos + e_turn sin) x qb, times its normal force. */
  real lever_c = v_cross(m->e, qb), lever_s = v_cross(m->e_turn, qb), dir = m->path.dir;
  const wave *n = normal_second;
  drive->k0 += dir * (lever_c * n->c + lever_s * n->s) / 2;
  drive->c2 += dir * (lever_c * n->c - lever_s * n->s) / 2;
  drive->s2 += dir * (lever_c * n->s + lever_s * n->c) / 2;
  drive->c1 += dir * lever_c * n->k;
  drive->s1 += dir * lever_s * n->k;
  return true;
}

/* Friction takes work, so the motion can only go the way in which the spring gives some. */
static bool trammel_starts(const core *c, int first, int second, real *dir)
{
  trammel m = trammel_path(c, first, second, 1);
  vec rate = v_mix(m.path.a_turn, m.path.xi_s, m.path.t);
  real power = v_dot(spring_force(c), rate) + spring_moment(c);
  *dir = r_sign(power);
  if (*dir < 0)
    m = trammel_path(c, first, second, -1);
  wave na, nb;
  curve drive;
  /* A slide that was stopped by its second touch has N = 0 there but for rounding: that is no contact force. */
  real above = balance_slack(c);
  return trammel_forces(c, &m, first, second, 0, &na, &nb, &drive) && wave_at(&na, 0) > above &&
         wave_at(&nb, 0) > above && curve_at(&drive, 0) > 0 && !is_balanced(c, curve_at(&drive, 0));
}

static void slide_trammel(core *c, int first, int second, real dir)
{
  contact *i = &c->contacts[first], *k = &c->contacts[second];
  trammel m = trammel_path(c, first, second, dir);
  wave na, nb;
  curve drive;
  real x = 0;
  bool zero = false;
  for (int piece = 0; piece < REVERSALS_MAX; piece++) {
    if (!trammel_forces(c, &m, first, second, x, &na, &nb, &drive))
      break;
    wave na_on = wave_shift(&na, x), nb_on = wave_shift(&nb, x);
    curve drive_on = curve_shift(&drive, x);
    wave va = wave_shift(&m.speed_first, x), vb = wave_shift(&m.speed_second, x);
    /* Where friction flips, a change of sign across the jump is the zero. */
    if (wave_at(&na_on, 0) <= 0 || wave_at(&nb_on, 0) <= 0 || curve_at(&drive_on, 0) <= 0)
      break;
    real reversal = r_min(wave_next_zero(&va, 2 * R_PI), wave_next_zero(&vb, 2 * R_PI));
    real lift = r_min(wave_first_down(&na_on, 0, 2 * R_PI), wave_first_down(&nb_on, 0, 2 * R_PI));
    real step, limit = r_min(r_min(reversal, lift), 2 * R_PI);
    zero = curve_first_zero(&drive_on, limit, &step, &c->report->iterations);
    x += step;
    if (zero || lift <= reversal)
      break;
  }
  touch t = path_first_touch(c, &m.path, x);
  if (t.at < R_HUGE)
    x = t.at;
  path_set_pose(c, &m.path, x);
  slide_to(c, i, path_place(&m.path, x));
  slide_to(c, k, world_vertex(c, k->vertex));
  slide_ended(c, zero && t.at == R_HUGE, dir);
  finish_slide(c, t);
}

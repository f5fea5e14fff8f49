/* Motions with one degree of freedom, in which the pose follows from the angle: turning about a stuck
 * vertex, the slip of one vertex (the force balance gives the place at every angle, 5.1), and the slip of
 * two vertices on two surfaces (an ellipse trammel, 5.3). The reference vertex runs along a line, its
 * place a wave of the angle turned; so are all gaps and forces. */
#include "statics.h"

static vec turn_of(vec e, real dir)
{
  return v_scale(v_perp(e), dir);
}

static wave dot_wave(vec axis, vec k, vec c, vec s)
{
  wave w = {v_dot(axis, k), v_dot(axis, c), v_dot(axis, s)};
  return w;
}

/* Adds the cross product of (ac cos + as sin) with (bk + bc cos + bs sin) to the curve. */
static void add_cross(curve *g, real sign, vec ac, vec as, vec bk, vec bc, vec bs)
{
  real cc = v_cross(ac, bc), ss = v_cross(as, bs), cs = v_cross(ac, bs) + v_cross(as, bc);
  g->k0 += sign * (cc + ss) / 2;
  g->c2 += sign * (cc - ss) / 2;
  g->s2 += sign * cs / 2;
  g->c1 += sign * v_cross(ac, bk);
  g->s1 += sign * v_cross(as, bk);
}

/* Spring force along the path and the drive that it gives; xi_c, xi_s and t are set. */
static void finish_path(const core *c, path *f)
{
  vec stretch = v_sub(v_sub(c->hand.h, f->origin), f->a);
  vec kc = v_mix(f->a, f->xi_c, f->t), ks = v_mix(f->a_turn, f->xi_s, f->t);
  vec fk = v_add(stretch, kc), fc = v_neg(kc), fs = v_neg(ks);
  f->force_x = (wave){fk.x, fc.x, fs.x};
  f->force_y = (wave){fk.y, fc.y, fs.y};
  curve g = {f->dir * c->body.kappa * (c->hand.phi - c->theta), -c->body.kappa, 0, 0, 0, 0};
  add_cross(&g, f->dir, f->a, f->a_turn, fk, fc, fs);
  f->drive = g;
}

static path path_start(const core *c, int vertex, vec place, vec t, real dir)
{
  path f = {0};
  f.vertex = vertex;
  f.dir = dir;
  f.origin = place;
  f.t = t;
  f.a = rotate(c->rot, v_sub(c->b, c->body.vertices[vertex]));
  f.a_turn = turn_of(f.a, dir);
  return f;
}

/* 5.1, stuck: "the vertex is fixed on a surface to a point around which a rotation is yet allowed". */
static path path_pinned(const core *c, int vertex, vec place, real dir)
{
  path f = path_start(c, vertex, place, v_make(0, 0), dir);
  finish_path(c, &f);
  return f;
}

/* 5.1, slipping: friction is -sigma mu_d N (`friction` = sigma mu_d), and the tangential balance
 * h_t - g_t = sigma mu_d N keeps the vertex where it belongs at every angle. */
static path path_sliding(const core *c, int vertex, vec place, vec t, vec n, real friction, real dir)
{
  path f = path_start(c, vertex, place, t, dir);
  vec w = v_mix(t, friction, n);
  f.xi_c = -v_dot(w, f.a);
  f.xi_s = -v_dot(w, f.a_turn);
  finish_path(c, &f);
  return f;
}

static wave path_force_along(const path *f, vec axis)
{
  wave w = {axis.x * f->force_x.k + axis.y * f->force_y.k, axis.x * f->force_x.c + axis.y * f->force_y.c,
            axis.x * f->force_x.s + axis.y * f->force_y.s};
  return w;
}

static wave path_gap(const core *c, const path *f, int vertex, int surface_index)
{
  const surface *s = &c->body.surfaces[surface_index];
  vec e = rotate(c->rot, v_sub(c->body.vertices[vertex], c->body.vertices[f->vertex]));
  wave w = dot_wave(s->n, v_sub(f->origin, s->point), e, turn_of(e, f->dir));
  real along = v_dot(s->n, f->t);
  w.k -= along * f->xi_c;
  w.c += along * f->xi_c;
  w.s += along * f->xi_s;
  return w;
}

static vec path_place(const path *f, real x)
{
  real half = r_sin(x / 2);
  return v_mix(f->origin, f->xi_s * r_sin(x) - 2 * f->xi_c * half * half, f->t);
}

/* The first touch of a vertex that is not the path's own, as the angle turned. */
static touch path_first_touch(core *c, const path *f, real x_max)
{
  touch best = {R_HUGE, 0, 0};
  real sweep = r_min(x_max, 2);
  near_update(c, sweep * (2 * c->body.radius + r_abs(f->xi_c) + r_abs(f->xi_s)));
  for (near_pair k = {0}; next_near(c, &k);) {
    if (k.vertex == f->vertex && f->xi_c == 0 && f->xi_s == 0)
      continue; /* it does not move */
    wave gap = path_gap(c, f, k.vertex, k.surface);
    keep_earlier(&best, wave_first_down(&gap, c->noise, x_max), k.vertex, k.surface);
  }
  return best;
}

static void path_set_pose(core *c, const path *f, real x)
{
  set_angle(c, c->theta + f->dir * x);
  c->p = v_sub(path_place(f, x), rotate(c->rot, c->body.vertices[f->vertex]));
}

/* What the analysis denies must never happen: random scenes, with further surfaces all around, are replayed and
 * each touch and contact set is held against the claims. */
#include "../files/help.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "invariants/random_scene.h"
#include "invariants/wild.h"
#include "needs.h"

#define SAMPLES 120

typedef struct tally {
  int scenes, behind, far, at_rest, touched, no_wedging, no_pairs;
} tally;

/* Surfaces at all distances and directions, outside of the start. */
static void add_surroundings(stic_scene *s, rng *r, double size)
{
  for (int i = rng_below(r, 5); i > 0; i--) {
    const double way = rng_range(r, 0, 360), distance = size * pow(10, rng_range(r, -0.5, 2));
    double n[2];

    stic_normal_from_degrees(way, n);
    random_surface(s, s->x - n[0] * (distance + 2 * size), s->y - n[1] * (distance + 2 * size), way,
                   rng_range(r, 0, 1), 0);
  }
}

static void check_row(const stic_scene *s, const stic_needs *n, const stic_result *row, bool unflagged,
                      uint64_t seed)
{
  for (int i = 0; i < row->contact_count && i < STIC_CONTACTS_MAX; i++) {
    const stic_surface_needs *m = &n->surfaces[row->contacts[i].surface];

    if (m->reach != STIC_REACH_POSSIBLE && unflagged)
      fail_msg("seed %llu: surface %d was said to be out of reach (%d), and is touched",
               (unsigned long long)seed, row->contacts[i].surface, (int)m->reach);
  }
  if (!unflagged)
    return;
  if (row->flags & STIC_FLAG_WEDGED)
    assert_true(n->wedging);
  if (row->state == STIC_EDGE)
    assert_true(n->edge);
  if (row->state == STIC_TWO_VERTEX)
    assert_true(n->two_vertex);
  if (row->state == STIC_CORNER)
    assert_true(n->corner);
  if (row->state == STIC_MULTI)
    assert_true(n->multi);
  if (row->state == STIC_VERTEX)
    assert_true(n->vertex);
  (void)s;
}

static void count(tally *t, const stic_scene *s, const stic_needs *n, const bool *touched)
{
  t->scenes++;
  t->no_wedging += !n->wedging;
  t->no_pairs += n->pair_count == 0;
  for (int i = 0; i < s->surface_count; i++) {
    t->behind += n->surfaces[i].reach == STIC_REACH_BEHIND;
    t->far += n->surfaces[i].reach == STIC_REACH_FAR;
    t->at_rest += n->surfaces[i].reach == STIC_REACH_FAR && n->surfaces[i].at_rest;
    t->touched += touched[i];
  }
}

/* Solves the samples and checks every row and every touch, also those between rows, up to the first row that is
 * flagged as unsolved. */
static void replay(const stic_scene *s, const stic_settings *settings, const stic_sample *samples,
                   int samples_count, uint64_t seed, tally *t)
{
  static stic_hand_range range;
  static stic_needs needs, anywhere;
  static stic_hand_range everywhere;
  bool touched[STIC_SURFACES_MAX] = {false}, unflagged = true;
  static stic_result row;
  stic_sim *sim;
  stic_error err;

  stic_hand_range_begin(&range);
  for (int i = 0; i < samples_count; i++)
    stic_hand_range_add(&range, s, &samples[i]);
  stic_hand_range_anywhere(&everywhere);
  stic_needs_find(s, &range, &needs);
  stic_needs_find(s, &everywhere, &anywhere);
  assert_int_equal(stic_sim_create(s, settings, &sim, &err), STIC_OK);
  for (int i = 0; i < samples_count; i++) {
    int events;
    const stic_event *e;

    stic_sim_step(sim, &samples[i], &row);
    e = stic_sim_events(sim, &events);
    unflagged = unflagged && !(row.flags & (STIC_FLAG_NO_ANSWER | STIC_FLAG_LIMIT));
    for (int k = 0; k < events; k++) {
      const stic_surface_needs *n;

      if (e[k].kind != STIC_EVENT_TOUCH)
        continue;
      touched[e[k].surface] = true;
      n = &needs.surfaces[e[k].surface];
      if (unflagged &&
          (n->reach != STIC_REACH_POSSIBLE || anywhere.surfaces[e[k].surface].reach != STIC_REACH_POSSIBLE))
        fail_msg("seed %llu: surface %d was said to be out of reach (%d), and is touched",
                 (unsigned long long)seed, e[k].surface, (int)n->reach);
    }
    check_row(s, &needs, &row, unflagged, seed);
    check_row(s, &anywhere, &row, unflagged, seed);
  }
  stic_sim_destroy(sim);
  count(t, s, &needs, touched);
}

static stic_settings settings_of(uint64_t seed)
{
  stic_settings settings;

  stic_settings_init(&settings);
  settings.level = seed % 3 == 0 ? STIC_LEVEL_FRAME : STIC_LEVEL_EVENT;
  settings.precision = seed % 7 == 0 ? STIC_F32 : STIC_F64;
  return settings;
}

static void random_scenes_keep_the_claims(void **state)
{
  static random_case c;
  static stic_sample samples[SAMPLES];
  tally t = {0, 0, 0, 0, 0, 0, 0};
  stic_error err;

  (void)state;
  for (uint64_t seed = 1; seed <= 500; seed++) {
    const stic_settings settings = settings_of(seed);
    rng r = {seed * 77 + 5};

    random_case_init(&c, seed);
    add_surroundings(&c.scene, &r, stic_scene_size(&c.scene));
    if (stic_scene_validate(&c.scene, &err) != STIC_OK)
      continue;
    for (int i = 0; i < SAMPLES; i++) {
      random_case_move(&c, &r);
      samples[i] = (stic_sample){
        (int64_t)(i + 1) * 32000000, {c.x, c.y, 0}, {0, 0, sin(c.phi / 2), cos(c.phi / 2)}, 1, false};
    }
    replay(&c.scene, &settings, samples, SAMPLES, seed, &t);
  }
  print_message(
    "%d scenes: %d surfaces behind, %d far (%d at rest), %d touched; no wedging %d, no pairs %d\n", t.scenes,
    t.behind, t.far, t.at_rest, t.touched, t.no_wedging, t.no_pairs);
  /* The claims are not empty. */
  assert_true(t.scenes > 400 && t.behind > 100 && t.far > 50 && t.at_rest > 30 && t.touched > 400);
  assert_true(t.no_wedging > 100 && t.no_pairs > 30);
}

/* Hands that jump, let go and take again; the hand is recorded first, as it looks at what comes out. */
static void wild_scenes_keep_the_claims(void **state)
{
  static wild_case c;
  static stic_sample samples[SAMPLES];
  static stic_result row;
  tally t = {0, 0, 0, 0, 0, 0, 0};
  stic_error err;

  (void)state;
  for (uint64_t seed = 1; seed <= 90; seed++) {
    stic_settings settings = settings_of(seed);
    stic_sim *sim;

    settings.precision = STIC_F64;
    wild_init(&c, seed);
    if (seed % 2)
      add_surroundings(&c.scene, &c.r, c.size);
    if (stic_sim_create(&c.scene, &settings, &sim, &err) != STIC_OK)
      continue;
    memset(&row, 0, sizeof row);
    for (int i = 0; i < SAMPLES; i++) {
      if (i > 0)
        wild_move(&c, &row);
      samples[i] = wild_sample(&c, i);
      stic_sim_step(sim, &samples[i], &row);
    }
    stic_sim_destroy(sim);
    replay(&c.scene, &settings, samples, SAMPLES, seed, &t);
  }
  print_message(
    "%d scenes: %d surfaces behind, %d far (%d at rest), %d touched; no wedging %d, no pairs %d\n", t.scenes,
    t.behind, t.far, t.at_rest, t.touched, t.no_wedging, t.no_pairs);
  assert_true(t.scenes > 60 && t.touched > 100);
}

/* ---- known cases --------------------------------------------------------------------------- */

static void box(stic_scene *s, double k_theta)
{
  stic_scene_init(s);
  stic_scene_set_box(s, 0.16, 0.08);
  s->y = 0.06;
  s->stiffness = 200;
  s->rotational_stiffness = k_theta;
  random_surface(s, 0, 0, 90, 0.5, 0.3);
}

static void find_in_box(const stic_scene *s, stic_needs *n)
{
  static const double low[2] = {-0.3, -0.05}, high[2] = {0.3, 0.4};
  static stic_hand_range range;

  stic_hand_range_box(&range, s, low, high);
  stic_needs_find(s, &range, n);
}

static void known_cases(void **state)
{
  static stic_scene s;
  static stic_needs n;

  (void)state;
  box(&s, 0.5);
  random_surface(&s, 0, -1, 90, 0.5, 0.3);   /* under the floor */
  random_surface(&s, 0, 2.5, 270, 0.5, 0.3); /* ceiling */
  random_surface(&s, 0.4, 0, 180, 0.5, 0.3); /* wall, in reach */
  find_in_box(&s, &n);
  assert_int_equal(n.surfaces[0].reach, STIC_REACH_POSSIBLE);
  assert_int_not_equal(n.surfaces[1].reach, STIC_REACH_POSSIBLE);
  assert_int_equal(n.surfaces[3].reach, STIC_REACH_POSSIBLE);
  assert_true(n.corner && n.two_vertex && n.multi && !n.wedging);
  s.surfaces[3].point[0] = 3; /* now out of it, and the ceiling with it */
  find_in_box(&s, &n);
  assert_int_equal(n.surfaces[2].reach, STIC_REACH_FAR);
  assert_int_equal(n.surfaces[3].reach, STIC_REACH_FAR);
  assert_true(n.surfaces[3].at_rest && !n.surfaces[2].at_rest);
  assert_int_equal(n.reachable, 1);
  assert_true(!n.multi && n.edge && n.behind == 1 && !n.jumpless);
  box(&s, 0);
  random_surface(&s, 0.1, 0.0, 180, 0, 0);
  s.surfaces[0].friction = (stic_friction){0, 0};
  find_in_box(&s, &n);
  assert_true(n.frictionless && n.jumpless && n.free_rotation && !n.fixed_angle);
  s.surfaces[0].friction = (stic_friction){0.4, 0.4};
  find_in_box(&s, &n);
  assert_true(!n.frictionless && n.jumpless);
}

/* A slot wedges iff two corners can be nearly level between its walls (V7). */
static void slots(void **state)
{
  static stic_scene s;
  static stic_needs n;

  (void)state;
  for (int wide = 0; wide < 2; wide++) {
    const double half = wide ? 0.2 : 0.0275;

    stic_scene_init(&s);
    stic_scene_set_box(&s, 0.05, 0.03); /* corners 0.0583 apart: wedged from mu = 0.352 on */
    s.stiffness = 200;
    random_surface(&s, -half, 0, 0, 0.36, 0.3);
    random_surface(&s, half, 0, 180, 0.36, 0.3);
    find_in_box(&s, &n);
    assert_int_equal(n.wedging, !wide);
    assert_int_equal(n.pair_count, !wide);
    if (!wide)
      assert_true(n.pairs[0].slot);
    s.surfaces[0].friction.mu_static = 0.34;
    find_in_box(&s, &n);
    assert_false(n.wedging);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(known_cases),
    cmocka_unit_test(slots),
    cmocka_unit_test(random_scenes_keep_the_claims),
    cmocka_unit_test(wild_scenes_keep_the_claims),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* What a simulation leaves out of the model changes no bit of what comes out: traces and random scenes, at every
 * level and precision, against the full model. Only `iterations` may be less where surfaces are left out: it counts
 * the root-finding steps that were made. */
#include "../files/help.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "golden.h"
#include "invariants/random_scene.h"
#include "invariants/wild.h"
#include "io/log_csv.h"
#include "invariants/random_scene.h"
#include "invariants/wild.h"
#include "needs.h"
#include "sim.h"

static const char *const accuracies[] = {"frame", "substep=8", "event"};

enum { ACCURACIES = 3, PRECISIONS = 3, SAMPLES = 40, TRACE_SAMPLES_MAX = 5000 };

static stic_settings settings_of(int accuracy, int precision)
{
  stic_settings settings;
  stic_error err;

  stic_settings_init(&settings);
  assert_int_equal(stic_settings_set_accuracy(&settings, accuracies[accuracy], &err), STIC_OK);
  settings.precision = (stic_precision)(STIC_F32 + precision);
  return settings;
}

/* The full model and what is left of it, side by side. */
typedef struct sides {
  stic_sim *full, *less;
  stic_result full_row, less_row;
  bool hides; /* surfaces are left out */
  char name[128];
} sides;

static int hidden_count(const stic_scene *scene)
{
  bool hidden[STIC_SURFACES_MAX];
  int count = 0;

  stic_needs_find_hidden(scene, hidden);
  for (int s = 0; s < scene->surface_count; s++)
    count += hidden[s];
  return count;
}

static bool begin(sides *s, const stic_scene *scene, const stic_settings *settings, const char *name)
{
  char accuracy[32];
  stic_error err;

  if (stic_sim_create_parts(scene, settings, STIC_LEAVE_NONE, &s->full, &err) != STIC_OK)
    return false;
  assert_int_equal(stic_sim_create(scene, settings, &s->less, &err), STIC_OK);
  s->hides = settings->precision != STIC_F32 && hidden_count(scene) > 0;
  stic_settings_accuracy_text(settings, accuracy, sizeof accuracy);
  snprintf(s->name, sizeof s->name, "%.70s, %s, %s", name, accuracy,
           stic_precision_name(settings->precision));
  return true;
}

static bool same_contacts(const stic_result *a, const stic_result *b)
{
  if (a->contact_count != b->contact_count)
    return false;
  for (int i = 0; i < a->contact_count; i++) {
    const stic_contact *p = &a->contacts[i], *q = &b->contacts[i];

    if (p->vertex != q->vertex || p->surface != q->surface || p->x != q->x || p->y != q->y ||
        p->normal != q->normal || p->friction != q->friction)
      return false;
  }
  return true;
}

static bool same_event(const stic_event *a, const stic_event *b)
{
  return a->t == b->t && a->kind == b->kind && a->vertex == b->vertex && a->surface == b->surface &&
         a->x == b->x && a->y == b->y && a->length == b->length;
}

static void step(sides *s, const stic_sample *sample)
{
  char full[STIC_LOG_ROW_MAX], less[STIC_LOG_ROW_MAX];
  const stic_event *full_events, *less_events;
  size_t full_length, less_length;
  int full_count, less_count;

  stic_sim_step(s->full, sample, &s->full_row);
  stic_sim_step(s->less, sample, &s->less_row);
  if (s->hides && s->less_row.iterations < s->full_row.iterations)
    s->full_row.iterations = s->less_row.iterations;
  full_length = stic_log_row_text(&s->full_row, full);
  less_length = stic_log_row_text(&s->less_row, less);
  if (full_length != less_length || memcmp(full, less, full_length) != 0)
    fail_msg("%s: the full model says\n%.*s, and with parts left out\n%.*s", s->name, (int)full_length, full,
             (int)less_length, less);
  if (!same_contacts(&s->full_row, &s->less_row))
    fail_msg("%s: other contacts at %lld ns", s->name, (long long)sample->t_ns);
  full_events = stic_sim_events(s->full, &full_count);
  less_events = stic_sim_events(s->less, &less_count);
  assert_int_equal(full_count, less_count);
  for (int i = 0; i < full_count; i++)
    if (!same_event(&full_events[i], &less_events[i]))
      fail_msg("%s: event %d at %lld ns is another", s->name, i, (long long)sample->t_ns);
}

static void end(sides *s)
{
  stic_sim_destroy(s->full);
  stic_sim_destroy(s->less);
}

/* ---- traces ------------------------------------------------------------------------------ */

/* Further surfaces just behind each of the scene's, so that there is something to leave out. */
static void add_hidden(stic_scene *scene)
{
  const double size = stic_scene_size(scene);
  const int count = scene->surface_count;

  for (int s = 0; s < 4 * count && scene->surface_count < STIC_SURFACES_MAX; s++) {
    stic_surface *to = &scene->surfaces[scene->surface_count++];
    double n[2];

    *to = scene->surfaces[s % count];
    stic_normal_from_degrees(to->normal_deg, n);
    for (int k = 0; k < 2; k++)
      to->point[k] -= n[k] * size * pow(10, -1 - s / (double)count);
  }
}

static void replay(const stic_scene *scene, const stic_golden_trace *trace, const char *name)
{
  for (int k = 0; k < ACCURACIES * PRECISIONS; k++) {
    const stic_settings settings = settings_of(k / PRECISIONS, k % PRECISIONS);
    static sides s;

    assert_true(begin(&s, scene, &settings, name));
    for (size_t i = 0; i < trace->count && i < TRACE_SAMPLES_MAX; i++)
      step(&s, &trace->samples[i]);
    end(&s);
  }
}

static void traces_keep_every_bit(void **state)
{
  int argc = 0;

  for (char **folder = *state; *folder; folder++, argc++) {
    static stic_scene scene;
    char path[512];
    stic_golden_trace trace;
    stic_error err;

    snprintf(path, sizeof path, "%s/scene.yaml", *folder);
    assert_int_equal(stic_scene_read(path, NULL, 0, &scene, &err), STIC_OK);
    snprintf(path, sizeof path, "%s/hand.csv", *folder);
    assert_int_equal(stic_golden_read_trace(path, &trace, &err), STIC_OK);
    replay(&scene, &trace, *folder);
    add_hidden(&scene);
    assert_true(hidden_count(&scene) >= scene.surface_count / 2);
    replay(&scene, &trace, *folder);
    free(trace.samples);
  }
  assert_true(argc >= 10);
}

/* ---- random scenes ------------------------------------------------------------------------ */

static void random_scenes_keep_every_bit(void **state)
{
  static random_case c;
  int hidden = 0, scenes = 0;

  (void)state;
  for (uint64_t seed = 1; seed <= 300; seed++) {
    const stic_settings settings = settings_of((int)(seed % 3), (int)(seed / 3 % 3));
    static sides s;
    rng r = {seed * 77 + 5};
    char name[32];

    random_any_init(&c, seed);
    if (seed % 2)
      add_hidden(&c.scene);
    snprintf(name, sizeof name, "random scene %d", (int)seed);
    if (!begin(&s, &c.scene, &settings, name))
      continue;
    scenes++;
    hidden += hidden_count(&c.scene);
    for (int i = 0; i < SAMPLES; i++) {
      const stic_sample sample = {
        (int64_t)(i + 1) * 32000000, {c.x, c.y, 0}, {0, 0, sin(c.phi / 2), cos(c.phi / 2)}, 1, false};

      step(&s, &sample);
      random_case_move(&c, &r);
    }
    end(&s);
  }
  print_message("%d scenes, %d surfaces left out\n", scenes, hidden);
  assert_true(scenes > 250 && hidden > 500);
}

static void wild_scenes_keep_every_bit(void **state)
{
  static wild_case c;
  int hidden = 0, scenes = 0;

  (void)state;
  for (uint64_t seed = 1; seed <= 220; seed++) {
    /* f80 less often: nothing there is wilder than in f64. */
    const stic_settings settings = settings_of(seed % 10 == 0 ? 2 : (int)(seed % 2), (int)(seed / 3 % 3));
    static sides s;
    char name[32];

    wild_init(&c, seed);
    if (seed % 2)
      add_hidden(&c.scene);
    snprintf(name, sizeof name, "wild scene %d", (int)seed);
    if (!begin(&s, &c.scene, &settings, name))
      continue;
    scenes++;
    hidden += hidden_count(&c.scene);
    for (int i = 0; i < SAMPLES; i++) {
      const stic_sample sample = wild_sample(&c, i);

      step(&s, &sample);
      wild_move(&c, &s.full_row);
    }
    end(&s);
  }
  print_message("%d scenes, %d surfaces left out\n", scenes, hidden);
  assert_true(scenes > 150 && hidden > 500);
}

int main(int argc, char **argv)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_prestate(traces_keep_every_bit, argv + 1),
    cmocka_unit_test(random_scenes_keep_every_bit),
    cmocka_unit_test(wild_scenes_keep_every_bit),
  };

  (void)argc;
  return cmocka_run_group_tests(tests, NULL, NULL);
}

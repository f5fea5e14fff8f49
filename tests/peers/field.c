#include "field.h"

#include "cli/cli.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Three settings: one coefficient; two of them, switched by the speed of slip; the same as cheap as it gets. */
enum { PLAIN, SWITCHED, CHEAP, KINDS };
static const char *const kind_names[KINDS] = {"", ", switched mu", ", switched, cheap"};

/* steps, iterations, mass, scale, firmness, damping, hand_damping, switch_speed. */
static const struct {
  const peer_engine *const *engine;
  const char *name, *package;
  bool without, scaled; /* may do without iterations; has tolerances of a fixed length */
  double firmness[3];   /* to choose from */
  peer_tuning tuning[KINDS];
} entries[PEER_ENGINES] = {
  {&peer_ode,
   "ODE",
   "libode-dev",
   true,
   false,
   {0.2, 0.5, 0.8},
   {{32, 50, 0.05, 1, 0.2, 1, 1, 0}, {32, 50, 0.05, 1, 0.2, 1, 1, 1e-2}, {2, 0, 0.1, 1, 0.8, 0.3, 0, 3e-3}}},
  {&peer_chipmunk,
   "Chipmunk",
   "chipmunk-dev",
   false,
   false,
   {0.1, 0.5, 0.9},
   {{32, 50, 0.05, 1, 0.1, 1, 1, 0}, {32, 50, 0.05, 1, 0.1, 1, 1, 1e-2}, {2, 10, 0.5, 1, 0.1, 0.6, 0, 1e-2}}},
  {&peer_bullet,
   "Bullet",
   "libbullet-dev",
   false,
   true,
   {0.1, 0.2, 0.8},
   {{32, 50, 0.05, 10, 0.2, 1, 1, 0},
    {32, 50, 0.05, 10, 0.2, 1, 1, 1e-2},
    {2, 10, 0.5, 10, 0.8, 0.3, 0, 1e-2}}},
  {&peer_box2d,
   "Box2D",
   "libbox2d-dev",
   false,
   true,
   {0.2, 0.2, 0.2},
   {{16, 50, 0.05, 100, 0.2, 1, 1, 0},
    {16, 50, 0.05, 100, 0.2, 1, 1, 1e-2},
    {2, 10, 0.1, 100, 0.2, 0.3, 0, 1e-2}}},
  {&peer_mujoco,
   "MuJoCo",
   "mujoco-core",
   true,
   false,
   {0.95, 0.99, 0.999},
   {{32, 50, 0.05, 1, 0.999, 1, 1, 0},
    {32, 50, 0.05, 1, 0.999, 1, 1, 1e-2},
    {2, 10, 0.1, 1, 0.999, 0.3, 0, 1e-2}}},
};

int peer_field(peer_contestant out[PEER_CONTESTANTS])
{
  static const stic_level levels[2] = {STIC_LEVEL_EVENT, STIC_LEVEL_FRAME};
  int count = 0;

  for (int i = 0; i < 2; i++, count++) {
    out[count] = (peer_contestant){.name = "stiction", .engine = NULL};
    snprintf(out[count].name, sizeof out[count].name, "stiction %s", i == 0 ? "event" : "frame");
    stic_settings_init(&out[count].settings);
    out[count].settings.level = levels[i];
  }
  for (int i = 0; i < PEER_ENGINES; i++) {
    for (int k = 0; *entries[i].engine && k < KINDS; k++, count++) {
      out[count] = (peer_contestant){.engine = *entries[i].engine, .tuning = entries[i].tuning[k]};
      snprintf(out[count].name, sizeof out[count].name, "%s%s", entries[i].name, kind_names[k]);
    }
  }
  return count;
}

void peer_field_missing(void)
{
  for (int i = 0; i < PEER_ENGINES; i++) {
    if (!*entries[i].engine)
      printf("%s is left out: %s was not there when this was built\n", entries[i].name, entries[i].package);
  }
}

/* ---- search ------------------------------------------------------------------------------ */

#define CHEAP_STEPS 2
#define CHEAP_ITERATIONS 10
#define FLOOR 1e-6 /* m: errors below count alike */

/* The mean over all scenes of the logarithm of the object's error: good everywhere, not in one place. */
static stic_status judge(const peer_contestant *who, const peer_scene *scenes, double *worth, stic_error *err)
{
  stic_status status = STIC_OK;

  *worth = 0;
  for (int i = 0; i < PEER_SCENES && status == STIC_OK; i++) {
    stic_outcome o = {0};
    peer_score score;
    double onset = NAN;

    status = peer_contest_run(who, &scenes[i], &o, &onset, err);
    if (status == STIC_OK) {
      peer_contest_score(&scenes[i], &o, onset, &score);
      *worth +=
        log10(fmax(FLOOR, isfinite(score.difference.position_rms) ? score.difference.position_rms : 1)) /
        PEER_SCENES;
    }
    stic_outcome_free(&o);
  }
  return status;
}

typedef struct choice {
  size_t field; /* of peer_tuning, an int or a double */
  bool whole;
  int count;
  double values[8];
} choice;

static void set(peer_tuning *t, const choice *c, int k)
{
  if (c->whole)
    *(int *)((char *)t + c->field) = (int)c->values[k];
  else
    *(double *)((char *)t + c->field) = c->values[k];
}

static int choices_of(int entry, int kind, choice out[8])
{
  const double *f = entries[entry].firmness;
  const bool cheap = kind == CHEAP;
  int count = 0;

  out[count++] = (choice){offsetof(peer_tuning, steps), true, cheap ? 2 : 6, {1, CHEAP_STEPS, 4, 8, 16, 32}};
  out[count++] = (choice){offsetof(peer_tuning, mass), false, 4, {0.05, 0.1, 0.2, 0.5}};
  out[count++] = (choice){offsetof(peer_tuning, damping), false, 3, {0.3, 0.6, 1}};
  out[count++] = (choice){offsetof(peer_tuning, iterations),
                          true,
                          cheap ? 2 : 4,
                          {entries[entry].without ? 0 : 4, CHEAP_ITERATIONS, 50, 200}};
  out[count++] = (choice){offsetof(peer_tuning, firmness), false, 3, {f[0], f[1], f[2]}};
  out[count++] = (choice){offsetof(peer_tuning, hand_damping), false, 2, {0, 1}};
  if (kind != PLAIN)
    out[count++] = (choice){offsetof(peer_tuning, switch_speed), false, 5, {1e-5, 1e-4, 1e-3, 3e-3, 1e-2}};
  if (entries[entry].scaled)
    out[count++] = (choice){offsetof(peer_tuning, scale), false, 3, {1, 10, 100}};
  return count;
}

typedef struct search {
  const peer_scene *scenes;
  choice choices[8];
  int count;
  peer_contestant who; /* the best so far */
  double best;
} search;

/* Takes the tuning over if it is better. */
static stic_status try_tuning(search *s, const peer_tuning *tuning, stic_error *err)
{
  peer_contestant trial = s->who;
  double worth;
  stic_status status;

  if (s->best < INFINITY && memcmp(tuning, &s->who.tuning, sizeof *tuning) == 0)
    return STIC_OK;
  trial.tuning = *tuning;
  status = judge(&trial, s->scenes, &worth, err);
  if (status == STIC_OK && worth < s->best - 1e-3) {
    s->best = worth;
    s->who = trial;
  }
  return status;
}

/* One value after the other in all its choices, until none makes it better. */
static stic_status descend(search *s, stic_error *err)
{
  const peer_tuning start = s->who.tuning;
  stic_status status = try_tuning(s, &start, err);
  double before;

  do {
    before = s->best;
    for (int i = 0; i < s->count; i++) {
      for (int k = 0; k < s->choices[i].count && status == STIC_OK && stic_cli_signal() == 0; k++) {
        peer_tuning t = s->who.tuning;

        set(&t, &s->choices[i], k);
        status = try_tuning(s, &t, err);
      }
    }
  } while (s->best < before && status == STIC_OK);
  return status;
}

stic_status peer_field_tune(const char *only, const peer_scene scenes[PEER_SCENES], stic_error *err)
{
  stic_status status = STIC_OK;

  for (int i = 0; i < PEER_ENGINES * KINDS && status == STIC_OK && stic_cli_signal() == 0; i++) {
    const int entry = i / KINDS, kind = i % KINDS;
    search s = {.scenes = scenes, .best = INFINITY};
    const peer_tuning *t = &s.who.tuning;

    snprintf(s.who.name, sizeof s.who.name, "%s%s", entries[entry].name, kind_names[kind]);
    if (!*entries[entry].engine || strncmp(s.who.name, only, strlen(only)) != 0)
      continue;
    s.who.engine = *entries[entry].engine;
    s.who.tuning = entries[entry].tuning[kind];
    s.count = choices_of(entry, kind, s.choices);
    status = descend(&s, err);
    if (status == STIC_OK)
      printf("%s: {%d, %d, %g, %g, %g, %g, %g, %g}, typical error %.3g mm\n", s.who.name, t->steps,
             t->iterations, t->mass, t->scale, t->firmness, t->damping, t->hand_damping, t->switch_speed,
             pow(10, s.best) * 1e3);
    fflush(stdout);
  }
  return status;
}

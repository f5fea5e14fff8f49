/* stiction-traces RECIPE [HAND.CSV]: makes a synthetic tracker recording. */
#include "recipe.h"

#include <inttypes.h>
#include <stdio.h>

enum { STEPS_PER_SAMPLE = 16 }; /* the hand moves on between samples */

typedef struct maker {
  const stic_recipe *recipe;
  stic_random random;
  stic_tremor tremor;
  stic_pose aim; /* where the hand wants to be */
  int64_t ticks; /* so far, STEPS_PER_SAMPLE to a sample */
  unsigned buttons;
} maker;

static stic_pose shaken(maker *m, const stic_pose *aim)
{
  const stic_recipe *r = m->recipe;
  stic_pose pose = *aim;

  for (int i = 0; i < STIC_AXES; i++)
    pose.axis[i] += (i < 3 ? r->tremor_mm : r->tremor_degrees) * m->tremor.last[i] +
                    (i < 3 ? r->noise_mm : r->noise_degrees) * stic_random_normal(&m->random);
  return pose;
}

static void print_time(int64_t sample, int64_t rate)
{
  const int64_t ns = sample % rate * 1000000000 / rate;

  printf("%" PRId64 ".%09" PRId64, sample / rate, ns);
}

/* A count is 25.4 um = 254e-7 m: whole numbers all the way. */
static void print_position(int64_t counts)
{
  const int64_t size = (counts < 0 ? -counts : counts) * 254;

  printf(",%s%" PRId64 ".%07" PRId64, counts < 0 ? "-" : "", size / 10000000, size % 10000000);
}

static void sample(maker *m)
{
  const stic_pose pose = shaken(m, &m->aim);
  const stic_counts counts = stic_tracker_counts(&pose);
  double s, c;

  stic_half_angle(counts.axis[3], &s, &c);
  print_time(m->ticks / STEPS_PER_SAMPLE, m->recipe->rate);
  for (int i = 0; i < 3; i++)
    print_position(counts.axis[i]);
  printf(",0,0,%.12f,%.12f,%u\n", s + 0.0, c + 0.0, m->buttons);
}

static void tick(maker *m)
{
  if (m->ticks % STEPS_PER_SAMPLE == 0)
    sample(m);
  stic_tremor_step(&m->tremor, &m->random);
  m->ticks++;
}

static void reach(maker *m, const stic_pose *to, double seconds)
{
  const stic_pose from = m->aim;
  const int64_t ticks = (int64_t)(seconds * (double)(m->recipe->rate * STEPS_PER_SAMPLE) + 0.5);

  for (int64_t i = 1; i <= ticks; i++) {
    tick(m);
    m->aim = stic_reach(&from, to, (double)i / (double)ticks);
  }
}

static stic_pose missed(maker *m, const stic_pose *target)
{
  stic_pose pose = *target;

  for (int i = 0; i < STIC_AXES; i++)
    pose.axis[i] +=
      (i < 3 ? m->recipe->scatter_mm : m->recipe->scatter_degrees) * stic_random_normal(&m->random);
  return pose;
}

static void follow(maker *m)
{
  const stic_recipe *r = m->recipe;
  int repeat_at = 0;
  int64_t left = 0;

  for (int i = 0; i < r->step_count; i++) {
    const stic_step *step = &r->steps[i];
    stic_pose target;

    switch (step->kind) {
    case STIC_STEP_REACH:
      target = missed(m, &step->pose);
      reach(m, &target, step->seconds);
      break;
    case STIC_STEP_WAIT:
      target = m->aim;
      reach(m, &target, step->seconds);
      break;
    case STIC_STEP_PRESS: m->buttons = 1; break;
    case STIC_STEP_RELEASE: m->buttons = 0; break;
    case STIC_STEP_REPEAT:
      repeat_at = i;
      left = step->count;
      break;
    case STIC_STEP_END:
      if (--left > 0)
        i = repeat_at;
      break;
    }
  }
}

static void print_head(const stic_recipe *r)
{
  printf("# stiction-trace 1\n# %s\n", r->title);
  printf("# Synthetic: no hand made this. A recipe of minimum-jerk reaches, %g mm and %g degrees (rms) of\n"
         "# physiological tremor at 8-12 Hz, seen by a tracker of %" PRId64
         " samples a second that counts in 0.001 inch\n"
         "# and 0.1 degree. Made by stiction-traces from recipe.txt beside this file.\n",
         r->tremor_mm, r->tremor_degrees, r->rate);
  printf("t,x,y,z,qx,qy,qz,qw,buttons\n");
}

/* False if something could not be written. */
static bool finish(const char *path)
{
  if (fflush(stdout) == 0 && !ferror(stdout))
    return true;
  perror(path ? path : "standard output");
  if (path)
    remove(path);
  return false;
}

int main(int argc, char **argv)
{
  static stic_recipe recipe;
  static maker m;
  const char *path = argc == 3 ? argv[2] : NULL;

  if (argc < 2 || argc > 3 || argv[1][0] == '-') {
    fprintf(stderr, "usage: stiction-traces RECIPE [HAND.CSV]\n");
    return 2;
  }
  if (!stic_recipe_read(argv[1], &recipe))
    return 3;
  if (path && !freopen(path, "w", stdout)) {
    perror(path);
    return 5;
  }
  m.recipe = &recipe;
  stic_random_seed(&m.random, (uint64_t)recipe.seed);
  stic_tremor_start(&m.tremor, (double)(recipe.rate * STEPS_PER_SAMPLE), &m.random);
  m.aim = recipe.start;
  print_head(&recipe);
  follow(&m);
  return finish(path) ? 0 : 5;
}

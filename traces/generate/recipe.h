/* A recipe says in a few lines what a hand does; see traces/README.md for the words. */
#ifndef STIC_TRACES_RECIPE_H
#define STIC_TRACES_RECIPE_H

#include "motion.h"

#include <stdbool.h>

enum { STIC_RECIPE_STEPS_MAX = 256, STIC_RECIPE_RATE_MAX = 1000 };

typedef enum stic_step_kind {
  STIC_STEP_REACH, /* to `pose` in `seconds`; a wait is a reach to where the hand already is */
  STIC_STEP_WAIT,
  STIC_STEP_PRESS,
  STIC_STEP_RELEASE,
  STIC_STEP_REPEAT, /* up to the matching end, `count` times; not nested */
  STIC_STEP_END
} stic_step_kind;

typedef struct stic_step {
  stic_step_kind kind;
  double seconds;
  int64_t count;
  stic_pose pose;
} stic_step;

typedef struct stic_recipe {
  char title[120];
  int64_t rate; /* samples per second */
  int64_t seed;
  double tremor_mm, tremor_degrees; /* rms */
  double noise_mm, noise_degrees;   /* of the tracker before it rounds, rms */
  double scatter_mm,
    scatter_degrees; /* how far each waypoint is missed, rms: nobody repeats a motion exactly */
  stic_pose start;
  int step_count;
  stic_step steps[STIC_RECIPE_STEPS_MAX];
} stic_recipe;

/* Reads a recipe; on failure says why on standard error. */
bool stic_recipe_read(const char *path, stic_recipe *recipe);

#endif

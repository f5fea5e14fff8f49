#include "recipe.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LINE_MAX_BYTES 200
#define NUMBERS_MAX 5

typedef struct line {
  char word[16];
  const char *rest; /* after the word */
  int count;        /* of numbers, -1: something else is there */
  double numbers[NUMBERS_MAX];
} line;

static const char blanks[] = " \t\n";

/* False for a line with nothing to do. */
static bool split(char *text, line *l)
{
  char *at = text + strspn(text, blanks), *end;
  size_t length = strcspn(at, blanks);

  if (*at == '#' || *at == '\0')
    return false;
  if (length >= sizeof l->word)
    length = sizeof l->word - 1;
  memcpy(l->word, at, length);
  l->word[length] = '\0';
  at += length;
  l->rest = at + strspn(at, blanks);
  for (l->count = 0;; l->count++) {
    at += strspn(at, blanks);
    if (*at == '\0' || *at == '#')
      return true;
    if (l->count == NUMBERS_MAX)
      break;
    l->numbers[l->count] = strtod(at, &end);
    if (end == at || !(fabs(l->numbers[l->count]) < 1e6))
      break;
    at = end;
  }
  l->count = -1;
  return true;
}

static bool is(const line *l, const char *word, int count)
{
  return strcmp(l->word, word) == 0 && l->count == count;
}

static void set_pose(stic_pose *pose, const double *numbers)
{
  memcpy(pose->axis, numbers, sizeof pose->axis);
}

static bool set_pair(double *a, double *b, const double *numbers)
{
  *a = numbers[0];
  *b = numbers[1];
  return numbers[0] >= 0 && numbers[1] >= 0;
}

static bool set_value(const line *l, stic_recipe *r)
{
  if (strcmp(l->word, "title") == 0) {
    snprintf(r->title, sizeof r->title, "%s", l->rest);
    r->title[strcspn(r->title, "\n")] = '\0';
    return r->title[0] != '\0';
  }
  if (is(l, "rate", 1)) {
    r->rate = (int64_t)l->numbers[0];
    return r->rate >= 1 && r->rate <= STIC_RECIPE_RATE_MAX;
  }
  if (is(l, "seed", 1)) {
    r->seed = (int64_t)l->numbers[0];
    return r->seed >= 0;
  }
  if (is(l, "tremor", 2))
    return set_pair(&r->tremor_mm, &r->tremor_degrees, l->numbers);
  if (is(l, "noise", 2))
    return set_pair(&r->noise_mm, &r->noise_degrees, l->numbers);
  if (is(l, "scatter", 2))
    return set_pair(&r->scatter_mm, &r->scatter_degrees, l->numbers);
  if (is(l, "start", 4)) {
    set_pose(&r->start, l->numbers);
    return true;
  }
  return false;
}

static bool add_step(const line *l, stic_recipe *r)
{
  stic_step *step = &r->steps[r->step_count];

  if (r->step_count == STIC_RECIPE_STEPS_MAX)
    return false;
  memset(step, 0, sizeof *step);
  if (is(l, "move", 5)) {
    step->kind = STIC_STEP_REACH;
    step->seconds = l->numbers[0];
    set_pose(&step->pose, l->numbers + 1);
  } else if (is(l, "wait", 1)) {
    step->kind = STIC_STEP_WAIT;
    step->seconds = l->numbers[0];
  } else if (is(l, "press", 0)) {
    step->kind = STIC_STEP_PRESS;
  } else if (is(l, "release", 0)) {
    step->kind = STIC_STEP_RELEASE;
  } else if (is(l, "repeat", 1)) {
    step->kind = STIC_STEP_REPEAT;
    step->count = (int64_t)l->numbers[0];
    if (step->count < 1)
      return false;
  } else if (is(l, "end", 0)) {
    step->kind = STIC_STEP_END;
  } else {
    return false;
  }
  r->step_count++;
  return step->seconds >= 0;
}

static bool repeats_match(const stic_recipe *r)
{
  bool inside = false;

  for (int i = 0; i < r->step_count; i++) {
    if (r->steps[i].kind == (inside ? STIC_STEP_REPEAT : STIC_STEP_END))
      return false;
    if (r->steps[i].kind == STIC_STEP_REPEAT || r->steps[i].kind == STIC_STEP_END)
      inside = !inside;
  }
  return !inside;
}

static bool read_lines(const char *path, FILE *file, stic_recipe *r)
{
  char text[LINE_MAX_BYTES];
  int number = 0;

  if (!fgets(text, sizeof text, file) || strcmp(text, "# stiction-recipe 1\n") != 0) {
    fprintf(stderr, "%s:1: expected '# stiction-recipe 1'\n", path);
    return false;
  }
  for (number = 2; fgets(text, sizeof text, file); number++) {
    line l;

    if (split(text, &l) && !set_value(&l, r) && !add_step(&l, r)) {
      fprintf(stderr, "%s:%d: cannot use '%s' so; traces/README.md lists the words\n", path, number, l.word);
      return false;
    }
  }
  if (!repeats_match(r)) {
    fprintf(stderr, "%s: each 'repeat' needs its 'end', one inside the other is not possible\n", path);
    return false;
  }
  return true;
}

bool stic_recipe_read(const char *path, stic_recipe *recipe)
{
  FILE *file = fopen(path, "r");
  bool good;

  memset(recipe, 0, sizeof *recipe);
  recipe->rate = 31;
  if (!file) {
    perror(path);
    return false;
  }
  good = read_lines(path, file, recipe);
  fclose(file);
  return good;
}

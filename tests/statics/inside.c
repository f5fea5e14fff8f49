/* The statics core once more, with a look inside HOLD: it must never raise the spring's energy. Linked in place of
 * the library's own core; compiled once per precision. */
#include <stdbool.h>

#include "inside.h"
#include "statics/core.h"

/* The solver's sources declare and define `hold(core *c)` and call `hold(c)`. The definition gets the name
 * hold_itself, the calls go to hold_watched; the same for judge. */
#define hold(argument) INSIDE_HOLD_##argument)
#define INSIDE_HOLD_core hold_itself(core
#define INSIDE_HOLD_c hold_watched(c
#define judge(argument) INSIDE_JUDGE_##argument)
#define INSIDE_JUDGE_core judge_itself(core
#define INSIDE_JUDGE_c judge_watched(c

struct core;
static bool hold_watched(struct core *c);
static unsigned judge_watched(struct core *c);

#include "statics/statics.c"

#undef hold
#undef judge

static unsigned judge_watched(core *c)
{
  verdict v = judge_itself(c);
  inside_report.decisions |= c->report->decisions;
  inside_report.row_decisions |= c->report->decisions;
  return (unsigned)v;
}

/* In long double, so that what is seen is the pose and not this sum. */
static long double energy(const core *c)
{
  long double x =
    (long double)c->p.x + (long double)c->rot.x * c->b.x - (long double)c->rot.y * c->b.y - c->hand.h.x;
  long double y =
    (long double)c->p.y + (long double)c->rot.y * c->b.x + (long double)c->rot.x * c->b.y - c->hand.h.y;
  long double turn = (long double)c->hand.phi - c->theta;
  return (x * x + y * y + c->body.kappa * turn * turn) / 2;
}

static bool hold_watched(core *c)
{
  long double before = energy(c);
  long double arm = v_length(spring_force(c)), turn = r_abs(c->hand.phi - c->theta);
  bool touched = hold_itself(c);
  if (inside_report.raise > 0 && arm > 0) /* the control: away from the hand */
    c->p = v_mix(c->p, -(real)inside_report.raise * c->body.size / (real)arm, spring_force(c));
  /* Places round by some ulp of the coordinates, the angle by some of its own. */
  long double place =
    4096 * REAL_EPSILON * c->body.size + 4 * REAL_EPSILON *
                                           ((long double)r_abs(c->p.x) + r_abs(c->p.y) + r_abs(c->hand.h.x) +
                                            r_abs(c->hand.h.y) + c->body.world_extent);
  long double angle = 4096 * REAL_EPSILON + 4 * REAL_EPSILON * (r_abs(c->theta) + r_abs(c->hand.phi));
  long double allowed =
    (arm + place) * (place + c->body.size * angle) + c->body.kappa * (turn + angle) * angle;
  long double rise = (energy(c) - before) / allowed;
  inside_report.holds++;
  if ((double)rise > inside_report.worst_rise)
    inside_report.worst_rise = (double)rise;
  inside_report.decisions |= c->report->decisions;
  if (c->report->stages_worst > inside_report.stages_worst)
    inside_report.stages_worst = c->report->stages_worst;
  return touched;
}

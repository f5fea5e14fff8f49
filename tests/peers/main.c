/* stiction beside dynamics engines: the same scenes and hands, one table. */
#include "field.h"

#include "angle.h"
#include "cli/cli.h"
#include "error.h"
#include "io/outfile.h"
#include "io/timing.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define ONSET 1e-9 /* relative error of the first slip that stiction must keep below */

static const stic_cli_usage usage = {
  "peers", "[OPTION...]",
  "Compares stiction with dynamics engines on the same scenes and hand motions, in error and in time. Ends with 1 if\n"
  "stiction creeps, or its first slip is wrong by more than 1e-9.\n",
  0, 0};

typedef struct table {
  peer_scene scenes[PEER_SCENES];
  peer_contestant who[PEER_CONTESTANTS];
  int count;
  peer_score scores[PEER_CONTESTANTS][PEER_SCENES];
} table;

/* ---- measuring --------------------------------------------------------------------------- */

/* Where nothing may move and the first slip is not looked for; one run will do there. */
static bool rests(const peer_scene *p)
{
  return p->rest_row > 0 && !(p->onset > 0);
}

/* All contestants in turn, then again: what disturbs the machine disturbs all alike. */
static stic_status measure_scene(table *t, int scene, int repeats, stic_error *err)
{
  stic_outcome outcomes[PEER_CONTESTANTS] = {{0}};
  double onsets[PEER_CONTESTANTS];
  stic_status status = STIC_OK;

  for (int i = 0; i < t->count; i++)
    onsets[i] = NAN;
  for (int k = 0; k < repeats * t->count && status == STIC_OK && stic_cli_signal() == 0; k++) {
    const int i = k % t->count;

    status = peer_contest_run(&t->who[i], &t->scenes[scene], &outcomes[i], &onsets[i], err);
  }
  for (int i = 0; i < t->count; i++) {
    if (status == STIC_OK && stic_cli_signal() == 0)
      peer_contest_score(&t->scenes[scene], &outcomes[i], onsets[i], &t->scores[i][scene]);
    stic_outcome_free(&outcomes[i]);
  }
  return status;
}

/* ---- printing ---------------------------------------------------------------------------- */

/* A number, or n/a; `width` columns. */
static const char *text(double value, const char *format, char out[32])
{
  if (isnan(value))
    snprintf(out, 32, "n/a");
  else
    snprintf(out, 32, format, value);
  return out;
}

static void print_scene(const table *t, int scene)
{
  printf("\n%s: %s\n  %-28s %9s %9s %9s %9s %9s %9s %9s %9s %9s %9s\n", t->scenes[scene].name,
         t->scenes[scene].about, "", "pose rms", "max mm", "angle deg", "force rms", "max %", "onset %",
         "creep", "drift um", "ns", "worst ns");
  for (int i = 0; i < t->count; i++) {
    const peer_score *s = &t->scores[i][scene];
    const stic_difference *d = &s->difference;
    char onset[32], creep[32], drift[32];

    printf("  %-28s %9.3g %9.3g %9.3g %9.3g %9.3g %9s %9s %9s %9lld %9lld\n", t->who[i].name,
           d->position_rms * 1e3, d->position_max * 1e3, d->angle_rms * STIC_DEG_PER_RAD, d->force_rms * 100,
           d->force_max * 100, text(s->onset * 100, "%.2g", onset), text(s->creep * 1e6, "%.2g", creep),
           text(s->drift * 1e6, "%.2g", drift), (long long)s->median_ns, (long long)s->worst_ns);
  }
}

static void write_csv(const table *t, stic_outfile *csv)
{
  stic_outfile_print(csv,
                     "scene,contestant,pose_rms_m,pose_max_m,angle_rms_rad,angle_max_rad,force_rms,force_max,"
                     "onset_error,creep_m_s,drift_m,median_ns,worst_ns,ratio_event,ratio_frame\n");
  for (int scene = 0; scene < PEER_SCENES; scene++) {
    for (int i = 0; i < t->count; i++) {
      const peer_score *s = &t->scores[i][scene];
      const stic_difference *d = &s->difference;

      stic_outfile_print(csv, "%s,\"%s\",%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%lld,%lld,%.4g,%.4g\n",
                         t->scenes[scene].name, t->who[i].name, d->position_rms, d->position_max,
                         d->angle_rms, d->angle_max, d->force_rms, d->force_max, s->onset, s->creep, s->drift,
                         (long long)s->median_ns, (long long)s->worst_ns,
                         (double)s->median_ns / (double)t->scores[0][scene].median_ns,
                         (double)s->median_ns / (double)t->scores[1][scene].median_ns);
    }
  }
}

/* What a contestant's scores come to over the scenes that move. */
typedef struct summary {
  double pose, force; /* rms of rms, m and relative */
  double median, worst;
  double onset, creep[4]; /* of the hold scenes in their order; NaN where there is none */
} summary;

static summary sum_up(const table *t, int who)
{
  summary sum = {.onset = NAN};
  int moving = 0, holds = 0;

  for (int i = 0; i < PEER_SCENES; i++) {
    const peer_score *s = &t->scores[who][i];

    if (t->scenes[i].onset > 0)
      sum.onset = s->onset;
    if (rests(&t->scenes[i])) {
      sum.creep[holds++] = s->creep;
      continue;
    }
    moving++;
    sum.worst = fmax(sum.worst, (double)s->worst_ns);
    sum.pose += s->difference.position_rms * s->difference.position_rms;
    sum.force += s->difference.force_rms * s->difference.force_rms;
    sum.median += log((double)s->median_ns);
  }
  sum.pose = sqrt(sum.pose / moving);
  sum.force = sqrt(sum.force / moving);
  sum.median = exp(sum.median / moving);
  return sum;
}

static void print_summary(const table *t)
{
  const double event = sum_up(t, 0).median, frame = sum_up(t, 1).median;
  char machine[256], onset[32];

  printf(
    "\nAll scenes: errors and times of those that move (rms, geometric mean of medians), creep of those that hold\n");
  printf(
    "| | pose rms mm | force rms %% | first slip off by %% | creep um/s at 50 %% | 95 %% | 95 %%, tremor | slope "
    "| ns a frame | worst ns | x event | x frame | note |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|---|\n");
  for (int i = 0; i < t->count; i++) {
    const summary s = sum_up(t, i);

    printf("| %s | %.2g | %.2g | %s | %.2g | %.2g | %.2g | %.2g | %.0f | %.0f | %.3g | %.3g | %s |\n",
           t->who[i].name, s.pose * 1e3, s.force * 100, text(s.onset * 100, "%.2g", onset), s.creep[0] * 1e6,
           s.creep[1] * 1e6, s.creep[2] * 1e6, s.creep[3] * 1e6, s.median, s.worst, s.median / event,
           s.median / frame, t->who[i].engine ? t->who[i].engine->note : "");
  }
  printf("\n%s\n", stic_machine_text(machine, sizeof machine));
}

/* ---- verdict ----------------------------------------------------------------------------- */

/* What is ours to meet: no creep at all at either level, and the first slip where it is due at level event. */
static bool stiction_holds(const table *t)
{
  bool good = true;

  for (int k = 0; k < 2 * PEER_SCENES; k++) {
    const peer_scene *p = &t->scenes[k % PEER_SCENES];
    const peer_score *s = &t->scores[k / PEER_SCENES][k % PEER_SCENES];

    if (rests(p) && !(s->creep == 0 && s->drift == 0)) {
      printf("FAIL: %s creeps on %s by %g m\n", t->who[k / PEER_SCENES].name, p->name, s->drift);
      good = false;
    }
    if (k < PEER_SCENES && p->onset > 0 && !(s->onset < ONSET)) {
      printf("FAIL: %s slips first on %s %g off\n", t->who[0].name, p->name, s->onset);
      good = false;
    }
  }
  if (good)
    printf("stiction: creep exactly 0, first slip %.1g off (allowed: %g)\n", sum_up(t, 0).onset, ONSET);
  return good;
}

static stic_status compare(table *t, const char *path, int repeats, stic_error *err)
{
  stic_outfile *csv = NULL;
  stic_status status = path ? stic_outfile_open(path, &csv, err) : STIC_OK;

  t->count = peer_field(t->who);
  for (int i = 0; i < PEER_SCENES && status == STIC_OK && stic_cli_signal() == 0; i++) {
    status = measure_scene(t, i, rests(&t->scenes[i]) ? 1 : repeats, err);
    if (status == STIC_OK && stic_cli_signal() == 0)
      print_scene(t, i);
  }
  if (status != STIC_OK || stic_cli_signal() != 0) {
    stic_outfile_abort(csv);
    return status;
  }
  print_summary(t);
  peer_field_missing();
  if (csv) {
    write_csv(t, csv);
    status = stic_outfile_commit(csv, err);
  }
  if (status == STIC_OK && !stiction_holds(t))
    status = stic_error_set(err, STIC_FAILED, NULL, 0, "peers: stiction does not keep what it promises");
  return status;
}

int main(int argc, const char **argv)
{
  char *csv = NULL, *tune = NULL;
  int repeats = 3;
  double hold = 100;
  const struct poptOption options[] = {
    {"csv", '\0', POPT_ARG_STRING, &csv, 0, "Write all rows also as CSV", "FILE"},
    {"repeats", '\0', POPT_ARG_INT | POPT_ARGFLAG_SHOW_DEFAULT, &repeats, 0,
     "Runs of what moves; a frame counts with its fastest", "N"},
    {"hold", '\0', POPT_ARG_DOUBLE | POPT_ARGFLAG_SHOW_DEFAULT, &hold, 0,
     "How long the still scenes hold; at least 10", "S"},
    {"tune", '\0', POPT_ARG_STRING, &tune, 0, "Search settings of engines whose name begins so, instead",
     "NAME"},
    POPT_TABLEEND};
  stic_cli_args args;
  stic_error err = {0};
  stic_status status;
  table *t = calloc(1, sizeof *t);
  int code = stic_cli_parse(&usage, options, argc, argv, &args);

  if (code < 0 && t) {
    stic_cli_catch_signals();
    status = peer_scenes_make(t->scenes, hold, &err);
    if (status == STIC_OK)
      status = tune ? peer_field_tune(tune, t->scenes, &err) : compare(t, csv, repeats, &err);
    code = stic_cli_signal() != 0 ? STIC_EXIT_SIGNAL + stic_cli_signal() : (int)status;
    if (status != STIC_OK)
      stic_cli_fail(&err);
    peer_scenes_free(t->scenes);
  }
  stic_cli_args_free(&args);
  free(csv);
  free(tune);
  free(t);
  return code;
}

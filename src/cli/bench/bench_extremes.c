/* stiction bench extremes: every range swept to its ends, every row held against the model's invariants. */
#include "../../error.h"
#include "../../io/outfile.h"
#include "../../io/timing.h"
#include "../../sim.h"
#include "bench.h"
#include "../cli.h"
#include "extremes.h"
#include "trade.h"

#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#define SAMPLE_NS 32258065 /* 31 Hz, the paper's frame */

enum { PRECISIONS = 3, LEVELS = 3, DECADES = 24, FAILURES_SHOWN = 20, STAGES_BOUND = 64, SUBSTEPS = 3 };

static const stic_precision precisions[PRECISIONS] = {STIC_F32, STIC_F64, STIC_F80};
static const stic_level levels[LEVELS] = {STIC_LEVEL_FRAME, STIC_LEVEL_SUBSTEP, STIC_LEVEL_EVENT};
static const char *const level_names[LEVELS] = {"frame", "substep=3", "event"};

/* RELAX calls in one sample: 10,000 at level event, and the last one. */
static const int relaxations_bound[LEVELS] = {1, SUBSTEPS, 10000 + 25};

/* Steps of root finding in one sample. A RELAX has one search of 256 steps a stage, one for every pair of vertex and
 * surface on the way to the hand, and 2,000 steps of the viscous flow; at level event 700,000 bound all RELAX calls but
 * the last event's. */
static int iterations_bound(const stic_scene *s, int level)
{
  const int one = 256 * (STAGES_BOUND + s->vertex_count * s->surface_count) + 2000;

  return levels[level] == STIC_LEVEL_EVENT ? 700000 + 25 * one : relaxations_bound[level] * one;
}

/* ---- what is counted ------------------------------------------------------------------------- */

typedef struct tally {
  int64_t frames, failures, no_answer, limit, refused, cases;
  double residual, depth; /* worst: relative to the largest term; in units of what is allowed */
  int iterations, stages, events;
  int64_t worst_ns;
  int64_t off[DECADES + 1]; /* rows by the decade of their distance from f80's, in sizes: 1e-20 ... 1e4 */
  int64_t other_contacts;   /* rows with contacts other than f80's */
} tally;

static void tally_add(tally *to, const tally *from)
{
  to->frames += from->frames;
  to->failures += from->failures;
  to->no_answer += from->no_answer;
  to->limit += from->limit;
  to->refused += from->refused;
  to->cases += from->cases;
  to->residual = fmax(to->residual, from->residual);
  to->depth = fmax(to->depth, from->depth);
  to->iterations = from->iterations > to->iterations ? from->iterations : to->iterations;
  to->stages = from->stages > to->stages ? from->stages : to->stages;
  to->events = from->events > to->events ? from->events : to->events;
  to->worst_ns = from->worst_ns > to->worst_ns ? from->worst_ns : to->worst_ns;
  to->other_contacts += from->other_contacts;
  for (int i = 0; i <= DECADES; i++)
    to->off[i] += from->off[i];
}

/* The distance that `part` of the rows do not exceed, as a power of ten. */
static int off_quantile(const tally *t, double part)
{
  int64_t count = 0, sum = 0;
  int i = 0;

  for (int k = 0; k <= DECADES; k++)
    count += t->off[k];
  while (i < DECADES && (double)(sum + t->off[i]) < part * (double)count)
    sum += t->off[i++];
  return i - 20;
}

static bool same_contact_set(const stic_result *a, const stic_result *b)
{
  bool same = a->contact_count == b->contact_count;

  for (int i = 0; same && i < a->contact_count; i++)
    same = stic_same_contact(&a->contacts[i], &b->contacts[i]);
  return same;
}

static void tally_off(tally *t, const stic_result *got, const stic_result *reference, double size)
{
  const double off =
    hypot(got->x - reference->x, got->y - reference->y) / size + fabs(got->theta - reference->theta);
  const double decade = off > 0 ? ceil(log10(off)) + 20 : 0;

  t->off[(int)fmax(0, fmin(DECADES, decade))]++;
  t->other_contacts += !same_contact_set(got, reference);
}

/* ---- one case at one level, in all precisions side by side ---------------------------------- */

typedef struct bench {
  const stic_extremes_options *options;
  stic_outfile *csv;
  stic_error err;
  bool no_memory;       /* in one of the cases */
  stic_sample *samples; /* of the case at hand, for files */
  int sample_count, sample_room;
  tally tallies[PRECISIONS]; /* of the sweep at hand */
  tally total[PRECISIONS];
  stic_heat_map maps[2 * PRECISIONS];
  int failures_shown;
  bool dumped; /* a failing case */
  stic_status status;
} bench;

typedef struct lane {
  stic_sim *sim;
  stic_checker checker;
  stic_result row, before;
  tally t;
} lane;

/* The hand of row i; `last` is the f64 row before it. */
static stic_sample sample_of(stic_extreme *e, int i, const stic_result *last)
{
  stic_sample s;

  if (!e->move)
    return e->given[i];
  e->move(e, i, i > 0 ? last : NULL);
  memset(&s, 0, sizeof s);
  s.t_ns = (int64_t)i * SAMPLE_NS;
  s.position[0] = e->x, s.position[1] = e->y;
  s.orientation[2] = sin(e->phi / 2), s.orientation[3] = cos(e->phi / 2);
  s.buttons = e->buttons;
  return s;
}

/* For files, if there are to be any. */
static void remember(bench *b, const stic_sample *sample)
{
  if (!b->options->dump)
    return;
  if (b->sample_count == b->sample_room) {
    const int room = b->sample_room * 2 + 256;
    stic_sample *more = realloc(b->samples, (size_t)room * sizeof *more);

    b->no_memory = b->no_memory || !more;
    if (!more)
      return;
    b->samples = more;
    b->sample_room = room;
  }
  b->samples[b->sample_count++] = *sample;
}

/* Bounds on work, and what must not change under a hand that stands still; "" if all is well. */
static void check_work(lane *l, int level, bool must_stand, char *complaint, size_t size)
{
  const stic_core_report *report = stic_sim_report(l->sim);
  stic_result now = l->row;

  if (report->stages_worst > STAGES_BOUND)
    snprintf(complaint, size, "%d stages in a RELAX", report->stages_worst);
  if (report->relaxations > relaxations_bound[level])
    snprintf(complaint, size, "%d RELAX calls in a sample", report->relaxations);
  if (report->iterations > iterations_bound(l->checker.scene, level))
    snprintf(complaint, size, "%d steps of root finding in a sample", report->iterations);
  if (must_stand) {
    now.t_ns = l->before.t_ns;
    now.flags = l->before.flags;
    now.iterations = l->before.iterations;
    if (memcmp(&now, &l->before, offsetof(stic_result, contacts)) != 0 ||
        memcmp(now.contacts, l->before.contacts, (size_t)now.contact_count * sizeof now.contacts[0]) != 0)
      snprintf(complaint, size, "a row changed under a hand that stands still");
  }
}

static void step_lane(lane *l, const stic_sample *sample, int level, bool must_stand)
{
  const stic_event *events;
  int64_t collide_ns, total_ns;
  int count;

  l->before = l->row;
  stic_sim_step(l->sim, sample, &l->row);
  stic_sim_stage_times(l->sim, &collide_ns, &total_ns);
  events = stic_sim_events(l->sim, &count);
  stic_checker_row(&l->checker, &l->row, events, count, true);
  if (!l->checker.complaint[0])
    check_work(l, level, must_stand, l->checker.complaint, sizeof l->checker.complaint);
  const stic_core_report *report = stic_sim_report(l->sim);

  l->t.frames++;
  l->t.no_answer += (l->row.flags & STIC_FLAG_NO_ANSWER) != 0;
  l->t.limit += (l->row.flags & STIC_FLAG_LIMIT) != 0;
  l->t.iterations = report->iterations > l->t.iterations ? report->iterations : l->t.iterations;
  l->t.stages = report->stages_worst > l->t.stages ? report->stages_worst : l->t.stages;
  l->t.events = report->relaxations > l->t.events ? report->relaxations : l->t.events;
  l->t.worst_ns = total_ns > l->t.worst_ns ? total_ns : l->t.worst_ns;
}

static void say_failure(bench *b, const char *where, const char *replay, int precision, int level, int row,
                        const char *complaint)
{
  if (b->failures_shown++ >= FAILURES_SHOWN)
    return;
  printf("  FAIL %s, %s %s, row %d: %s\n       files: stiction bench extremes %s --dump FOLDER\n", where,
         stic_precision_name(precisions[precision]), level_names[level], row, complaint, replay);
}

static bool open_lane(bench *b, lane *l, const stic_extreme *e, int precision, int level)
{
  stic_settings settings;

  memset(l, 0, sizeof *l);
  stic_settings_init(&settings);
  settings.level = levels[level];
  settings.precision = precisions[precision];
  settings.substeps = SUBSTEPS;
  l->t.cases = 1;
  if (stic_sim_create(&e->scene, &settings, &l->sim, &b->err) != STIC_OK) {
    b->no_memory |= b->err.status == STIC_NO_MEMORY; /* no refusal of the scene */
    return false;
  }
  stic_sim_time_stages(l->sim, true);
  stic_checker_init(&l->checker, &e->scene, settings.precision);
  return true;
}

static void print_csv_header(stic_outfile *csv)
{
  stic_outfile_print(csv,
                     "sweep,case,a,b,precision,level,refused,frames,residual,depth_of_allowed,iterations,"
                     "stages,relaxations,worst_ns,no_answer,limit,failures,median_off_f80_log10,"
                     "p99_off_f80_log10,other_contacts_than_f80\n");
}

static void print_csv(bench *b, const char *sweep, int64_t number, const stic_extreme *e, int precision,
                      int level, const tally *t)
{
  if (!b->csv)
    return;
  stic_outfile_print(
    b->csv, "%s,%" PRId64 ",%.17g,%.17g,%s,%s,%" PRId64 ",%" PRId64 ",%.3g,%.3g,%d,%d,%d,%" PRId64, sweep,
    number, e->a, e->b, stic_precision_name(precisions[precision]), level_names[level], t->refused, t->frames,
    t->residual, t->depth, t->iterations, t->stages, t->events, t->worst_ns);
  stic_outfile_print(b->csv, ",%" PRId64 ",%" PRId64 ",%" PRId64 ",%d,%d,%" PRId64 "\n", t->no_answer,
                     t->limit, t->failures, off_quantile(t, 0.5), off_quantile(t, 0.99), t->other_contacts);
}

/* What a case is called. */
typedef struct label {
  const char *sweep;
  int64_t number;
  char replay[96];
} label;

static void close_lane(bench *b, lane *l, const stic_extreme *e, const label *name, int precision, int level,
                       int row)
{
  char where[160];

  snprintf(where, sizeof where, "%s case %" PRId64 " (%g, %g)", name->sweep, name->number, e->a, e->b);
  l->t.residual = l->checker.worst_relative_residual;
  l->t.depth = l->checker.worst_depth;
  if (l->checker.complaint[0]) {
    l->t.failures = 1;
    say_failure(b, where, name->replay, precision, level, row, l->checker.complaint);
  }
  stic_sim_destroy(l->sim);
  l->sim = NULL;
  tally_add(&b->tallies[precision], &l->t);
  print_csv(b, name->sweep, name->number, e, precision, level, &l->t);
}

/* A scene that must be refused and is not, or the other way. */
static void judge_refusal(bench *b, lane *l, const stic_extreme *e, bool made)
{
  if (!made) {
    l->t.refused = 1;
    if (!e->must_refuse && !e->may_refuse) {
      snprintf(l->checker.complaint, sizeof l->checker.complaint, "refused: %.400s", b->err.message);
    }
  } else if (e->must_refuse) {
    snprintf(l->checker.complaint, sizeof l->checker.complaint, "not refused");
  }
}

/* ---- a failing case, made small ------------------------------------------------------------- */

typedef struct failing {
  stic_extreme e;
  stic_sample *samples;
  int count, precision, level;
} failing;

/* The first row that breaks an invariant, -1 if none does. */
static int first_failure(bench *b, const failing *f)
{
  static lane l;
  int at = -1;

  if (!open_lane(b, &l, &f->e, f->precision, f->level))
    return -1;
  for (int i = 0; i < f->count && at < 0; i++) {
    step_lane(&l, &f->samples[i], f->level, false);
    if (l.checker.complaint[0])
      at = i;
  }
  stic_sim_destroy(l.sim);
  return at;
}

/* Leaves out samples, in ever shorter runs, as long as a row still fails. */
static void drop_samples(bench *b, failing *f, stic_sample *kept)
{
  for (int length = f->count / 2; length >= 1; length /= 2)
    for (int from = f->count - length - 1; from >= 0; from -= length) {
      const int count = f->count;

      memcpy(kept, f->samples, (size_t)count * sizeof *kept);
      memmove(f->samples + from, f->samples + from + length, (size_t)(count - from - length) * sizeof *kept);
      f->count = count - length;
      const int at = first_failure(b, f);

      if (at >= 0) {
        f->count = at + 1;
        from = from < f->count ? from : f->count;
      } else {
        memcpy(f->samples, kept, (size_t)count * sizeof *kept);
        f->count = count;
      }
    }
}

static void drop_surfaces(bench *b, failing *f)
{
  stic_scene *s = &f->e.scene;

  for (int i = s->surface_count - 1; i >= 0 && s->surface_count > 1; i--) {
    const stic_scene before = *s;

    memmove(&s->surfaces[i], &s->surfaces[i + 1], (size_t)(s->surface_count - i - 1) * sizeof s->surfaces[0]);
    s->surface_count--;
    if (first_failure(b, f) < 0)
      *s = before;
  }
}

/* A standing hand breaks nothing that a first failure shows. */
static void minimise(bench *b, failing *f)
{
  stic_sample *kept = malloc((size_t)f->count * sizeof *kept);
  const int at = first_failure(b, f);

  if (kept && at >= 0 && at < 5000) {
    f->count = at + 1;
    drop_surfaces(b, f);
    drop_samples(b, f, kept);
  }
  free(kept);
}

/* The case at hand as files; if it fails, as small as it still does. */
static void dump(bench *b, const stic_extreme *e, int precision, int level)
{
  static failing f;

  if (!b->options->dump || b->dumped || b->status != STIC_OK)
    return;
  f = (failing){
    .e = *e, .samples = b->samples, .count = b->sample_count, .precision = precision, .level = level};
  if (precision >= 0) {
    minimise(b, &f);
    b->dumped = true;
  }
  b->status = stic_extreme_dump(b->options->dump, &f.e.scene, f.samples, f.count, &b->err);
  if (b->status == STIC_OK)
    printf("  stiction replay %s/scene.yaml %s/hand.csv --accuracy %s --precision %s --log log.csv\n",
           b->options->dump, b->options->dump, level_names[level],
           stic_precision_name(precisions[precision >= 0 ? precision : 1]));
}

static void run_case(bench *b, const stic_extreme *start, const label *name, int level)
{
  static lane lanes[PRECISIONS]; /* rows with all their contacts are large */
  stic_extreme e = *start;
  int failed_at[PRECISIONS] = {0};
  bool made[PRECISIONS];

  b->sample_count = 0;
  for (int p = 0; p < PRECISIONS; p++) {
    made[p] = open_lane(b, &lanes[p], &e, p, level);
    judge_refusal(b, &lanes[p], &e, made[p]);
  }
  for (int i = 0; i < e.frames && made[0] && stic_cli_signal() == 0; i++) {
    const stic_sample sample = sample_of(&e, i, &lanes[1].row);

    remember(b, &sample);
    for (int p = 0; p < PRECISIONS; p++) {
      if (lanes[p].checker.complaint[0])
        continue;
      step_lane(&lanes[p], &sample, level, e.must_stand && i > e.stand_from);
      failed_at[p] = i;
    }
    for (int p = 0; p < PRECISIONS; p++)
      tally_off(&lanes[p].t, &lanes[p].row, &lanes[2].row, lanes[2].checker.size);
  }
  for (int p = 0; p < PRECISIONS; p++)
    close_lane(b, &lanes[p], &e, name, p, level, failed_at[p]);
  int worst = PRECISIONS - 1;

  while (worst >= 0 && !lanes[worst].checker.complaint[0])
    worst--;
  dump(b, &e, worst, level);
}

/* ---- heat maps ------------------------------------------------------------------------------- */

/* Digits that the balance is met to: of the worst row of all levels. Frames count from `before` this case. */
static void add_heat(stic_heat_map *map, const stic_extreme *e, const tally *t, const tally *before)
{
  if (map->count == map->room) {
    const int room = map->room * 2 + 256;
    stic_heat_point *more = realloc(map->points, (size_t)room * sizeof *more);

    map->lacks_memory |= !more;
    if (!more)
      return;
    map->points = more;
    map->room = room;
  }
  const bool answered = t->frames - before->frames > t->no_answer - before->no_answer;
  const double digits = t->residual > 0 ? -log10(t->residual) : 17;

  map->points[map->count++] = (stic_heat_point){e->a, e->b, answered ? fmin(17, fmax(0, digits)) : NAN};
}

/* Which row of maps shows a sweep, -1: none. */
static int map_row(const char *sweep)
{
  return strcmp(sweep, "k_p-mu") == 0 ? 0 : strcmp(sweep, "distance") == 0 ? 1 : -1;
}

static stic_heat_map *map_of(bench *b, const char *sweep, int precision)
{
  const int row = map_row(sweep);

  return row < 0 || !b->options->picture ? NULL : &b->maps[row * PRECISIONS + precision];
}

/* ---- tables ------------------------------------------------------------------------------------ */

static void print_head(void)
{
  printf("%-10s %-4s %6s %8s %9s %8s %7s %6s %7s %9s %6s %6s %8s %5s\n", "sweep", "", "cases", "rows",
         "residual", "off f80", "iterat.", "stages", "RELAXes", "worst us", "no ans", "limit", "refused",
         "FAIL");
}

static void print_tally(const char *name, int precision, const tally *t)
{
  char off[24];

  if (precision == PRECISIONS - 1)
    snprintf(off, sizeof off, "-");
  else
    snprintf(off, sizeof off, "%d/%d", off_quantile(t, 0.5), off_quantile(t, 0.99));
  printf("%-10s %-4s %6" PRId64 " %8" PRId64 " %9.1e %8s %7d %6d %7d %9.1f %6" PRId64 " %6" PRId64
         " %8" PRId64 " %5" PRId64 "\n",
         precision == 0 ? name : "", stic_precision_name(precisions[precision]), t->cases, t->frames,
         t->residual, off, t->iterations, t->stages, t->events, (double)t->worst_ns / 1e3, t->no_answer,
         t->limit, t->refused, t->failures);
}

static void end_sweep(bench *b, const char *name)
{
  for (int p = 0; p < PRECISIONS; p++) {
    print_tally(name, p, &b->tallies[p]);
    tally_add(&b->total[p], &b->tallies[p]);
    memset(&b->tallies[p], 0, sizeof b->tallies[p]);
  }
  fflush(stdout);
  b->failures_shown = 0;
}

static double part(int64_t count, int64_t of)
{
  return of > 0 ? 100.0 * (double)count / (double)of : 0;
}

static void print_words(const bench *b)
{
  const tally *single = &b->total[0], *twice = &b->total[1];

  printf(
    "\nresidual: of force and moment, of the largest term, worst row; off f80: distance from f80's pose, in sizes, "
    "as a power of\nten: half of the rows are within the first, 99 %% within the second. no ans: rows flagged 4, the "
    "object left where it last was.\n\n");
  printf(
    "Where f32 degrades: its worst balance is met to %.0e of the largest term (f64: %.0e). Half of its rows are "
    "within 1e%d\nsizes of f80's pose, 99 %% within 1e%d (f64: 1e%d and 1e%d). A row rounded the other way at a "
    "touch or at the limit of\nfriction goes on from another place: contacts differ from f80's in %.2f %% of the rows "
    "(f64: %.2f %%). It finds no answer\nin %.3f %% and meets a limit in %.3f %% of them (f64: %.3f %% and %.3f %%), "
    "says so, and leaves the object where it was.\n",
    single->residual, twice->residual, off_quantile(single, 0.5), off_quantile(single, 0.99),
    off_quantile(twice, 0.5), off_quantile(twice, 0.99), part(single->other_contacts, single->frames),
    part(twice->other_contacts, twice->frames), part(single->no_answer, single->frames),
    part(single->limit, single->frames), part(twice->no_answer, twice->frames),
    part(twice->limit, twice->frames));
}

/* ---- sweeps -------------------------------------------------------------------------------------- */

static int frames_of_stand(const stic_extremes_options *o)
{
  return o->long_form ? 10000000 : o->quick ? 500 : 20000;
}

/* Whether there was anything to do. */
static bool run_sweep(bench *b, const stic_sweep *sweep)
{
  const stic_extremes_options *o = b->options;
  static stic_extreme e;
  bool any = false;

  for (int k = 0; sweep->get(&e, k, frames_of_stand(o)) && stic_cli_signal() == 0; k++) {
    label name = {.sweep = sweep->name, .number = k};
    tally before[PRECISIONS];

    if (o->number >= 0 ? k != o->number : o->quick && k % sweep->thin != 0)
      continue;
    any = true;
    snprintf(name.replay, sizeof name.replay, "--sweep %s --case %d", sweep->name, k);
    stic_extreme_canonical(&e.scene);
    memcpy(before, b->tallies, sizeof before);
    for (int p = 0; p < PRECISIONS; p++)
      b->tallies[p].residual = 0;
    for (int level = 0; level < LEVELS; level++)
      run_case(b, &e, &name, level);
    for (int p = 0; p < PRECISIONS; p++) {
      stic_heat_map *map = map_of(b, sweep->name, p);

      if (map) {
        map->label_a = sweep->axis_a, map->label_b = sweep->axis_b;
        add_heat(map, &e, &b->tallies[p], &before[p]);
      }
      b->tallies[p].residual = fmax(b->tallies[p].residual, before[p].residual);
    }
  }
  if (any)
    end_sweep(b, sweep->name);
  return any;
}

static stic_status no_sweep(const char *wanted, stic_error *err)
{
  char names[200] = "";

  for (int i = 0; i < stic_sweep_count; i++)
    snprintf(names + strlen(names), sizeof names - strlen(names), "%s%s", i > 0 ? ", " : "",
             stic_sweeps[i].name);
  return stic_error_set(err, STIC_USAGE, NULL, 0, "bench extremes: there is no sweep '%.40s'; expected %s",
                        wanted, names);
}

static stic_status run_sweeps(bench *b)
{
  const char *wanted = b->options->sweep;
  bool found = false, any = false;

  for (int i = 0; i < stic_sweep_count; i++)
    found |= !wanted || strcmp(wanted, stic_sweeps[i].name) == 0;
  if (!found)
    return no_sweep(wanted, &b->err);
  print_head();
  for (int i = 0; i < stic_sweep_count && stic_cli_signal() == 0; i++) {
    if (!wanted || strcmp(wanted, stic_sweeps[i].name) == 0)
      any |= run_sweep(b, &stic_sweeps[i]);
  }
  return any || stic_cli_signal() != 0
           ? STIC_OK
           : stic_error_set(&b->err, STIC_USAGE, NULL, 0, "bench extremes: there is no case %" PRId64,
                            b->options->number);
}

/* ---- random --------------------------------------------------------------------------------------- */

/* Most at level frame; one of a hundred at event, where a row may cost a thousand times as much. */
static int level_of(int64_t number)
{
  return number % 100 == 99 ? 2 : number % 20 == 9 ? 1 : 0;
}

static void run_random(bench *b)
{
  const stic_extremes_options *o = b->options;
  const int64_t per_case = 60 * PRECISIONS, cases = (o->random + per_case - 1) / per_case;
  static stic_extreme e;

  printf("random cases, seed %" PRIu64 ", %" PRId64 " rows\n", o->seed, o->random);
  print_head();
  for (int64_t k = o->number >= 0 ? o->number : 0;
       k < (o->number >= 0 ? o->number + 1 : cases) && stic_cli_signal() == 0; k++) {
    label name = {.sweep = "random", .number = k};

    snprintf(name.replay, sizeof name.replay, "--random 1 --seed %" PRIu64 " --case %" PRId64, o->seed, k);
    stic_extreme_random(&e, o->seed, k);
    stic_extreme_canonical(&e.scene);
    run_case(b, &e, &name, level_of(k));
  }
  end_sweep(b, "random");
}

/* ---- a scene and a trace --------------------------------------------------------------------------- */

static stic_status run_files(bench *b)
{
  const label name = {.sweep = "files", .replay = ""};
  static stic_extreme e;
  stic_motion motion;
  const stic_status status =
    stic_motion_read(&motion, b->options->scene, b->options->trace, NULL, 0, &b->err);

  if (status != STIC_OK)
    return status;
  e = (stic_extreme){.scene = motion.scene, .frames = motion.count, .given = motion.samples};
  print_head();
  for (int level = 0; level < LEVELS; level++)
    run_case(b, &e, &name, level);
  end_sweep(b, name.sweep);
  stic_motion_free(&motion);
  return STIC_OK;
}

/* ---- the program ------------------------------------------------------------------------------------ */

static stic_status run(bench *b)
{
  const stic_extremes_options *o = b->options;
  stic_status status = STIC_OK;

  if (o->scene)
    status = run_files(b);
  else if (o->random > 0)
    run_random(b);
  else
    status = run_sweeps(b);
  return status != STIC_OK ? status : b->status;
}

static stic_status write_picture(bench *b)
{
  static const char *const titles[2] = {"stiffness and friction", "size and distance"};
  /* A sweep that did not run has no maps. */
  const int first = b->maps[0].count > 0 ? 0 : PRECISIONS;
  const int count = (b->maps[PRECISIONS].count > 0 ? 2 * PRECISIONS : PRECISIONS) - first;

  for (int i = 0; i < 2 * PRECISIONS; i++) {
    stic_heat_map *map = &b->maps[i];

    if (map->lacks_memory)
      return stic_error_set(&b->err, STIC_NO_MEMORY, NULL, 0, "out of memory");
    snprintf(map->title, sizeof map->title, "%s: %s", stic_precision_name(precisions[i % PRECISIONS]),
             titles[i / PRECISIONS]);
  }
  return stic_heat_picture(b->options->picture, &b->maps[first], count, PRECISIONS, &b->err);
}

static int finish(bench *b, stic_status status)
{
  int64_t failures = 0;

  for (int p = 0; p < PRECISIONS; p++)
    failures += b->total[p].failures;
  if (status == STIC_OK && b->no_memory)
    status = stic_error_set(&b->err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  if (status == STIC_OK && stic_cli_signal() == 0 && b->options->picture)
    status = write_picture(b);
  if (status != STIC_OK || stic_cli_signal() != 0) {
    stic_outfile_abort(b->csv);
    return status != STIC_OK ? stic_cli_fail(&b->err) : STIC_EXIT_SIGNAL + stic_cli_signal();
  }
  if (b->csv && stic_outfile_commit(b->csv, &b->err) != STIC_OK)
    return stic_cli_fail(&b->err);
  print_words(b);
  return failures > 0 ? STIC_FAILED : STIC_OK;
}

int stic_bench_extremes(const stic_extremes_options *options)
{
  bench *b = calloc(1, sizeof *b);
  stic_status status = STIC_OK;
  char machine[512];
  int code;

  if (!b) {
    stic_cli_say("out of memory");
    return STIC_NO_MEMORY;
  }
  b->options = options;
  if (options->picture &&
      (options->random > 0 || options->scene || (options->sweep && map_row(options->sweep) < 0)))
    status = stic_error_set(&b->err, STIC_USAGE, NULL, 0,
                            "bench extremes: --picture shows the sweeps k_p-mu and distance only");
  if (status == STIC_OK && options->csv)
    status = stic_outfile_open(options->csv, &b->csv, &b->err);
  if (status == STIC_OK) {
    if (b->csv)
      print_csv_header(b->csv);
    printf("stiction %s, %s\nEvery row of every case at levels frame, substep=3 and event.\n", stic_version(),
           stic_machine_text(machine, sizeof machine));
    status = run(b);
  }
  code = finish(b, status);
  for (int i = 0; i < 2 * PRECISIONS; i++)
    free(b->maps[i].points);
  free(b->samples);
  free(b);
  return code;
}

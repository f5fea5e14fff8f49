/* stiction bench trade: what accuracy costs and what it buys, on the user's own scene. */
#include "../../angle.h"
#include "../../error.h"
#include "../../io/outfile.h"
#include "../../io/timing.h"
#include "bench.h"
#include "../cli.h"
#include "trade.h"

#include <float.h>
#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LEVELS = STIC_TRADE_LEVELS, PRECISIONS = 3, SETTINGS = LEVELS * PRECISIONS, H_MINS = 5 };

#define MOTIONS_MAX 16
#define SAMPLES_MAX 2000 /* of a trace: more say little more, and substep=256 takes its time */
#define ENOUGH 1e-6      /* of the object's size: far below what any tracker resolves */

/* Position in the list of settings; event is the last level. */
static int setting_of(int level, int precision)
{
  return precision * LEVELS + level;
}

#define REFERENCE (SETTINGS - 1)
#define EVENT_F64 (2 * LEVELS - 1)
#define FRAME_F64 LEVELS

static const double h_mins[H_MINS] = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6};

typedef struct bench {
  const stic_trade_options *options;
  stic_outfile *csv; /* NULL: not asked for */
  stic_motion motion;
  stic_settings settings[SETTINGS], h_settings[H_MINS];
  stic_outcome outcomes[SETTINGS], h_outcomes[H_MINS];
  stic_outcome finer; /* the reference with a tenth of its h_min */
  stic_difference differences[SETTINGS];
  double size, own_error; /* m; of the reference, of the object's size */
  stic_trade_panel panels[MOTIONS_MAX];
  int panel_count;
  stic_error err;
} bench;

/* ---- CSV --------------------------------------------------------------------------------- */

static void csv_begin(stic_outfile *csv)
{
  stic_outfile_print(
    csv, "scene,part,accuracy,precision,h_min,rate_hz,shift,frames,position_max_m,position_rms_m,"
         "position_max_rel,position_rms_rel,angle_max_rad,angle_rms_rad,force_max_rel,force_rms_rel,"
         "slips,slips_error,slip_time_s,slip_time_max_s,median_ns,p99_ns,worst_ns,worst_of_all_ns,"
         "flagged,contacts_changed,events_changed,tried,hash\n");
}

static void csv_name(stic_outfile *csv, const char *name)
{
  stic_outfile_print(csv, "\"");
  for (; *name; name++)
    stic_outfile_print(csv, *name == '"' ? "\"\"" : "%c", *name);
  stic_outfile_print(csv, "\"");
}

static void csv_row(bench *b, const char *part, const stic_settings *s, double rate, const stic_outcome *o,
                    const stic_difference *d, bool timed)
{
  char accuracy[32];

  if (!b->csv)
    return;
  stic_settings_accuracy_text(s, accuracy, sizeof accuracy);
  csv_name(b->csv, b->motion.name);
  stic_outfile_print(
    b->csv, ",%s,%s,%s,%g,%g,,%d,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%lld,%lld,%.9g,%.9g,", part,
    accuracy, stic_precision_name(s->precision), s->h_min, rate, o->count, d->position_max, d->position_rms,
    d->position_max / b->size, d->position_rms / b->size, d->angle_max, d->angle_rms, d->force_max,
    d->force_rms, (long long)o->slips, (long long)d->slips, d->slip_time, d->slip_time_max);
  if (timed)
    stic_outfile_print(b->csv, "%lld,%lld,%lld,%lld,", (long long)stic_outcome_cost(o, 0.5),
                       (long long)stic_outcome_cost(o, 0.99), (long long)stic_outcome_cost(o, 1),
                       (long long)o->worst_ns);
  else
    stic_outfile_print(b->csv, ",,,,");
  stic_outfile_print(b->csv, "%d,,,,%016llx\n", o->flagged, (unsigned long long)o->hash);
}

/* ---- levels and precisions ----------------------------------------------------------------- */

static void make_settings(bench *b)
{
  for (int p = 0; p < PRECISIONS; p++)
    for (int l = 0; l < LEVELS; l++) {
      stic_settings *s = &b->settings[setting_of(l, p)];

      stic_settings_init(s);
      s->precision = p == 0 ? STIC_F32 : p == 1 ? STIC_F64 : STIC_F80;
      s->level = l == 0 ? STIC_LEVEL_FRAME : l == LEVELS - 1 ? STIC_LEVEL_EVENT : STIC_LEVEL_SUBSTEP;
      s->substeps = 1 << l;
    }
  for (int i = 0; i < H_MINS; i++) {
    stic_settings_init(&b->h_settings[i]);
    b->h_settings[i].h_min = h_mins[i];
  }
}

/* Every setting once, then again, each time beginning with another one: what the machine does meanwhile falls on
 * all alike, and the fastest of a row's runs is its cost. */
static stic_status run_all(bench *b)
{
  const int runs = b->options->quick ? 2 : 15, all = SETTINGS + H_MINS;
  stic_settings finer = b->settings[REFERENCE];
  stic_status status = STIC_OK;

  for (int run = 0; run < runs; run++)
    for (int i = 0; i < all && status == STIC_OK && stic_cli_signal() == 0; i++) {
      const int k = (i + run * 7) % all;

      status = k < SETTINGS ? stic_outcome_run(&b->outcomes[k], &b->motion, &b->settings[k], 1, &b->err)
                            : stic_outcome_run(&b->h_outcomes[k - SETTINGS], &b->motion,
                                               &b->h_settings[k - SETTINGS], 1, &b->err);
    }
  finer.h_min /= 10;
  if (status == STIC_OK)
    status = stic_outcome_run(&b->finer, &b->motion, &finer, 1, &b->err);
  return status;
}

static void print_row(const stic_settings *s, const char *name, const stic_outcome *o,
                      const stic_difference *d, double size)
{
  printf("  %-12s %-4s %8lld %8lld %9lld  %8.1e %8.1e  %8.1e %8.1e %6lld %+5lld %9.2g\n", name,
         stic_precision_name(s->precision), (long long)stic_outcome_cost(o, 0.5),
         (long long)stic_outcome_cost(o, 0.99), (long long)stic_outcome_cost(o, 1), d->position_rms / size,
         d->position_max / size, d->angle_max, d->force_max, (long long)o->slips, (long long)d->slips,
         d->slip_time);
}

static const char table_head[] = "  %-12s %-4s %26s  %17s  %8s %8s %6s %5s %9s\n"
                                 "  %-12s %-4s %8s %8s %9s  %8s %8s  %8s %8s %6s %5s %9s\n";

static void print_head(const char *what)
{
  printf(table_head, "", "", "ns a frame", "position / size", "angle", "force", "", "", "slip", what, "",
         "median", "p99", "worst", "rms", "max", "max rad", "max rel", "slips", "more", "time, s");
}

static void print_settings(bench *b)
{
  stic_difference h, rounding;

  print_head("accuracy");
  for (int k = 0; k < SETTINGS; k++) {
    char name[32];

    stic_outcome_compare(&b->motion, &b->outcomes[REFERENCE], &b->outcomes[k], 1, &b->differences[k]);
    stic_settings_accuracy_text(&b->settings[k], name, sizeof name);
    print_row(&b->settings[k], name, &b->outcomes[k], &b->differences[k], b->size);
    csv_row(b, "level", &b->settings[k], 0, &b->outcomes[k], &b->differences[k], true);
  }
  rounding = b->differences[EVENT_F64];
  stic_outcome_compare(&b->motion, &b->outcomes[REFERENCE], &b->finer, 1, &h);
  /* f80 rounds 2048 times finer than f64. */
  b->own_error = fmax(rounding.position_rms / b->size / 2048, LDBL_EPSILON / 16);
  printf(
    "  Reference: event, f80. f64 differs from it by %.1e of the object's size (rms); rounding 2048 times finer, its\n"
    "  own error is about %.0e. With a tenth of its h_min it differs by %.1e (rms): %s.\n",
    rounding.position_rms / b->size, b->own_error, h.position_rms / b->size,
    h.position_rms / b->size > 1e-9
      ? "here h_min is part of the answer, bursts of slips begin infinitely small"
      : "h_min plays no part");
}

static void print_h_mins(bench *b)
{
  print_head("h_min");
  for (int i = 0; i < H_MINS; i++) {
    char name[32];
    stic_difference d;

    stic_outcome_compare(&b->motion, &b->outcomes[REFERENCE], &b->h_outcomes[i], 1, &d);
    snprintf(name, sizeof name, "%g%s", h_mins[i], h_mins[i] == 1e-4 ? " *" : "");
    print_row(&b->h_settings[i], name, &b->h_outcomes[i], &d, b->size);
    csv_row(b, "h_min", &b->h_settings[i], 0, &b->h_outcomes[i], &d, true);
  }
  printf("  * the default. There is no root tolerance to choose: roots are solved to rounding.\n");
}

/* ---- a start that is a little different ----------------------------------------------------- */

enum { SHIFTS = 7, DIRECTIONS = 16 };

/* Start and holding point moved by a part of the size, the start turned by as many rad. With `hold: start` a free
 * object forgets its start at once, but not where it is held. */
static void shift_start(const stic_motion *from, double shift, int direction, double size, stic_motion *to)
{
  const double a = 2 * STIC_PI * direction / DIRECTIONS;

  *to = *from;
  to->scene.x += shift * size * cos(a);
  to->scene.y += shift * size * sin(a);
  to->scene.angle += shift * cos(3 * a);
  to->scene.holding_point[0] += shift * size * cos(a + 1);
  to->scene.holding_point[1] += shift * size * sin(a + 1);
}

static stic_status shifted(bench *b, const stic_settings *settings, const stic_outcome *as_it_is,
                           double shift)
{
  int contacts = 0, events = 0, tried = 0;
  double farthest = 0;
  char accuracy[32];

  for (int i = 0; i < DIRECTIONS && stic_cli_signal() == 0; i++) {
    stic_motion motion;
    stic_outcome o = {0};
    stic_difference d;
    stic_error ignored;

    shift_start(&b->motion, shift, i, b->size, &motion);
    if (stic_scene_validate(&motion.scene, &ignored) != STIC_OK)
      continue; /* it would start inside a surface */
    if (stic_outcome_run(&o, &motion, settings, 1, &b->err) != STIC_OK)
      return b->err.status;
    stic_outcome_compare(&b->motion, as_it_is, &o, 1, &d);
    tried++;
    contacts += o.contacts != as_it_is->contacts;
    events += o.events != as_it_is->events;
    farthest = fmax(farthest, d.position_max / b->size);
    stic_outcome_free(&o);
  }
  stic_settings_accuracy_text(settings, accuracy, sizeof accuracy);
  printf("  %-12s %8.0e %8d %8d   of %d %14.1e\n", accuracy, shift, contacts, events, tried, farthest);
  if (b->csv) {
    csv_name(b->csv, b->motion.name);
    stic_outfile_print(b->csv, ",start,%s,%s,%g,,%g,%d,%.9g,,%.9g,,,,,,,,,,,,,,,%d,%d,%d,\n", accuracy,
                       stic_precision_name(settings->precision), settings->h_min, shift, as_it_is->count,
                       farthest * b->size, farthest, contacts, events, tried);
  }
  return STIC_OK;
}

static stic_status print_starts(bench *b)
{
  static const int settings[2] = {EVENT_F64, FRAME_F64};
  stic_status status = STIC_OK;

  printf(
    "  Start and grip moved in %d directions by a part of the object's size: how many give another sequence of\n"
    "  contact sets, or of touches, openings, slips and snaps.\n  %-12s %8s %8s %8s %19s\n",
    DIRECTIONS, "accuracy", "by", "sets", "events", "position, max");
  for (int k = 0; k < 2; k++)
    for (int i = 0; i < SHIFTS && status == STIC_OK; i++)
      status = shifted(b, &b->settings[settings[k]], &b->outcomes[settings[k]], pow(10, i - 9));
  return status;
}

/* ---- tracker's rate -------------------------------------------------------------------------- */

static stic_status at_rate(bench *b, const stic_motion *fine, const stic_outcome *reference, int stride)
{
  static const int settings[2] = {FRAME_F64, EVENT_F64};
  stic_difference d[2];
  int64_t slips[2] = {0, 0};

  for (int k = 0; k < 2; k++) {
    stic_outcome o = {0};

    if (stic_outcome_run(&o, fine, &b->settings[settings[k]], stride, &b->err) != STIC_OK)
      return b->err.status;
    stic_outcome_compare(fine, reference, &o, stride, &d[k]);
    csv_row(b, "rate", &b->settings[settings[k]], 1000.0 / stride, &o, &d[k], false);
    slips[k] = o.slips;
    stic_outcome_free(&o);
  }
  printf("  %8.2f  %9.1e %9.1e %6lld %9.2g   %9.1e %9.1e %6lld %9.2g\n", 1000.0 / stride,
         d[0].position_rms / b->size, d[0].position_max / b->size, (long long)slips[0], d[0].slip_time,
         d[1].position_rms / b->size, d[1].position_max / b->size, (long long)slips[1], d[1].slip_time);
  return STIC_OK;
}

static stic_status print_rates(bench *b)
{
  static const int strides[] = {100, 50, 32, 16, 8, 4, 2, 1};
  stic_motion fine;
  stic_outcome reference = {0};
  stic_status status = stic_motion_resample(&b->motion, &fine, &b->err);

  if (status != STIC_OK)
    return status;
  status = stic_outcome_run(&reference, &fine, &b->settings[REFERENCE], 1, &b->err);
  printf(
    "  The same motion, a smooth curve through the samples, seen by slower trackers; error at their samples, of the\n"
    "  object's size, against event, f80 at 1000 Hz (%lld slips). The paper has 31 Hz and level frame.\n"
    "  %8s  %36s   %36s\n  %8s  %9s %9s %6s %9s   %9s %9s %6s %9s\n",
    (long long)reference.slips, "", "frame, f64     ", "event, f64     ", "Hz", "rms", "max", "slips",
    "slip, s", "rms", "max", "slips", "slip, s");
  for (size_t i = 0; i < sizeof strides / sizeof strides[0] && status == STIC_OK && stic_cli_signal() == 0;
       i++)
    if (strides[i] < fine.count)
      status = at_rate(b, &fine, &reference, strides[i]);
  stic_outcome_free(&reference);
  stic_motion_free(&fine);
  return status;
}

/* ---- in words -------------------------------------------------------------------------------- */

/* As drawn and judged: the reference has its own error, none has less. */
static double error_of(const bench *b, int k)
{
  return fmax(b->differences[k].position_rms / b->size, b->own_error);
}

static double cost_of(const bench *b, int k)
{
  return fmax(1, (double)stic_outcome_cost(&b->outcomes[k], 0.5));
}

static bool on_front(const bench *b, int k)
{
  for (int i = 0; i < SETTINGS; i++) {
    if (cost_of(b, i) <= cost_of(b, k) && error_of(b, i) <= error_of(b, k) && i != k &&
        (cost_of(b, i) < cost_of(b, k) || error_of(b, i) < error_of(b, k)))
      return false;
  }
  return true;
}

/* The knee: of the settings that no other beats in both, the one farthest below the line from the cheapest to
 * the most accurate, in logarithms. */
static int find_knee(const bench *b)
{
  int cheapest = -1, best = -1, knee = -1;
  double deepest = -1;

  for (int k = 0; k < SETTINGS; k++) {
    if (!on_front(b, k))
      continue;
    if (cheapest < 0 || cost_of(b, k) < cost_of(b, cheapest))
      cheapest = k;
    if (best < 0 || error_of(b, k) < error_of(b, best))
      best = k;
  }
  for (int k = 0; k < SETTINGS; k++) {
    const double dx = log(error_of(b, best) / error_of(b, cheapest)),
                 dy = log(cost_of(b, best) / cost_of(b, cheapest));
    const double x = log(error_of(b, k) / error_of(b, cheapest)),
                 y = log(cost_of(b, k) / cost_of(b, cheapest));
    const double depth = x * dy - y * dx; /* dx < 0: below the line is positive where it saves error early */

    if (on_front(b, k) && (knee < 0 || -depth > deepest)) {
      knee = k;
      deepest = -depth;
    }
  }
  return knee;
}

static int find_recommended(const bench *b)
{
  int found = -1, best = 0;

  for (int k = 0; k < SETTINGS; k++) {
    if (error_of(b, k) <= ENOUGH && (found < 0 || cost_of(b, k) < cost_of(b, found)))
      found = k;
    if (error_of(b, k) < error_of(b, best))
      best = k;
  }
  return found < 0 ? best : found;
}

static const char *setting_text(const bench *b, int k, char out[48])
{
  char accuracy[32];

  stic_settings_accuracy_text(&b->settings[k], accuracy, sizeof accuracy);
  snprintf(out, 48, "%s, %s", accuracy, stic_precision_name(b->settings[k].precision));
  return out;
}

static void print_words(const bench *b)
{
  const int knee = find_knee(b), chosen = find_recommended(b), last = setting_of(LEVELS - 2, 1);
  const stic_difference *frame = &b->differences[FRAME_F64], *substep = &b->differences[last];
  char text[48];

  printf("  In words: the knee is at %s: %.0f ns a frame at an error of %.0e of the object's size.",
         setting_text(b, knee, text), cost_of(b, knee), error_of(b, knee));
  printf(
    " Level frame, the paper's, costs\n  %.0f %% of event (f64) and is wrong by %.1e of the size (rms; at most %.1e), with %lld slips instead of "
    "%lld, %.2g s off on average.\n",
    100 * cost_of(b, FRAME_F64) / cost_of(b, EVENT_F64), frame->position_rms / b->size,
    frame->position_max / b->size, (long long)b->outcomes[FRAME_F64].slips,
    (long long)b->outcomes[REFERENCE].slips, frame->slip_time);
  printf("  substep=256 costs %.1f times event and is still off by %.1e: %s.\n",
         cost_of(b, last) / cost_of(b, EVENT_F64), substep->position_rms / b->size,
         substep->position_rms > 1e-9 * b->size
           ? "a slip found late lands elsewhere and shifts those after it"
           : "there is little on this way to be late for");
  printf(
    "  f32 at level event costs %.2f times f64 and errs by %.0e; f80 costs %.2f times and changes %.0e.\n",
    cost_of(b, setting_of(LEVELS - 1, 0)) / cost_of(b, EVENT_F64), error_of(b, setting_of(LEVELS - 1, 0)),
    cost_of(b, REFERENCE) / cost_of(b, EVENT_F64), error_of(b, EVENT_F64));
  printf("  Recommended for this scene: %s, ", setting_text(b, chosen, text));
  if (error_of(b, chosen) <= ENOUGH)
    printf("the cheapest that errs by less than a millionth of the object's size.\n");
  else
    printf("the most accurate; none errs by less than a millionth of the object's size.\n");
}

static void keep_panel(bench *b)
{
  stic_trade_panel *panel = &b->panels[b->panel_count++];

  memcpy(panel->title, b->motion.name, sizeof panel->title);
  for (int p = 0; p < PRECISIONS; p++) {
    panel->has[p] = true;
    for (int l = 0; l < LEVELS; l++) {
      const int k = setting_of(l, p);

      panel->points[p][l] =
        (stic_trade_point){error_of(b, k), cost_of(b, k), (double)stic_outcome_cost(&b->outcomes[k], 0.99)};
    }
  }
}

/* ---- closed forms ---------------------------------------------------------------------------- */

/* Where the answer is known, the reference's own error is too. */
static stic_status print_closed_forms(bench *b)
{
  static const stic_precision precisions[2] = {STIC_F80, STIC_F64};
  stic_status status = STIC_OK;

  printf("Where closed forms are known (bench validate), level event errs by at most");
  for (int p = 0; p < 2 && status == STIC_OK && stic_cli_signal() == 0; p++) {
    stic_closed_form_result r = {0, 0, 0};

    status = stic_closed_forms(precisions[p], &r, &b->err);
    printf("%s %.1e with %s (%d of %d within bounds)", p ? "," : "", r.worst,
           stic_precision_name(precisions[p]), r.passed, r.rows);
  }
  printf(".\n");
  return status;
}

/* ---- all ------------------------------------------------------------------------------------- */

static void clear(bench *b)
{
  for (int k = 0; k < SETTINGS; k++)
    stic_outcome_free(&b->outcomes[k]);
  for (int i = 0; i < H_MINS; i++)
    stic_outcome_free(&b->h_outcomes[i]);
  stic_outcome_free(&b->finer);
  stic_motion_free(&b->motion);
}

static stic_status trade_motion(bench *b)
{
  stic_status status;

  b->size = stic_scene_size(&b->motion.scene);
  printf("\n%s: %d samples in %.2f s, object size %.4g m, h_min %g\n", b->motion.name, b->motion.count,
         (double)(b->motion.samples[b->motion.count - 1].t_ns - b->motion.samples[0].t_ns) * 1e-9, b->size,
         b->settings[REFERENCE].h_min);
  if (b->motion.count > SAMPLES_MAX) {
    b->motion.count = SAMPLES_MAX;
    printf("  only the first %d samples are used\n", SAMPLES_MAX);
  }
  status = run_all(b);
  if (status == STIC_OK && stic_cli_signal() == 0) {
    print_settings(b);
    print_h_mins(b);
    status = print_starts(b);
  }
  if (status == STIC_OK && stic_cli_signal() == 0)
    status = print_rates(b);
  if (status == STIC_OK && stic_cli_signal() == 0) {
    print_words(b);
    keep_panel(b);
  }
  clear(b);
  return status;
}

static stic_status trade_file(bench *b, const char *scene, const char *trace)
{
  stic_override *overrides = NULL;
  int count = 0;
  stic_status status = stic_cli_overrides(b->options->set, &overrides, &count, &b->err);

  if (status == STIC_OK)
    status = stic_motion_read(&b->motion, scene, trace, overrides, count, &b->err);
  free(overrides);
  return status == STIC_OK && b->motion.count > 0 ? trade_motion(b) : status;
}

/* traces/NAME/hand.csv with scene.yaml beside it. */
static stic_status trade_tree(bench *b)
{
  glob_t found;
  stic_status status = STIC_OK;

  if (glob("traces/*/hand.csv", 0, NULL, &found) != 0) {
    globfree(&found);
    status = stic_motion_built_in(&b->motion, &b->err);
    return status == STIC_OK ? trade_motion(b) : status;
  }
  for (size_t i = 0; i < found.gl_pathc && i < MOTIONS_MAX && status == STIC_OK && stic_cli_signal() == 0;
       i++) {
    const char *trace = found.gl_pathv[i];
    char scene[512];

    snprintf(scene, sizeof scene, "%.*sscene.yaml", (int)(strlen(trace) - strlen("hand.csv")), trace);
    status = trade_file(b, scene, trace);
  }
  globfree(&found);
  return status;
}

static int finish(bench *b, stic_status status)
{
  if (status == STIC_OK && stic_cli_signal() == 0 && b->options->plot)
    status = stic_trade_plot(b->options->plot, b->panels, b->panel_count, &b->err);
  if (status != STIC_OK || stic_cli_signal() != 0) {
    stic_outfile_abort(b->csv);
    return status != STIC_OK ? stic_cli_fail(&b->err) : STIC_EXIT_SIGNAL + stic_cli_signal();
  }
  if (b->csv && stic_outfile_commit(b->csv, &b->err) != STIC_OK)
    return stic_cli_fail(&b->err);
  return STIC_OK;
}

int stic_bench_trade(const stic_trade_options *options)
{
  bench *b = calloc(1, sizeof *b);
  char machine[512];
  stic_status status = STIC_OK;
  int code;

  if (!b) {
    stic_cli_say("out of memory");
    return STIC_NO_MEMORY;
  }
  b->options = options;
  make_settings(b);
  if (options->csv)
    status = stic_outfile_open(options->csv, &b->csv, &b->err);
  if (status == STIC_OK) {
    if (b->csv)
      csv_begin(b->csv);
    printf("stiction %s, %s\nA row's cost is its fastest of %d runs, all settings in turn; clock included.\n",
           stic_version(), stic_machine_text(machine, sizeof machine), options->quick ? 2 : 15);
    status = print_closed_forms(b);
  }
  if (status == STIC_OK && stic_cli_signal() == 0) {
    status = options->scene ? trade_file(b, options->scene, options->trace) : trade_tree(b);
  }
  code = finish(b, status);
  clear(b);
  free(b);
  return code;
}

/* stiction bench: the measurements, one file each. */
#include "bench/bench.h"
#include "cli.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

static const stic_cli_usage usage = {
  "bench", "[OPTION...] speed|render|devices|validate|trade|extremes [SCENE TRACE]",
  "speed     what a sample costs: solving, further surfaces and vertices, files, start-up\n"
  "render    what a picture costs on one core, by stage, size and quality; PNG and video\n"
  "devices   what decoding a report costs, how long a sample takes to its result through a pseudo terminal at the\n"
  "          device's own rate, and whether of 600,000 reports any is lost; ends with 1 if one is\n"
  "validate  closed forms of friction against what the solver says, row by row; ends with 1 if one fails\n"
  "trade     what each accuracy level and precision costs and how far it is from the reference, for SCENE\n"
  "          and TRACE or for those in traces/; a work-precision diagram, and which level to take\n"
  "extremes  every range swept to its ends, or random cases, and every row held against the model's invariants, in\n"
  "          all precisions and levels; with SCENE and TRACE only these; ends with 1 if one is broken\n",
  1, 3};

#define NOT_GIVEN INT_MIN /* of a number */

typedef struct bench_options {
  int quick, long_form;
  char *csv, *plot;
  double spoil, seconds;
  char **set;
  /* extremes */
  char *picture, *sweep, *dump;
  long long random, seed, number;
} bench_options;

static bool extremes_only(const bench_options *o)
{
  return o->picture || o->sweep || o->dump || o->random != NOT_GIVEN || o->number != NOT_GIVEN ||
         o->seed != NOT_GIVEN || o->long_form;
}

static int extremes(const stic_cli_args *args, const bench_options *o)
{
  const bool random = o->random != NOT_GIVEN;
  const stic_extremes_options options = {.quick = o->quick != 0,
                                         .long_form = o->long_form != 0,
                                         .random = random ? o->random : 0,
                                         .seed = o->seed != NOT_GIVEN ? (uint64_t)o->seed : 1,
                                         .number = o->number != NOT_GIVEN ? o->number : -1,
                                         .sweep = o->sweep,
                                         .dump = o->dump,
                                         .csv = o->csv,
                                         .picture = o->picture,
                                         .scene = args->positions[1],
                                         .trace = args->positions[2]};

  if ((random && o->random < 1) || (random && o->sweep)) {
    stic_cli_say("bench extremes: --random is a number of rows above 0, without --sweep");
    return STIC_USAGE;
  }
  if ((random && o->long_form) || (!random && o->seed != NOT_GIVEN)) {
    stic_cli_say("bench extremes: --seed goes with --random only, --long only without");
    return STIC_USAGE;
  }
  if (o->dump && (o->number < 0 || (!random && !o->sweep))) {
    stic_cli_say("bench extremes: --dump needs --case K and either --sweep NAME or --random N");
    return STIC_USAGE;
  }
  if (o->number != NOT_GIVEN && o->number < 0) {
    stic_cli_say("bench extremes: --case is %lld; expected 0 or above", o->number);
    return STIC_USAGE;
  }
  if (o->picture && (random || args->positions[1])) {
    stic_cli_say("bench extremes: --picture is of sweeps, not of random cases or of a scene");
    return STIC_USAGE;
  }
  return stic_bench_extremes(&options);
}

static int measure(const stic_cli_args *args, const bench_options *o)
{
  const char *name = args->positions[0];
  const bool trade = strcmp(name, "trade") == 0, validate = strcmp(name, "validate") == 0;
  const bool render = strcmp(name, "render") == 0, devices = strcmp(name, "devices") == 0;
  const bool extreme = strcmp(name, "extremes") == 0;
  const char *const inputs[] = {args->positions[1], args->positions[2]}, *const outputs[] = {o->csv,
                                                                                             o->picture};
  stic_error err;

  if (!trade && !validate && !render && !devices && !extreme && strcmp(name, "speed") != 0) {
    stic_cli_say(
      "bench: unknown measurement '%.40s'; expected speed, render, devices, validate, trade or extremes",
      name);
    return STIC_USAGE;
  }
  if (args->position_count != 1 && !((trade || extreme) && args->position_count == 3)) {
    stic_cli_say("bench %s: expected %s", name, trade || extreme ? "SCENE and TRACE, or neither" : "no file");
    return STIC_USAGE;
  }
  if ((o->csv && !trade && !validate && !devices && !extreme) || (o->seconds != NOT_GIVEN && !devices) ||
      ((o->plot || o->set) && !trade)) {
    stic_cli_say("bench %s has no %s", name,
                 o->plot  ? "--plot"
                 : o->set ? "--set"
                 : o->csv ? "--csv"
                          : "--seconds");
    return STIC_USAGE;
  }
  if (extremes_only(o) && !extreme) {
    stic_cli_say("bench %s has none of --picture, --sweep, --case, --dump, --random, --seed and --long",
                 name);
    return STIC_USAGE;
  }
  if (stic_cli_check_paths(inputs, 2, outputs, 2, &err) != STIC_OK)
    return stic_cli_fail(&err);
  if (extreme)
    return extremes(args, o);
  if (trade) {
    const stic_trade_options options = {
      o->quick != 0, args->positions[1], args->positions[2], o->csv, o->plot, o->set};

    return stic_bench_trade(&options);
  }
  if (devices) {
    const stic_bench_devices_options options = {
      o->quick != 0, o->seconds == NOT_GIVEN ? o->quick ? 2 : 60 : o->seconds, o->csv};

    return stic_bench_devices(&options);
  }
  if (render)
    return stic_bench_render(o->quick != 0);
  return validate ? stic_bench_validate(o->quick != 0, o->csv, o->spoil) : stic_bench_speed(o->quick != 0);
}

int stic_cmd_bench(int argc, const char **argv)
{
  bench_options o = {
    .spoil = 1, .seconds = NOT_GIVEN, .seed = NOT_GIVEN, .random = NOT_GIVEN, .number = NOT_GIVEN};
  const struct poptOption table[] = {
    {"quick", '\0', POPT_ARG_NONE, &o.quick, 0, "Few repetitions: whether it works, not how fast", NULL},
    {"csv", '\0', POPT_ARG_STRING, &o.csv, 0,
     "validate, trade, devices, extremes: write the table also as CSV", "FILE"},
    {"seconds", '\0', POPT_ARG_DOUBLE, &o.seconds, 0, "devices: how long latency is measured, default 60",
     "N"},
    {"plot", '\0', POPT_ARG_STRING, &o.plot, 0, "trade: draw NAME.png and NAME.svg (needs gnuplot)", "NAME"},
    {"set", '\0', POPT_ARG_ARGV, &o.set, 0, "trade: override a value of the scene; repeatable", "KEY=VALUE"},
    {"picture", '\0', POPT_ARG_STRING, &o.picture, 0, "extremes: heat maps as PNG (needs gnuplot)", "FILE"},
    {"sweep", '\0', POPT_ARG_STRING, &o.sweep, 0, "extremes: only this one", "NAME"},
    {"random", '\0', POPT_ARG_LONGLONG, &o.random, 0, "extremes: this many rows of random cases instead",
     "N"},
    {"seed", '\0', POPT_ARG_LONGLONG, &o.seed, 0, "extremes: of the random cases, default 1", "S"},
    {"case", '\0', POPT_ARG_LONGLONG, &o.number, 0, "extremes: only this case of a sweep or seed", "K"},
    {"dump", '\0', POPT_ARG_STRING, &o.dump, 0, "extremes: write that case as scene.yaml and hand.csv",
     "FOLDER"},
    {"long", '\0', POPT_ARG_NONE, &o.long_form, 0,
     "extremes: also ten million rows of standing still at each place", NULL},
    /* A control: the table must fail if the solver's friction is not the formulas'. */
    {"spoil", '\0', POPT_ARG_DOUBLE | POPT_ARGFLAG_DOC_HIDDEN, &o.spoil, 0, NULL, NULL},
    POPT_TABLEEND};
  stic_cli_args args;
  int code = stic_cli_parse(&usage, table, argc, argv, &args);

  if (code < 0)
    code = measure(&args, &o);
  stic_cli_args_free(&args);
  free(o.csv);
  free(o.plot);
  free(o.picture);
  free(o.sweep);
  free(o.dump);
  stic_cli_free_list(o.set);
  return code;
}

/* stiction bench: the measurements, one file each. */
#include "bench.h"
#include "cli.h"

#include <stdlib.h>
#include <string.h>

static const stic_cli_usage usage = {
  "bench", "[OPTION...] speed|render|devices|validate|trade [SCENE TRACE]",
  "speed     what a sample costs: solving, further surfaces and vertices, files, start-up\n"
  "render    what a picture costs on one core, by stage, size and quality; PNG and video\n"
  "devices   what decoding a report costs, how long a sample takes to its result through a pseudo terminal at the\n"
  "          device's own rate, and whether of 600,000 reports any is lost; ends with 1 if one is\n"
  "validate  closed forms of friction against what the solver says, row by row; ends with 1 if one fails\n"
  "trade     what each accuracy level and precision costs and how far it is from the reference, for SCENE\n"
  "          and TRACE or for those in traces/; a work-precision diagram, and which level to take\n",
  1, 3};

typedef struct bench_options {
  int quick;
  char *csv, *plot;
  double spoil, seconds;
  char **set;
} bench_options;

static int measure(const stic_cli_args *args, const bench_options *o)
{
  const char *name = args->positions[0];
  const bool trade = strcmp(name, "trade") == 0, validate = strcmp(name, "validate") == 0;
  const bool render = strcmp(name, "render") == 0, devices = strcmp(name, "devices") == 0;

  if (!trade && !validate && !render && !devices && strcmp(name, "speed") != 0) {
    stic_cli_say("bench: unknown measurement '%.40s'; expected speed, render, devices, validate or trade",
                 name);
    return STIC_USAGE;
  }
  if (args->position_count != 1 && !(trade && args->position_count == 3)) {
    stic_cli_say("bench %s: expected %s", name, trade ? "SCENE and TRACE, or neither" : "no file");
    return STIC_USAGE;
  }
  if ((o->csv && !trade && !validate && !devices) || (o->seconds != 0 && !devices) ||
      ((o->plot || o->set) && !trade)) {
    stic_cli_say("bench %s has no %s", name,
                 o->plot  ? "--plot"
                 : o->set ? "--set"
                 : o->csv ? "--csv"
                          : "--seconds");
    return STIC_USAGE;
  }
  if (trade) {
    const stic_trade_options options = {
      o->quick != 0, args->positions[1], args->positions[2], o->csv, o->plot, o->set};
    const char *const inputs[] = {args->positions[1], args->positions[2]}, *const outputs[] = {o->csv};
    stic_error err;

    if (stic_cli_check_paths(inputs, 2, outputs, 1, &err) != STIC_OK)
      return stic_cli_fail(&err);
    return stic_bench_trade(&options);
  }
  if (devices) {
    const stic_bench_devices_options options = {o->quick != 0, o->seconds, o->csv};

    return stic_bench_devices(&options);
  }
  if (render)
    return stic_bench_render(o->quick != 0);
  return validate ? stic_bench_validate(o->quick != 0, o->csv, o->spoil) : stic_bench_speed(o->quick != 0);
}

int stic_cmd_bench(int argc, const char **argv)
{
  bench_options o = {0, NULL, NULL, 1, 0, NULL};
  const struct poptOption table[] = {
    {"quick", '\0', POPT_ARG_NONE, &o.quick, 0, "Few repetitions: whether it works, not how fast", NULL},
    {"csv", '\0', POPT_ARG_STRING, &o.csv, 0, "validate, trade, devices: write the table also as CSV",
     "FILE"},
    {"seconds", '\0', POPT_ARG_DOUBLE, &o.seconds, 0, "devices: how long latency is measured, default 60",
     "N"},
    {"plot", '\0', POPT_ARG_STRING, &o.plot, 0, "trade: draw NAME.png and NAME.svg (needs gnuplot)", "NAME"},
    {"set", '\0', POPT_ARG_ARGV, &o.set, 0, "trade: override a value of the scene; repeatable", "KEY=VALUE"},
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
  stic_cli_free_list(o.set);
  return code;
}

/* stiction bench: the measurements, one file each. */
#include "bench.h"
#include "cli.h"

#include <stdlib.h>
#include <string.h>

static const stic_cli_usage usage = {
  "bench", "[OPTION...] speed|render|validate|trade [SCENE TRACE]",
  "speed     what a sample costs: solving, further surfaces and vertices, files, start-up\n"
  "render    what a picture costs on one core, by stage, size and quality; PNG and video\n"
  "validate  closed forms of friction against what the solver says, row by row; ends with 1 if one fails\n"
  "trade     what each accuracy level and precision costs and how far it is from the reference, for SCENE\n"
  "          and TRACE or for those in traces/; a work-precision diagram, and which level to take\n",
  1, 3};

typedef struct bench_options {
  int quick;
  char *csv, *plot;
  double spoil;
  char **set;
} bench_options;

static int measure(const stic_cli_args *args, const bench_options *o)
{
  const char *name = args->positions[0];
  const bool trade = strcmp(name, "trade") == 0, validate = strcmp(name, "validate") == 0;
  const bool render = strcmp(name, "render") == 0;

  if (!trade && !validate && !render && strcmp(name, "speed") != 0) {
    stic_cli_say("bench: unknown measurement '%.40s'; expected speed, render, validate or trade", name);
    return STIC_USAGE;
  }
  if (args->position_count != 1 && !(trade && args->position_count == 3)) {
    stic_cli_say("bench %s: expected %s", name, trade ? "SCENE and TRACE, or neither" : "no file");
    return STIC_USAGE;
  }
  if ((o->csv && !trade && !validate) || ((o->plot || o->set) && !trade)) {
    stic_cli_say("bench %s has no %s", name, o->plot ? "--plot" : o->set ? "--set" : "--csv");
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
  if (render)
    return stic_bench_render(o->quick != 0);
  return validate ? stic_bench_validate(o->quick != 0, o->csv, o->spoil) : stic_bench_speed(o->quick != 0);
}

int stic_cmd_bench(int argc, const char **argv)
{
  bench_options o = {0, NULL, NULL, 1, NULL};
  const struct poptOption table[] = {
    {"quick", '\0', POPT_ARG_NONE, &o.quick, 0, "Few repetitions: whether it works, not how fast", NULL},
    {"csv", '\0', POPT_ARG_STRING, &o.csv, 0, "validate, trade: write the table also as CSV", "FILE"},
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

/* stiction bench: the measurements, one file each. */
#include "bench.h"
#include "cli.h"

#include <string.h>

static const stic_cli_usage usage = {
  "bench", "[OPTION...] speed",
  "speed  what a sample costs: solving, further surfaces and vertices, files, start-up\n",
  1, 1};

int stic_cmd_bench(int argc, const char **argv)
{
  int quick = 0;
  const struct poptOption table[] = {
    {"quick", '\0', POPT_ARG_NONE, &quick, 0, "Few repetitions: whether it works, not how fast", NULL},
    POPT_TABLEEND
  };
  stic_cli_args args;
  int code = stic_cli_parse(&usage, table, argc, argv, &args);

  if (code < 0) {
    if (strcmp(args.positions[0], "speed") == 0) {
      code = stic_bench_speed(quick != 0);
    } else {
      stic_cli_say("bench: unknown measurement '%.40s'; expected speed", args.positions[0]);
      code = STIC_USAGE;
    }
  }
  stic_cli_args_free(&args);
  return code;
}

/* What the program's commands share: arguments, messages, signals, overrides. */
#ifndef STIC_CLI_H
#define STIC_CLI_H

#include <popt.h>
#include <signal.h>

#include "../stiction.h"

#define STIC_EXIT_SIGNAL 128 /* plus the signal's number */
#define STIC_EXIT_PIPE (STIC_EXIT_SIGNAL + SIGPIPE)

/* One command: `argv[0]` is its name. Returns the exit code. */
int stic_cmd_replay(int argc, const char **argv);
int stic_cmd_run(int argc, const char **argv);
int stic_cmd_check(int argc, const char **argv);
int stic_cmd_still(int argc, const char **argv);
int stic_cmd_bench(int argc, const char **argv);
int stic_cmd_explain(int argc, const char **argv);
int stic_cmd_plot(int argc, const char **argv);
int stic_cmd_monitor(int argc, const char **argv);
int stic_cmd_convert(int argc, const char **argv);
int stic_cmd_devices(int argc, const char **argv);

/* ---- messages (standard error) ------------------------------------------------------------ */

/* Prints an error and returns its status, which is the exit code. Quiet is that the reader of standard output has left,
 * STIC_EXIT_PIPE, and an input that a signal interrupted, STIC_EXIT_SIGNAL + its number. */
int stic_cli_fail(const stic_error *err);

/* The same for what failed before anything was done: after a signal that is STIC_EXIT_SIGNAL + its number, quietly, as
 * an open that waits for the other end of a pipe fails then. */
int stic_cli_fail_to_begin(const stic_error *err);
void stic_cli_warn(const stic_error *problem);
/* "stiction: ..." in one line. */
void stic_cli_say(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Flushes standard output, as main() does after each command: STIC_OK, STIC_EXIT_PIPE, or STIC_CANNOT_WRITE after a
 * message. */
int stic_cli_flush(void);

/* ---- command line ------------------------------------------------------------------------ */

#define STIC_POSITIONS_MAX 4

/* The parsed command line of one command. */
typedef struct stic_cli_args {
  poptContext popt; /* positions live as long as it */
  const char *positions[STIC_POSITIONS_MAX];
  int position_count;
} stic_cli_args;

/* What a command says of itself. */
typedef struct stic_cli_usage {
  const char *command;   /* "replay" */
  const char *positions; /* "SCENE TRACE" */
  const char *about;     /* what it does; ends with a line end */
  int positions_min, positions_max;
} stic_cli_usage;

/* Parses all arguments into the variables that `options` points at and the positions. Returns -1 to
 * go on, or the exit code: 0 after --help, STIC_USAGE after a message. Free in either case. */
int stic_cli_parse(const stic_cli_usage *usage, const struct poptOption *options, int argc, const char **argv,
                   stic_cli_args *args);
void stic_cli_args_free(stic_cli_args *args);

/* Values of --set as overrides; splits `set` (NULL-ended, may be NULL) in place. The caller frees
 * `*overrides`. */
stic_status stic_cli_overrides(char **set, stic_override **overrides, int *count, stic_error *err);
/* Frees what POPT_ARG_ARGV gathered; NULL allowed. */
void stic_cli_free_list(char **list);

/* Refuses outputs (NULL where not asked for) that are one file, or one of the inputs. */
stic_status stic_cli_check_paths(const char *const *inputs, int input_count, const char *const *outputs,
                                 int output_count, stic_error *err);

/* Whether an input can be read only once: "-" or a pipe. */
bool stic_cli_reads_once(const char *path);

/* ---- standard streams --------------------------------------------------------------------- */

/* Has every standard stream stand for something, if closed for nothing: else the next file opened would take its
 * number, and what is meant for standard output would go there. */
void stic_cli_hold_streams(void);

/* ---- signals ----------------------------------------------------------------------------- */

/* Catches SIGINT, SIGTERM and SIGHUP, and has writes to closed pipes and beyond the limit of a file's size fail
 * instead of killing. */
void stic_cli_catch_signals(void);
/* The signal that came, 0: none. */
int stic_cli_signal(void);

#endif

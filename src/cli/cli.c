#include "cli.h"

#include "../error.h"
#include "../io/outfile.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- messages ---------------------------------------------------------------------------- */

static void print_problem(const char *kind, const stic_error *err)
{
  char text[1024];

  stic_error_format(err, text, sizeof text);
  /* With a place first, as editors expect it; else with our name. */
  fprintf(stderr, "%s%s%s\n", err->file[0] ? "" : "stiction: ", kind, text);
}

/* The errno of a write that failed long ago is lost. */
static bool reader_has_left(void)
{
  struct pollfd out = {STDOUT_FILENO, POLLOUT, 0};

  return poll(&out, 1, 0) == 1 && (out.revents & (POLLERR | POLLHUP)) != 0;
}

int stic_cli_fail(const stic_error *err)
{
  assert(err->status != STIC_OK);
  if (err->status == STIC_CANNOT_WRITE && strcmp(err->file, STIC_OUTFILE_STDOUT) == 0 && reader_has_left())
    return STIC_EXIT_PIPE;
  if (err->status == STIC_BAD_INPUT && stic_cli_signal() != 0)
    return STIC_EXIT_SIGNAL + stic_cli_signal();
  print_problem("", err);
  return (int)err->status;
}

int stic_cli_fail_to_begin(const stic_error *err)
{
  return stic_cli_signal() != 0 ? STIC_EXIT_SIGNAL + stic_cli_signal() : stic_cli_fail(err);
}

void stic_cli_warn(const stic_error *problem)
{
  print_problem("warning: ", problem);
}

void stic_cli_say(const char *format, ...)
{
  char text[2048], shown[2048];
  va_list args;

  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  fprintf(stderr, "stiction: %s\n", stic_error_quote(text, strlen(text), shown, sizeof shown));
}

int stic_cli_flush(void)
{
  const int problem = fflush(stdout) == 0 ? 0 : errno;

  if (problem == 0 && !ferror(stdout))
    return STIC_OK;
  if (reader_has_left())
    return STIC_EXIT_PIPE;
  stic_cli_say(STIC_OUTFILE_STDOUT ": cannot write%s%s", problem ? ": " : "",
               problem ? strerror(problem) : "");
  return STIC_CANNOT_WRITE;
}

/* ---- command line ------------------------------------------------------------------------ */

static int refuse(const stic_cli_usage *usage, const char *what, const char *which)
{
  stic_cli_say("%s: %s%s%s; see stiction %s --help", usage->command, what, which ? ": " : "",
               which ? which : "", usage->command);
  return STIC_USAGE;
}

static int show_help(const stic_cli_usage *usage, poptContext popt)
{
  poptPrintHelp(popt, stdout, 0);
  printf("\n%s", usage->about);
  return STIC_OK;
}

static int take_arguments(const stic_cli_usage *usage, stic_cli_args *args, const int *help)
{
  const char *position;
  int result;

  while ((result = poptGetNextOpt(args->popt)) > 0)
    ;
  if (result < -1)
    return refuse(usage, poptStrerror(result), poptBadOption(args->popt, POPT_BADOPTION_NOALIAS));
  if (*help)
    return show_help(usage, args->popt);
  while ((position = poptGetArg(args->popt)) != NULL) {
    if (args->position_count == usage->positions_max)
      return refuse(usage, "one argument too many", position);
    args->positions[args->position_count++] = position;
  }
  if (args->position_count < usage->positions_min)
    return refuse(usage, "arguments are missing, expected", usage->positions);
  return -1;
}

int stic_cli_parse(const stic_cli_usage *usage, const struct poptOption *options, int argc, const char **argv,
                   stic_cli_args *args)
{
  int help = 0, result;
  struct poptOption table[] = {{NULL, '\0', POPT_ARG_INCLUDE_TABLE, NULL, 0, NULL, NULL},
                               {"help", 'h', POPT_ARG_NONE, &help, 0, "Show this and end", NULL},
                               POPT_TABLEEND};
  const char *const own_name = argv[0];
  char name[64], positions[128];

  memset(args, 0, sizeof *args);
  table[0].arg = (void *)(uintptr_t)options; /* popt only reads the table */
  snprintf(name, sizeof name, "stiction %s", usage->command);
  argv[0] = name; /* popt shows it in its help */
  args->popt = poptGetContext(name, argc, argv, table, 0);
  if (args->popt) {
    snprintf(positions, sizeof positions, "%s", usage->positions);
    poptSetOtherOptionHelp(args->popt, positions);
    result = take_arguments(usage, args, &help);
  } else {
    stic_cli_say("out of memory");
    result = STIC_NO_MEMORY;
  }
  argv[0] = own_name;
  return result;
}

void stic_cli_args_free(stic_cli_args *args)
{
  if (args->popt)
    poptFreeContext(args->popt);
  args->popt = NULL;
}

stic_status stic_cli_overrides(char **set, stic_override **overrides, int *count, stic_error *err)
{
  int n = 0;

  *overrides = NULL;
  *count = 0;
  while (set && set[n])
    n++;
  if (n == 0)
    return STIC_OK;
  *overrides = malloc((size_t)n * sizeof **overrides);
  if (!*overrides)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  for (int i = 0; i < n; i++) {
    char *equals = strchr(set[i], '=');

    if (!equals || equals == set[i])
      return stic_error_set(err, STIC_USAGE, NULL, 0, "--set %.200s: expected KEY=VALUE", set[i]);
    *equals = '\0';
    (*overrides)[i].key = set[i];
    (*overrides)[i].value = equals + 1;
    *count = i + 1;
  }
  return STIC_OK;
}

void stic_cli_free_list(char **list)
{
  for (char **item = list; item && *item; item++)
    free(*item);
  free(list);
}

static bool is_same_file(const char *a, const char *b)
{
  struct stat of_a, of_b;

  if (strcmp(a, "-") == 0 || strcmp(b, "-") == 0)
    return strcmp(a, b) == 0;
  if (strcmp(a, b) == 0)
    return stat(a, &of_a) != 0 || S_ISREG(of_a.st_mode);
  return stat(a, &of_a) == 0 && stat(b, &of_b) == 0 && S_ISREG(of_a.st_mode) && of_a.st_dev == of_b.st_dev &&
         of_a.st_ino == of_b.st_ino;
}

stic_status stic_cli_check_paths(const char *const *inputs, int input_count, const char *const *outputs,
                                 int output_count, stic_error *err)
{
  for (int i = 0; i < output_count; i++) {
    if (!outputs[i])
      continue;
    for (int j = 0; j < i; j++) {
      if (outputs[j] && is_same_file(outputs[i], outputs[j]))
        return stic_error_set(err, STIC_USAGE, NULL, 0,
                              "two outputs go to '%.200s'; expected different files", outputs[i]);
    }
    for (int j = 0; j < input_count; j++) {
      if (inputs[j] && strcmp(outputs[i], "-") != 0 && is_same_file(outputs[i], inputs[j]))
        return stic_error_set(err, STIC_USAGE, NULL, 0,
                              "the output '%.200s' is an input; expected another file", outputs[i]);
    }
  }
  return STIC_OK;
}

bool stic_cli_reads_once(const char *path)
{
  struct stat st;

  return strcmp(path, "-") == 0 || (stat(path, &st) == 0 && S_ISFIFO(st.st_mode));
}

/* ---- standard streams --------------------------------------------------------------------- */

void stic_cli_hold_streams(void)
{
  int fd;

  do
    fd = open("/dev/null", O_RDONLY); /* a closed output is one that cannot be written */
  while (fd >= 0 && fd <= STDERR_FILENO);
  if (fd > STDERR_FILENO)
    close(fd);
}

/* ---- signals ----------------------------------------------------------------------------- */

static volatile sig_atomic_t caught_signal;

static void on_signal(int number)
{
  caught_signal = number;
}

void stic_cli_catch_signals(void)
{
  struct sigaction action, before;

  memset(&action, 0, sizeof action);
  sigemptyset(&action.sa_mask);
  action.sa_handler = on_signal; /* without SA_RESTART: a waiting read must return */
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
  sigaction(SIGHUP, NULL, &before);
  if (before.sa_handler != SIG_IGN) /* nohup */
    sigaction(SIGHUP, &action, NULL);
  action.sa_handler = SIG_IGN;
  sigaction(SIGPIPE, &action, NULL);
  sigaction(SIGXFSZ, &action, NULL);
}

int stic_cli_signal(void)
{
  return (int)caught_signal;
}

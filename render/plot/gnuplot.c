#include "gnuplot.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "../../src/error.h"

#define NOT_THERE 127 /* as a shell says it */

/* In the child: never returns. -d leaves out the user's start-up files. */
static void become_gnuplot(const char *folder, const char *script, const char *set_format, int messages)
{
  const int nothing = open("/dev/null", O_RDWR);

  if (nothing < 0 || dup2(nothing, 0) < 0 || dup2(nothing, 1) < 0 || dup2(messages, 2) < 0 ||
      chdir(folder) != 0)
    _exit(1);
  setenv("LC_ALL", "C.UTF-8", 1); /* a point in numbers */
  execlp("gnuplot", "gnuplot", "-d", "-e", set_format, script, (char *)NULL);
  _exit(errno == ENOENT || errno == EACCES ? NOT_THERE : 1);
}

/* Reads all that is said and keeps its beginning. */
static void read_words(int messages, char *words, size_t size)
{
  char rest[512];
  size_t used = 0;
  ssize_t n;

  while ((n = read(messages, rest, sizeof rest)) > 0 || (n < 0 && errno == EINTR)) {
    for (ssize_t i = 0; i < n && used + 1 < size; i++)
      words[used++] = rest[i];
  }
  words[used] = '\0';
}

static stic_status judge(int outcome, const char *words, stic_error *err)
{
  char quoted[300];

  if (WIFEXITED(outcome) && WEXITSTATUS(outcome) == 0)
    return STIC_OK;
  if (WIFEXITED(outcome) && WEXITSTATUS(outcome) == NOT_THERE)
    return stic_error_set(
      err, STIC_USAGE, NULL, 0,
      "plots need the program gnuplot, which is not there; install the package gnuplot-nox");
  if (WIFSIGNALED(outcome))
    return stic_error_set(err, STIC_CANNOT_WRITE, NULL, 0, "gnuplot was ended by signal %d",
                          WTERMSIG(outcome));
  return stic_error_set(err, STIC_CANNOT_WRITE, NULL, 0, "gnuplot failed: %s",
                        stic_error_quote(words, strlen(words), quoted, sizeof quoted));
}

stic_status stic_gnuplot_run(const char *folder, const char *script, const char *format, stic_error *err)
{
  char set_format[40], words[600] = "";
  int ends[2], outcome = 0;
  pid_t child;

  snprintf(set_format, sizeof set_format, "format='%s'", format);
  if (pipe(ends) != 0)
    return stic_error_set(err, STIC_CANNOT_WRITE, NULL, 0, "cannot run gnuplot: %s", strerror(errno));
  child = fork();
  if (child == 0)
    become_gnuplot(folder, script, set_format, ends[1]);
  close(ends[1]);
  if (child > 0) {
    read_words(ends[0], words, sizeof words);
    while (waitpid(child, &outcome, 0) < 0 && errno == EINTR)
      ;
  }
  close(ends[0]);
  if (child < 0)
    return stic_error_set(err, STIC_CANNOT_WRITE, NULL, 0, "cannot run gnuplot: %s", strerror(errno));
  return judge(outcome, words, err);
}

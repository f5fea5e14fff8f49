/* logitech-emulator: a Logitech tracker behind a pseudo terminal, to try drivers and programs with. */
#define _XOPEN_SOURCE 700 /* symlink() */
#include "logitech_emulator.h"

#include <popt.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static volatile sig_atomic_t stopped;

static void stop(int number)
{
  (void)number;
  stopped = 1;
}

typedef struct arguments {
  char *link;
  double seconds, stall_at, stall;
  int out, never, fringe, silent, split, no_information, glitch, record_size, diagnostics;
  int drop, insert, insert_byte, flip, flip_bits;
} arguments;

static int64_t at(int argument)
{
  return argument >= 0 ? argument : EMULATOR_NEVER;
}

static void take_faults(const arguments *a, emulator_faults *f)
{
  f->out = a->out;
  f->never = a->never;
  f->fringe = a->fringe;
  f->silent = a->silent;
  f->split = a->split;
  f->no_information = a->no_information;
  f->glitch = a->glitch;
  f->record_size = a->record_size;
  f->diagnostics[0] = (uint8_t)(a->diagnostics >> 8);
  f->diagnostics[1] = (uint8_t)a->diagnostics;
  f->drop_at = at(a->drop);
  f->insert_at = at(a->insert);
  f->insert = (uint8_t)a->insert_byte;
  f->flip_at = at(a->flip);
  f->flip = (uint8_t)a->flip_bits;
  f->stall_at = a->stall > 0 ? (int64_t)(a->stall_at * 50) : EMULATOR_NEVER;
  f->stall_ns = (int64_t)(a->stall * 1e9);
}

static int serve(const arguments *a)
{
  emulator unit;
  logitech_pty pty;
  bool good = true;

  emulator_init(&unit);
  take_faults(a, &unit.faults);
  if (!logitech_pty_open(&pty, &unit)) {
    perror("logitech-emulator: no pseudo terminal");
    return 1;
  }
  if (a->link && (unlink(a->link), symlink(pty.path, a->link) != 0)) {
    perror("logitech-emulator: cannot make the link");
    logitech_pty_close(&pty);
    return 1;
  }
  printf("%s\n", a->link ? a->link : pty.path);
  fflush(stdout);
  for (double t = 0; good && !stopped && (a->seconds <= 0 || t < a->seconds); t += 0.1)
    good = logitech_pty_serve(&pty, 100000000);
  logitech_pty_close(&pty);
  if (a->link)
    unlink(a->link);
  fprintf(stderr, "logitech-emulator: %lld records, %lld resets, %lld commands refused%s\n",
          (long long)unit.records, (long long)unit.resets, (long long)unit.refused,
          unit.wrong_format ? ", wrong speed or format" : "");
  return good ? 0 : 1;
}

int main(int argc, char **argv)
{
  arguments a = {NULL, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, EMULATOR_RECORD, 0xbf3f, -1, -1, 0, -1, 0x80};
  const struct poptOption table[] = {
    {"link", 'l', POPT_ARG_STRING, &a.link, 0, "Make this symbolic link to the port", "PATH"},
    {"seconds", 't', POPT_ARG_DOUBLE, &a.seconds, 0, "Unplug after so long (default: at a signal)", "S"},
    {"out", 0, POPT_ARG_NONE, &a.out, 0, "Out of range", NULL},
    {"never", 0, POPT_ARG_NONE, &a.never, 0, "Out of range from the start: records are all zero", NULL},
    {"fringe", 0, POPT_ARG_NONE, &a.fringe, 0, "At the edge of the range", NULL},
    {"silent", 0, POPT_ARG_NONE, &a.silent, 0, "In 2D mode: answers nothing", NULL},
    {"split", 0, POPT_ARG_NONE, &a.split, 0, "A write per byte", NULL},
    {"no-information", 0, POPT_ARG_NONE, &a.no_information, 0, "Do not answer *m", NULL},
    {"record-size", 0, POPT_ARG_INT, &a.record_size, 0, "That *m tells, default 16", "N"},
    {"diagnostics", 0, POPT_ARG_INT, &a.diagnostics, 0, "The two bytes of the reply, default 0xbf3f", "N"},
    {"glitch", 0, POPT_ARG_INT, &a.glitch, 0, "Records with the right button for the left at a press", "N"},
    {"drop", 0, POPT_ARG_INT, &a.drop, 0, "Lose this byte of the stream", "AT"},
    {"insert", 0, POPT_ARG_INT, &a.insert, 0, "Put a byte in before this one", "AT"},
    {"insert-byte", 0, POPT_ARG_INT, &a.insert_byte, 0, "... namely, default 0", "BYTE"},
    {"flip", 0, POPT_ARG_INT, &a.flip, 0, "Invert bits of this byte of the stream", "AT"},
    {"flip-bits", 0, POPT_ARG_INT, &a.flip_bits, 0, "... namely, default 0x80", "BITS"},
    {"stall-at", 0, POPT_ARG_DOUBLE, &a.stall_at, 0, "Pause after so long of the stream", "S"},
    {"stall", 0, POPT_ARG_DOUBLE, &a.stall, 0, "... for so long", "S"},
    POPT_AUTOHELP POPT_TABLEEND};
  poptContext context = poptGetContext("logitech-emulator", argc, (const char **)(uintptr_t)argv, table, 0);
  const int result = poptGetNextOpt(context);
  struct sigaction action;
  int code = 2;

  memset(&action, 0, sizeof action);
  action.sa_handler = stop;
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
  if (result < -1)
    fprintf(stderr, "logitech-emulator: %s: %s\n", poptBadOption(context, 0), poptStrerror(result));
  else if (poptPeekArg(context))
    fprintf(stderr, "logitech-emulator: expected options only\n");
  else
    code = serve(&a);
  poptFreeContext(context);
  free(a.link);
  return code;
}

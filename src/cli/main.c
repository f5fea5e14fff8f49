/* The program `stiction`: finds the command and hands over. */
#include "cli.h"
#include "video.h"
#include "window/window.h"

#include <stdio.h>
#include <string.h>

typedef struct command {
  const char *name;
  int (*run)(int argc, const char **argv);
  const char *about;
} command;

static const command commands[] = {
  {"replay", stic_cmd_replay, "solve a trace, as fast as it can: log, events, timing, pictures, a page"},
  {"run", stic_cmd_run, "solve a device's samples in real time"},
  {"devices", stic_cmd_devices, "what is connected, what to type for it, and what stops it from opening"},
  {"monitor", stic_cmd_monitor, "a tracker's pose, buttons, rate and state, live in the terminal"},
  {"convert", stic_cmd_convert, "raw recordings of devices and pose files (TUM, EuRoC) into traces"},
  {"check", stic_cmd_check, "tell all errors and warnings of a scene and a trace"},
  {"explain", stic_cmd_explain, "say which parts of the model a scene can need, and why"},
  {"still", stic_cmd_still, "one moment of a trace as a picture, or a contact sheet of the telling ones"},
  {"plot", stic_cmd_plot, "figures 9 to 12 of the paper from a log"},
  {"bench", stic_cmd_bench, "measure: speed, pictures, friction against closed forms, accuracy against cost"},
};

#define COMMAND_COUNT (sizeof commands / sizeof commands[0])

static int show_help(void)
{
  printf("Usage: stiction COMMAND ...\n\n"
         "Where an object held in the hand rests when it is pressed against surfaces with friction.\n\n"
         "Commands:\n");
  for (size_t i = 0; i < COMMAND_COUNT; i++)
    printf("  %-8s %s\n", commands[i].name, commands[i].about);
  printf("\nstiction COMMAND --help says more; stiction --version says which one this is.\n\n"
         "Exit codes:\n"
         "  0  done\n"
         "  1  a check or bench failed\n"
         "  2  wrong usage, or an option that this build lacks\n"
         "  3  bad input file: FILE:LINE: what was found and what was expected\n"
         "  4  no device, or it was lost for good\n"
         "  5  could not write, or there is no usable renderer\n"
         "  6  out of memory, threads or file descriptors\n"
         "  128 + n  ended by signal n\n");
  return STIC_OK;
}

static int show_version(void)
{
  char libav[64];

  stic_video_licence(libav, sizeof libav);
  printf("stiction %s\n", stic_version());
  if (strncmp(libav, "GPL", 3) == 0)
    printf("MIT licence; together with the libav that it was built with (x264): %s\n", libav);
  else
    printf("MIT licence\n");
  printf("video: %s%s\n", *libav ? "libav, " : "none", libav);
  printf("window: %s\n", stic_window_available() ? "SDL" : "none");
  return STIC_OK;
}

/* What was found or done counts only once it is written. */
static int ended(int code)
{
  int flushed;

  if (code != STIC_OK && code != STIC_FAILED)
    return code;
  flushed = stic_cli_flush();
  return flushed == STIC_OK ? code : flushed;
}

int main(int argc, char **argv)
{
  const char *name = argc > 1 ? argv[1] : "";

  stic_cli_hold_streams();
  stic_cli_catch_signals();
  if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0 || strcmp(name, "help") == 0)
    return ended(show_help());
  if (strcmp(name, "--version") == 0)
    return ended(show_version());
  for (size_t i = 0; i < COMMAND_COUNT; i++) {
    if (strcmp(name, commands[i].name) == 0)
      return ended(commands[i].run(argc - 1, (const char **)(argv + 1)));
  }
  if (*name)
    stic_cli_say("unknown command '%.40s'; see stiction --help", name);
  else
    stic_cli_say("which command? See stiction --help");
  return STIC_USAGE;
}

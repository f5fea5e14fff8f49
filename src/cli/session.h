/* One solving session: scene, simulation and what is written of it. Shared by replay and run. */
#ifndef STIC_SESSION_H
#define STIC_SESSION_H

#include "../io/outfile.h"
#include "../io/provenance.h"
#include "../io/timing.h"
#include "../stiction.h"
#include "cli.h"

/* Command-line values; all NULL by default. Strings are popt's copies, freed by the function below. */
typedef struct stic_session_options {
  char *accuracy, *precision;
  char *log, *events, *timing; /* paths of outputs */
  char **set;
  int64_t budget_ns; /* for accuracy auto; 0 (default): this command does not have it */
} stic_session_options;

void stic_session_options_free(stic_session_options *options);

/* Rows of a popt table for the options above; `levels` says what --accuracy takes. */
#define STIC_SESSION_OPTIONS(o, levels)                                                                      \
  {"log", '\0', POPT_ARG_STRING, &(o)->log, 0, "Write a row per sample as CSV ('-': standard output)",       \
   "FILE"},                                                                                                  \
    {"events", '\0', POPT_ARG_STRING, &(o)->events, 0, "Write touches, slips, snaps, grips as CSV", "FILE"}, \
    {"timing", '\0', POPT_ARG_STRING, &(o)->timing, 0, "Write where the time went as JSON", "FILE"},         \
    STIC_SOLVER_OPTIONS(o, levels)

/* The part of them that any command which solves has. */
#define STIC_SOLVER_OPTIONS(o, levels)                                                                        \
  {"accuracy",     '\0', POPT_ARG_STRING,                                                                     \
   &(o)->accuracy, 0,    "How the hand's path between samples is followed: " levels,                          \
   "LEVEL"},                                                                                                  \
    {"precision", '\0', POPT_ARG_STRING, &(o)->precision, 0, "Arithmetic: f32, f64 (default) or f80", "P"},   \
  {                                                                                                           \
    "set", '\0', POPT_ARG_ARGV, &(o)->set, 0,                                                                 \
      "Override a value of the scene, e.g. friction.static=0.6 or surfaces.floor.point=[0, 0.1]; repeatable", \
      "KEY=VALUE"                                                                                             \
  }

typedef struct stic_session {
  const stic_session_options *options; /* as given */
  const char *scene_path;
  stic_scene scene;
  char *scene_text; /* of its file, which may be a pipe and gone */
  stic_settings settings;
  char accuracy_text[96]; /* "event (auto, budget 3225806 ns)" */
  stic_override *overrides;
  int override_count;
  stic_sim *sim;
  stic_outfile *log, *events; /* NULL: not asked for */
  stic_timing *timing;        /* NULL: not asked for */
  const char *timing_path;
  int64_t started_ns;
  double seconds;     /* for the timing; 0 (default): from the start to the commit */
  stic_result result; /* of the last step */
  int64_t rows;
} stic_session;

/* Reads options and scene and settles the accuracy, which takes up to 2 s for "auto". Both strings and options must
 * outlive the session. On failure nothing stays open. */
stic_status stic_session_load(stic_session *session, const stic_session_options *options,
                              const char *scene_path, stic_error *err);
/* Where its outputs come from, for the head of a log or recording; as long as the session and the strings last. */
stic_provenance stic_session_provenance(const stic_session *session, const char *input_kind,
                                        const char *input);
/* Then makes the simulation and opens the outputs. `input_kind` and `input` are the log's provenance ("trace",
 * path). On failure nothing stays open. */
stic_status stic_session_begin(stic_session *session, const char *input_kind, const char *input,
                               stic_error *err);
/* Both at once. */
stic_status stic_session_open(stic_session *session, const stic_session_options *options,
                              const char *scene_path, const char *input_kind, const char *input,
                              stic_error *err);

/* Makes `timing` count although no file was asked for. */
stic_status stic_session_time(stic_session *session, stic_error *err);

/* Solves one sample and writes its row. `read_ns`: what getting the sample took. Returns how long all
 * took, 0 without timing. Failed writes show in stic_session_write_failed(). */
int64_t stic_session_step(stic_session *session, const stic_sample *sample, int64_t read_ns);

/* The second half of it: writes what a step gave, be it in another thread. */
void stic_session_write(stic_session *session, const stic_result *result, const stic_event *events,
                        int event_count);

/* Hands on what is buffered, for those who follow a run. */
void stic_session_flush(stic_session *session);

/* Whether an output could not be written: no use in going on, stic_session_commit() will say why. */
bool stic_session_write_failed(const stic_session *session);

/* Moves all outputs into place; the first failure is returned and what follows is dropped. */
stic_status stic_session_commit(stic_session *session, const char *scheduling, stic_error *err);

/* Ends; outputs not committed leave nothing. */
void stic_session_close(stic_session *session);

#endif

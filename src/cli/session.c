#include "session.h"

#include "auto_level.h"

#include "../error.h"
#include "../io/events_csv.h"
#include "../io/log_csv.h"
#include "../scene_yaml.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void stic_session_options_free(stic_session_options *options)
{
  free(options->accuracy);
  free(options->precision);
  free(options->log);
  free(options->events);
  free(options->timing);
  stic_cli_free_list(options->set);
  memset(options, 0, sizeof *options);
}

static bool is_auto(const stic_session_options *o)
{
  return o->accuracy && strcmp(o->accuracy, "auto") == 0;
}

static stic_status read_settings(stic_session *s, const stic_session_options *o, stic_error *err)
{
  stic_status status = STIC_OK;

  stic_settings_init(&s->settings);
  if (is_auto(o) && o->precision)
    return stic_error_set(err, STIC_USAGE, NULL, 0,
                          "accuracy auto chooses the precision as well; --precision does not go with it");
  if (is_auto(o) && o->budget_ns == 0)
    return stic_error_set(err, STIC_USAGE, NULL, 0,
                          "accuracy 'auto' is for run only; expected frame, substep=N or event");
  if (o->accuracy && !is_auto(o))
    status = stic_settings_set_accuracy(&s->settings, o->accuracy, err);
  if (status == STIC_OK && o->precision)
    status = stic_settings_set_precision(&s->settings, o->precision, err);
  if (status == STIC_OK)
    status = stic_cli_overrides(o->set, &s->overrides, &s->override_count, err);
  return status;
}

/* Decides what "auto" means here, once, and says so. */
static stic_status settle_accuracy(stic_session *s, const stic_session_options *o, stic_error *err)
{
  stic_auto_choice choice;
  char text[1024];
  size_t n;

  if (is_auto(o)) {
    const stic_status status = stic_auto_level(&s->scene, o->budget_ns, &s->settings, &choice, err);

    if (status != STIC_OK)
      return status;
    stic_auto_text(&choice, o->budget_ns, text, sizeof text);
    stic_cli_say("%s%s", choice.fits ? "" : "warning: ", text);
  }
  stic_settings_accuracy_text(&s->settings, s->accuracy_text, sizeof s->accuracy_text);
  n = strlen(s->accuracy_text);
  if (is_auto(o))
    snprintf(s->accuracy_text + n, sizeof s->accuracy_text - n, " (auto, budget %lld ns)",
             (long long)o->budget_ns);
  return STIC_OK;
}

/* Refuses what cannot be written before the first sample is solved, not after an hour. */
static stic_status open_outputs(stic_session *s, const stic_session_options *o, stic_error *err)
{
  stic_status status = STIC_OK;

  if (o->log)
    status = stic_outfile_open(o->log, &s->log, err);
  if (status == STIC_OK && o->events)
    status = stic_outfile_open(o->events, &s->events, err);
  if (status == STIC_OK && o->timing) {
    stic_outfile *probe = NULL;

    status = stic_outfile_open(o->timing, &probe, err);
    stic_outfile_abort(probe);
    if (status == STIC_OK)
      status = stic_session_time(s, err);
    s->timing_path = o->timing;
  }
  return status;
}

stic_status stic_session_load(stic_session *s, const stic_session_options *o, const char *scene_path,
                              stic_error *err)
{
  stic_status status;

  memset(s, 0, sizeof *s);
  s->options = o;
  s->scene_path = scene_path;
  status = read_settings(s, o, err);
  if (status == STIC_OK)
    status =
      stic_scene_read_text(scene_path, s->overrides, s->override_count, &s->scene, &s->scene_text, err);
  if (status == STIC_OK)
    status = settle_accuracy(s, o, err);
  if (status != STIC_OK)
    stic_session_close(s);
  return status;
}

stic_provenance stic_session_provenance(const stic_session *s, const char *input_kind, const char *input)
{
  return (stic_provenance){s->scene_path, input_kind,       input, s->accuracy_text, &s->settings,
                           s->overrides,  s->override_count};
}

stic_status stic_session_begin(stic_session *s, const char *input_kind, const char *input, stic_error *err)
{
  stic_status status;

  s->started_ns = stic_clock_ns();
  status = stic_sim_create(&s->scene, &s->settings, &s->sim, err);
  if (status == STIC_OK)
    status = open_outputs(s, s->options, err);
  if (status != STIC_OK) {
    stic_session_close(s);
    return status;
  }
  if (s->log) {
    const stic_provenance provenance = stic_session_provenance(s, input_kind, input);

    stic_log_begin(s->log, &provenance);
  }
  if (s->events)
    stic_events_begin(s->events);
  return STIC_OK;
}

stic_status stic_session_open(stic_session *s, const stic_session_options *o, const char *scene_path,
                              const char *input_kind, const char *input, stic_error *err)
{
  const stic_status status = stic_session_load(s, o, scene_path, err);

  return status == STIC_OK ? stic_session_begin(s, input_kind, input, err) : status;
}

stic_status stic_session_time(stic_session *s, stic_error *err)
{
  if (!s->timing)
    s->timing = stic_timing_create();
  if (!s->timing)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  stic_sim_time_stages(s->sim, true);
  return STIC_OK;
}

void stic_session_write(stic_session *s, const stic_result *result, const stic_event *events, int event_count)
{
  if (s->log)
    stic_log_row(s->log, result);
  if (s->events)
    stic_events_rows(s->events, events, event_count);
}

static void write_last(stic_session *s)
{
  int count = 0;
  const stic_event *events = s->events ? stic_sim_events(s->sim, &count) : NULL;

  stic_session_write(s, &s->result, events, count);
}

int64_t stic_session_step(stic_session *s, const stic_sample *sample, int64_t read_ns)
{
  int64_t start, total, write, frame;

  s->rows++;
  stic_sim_step(s->sim, sample, &s->result);
  if (!s->timing) {
    write_last(s);
    return 0;
  }
  total = stic_timing_add_step(s->timing, s->sim);
  start = stic_clock_ns();
  write_last(s);
  write = stic_clock_ns() - start;
  frame = read_ns + total + write;
  stic_timing_add(s->timing, STIC_STAGE_READ, read_ns);
  stic_timing_add(s->timing, STIC_STAGE_WRITE, write);
  stic_timing_add(s->timing, STIC_STAGE_FRAME, frame);
  return frame;
}

bool stic_session_write_failed(const stic_session *s)
{
  return (s->log && stic_outfile_error(s->log) != 0) || (s->events && stic_outfile_error(s->events) != 0);
}

void stic_session_flush(stic_session *s)
{
  if (s->log)
    stic_outfile_flush(s->log);
  if (s->events)
    stic_outfile_flush(s->events);
}

static stic_status commit(stic_outfile **out, stic_error *err)
{
  stic_outfile *o = *out;

  *out = NULL;
  return stic_outfile_commit(o, err);
}

stic_status stic_session_commit(stic_session *s, const char *scheduling, stic_error *err)
{
  const double seconds = s->seconds > 0 ? s->seconds : (double)(stic_clock_ns() - s->started_ns) / 1e9;
  stic_status status = STIC_OK;

  /* All data first, so that a full disk is found before anything is in place. */
  if (s->log)
    stic_outfile_flush(s->log);
  if (s->events && stic_outfile_flush(s->events) != 0)
    status = commit(&s->events, err);
  if (status == STIC_OK)
    status = commit(&s->log, err);
  if (status == STIC_OK)
    status = commit(&s->events, err);
  if (status == STIC_OK && s->timing_path)
    status = stic_timing_write(s->timing, seconds, scheduling, s->timing_path, err);
  return status;
}

void stic_session_close(stic_session *s)
{
  stic_outfile_abort(s->log);
  stic_outfile_abort(s->events);
  stic_sim_destroy(s->sim);
  free(s->scene_text);
  free(s->timing);
  free(s->overrides);
  memset(s, 0, sizeof *s);
}

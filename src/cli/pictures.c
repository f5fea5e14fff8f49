#include "pictures.h"

#include "../error.h"
#include "../io/trace_csv.h"
#include "../number.h"

#include <stdlib.h>
#include <string.h>

void stic_picture_options_free(stic_picture_options *o)
{
  free(o->size);
  free(o->camera);
  free(o->theme);
  free(o->quality);
  free(o->plot);
  memset(o, 0, sizeof *o);
}

static bool parse_size(const char *text, int *width, int *height)
{
  const char *x = strchr(text, 'x');
  int64_t w, h;

  if (!x || stic_number_parse_integer(text, (size_t)(x - text), 1, INT32_MAX, &w) != STIC_NUMBER_OK ||
      stic_number_parse_integer(x + 1, strlen(x + 1), 1, INT32_MAX, &h) != STIC_NUMBER_OK)
    return false;
  *width = (int)w;
  *height = (int)h;
  return true;
}

static stic_status unknown(const char *option, const char *value, const char *expected, stic_error *err)
{
  return stic_error_set(err, STIC_USAGE, NULL, 0, "--%s %.40s: expected %s", option, value, expected);
}

stic_status stic_pictures_apply(const stic_picture_options *o, stic_render_settings *s, stic_error *err)
{
  if (o->size && !parse_size(o->size, &s->width, &s->height))
    return unknown("size", o->size, "WIDTHxHEIGHT in pixels, e.g. 1280x720", err);
  if (o->camera && !stic_camera_from_name(o->camera, &s->camera))
    return unknown("camera", o->camera, "three-quarter, front or follow", err);
  if (o->theme && !stic_look_from_name(o->theme, &s->look))
    return unknown("theme", o->theme, "light or dark", err);
  if (o->quality && !stic_quality_from_name(o->quality, &s->quality))
    return unknown("quality", o->quality, "fast, good or best", err);
  if (o->plot && !stic_plot_from_name(o->plot, &s->plot))
    return unknown("plot-of", o->plot, "auto, x, y or angle", err);
  return stic_render_settings_validate(s, err);
}

stic_status stic_pictures_measure(const stic_scene *scene, const stic_settings *settings, const char *trace,
                                  bool lenient, stic_extent *extent, bool *measured, double *seconds,
                                  stic_error *err)
{
  const stic_trace_options options = {.lenient = lenient};
  stic_trace_reader *reader = NULL;
  stic_sim *sim = NULL;
  stic_sample sample;
  stic_result result;
  stic_status status;
  int64_t first_ns = 0;
  bool any = false;

  *seconds = 0;
  stic_extent_init(extent);
  *measured = !stic_cli_reads_once(trace);
  if (!*measured)
    return STIC_OK;
  status = stic_sim_create(scene, settings, &sim, err);
  if (status == STIC_OK)
    status = stic_trace_open(trace, &options, &reader, err);
  while (status == STIC_OK && stic_cli_signal() == 0) {
    const stic_trace_status next = stic_trace_next(reader, &sample, NULL);

    if (next == STIC_TRACE_WAIT)
      continue;
    if (next != STIC_TRACE_SAMPLE)
      break;
    first_ns = any ? first_ns : sample.t_ns;
    any = true;
    *seconds = (double)(sample.t_ns - first_ns) * 1e-9;
    stic_sim_step(sim, &sample, &result);
    stic_extent_add(extent, scene, &result);
  }
  stic_trace_close(reader);
  stic_sim_destroy(sim);
  return status;
}

/* Accuracy and precision, from and to the words that users write (stiction.h). */
#include "error.h"
#include "number.h"

#include <assert.h>
#include <float.h>
#include <stdio.h>
#include <string.h>

#define SUBSTEPS_MAX 1000000

void stic_settings_init(stic_settings *settings)
{
  assert(settings);
  memset(settings, 0, sizeof *settings);
  settings->level = STIC_LEVEL_EVENT;
  settings->substeps = 8;
  settings->precision = STIC_F64;
  settings->h_min = 1e-4;
}

stic_status stic_settings_set_accuracy(stic_settings *settings, const char *text, stic_error *err)
{
  static const char substep[] = "substep=";
  char quoted[48];

  assert(settings && text);
  if (strcmp(text, "frame") == 0) {
    settings->level = STIC_LEVEL_FRAME;
    return STIC_OK;
  }
  if (strcmp(text, "event") == 0) {
    settings->level = STIC_LEVEL_EVENT;
    return STIC_OK;
  }
  if (strncmp(text, substep, sizeof substep - 1) == 0) {
    const char *count = text + sizeof substep - 1;
    int64_t n;

    if (stic_number_parse_integer(count, strlen(count), 1, SUBSTEPS_MAX, &n) != STIC_NUMBER_OK)
      return stic_error_set(err, STIC_USAGE, NULL, 0,
                            "accuracy '%s': expected substep=N with a whole N from 1 to %d",
                            stic_error_quote(text, strlen(text), quoted, sizeof quoted), SUBSTEPS_MAX);
    settings->level = STIC_LEVEL_SUBSTEP;
    settings->substeps = (int)n;
    return STIC_OK;
  }
  return stic_error_set(err, STIC_USAGE, NULL, 0,
                        "accuracy '%s' is unknown; expected frame, substep=N or event",
                        stic_error_quote(text, strlen(text), quoted, sizeof quoted));
}

/* 80-bit numbers are what `long double` is on x86; elsewhere it is something else. */
static bool precision_built(stic_precision precision)
{
  return precision != STIC_F80 || LDBL_MANT_DIG == 64;
}

stic_status stic_settings_set_precision(stic_settings *settings, const char *text, stic_error *err)
{
  char quoted[48];

  assert(settings && text);
  for (stic_precision p = STIC_F32; p <= STIC_F80; p++) {
    if (strcmp(text, stic_precision_name(p)) != 0)
      continue;
    if (!precision_built(p))
      return stic_error_set(err, STIC_USAGE, NULL, 0,
                            "precision %s is not in this build; expected f32 or f64", text);
    settings->precision = p;
    return STIC_OK;
  }
  return stic_error_set(err, STIC_USAGE, NULL, 0, "precision '%s' is unknown; expected f32, f64 or f80",
                        stic_error_quote(text, strlen(text), quoted, sizeof quoted));
}

void stic_settings_accuracy_text(const stic_settings *settings, char *out, size_t out_size)
{
  assert(settings && out && out_size > 0);
  switch (settings->level) {
  case STIC_LEVEL_FRAME: snprintf(out, out_size, "frame"); break;
  case STIC_LEVEL_SUBSTEP: snprintf(out, out_size, "substep=%d", settings->substeps); break;
  case STIC_LEVEL_EVENT: snprintf(out, out_size, "event"); break;
  }
}

#include "provenance.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "../error.h"

typedef struct lines {
  void (*line)(void *context, const char *text);
  void *context;
} lines;

/* File names and overrides are foreign text: one line, whatever they hold. */
static void give(const lines *to, const char *key, const char *value)
{
  char text[STIC_PROVENANCE_LINE_MAX], quoted[1024];

  snprintf(text, sizeof text, "# %s: %s\n", key,
           stic_error_quote(value, strlen(value), quoted, sizeof quoted));
  to->line(to->context, text);
}

void stic_provenance_lines(const stic_provenance *p, void (*line)(void *context, const char *text),
                           void *context)
{
  const lines to = {line, context};
  char accuracy[32], set[512];

  assert(p->scene && p->input_kind && p->input && p->settings);
  stic_settings_accuracy_text(p->settings, accuracy, sizeof accuracy);
  give(&to, "scene", p->scene);
  give(&to, p->input_kind, p->input);
  give(&to, "version", stic_version());
  give(&to, "accuracy", p->accuracy ? p->accuracy : accuracy);
  give(&to, "precision", stic_precision_name(p->settings->precision));
  for (int i = 0; i < p->override_count; i++) {
    snprintf(set, sizeof set, "%s=%s", p->overrides[i].key, p->overrides[i].value);
    give(&to, "set", set);
  }
}

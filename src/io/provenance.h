/* Where the numbers of an output come from: "# key: value" lines under its format line. Internal. */
#ifndef STIC_PROVENANCE_H
#define STIC_PROVENANCE_H

#include "../stiction.h"

typedef struct stic_provenance {
  const char *scene;      /* path of the scene file */
  const char *input_kind; /* "trace" or "device" */
  const char *input;      /* its path or description */
  const char *accuracy;   /* NULL: as in settings */
  const stic_settings *settings;
  const stic_override *overrides; /* may be NULL if override_count is 0 */
  int override_count;
} stic_provenance;

#define STIC_PROVENANCE_LINE_MAX 1100

/* Gives out the lines in order, each with its "# " and line end; foreign text is kept to one line. Real-time: no. */
void stic_provenance_lines(const stic_provenance *provenance, void (*line)(void *context, const char *text),
                           void *context);

#endif

/* `run --accuracy auto`: the most accurate level and precision that a scene allows within a budget. */
#ifndef STIC_AUTO_LEVEL_H
#define STIC_AUTO_LEVEL_H

#include "../io/timing.h"
#include "../stiction.h"

#define STIC_AUTO_BUDGET_NS (STIC_FRAME_NS / 10) /* default */
#define STIC_AUTO_TRIED_MAX 16

typedef struct stic_auto_try {
  stic_settings settings;
  int64_t p999_ns; /* of a sample's solving, each the best of three runs */
  bool whole;      /* false: too slow for all samples, p999_ns is of the first ones */
} stic_auto_try;

typedef struct stic_auto_choice {
  stic_auto_try tried[STIC_AUTO_TRIED_MAX]; /* from the most accurate on, up to the first that fits */
  int count;
  int chosen;      /* index of it; the cheapest if none fits */
  bool fits;       /* p99.9 of the chosen one is within the budget */
  int64_t took_ns; /* to find out: under 2 s */
} stic_auto_choice;

/* Leads a hand along the scene's surfaces and measures one setting after the other, h_min that of `settings`, whose
 * level, substeps and precision become the chosen ones. Errors: STIC_NO_MEMORY. Real-time: no. */
stic_status stic_auto_level(const stic_scene *scene, int64_t budget_ns, stic_settings *settings,
                            stic_auto_choice *choice, stic_error *err);

/* One line: "accuracy auto: event f64, p99.9 12.3 us of 3226 us (event f80: 41 us) ..." */
void stic_auto_text(const stic_auto_choice *choice, int64_t budget_ns, char *out, size_t out_size);

#endif

/* The measurements behind `stiction bench`. Each prints a table and returns the exit code. */
#ifndef STIC_BENCH_H
#define STIC_BENCH_H

#include "../../stiction.h"

#include <stdbool.h>
#include <stdint.h>

/* `quick`: few repetitions, for tests. */
int stic_bench_speed(bool quick);
int stic_bench_render(bool quick);

/* The friction benchmark. `csv` NULL: none. `spoil`: the solver gets this times the friction that the formulas
 * have; anything but 1 must fail. */
int stic_bench_validate(bool quick, const char *csv, double spoil);

typedef struct stic_bench_devices_options {
  bool quick;
  double seconds;  /* of the latency's measurement, at the device's own rate; 0.1 or more */
  const char *csv; /* NULL: none */
} stic_bench_devices_options;

/* What decoding costs, how long a sample takes to its result, and whether any is lost on its way to the recorder:
 * STIC_FAILED if so. */
int stic_bench_devices(const stic_bench_devices_options *options);

/* How far the same closed forms are met at a precision, nothing printed. */
typedef struct stic_closed_form_result {
  int rows, passed;
  double worst; /* largest error of the exact ones, relative, absolute where 0 is expected */
} stic_closed_form_result;

stic_status stic_closed_forms(stic_precision precision, stic_closed_form_result *result, stic_error *err);

typedef struct stic_trade_options {
  bool quick;
  const char *scene, *trace; /* both NULL: those of traces/, or one built in */
  const char *csv;           /* NULL: none */
  const char *plot;          /* NULL: none; else PLOT.png and PLOT.svg */
  char **set;                /* overrides of the scene */
} stic_trade_options;

/* What accuracy costs and what it buys. */
int stic_bench_trade(const stic_trade_options *options);

typedef struct stic_extremes_options {
  bool quick, long_form;     /* long_form: ten million frames of standing still */
  int64_t random;            /* random frames in all precisions together, 0: none and all sweeps instead */
  uint64_t seed;             /* of the random cases */
  int64_t number;            /* only this case of the sweep or seed; -1: all */
  const char *sweep;         /* only this one; NULL: all */
  const char *dump;          /* folder for the case's scene and trace; NULL: none */
  const char *csv, *picture; /* NULL: none */
  const char *scene, *trace; /* both NULL; else only these are held against the invariants */
} stic_extremes_options;

/* The model's invariants at the ends of every range. */
int stic_bench_extremes(const stic_extremes_options *options);

#endif

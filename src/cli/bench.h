/* The measurements behind `stiction bench`. Each prints a table and returns the exit code. */
#ifndef STIC_BENCH_H
#define STIC_BENCH_H

#include <stdbool.h>

/* `quick`: few repetitions, for tests. */
int stic_bench_speed(bool quick);

#endif

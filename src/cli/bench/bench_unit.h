/* A Logitech tracker behind a pseudo terminal, as far as a measurement needs one: it answers the driver's start and
 * then sends numbered records at a rate, from a thread of its own. It says when each one was sent. */
#ifndef STIC_BENCH_UNIT_H
#define STIC_BENCH_UNIT_H

#include "../../stiction.h"

typedef struct stic_bench_unit stic_bench_unit;

/* Makes the terminal and starts the thread; `count` records at `rate` Hz once the driver asks for them. Record i has
 * i counts in z, so that it can be known again. A terminal that is full is waited for. Errors: STIC_FAILED,
 * STIC_NO_MEMORY. The caller owns `*unit`. */
stic_status stic_bench_unit_start(double rate, int64_t count, stic_bench_unit **unit, stic_error *err);

/* The port to open; lives as long as the unit. */
const char *stic_bench_unit_port(const stic_bench_unit *unit);

/* Which record a sample came from, by its z in m. */
int64_t stic_bench_unit_index(double z);

/* When record `index` was handed to the terminal, all bytes at once, CLOCK_MONOTONIC; 0: not yet. Any thread. */
int64_t stic_bench_unit_sent(const stic_bench_unit *unit, int64_t index);

void stic_bench_unit_stop(stic_bench_unit *unit); /* NULL allowed */

#endif

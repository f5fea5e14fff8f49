/* Columns of numbers that grow while a run goes on, as little-endian bytes. */
#ifndef STIC_COLUMN_H
#define STIC_COLUMN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* All zero is an empty column. */
typedef struct stic_column {
  unsigned char *bytes;
  size_t size, room;
  bool failed; /* out of memory; what is added then is dropped */
} stic_column;

void stic_column_f64(stic_column *column, double value);
void stic_column_f32(stic_column *column, double value);
/* 1, 2 or 4 bytes of a whole number; negative ones as two's complement. */
void stic_column_integer(stic_column *column, int64_t value, int bytes);
void stic_column_free(stic_column *column);

#endif

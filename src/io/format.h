/* Numbers as text in our files. Each writes at `out` without a final 0 and returns the length. */
#ifndef STIC_FORMAT_H
#define STIC_FORMAT_H

#include <stddef.h>
#include <stdint.h>

/* 17 significant digits: reads back to the same double, also -0. At most 25 bytes (26 for out).
 * The program keeps the "C" locale, so the decimal sign is a point. */
size_t stic_format_double(double value, char *out);

/* At most 20 bytes. */
size_t stic_format_integer(int64_t value, char *out);

/* Seconds with nine decimals, exact. At most 22 bytes. */
size_t stic_format_seconds(int64_t t_ns, char *out);

#endif

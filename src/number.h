/* Numbers in text files: plain decimals only, the same in every locale. Internal. */
#ifndef STIC_NUMBER_H
#define STIC_NUMBER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum stic_number_status {
  STIC_NUMBER_OK,
  STIC_NUMBER_NOT_PLAIN, /* not [sign] digits [. digits] [e [sign] digits], or a needless leading 0 */
  STIC_NUMBER_TOO_LARGE  /* not finite as a double, or outside the integer's range */
} stic_number_status;

/* Each parses exactly text[0..length), which need not be terminated; `*value` is set on success only.
 * Allocates nothing. Real-time: no. */

/* The double nearest to the decimal. What underflows becomes 0 or subnormal. */
stic_number_status stic_number_parse(const char *text, size_t length, double *value);

/* Seconds to whole nanoseconds from the decimal itself, never through a double; digits beyond the
 * ninth are rounded to the nearest, halves away from zero. Range +-9.2e9 s. */
stic_number_status stic_number_parse_ns(const char *text, size_t length, int64_t *ns);

/* Digits only, optionally after one '-' if low < 0; low..high. */
stic_number_status stic_number_parse_integer(const char *text, size_t length, int64_t low, int64_t high,
                                             int64_t *value);

/* "within +-1 m", "> 0 and <= 10 m": what a message expects. `unit` may be "". Returns out. */
const char *stic_number_range_text(double low, double high, bool above_low, const char *unit, char *out,
                                   size_t out_size);

#endif

/* Setting a stic_error. Internal to the library, its drivers and its program. */
#ifndef STIC_ERROR_H
#define STIC_ERROR_H

#include "stiction.h"

#if defined(__GNUC__)
#define STIC_PRINTF(format_at, first) __attribute__((format(printf, format_at, first)))
#else
#define STIC_PRINTF(format_at, first)
#endif

/* Fills `err` if it is not NULL and returns `status`, so that a refusal is one statement. `file` may
 * be NULL, `line` 0. Control characters become '?': a message is always one line. Real-time: no. */
stic_status stic_error_set(stic_error *err, stic_status status, const char *file, int64_t line,
                           const char *format, ...) STIC_PRINTF(5, 6);

/* clang's analyzer sees one file at a time and would take STIC_OK for possible. */
#if defined(__clang_analyzer__)
#define stic_error_set(err, status, ...) ((void)(stic_error_set)(err, status, __VA_ARGS__), (status))
#endif

/* Copies at most `length` bytes of foreign text into `out` for use in a message: shortened with
 * "..." where it does not fit, control characters shown as '?'. Returns `out`. */
const char *stic_error_quote(const char *text, size_t length, char *out, size_t out_size);

#endif

/* What makes something, for test_create: each part of the tree lists its own. */
#ifndef STIC_TEST_MAKERS_H
#define STIC_TEST_MAKERS_H

#include "../../src/error.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

typedef struct maker {
  const char *function, *how; /* "" where there is one row for it */
  /* What was made into *made, NULL if it is not held by a pointer. */
  stic_status (*make)(void **made, stic_error *err);
  void (*end)(void *made);
} maker;

typedef struct maker_group {
  void (*set_up)(void); /* what they are given */
  void (*tear_down)(void);
  const maker *makers; /* ended by a NULL function */
} maker_group;

extern const maker_group library_makers, driver_makers, picture_makers, plot_makers;

extern char poison; /* what a result points to before the call */

/* A maker of the usual shape: status function(..., &it, err). */
#define MAKE(id, function, type, destroy, ...)                                                               \
  static stic_status make_##id(void **made, stic_error *err)                                                 \
  {                                                                                                          \
    type *it = (type *)(void *)&poison;                                                                      \
    const stic_status status = function(__VA_ARGS__, &it, err);                                              \
                                                                                                             \
    *made = it;                                                                                              \
    return status;                                                                                           \
  }                                                                                                          \
  static void end_##id(void *made)                                                                           \
  {                                                                                                          \
    destroy(made);                                                                                           \
  }

/* For those that give nothing but success: the message that their callers would find. */
stic_status without_words(bool good, stic_error *err);
void end_nothing(void *made);

#endif

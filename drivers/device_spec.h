/* NAME[:key=value,...]: which device to open and how. */
#ifndef STIC_DEVICE_SPEC_H
#define STIC_DEVICE_SPEC_H

#include "../src/stiction.h"

#define STIC_SPEC_MAX 512 /* bytes of a specification, with its final 0 */
#define STIC_SPEC_PAIRS_MAX 16

/* A key that a driver knows. */
typedef struct stic_spec_key {
  const char *name;
  bool flag;         /* stands alone, without a value */
  const char *about; /* for --help */
} stic_spec_key;

typedef struct stic_spec_pair {
  const char *key;
  const char *value; /* NULL for a flag */
} stic_spec_pair;

/* A parsed specification; its strings are inside it, so it must not be copied. */
typedef struct stic_device_spec {
  const char *name;
  bool again; /* the device was lost and is opened anew; false as parsed */
  int pair_count;
  stic_spec_pair pairs[STIC_SPEC_PAIRS_MAX];
  char text[STIC_SPEC_MAX];
} stic_device_spec;

/* Takes a specification apart; "\," and "\\" in values stand for "," and "\". STIC_USAGE. */
stic_status stic_spec_parse(const char *text, stic_device_spec *spec, stic_error *err);

/* `value` as it must stand in a specification: with "\\" before "," and "\\". Cut where `out` is full; returns out. */
const char *stic_spec_quote(const char *value, char *out, size_t out_size);

/* Refuses unknown and repeated keys, missing and needless values. `keys` is ended by a NULL name. */
stic_status stic_spec_check(const stic_device_spec *spec, const stic_spec_key *keys, stic_error *err);

/* The value of a key, `fallback` if it is not given. */
const char *stic_spec_text(const stic_device_spec *spec, const char *key, const char *fallback);
bool stic_spec_flag(const stic_device_spec *spec, const char *key);
/* A number low..high; `*value` keeps its value if the key is not given. STIC_USAGE. */
stic_status stic_spec_number(const stic_device_spec *spec, const char *key, double low, double high,
                             double *value, stic_error *err);

#endif

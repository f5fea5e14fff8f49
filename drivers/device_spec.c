#include "device_spec.h"

#include "../src/error.h"
#include "../src/number.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

/* Ends the text at the next unescaped `end` and takes escapes out; returns what follows, NULL if the text
 * ended first. */
static char *cut_at(char *text, char end)
{
  char *to = text;

  for (; *text && *text != end; text++) {
    if (*text == '\\' && (text[1] == ',' || text[1] == '\\'))
      text++;
    *to++ = *text;
  }
  if (!*text) {
    *to = '\0';
    return NULL;
  }
  *to = '\0';
  return text + 1;
}

static stic_status add_pair(stic_device_spec *spec, char *pair, stic_error *err)
{
  char *equals = strchr(pair, '=');

  if (!*pair || equals == pair)
    return stic_error_set(err, STIC_USAGE, NULL, 0, "device %.40s: expected NAME:key=value,...", spec->name);
  if (spec->pair_count == STIC_SPEC_PAIRS_MAX)
    return stic_error_set(err, STIC_USAGE, NULL, 0, "device %.40s: expected at most %d keys", spec->name,
                          STIC_SPEC_PAIRS_MAX);
  if (equals)
    *equals = '\0';
  spec->pairs[spec->pair_count].key = pair;
  spec->pairs[spec->pair_count].value = equals ? equals + 1 : NULL;
  spec->pair_count++;
  return STIC_OK;
}

stic_status stic_spec_parse(const char *text, stic_device_spec *spec, stic_error *err)
{
  stic_status status = STIC_OK;
  char *rest;

  spec->again = false;
  spec->pair_count = 0;
  if (strlen(text) >= sizeof spec->text)
    return stic_error_set(err, STIC_USAGE, NULL, 0, "the device specification is longer than %d bytes",
                          STIC_SPEC_MAX - 1);
  strcpy(spec->text, text);
  spec->name = spec->text;
  rest = strchr(spec->text, ':');
  if (rest)
    *rest++ = '\0';
  if (!*spec->name)
    return stic_error_set(err, STIC_USAGE, NULL, 0, "the device has no name; expected NAME[:key=value,...]");
  while (rest && status == STIC_OK) {
    char *pair = rest;

    rest = cut_at(pair, ',');
    status = add_pair(spec, pair, err);
  }
  return status;
}

static const stic_spec_key *find_known(const stic_spec_key *keys, const char *name)
{
  for (; keys && keys->name; keys++) {
    if (strcmp(keys->name, name) == 0)
      return keys;
  }
  return NULL;
}

static void known_names(const stic_spec_key *keys, char *out, size_t out_size)
{
  size_t used = 0;

  snprintf(out, out_size, "none");
  for (; keys && keys->name && used < out_size; keys++) {
    const int n = snprintf(out + used, out_size - used, "%s%s%s", used > 0 ? ", " : "", keys->name,
                           keys->flag ? "" : "=");

    used += n > 0 ? (size_t)n : 0;
  }
}

stic_status stic_spec_check(const stic_device_spec *spec, const stic_spec_key *keys, stic_error *err)
{
  for (int i = 0; i < spec->pair_count; i++) {
    const stic_spec_pair *pair = &spec->pairs[i];
    const stic_spec_key *known = find_known(keys, pair->key);
    char names[200];

    known_names(keys, names, sizeof names);
    if (!known)
      return stic_error_set(err, STIC_USAGE, NULL, 0, "device %.40s: unknown key '%.40s'; expected %s",
                            spec->name, pair->key, names);
    if (known->flag && pair->value)
      return stic_error_set(err, STIC_USAGE, NULL, 0, "device %.40s: '%s' takes no value", spec->name,
                            pair->key);
    if (!known->flag && (!pair->value || !*pair->value))
      return stic_error_set(err, STIC_USAGE, NULL, 0, "device %.40s: '%s' has no value; expected %s=VALUE",
                            spec->name, pair->key, pair->key);
    for (int j = 0; j < i; j++) {
      if (strcmp(spec->pairs[j].key, pair->key) == 0)
        return stic_error_set(err, STIC_USAGE, NULL, 0, "device %.40s: '%s' is given twice", spec->name,
                              pair->key);
    }
  }
  return STIC_OK;
}

static const stic_spec_pair *find_pair(const stic_device_spec *spec, const char *key)
{
  for (int i = 0; i < spec->pair_count; i++) {
    if (strcmp(spec->pairs[i].key, key) == 0)
      return &spec->pairs[i];
  }
  return NULL;
}

const char *stic_spec_text(const stic_device_spec *spec, const char *key, const char *fallback)
{
  const stic_spec_pair *pair = find_pair(spec, key);

  return pair && pair->value ? pair->value : fallback;
}

bool stic_spec_flag(const stic_device_spec *spec, const char *key)
{
  return find_pair(spec, key) != NULL;
}

stic_status stic_spec_number(const stic_device_spec *spec, const char *key, double low, double high,
                             double *value, stic_error *err)
{
  const char *text = stic_spec_text(spec, key, NULL);
  double v;

  if (!text)
    return STIC_OK;
  if (stic_number_parse(text, strlen(text), &v) != STIC_NUMBER_OK || v < low || v > high)
    return stic_error_set(err, STIC_USAGE, NULL, 0,
                          "device %.40s: %s is '%.40s'; expected a number from %g to %g", spec->name, key,
                          text, low, high);
  *value = v;
  return STIC_OK;
}

const char *stic_spec_quote(const char *value, char *out, size_t out_size)
{
  size_t used = 0;

  for (; *value && used + 3 <= out_size; value++) {
    if (*value == ',' || *value == '\\')
      out[used++] = '\\';
    out[used++] = *value;
  }
  out[used] = '\0';
  return out;
}

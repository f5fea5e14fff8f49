/* Building JSON: what cannot be made for lack of memory is NULL, and so is all that it would have been part of. json_pack()
 * keeps to that by itself; these do for lists and objects of any length. Both take `value` over. */
#ifndef STIC_JSON_H
#define STIC_JSON_H

#include <jansson.h>
#include <stdlib.h>

/* The list with the value at its end. */
static inline json_t *stic_json_append(json_t *list, json_t *value)
{
  if (json_array_append_new(list, value) == 0)
    return list;
  json_decref(list);
  return NULL;
}

/* The object with the value under that key. */
static inline json_t *stic_json_set(json_t *object, const char *key, json_t *value)
{
  if (json_object_set_new(object, key, value) == 0)
    return object;
  json_decref(object);
  return NULL;
}

/* As json_dumps(), which leaves a character out where it has no memory for it. To be freed, NULL without memory. */
static inline char *stic_json_text(const json_t *json, size_t flags)
{
  const size_t length = json ? json_dumpb(json, NULL, 0, flags) : 0;
  char *text = length > 0 ? malloc(length + 1) : NULL;

  if (text && json_dumpb(json, text, length, flags) == length) {
    text[length] = '\0';
    return text;
  }
  free(text);
  return NULL;
}

#endif

/* Scene files. What follows the last zero byte is a --set KEY=VALUE if it has the form of one. What is read as a
 * scene is one: the library's own examination finds nothing. */
#include "memory_file.h"

#include "scene_yaml.h"

#include <math.h>
#include <string.h>

#define OVERRIDE_MAX 256

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void on_finding(void *context, bool warning, const stic_error *problem)
{
  int *errors = context;
  char text[1024];

  *errors += !warning;
  require((problem->status == STIC_OK) == warning && problem->message[0] && problem->line >= 0);
  stic_error_format(problem, text, sizeof text);
  for (const char *c = text; *c; c++)
    require((unsigned char)*c >= 0x20);
}

/* Splits off KEY=VALUE. */
static size_t take_override(const uint8_t *data, size_t size, char *text, stic_override *override)
{
  size_t start = size;
  char *equals;

  while (start > 0 && data[start - 1])
    start--;
  if (start == 0 || size - start >= OVERRIDE_MAX)
    return size;
  memcpy(text, data + start, size - start);
  text[size - start] = '\0';
  equals = strchr(text, '=');
  if (!equals || equals == text)
    return size;
  *equals = '\0';
  override->key = text;
  override->value = equals + 1;
  return start - 1;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  static memory_file file;
  static stic_scene scene;
  char text[OVERRIDE_MAX];
  stic_override override = {NULL, NULL};
  const size_t length = take_override(data, size, text, &override);
  const char *path = memory_file_write(&file, data, length);
  stic_error err;
  int errors = 0;
  const stic_status status =
    stic_scene_read_all(path, &override, override.key != NULL, &scene, NULL, on_finding, &errors);

  require((status == STIC_OK) == (errors == 0));
  if (status != STIC_OK)
    return 0;
  require(stic_scene_validate(&scene, &err) == STIC_OK);
  require(isfinite(stic_scene_size(&scene)) && stic_scene_size(&scene) > 0);
  return 0;
}

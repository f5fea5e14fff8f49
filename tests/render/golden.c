#include "golden.h"

#include <ctype.h>
#include <inttypes.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "png_writer.h"

#define CHANNEL_TOLERANCE 16
#define PIXELS_PER_OUTLIER 500

uint64_t stic_hash(const void *data, size_t size)
{
  const unsigned char *bytes = data;
  uint64_t hash = 14695981039346656037u;

  for (size_t i = 0; i < size; i++)
    hash = (hash ^ bytes[i]) * 1099511628211u;
  return hash;
}

static bool pixel_differs(const uint8_t *a, const uint8_t *b)
{
  for (int k = 0; k < 3; k++) {
    if (abs(a[k] - b[k]) > CHANNEL_TOLERANCE)
      return true;
  }
  return false;
}

bool stic_pictures_agree(const stic_image *a, const stic_image *b)
{
  int count = a->width * a->height, outliers = 0;

  if (a->width != b->width || a->height != b->height)
    return false;
  for (int i = 0; i < count; i++)
    outliers += pixel_differs(a->pixels + 4 * i, b->pixels + 4 * i);
  return outliers * PIXELS_PER_OUTLIER <= count;
}

static bool blessing(void)
{
  const char *value = getenv("STIC_BLESS");

  return value && !strcmp(value, "1");
}

/* "llvmpipe (LLVM 15.0.6, 256 bits), 4.5 (Core Profile) Mesa 22.3.6" -> "llvm-15.0.6-256-mesa-22.3.6" */
static void short_name(const char *rasteriser, char *out, size_t size)
{
  char llvm[24] = "unknown", mesa[24] = "unknown";
  const char *at = strstr(rasteriser, "Mesa ");
  int bits = 0;

  sscanf(rasteriser, "llvmpipe (LLVM %23[^,], %d", llvm, &bits);
  if (at)
    sscanf(at, "Mesa %23[0-9.]", mesa);
  snprintf(out, size, "llvm-%s-%d-mesa-%s", llvm, bits, mesa);
}

stic_verdict stic_golden_picture(const char *name, const char *rasteriser, const stic_image *image)
{
  char key[96], path[600];
  png_image file;
  stic_image golden;
  uint8_t *pixels;
  bool same;

  short_name(rasteriser, key, sizeof key);
  snprintf(path, sizeof path, "%s/%s-%s.png", STIC_GOLDEN_FOLDER, name, key);
  if (blessing() && stic_png_write(path, image, NULL))
    return STIC_DIFFERENT;
  memset(&file, 0, sizeof file);
  file.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&file, path))
    return STIC_NO_GOLDEN;
  file.format = PNG_FORMAT_RGBA;
  pixels = malloc(PNG_IMAGE_SIZE(file));
  if (!pixels || !png_image_finish_read(&file, NULL, pixels, 0, NULL)) {
    free(pixels);
    return STIC_DIFFERENT;
  }
  golden = (stic_image){(int)file.width, (int)file.height, pixels};
  same = stic_pictures_agree(&golden, image);
  free(pixels);
  return same ? STIC_SAME : STIC_DIFFERENT;
}

stic_verdict stic_golden_hash(const char *name, const char *rasteriser, uint64_t hash)
{
  char key[96], line[256], line_key[96], line_name[64];
  const char *path = STIC_GOLDEN_FOLDER "/hashes.txt";
  stic_verdict verdict = STIC_NO_GOLDEN;
  FILE *file;
  uint64_t value;

  short_name(rasteriser, key, sizeof key);
  if (blessing() && (file = fopen(path, "a")) != NULL) {
    fprintf(file, "%s %s %016" PRIx64 "\n", key, name, hash);
    fclose(file);
  }
  file = fopen(path, "r");
  /* The last line of a name counts. */
  while (file && fgets(line, sizeof line, file)) {
    if (sscanf(line, "%95s %63s %" SCNx64, line_key, line_name, &value) == 3 && !strcmp(key, line_key) &&
        !strcmp(name, line_name))
      verdict = value == hash ? STIC_SAME : STIC_DIFFERENT;
  }
  if (file)
    fclose(file);
  return verdict;
}

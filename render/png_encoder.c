#include "png_encoder.h"

#include <libdeflate.h>
#include <stdlib.h>
#include <string.h>

/* Signature, IHDR and the head of IDAT before the data; IDAT's checksum and IEND after it. */
enum {
  SIGNATURE = 8,
  CHUNK = 12,
  IHDR_DATA = 13,
  BEFORE = SIGNATURE + CHUNK + IHDR_DATA + 8,
  AFTER = 4 + CHUNK
};

struct stic_png_encoder {
  struct libdeflate_compressor *compressor;
  uint8_t *rows, *file; /* owned */
  size_t rows_size, file_size;
};

stic_png_encoder *stic_png_encoder_create(int effort)
{
  stic_png_encoder *e = calloc(1, sizeof *e);

  if (e)
    e->compressor = libdeflate_alloc_compressor(effort);
  if (!e || !e->compressor) {
    free(e);
    return NULL;
  }
  return e;
}

void stic_png_encoder_destroy(stic_png_encoder *e)
{
  if (!e)
    return;
  libdeflate_free_compressor(e->compressor);
  free(e->rows);
  free(e->file);
  free(e);
}

static bool make_room(uint8_t **buffer, size_t *size, size_t wanted)
{
  if (*size >= wanted)
    return true;
  free(*buffer);
  *buffer = malloc(wanted);
  *size = *buffer ? wanted : 0;
  return *buffer != NULL;
}

/* A byte 0 (no filter) and the colours of each row. Whole pixels are copied, which is quicker: the fourth byte
 * is overwritten by what follows, so `out` has room for one more. */
static void pack_rows(const stic_image *image, uint8_t *out)
{
  const uint8_t *in = image->pixels;

  for (int y = 0; y < image->height; y++) {
    *out++ = 0;
    for (int x = 0; x < image->width; x++, in += 4, out += 3)
      memcpy(out, in, 4);
  }
}

static void put_number(uint8_t *out, uint32_t n)
{
  for (int i = 0; i < 4; i++)
    out[i] = (uint8_t)(n >> (24 - 8 * i));
}

/* Completes a chunk whose `length` bytes of data are already at out + 8; returns what follows it. */
static uint8_t *put_chunk(uint8_t *out, const char *type, uint32_t length)
{
  put_number(out, length);
  memcpy(out + 4, type, 4);
  put_number(out + 8 + length, libdeflate_crc32(0, out + 4, length + 4));
  return out + CHUNK + length;
}

static uint8_t *put_head(uint8_t *out, const stic_image *image)
{
  static const uint8_t signature[SIGNATURE] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  static const uint8_t eight_bits_rgb[5] = {8, 2, 0, 0, 0};

  memcpy(out, signature, SIGNATURE);
  out += SIGNATURE;
  put_number(out + 8, (uint32_t)image->width);
  put_number(out + 12, (uint32_t)image->height);
  memcpy(out + 16, eight_bits_rgb, sizeof eight_bits_rgb);
  return put_chunk(out, "IHDR", IHDR_DATA);
}

const uint8_t *stic_png_encode(stic_png_encoder *e, const stic_image *image, size_t *length)
{
  const size_t size = ((size_t)image->width * 3 + 1) * (size_t)image->height;
  const size_t bound = libdeflate_zlib_compress_bound(e->compressor, size);
  uint8_t *end;
  size_t packed;

  if (!make_room(&e->rows, &e->rows_size, size + 1) ||
      !make_room(&e->file, &e->file_size, BEFORE + bound + AFTER))
    return NULL;
  pack_rows(image, e->rows);
  packed = libdeflate_zlib_compress(e->compressor, e->rows, size, e->file + BEFORE, bound);
  end = put_chunk(put_head(e->file, image), "IDAT", (uint32_t)packed);
  end = put_chunk(end, "IEND", 0);
  *length = (size_t)(end - e->file);
  return e->file;
}

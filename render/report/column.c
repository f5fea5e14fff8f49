#include "column.h"

#include <stdlib.h>
#include <string.h>

static void put(stic_column *c, uint64_t bits, int count)
{
  if (c->size + 8 > c->room && !c->failed) {
    const size_t room = c->room > 0 ? 2 * c->room : 4096;
    unsigned char *bytes = realloc(c->bytes, room);

    c->failed = !bytes;
    if (bytes) {
      c->bytes = bytes;
      c->room = room;
    }
  }
  for (int i = 0; i < count && !c->failed; i++)
    c->bytes[c->size++] = (unsigned char)(bits >> (8 * i));
}

void stic_column_f64(stic_column *column, double value)
{
  uint64_t bits;

  memcpy(&bits, &value, sizeof bits);
  put(column, bits, 8);
}

void stic_column_f32(stic_column *column, double value)
{
  const float narrow = (float)value;
  uint32_t bits;

  memcpy(&bits, &narrow, sizeof bits);
  put(column, bits, 4);
}

void stic_column_integer(stic_column *column, int64_t value, int bytes)
{
  put(column, (uint64_t)value, bytes);
}

void stic_column_free(stic_column *column)
{
  free(column->bytes);
  memset(column, 0, sizeof *column);
}

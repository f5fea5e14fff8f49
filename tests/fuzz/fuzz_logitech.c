/* Any bytes in any pieces into the Logitech decoder: what comes out is a pose, in order of time. */
#include "../../drivers/logitech/logitech_stream.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds)
{
  if (!holds)
    abort();
}

static void check(const stic_device_sample *sample, const stic_device_sample *last)
{
  double norm = 0;

  for (int i = 0; i < 4; i++)
    norm += sample->orientation[i] * sample->orientation[i];
  require(fabs(norm - 1) < 1e-9);
  for (int i = 0; i < 3; i++)
    require(fabs(sample->position[i]) <= 1048576 * 25.4e-6);
  require(sample->t_ns > last->t_ns && sample->sequence >= last->sequence && sample->buttons < 32);
  require(!(sample->flags & STIC_SAMPLE_TRACKED) || (sample->flags & STIC_SAMPLE_POSITION));
}

/* The first byte is the size of the pieces; time goes on by a byte's time on the wire. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  stic_logitech_stream stream;
  stic_device_sample sample, last;
  const size_t piece = size > 0 && data[0] % 32 > 0 ? data[0] % 32 : 32;

  memset(&stream, 0, sizeof stream);
  memset(&last, 0, sizeof last);
  for (size_t at = 1; at < size; at += piece) {
    const size_t length = size - at < piece ? size - at : piece;
    const int64_t arrival_ns = 1000000000 + (int64_t)(at + length) * STIC_LOGITECH_BYTE_NS;
    size_t taken = 0, used;
    bool given;

    do {
      given =
        stic_logitech_stream_next(&stream, data + at + taken, length - taken, arrival_ns, &used, &sample);
      taken += used;
      require(taken <= length && (given || taken == length));
      if (given) {
        check(&sample, &last);
        last = sample;
      }
    } while (given || taken < length);
  }
  require(stic_logitech_stream_bad(&stream) >= 0);
  return 0;
}

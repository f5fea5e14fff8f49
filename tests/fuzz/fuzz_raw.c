/* Raw recordings, serial and hid-recorder text: what is given out is in order of time and within its bounds. */
#include "memory_file.h"

#include "../../drivers/raw_recording.h"

#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check_device(const stic_raw_device *d)
{
  require(memchr(d->name, 0, sizeof d->name) && memchr(d->place, 0, sizeof d->place));
  require(d->descriptor_length <= STIC_RAW_DESCRIPTOR_MAX);
  require(d->bus >= 0 && d->bus <= 0xffff && d->vendor >= 0 && d->product >= 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  static memory_file file;
  stic_raw_reader *reader;
  stic_raw_record record;
  stic_raw_status status;
  stic_error err;
  int64_t last_ns = 0;
  unsigned sum = 0;

  require(stic_raw_open(memory_file_write(&file, data, size), &reader, &err) == STIC_OK);
  while ((status = stic_raw_next(reader, &record, &err)) == STIC_RAW_RECORD || status == STIC_RAW_WAIT) {
    if (status == STIC_RAW_WAIT)
      continue;
    require(record.length >= 1 && record.length <= STIC_RAW_BYTES_MAX && record.t_ns >= last_ns);
    require(record.device >= 0 && record.device < STIC_RAW_DEVICES_MAX);
    for (size_t i = 0; i < record.length; i++)
      sum += record.bytes[i];
    last_ns = record.t_ns;
  }
  require(sum <= 255 * size && (status == STIC_RAW_END || err.message[0]));
  for (int i = 0; i < STIC_RAW_DEVICES_MAX; i++)
    check_device(stic_raw_reader_device(reader, i));
  stic_raw_close(reader);
  return 0;
}

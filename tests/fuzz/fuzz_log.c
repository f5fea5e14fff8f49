/* Logs. A row that is read, written and read again is the same. */
#include "memory_file.h"

#include "io/log_csv.h"

#include <string.h>

#define HEAD STIC_LOG_FORMAT "\n" STIC_LOG_HEADER "\n"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check_row(const stic_result *row)
{
  static memory_file file;
  static stic_result again;
  char text[sizeof HEAD + STIC_LOG_ROW_MAX] = HEAD;
  const size_t length = sizeof HEAD - 1;
  stic_log_reader *reader;
  stic_error err;
  bool more;

  require(row->contact_count >= 0 && row->contact_count <= STIC_CONTACTS_MAX);
  const char *path = memory_file_write(&file, text, length + stic_log_row_text(row, text + length));
  require(stic_log_open(path, &reader, &err) == STIC_OK);
  require(stic_log_next(reader, &again, &more, &err) == STIC_OK && more);
  require(memcmp(row, &again, sizeof again) == 0);
  require(stic_log_next(reader, &again, &more, &err) == STIC_OK && !more);
  stic_log_close(reader);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  static memory_file file;
  static stic_result row;
  stic_log_reader *reader;
  stic_error err;
  bool more = true;

  if (stic_log_open(memory_file_write(&file, data, size), &reader, &err) != STIC_OK) {
    require(err.message[0] != '\0');
    return 0;
  }
  require(strlen(stic_log_provenance(reader, "scene", 0)) < 1024);
  while (more && stic_log_next(reader, &row, &more, &err) == STIC_OK) {
    if (more)
      check_row(&row);
  }
  stic_log_close(reader);
  return 0;
}

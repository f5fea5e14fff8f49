#include "raw_recording.h"

#include "../src/error.h"
#include "../src/io/format.h"
#include "../src/io/line_reader.h"
#include "../src/number.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define FORMAT_VERSION 1
#define US 1000                         /* ns */
#define CLOCK_MARK "# the clock at 0: " /* ns; what a HID recording's times are counted from */

struct stic_raw_reader {
  stic_line_reader *lines;
  bool kind_known;
  bool begun; /* a record has been given out */
  bool lenient;
  void (*report)(void *context, const stic_error *problem); /* may be NULL */
  void *report_context;
  bool held; /* `record` is to be given out again */
  stic_raw_record record;
  stic_raw_kind kind;
  int device; /* that the lines are about */
  int64_t last_ns;
  bool clock_known; /* a HID recording says what its times are counted from: */
  int64_t clock_ns;
  uint8_t bytes[STIC_RAW_BYTES_MAX];
  stic_raw_device devices[STIC_RAW_DEVICES_MAX];
};

stic_status stic_raw_open(const char *path, stic_raw_reader **reader, stic_error *err)
{
  stic_raw_reader *r = calloc(1, sizeof *r);
  stic_status status;

  *reader = NULL;
  if (!r)
    return stic_error_set(err, STIC_NO_MEMORY, path, 0, "out of memory");
  status = stic_line_reader_open(path, &r->lines, err);
  if (status != STIC_OK)
    free(r);
  else
    *reader = r;
  return status;
}

void stic_raw_be_lenient(stic_raw_reader *reader, void (*report)(void *context, const stic_error *problem),
                         void *context)
{
  reader->lenient = true;
  reader->report = report;
  reader->report_context = context;
}

void stic_raw_close(stic_raw_reader *reader)
{
  if (!reader)
    return;
  stic_line_reader_close(reader->lines);
  free(reader);
}

stic_raw_kind stic_raw_reader_kind(const stic_raw_reader *reader)
{
  return reader->kind;
}

const stic_raw_device *stic_raw_reader_device(const stic_raw_reader *reader, int device)
{
  assert(device >= 0 && device < STIC_RAW_DEVICES_MAX);
  return &reader->devices[device];
}

/* ---- words of a line --------------------------------------------------------------------- */

typedef struct words {
  const char *at, *end;
} words;

static bool next_word(words *w, const char **text, size_t *length)
{
  while (w->at < w->end && (*w->at == ' ' || *w->at == '\t'))
    w->at++;
  *text = w->at;
  while (w->at < w->end && *w->at != ' ' && *w->at != '\t')
    w->at++;
  *length = (size_t)(w->at - *text);
  return *length > 0;
}

static int hex_digit(char c)
{
  if (c >= '0' && c <= '9')
    return c - '0';
  if (c >= 'a' && c <= 'f')
    return c - 'a' + 10;
  if (c >= 'A' && c <= 'F')
    return c - 'A' + 10;
  return -1;
}

/* Up to four hexadecimal digits. */
static bool parse_hex(const char *text, size_t length, int *value)
{
  *value = 0;
  if (length < 1 || length > 4)
    return false;
  for (size_t i = 0; i < length; i++) {
    const int digit = hex_digit(text[i]);

    if (digit < 0)
      return false;
    *value = *value * 16 + digit;
  }
  return true;
}

static stic_raw_status bad(const stic_raw_reader *r, stic_error *err, const char *format, ...)
  STIC_PRINTF(3, 4);

static stic_raw_status bad(const stic_raw_reader *r, stic_error *err, const char *format, ...)
{
  char message[400];
  va_list args;

  va_start(args, format);
  vsnprintf(message, sizeof message, format, args);
  va_end(args);
  stic_error_set(err, STIC_BAD_INPUT, stic_line_reader_name(r->lines), stic_line_reader_number(r->lines),
                 "%s", message);
  return STIC_RAW_BAD;
}

/* The bytes in the rest of a line; false and `*err` if there is anything else. */
static bool parse_bytes(const stic_raw_reader *r, words *w, uint8_t *bytes, size_t room, size_t *count,
                        stic_error *err)
{
  const char *text;
  size_t length;
  char shown[24];
  int value;

  *count = 0;
  while (next_word(w, &text, &length)) {
    if (length != 2 || !parse_hex(text, length, &value)) {
      bad(r, err, "found '%s'; expected bytes of two hexadecimal digits",
          stic_error_quote(text, length, shown, sizeof shown));
      return false;
    }
    if (*count == room) {
      bad(r, err, "more than %zu bytes; expected fewer in one line", room);
      return false;
    }
    bytes[(*count)++] = (uint8_t)value;
  }
  return true;
}

/* A length and that many bytes. */
static bool parse_counted_bytes(const stic_raw_reader *r, words *w, uint8_t *bytes, size_t room,
                                size_t *count, stic_error *err)
{
  const char *text;
  size_t length;
  int64_t told;
  char shown[24];

  if (!next_word(w, &text, &length) ||
      stic_number_parse_integer(text, length, 1, (int64_t)room, &told) != STIC_NUMBER_OK) {
    bad(r, err, "length is '%s'; expected a number of bytes from 1 to %zu",
        stic_error_quote(text, length, shown, sizeof shown), room);
    return false;
  }
  if (!parse_bytes(r, w, bytes, room, count, err))
    return false;
  if ((int64_t)*count != told) {
    bad(r, err, "found %zu bytes; expected the %lld that the line tells", *count, (long long)told);
    return false;
  }
  return true;
}

/* ---- records ----------------------------------------------------------------------------- */

static stic_raw_status give(stic_raw_reader *r, int64_t t_ns, size_t count, stic_raw_record *record,
                            stic_error *err)
{
  if (r->begun && t_ns < r->last_ns)
    return bad(r, err, "time %lld ns is before the last record's %lld; expected it not to decrease",
               (long long)t_ns, (long long)r->last_ns);
  r->begun = true;
  r->last_ns = t_ns;
  record->t_ns = t_ns;
  record->device = r->device;
  record->length = count;
  record->bytes = r->bytes;
  return STIC_RAW_RECORD;
}

static stic_raw_status read_serial(stic_raw_reader *r, words *w, stic_raw_record *record, stic_error *err)
{
  const char *text;
  size_t length, count;
  int64_t t_ns;
  char shown[40];

  if (!next_word(w, &text, &length))
    return STIC_RAW_WAIT; /* an empty line */
  if (stic_number_parse_integer(text, length, 0, INT64_MAX, &t_ns) != STIC_NUMBER_OK)
    return bad(r, err, "time is '%s'; expected whole nanoseconds, then bytes",
               stic_error_quote(text, length, shown, sizeof shown));
  if (!parse_bytes(r, w, r->bytes, sizeof r->bytes, &count, err))
    return STIC_RAW_BAD;
  if (count == 0)
    return bad(r, err, "a time without bytes; expected 't_ns hex ...'");
  return give(r, t_ns, count, record, err);
}

/* sec.usec, with leading zeros as hid-recorder writes them. */
static bool parse_time(const char *text, size_t length, int64_t *t_ns)
{
  while (length > 1 && text[0] == '0' && text[1] != '.') {
    text++;
    length--;
  }
  return stic_number_parse_ns(text, length, t_ns) == STIC_NUMBER_OK && *t_ns >= 0;
}

static stic_raw_status read_event(stic_raw_reader *r, words *w, stic_raw_record *record, stic_error *err)
{
  const char *text;
  size_t length, count;
  int64_t t_ns;
  char shown[40];

  if (!next_word(w, &text, &length) || !parse_time(text, length, &t_ns))
    return bad(r, err, "time is '%s'; expected E: sec.usec length hex ...",
               stic_error_quote(text, length, shown, sizeof shown));
  if (!parse_counted_bytes(r, w, r->bytes, sizeof r->bytes, &count, err))
    return STIC_RAW_BAD;
  return give(r, t_ns, count, record, err);
}

static stic_raw_status read_device_number(stic_raw_reader *r, words *w, stic_error *err)
{
  const char *text;
  size_t length;
  int64_t device;
  char shown[24];

  if (!next_word(w, &text, &length) ||
      stic_number_parse_integer(text, length, 0, STIC_RAW_DEVICES_MAX - 1, &device) != STIC_NUMBER_OK)
    return bad(r, err, "device is '%s'; expected D: 0 to %d",
               stic_error_quote(text, length, shown, sizeof shown), STIC_RAW_DEVICES_MAX - 1);
  r->device = (int)device;
  return STIC_RAW_WAIT;
}

static stic_raw_status read_ids(stic_raw_reader *r, words *w, stic_error *err)
{
  stic_raw_device *d = &r->devices[r->device];
  int *const ids[] = {&d->bus, &d->vendor, &d->product};
  const char *text;
  size_t length;

  for (int i = 0; i < 3; i++) {
    if (!next_word(w, &text, &length) || !parse_hex(text, length, ids[i]))
      return bad(r, err, "expected I: bus vendor product, each of 1 to 4 hexadecimal digits");
  }
  return STIC_RAW_WAIT;
}

static stic_raw_status read_descriptor(stic_raw_reader *r, words *w, stic_error *err)
{
  stic_raw_device *d = &r->devices[r->device];

  return parse_counted_bytes(r, w, d->descriptor, sizeof d->descriptor, &d->descriptor_length, err)
           ? STIC_RAW_WAIT
           : STIC_RAW_BAD;
}

static stic_raw_status read_text(const words *w, char *out, size_t out_size)
{
  const char *at = w->at;

  while (at < w->end && *at == ' ')
    at++;
  stic_error_quote(at, (size_t)(w->end - at), out, out_size);
  return STIC_RAW_WAIT;
}

static stic_raw_status read_hid(stic_raw_reader *r, words *w, stic_raw_record *record, stic_error *err)
{
  stic_raw_device *d = &r->devices[r->device];
  const char *text;
  size_t length;
  char shown[24];

  if (!next_word(w, &text, &length))
    return STIC_RAW_WAIT;
  if (length == 2 && text[1] == ':') {
    switch (text[0]) {
    case 'D': return read_device_number(r, w, err);
    case 'R': return read_descriptor(r, w, err);
    case 'N': return read_text(w, d->name, sizeof d->name);
    case 'P': return read_text(w, d->place, sizeof d->place);
    case 'I': return read_ids(r, w, err);
    case 'E': return read_event(r, w, record, err);
    default: break;
    }
  }
  return bad(r, err, "found '%s'; expected a line that starts with D: R: N: P: I: E: or #",
             stic_error_quote(text, length, shown, sizeof shown));
}

/* The first line that is no foreign comment tells the kind. */
static stic_raw_status learn_kind(stic_raw_reader *r, const char *text, size_t length, stic_error *err)
{
  const int64_t version = stic_line_format_version(text, length, "serial");

  if (version >= 0 && version != FORMAT_VERSION)
    return bad(r, err, "the recording has format version %lld; expected %d", (long long)version,
               FORMAT_VERSION);
  if (version >= 0) {
    r->kind = STIC_RAW_SERIAL;
    r->kind_known = true;
  } else if (length >= 2 && text[1] == ':') {
    r->kind = STIC_RAW_HID;
    r->kind_known = true;
  } else if (length > 0 && text[0] != '#') {
    return bad(r, err, "expected '%s' or a recording by hid-recorder", STIC_RAW_FORMAT);
  }
  return STIC_RAW_WAIT;
}

static void read_clock(stic_raw_reader *r, const char *text, size_t length)
{
  const size_t mark = sizeof CLOCK_MARK - 1;

  if (length > mark && memcmp(text, CLOCK_MARK, mark) == 0)
    r->clock_known = stic_number_parse_integer(text + mark, length - mark, INT64_MIN, INT64_MAX,
                                               &r->clock_ns) == STIC_NUMBER_OK;
}

/* One line: a record, or STIC_RAW_WAIT for any other. */
static stic_raw_status read_line(stic_raw_reader *r, const char *text, size_t length, stic_raw_record *record,
                                 stic_error *err)
{
  words w = {text, text + length};

  if (!r->kind_known) {
    const stic_raw_status status = learn_kind(r, text, length, err);

    if (status != STIC_RAW_WAIT || !r->kind_known)
      return status;
  }
  if (length == 0 || text[0] == '#') {
    read_clock(r, text, length);
    return STIC_RAW_WAIT;
  }
  return r->kind == STIC_RAW_SERIAL ? read_serial(r, &w, record, err) : read_hid(r, &w, record, err);
}

/* Whether a bad line is to be passed over: what is no recording at all is not. */
static bool pass_over(stic_raw_reader *r, const stic_error *problem)
{
  if (!r->lenient || !r->kind_known)
    return false;
  if (r->report)
    r->report(r->report_context, problem);
  return true;
}

stic_raw_status stic_raw_next(stic_raw_reader *r, stic_raw_record *record, stic_error *err)
{
  stic_error problem;

  if (r->held) {
    r->held = false;
    *record = r->record;
    return STIC_RAW_RECORD;
  }
  for (;;) {
    const char *text;
    size_t length;
    stic_raw_status status = STIC_RAW_BAD;

    errno = 0;
    switch (stic_line_reader_next(r->lines, &text, &length)) {
    case STIC_LINE_READ:
      status = read_line(r, text, length, record, &problem);
      if (status == STIC_RAW_RECORD)
        return status;
      break;
    case STIC_LINE_TOO_LONG: bad(r, &problem, "the line is longer than %d bytes", STIC_LINE_MAX); break;
    case STIC_LINE_UNFINISHED: continue;
    case STIC_LINE_END:
      if (!r->begun)
        return bad(r, err, "the recording holds no records; expected '%s' or a recording by hid-recorder",
                   STIC_RAW_FORMAT);
      return STIC_RAW_END;
    case STIC_LINE_WAIT: /* nobody who asks again looks for signals, and the pipe may never be written to */
      if (errno == EINTR)
        return bad(r, err, "cannot read: %s", strerror(errno));
      return STIC_RAW_WAIT;
    case STIC_LINE_FAILED: return bad(r, err, "cannot read: %s", strerror(errno));
    }
    if (status == STIC_RAW_BAD && !pass_over(r, &problem)) {
      if (err)
        *err = problem;
      return STIC_RAW_BAD;
    }
  }
}

stic_raw_status stic_raw_peek(stic_raw_reader *r, stic_raw_record *record, stic_error *err)
{
  const stic_raw_status status = stic_raw_next(r, record, err);

  r->held = status == STIC_RAW_RECORD;
  if (r->held)
    r->record = *record;
  return status;
}

/* ---- writing ----------------------------------------------------------------------------- */

struct stic_raw_writer {
  int fd;
  bool owned;    /* fd is ours to close */
  bool head_due; /* nothing is written yet, and an older file still there */
  bool begun;    /* a record is written */
  stic_raw_kind kind;
  int device;
  int64_t start_ns;
  char path[256];
  char line[STIC_RAW_BYTES_MAX * 3 + 64];
  stic_raw_device about; /* device 0 */
};

static size_t put_bytes(const uint8_t *bytes, size_t length, char *out)
{
  static const char digits[] = "0123456789abcdef";

  for (size_t i = 0; i < length; i++) {
    out[3 * i] = ' ';
    out[3 * i + 1] = digits[bytes[i] >> 4];
    out[3 * i + 2] = digits[bytes[i] & 15];
  }
  return 3 * length;
}

static stic_status write_line(stic_raw_writer *w, size_t length, stic_error *err)
{
  const char *at = w->line;

  w->line[length++] = '\n';
  while (length > 0) {
    const ssize_t n = write(w->fd, at, length);

    if (n < 0 && errno == EINTR)
      continue;
    if (n <= 0)
      return stic_error_set(err, STIC_CANNOT_WRITE, w->path, 0, "cannot write: %s",
                            strerror(n < 0 ? errno : ENOSPC));
    at += n;
    length -= (size_t)n;
  }
  return STIC_OK;
}

static stic_status write_text(stic_raw_writer *w, stic_error *err, const char *format, ...) STIC_PRINTF(3, 4);

static stic_status write_text(stic_raw_writer *w, stic_error *err, const char *format, ...)
{
  va_list args;
  int n;

  va_start(args, format);
  n = vsnprintf(w->line, sizeof w->line - 1, format, args);
  va_end(args);
  assert(n >= 0 && (size_t)n < sizeof w->line - 1);
  return write_line(w, (size_t)n, err);
}

/* An older recording is lost only now, when there is something to put in its place. */
static stic_status write_head(stic_raw_writer *w, stic_error *err)
{
  const stic_raw_device *device = &w->about;
  struct stat st;
  stic_status status;
  size_t n;

  w->head_due = false;
  if (fstat(w->fd, &st) == 0 && S_ISREG(st.st_mode) && w->owned && ftruncate(w->fd, 0) != 0)
    return stic_error_set(err, STIC_CANNOT_WRITE, w->path, 0, "cannot empty the older recording: %s",
                          strerror(errno));
  if (w->kind == STIC_RAW_SERIAL)
    return write_text(w, err, "%s", STIC_RAW_FORMAT);
  status = write_text(w, err, "D: 0");
  if (status == STIC_OK && device->descriptor_length > 0) {
    n = (size_t)snprintf(w->line, sizeof w->line, "R: %zu", device->descriptor_length);
    n += put_bytes(device->descriptor, device->descriptor_length, w->line + n);
    status = write_line(w, n, err);
  }
  if (status == STIC_OK)
    status = write_text(w, err, "N: %s", device->name);
  if (status == STIC_OK)
    status = write_text(w, err, "P: %s", device->place);
  if (status == STIC_OK)
    status = write_text(w, err, "I: %x %04x %04x", (unsigned)device->bus, (unsigned)device->vendor,
                        (unsigned)device->product);
  return status;
}

/* Cuts a line without its end, as a full disk leaves it. */
static bool cut_last_line(int fd)
{
  off_t end = lseek(fd, 0, SEEK_END);
  char c = '\n';

  while (end > 0 && pread(fd, &c, 1, end - 1) == 1 && c != '\n')
    end--;
  return end >= 0 && ftruncate(fd, end) == 0;
}

static stic_status cannot_write(const char *path, stic_error *err)
{
  return stic_error_set(err, STIC_CANNOT_WRITE, path, 0, "cannot write: %s", strerror(errno));
}

/* Goes on with a recording; `w->fd` stays -1 if there is none of this kind, or its clock is not told. Not knowing for lack
 * of memory is an error, as what was recorded would be lost. */
static stic_status resume(stic_raw_writer *w, const char *path, stic_error *err)
{
  stic_raw_reader *reader;
  stic_raw_record record;
  stic_raw_status read;
  const stic_status status = stic_raw_open(path, &reader, NULL);
  bool good;

  if (status == STIC_NO_MEMORY)
    return stic_error_set(err, status, path, 0, "out of memory");
  if (status != STIC_OK)
    return STIC_OK;
  do
    read = stic_raw_next(reader, &record, NULL);
  while (read == STIC_RAW_WAIT);
  good =
    read == STIC_RAW_RECORD && reader->kind == w->kind && (w->kind == STIC_RAW_SERIAL || reader->clock_known);
  w->start_ns = reader->clock_ns;
  stic_raw_close(reader);
  if (!good)
    return STIC_OK;
  w->begun = true;
  w->device = -1; /* whose line came last is not known */
  w->fd = open(path, O_RDWR | O_APPEND | O_CLOEXEC);
  return w->fd >= 0 && cut_last_line(w->fd) ? STIC_OK : cannot_write(path, err);
}

static stic_status begin_writer(stic_raw_writer *w, const char *path, bool again, stic_error *err)
{
  const bool standard_output = strcmp(path, "-") == 0;
  stic_status status = STIC_OK;

  w->owned = !standard_output;
  if (standard_output)
    w->fd = STDOUT_FILENO;
  else if (again)
    status = resume(w, path, err);
  if (status != STIC_OK || (again && w->fd >= 0 && (!standard_output || w->kind == STIC_RAW_SERIAL)))
    return status;
  w->head_due = true;
  if (!standard_output)
    w->fd = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  return w->fd < 0 ? cannot_write(path, err) : STIC_OK;
}

stic_status stic_raw_create(const char *path, stic_raw_kind kind, const stic_raw_device *device, bool again,
                            stic_raw_writer **writer, stic_error *err)
{
  stic_raw_writer *w = calloc(1, sizeof *w);
  stic_status status;

  assert((kind == STIC_RAW_HID) == (device != NULL));
  *writer = NULL;
  if (!w)
    return stic_error_set(err, STIC_NO_MEMORY, path, 0, "out of memory");
  w->fd = -1;
  w->kind = kind;
  if (device)
    w->about = *device;
  snprintf(w->path, sizeof w->path, "%s", strcmp(path, "-") == 0 ? "standard output" : path);
  status = begin_writer(w, path, again, err);
  if (status != STIC_OK)
    stic_raw_finish(w, NULL);
  else
    *writer = w;
  return status;
}

stic_status stic_raw_write(stic_raw_writer *w, int device, int64_t t_ns, const uint8_t *bytes, size_t length,
                           stic_error *err)
{
  size_t n;

  assert(length >= 1 && length <= STIC_RAW_BYTES_MAX && device >= 0 && device < STIC_RAW_DEVICES_MAX);
  if (w->head_due) {
    const stic_status status = write_head(w, err);

    if (status != STIC_OK)
      return status;
  }
  if (w->kind == STIC_RAW_SERIAL) {
    n = stic_format_integer(t_ns, w->line);
  } else {
    int64_t us;

    if (device != w->device) {
      const stic_status status = write_text(w, err, "D: %d", device);

      if (status != STIC_OK)
        return status;
      w->device = device;
    }
    if (!w->begun) {
      const stic_status status = write_text(w, err, CLOCK_MARK "%lld", (long long)t_ns);

      if (status != STIC_OK)
        return status;
      w->start_ns = t_ns;
    }
    w->begun = true;
    us = (t_ns - w->start_ns) / US;
    n = (size_t)snprintf(w->line, sizeof w->line, "E: %06lld.%06lld %zu", (long long)(us / 1000000),
                         (long long)(us % 1000000), length);
  }
  n += put_bytes(bytes, length, w->line + n);
  return write_line(w, n, err);
}

stic_status stic_raw_finish(stic_raw_writer *writer, stic_error *err)
{
  stic_status status = STIC_OK;

  if (!writer)
    return STIC_OK;
  if (writer->owned && writer->fd >= 0 && close(writer->fd) != 0)
    status = stic_error_set(err, STIC_CANNOT_WRITE, writer->path, 0, "cannot write: %s", strerror(errno));
  free(writer);
  return status;
}

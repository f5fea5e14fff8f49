#include "error.h"

#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const char *stic_version(void)
{
  return STIC_VERSION;
}

static void one_line(char *text)
{
  for (; *text; text++) {
    if ((unsigned char)*text < 0x20 || *text == 0x7f)
      *text = '?';
  }
}

stic_status(stic_error_set)(stic_error *err, stic_status status, const char *file, int64_t line,
                            const char *format, ...)
{
  va_list args;

  if (!err)
    return status;
  err->status = status;
  err->line = line;
  snprintf(err->file, sizeof err->file, "%s", file ? file : "");
  one_line(err->file);
  va_start(args, format);
  vsnprintf(err->message, sizeof err->message, format, args);
  va_end(args);
  one_line(err->message);
  return status;
}

const char *stic_error_quote(const char *text, size_t length, char *out, size_t out_size)
{
  size_t kept = length;

  assert(out_size >= 8);
  if (length >= out_size)
    kept = out_size - 4;
  memcpy(out, text, kept);
  out[kept] = '\0';
  for (size_t i = 0; i < kept; i++) {
    if (!out[i])
      out[i] = '?';
  }
  one_line(out);
  if (kept < length) {
    /* Not in the middle of a UTF-8 character. */
    while (kept > 0 && ((unsigned char)text[kept] & 0xc0) == 0x80)
      kept--;
    memcpy(out + kept, "...", 4);
  }
  return out;
}

void stic_error_format(const stic_error *err, char *out, size_t out_size)
{
  assert(err && out && out_size > 0);
  if (err->file[0] && err->line > 0)
    snprintf(out, out_size, "%s:%lld: %s", err->file, (long long)err->line, err->message);
  else if (err->file[0])
    snprintf(out, out_size, "%s: %s", err->file, err->message);
  else
    snprintf(out, out_size, "%s", err->message);
}

const char *stic_state_name(stic_state state)
{
  static const char *const names[] = {"released", "free", "vertex", "edge", "two-vertex", "corner", "multi"};

  assert((unsigned)state < sizeof names / sizeof names[0]);
  return names[state];
}

const char *stic_event_name(stic_event_kind kind)
{
  static const char *const names[] = {"touch", "open", "slip", "snap", "take", "release"};

  assert((unsigned)kind < sizeof names / sizeof names[0]);
  return names[kind];
}

const char *stic_precision_name(stic_precision precision)
{
  static const char *const names[] = {"f32", "f64", "f80"};

  assert((unsigned)precision < sizeof names / sizeof names[0]);
  return names[precision];
}

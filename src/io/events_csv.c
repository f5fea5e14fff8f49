#include "events_csv.h"

#include "format.h"

#include <string.h>

#define ROW_MAX 256

void stic_events_begin(stic_outfile *out)
{
  stic_outfile_print(out, STIC_EVENTS_FORMAT "\n" STIC_EVENTS_HEADER "\n");
}

static char *put_index(char *at, int index)
{
  *at++ = ',';
  return index < 0 ? at : at + stic_format_integer(index, at);
}

static char *put_double(char *at, double value)
{
  *at++ = ',';
  return at + stic_format_double(value, at);
}

static size_t row_text(const stic_event *event, char *text)
{
  const char *name = stic_event_name(event->kind);
  char *at = text + stic_format_double(event->t, text);

  *at++ = ',';
  memcpy(at, name, strlen(name));
  at += strlen(name);
  at = put_index(at, event->vertex);
  at = put_index(at, event->surface);
  at = put_double(at, event->x);
  at = put_double(at, event->y);
  at = put_double(at, event->length);
  *at++ = '\n';
  return (size_t)(at - text);
}

void stic_events_rows(stic_outfile *out, const stic_event *events, int count)
{
  for (int i = 0; i < count; i++)
    stic_outfile_used(out, row_text(&events[i], stic_outfile_reserve(out, ROW_MAX)));
}

/* Events as CSV ("# stiction-events 1"): t,event,vertex,surface,x,y,length. */
#ifndef STIC_EVENTS_CSV_H
#define STIC_EVENTS_CSV_H

#include "../stiction.h"
#include "outfile.h"

#define STIC_EVENTS_FORMAT "# stiction-events 1"
#define STIC_EVENTS_HEADER "t,event,vertex,surface,x,y,length"

/* Writes the format line and the column header. */
void stic_events_begin(stic_outfile *out);

/* Appends rows; vertex and surface are empty where none is meant. Failures show in the outfile. */
void stic_events_rows(stic_outfile *out, const stic_event *events, int count);

#endif

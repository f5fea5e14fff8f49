/* Who is compared, how each is set up, and the search that found those settings. */
#ifndef PEER_FIELD_H
#define PEER_FIELD_H

#include "contest.h"

#define PEER_ENGINES 5
#define PEER_CONTESTANTS (2 + 3 * PEER_ENGINES)

/* stiction at levels event and frame, then of each engine in this build three settings. Returns how many. */
int peer_field(peer_contestant out[PEER_CONTESTANTS]);
/* Prints a line for each engine that this build lacks. */
void peer_field_missing(void);

/* Looks for better settings of those contestants whose name begins with `only` and prints what it finds. Minutes. */
stic_status peer_field_tune(const char *only, const peer_scene scenes[PEER_SCENES], stic_error *err);

#endif

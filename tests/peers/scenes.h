/* The motions that all contestants make, and what is measured on each. */
#ifndef PEER_SCENES_H
#define PEER_SCENES_H

#include "../../src/cli/bench/trade.h"

typedef struct peer_scene {
  const char *name, *about;
  stic_motion motion;
  stic_outcome reference; /* level event, f80 */
  bool *held;             /* per sample: whether the hand has the object */
  int rest_row;           /* from here on the object must not move: 0: no such row */
  double onset;           /* m the hand has gone from x = 0 when the first slip is due, else 0 */
} peer_scene;

/* How far the object has gone from where it was at rest_row when its first slip counts as begun: m. */
#define PEER_ONSET_SEEN 5e-6

#define PEER_SCENES 12

/* Fills `scenes`; those that hold still do so for `hold` seconds. On failure as far as it got; free in either case. */
stic_status peer_scenes_make(peer_scene scenes[PEER_SCENES], double hold, stic_error *err);
void peer_scenes_free(peer_scene scenes[PEER_SCENES]);

#endif

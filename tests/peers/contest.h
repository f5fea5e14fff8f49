/* One contestant on one scene. */
#ifndef PEER_CONTEST_H
#define PEER_CONTEST_H

#include "peer.h"
#include "scenes.h"

typedef struct peer_contestant {
  char name[64];
  const peer_engine *engine; /* NULL: stiction with `settings` */
  peer_tuning tuning;
  stic_settings settings;
} peer_contestant;

typedef struct peer_score {
  stic_difference difference;
  double
    onset; /* relative error of the hand's way to the first slip; NaN: the scene has none, or none came */
  double creep;                /* m/s over the first 10 s at rest; NaN: the scene has no rest */
  double drift;                /* m from there to the end */
  int64_t median_ns, worst_ns; /* of samples; each counts with its fastest run */
} peer_score;

/* One run more of a contestant, adding its times to `outcome` (start with all zero). `*onset` is set where the scene
 * has one. STIC_FAILED: the engine refuses the scene. */
stic_status peer_contest_run(const peer_contestant *who, const peer_scene *scene, stic_outcome *outcome,
                             double *onset, stic_error *err);
void peer_contest_score(const peer_scene *scene, const stic_outcome *outcome, double onset,
                        peer_score *score);

#endif

/* Collision detection: which of the object's vertices are near which surfaces. Detection only; where and when
 * they touch is solved in closed form by the statics core [5]. */
#ifndef STIC_COLLIDE_H
#define STIC_COLLIDE_H

#include <stdint.h>

#include "stiction.h"

typedef struct stic_collider stic_collider;

/* For the scene's object and `count` of its surfaces; answers are in their order. By ODE: one geom for the
 * object, one per surface; else the gaps are computed here. All lengths are taken in units of `unit`, so that the
 * arithmetic sees the same numbers at every scale. NULL if memory runs out. Real-time: no. */
stic_collider *stic_collider_create(const stic_scene *scene, double unit, const int *surfaces, int count,
                                    bool by_ode);
void stic_collider_destroy(stic_collider *collider); /* NULL allowed */

/* The vertices that are, at this pose, within `reach` of a surface (m, >= 0), or deeper than it.
 * gaps[i] is the gap of the body's origin to surface i (m), cosine and sine those of the body's angle.
 * Writes one bit per vertex into masks[s] for each surface and returns the number of surfaces with any.
 * Never leaves a near one out; may name one that is up to 1e-6 farther. Real-time: yes. */
int stic_collide_near(stic_collider *collider, const double *gaps, double cosine, double sine, double reach,
                      uint64_t *masks);

/* Nanoseconds spent in stic_collide_near() since the last call with the clock on (stic_sim_time_stages). */
void stic_collider_clock(stic_collider *collider, bool on);
int64_t stic_collider_take_ns(stic_collider *collider);

#endif

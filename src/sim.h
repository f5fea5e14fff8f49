/* Inside of the simulation: what its last step took, and which parts of the model it leaves out because its scene cannot need them. Results are
 * the same to the last bit (`iterations` counts what was done); tests prove it and `stiction bench speed` shows what
 * each part costs.
 *
 * Not left out, as it saves nothing that can be measured: surfaces out of the hand's reach (the list of near pairs
 * does that already), wedging where no cones face each other (asked once per contact set), jumps where mu_s = mu_d,
 * friction where there is none, the rotational spring where k_theta = 0 (a multiplication each). */
#ifndef STIC_SIM_H
#define STIC_SIM_H

#include "statics/core.h"

/* Parts to leave out, where the scene allows it. */
enum {
  STIC_LEAVE_HIDDEN = 1, /* surfaces that lie behind others: never touched (needs.c); f64 and f80 */
  STIC_LEAVE_ODE = 2,    /* ODE's collision detection: the gaps of convex vertices to planes need none */
  STIC_LEAVE_NONE = 0,   /* the full model */
  STIC_LEAVE_ALL = 3     /* what stic_sim_create() does */
};

/* As stic_sim_create(), with a choice of what is left out. Real-time: no. */
stic_status stic_sim_create_parts(const stic_scene *scene, const stic_settings *settings, unsigned leave_out,
                                  stic_sim **sim, stic_error *err);

/* Of the last step; valid until the next one. Real-time: yes. */
const stic_core_report *stic_sim_report(const stic_sim *sim);

#endif

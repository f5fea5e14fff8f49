/* Rule 4, for the few cases in which no contact set can go on alone: the viscous flow
 * k_p dg/ds = net force, k_theta dtheta/ds = net moment about g, to the next event or to rest. */
#include "statics.h"

static bool viscous_flow(core *c) {
  (void)c;
  return false;
}

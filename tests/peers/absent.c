/* The engines that this build does without. */
#include "peer.h"

#ifdef PEER_WITHOUT_ODE
const peer_engine *const peer_ode = NULL;
#endif
#ifdef PEER_WITHOUT_CHIPMUNK
const peer_engine *const peer_chipmunk = NULL;
#endif
#ifdef PEER_WITHOUT_BULLET
const peer_engine *const peer_bullet = NULL;
#endif
#ifdef PEER_WITHOUT_BOX2D
const peer_engine *const peer_box2d = NULL;
#endif
#ifdef PEER_WITHOUT_MUJOCO
const peer_engine *const peer_mujoco = NULL;
#endif

#include "hydra_mode.h"

#define SECOND INT64_C(1000000000)
#define LISTEN_NS (1 * SECOND)
#define SWITCH_NS (5 * SECOND) /* what the device may take to switch */
#define COMMANDS_MAX 4

void stic_hydra_mode_start(stic_hydra_mode *mode, int64_t now_ns)
{
  mode->deadline_ns = now_ns + LISTEN_NS;
  mode->commands = 0;
}

void stic_hydra_mode_heard(stic_hydra_mode *mode, int64_t now_ns)
{
  stic_hydra_mode_start(mode, now_ns);
}

stic_hydra_step stic_hydra_mode_next(stic_hydra_mode *mode, int64_t now_ns)
{
  if (now_ns < mode->deadline_ns)
    return STIC_HYDRA_WAIT;
  if (mode->commands == COMMANDS_MAX)
    return STIC_HYDRA_GIVE_UP;
  mode->commands++;
  mode->deadline_ns = now_ns + SWITCH_NS;
  return STIC_HYDRA_COMMAND;
}

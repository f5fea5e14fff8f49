/* When to tell a Hydra to send motion: it powers up as a gamepad. Pure: time is given. */
#ifndef STIC_HYDRA_MODE_H
#define STIC_HYDRA_MODE_H

#include <stdbool.h>
#include <stdint.h>

typedef enum stic_hydra_step {
  STIC_HYDRA_WAIT,    /* nothing to do before `deadline_ns` */
  STIC_HYDRA_COMMAND, /* send the motion command now */
  STIC_HYDRA_GIVE_UP  /* it answers no command */
} stic_hydra_step;

typedef struct stic_hydra_mode {
  int64_t deadline_ns; /* on the caller's clock */
  int commands;        /* sent since the last motion report */
} stic_hydra_mode;

/* Listens for a second first: it may send motion already. Real-time: yes. */
void stic_hydra_mode_start(stic_hydra_mode *mode, int64_t now_ns);

/* A motion report came. Real-time: yes. */
void stic_hydra_mode_heard(stic_hydra_mode *mode, int64_t now_ns);

/* What to do now; counts the command that it asks for, after which the device has 5 s. Real-time: yes. */
stic_hydra_step stic_hydra_mode_next(stic_hydra_mode *mode, int64_t now_ns);

#endif

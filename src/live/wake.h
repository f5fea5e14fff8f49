/* One thread wakes another, and neither can hold the other up: a pipe that never blocks. Internal. */
#ifndef STIC_WAKE_H
#define STIC_WAKE_H

#include "../stiction.h"

typedef struct stic_wake {
  int ends[2]; /* to read, to write */
} stic_wake;

/* STIC_NO_MEMORY without file descriptors. Real-time: no. */
stic_status stic_wake_create(stic_wake *wake, stic_error *err);
void stic_wake_destroy(stic_wake *wake);

/* Any thread or signal handler; several before the other wakes are one. Real-time: yes. */
void stic_wake_send(const stic_wake *wake);

/* Waits until it is sent, until `until_ns` (CLOCK_MONOTONIC; INT64_MAX: for ever), or a signal that the thread
 * takes: false without a sending. What was sent before counts. One thread only. Real-time: yes. */
bool stic_wake_wait(const stic_wake *wake, int64_t until_ns);

#endif

/* The one clock of timing and pacing, and one that others on the machine do not move. Internal. */
#ifndef STIC_CLOCK_H
#define STIC_CLOCK_H

#include <stdint.h>
#include <time.h>

/* Now, ns of CLOCK_MONOTONIC. Real-time: yes. */
static inline int64_t stic_clock_ns(void)
{
  struct timespec now;

  clock_gettime(CLOCK_MONOTONIC, &now);
  return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

/* This thread's own computing, ns: for measurements on a machine that does other things too. Reading it costs about
 * as much as a small step. Real-time: no. */
static inline int64_t stic_clock_thread_ns(void)
{
  struct timespec now;

  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

#endif

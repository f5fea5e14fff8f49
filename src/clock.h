/* The one clock of timing and pacing. Internal. */
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

#endif

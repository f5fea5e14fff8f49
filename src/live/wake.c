#include "wake.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/select.h>
#include <unistd.h>

#include "../clock.h"
#include "../error.h"

#define NS_PER_S 1000000000

static bool set_up(int fd)
{
  errno = EMFILE; /* too many for select() */
  return fd < FD_SETSIZE && fcntl(fd, F_SETFL, O_NONBLOCK) == 0 && fcntl(fd, F_SETFD, FD_CLOEXEC) == 0;
}

stic_status stic_wake_create(stic_wake *w, stic_error *err)
{
  w->ends[0] = w->ends[1] = -1;
  if (pipe(w->ends) == 0 && set_up(w->ends[0]) && set_up(w->ends[1]))
    return STIC_OK;
  stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "no pipe between threads: %s", strerror(errno));
  stic_wake_destroy(w);
  return STIC_NO_MEMORY;
}

void stic_wake_destroy(stic_wake *w)
{
  for (int i = 0; i < 2; i++) {
    if (w->ends[i] >= 0)
      close(w->ends[i]);
    w->ends[i] = -1;
  }
}

void stic_wake_send(const stic_wake *w)
{
  /* A pipe that is full wakes as well as one with a byte more. */
  const ssize_t n = write(w->ends[1], "", 1);

  (void)n;
}

bool stic_wake_wait(const stic_wake *w, int64_t until_ns)
{
  const int64_t left_ns = until_ns == INT64_MAX ? 0 : until_ns - stic_clock_ns();
  struct timespec left = {0, 0};
  fd_set ready;
  char taken[64];

  if (left_ns > 0) {
    left.tv_sec = (time_t)(left_ns / NS_PER_S);
    left.tv_nsec = (long)(left_ns % NS_PER_S);
  }
  FD_ZERO(&ready);
  FD_SET(w->ends[0], &ready);
  /* poll() knows whole milliseconds only. */
  if (pselect(w->ends[0] + 1, &ready, NULL, NULL, until_ns == INT64_MAX ? NULL : &left, NULL) <= 0)
    return false;
  while (read(w->ends[0], taken, sizeof taken) == (ssize_t)sizeof taken)
    ;
  return true;
}

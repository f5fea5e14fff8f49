#include "tty.h"

#include "../../src/error.h"
#include "../../src/io/timing.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#define WAIT_MAX_MS 60000

static stic_status refuse(const char *path, const char *what, int problem, stic_error *err)
{
  const char *hint = "";

  if (problem == EACCES)
    hint =
      "; serial ports belong to a group: see ls -l on the port, then 'usermod -aG GROUP USER' and a new login";
  else if (problem == EBUSY)
    hint = "; another program has it open";
  else if (problem == ENOTTY)
    hint = "; expected a serial port";
  return stic_error_set(err, STIC_NO_DEVICE, path, 0, "%s: %s%s", what, strerror(problem), hint);
}

static bool is_as_wanted(const struct termios *t, speed_t speed)
{
  return cfgetispeed(t) == speed && cfgetospeed(t) == speed && (t->c_cflag & CSIZE) == CS8 &&
         !(t->c_cflag & (PARENB | CSTOPB)) && (t->c_cflag & CREAD) &&
         !(t->c_lflag & (ICANON | ECHO | ISIG)) && !(t->c_iflag & (IXON | IXOFF | ICRNL | INLCR | ISTRIP)) &&
         !(t->c_oflag & OPOST);
}

/* All flags from nothing, so that no flow control or translation is left from before. */
static stic_status set_raw(stic_tty *tty, const char *path, speed_t speed, stic_error *err)
{
  struct termios t = tty->found;

  t.c_iflag = IGNBRK;
  t.c_oflag = 0;
  t.c_lflag = 0;
  t.c_cflag = CS8 | CREAD | CLOCAL;
  /* With VMIN 0 a read() of nothing would give 0, which must mean a hang-up. */
  t.c_cc[VMIN] = 1;
  t.c_cc[VTIME] = 0;
  if (cfsetispeed(&t, speed) != 0 || cfsetospeed(&t, speed) != 0 || tcsetattr(tty->fd, TCSANOW, &t) != 0 ||
      tcgetattr(tty->fd, &t) != 0)
    return refuse(path, "cannot set up the serial port", errno, err);
  if (!is_as_wanted(&t, speed))
    return stic_error_set(
      err, STIC_NO_DEVICE, path, 0,
      "the serial port does not take the speed or format; expected 8 data bits, no parity, "
      "1 stop bit");
  return STIC_OK;
}

stic_status stic_tty_open(stic_tty *tty, const char *path, speed_t speed, stic_error *err)
{
  stic_status status;

  tty->fd = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (tty->fd < 0)
    return refuse(path, "cannot open", errno, err);
  if (tcgetattr(tty->fd, &tty->found) != 0) {
    status = refuse(path, "cannot use", errno, err);
    close(tty->fd);
    return status;
  }
  /* Two readers would each get a part of the bytes. Ports that cannot be locked are used all the same. */
  (void)ioctl(tty->fd, TIOCEXCL);
  status = set_raw(tty, path, speed, err);
  if (status != STIC_OK)
    stic_tty_close(tty);
  else
    tcflush(tty->fd, TCIOFLUSH);
  return status;
}

void stic_tty_close(stic_tty *tty)
{
  tcdrain(tty->fd);
  tcsetattr(tty->fd, TCSANOW, &tty->found);
  (void)ioctl(tty->fd, TIOCNXCL);
  close(tty->fd);
  tty->fd = -1;
}

int stic_tty_read(stic_tty *tty, uint8_t *bytes, size_t size)
{
  size_t used = 0;

  while (used < size) {
    const ssize_t n = read(tty->fd, bytes + used, size - used);

    if (n > 0) {
      used += (size_t)n;
    } else if (n < 0 && errno == EINTR) {
      continue;
    } else if (n < 0 && errno == EAGAIN) {
      break;
    } else {
      /* The end of the file, EIO or ENXIO: unplugged. What came before it still counts. */
      return used > 0 ? (int)used : -1;
    }
  }
  return (int)used;
}

bool stic_tty_write(stic_tty *tty, const uint8_t *bytes, size_t length)
{
  while (length > 0) {
    const ssize_t n = write(tty->fd, bytes, length);

    if (n < 0 && errno == EINTR)
      continue;
    if (n <= 0)
      return false;
    bytes += n;
    length -= (size_t)n;
  }
  return true;
}

bool stic_tty_set_line(stic_tty *tty, stic_tty_line line, bool on)
{
  const int bit = line == STIC_TTY_DTR ? TIOCM_DTR : TIOCM_RTS;

  return ioctl(tty->fd, on ? TIOCMBIS : TIOCMBIC, &bit) == 0;
}

int stic_tty_cts(const stic_tty *tty)
{
  int bits;

  if (ioctl(tty->fd, TIOCMGET, &bits) != 0)
    return -1;
  return (bits & TIOCM_CTS) != 0;
}

bool stic_tty_wait(const stic_tty *tty, int64_t until_ns)
{
  struct pollfd port = {tty->fd, POLLIN, 0};
  const int64_t left_ns = until_ns - stic_clock_ns();
  int64_t left_ms = left_ns > 0 ? (left_ns + 999999) / 1000000 : 0;

  if (left_ms > WAIT_MAX_MS)
    left_ms = WAIT_MAX_MS;
  return poll(&port, 1, (int)left_ms) >= 0;
}

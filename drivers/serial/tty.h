/* A serial port for trackers: raw bytes, 8 data bits, no parity, 1 stop bit, no flow control; never blocks. */
#ifndef STIC_TTY_H
#define STIC_TTY_H

#include "../../src/stiction.h"

#include <termios.h>

typedef struct stic_tty {
  int fd;
  struct termios found; /* settings before ours, put back on close */
} stic_tty;

typedef enum stic_tty_line { STIC_TTY_DTR, STIC_TTY_RTS } stic_tty_line;

/* Opens `path` for us alone, sets it up and reads the settings back, since a driver may silently take
 * others. `speed` is one of termios.h, e.g. B19200. Errors: STIC_NO_DEVICE (absent, no permission, in
 * use, no serial port, cannot do the format). Real-time: no. */
stic_status stic_tty_open(stic_tty *tty, const char *path, speed_t speed, stic_error *err);

/* Waits until what was written is out (a few bytes), restores the port and closes it. Real-time: no. */
void stic_tty_close(stic_tty *tty);

/* Takes what is there: its number of bytes, 0 if nothing, -1 if the port is gone. Real-time: yes. */
int stic_tty_read(stic_tty *tty, uint8_t *bytes, size_t size);

/* Whether all bytes were taken for sending. Meant for commands of a few bytes. Real-time: yes. */
bool stic_tty_write(stic_tty *tty, const uint8_t *bytes, size_t length);

/* Sets a modem line; false where there are none (pseudo terminals, some adapters). Real-time: yes. */
bool stic_tty_set_line(stic_tty *tty, stic_tty_line line, bool on);

/* The other side's CTS: 1, 0, or -1 where it cannot be known. Real-time: yes. */
int stic_tty_cts(const stic_tty *tty);

/* Waits for input or a hang-up until `until_ns` (CLOCK_MONOTONIC, to 1 ms). False if a signal came
 * first. Real-time: yes. */
bool stic_tty_wait(const stic_tty *tty, int64_t until_ns);

#endif

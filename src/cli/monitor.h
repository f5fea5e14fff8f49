/* What `stiction monitor` knows of a tracker, and its picture in characters. No I/O. */
#ifndef STIC_MONITOR_H
#define STIC_MONITOR_H

#include "../../drivers/driver.h"

#define STIC_MONITOR_TIMES 512  /* samples that rate and jitter are judged by, at most */
#define STIC_MONITOR_TRAIL 2048 /* points */
#define STIC_MONITOR_COLUMNS_MIN 40
#define STIC_MONITOR_ROWS_MIN 12
#define STIC_MONITOR_COLUMNS_MAX 200
#define STIC_MONITOR_ROWS_MAX 70
#define STIC_MONITOR_PAGE_MAX 65536 /* bytes of a page */

typedef struct stic_monitor {
  char device[300];  /* its description */
  char message[300]; /* the last change of the connection that is worth a word; "" none */
  stic_connection state;
  stic_device_counters counters;
  int64_t started_ns, now_ns; /* CLOCK_MONOTONIC */
  size_t raw_length;          /* 0: not shown */
  uint8_t raw[STIC_RAW_SHOWN_MAX];
  /* Below: from the samples. */
  bool begun;
  stic_device_sample sample; /* the last one, in the room */
  uint32_t bits;             /* its buttons as the device numbers them */
  double speed;              /* m/s, between the last two */
  int64_t times[STIC_MONITOR_TIMES];
  int64_t count; /* of samples */
  float trail[STIC_MONITOR_TRAIL][3];
  int64_t trail_count, trail_ns;
  double low[3], high[3]; /* of the trail, m */
} stic_monitor;

/* Takes a sample in; `bits` are its buttons before the tracker's map. All zero is a monitor that has seen nothing. */
void stic_monitor_add(stic_monitor *monitor, const stic_device_sample *sample, uint32_t bits);

/* Forgets trail, rate and pose. */
void stic_monitor_reset(stic_monitor *monitor);

typedef struct stic_monitor_look {
  int columns, rows; /* of the terminal; cut to the limits above */
  bool unicode, colour;
} stic_monitor_look;

/* The whole page with its escape sequences, which overwrites the last one; its length. `out` holds
 * STIC_MONITOR_PAGE_MAX bytes. */
size_t stic_monitor_page(const stic_monitor *monitor, const stic_monitor_look *look, char *out);

/* One line of plain text with its end; its length. */
size_t stic_monitor_line(const stic_monitor *monitor, char *out, size_t out_size);

#endif

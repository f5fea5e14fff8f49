/* Files of poses by other programs, read pose by pose:
 *
 *   TUM     "timestamp tx ty tz qx qy qz qw" with blanks between, seconds and m; lines that start with # are comments
 *   EuRoC   CSV "timestamp,px,py,pz,qw,qx,qy,qz[,...]", whole ns and m; lines that start with # are comments; columns
 *           beyond the eighth (velocities, biases) are not read */
#ifndef STIC_POSE_FILE_H
#define STIC_POSE_FILE_H

#include "../stiction.h"

typedef enum stic_pose_format { STIC_POSE_TUM, STIC_POSE_EUROC } stic_pose_format;

typedef struct stic_pose_options {
  bool lenient; /* default false; true: bad lines are passed over */
  /* Told about each line passed over (an error) and about a dropped last line (a warning); may be NULL. */
  void (*report)(void *context, bool warning, const stic_error *problem);
  void *context;
} stic_pose_options;

typedef enum stic_pose_status {
  STIC_POSE_READ,
  STIC_POSE_END,
  STIC_POSE_WAIT, /* interrupted by a signal, or a slow pipe; ask again */
  STIC_POSE_BAD   /* `*err` is set; the reader can only be closed */
} stic_pose_status;

typedef struct stic_pose_reader stic_pose_reader;

/* Opens a file, "-" for standard input. `options` may be NULL. The caller owns `*reader`. Errors: STIC_BAD_INPUT,
 * STIC_NO_MEMORY. Real-time: no. */
stic_status stic_pose_open(const char *path, stic_pose_format format, const stic_pose_options *options,
                           stic_pose_reader **reader, stic_error *err);
void stic_pose_close(stic_pose_reader *reader); /* NULL allowed */

/* The next pose: times exact in whole ns and strictly increasing, the quaternion brought to norm 1 from within 1 % of it;
 * no buttons. A file without any pose is bad. A last line without its end may be cut within a number and is dropped, as
 * in a trace. At most one read() in a call. Real-time: no. */
stic_pose_status stic_pose_next(stic_pose_reader *reader, stic_sample *pose, stic_error *err);

/* Tells the format of a file by its first line that is no comment: false if it looks like neither. Real-time: no. */
bool stic_pose_recognize(const char *line, size_t length, stic_pose_format *format);

#endif

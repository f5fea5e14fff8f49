/* Pose files of other programs, TUM and EuRoC, strict and lenient: what is read is in order of time, of norm 1. */
#include "memory_file.h"

#include "io/pose_file.h"

#include <math.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void on_problem(void *context, bool warning, const stic_error *problem)
{
  bool *skipped = context;

  require(problem->message[0]);
  *skipped |= !warning;
}

static void read_all(const char *path, stic_pose_format format, bool lenient)
{
  bool skipped = false;
  const stic_pose_options options = {lenient, on_problem, &skipped};
  stic_pose_reader *reader;
  stic_pose_status status;
  stic_sample pose;
  stic_error err;
  int64_t last_ns = INT64_MIN;

  require(stic_pose_open(path, format, &options, &reader, &err) == STIC_OK);
  while ((status = stic_pose_next(reader, &pose, &err)) == STIC_POSE_READ || status == STIC_POSE_WAIT) {
    double norm = 0;

    if (status == STIC_POSE_WAIT)
      continue;
    for (int i = 0; i < 3; i++)
      require(isfinite(pose.position[i]));
    for (int i = 0; i < 4; i++)
      norm += pose.orientation[i] * pose.orientation[i];
    require(fabs(norm - 1) < 1e-12 && pose.t_ns > last_ns && pose.buttons == 0);
    last_ns = pose.t_ns;
  }
  require(status == STIC_POSE_END || err.message[0]);
  require(lenient || !skipped);
  stic_pose_close(reader);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  static memory_file file;
  const char *path = memory_file_write(&file, data, size);
  stic_pose_format format;

  stic_pose_recognize((const char *)data, size, &format);
  for (int i = 0; i < 4; i++)
    read_all(path, i & 1 ? STIC_POSE_TUM : STIC_POSE_EUROC, i > 1);
  return 0;
}

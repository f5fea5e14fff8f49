/* Tracker sections. With any settings that are read, any sample keeps a unit quaternion and stays finite. */
#include "memory_file.h"

#include "../../drivers/motion/tracker_yaml.h"

#include <math.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check_motion(const stic_tracker_settings *settings, stic_driver_kind kind)
{
  stic_tracker tracker;

  stic_tracker_begin(&tracker, settings, kind);
  for (int i = 0; i < 8; i++) {
    stic_device_sample s;
    double norm = 0;

    memset(&s, 0, sizeof s);
    s.t_ns = 1000000000 + i * 16000000;
    s.position[0] = 0.1 * i, s.position[1] = -2, s.position[2] = 30;
    s.orientation[i % 4] = 1;
    s.velocity[1] = i - 4, s.turn_rate[2] = 100;
    s.buttons = i & 1 ? ~0u : 0;
    s.flags = STIC_SAMPLE_POSITION | STIC_SAMPLE_ORIENTATION | STIC_SAMPLE_TRACKED | STIC_SAMPLE_VELOCITY;
    stic_tracker_apply(&tracker, &s);
    for (int k = 0; k < 4; k++)
      norm += s.orientation[k] * s.orientation[k];
    require(fabs(norm - 1) < 1e-9);
    for (int k = 0; k < 3; k++)
      require(isfinite(s.position[k]));
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  static memory_file file;
  const char *path = memory_file_write(&file, data, size);
  stic_tracker_settings settings;
  stic_error err;

  for (int required = 0; required < 2; required++) {
    if (stic_tracker_read(path, NULL, required, &settings, &err) != STIC_OK) {
      require(err.message[0] != '\0');
      continue;
    }
    check_motion(&settings, STIC_DRIVER_POSE);
    check_motion(&settings, STIC_DRIVER_RATE);
  }
  return 0;
}

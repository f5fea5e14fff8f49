#include "tracker_frame.h"

#include "quaternion.h"

#include <math.h>
#include <string.h>

#define ROTATION_TOLERANCE 1e-6

void stic_tracker_frame_init(stic_tracker_frame *frame)
{
  memset(frame, 0, sizeof *frame);
  for (int i = 0; i < 3; i++) {
    frame->axes[4 * i] = frame->hand_axes[4 * i] = 1;
    frame->buttons[i] = i;
  }
  frame->scale = 1;
}

static void rotate(const double m[9], double factor, const double add[3], double v[3])
{
  double out[3];

  for (int i = 0; i < 3; i++)
    out[i] = factor * (m[3 * i] * v[0] + m[3 * i + 1] * v[1] + m[3 * i + 2] * v[2]) + add[i];
  memcpy(v, out, sizeof out);
}

static uint32_t map_buttons(const stic_tracker_frame *frame, uint32_t buttons)
{
  uint32_t mapped = 0;

  for (int i = 0; i < STIC_TRACKER_BUTTONS; i++) {
    if (frame->buttons[i] >= 0)
      mapped |= (buttons >> frame->buttons[i] & 1) << i;
  }
  return mapped;
}

void stic_tracker_frame_apply(const stic_tracker_frame *frame, stic_device_sample *sample)
{
  static const double none[3] = {0, 0, 0};
  double axes[4], hand[4];

  rotate(frame->axes, frame->scale, frame->offset, sample->position);
  rotate(frame->axes, frame->scale, none, sample->velocity);
  rotate(frame->axes, 1, none, sample->turn_rate);
  stic_quaternion_from_matrix(frame->axes, axes);
  stic_quaternion_from_matrix(frame->hand_axes, hand);
  stic_quaternion_multiply(axes, sample->orientation, sample->orientation);
  stic_quaternion_multiply(sample->orientation, hand, sample->orientation);
  stic_quaternion_normalize(sample->orientation);
  sample->buttons = map_buttons(frame, sample->buttons);
}

bool stic_is_proper_rotation(const double m[9])
{
  const double determinant = m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
                             m[2] * (m[3] * m[7] - m[4] * m[6]);

  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      const double dot = m[3 * i] * m[3 * j] + m[3 * i + 1] * m[3 * j + 1] + m[3 * i + 2] * m[3 * j + 2];

      if (!(fabs(dot - (i == j)) <= ROTATION_TOLERANCE))
        return false;
    }
  }
  return determinant > 0;
}

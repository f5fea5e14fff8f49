#include "mouse_hand.h"

#include "../../src/angle.h"

#include <math.h>
#include <string.h>

#define LEVEL 0.05 /* a ray that falls less than this per unit of depth says nothing about depth */

/* Where the ray has the coordinate `axis` that the hand has. */
static double ray_share(const stic_mouse_hand *h, const double eye[3], const double through[3], int axis)
{
  return (h->position[axis] - eye[axis]) / (through[axis] - eye[axis]);
}

void stic_mouse_hand_point(stic_mouse_hand *h, const double eye[3], const double through[3])
{
  const double share = ray_share(h, eye, through, 2);

  for (int k = 0; k < 2; k++)
    h->position[k] = eye[k] + share * (through[k] - eye[k]);
}

void stic_mouse_hand_slide(stic_mouse_hand *h, const double eye[3], const double through[3], double most)
{
  const double down = eye[1] - through[1], ahead = eye[2] - through[2];
  double share, z;

  if (fabs(down) < LEVEL * fabs(ahead))
    return;
  share = ray_share(h, eye, through, 1);
  z = eye[2] + share * (through[2] - eye[2]);
  h->position[2] += fmin(fmax(z - h->position[2], -most), most);
  stic_mouse_hand_point(h, eye, through);
}

void stic_mouse_hand_turn(stic_mouse_hand *h, double notches, bool fine)
{
  h->angle += STIC_RAD_PER_DEG * (fine ? STIC_MOUSE_FINE_TURN_DEG : STIC_MOUSE_TURN_DEG) * notches;
}

void stic_mouse_hand_push(stic_mouse_hand *h, double notches, double size)
{
  h->position[2] -= STIC_MOUSE_DEPTH_SIZES * size * notches;
}

void stic_mouse_hand_sample(const stic_mouse_hand *h, stic_device_sample *sample)
{
  memset(sample, 0, sizeof *sample);
  memcpy(sample->position, h->position, sizeof sample->position);
  sample->orientation[2] = sin(h->angle / 2);
  sample->orientation[3] = cos(h->angle / 2);
  sample->buttons = h->buttons;
  sample->flags = STIC_SAMPLE_POSITION | STIC_SAMPLE_ORIENTATION | STIC_SAMPLE_TRACKED;
}

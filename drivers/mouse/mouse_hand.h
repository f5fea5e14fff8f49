/* What pointer, wheel and buttons make of a hand. No window, no I/O: who has the window says where the pointer is
 * in the scene. */
#ifndef STIC_MOUSE_HAND_H
#define STIC_MOUSE_HAND_H

#include "../driver.h"

#define STIC_MOUSE_TURN_DEG 2.0       /* a notch of the wheel */
#define STIC_MOUSE_FINE_TURN_DEG 0.25 /* a notch while turning finely */
#define STIC_MOUSE_DEPTH_SIZES 0.02   /* object sizes a notch */

/* The pose in the scene and what is pressed. */
typedef struct stic_mouse_hand {
  double position[3]; /* m */
  double angle;       /* rad, about z */
  uint32_t buttons;   /* STIC_BUTTON_GRIP */
} stic_mouse_hand;

/* Brings the hand under the pointer: onto the ray from the eye through a point, keeping its depth. m. All functions
 * are pure. Real-time: yes. */
void stic_mouse_hand_point(stic_mouse_hand *hand, const double eye[3], const double through[3]);
/* The same, but it keeps its height and moves in depth, by at most `most` (m), and not at all where the ray is nearly
 * level. */
void stic_mouse_hand_slide(stic_mouse_hand *hand, const double eye[3], const double through[3], double most);
/* Positive notches (the wheel away from the user) turn counter-clockwise. */
void stic_mouse_hand_turn(stic_mouse_hand *hand, double notches, bool fine);
/* Positive notches push it away from the user, along -z; `size` is the object's, m. */
void stic_mouse_hand_push(stic_mouse_hand *hand, double notches, double size);

/* The hand as a sample; time and sequence stay to be set. */
void stic_mouse_hand_sample(const stic_mouse_hand *hand, stic_device_sample *sample);

#endif

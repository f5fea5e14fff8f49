/* Pointer and wheel in the live view, for those who have no tracker. The window feeds it from another thread. */
#ifndef STIC_MOUSE_DRIVER_H
#define STIC_MOUSE_DRIVER_H

#include "mouse_hand.h"

extern const stic_driver stic_mouse_driver;

/* Says where the hand is now; wakes the poll(). `device` is one of this driver's. One thread feeds, one other
 * polls. False if too much waits already: it is dropped and counted as an overrun, the next one says it all.
 * Real-time: yes. */
bool stic_mouse_feed(stic_device *device, const stic_mouse_hand *hand);

#endif

/* Logitech ultrasonic 3D mouse and head tracker over RS-232: logitech:port=/dev/ttyS0[,head][,raw=F]. */
#ifndef STIC_LOGITECH_DRIVER_H
#define STIC_LOGITECH_DRIVER_H

#include "../driver.h"

extern const stic_driver stic_logitech_driver;

#endif

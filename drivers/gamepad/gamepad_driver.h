/* DualSense gamepad: its sticks give velocities. gamepad[:path=,serial=,speed=,turn=] */
#ifndef STIC_GAMEPAD_DRIVER_H
#define STIC_GAMEPAD_DRIVER_H

#include "../hid/hid.h"

extern const stic_driver stic_gamepad_driver;

/* The driver's open() over another transport, which must outlive the device. */
stic_status stic_gamepad_open(const stic_hid_transport *transport, const stic_device_spec *spec,
                              stic_device **device, stic_error *err);

#endif

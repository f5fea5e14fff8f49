/* Razer Hydra: the position and orientation of a wand. hydra[:hand=left|right,path=,serial=] */
#ifndef STIC_HYDRA_DRIVER_H
#define STIC_HYDRA_DRIVER_H

#include "../hid/hid.h"

extern const stic_driver stic_hydra_driver;

/* The driver's open() over another transport, which must outlive the device. */
stic_status stic_hydra_open(const stic_hid_transport *transport, const stic_device_spec *spec,
                            stic_device **device, stic_error *err);

#endif

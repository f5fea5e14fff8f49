/* A driver to be copied: sample[:rate=HZ], a hand that draws a circle. See drivers/README.md. */
#ifndef STIC_SAMPLE_DRIVER_H
#define STIC_SAMPLE_DRIVER_H

#include "../driver.h"

extern const stic_driver stic_sample_driver;

#endif

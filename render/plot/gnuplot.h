/* Running gnuplot. */
#ifndef STIC_GNUPLOT_H
#define STIC_GNUPLOT_H

#include "../../src/stiction.h"

/* Runs `gnuplot SCRIPT` in a folder with the variable `format` set, and waits. STIC_USAGE if there is no
 * gnuplot, STIC_CANNOT_WRITE with its first words if it fails. */
stic_status stic_gnuplot_run(const char *folder, const char *script, const char *format, stic_error *err);

#endif

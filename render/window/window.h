/* Loads the module that opens a window when one is wanted: the program starts without it. */
#ifndef STIC_WINDOW_H
#define STIC_WINDOW_H

#include "window_module.h"

/* True if this build can open windows. */
bool stic_window_available(void);

/* The module's functions; `*library` is its handle for stic_window_unload(). STIC_USAGE for a build without
 * SDL. */
stic_status stic_window_load(const stic_window_module **module, void **library, stic_error *err);
void stic_window_unload(void *library); /* NULL allowed */

#endif

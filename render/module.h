/* Parts of the program that are loaded only when they are wanted, for they bring many shared libraries along. */
#ifndef STIC_MODULE_H
#define STIC_MODULE_H

/* Loads `file` (beside the program while it is in its build folder, else where it was installed: both are in its
 * run path) and gives its one symbol, a table that starts with an int: NULL unless that is `version`, for a module
 * of another build is not used. `*library` is the handle for stic_module_unload(), NULL on failure. */
const void *stic_module_load(const char *file, const char *symbol, int version, void **library);
void stic_module_unload(void *library); /* NULL allowed */

#endif

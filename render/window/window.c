#include "window.h"

#include "error.h"
#include "module.h"

bool stic_window_available(void)
{
  const stic_window_module *module;
  void *library;
  const bool available = stic_window_load(&module, &library, NULL) == STIC_OK;

  stic_window_unload(library);
  return available;
}

stic_status stic_window_load(const stic_window_module **module, void **library, stic_error *err)
{
  *library = NULL;
#if defined(STIC_WITH_SDL)
  *module = stic_module_load(STIC_WINDOW_MODULE_FILE, "stic_window_sdl", STIC_WINDOW_MODULE, library);
#else
  *module = NULL;
#endif
  return *module
           ? STIC_OK
           : stic_error_set(err, STIC_USAGE, NULL, 0,
                            "this build cannot open a window: it was made without SDL, or its module is "
                            "missing");
}

void stic_window_unload(void *library)
{
  stic_module_unload(library);
}

#include "module.h"

#include <dlfcn.h>
#include <stddef.h>

const void *stic_module_load(const char *file, const char *symbol, int version, void **library)
{
  const void *table;

  *library = dlopen(file, RTLD_NOW | RTLD_LOCAL);
  table = *library ? dlsym(*library, symbol) : NULL;
  if (table && *(const int *)table == version)
    return table;
  stic_module_unload(*library);
  *library = NULL;
  return NULL;
}

/* Not under the address sanitizer: leaks of libraries could not be told from ours by name. */
void stic_module_unload(void *library)
{
#ifdef __SANITIZE_ADDRESS__
  (void)library;
#else
  if (library)
    dlclose(library);
#endif
}

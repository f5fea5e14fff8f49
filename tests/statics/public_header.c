/* The public header alone, as a user's C99 or C++ compiler sees it. */
#include "stiction.h"

int public_header_compiles(void);
int public_header_compiles(void)
{
  return (int)STIC_OK;
}

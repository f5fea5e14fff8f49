/* The heat maps of `stiction bench extremes`, by gnuplot. */
#include "../error.h"
#include "extremes.h"

stic_status stic_heat_picture(const char *path, const stic_heat_map *maps, int count, int columns,
                              stic_error *err)
{
  (void)path, (void)maps, (void)count, (void)columns;
  return stic_error_set(err, STIC_USAGE, NULL, 0, "not yet");
}

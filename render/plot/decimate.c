#include "decimate.h"

#include <math.h>
#include <string.h>

static void keep_extremes(const double *v, int64_t from, int64_t to, bool *keep)
{
  int64_t low = from, high = from;

  for (int64_t i = from; i < to; i++) {
    if (isnan(v[low]) || v[i] < v[low])
      low = i;
    if (isnan(v[high]) || v[i] > v[high])
      high = i;
  }
  keep[from] = keep[to - 1] = keep[low] = keep[high] = true;
}

static int64_t count_true(const bool *flags, int64_t count)
{
  int64_t n = 0;

  for (int64_t i = 0; i < count; i++)
    n += flags[i];
  return n;
}

void stic_decimate(const double *v, const bool *jump, int64_t count, bool *keep)
{
  const int64_t jumps = count_true(jump, count);
  const bool keep_jumps = 4 * jumps <= STIC_CURVE_POINTS; /* then two points each are at most half of all */
  const int64_t parts = (STIC_CURVE_POINTS - (keep_jumps ? 2 * jumps : 0)) / 4;

  if (count <= STIC_CURVE_POINTS) {
    memset(keep, true, (size_t)count * sizeof *keep);
    return;
  }
  memset(keep, false, (size_t)count * sizeof *keep);
  for (int64_t k = 0; k < parts; k++)
    keep_extremes(v, count * k / parts, count * (k + 1) / parts, keep);
  for (int64_t i = 1; i < count; i++) {
    if ((keep_jumps && jump[i]) || isnan(v[i]) != isnan(v[i - 1]))
      keep[i] = keep[i - 1] = true;
  }
}

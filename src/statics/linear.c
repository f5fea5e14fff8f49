/* Small systems of linear equations. */
#include "statics.h"

/* Solves n equations in place by Gauss and Jordan with pivoting: m has rows of `width` numbers, of which the first n
 * are the matrix and the next one the right side, which becomes the solution. False if a pivot is not above
 * `smallest`: singular. */
static bool solve_linear(int n, int width, real *m, real smallest)
{
  for (int k = 0; k < n; k++) {
    real *row = m + k * width, *pivot = row;
    for (int i = k + 1; i < n; i++)
      if (r_abs(m[i * width + k]) > r_abs(pivot[k]))
        pivot = m + i * width;
    if (r_abs(pivot[k]) <= smallest)
      return false;
    for (int j = k; j <= n; j++) {
      real swap = row[j];
      row[j] = pivot[j];
      pivot[j] = swap;
    }
    for (int i = 0; i < n; i++) {
      real *other = m + i * width, factor = i == k ? 0 : other[k] / row[k];
      for (int j = k; factor != 0 && j <= n; j++)
        other[j] -= factor * row[j];
    }
  }
  for (int k = 0; k < n; k++)
    m[k * width + n] /= m[k * width + k];
  return true;
}

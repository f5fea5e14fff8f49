/* Thinning curves for print without changing how they look. */
#ifndef STIC_DECIMATE_H
#define STIC_DECIMATE_H

#include <stdbool.h>
#include <stdint.h>

/* Most points of a curve after thinning, about. */
#define STIC_CURVE_POINTS 2000

/* Marks in keep[0..count) the points that a curve needs. Each of a few hundred stretches of equal length keeps
 * its first, lowest, highest and last point, so that a line drawn through them covers the same dots; the two
 * ends of a jump (`jump[i]`: between i - 1 and i) are kept too while they are not too many for that. Gaps
 * (NaN) keep their edges. All is kept if there are no more than STIC_CURVE_POINTS. */
void stic_decimate(const double *values, const bool *jump, int64_t count, bool *keep);

#endif

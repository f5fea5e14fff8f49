#include "quaternion.h"

#include <math.h>
#include <string.h>

void stic_quaternion_multiply(const double a[4], const double b[4], double out[4])
{
  const double x = a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1];
  const double y = a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0];
  const double z = a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3];
  const double w = a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2];

  out[0] = x;
  out[1] = y;
  out[2] = z;
  out[3] = w;
}

void stic_quaternion_normalize(double q[4])
{
  static const double identity[4] = {0, 0, 0, 1};
  const double norm = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);

  if (!(norm > 0) || !isfinite(norm)) {
    memcpy(q, identity, sizeof identity);
    return;
  }
  for (int i = 0; i < 4; i++)
    q[i] /= norm;
}

void stic_quaternion_from_turn(const double v[3], double out[4])
{
  const double angle = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  /* sin(a/2)/a tends to 1/2: no division by a tiny angle. */
  const double factor = angle > 1e-8 ? sin(angle / 2) / angle : 0.5;

  for (int i = 0; i < 3; i++)
    out[i] = factor * v[i];
  out[3] = cos(angle / 2);
}

void stic_quaternion_to_turn(const double q[4], double v[3])
{
  const double sine = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
  const double sign = q[3] < 0 ? -1 : 1;
  const double factor = sine > 1e-8 ? 2 * atan2(sine, sign * q[3]) / sine : 2;

  for (int i = 0; i < 3; i++)
    v[i] = sign * factor * q[i];
}

void stic_quaternion_from_matrix(const double m[9], double out[4])
{
  const double trace = m[0] + m[4] + m[8];
  int i = 0;

  /* From the largest component, which is at least 1/2. */
  if (m[4] > m[0])
    i = 1;
  if (m[8] > m[4 * i])
    i = 2;
  if (trace > m[4 * i]) {
    out[3] = 1 + trace;
    out[0] = m[7] - m[5];
    out[1] = m[2] - m[6];
    out[2] = m[3] - m[1];
  } else {
    const int j = (i + 1) % 3, k = (i + 2) % 3;

    out[i] = 1 + 2 * m[4 * i] - trace;
    out[j] = m[3 * j + i] + m[3 * i + j];
    out[k] = m[3 * k + i] + m[3 * i + k];
    out[3] = m[3 * k + j] - m[3 * j + k];
  }
  if (out[3] < 0) {
    for (int c = 0; c < 4; c++)
      out[c] = -out[c];
  }
  stic_quaternion_normalize(out);
}

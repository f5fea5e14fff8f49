#include "format.h"

#include <math.h>
#include <stdio.h>

size_t stic_format_double(double value, char *out)
{
  if (value == 0 && !signbit(value)) {
    *out = '0'; /* the most frequent number in a log */
    return 1;
  }
  return (size_t)snprintf(out, 26, "%.17g", value);
}

static size_t put_digits(uint64_t value, int least, char *out)
{
  char reversed[20];
  size_t n = 0;

  do {
    reversed[n++] = (char)('0' + value % 10);
    value /= 10;
  } while (value > 0 || n < (size_t)least);
  for (size_t i = 0; i < n; i++)
    out[i] = reversed[n - 1 - i];
  return n;
}

static uint64_t magnitude(int64_t value)
{
  return value < 0 ? 0 - (uint64_t)value : (uint64_t)value;
}

size_t stic_format_integer(int64_t value, char *out)
{
  const size_t sign = value < 0;

  if (sign)
    *out = '-';
  return sign + put_digits(magnitude(value), 1, out + sign);
}

size_t stic_format_seconds(int64_t t_ns, char *out)
{
  const uint64_t ns = magnitude(t_ns);
  size_t n = t_ns < 0;

  if (n)
    *out = '-';
  n += put_digits(ns / 1000000000u, 1, out + n);
  out[n++] = '.';
  return n + put_digits(ns % 1000000000u, 9, out + n);
}

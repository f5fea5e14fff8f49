#include "number.h"

#include <float.h>
#include <inttypes.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A decimal taken apart: (-1)^negative * digits * 10^exponent. */
typedef struct decimal {
  bool negative;
  bool cut; /* more than 19 digits: `digits` holds the first 19 significant ones */
  int kept; /* significant digits in `digits` */
  uint64_t digits;
  int64_t exponent;
  int next_digit; /* the first that was cut, for rounding */
} decimal;

#define DIGITS_MAX 19 /* always fit into 64 bits */
#define EXPONENT_CAP 100000
#define DIGITS_NEEDED 768

static bool is_digit(char c)
{
  return c >= '0' && c <= '9';
}

static void take_digit(decimal *d, char c, bool after_point)
{
  const int digit = c - '0';

  if (d->kept == 0 && digit == 0) {
    d->exponent -= after_point;
  } else if (d->kept < DIGITS_MAX) {
    d->digits = d->digits * 10 + (uint64_t)digit;
    d->kept++;
    d->exponent -= after_point;
  } else {
    if (!d->cut)
      d->next_digit = digit;
    d->cut = true;
    d->exponent += !after_point;
  }
}

/* Returns the position after the exponent's digits, or NULL. */
static const char *take_exponent(decimal *d, const char *at, const char *end)
{
  bool negative = false;
  int64_t exponent = 0;

  if (at < end && (*at == '+' || *at == '-'))
    negative = *at++ == '-';
  if (at == end || !is_digit(*at))
    return NULL;
  for (; at < end && is_digit(*at); at++) {
    if (exponent < EXPONENT_CAP)
      exponent = exponent * 10 + (*at - '0');
  }
  d->exponent += negative ? -exponent : exponent;
  return at;
}

static bool take_apart(const char *text, size_t length, decimal *d)
{
  const char *at = text, *const end = text + length;
  const char *whole;
  size_t whole_digits, fraction_digits = 0;

  memset(d, 0, sizeof *d);
  if (at < end && (*at == '+' || *at == '-'))
    d->negative = *at++ == '-';
  whole = at;
  for (; at < end && is_digit(*at); at++)
    take_digit(d, *at, false);
  whole_digits = (size_t)(at - whole);
  if (whole_digits > 1 && *whole == '0')
    return false; /* octal to some readers of YAML, decimal to others */
  if (at < end && *at == '.') {
    for (at++; at < end && is_digit(*at); at++, fraction_digits++)
      take_digit(d, *at, true);
  }
  if (whole_digits + fraction_digits == 0)
    return false;
  if (at < end && (*at == 'e' || *at == 'E')) {
    at = take_exponent(d, at + 1, end);
    if (!at)
      return false;
  }
  return at == end;
}

/* The same decimal in few characters: of the digits beyond DIGITS_NEEDED only matters whether one is not 0, as the middle
 * between two doubles never has more than 767 significant ones. */
static void shorten(const decimal *d, const char *text, size_t length, char *out)
{
  const char *const end = text + length;
  int kept = 0;
  bool rest = false;

  *out++ = d->negative ? '-' : '+';
  *out++ = '.';
  for (const char *at = text; at < end && *at != 'e' && *at != 'E'; at++) {
    if (!is_digit(*at) || (kept == 0 && *at == '0'))
      continue;
    if (kept < DIGITS_NEEDED) {
      *out++ = *at;
      kept++;
    } else {
      rest = rest || *at != '0';
    }
  }
  sprintf(out, "%de%" PRId64, rest, d->exponent + d->kept);
}

/* The C library's conversion, with a point as the decimal sign whatever the caller's locale. */
static bool parse_slowly(const decimal *d, const char *text, size_t length, double *value)
{
  char copy[DIGITS_NEEDED + 32];
  const locale_t c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0); /* takes no memory */
  locale_t before;

  if (c_locale == (locale_t)0)
    return false;
  shorten(d, text, length, copy);
  before = uselocale(c_locale);
  *value = strtod(copy, NULL);
  uselocale(before);
  freelocale(c_locale);
  return true;
}

stic_number_status stic_number_parse(const char *text, size_t length, double *value)
{
  static const double power[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  decimal d;
  double v;

  if (!take_apart(text, length, &d))
    return STIC_NUMBER_NOT_PLAIN;
  if (FLT_EVAL_METHOD == 0 && !d.cut && d.digits <= (UINT64_C(1) << 53) && d.exponent >= -22 &&
      d.exponent <= 22) {
    /* Both factors are exact doubles, so one operation rounds correctly (Clinger). */
    v = (double)d.digits;
    v = d.exponent < 0 ? v / power[-d.exponent] : v * power[d.exponent];
    v = d.negative ? -v : v;
  } else if (!parse_slowly(&d, text, length, &v)) {
    return STIC_NUMBER_NOT_PLAIN;
  }
  if (!isfinite(v))
    return STIC_NUMBER_TOO_LARGE;
  *value = v;
  return STIC_NUMBER_OK;
}

stic_number_status stic_number_parse_ns(const char *text, size_t length, int64_t *ns)
{
  decimal d;
  uint64_t value;
  int64_t shift;
  bool round_up;

  if (!take_apart(text, length, &d))
    return STIC_NUMBER_NOT_PLAIN;
  value = d.digits;
  shift = d.exponent + 9;
  round_up = shift == 0 && d.cut && d.next_digit >= 5;
  if (shift > 0 && d.cut)
    return STIC_NUMBER_TOO_LARGE;
  for (; shift > 0 && value > 0; shift--) {
    if (value > UINT64_MAX / 10)
      return STIC_NUMBER_TOO_LARGE;
    value *= 10;
  }
  for (; shift < 0 && value > 0; shift++) {
    round_up = shift == -1 && value % 10 >= 5;
    value /= 10;
  }
  value += round_up && shift == 0;
  if (value > (uint64_t)INT64_MAX)
    return STIC_NUMBER_TOO_LARGE;
  *ns = d.negative ? -(int64_t)value : (int64_t)value;
  return STIC_NUMBER_OK;
}

stic_number_status stic_number_parse_integer(const char *text, size_t length, int64_t low, int64_t high,
                                             int64_t *value)
{
  const char *at = text, *const end = text + length;
  bool negative = false;
  int64_t v = 0;

  if (low < 0 && at < end && *at == '-') {
    negative = true;
    at++;
  }
  if (at == end)
    return STIC_NUMBER_NOT_PLAIN;
  for (const char *c = at; c < end; c++) {
    if (!is_digit(*c))
      return STIC_NUMBER_NOT_PLAIN;
  }
  for (; at < end; at++) {
    if (v > (INT64_MAX - 9) / 10)
      return STIC_NUMBER_TOO_LARGE;
    v = v * 10 + (*at - '0');
  }
  v = negative ? -v : v;
  if (v < low || v > high)
    return STIC_NUMBER_TOO_LARGE;
  *value = v;
  return STIC_NUMBER_OK;
}

const char *stic_number_range_text(double low, double high, bool above_low, const char *unit, char *out,
                                   size_t out_size)
{
  const char *space = unit[0] ? " " : "";

  if (low == -high)
    snprintf(out, out_size, "within +-%g%s%s", high, space, unit);
  else
    snprintf(out, out_size, "%s %g and <= %g%s%s", above_low ? ">" : ">=", low, high, space, unit);
  return out;
}

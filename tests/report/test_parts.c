/* Thinning of curves, SHA-256 and text for pages, each against what is known. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "decimate.h"
#include "page.h"
#include "../../src/io/sha256.h"

#define COUNT 100000

static int64_t kept(const bool *keep, int64_t count)
{
  int64_t n = 0;

  for (int64_t i = 0; i < count; i++)
    n += keep[i];
  return n;
}

/* A slow curve with sudden steps: both ends of each step stay, and the curve through the rest covers it. */
static void test_steps_survive(void **state)
{
  double *v = malloc(COUNT * sizeof *v);
  bool *jump = calloc(COUNT, sizeof *jump), *keep = malloc(COUNT * sizeof *keep);

  (void)state;
  for (int i = 0; i < COUNT; i++) {
    jump[i] = i % 997 == 500;
    v[i] = sin(i * 1e-4) + i / 997 * 0.1 + (i % 997 >= 500 ? 0.05 : 0);
  }
  v[12345] = 9; /* one wild row */
  stic_decimate(v, jump, COUNT, keep);
  assert_true(keep[0] && keep[COUNT - 1] && keep[12345]);
  for (int i = 1; i < COUNT; i++) {
    if (jump[i])
      assert_true(keep[i] && keep[i - 1]);
  }
  assert_true(kept(keep, COUNT) <= 2200);
  free(v);
  free(jump);
  free(keep);
}

/* With a jump in every row they cannot all stay, but highest and lowest do. */
static void test_many_steps(void **state)
{
  double *v = malloc(COUNT * sizeof *v);
  bool *jump = malloc(COUNT * sizeof *jump), *keep = malloc(COUNT * sizeof *keep);

  (void)state;
  for (int i = 0; i < COUNT; i++) {
    jump[i] = true;
    v[i] = i % 2;
  }
  stic_decimate(v, jump, COUNT, keep);
  assert_in_range(kept(keep, COUNT), 1000, 2000);
  free(v);
  free(jump);
  free(keep);
}

static void test_gaps_and_short_curves(void **state)
{
  double v[5000];
  bool jump[5000] = {false}, keep[5000];

  (void)state;
  for (int i = 0; i < 5000; i++)
    v[i] = i >= 1000 && i < 4000 ? NAN : (double)i;
  stic_decimate(v, jump, 5000, keep);
  assert_true(keep[999] && keep[1000] && keep[3999] && keep[4000]);
  stic_decimate(v, jump, STIC_CURVE_POINTS, keep);
  assert_int_equal(kept(keep, STIC_CURVE_POINTS), STIC_CURVE_POINTS);
}

/* FIPS 180-4's examples. */
static void test_sha256(void **state)
{
  static const char two_blocks[] = "abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq";
  char text[STIC_SHA256_TEXT];
  stic_sha256 sha;

  (void)state;
  stic_sha256_begin(&sha);
  stic_sha256_end(&sha, text);
  assert_string_equal(text, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  stic_sha256_begin(&sha);
  stic_sha256_add(&sha, "abc", 3);
  stic_sha256_end(&sha, text);
  assert_string_equal(text, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  stic_sha256_begin(&sha);
  for (size_t i = 0; i < sizeof two_blocks - 1; i += 7)
    stic_sha256_add(&sha, two_blocks + i, 7);
  stic_sha256_end(&sha, text);
  assert_string_equal(text, "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

static void check_clean(const char *in, const char *out)
{
  char *clean = stic_utf8_clean(in, strlen(in));

  assert_string_equal(clean, out);
  free(clean);
}

static void test_utf8(void **state)
{
  (void)state;
  check_clean("plain \xc3\xa4 \xe2\x82\xac \xf0\x9f\x99\x82", "plain \xc3\xa4 \xe2\x82\xac \xf0\x9f\x99\x82");
  check_clean("\xff", "\xef\xbf\xbd");
  check_clean("a\xc3", "a\xef\xbf\xbd");
  check_clean("\xc0\x80", "\xef\xbf\xbd\xef\xbf\xbd");                 /* too long a form */
  check_clean("\xed\xa0\x80", "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd"); /* half of a surrogate pair */
  check_clean("\xf4\x90\x80\x80", "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd"); /* beyond U+10FFFF */
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_steps_survive),
    cmocka_unit_test(test_many_steps),
    cmocka_unit_test(test_gaps_and_short_curves),
    cmocka_unit_test(test_sha256),
    cmocka_unit_test(test_utf8),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Outputs that appear whole or not at all. */
#include "help.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/outfile.h"

static void write_some(stic_outfile *out, int count)
{
  for (int i = 0; i < count; i++)
    stic_outfile_print(out, "line %d\n", i);
}

static void test_commit_and_abort(void **state)
{
  const char *path = stic_test_write("a.txt", "old");
  stic_outfile *out;
  char *text;

  (void)state;
  assert_int_equal(stic_outfile_open(path, &out, NULL), STIC_OK);
  write_some(out, 100000);
  text = stic_test_read(path);
  assert_string_equal(text, "old");
  free(text);
  stic_outfile_abort(out);
  text = stic_test_read(path);
  assert_string_equal(text, "old");
  free(text);
  assert_int_equal(stic_test_count_entries(".tmp"), 0);

  assert_int_equal(chmod(path, 0640), 0);
  assert_int_equal(stic_outfile_open(path, &out, NULL), STIC_OK);
  write_some(out, 100000);
  assert_int_equal(stic_outfile_commit(out, NULL), STIC_OK);
  text = stic_test_read(path);
  assert_int_equal(strlen(text), 1088890);
  stic_test_contains(text, "line 99999\n");
  free(text);
  {
    struct stat st;

    assert_int_equal(stat(path, &st), 0);
    assert_int_equal(st.st_mode & 0777, 0640);
  }
  assert_int_equal(stic_test_count_entries(".tmp"), 0);
}

static void test_link(void **state)
{
  const char *target = stic_test_write("target.txt", "old"), *link_path = stic_test_path("link.txt");
  stic_outfile *out;
  struct stat st;
  char *text;

  (void)state;
  assert_int_equal(symlink(target, link_path), 0);
  assert_int_equal(stic_outfile_open(link_path, &out, NULL), STIC_OK);
  stic_outfile_write(out, "new", 3);
  assert_int_equal(stic_outfile_commit(out, NULL), STIC_OK);
  assert_int_equal(lstat(link_path, &st), 0);
  assert_true(S_ISLNK(st.st_mode));
  text = stic_test_read(target);
  assert_string_equal(text, "new");
  free(text);
}

static void test_refused(void **state)
{
  static const char *const places[] = {"/nonexistent/a", "/tmp", "", "/dev/null/a"};
  stic_outfile *out;
  stic_error err;

  (void)state;
  for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
    assert_int_equal(stic_outfile_open(places[i], &out, &err), STIC_CANNOT_WRITE);
    assert_null(out);
    stic_test_contains(err.message, "cannot write: ");
  }
}

static void test_full_disk(void **state)
{
  stic_outfile *out;
  stic_error err;

  (void)state;
  assert_int_equal(stic_outfile_open("/dev/full", &out, &err), STIC_OK);
  write_some(out, 100000);
  assert_int_equal(stic_outfile_error(out), ENOSPC);
  assert_int_equal(stic_outfile_commit(out, &err), STIC_CANNOT_WRITE);
  stic_test_contains(err.message, "No space left on device");
  assert_int_equal(stic_outfile_open("/dev/null", &out, &err), STIC_OK);
  write_some(out, 10);
  assert_int_equal(stic_outfile_commit(out, &err), STIC_OK);
  assert_int_equal(access("/dev/null", W_OK), 0);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_commit_and_abort),
    cmocka_unit_test(test_link),
    cmocka_unit_test(test_refused),
    cmocka_unit_test(test_full_disk),
  };

  return cmocka_run_group_tests(tests, NULL, stic_test_clean_up);
}

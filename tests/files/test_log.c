/* Logs: what is written reads back to the same bits; wrong logs are refused. */
#include "help.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/events_csv.h"
#include "io/log_csv.h"
#include "io/timing.h"

static stic_result a_result(int i)
{
  stic_result r;

  memset(&r, 0, sizeof r);
  r.t_ns = i * INT64_C(20000001);
  r.state = (stic_state)(i % 7);
  r.x = sin(i) / 3;
  r.y = i == 0 ? -0.0 : pow(10, -i % 300);
  r.theta = i * 0.7;
  r.hand_theta = -i * 1e3;
  r.force_x = 1.0 / (i + 1);
  r.slips = i * 3;
  r.flags = (unsigned)i % 32;
  r.iterations = i;
  r.residual = 1e-17 * i;
  r.contact_count = i % 7;
  for (int c = 0; c < r.contact_count; c++) {
    const stic_contact contact = {c, i % 256, 0.1 * c, -0.1 / (i + 1), 3.3, -0.7};

    r.contacts[c] = contact;
  }
  return r;
}

static const char *write_log(int rows)
{
  const char *path = stic_test_path("log.csv");
  const stic_override set[] = {{"friction.static", "0.6\n"}};
  stic_settings settings;
  const stic_provenance provenance = {"a\nb.yaml", "trace", "t.csv", NULL, &settings, set, 1};
  stic_outfile *out;

  stic_settings_init(&settings);
  assert_int_equal(stic_outfile_open(path, &out, NULL), STIC_OK);
  stic_log_begin(out, &provenance);
  for (int i = 0; i < rows; i++) {
    const stic_result r = a_result(i);

    stic_log_row(out, &r);
  }
  assert_int_equal(stic_outfile_commit(out, NULL), STIC_OK);
  return path;
}

static void test_round_trip(void **state)
{
  const char *path = write_log(1000);
  stic_log_reader *reader;
  stic_result found;
  stic_error err;
  bool more;

  (void)state;
  assert_int_equal(stic_log_open(path, &reader, &err), STIC_OK);
  assert_string_equal(stic_log_provenance(reader, "scene", 0), "a?b.yaml");
  assert_string_equal(stic_log_provenance(reader, "accuracy", 0), "event");
  assert_string_equal(stic_log_provenance(reader, "precision", 0), "f64");
  assert_string_equal(stic_log_provenance(reader, "version", 0), STIC_VERSION);
  assert_string_equal(stic_log_provenance(reader, "set", 0), "friction.static=0.6?");
  assert_string_equal(stic_log_provenance(reader, "none", 0), "");
  for (int i = 0; i < 1000; i++) {
    stic_result expected = a_result(i);

    for (int c = STIC_LOG_CONTACTS; c < expected.contact_count; c++)
      memset(&expected.contacts[c], 0, sizeof expected.contacts[c]);
    assert_int_equal(stic_log_next(reader, &found, &more, &err), STIC_OK);
    assert_true(more);
    assert_memory_equal(&found, &expected, sizeof found);
  }
  assert_int_equal(stic_log_next(reader, &found, &more, &err), STIC_OK);
  assert_false(more);
  stic_log_close(reader);
}

static stic_status read_first_row(const char *path, stic_error *err)
{
  stic_log_reader *reader;
  stic_result r;
  bool more;
  stic_status status = stic_log_open(path, &reader, err);

  if (status != STIC_OK)
    return status;
  status = stic_log_next(reader, &r, &more, err);
  stic_log_close(reader);
  return status;
}

static void test_wrong_logs(void **state)
{
  static const stic_test_wrong wrong[] = {
    {"", 0, "the first line is ''"},
    {"t,state\n", 1, "expected '# stiction-log 1'"},
    {"# stiction-log 2\n", 1, "format version 2; expected 1"},
    {"# stiction-log 1\n", 1, "ends before its column header"},
    {"# stiction-log 1\nt,state\n", 2, "the columns are 't,state'"},
    {"# stiction-log 1\n" STIC_LOG_HEADER "\n1,free\n", 3, "found 2 fields; expected 42"},
    {"# stiction-log 1\n" STIC_LOG_HEADER "\n1,fre,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,,,,,,,,,,,,,,,,,,,,,,,,\n",
     3, "column 2 is 'fre'"},
    {"# stiction-log 1\n" STIC_LOG_HEADER
     "\n1,free,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,1,,,,,,,,,,,,,,,,,,,,,,,,\n",
     3, "column 19 is ''"},
    {"# stiction-log 1\n" STIC_LOG_HEADER "\n1,free", 3, "no end"},
  };

  (void)state;
  stic_test_wrong_files(wrong, sizeof wrong / sizeof wrong[0], read_first_row);
}

static void test_events(void **state)
{
  const char *path = stic_test_path("events.csv");
  const stic_event events[] = {{0.1, STIC_EVENT_TAKE, -1, -1, 1, 2, 0},
                               {0.5, STIC_EVENT_SLIP, 3, 1, -0.25, 0, 0.125}};
  stic_outfile *out;
  char *text;

  (void)state;
  assert_int_equal(stic_outfile_open(path, &out, NULL), STIC_OK);
  stic_events_begin(out);
  stic_events_rows(out, events, 2);
  assert_int_equal(stic_outfile_commit(out, NULL), STIC_OK);
  text = stic_test_read(path);
  assert_string_equal(text, "# stiction-events 1\nt,event,vertex,surface,x,y,length\n"
                            "0.10000000000000001,take,,,1,2,0\n0.5,slip,3,1,-0.25,0,0.125\n");
  free(text);
}

/* The longest numbers that there are fit into a row. */
static void test_longest_row(void **state)
{
  char row[STIC_LOG_ROW_MAX];
  stic_result r;

  (void)state;
  memset(&r, 0, sizeof r);
  r.t_ns = INT64_MIN;
  r.state = STIC_TWO_VERTEX;
  r.x = r.y = r.z = r.theta = r.hand_x = r.hand_y = r.hand_z = r.hand_theta = -2.2250738585072014e-308;
  r.force_x = r.force_y = r.moment = r.residual = -2.2250738585072014e-308;
  r.slips = INT64_MIN;
  r.flags = UINT32_MAX;
  r.iterations = INT32_MIN;
  r.contact_count = STIC_LOG_CONTACTS;
  for (int i = 0; i < STIC_LOG_CONTACTS; i++) {
    const stic_contact c = {INT32_MIN,
                            INT32_MIN,
                            -2.2250738585072014e-308,
                            -2.2250738585072014e-308,
                            -2.2250738585072014e-308,
                            -2.2250738585072014e-308};

    r.contacts[i] = c;
  }
  assert_true(stic_log_row_text(&r, row) < STIC_LOG_ROW_MAX - 32);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_round_trip),
    cmocka_unit_test(test_wrong_logs),
    cmocka_unit_test(test_events),
    cmocka_unit_test(test_longest_row),
  };

  return cmocka_run_group_tests(tests, NULL, stic_test_clean_up);
}

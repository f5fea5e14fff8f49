/* stiction convert: pose files and raw recordings into traces, and every way in which that is refused. */
#include "../files/help.h"
#include "io/trace_csv.h"
#include "logitech_emulator.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SAMPLES 1000
#define MS INT64_C(1000000)

static const char *scene, *out;

static int set_up(void **state)
{
  static char paths[2][256];

  (void)state;
  strcpy(paths[0], stic_test_write("scene.yaml", stic_test_scene));
  strcpy(paths[1], stic_test_path("out.csv"));
  scene = paths[0];
  out = paths[1];
  return 0;
}

/* What was written; it also passes `check`. */
static int read_trace(stic_sample *samples)
{
  stic_trace_reader *reader;
  stic_trace_status status;
  stic_error err;
  int count = 0;

  expect(stic_test_program("check", scene, out, NULL), 0, "");
  assert_int_equal(stic_trace_open(out, NULL, &reader, &err), STIC_OK);
  while (count < SAMPLES && (status = stic_trace_next(reader, &samples[count], &err)) != STIC_TRACE_END) {
    assert_int_not_equal(status, STIC_TRACE_BAD);
    count += status == STIC_TRACE_SAMPLE;
  }
  stic_trace_close(reader);
  return count;
}

/* ---- pose files -------------------------------------------------------------------------- */

static void test_tum(void **state)
{
  static stic_sample s[SAMPLES];
  const char *in = stic_test_write("a.tum", "# timestamp tx ty tz qx qy qz qw\r\n"
                                            "1305031102.175304001  0.5 -1 2e-1 0 0 0 1\r\n"
                                            "#\n"
                                            "1305031102.2753040014\t1 2 3 0.6004 0 0 0.7999\n");

  (void)state;
  expect(stic_test_program("convert", in, out, NULL), 0, "2 samples, 0 with the grip pressed");
  assert_int_equal(read_trace(s), 2);
  assert_int_equal(s[0].t_ns, 0);
  assert_int_equal(s[1].t_ns, 100000000); /* exact, though no double holds these times */
  assert_true(s[0].position[0] == 0.5 && s[0].position[1] == -1 && s[0].position[2] == 0.2);
  assert_true(fabs(hypot(s[1].orientation[0], s[1].orientation[3]) - 1) < 1e-15);
  assert_int_equal(s[0].buttons, 0);
  expect(stic_test_program("convert", "--grip", "--keep-time", "--from", "tum", in, out, NULL), 0,
         "2 with the grip");
  assert_int_equal(read_trace(s), 2);
  assert_int_equal(s[0].t_ns, INT64_C(1305031102175304001));
  assert_int_equal(s[0].buttons, STIC_BUTTON_GRIP);
}

static void test_euroc(void **state)
{
  static stic_sample s[SAMPLES];
  const char *in = stic_test_write(
    "a.csv",
    "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n"
    "1403636579763555584,4.68,-1.78,0.83,0.8,0.6,0,0,9,9,9,9,9,9,9,9,9\n"
    "1403636579763555585, 4.68, -1.78, 0.83, 1, 0, 0, 0\n");
  const char *tracker = stic_test_write("t.yaml", "stiction: 1\ntracker: {axes: [x, -z, y], scale: 2}\n");

  (void)state;
  expect(stic_test_program("convert", in, out, NULL), 0, "2 samples");
  assert_int_equal(read_trace(s), 2);
  assert_int_equal(s[1].t_ns, 1);
  assert_true(s[0].position[0] == 4.68 && s[0].position[2] == 0.83);
  assert_true(s[0].orientation[3] == 0.8 && s[0].orientation[0] == 0.6 && s[1].orientation[3] == 1);
  /* The device's x, -z, y are the room's x, y, z. */
  expect(stic_test_program("convert", "--tracker", tracker, in, out, NULL), 0, "2 samples");
  assert_int_equal(read_trace(s), 2);
  assert_true(fabs(s[0].position[0] - 9.36) < 1e-12 && fabs(s[0].position[1] + 1.66) < 1e-12 &&
              fabs(s[0].position[2] + 3.56) < 1e-12);
}

#define GOOD "1 0 0 0 0 0 0 1\n"

static void test_bad_lines(void **state)
{
  static const struct {
    const char *text, *words;
  } cases[] = {
    {GOOD "2 0 0 0 0 0 0\n", "x:2: found 7 fields; expected 8: timestamp tx"},
    {GOOD "2 0 0 0 0 0 0 1 1\n", "x:2: found 9 fields"},
    {GOOD "\n", "x:2: found 0 fields"},
    {GOOD "1.0000000001 0 0 0 0 0 0 1\n", "x:2: timestamp 1.0000000001 does not come after"},
    {GOOD "t 0 0 0 0 0 0 1\n", "x:2: timestamp is 't'; expected seconds"},
    {GOOD "2 0 nan 0 0 0 0 1\n", "x:2: ty is 'nan'; expected a plain number"},
    {GOOD "2 0 0 1e300 0 0 0 1\n", "x:2: tz is 1e+300 m"},
    {GOOD "2 0 0 0 0 0 0 0.9\n", "x:2: the quaternion's norm is 0.9"},
    {"1,0,0,0,1,0,0,0\n2,0,0,0,1,0,0\n", "x:2: found 7 fields; expected 8: timestamp,px"},
    {"1,0,0,0,1,0,0,0\n2.5,0,0,0,1,0,0,0\n", "x:2: timestamp is '2.5'; expected whole nanoseconds"},
  };

  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    const char *in = stic_test_write("x", cases[i].text);

    unlink(out);
    expect(stic_test_program("convert", in, out, NULL), 3, cases[i].words);
    assert_int_equal(access(out, F_OK), -1);
    expect(stic_test_program("convert", "--lenient", in, out, NULL), 0,
           "1 bad line passed over, the first: ");
    stic_test_contains(stic_test_program("convert", "--lenient", in, out, NULL)->err, cases[i].words);
  }
  expect(stic_test_program("convert", stic_test_write("x", GOOD "2 0 0"), out, NULL), 0,
         "x:2: the last line has no end");
}

static void test_refused(void **state)
{
  static const struct {
    const char *text;
    int code;
    const char *words;
  } cases[] = {
    {"", 3, "neither a raw recording nor a TUM or EuRoC"},
    {"hello world\n", 3, "neither a raw recording"},
    {"# stiction-trace 1\n0,0,0,0,0,0,0,1,0\n", 3, "this is a trace already"},
    {"# stiction-serial 2\n1 80\n", 3, "format version 2"},
    {"# stiction-serial 1\n1 80\n", 3, "no sample with a known pose"},
    {"D: 0\nE: 0.0 1 00\n", 3, "does not say of which device"},
    {"D: 0\nI: 3 413c 2113\nN: Keyboard\nE: 0.0 1 00\n", 3, "no driver is for the recorded device 413c:2113"},
  };
  const char *pose = stic_test_write("p", GOOD),
             *serial = stic_test_write("s", "# stiction-serial 1\n1 80\n");

  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
    expect(stic_test_program("convert", stic_test_write("x", cases[i].text), out, NULL), cases[i].code,
           cases[i].words);
  expect(stic_test_program("convert", pose, pose, NULL), 2, "is an input");
  expect(stic_test_program("convert", "--from", "csv", pose, out, NULL), 2, "expected auto, tum");
  expect(stic_test_program("convert", "-", out, NULL), 2, "expected --from");
  expect(stic_test_program("convert", "--device", "hydra", pose, out, NULL), 2,
         "--device is for raw recordings");
  expect(stic_test_program("convert", "--grip", serial, out, NULL), 2, "--grip is for pose files");
  expect(stic_test_program("convert", "--device", "hydra", serial, out, NULL), 2,
         "does not decode serial recordings");
  expect(stic_test_program("convert", "--from", "tum", "/nonexistent", out, NULL), 3, "No such file");
  expect(stic_test_program("convert", "/", out, NULL), 3, "/: cannot read: Is a directory");
  expect(stic_test_program("convert", pose, "/nonexistent/out", NULL), 5, "");
}

/* ---- recordings -------------------------------------------------------------------------- */

/* Records of a hand that stands still at 10 in, one every 20 ms, with these bits. */
static char *put_records(char *at, int64_t *t_ns, int count, unsigned bits)
{
  for (int i = 0; i < count; i++) {
    const emulator_record record = {{10000, 0, 0}, 0, 0, 0, bits};
    uint8_t bytes[EMULATOR_RECORD];

    emulator_pack(&record, bytes);
    at += sprintf(at, "%lld", (long long)*t_ns);
    for (int k = 0; k < EMULATOR_RECORD; k++)
      at += sprintf(at, " %02x", bytes[k]);
    *at++ = '\n';
    *t_ns += 20 * MS;
  }
  *at = '\0';
  return at;
}

static void test_serial(void **state)
{
  static stic_sample s[SAMPLES];
  static char text[65536] = "# stiction-serial 1\n";
  char *at = text + strlen(text);
  int64_t t_ns = 5000 * MS;

  (void)state;
  at = put_records(at, &t_ns, 10, 0);
  at = put_records(at, &t_ns, 10, 0x04);
  t_ns += 1000 * MS; /* silence: the grip is let go and counts again only once it was seen released */
  at = put_records(at, &t_ns, 10, 0x04);
  at = put_records(at, &t_ns, 10, 0x24);
  put_records(at, &t_ns, 10, 0);
  expect(stic_test_program("convert", stic_test_write("raw.txt", text), out, NULL), 0,
         "51 samples, 8 with the grip");
  assert_int_equal(read_trace(s), 51);
  assert_int_equal(s[0].t_ns, 0);
  assert_true(fabs(s[0].position[0] - 0.254) < 1e-12);
  assert_int_equal(s[11].buttons, 0);
  assert_int_equal(s[12].buttons, STIC_BUTTON_GRIP);
  assert_int_equal(s[19].buttons, STIC_BUTTON_GRIP);
  assert_true(s[20].lost && s[20].buttons == 0); /* the supervisor's own */
  assert_true(s[20].t_ns > s[19].t_ns + 60 * MS && s[20].t_ns < s[19].t_ns + 70 * MS);
  assert_true(!s[21].lost && s[21].buttons == 0 && s[31].lost && !s[50].lost);
}

static void test_hid(void **state)
{
  static stic_sample s[SAMPLES];
  static char text[65536];
  char *at = text;
  double moved;

  (void)state;
  at +=
    sprintf(at, "# by hand\nD: 0\nN: SpaceNavigator\nP: usb\nI: 3 046d c626\nE: 000000.000000 3 03 01 00\n");
  for (int i = 0; i < 100; i++) /* full deflection to the right for 1.6 s */
    at += sprintf(at, "E: %06d.%06d 7 01 5e 01 00 00 00 00\nE: %06d.%06d 7 02 00 00 00 00 00 00\n",
                  i * 16 / 1000, i * 16 % 1000 * 1000, (i * 16 + 8) / 1000, (i * 16 + 8) % 1000 * 1000);
  expect(stic_test_program("convert", stic_test_write("raw.txt", text), out, NULL), 0, "with the grip");
  assert_int_equal(read_trace(s), 201);
  moved = s[200].position[0];
  assert_true(moved > 0.35 && moved < 0.4 && s[200].position[1] == 0); /* 0.25 m/s less the dead zone */
  assert_int_equal(s[100].buttons, STIC_BUTTON_GRIP);
  expect(
    stic_test_program("convert", "--device", "spacemouse:speed=0.5", stic_test_path("raw.txt"), out, NULL), 0,
    "");
  assert_int_equal(read_trace(s), 201);
  assert_true(fabs(s[200].position[0] / moved - 2) < 0.05);
  at += sprintf(at, "E: 000002.000000 3 03 01\n");
  strcpy(at, "E: 000003.000000 3 03 00 00\n");
  expect(stic_test_program("convert", stic_test_write("raw.txt", text), out, NULL), 3,
         "raw.txt:207: found 2 bytes");
  expect(stic_test_program("convert", "--lenient", stic_test_path("raw.txt"), out, NULL), 0,
         "1 bad line passed over");
  assert_int_equal(read_trace(s), 203); /* the rest after 100 ms of silence, and the release */
  assert_int_equal(s[202].buttons, 0);
  assert_true(s[202].position[0] == s[201].position[0]);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_tum),     cmocka_unit_test(test_euroc),  cmocka_unit_test(test_bad_lines),
    cmocka_unit_test(test_refused), cmocka_unit_test(test_serial), cmocka_unit_test(test_hid),
  };

  return cmocka_run_group_tests(tests, set_up, stic_test_clean_up);
}

/* The mouse as a tracker, without a window: what is fed comes out, in order, at once, and silence keeps the grip. */
#include "../files/help.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "../../drivers/connection.h"
#include "../../drivers/mouse/mouse_driver.h"
#include "angle.h"
#include "io/timing.h"

#define SECOND_NS INT64_C(1000000000)

static stic_mouse_hand hand_at(double x, uint32_t buttons)
{
  return (stic_mouse_hand){{x, 0.2, 0.3}, 0.4, buttons};
}

static void test_feed(void **state)
{
  const int64_t begun_ns = stic_clock_ns();
  stic_device_sample samples[8];
  stic_device *device;

  (void)state;
  assert_int_equal(stic_device_open("mouse", &device, NULL), STIC_OK);
  assert_int_equal(stic_device_poll(device, 0, samples, 8), 0);
  for (int i = 0; i < 5; i++) {
    const stic_mouse_hand hand = hand_at(i, i == 2 ? STIC_BUTTON_GRIP : 0);

    assert_true(stic_mouse_feed(device, &hand));
  }
  assert_int_equal(stic_device_poll(device, 0, samples, 3), 3);
  assert_int_equal(stic_device_poll(device, 0, samples + 3, 5), 2);
  for (int i = 0; i < 5; i++) {
    const stic_device_sample *s = &samples[i];

    assert_true(s->position[0] == i && s->position[1] == 0.2 && s->position[2] == 0.3);
    assert_true(fabs(2 * atan2(s->orientation[2], s->orientation[3]) - 0.4) < 1e-15);
    assert_int_equal(s->buttons, i == 2 ? STIC_BUTTON_GRIP : 0);
    assert_int_equal(s->sequence, i);
    assert_true(s->flags == (STIC_SAMPLE_POSITION | STIC_SAMPLE_ORIENTATION | STIC_SAMPLE_TRACKED));
    assert_true(s->t_ns > (i ? samples[i - 1].t_ns : begun_ns - 1) && s->t_ns <= stic_clock_ns() + 5);
  }
  assert_int_equal(stic_device_poll(device, stic_clock_ns() + SECOND_NS / 100, samples, 8), 0);
  stic_device_close(device);
  assert_int_equal(stic_device_open("mouse:speed=2", &device, NULL), STIC_USAGE);
}

static void *feed_later(void *device)
{
  const stic_mouse_hand hand = hand_at(7, 0);

  nanosleep(&(struct timespec){0, 30000000}, NULL);
  stic_mouse_feed(device, &hand);
  return NULL;
}

/* A poll that would wait for an hour ends with the sample: the other thread wakes it. */
static void test_wakes(void **state)
{
  stic_device_sample sample;
  stic_device *device;
  pthread_t thread;

  (void)state;
  assert_int_equal(stic_device_open("mouse", &device, NULL), STIC_OK);
  for (int i = 0; i < 3; i++) {
    assert_int_equal(pthread_create(&thread, NULL, feed_later, device), 0);
    assert_int_equal(stic_device_poll(device, stic_clock_ns() + 3600 * SECOND_NS, &sample, 1), 1);
    pthread_join(thread, NULL);
  }
  stic_device_close(device);
}

static void test_overrun(void **state)
{
  const stic_mouse_hand hand = hand_at(0, 0);
  stic_device_sample samples[64];
  stic_device *device;
  int fed = 0, got = 0, n;

  (void)state;
  assert_int_equal(stic_device_open("mouse", &device, NULL), STIC_OK);
  for (int i = 0; i < 100000; i++)
    fed += stic_mouse_feed(device, &hand);
  assert_true(fed >= 1000 && fed < 100000);
  while ((n = stic_device_poll(device, 0, samples, 64)) > 0)
    got += n;
  assert_int_equal(got, fed);
  assert_int_equal(device->counters.overruns, 100000 - fed);
  assert_true(stic_mouse_feed(device, &hand));
  assert_int_equal(stic_device_poll(device, 0, samples, 64), 1);
  stic_device_close(device);
}

/* A still mouse is at rest, not gone: no sample is made up and the state stays. */
static void test_silence(void **state)
{
  const stic_mouse_hand hand = hand_at(0, STIC_BUTTON_GRIP);
  stic_device_sample sample;
  stic_supervisor *s;
  int64_t until_ns;

  (void)state;
  assert_int_equal(stic_supervisor_open("mouse", NULL, &s, NULL), STIC_OK);
  assert_true(stic_supervisor_driver(s)->in_room);
  assert_true(stic_mouse_feed(stic_supervisor_device(s), &hand));
  assert_int_equal(stic_supervisor_poll(s, 0, &sample, 1), 1);
  assert_int_equal(sample.buttons, STIC_BUTTON_GRIP);
  until_ns = stic_clock_ns() + 12 * SECOND_NS / 5; /* longer than what is lost otherwise */
  assert_int_equal(stic_supervisor_poll(s, until_ns, &sample, 1), 0);
  assert_true(stic_clock_ns() >= until_ns);
  assert_int_equal(stic_supervisor_state(s), STIC_CONNECTION_RUNNING);
  assert_true(stic_mouse_feed(stic_supervisor_device(s), &hand));
  assert_int_equal(stic_supervisor_poll(s, 0, &sample, 1), 1);
  assert_int_equal(sample.buttons, STIC_BUTTON_GRIP);
  stic_supervisor_close(s);
}

/* Turning and moving in depth, and where a ray meets the hand's plane and its level. */
static void test_hand(void **state)
{
  const double eye[3] = {1, 2, 10}, through[3] = {0.5, 0.5, 1};
  stic_mouse_hand h = hand_at(0, 0);

  (void)state;
  stic_mouse_hand_turn(&h, -3, false);
  stic_mouse_hand_turn(&h, 2, true);
  assert_true(fabs(h.angle - (0.4 - 5.5 * STIC_PI / 180)) < 1e-15);
  stic_mouse_hand_push(&h, 5, 0.5);
  assert_true(fabs(h.position[2] - (0.3 - 5 * 0.02 * 0.5)) < 1e-15);
  h.position[2] = 4; /* a third of the way from the point to the eye */
  stic_mouse_hand_point(&h, eye, through);
  assert_true(fabs(h.position[0] - 2.0 / 3) < 1e-15 && fabs(h.position[1] - 1) < 1e-15);
  assert_true(h.position[2] == 4);
  h.position[1] = 0.5;
  stic_mouse_hand_slide(&h, eye, through, 100);
  assert_true(fabs(h.position[0] - 0.5) < 1e-14 && fabs(h.position[1] - 0.5) < 1e-14);
  assert_true(fabs(h.position[2] - 1) < 1e-14);
  stic_mouse_hand_slide(&h, eye, (double[3]){0.5, 1.9, 1}, 0.25); /* nearly level */
  assert_true(fabs(h.position[2] - 1) < 1e-14);
  h.position[1] = 1;
  stic_mouse_hand_slide(&h, eye, through, 0.25);
  assert_true(fabs(h.position[2] - 1.25) < 1e-14);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_feed),    cmocka_unit_test(test_wakes), cmocka_unit_test(test_overrun),
    cmocka_unit_test(test_silence), cmocka_unit_test(test_hand),
  };

  return cmocka_run_group_tests_name("mouse", tests, NULL, NULL);
}

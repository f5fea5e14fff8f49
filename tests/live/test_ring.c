/* The queue loses and reorders nothing, the cell never shows a torn value, between two real threads. */
#include <pthread.h>
#include <sched.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "../../src/live/ring.h"

#define ITEMS 400000

typedef struct item {
  uint64_t number, inverse[7]; /* larger than what one store can write */
} item;

static void fill(item *to, uint64_t number)
{
  to->number = number;
  for (int i = 0; i < 7; i++)
    to->inverse[i] = ~number;
}

static bool is_whole(const item *it)
{
  for (int i = 0; i < 7; i++)
    if (it->inverse[i] != ~it->number)
      return false;
  return true;
}

static void *write_ring(void *context)
{
  for (uint64_t n = 0; n < ITEMS; n++) {
    item *slot;

    while (!(slot = stic_ring_slot(context)))
      sched_yield();
    fill(slot, n);
    stic_ring_put(context);
  }
  return NULL;
}

static void ring_keeps_every_item_in_order(void **state)
{
  stic_ring *ring;
  pthread_t writer;

  (void)state;
  assert_int_equal(stic_ring_create(sizeof(item), 100, &ring, NULL), STIC_OK);
  assert_int_equal(pthread_create(&writer, NULL, write_ring, ring), 0);
  for (uint64_t n = 0; n < ITEMS; n++) {
    const item *front;

    while (!(front = stic_ring_front(ring)))
      sched_yield();
    assert_true(is_whole(front));
    assert_int_equal(front->number, n);
    stic_ring_take(ring);
  }
  pthread_join(writer, NULL);
  assert_null(stic_ring_front(ring));
  assert_int_equal(stic_ring_count(ring), 0);
  assert_in_range(stic_ring_most(ring), 1, 128);
  stic_ring_destroy(ring);
}

static void ring_says_when_it_is_full(void **state)
{
  stic_ring *ring;

  (void)state;
  assert_int_equal(stic_ring_create(sizeof(item), 5, &ring, NULL), STIC_OK);
  for (uint64_t n = 0; n < 8; n++) { /* 5 made 8 */
    fill(stic_ring_slot(ring), n);
    stic_ring_put(ring);
  }
  assert_null(stic_ring_slot(ring));
  assert_int_equal(stic_ring_count(ring), 8);
  assert_int_equal(((const item *)stic_ring_front(ring))->number, 0);
  stic_ring_take(ring);
  assert_non_null(stic_ring_slot(ring));
  assert_int_equal(stic_ring_most(ring), 8);
  stic_ring_destroy(ring);
}

static void *write_latest(void *context)
{
  for (uint64_t n = 1; n <= ITEMS; n++) {
    fill(stic_latest_slot(context), n);
    stic_latest_publish(context);
  }
  return NULL;
}

static void latest_is_whole_and_never_goes_back(void **state)
{
  stic_latest *latest;
  pthread_t writer;
  uint64_t last = 0;
  bool fresh;

  (void)state;
  assert_int_equal(stic_latest_create(sizeof(item), &latest, NULL), STIC_OK);
  assert_null(stic_latest_read(latest, &fresh));
  assert_false(fresh);
  assert_int_equal(pthread_create(&writer, NULL, write_latest, latest), 0);
  while (last < ITEMS) {
    const item *now = stic_latest_read(latest, &fresh);

    if (!now)
      continue;
    assert_true(is_whole(now));
    assert_true(fresh ? now->number > last : now->number == last);
    last = now->number;
  }
  pthread_join(writer, NULL);
  stic_latest_destroy(latest);
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(ring_keeps_every_item_in_order),
                                     cmocka_unit_test(ring_says_when_it_is_full),
                                     cmocka_unit_test(latest_is_whole_and_never_goes_back)};

  return cmocka_run_group_tests_name("hand-over between threads", tests, NULL, NULL);
}

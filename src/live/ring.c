#include "ring.h"

#include <stdlib.h>
#include <string.h>

#include "../error.h"

/* Each end's own variables on cache lines of their own: the ends do not slow each other. */
#define LINE 64

struct stic_ring {
  size_t item_size, mask;
  char *items;
  char pad0[LINE];
  size_t head; /* atomic; items ever put, written by the writer */
  size_t seen_tail, most;
  char pad1[LINE];
  size_t tail; /* atomic; items ever taken, written by the reader */
  size_t seen_head;
  char pad2[LINE];
};

stic_status stic_ring_create(size_t item_size, size_t capacity, stic_ring **ring, stic_error *err)
{
  size_t count = 1;

  *ring = NULL;
  while (count < capacity && count <= SIZE_MAX / 4)
    count *= 2;
  if (count < capacity || item_size == 0 || count > SIZE_MAX / item_size ||
      !(*ring = calloc(1, sizeof **ring)))
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "no memory for a queue of %zu items", capacity);
  (*ring)->item_size = item_size;
  (*ring)->mask = count - 1;
  (*ring)->items = malloc(count * item_size);
  if (!(*ring)->items) {
    stic_ring_destroy(*ring);
    *ring = NULL;
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "no memory for a queue of %zu items", capacity);
  }
  memset((*ring)->items, 0xff, count * item_size); /* zeros would leave the pages to the first use */
  return STIC_OK;
}

void stic_ring_destroy(stic_ring *ring)
{
  if (ring)
    free(ring->items);
  free(ring);
}

void *stic_ring_slot(stic_ring *ring)
{
  if (ring->head - ring->seen_tail > ring->mask) {
    ring->seen_tail = __atomic_load_n(&ring->tail, __ATOMIC_ACQUIRE);
    if (ring->head - ring->seen_tail > ring->mask)
      return NULL;
  }
  return ring->items + (ring->head & ring->mask) * ring->item_size;
}

void stic_ring_put(stic_ring *ring)
{
  const size_t head = ring->head + 1;

  if (head - ring->seen_tail > ring->most) {
    ring->seen_tail = __atomic_load_n(&ring->tail, __ATOMIC_ACQUIRE);
    if (head - ring->seen_tail > ring->most)
      __atomic_store_n(&ring->most, head - ring->seen_tail, __ATOMIC_RELAXED);
  }
  __atomic_store_n(&ring->head, head, __ATOMIC_RELEASE);
}

const void *stic_ring_front(stic_ring *ring)
{
  if (ring->tail == ring->seen_head) {
    ring->seen_head = __atomic_load_n(&ring->head, __ATOMIC_ACQUIRE);
    if (ring->tail == ring->seen_head)
      return NULL;
  }
  return ring->items + (ring->tail & ring->mask) * ring->item_size;
}

void stic_ring_take(stic_ring *ring)
{
  __atomic_store_n(&ring->tail, ring->tail + 1, __ATOMIC_RELEASE);
}

size_t stic_ring_count(const stic_ring *ring)
{
  const size_t tail = __atomic_load_n(&ring->tail, __ATOMIC_ACQUIRE); /* first: never below zero */

  return __atomic_load_n(&ring->head, __ATOMIC_ACQUIRE) - tail;
}

size_t stic_ring_most(const stic_ring *ring)
{
  return __atomic_load_n(&ring->most, __ATOMIC_RELAXED);
}

/* ---- cell: three places, one the writer's, one the reader's, one between them --------------- */

#define FRESH 4u /* in `between`: published and not yet read */

struct stic_latest {
  size_t size;
  char *places;
  unsigned between; /* atomic: index of a place, plus FRESH */
  char pad0[LINE];
  unsigned writing;
  char pad1[LINE];
  unsigned reading;
  bool any;
  char pad2[LINE];
};

stic_status stic_latest_create(size_t size, stic_latest **latest, stic_error *err)
{
  *latest = calloc(1, sizeof **latest);
  if (*latest && size > 0 && size < SIZE_MAX / 3)
    (*latest)->places = malloc(3 * size);
  if (!*latest || !(*latest)->places) {
    stic_latest_destroy(*latest);
    *latest = NULL;
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "no memory for %zu bytes three times", size);
  }
  memset((*latest)->places, 0xff, 3 * size);
  (*latest)->size = size;
  (*latest)->writing = 1;
  (*latest)->reading = 2;
  return STIC_OK;
}

void stic_latest_destroy(stic_latest *latest)
{
  if (latest)
    free(latest->places);
  free(latest);
}

void *stic_latest_slot(stic_latest *latest)
{
  return latest->places + latest->writing * latest->size;
}

void stic_latest_publish(stic_latest *latest)
{
  const unsigned old = __atomic_exchange_n(&latest->between, latest->writing | FRESH, __ATOMIC_ACQ_REL);

  latest->writing = old & ~FRESH;
}

const void *stic_latest_read(stic_latest *latest, bool *fresh)
{
  const bool is_new = __atomic_load_n(&latest->between, __ATOMIC_RELAXED) & FRESH;

  if (is_new) {
    const unsigned old = __atomic_exchange_n(&latest->between, latest->reading, __ATOMIC_ACQ_REL);

    latest->reading = old & ~FRESH;
    latest->any = true;
  }
  if (fresh)
    *fresh = is_new;
  return latest->any ? latest->places + latest->reading * latest->size : NULL;
}

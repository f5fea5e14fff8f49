/* Hand-over between two threads without locks: a queue that keeps everything and a cell that keeps the newest
 * value. One thread writes, one other reads; both ends are wait-free. Internal to the program. */
#ifndef STIC_RING_H
#define STIC_RING_H

#include "../stiction.h"

/* ---- queue: every item, in order ---------------------------------------------------------- */

typedef struct stic_ring stic_ring;

/* Room for `capacity` items (rounded up to a power of 2) of `item_size` bytes, all of it touched, so that no page
 * fault comes later. The caller owns it. Real-time: no. */
stic_status stic_ring_create(size_t item_size, size_t capacity, stic_ring **ring, stic_error *err);
void stic_ring_destroy(stic_ring *ring); /* NULL allowed */

/* Writer: where the next item goes, NULL if the queue is full; then hands it over. Real-time: yes. */
void *stic_ring_slot(stic_ring *ring);
void stic_ring_put(stic_ring *ring);

/* Reader: the oldest item, NULL if there is none; then gives its place back. Real-time: yes. */
const void *stic_ring_front(stic_ring *ring);
void stic_ring_take(stic_ring *ring);

/* Items in it, by the asking thread's last knowledge; the most there have been. Real-time: yes. */
size_t stic_ring_count(const stic_ring *ring);
size_t stic_ring_most(const stic_ring *ring);

/* ---- cell: the newest value --------------------------------------------------------------- */

typedef struct stic_latest stic_latest;

stic_status stic_latest_create(size_t size, stic_latest **latest, stic_error *err);
void stic_latest_destroy(stic_latest *latest); /* NULL allowed */

/* Writer: a place to fill in whole (what it holds is old), then shows it to the reader. Real-time: yes. */
void *stic_latest_slot(stic_latest *latest);
void stic_latest_publish(stic_latest *latest);

/* Reader: the newest value, unchanged until the next call; NULL before the first. `*fresh` (may be NULL):
 * whether it was published since the last call. Real-time: yes. */
const void *stic_latest_read(stic_latest *latest, bool *fresh);

#endif

/* Preloaded into the program: lets its n-th allocation fail, and counts what it does not free.
 *   FAIL_AT=N       that one, from 1 (0: none);   FAIL_FROM=N   that one and all after it
 *   FAIL_ALL=1      counts every allocation, not only those that this project's own code asks for
 *   FAIL_REPORT=F   at the end writes "allocations live" to F: how many there were and how many are left
 * Freed memory is overwritten, so that what uses it afterwards shows. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <malloc.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* glibc's own, by names that it keeps for replacements. */
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *block, size_t size);
void __libc_free(void *block);

#define SLOTS 65536

static long allocations, fail_at, fail_from;
static bool all, ready;
static char report_path[4096];
static uintptr_t live[SLOTS]; /* open addressing; 0: never used, 1: freed */
static int lock;

static void take_lock(void)
{
  while (__atomic_exchange_n(&lock, 1, __ATOMIC_ACQUIRE))
    ;
}

static void give_lock(void)
{
  __atomic_store_n(&lock, 0, __ATOMIC_RELEASE);
}

static size_t first_slot(uintptr_t block)
{
  return (size_t)(block >> 4) * 2654435761u % SLOTS;
}

static void remember(void *block)
{
  const uintptr_t b = (uintptr_t)block;
  size_t i = first_slot(b);

  if (!b)
    return;
  take_lock();
  for (size_t n = 0; n < SLOTS && live[i] > 1; n++)
    i = (i + 1) % SLOTS;
  live[i] = b;
  give_lock();
}

/* Whether it was one of ours. */
static bool forget(void *block)
{
  const uintptr_t b = (uintptr_t)block;
  size_t i = first_slot(b);
  bool found = false;

  take_lock();
  for (size_t n = 0; n < SLOTS && live[i] && !found; n++, i = (i + 1) % SLOTS) {
    found = live[i] == b;
    if (found)
      live[i] = 1;
  }
  give_lock();
  return found;
}

/* Whether the code at that address is this project's: the program or its module. */
static bool is_ours(void *caller)
{
  Dl_info info;

  return ready && dladdr(caller, &info) && info.dli_fname && strstr(info.dli_fname, "stiction") &&
         !strstr(info.dli_fname, "fail_alloc");
}

/* At its end a coverage build writes its counts, with allocations that look like the program's own. */
static void stop(void)
{
  ready = false;
}

static bool must_fail(bool ours)
{
  static bool stops;
  long n;

  if (!ready || !(ours || all))
    return false;
  if (!__atomic_exchange_n(&stops, true, __ATOMIC_RELAXED))
    atexit(stop); /* not sooner: the last one registered is the first one called */
  n = __atomic_add_fetch(&allocations, 1, __ATOMIC_RELAXED);
  return n == fail_at || (fail_from > 0 && n >= fail_from);
}

static void *out_of_memory(void)
{
  errno = ENOMEM;
  return NULL;
}

void *malloc(size_t size)
{
  const bool ours = is_ours(__builtin_return_address(0));
  void *block;

  if (must_fail(ours))
    return out_of_memory();
  block = __libc_malloc(size);
  if (ours)
    remember(block);
  return block;
}

void *calloc(size_t count, size_t size)
{
  const bool ours = is_ours(__builtin_return_address(0));
  void *block;

  if (must_fail(ours))
    return out_of_memory();
  block = __libc_calloc(count, size);
  if (ours)
    remember(block);
  return block;
}

void *realloc(void *old, size_t size)
{
  const bool ours = is_ours(__builtin_return_address(0));
  void *block;

  if (must_fail(ours))
    return out_of_memory();
  block = __libc_realloc(old, size);
  if (block && old)
    forget(old);
  if (ours)
    remember(block);
  return block;
}

void free(void *block)
{
  if (block && forget(block))
    memset(block, 0xdd, malloc_usable_size(block));
  __libc_free(block);
}

static long number(const char *name)
{
  const char *text = getenv(name);

  return text ? atol(text) : 0;
}

__attribute__((constructor)) static void begin(void)
{
  const char *path = getenv("FAIL_REPORT");

  fail_at = number("FAIL_AT");
  fail_from = number("FAIL_FROM");
  all = number("FAIL_ALL") != 0;
  snprintf(report_path, sizeof report_path, "%s", path ? path : "");
  unsetenv("LD_PRELOAD"); /* children are none of ours */
  ready = true;
}

__attribute__((destructor)) static void end(void)
{
  char text[64];
  long left = 0;
  int fd, length;

  ready = false;
  for (size_t i = 0; i < SLOTS; i++)
    left += live[i] > 1;
  fd = report_path[0] ? open(report_path, O_WRONLY | O_CREAT | O_TRUNC, 0666) : -1;
  length = snprintf(text, sizeof text, "%ld %ld\n", allocations, left);
  if (fd >= 0 && write(fd, text, (size_t)length) == length)
    close(fd);
}

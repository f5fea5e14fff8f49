#include "refuse.h"

#include <dirent.h>
#include <errno.h>
#include <pthread.h>
#include <stddef.h>
#include <stdlib.h>

#define BLOCKS_MAX 4096

static struct {
  pthread_mutex_t lock;
  bool active;
  pthread_t who;
  int n, asked;
  bool all_after;
  refused first;
  void *blocks[BLOCKS_MAX];
  int count; /* of blocks */
  bool tracks;
} state = {.lock = PTHREAD_MUTEX_INITIALIZER};

void refuse_begin(int n, bool all_after)
{
  pthread_mutex_lock(&state.lock);
  state.who = pthread_self();
  state.n = n;
  state.all_after = all_after;
  state.asked = 0;
  state.first = REFUSED_NOTHING;
  state.count = 0;
  state.active = state.tracks = true;
  pthread_mutex_unlock(&state.lock);
}

refused refuse_end(void)
{
  pthread_mutex_lock(&state.lock);
  state.active = false;
  pthread_mutex_unlock(&state.lock);
  return state.first;
}

int refuse_asked(void)
{
  return state.asked;
}

int refuse_blocks_left(void)
{
  return state.count;
}

static bool is_refused(refused kind)
{
  bool hit = false;

  pthread_mutex_lock(&state.lock);
  if (state.active && pthread_equal(state.who, pthread_self())) {
    state.asked++;
    hit = state.asked == state.n || (state.all_after && state.n > 0 && state.asked > state.n);
    if (state.asked == state.n)
      state.first = kind;
  }
  pthread_mutex_unlock(&state.lock);
  if (hit)
    errno = ENOMEM;
  return hit;
}

static void *noted(void *block)
{
  pthread_mutex_lock(&state.lock);
  if (block && state.tracks) {
    if (state.count == BLOCKS_MAX)
      abort();
    state.blocks[state.count++] = block;
  }
  pthread_mutex_unlock(&state.lock);
  return block;
}

static void forget(const void *block)
{
  pthread_mutex_lock(&state.lock);
  for (int i = 0; block && i < state.count; i++) {
    if (state.blocks[i] == block) {
      state.blocks[i] = state.blocks[--state.count];
      break;
    }
  }
  pthread_mutex_unlock(&state.lock);
}

/* ---- what the linker puts in the place of ... ------------------------------------------------ */

#define STANDS_IN(type, function, parameters)                                                                \
  type __real_##function parameters;                                                                         \
  type __wrap_##function parameters;                                                                         \
  type __wrap_##function parameters

STANDS_IN(void *, malloc, (size_t size))
{
  return is_refused(REFUSED_MEMORY) ? NULL : noted(__real_malloc(size));
}

STANDS_IN(void *, calloc, (size_t count, size_t size))
{
  return is_refused(REFUSED_MEMORY) ? NULL : noted(__real_calloc(count, size));
}

STANDS_IN(void *, realloc, (void *block, size_t size))
{
  if (is_refused(REFUSED_MEMORY))
    return NULL;
  forget(block); /* first: another thread may get its place */
  return noted(__real_realloc(block, size));
}

STANDS_IN(char *, strdup, (const char *text))
{
  return is_refused(REFUSED_MEMORY) ? NULL : noted(__real_strdup(text));
}

STANDS_IN(char *, strndup, (const char *text, size_t size))
{
  return is_refused(REFUSED_MEMORY) ? NULL : noted(__real_strndup(text, size));
}

STANDS_IN(void, free, (void *block))
{
  forget(block);
  __real_free(block);
}

STANDS_IN(char *, realpath, (const char *path, char *resolved))
{
  return is_refused(REFUSED_MEMORY) ? NULL
         : resolved                 ? __real_realpath(path, resolved)
                                    : noted(__real_realpath(path, NULL));
}

STANDS_IN(void *, libdeflate_alloc_compressor, (int level))
{
  return is_refused(REFUSED_MEMORY) ? NULL : __real_libdeflate_alloc_compressor(level);
}

STANDS_IN(DIR *, opendir, (const char *path))
{
  return is_refused(REFUSED_SYSTEM) ? NULL : __real_opendir(path);
}

STANDS_IN(char *, mkdtemp, (char *name))
{
  return is_refused(REFUSED_SYSTEM) ? NULL : __real_mkdtemp(name);
}

STANDS_IN(int, pipe, (int ends[2]))
{
  return is_refused(REFUSED_SYSTEM) ? -1 : __real_pipe(ends);
}

STANDS_IN(int, pthread_create,
          (pthread_t * thread, const pthread_attr_t *attributes, void *(*run)(void *), void *context))
{
  return is_refused(REFUSED_SYSTEM) ? EAGAIN : __real_pthread_create(thread, attributes, run, context);
}

STANDS_IN(void *, dlopen, (const char *file, int mode))
{
  return is_refused(REFUSED_SYSTEM) ? NULL : __real_dlopen(file, mode);
}

#include "png_writer.h"

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "error.h"
#include "png_encoder.h"

/* Pictures that wait per worker: enough to even out, few enough to bound memory. */
#define QUEUE_PER_WORKER 2

void stic_png_sequence_name(int64_t index, char name[STIC_PNG_NAME_MAX])
{
  snprintf(name, STIC_PNG_NAME_MAX, "frame_%06lld.png", (long long)index);
}

/* NULL without memory. */
static char *sequence_path(const char *folder, int64_t index)
{
  size_t room = strlen(folder) + 1 + STIC_PNG_NAME_MAX;
  char *path = malloc(room), name[STIC_PNG_NAME_MAX];

  stic_png_sequence_name(index, name);
  if (path)
    snprintf(path, room, "%s/%s", folder, name);
  return path;
}

/* ---- one file ------------------------------------------------------------------------------ */

/* 0 or an errno; what failed is removed again if it is a file of ours. */
static int write_file(const char *path, stic_png_encoder *encoder, const stic_image *image, bool ours)
{
  size_t length;
  const uint8_t *png = stic_png_encode(encoder, image, &length);
  FILE *file = png ? fopen(path, "wb") : NULL;
  int problem = 0;

  if (!file)
    return png ? errno : ENOMEM;
  setvbuf(file, NULL, _IONBF, 0); /* it is written at once */
  errno = 0;
  if (fwrite(png, 1, length, file) != length)
    problem = errno ? errno : EIO;
  if (fclose(file) && !problem)
    problem = errno;
  if (problem && ours)
    unlink(path);
  return problem;
}

static stic_status refused(const char *path, int problem, stic_error *err)
{
  return stic_error_set(err, problem == ENOMEM ? STIC_NO_MEMORY : STIC_CANNOT_WRITE, path, 0,
                        "cannot write: %s", strerror(problem));
}

/* 0 or an errno. */
static int replace_file(const char *path, stic_png_encoder *encoder, const stic_image *image)
{
  size_t room = strlen(path) + 32;
  char *draft = malloc(room);
  int problem;

  if (!draft)
    return ENOMEM;
  snprintf(draft, room, "%s.%ld.tmp", path, (long)getpid());
  problem = write_file(draft, encoder, image, true);
  if (!problem && rename(draft, path) != 0) {
    problem = errno;
    unlink(draft);
  }
  free(draft);
  return problem;
}

stic_status stic_png_write(const char *path, const stic_image *image, stic_error *err)
{
  stic_png_encoder *encoder = stic_png_encoder_create(STIC_PNG_QUICK);
  struct stat there;
  int problem = ENOMEM;

  /* A device or a pipe cannot be replaced. */
  if (encoder && !stat(path, &there) && !S_ISREG(there.st_mode))
    problem = write_file(path, encoder, image, false);
  else if (encoder)
    problem = replace_file(path, encoder, image);
  stic_png_encoder_destroy(encoder);
  return problem ? refused(path, problem, err) : STIC_OK;
}

/* ---- sequence ------------------------------------------------------------------------------ */

typedef struct slot {
  int64_t index;
  uint8_t *pixels; /* owned */
} slot;

struct stic_png_writer {
  char *folder;
  int width, height;
  pthread_mutex_t lock; /* guards what follows */
  pthread_cond_t changed;
  slot *slots; /* ring */
  int slot_count, first, waiting;
  int busy; /* threads with a picture in hand */
  bool ending;
  stic_error failure; /* status STIC_OK: none */
  int workers;        /* threads that run */
  pthread_t threads[STIC_PNG_WORKERS_MAX];
};

static void write_slot(stic_png_writer *w, stic_png_encoder *encoder, const slot *s, stic_error *err)
{
  stic_image image = {w->width, w->height, s->pixels};
  char *path = sequence_path(w->folder, s->index);
  int problem = path ? write_file(path, encoder, &image, true) : ENOMEM;

  err->status = STIC_OK;
  if (problem)
    refused(path ? path : w->folder, problem, err);
  free(path);
}

/* Takes pictures off the queue until the end. The slot's pixels are swapped with the thread's own, so
 * that the slot is free at once. */
static void *work(void *writer)
{
  stic_png_writer *w = writer;
  slot own = {0, malloc((size_t)w->width * (size_t)w->height * 4)};
  stic_png_encoder *encoder = stic_png_encoder_create(STIC_PNG_QUICK);
  bool able = own.pixels && encoder;
  stic_error err;

  pthread_mutex_lock(&w->lock);
  if (!able && !w->failure.status)
    refused(w->folder, ENOMEM, &w->failure);
  for (;;) {
    slot *s = &w->slots[w->first], taken;

    if (!w->waiting && w->ending)
      break;
    if (!w->waiting) {
      pthread_cond_wait(&w->changed, &w->lock);
      continue;
    }
    w->first = (w->first + 1) % w->slot_count;
    w->waiting--;
    if (!able || w->failure.status) {
      pthread_cond_broadcast(&w->changed);
      continue;
    }
    taken = *s;
    s->pixels = own.pixels;
    own = taken;
    w->busy++;
    pthread_cond_broadcast(&w->changed);
    pthread_mutex_unlock(&w->lock);
    write_slot(w, encoder, &own, &err);
    pthread_mutex_lock(&w->lock);
    w->busy--;
    if (err.status && !w->failure.status)
      w->failure = err;
    pthread_cond_broadcast(&w->changed);
  }
  pthread_mutex_unlock(&w->lock);
  stic_png_encoder_destroy(encoder);
  free(own.pixels);
  return NULL;
}

static bool make_slots(stic_png_writer *w, int workers)
{
  w->slot_count = workers * QUEUE_PER_WORKER;
  w->slots = calloc((size_t)w->slot_count, sizeof *w->slots);
  for (int i = 0; w->slots && i < w->slot_count; i++) {
    w->slots[i].pixels = malloc((size_t)w->width * (size_t)w->height * 4);
    if (!w->slots[i].pixels)
      return false;
  }
  return w->slots != NULL;
}

stic_status stic_png_writer_create(const char *folder, int width, int height, int workers,
                                   stic_png_writer **writer, stic_error *err)
{
  stic_png_writer *w = calloc(1, sizeof *w);

  *writer = NULL;
  if (!w)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "no memory for writing pictures");
  pthread_mutex_init(&w->lock, NULL);
  pthread_cond_init(&w->changed, NULL);
  w->width = width;
  w->height = height;
  w->folder = malloc(strlen(folder) + 1);
  if (w->folder && make_slots(w, workers)) {
    strcpy(w->folder, folder);
    while (w->workers < workers && !pthread_create(&w->threads[w->workers], NULL, work, w))
      w->workers++;
  }
  if (!w->workers) {
    stic_png_writer_destroy(w);
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "no memory or threads for writing pictures");
  }
  *writer = w;
  return STIC_OK;
}

/* With the lock held. */
static stic_status report(const stic_png_writer *w, stic_error *err)
{
  if (w->failure.status && err)
    *err = w->failure;
  return w->failure.status;
}

stic_status stic_png_writer_add(stic_png_writer *w, int64_t index, const stic_image *image, stic_error *err)
{
  stic_status status;

  pthread_mutex_lock(&w->lock);
  while (w->waiting == w->slot_count && !w->failure.status)
    pthread_cond_wait(&w->changed, &w->lock);
  status = report(w, err);
  if (!status) {
    slot *s = &w->slots[(w->first + w->waiting) % w->slot_count];

    s->index = index;
    memcpy(s->pixels, image->pixels, (size_t)w->width * (size_t)w->height * 4);
    w->waiting++;
    pthread_cond_broadcast(&w->changed);
  }
  pthread_mutex_unlock(&w->lock);
  return status;
}

stic_status stic_png_writer_finish(stic_png_writer *w, stic_error *err)
{
  stic_status status;

  pthread_mutex_lock(&w->lock);
  while (w->waiting || w->busy)
    pthread_cond_wait(&w->changed, &w->lock);
  status = report(w, err);
  pthread_mutex_unlock(&w->lock);
  return status;
}

void stic_png_writer_destroy(stic_png_writer *w)
{
  if (!w)
    return;
  pthread_mutex_lock(&w->lock);
  w->ending = true;
  w->waiting = 0;
  pthread_cond_broadcast(&w->changed);
  pthread_mutex_unlock(&w->lock);
  for (int i = 0; i < w->workers; i++)
    pthread_join(w->threads[i], NULL);
  for (int i = 0; w->slots && i < w->slot_count; i++)
    free(w->slots[i].pixels);
  free(w->slots);
  free(w->folder);
  pthread_cond_destroy(&w->changed);
  pthread_mutex_destroy(&w->lock);
  free(w);
}

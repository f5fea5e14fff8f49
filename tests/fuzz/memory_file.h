/* Bytes as a file with a path, without a disk: for readers that take paths. */
#ifndef STICTION_TESTS_MEMORY_FILE_H
#define STICTION_TESTS_MEMORY_FILE_H

#ifndef _GNU_SOURCE
#define _GNU_SOURCE /* memfd_create() */
#endif
#include <fcntl.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

typedef struct memory_file {
  int fd;
  char path[32]; /* opening it gives a file of its own, at its beginning */
} memory_file;

static inline void require(int holds)
{
  if (!holds)
    abort();
}

/* Opened on first use, then used over and over. */
static inline const char *memory_file_write(memory_file *file, const void *bytes, size_t size)
{
  if (!file->path[0]) {
    file->fd = memfd_create("fuzz", MFD_CLOEXEC);
    require(file->fd >= 0);
    snprintf(file->path, sizeof file->path, "/proc/self/fd/%d", file->fd);
  }
  require(ftruncate(file->fd, 0) == 0 && pwrite(file->fd, bytes, size, 0) == (ssize_t)size);
  return file->path;
}

#endif

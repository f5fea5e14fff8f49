/* Loads the module that writes video when the first one is wanted. */
#include "video.h"

#include "error.h"
#include "video_module.h"

#include <dlfcn.h>
#include <stdlib.h>

struct stic_video {
  void *library;
  const stic_video_module *module;
  stic_video_writer *writer;
};

#if defined(STIC_WITH_LIBAV)

/* Beside the program while it is in its build folder, else where it was installed: both are in its run path. */
static void *open_module(const stic_video_module **module)
{
  void *library = dlopen(STIC_VIDEO_MODULE_FILE, RTLD_NOW | RTLD_LOCAL);

  *module = library ? dlsym(library, "stic_video_libav") : NULL;
  if (*module && (*module)->version == STIC_VIDEO_MODULE)
    return library;
  if (library)
    dlclose(library);
  return NULL;
}

#else

static void *open_module(const stic_video_module **module)
{
  *module = NULL;
  return NULL;
}

#endif

bool stic_video_available(void)
{
  const stic_video_module *module;
  void *library = open_module(&module);

  if (library)
    dlclose(library);
  return library != NULL;
}

stic_status stic_video_create(const char *path, int width, int height, int fps, bool live, stic_video **video,
                              stic_error *err)
{
  stic_video *v = calloc(1, sizeof *v);
  stic_status status;

  *video = NULL;
  if (!v)
    return stic_error_set(err, STIC_NO_MEMORY, path, 0, "out of memory");
  v->library = open_module(&v->module);
  if (v->library)
    status = v->module->create(path, width, height, fps, live, &v->writer, err);
  else
    status =
      stic_error_set(err, STIC_USAGE, path, 0,
                     "this build cannot write video: it was made without libav, or its module is missing");
  if (status) {
    stic_video_destroy(v);
    return status;
  }
  *video = v;
  return STIC_OK;
}

stic_status stic_video_add(stic_video *v, const stic_image *image, stic_error *err)
{
  return v->module->add(v->writer, image, err);
}

stic_status stic_video_finish(stic_video *v, stic_error *err)
{
  return v->module->finish(v->writer, err);
}

stic_status stic_video_keep(stic_video *v, stic_error *err)
{
  return v->module->keep(v->writer, err);
}

void stic_video_destroy(stic_video *v)
{
  if (!v)
    return;
  if (v->writer)
    v->module->destroy(v->writer);
  if (v->library)
    dlclose(v->library);
  free(v);
}

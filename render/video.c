/* Loads the module that writes video when the first one is wanted. */
#include "video.h"

#include "error.h"
#include "module.h"
#include "video_module.h"

#include <stdio.h>
#include <stdlib.h>

struct stic_video {
  void *library;
  const stic_video_module *module;
  stic_video_writer *writer;
};

static void *open_module(const stic_video_module **module)
{
  void *library = NULL;

#if defined(STIC_WITH_LIBAV)
  *module = stic_module_load(STIC_VIDEO_MODULE_FILE, "stic_video_libav", STIC_VIDEO_MODULE, &library);
#else
  *module = NULL;
#endif
  return library;
}

bool stic_video_available(void)
{
  const stic_video_module *module;
  void *library = open_module(&module);

  stic_module_unload(library);
  return library != NULL;
}

void stic_video_licence(char *text, size_t size)
{
  const stic_video_module *module;
  void *library = open_module(&module);

  snprintf(text, size, "%s", library ? module->licence() : "");
  stic_module_unload(library);
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
    status = stic_error_set(
      err, STIC_USAGE, path, 0,
      "this build cannot write video: it was made without libav, or its module cannot be loaded");
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
  stic_module_unload(v->library);
  free(v);
}

#include "gl.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/osmesa.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"

typedef void (*stic_gl_proc)(void);

/* OSMesa and EGL insist on a drawable; ours is never looked at. */
#define DRAWABLE_SIZE 16

typedef struct osmesa_api {
  OSMesaContext (*create)(const int *, OSMesaContext);
  void (*destroy)(OSMesaContext);
  GLboolean (*make_current)(OSMesaContext, void *, GLenum, GLsizei, GLsizei);
  OSMesaContext (*current)(void);
  OSMESAproc (*proc)(const char *);
} osmesa_api;

typedef struct egl_api {
  EGLDisplay (*get_display)(EGLenum, void *, const EGLAttrib *);
  EGLBoolean (*initialize)(EGLDisplay, EGLint *, EGLint *);
  EGLBoolean (*bind_api)(EGLenum);
  EGLBoolean (*choose_config)(EGLDisplay, const EGLint *, EGLConfig *, EGLint, EGLint *);
  EGLContext (*create_context)(EGLDisplay, EGLConfig, EGLContext, const EGLint *);
  EGLBoolean (*destroy_context)(EGLDisplay, EGLContext);
  EGLBoolean (*make_current)(EGLDisplay, EGLSurface, EGLSurface, EGLContext);
  EGLContext (*current)(void);
  __eglMustCastToProperFunctionPointerType (*proc)(const char *);
} egl_api;

struct stic_gl_context {
  void *library;
  osmesa_api osmesa;
  OSMesaContext osmesa_context;
  unsigned char drawable[DRAWABLE_SIZE * DRAWABLE_SIZE * 4];
  egl_api egl;
  EGLDisplay egl_display;
  EGLContext egl_context;
};

/* ISO C has no cast from an object to a function pointer; POSIX guarantees that the bytes agree. */
static bool load_symbol(void *library, const char *name, void *function)
{
  void *symbol = dlsym(library, name);

  memcpy(function, &symbol, sizeof symbol);
  return symbol != NULL;
}

/* ---- OSMesa -------------------------------------------------------------------------------- */

static bool osmesa_load(struct stic_gl_context *c, const char *library)
{
  static const char *const names[] = {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"};
  osmesa_api *api = &c->osmesa;

  if (library)
    c->library = dlopen(library, RTLD_NOW | RTLD_LOCAL);
  for (size_t i = 0; !library && !c->library && i < sizeof names / sizeof names[0]; i++)
    c->library = dlopen(names[i], RTLD_NOW | RTLD_LOCAL);
  return c->library && load_symbol(c->library, "OSMesaCreateContextAttribs", &api->create) &&
         load_symbol(c->library, "OSMesaDestroyContext", &api->destroy) &&
         load_symbol(c->library, "OSMesaMakeCurrent", &api->make_current) &&
         load_symbol(c->library, "OSMesaGetCurrentContext", &api->current) &&
         load_symbol(c->library, "OSMesaGetProcAddress", &api->proc);
}

static bool osmesa_make_current(struct stic_gl_context *c)
{
  return c->osmesa.make_current(c->osmesa_context, c->drawable, GL_UNSIGNED_BYTE, DRAWABLE_SIZE,
                                DRAWABLE_SIZE);
}

static const char *osmesa_open(struct stic_gl_context *c, const char *library)
{
  static const int attributes[] = {OSMESA_FORMAT,
                                   OSMESA_RGBA,
                                   OSMESA_DEPTH_BITS,
                                   0,
                                   OSMESA_PROFILE,
                                   OSMESA_CORE_PROFILE,
                                   OSMESA_CONTEXT_MAJOR_VERSION,
                                   3,
                                   OSMESA_CONTEXT_MINOR_VERSION,
                                   3,
                                   0};

  if (!osmesa_load(c, library))
    return "the OSMesa library cannot be loaded (Debian: libosmesa6)";
  c->osmesa_context = c->osmesa.create(attributes, NULL);
  if (!c->osmesa_context || !osmesa_make_current(c))
    return "OSMesa gives no OpenGL 3.3 core context";
  return NULL;
}

/* ---- EGL surfaceless ----------------------------------------------------------------------- */

static bool egl_load(struct stic_gl_context *c)
{
  egl_api *api = &c->egl;

  c->library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
  return c->library && load_symbol(c->library, "eglGetPlatformDisplay", &api->get_display) &&
         load_symbol(c->library, "eglInitialize", &api->initialize) &&
         load_symbol(c->library, "eglBindAPI", &api->bind_api) &&
         load_symbol(c->library, "eglChooseConfig", &api->choose_config) &&
         load_symbol(c->library, "eglCreateContext", &api->create_context) &&
         load_symbol(c->library, "eglDestroyContext", &api->destroy_context) &&
         load_symbol(c->library, "eglMakeCurrent", &api->make_current) &&
         load_symbol(c->library, "eglGetCurrentContext", &api->current) &&
         load_symbol(c->library, "eglGetProcAddress", &api->proc);
}

static bool egl_make_current(struct stic_gl_context *c)
{
  return c->egl.bind_api(EGL_OPENGL_API) &&
         c->egl.make_current(c->egl_display, EGL_NO_SURFACE, EGL_NO_SURFACE, c->egl_context);
}

static const char *egl_open(struct stic_gl_context *c)
{
  static const EGLint config_wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  static const EGLint context_wanted[] = {EGL_CONTEXT_MAJOR_VERSION,
                                          3,
                                          EGL_CONTEXT_MINOR_VERSION,
                                          3,
                                          EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                          EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                          EGL_NONE};
  EGLConfig config;
  EGLint found = 0;

  if (!egl_load(c))
    return "the EGL library cannot be loaded (Debian: libegl1)";
  c->egl_display = c->egl.get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
  if (c->egl_display == EGL_NO_DISPLAY || !c->egl.initialize(c->egl_display, NULL, NULL))
    return "EGL has no surfaceless platform";
  if (!c->egl.bind_api(EGL_OPENGL_API) ||
      !c->egl.choose_config(c->egl_display, config_wanted, &config, 1, &found) || found < 1)
    return "EGL has no OpenGL configuration";
  c->egl_context = c->egl.create_context(c->egl_display, config, EGL_NO_CONTEXT, context_wanted);
  if (c->egl_context == EGL_NO_CONTEXT || !egl_make_current(c))
    return "EGL gives no OpenGL 3.3 core context";
  return NULL;
}

/* ---- either -------------------------------------------------------------------------------- */

static stic_gl_proc get_proc(const stic_gl *gl, const char *name)
{
  if (gl->backend == STIC_GL_OSMESA)
    return (stic_gl_proc)gl->context->osmesa.proc(name);
  return (stic_gl_proc)gl->context->egl.proc(name);
}

static bool load_functions(stic_gl *gl)
{
#define X(name, type)                                                                                        \
  gl->name = (PFNGL##type##PROC)get_proc(gl, "gl" #name);                                                    \
  if (!gl->name)                                                                                             \
    return false;
  STIC_GL_FUNCTIONS(X)
#undef X
  return true;
}

static void copy_string(const stic_gl *gl, GLenum name, char *out, size_t out_size)
{
  const GLubyte *text = gl->GetString(name);

  snprintf(out, out_size, "%s", text ? (const char *)text : "unknown");
}

/* The EGL display is shared by all contexts of the process, so it is not terminated. The
 * library stays loaded: Mesa's threads and thread-local data do not survive unloading. */
static void leave(struct stic_gl_context *c)
{
  if (c->osmesa_context)
    c->osmesa.destroy(c->osmesa_context);
  if (c->egl_context) {
    c->egl.make_current(c->egl_display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    c->egl.destroy_context(c->egl_display, c->egl_context);
  }
  memset(c, 0, sizeof *c);
}

/* NULL, or why this way gives no context, which is empty then. */
static const char *open_backend(stic_gl *gl, struct stic_gl_context *c, stic_gl_backend backend,
                                const char *osmesa_library)
{
  const char *problem;

  memset(gl, 0, sizeof *gl);
  gl->backend = backend;
  gl->context = c;
  problem = backend == STIC_GL_OSMESA ? osmesa_open(c, osmesa_library) : egl_open(c);
  if (!problem && !load_functions(gl))
    problem = "the OpenGL library lacks a function of OpenGL 3.3";
  if (problem)
    leave(c);
  return problem;
}

stic_status stic_gl_open(stic_gl *gl, stic_gl_backend backend, const char *osmesa_library, stic_error *err)
{
  stic_gl_backend first = backend == STIC_GL_EGL ? STIC_GL_EGL : STIC_GL_OSMESA;
  struct stic_gl_context *c = calloc(1, sizeof *c);
  const char *problem;
  stic_status status = STIC_OK;

  memset(gl, 0, sizeof *gl);
  if (!c)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "no memory for pictures");
  problem = open_backend(gl, c, first, osmesa_library);
  if (problem && backend == STIC_GL_AUTO && !open_backend(gl, c, STIC_GL_EGL, NULL))
    problem = NULL;
  if (problem) {
    stic_gl_close(gl);
    return stic_error_set(err, STIC_CANNOT_WRITE, NULL, 0, "no usable renderer: %s", problem);
  }
  copy_string(gl, GL_RENDERER, gl->renderer, sizeof gl->renderer);
  copy_string(gl, GL_VERSION, gl->version, sizeof gl->version);
  if (!strstr(gl->renderer, "llvmpipe")) {
    status = stic_error_set(err, STIC_CANNOT_WRITE, NULL, 0,
                            "no usable renderer: it is \"%s\", expected llvmpipe "
                            "(is GALLIUM_DRIVER or LIBGL_ALWAYS_SOFTWARE set?)",
                            gl->renderer);
    stic_gl_close(gl);
  }
  return status;
}

bool stic_gl_make_current(const stic_gl *gl)
{
  struct stic_gl_context *c = gl->context;

  if (gl->backend == STIC_GL_OSMESA)
    return c->osmesa.current() == c->osmesa_context || osmesa_make_current(c);
  return c->egl.current() == c->egl_context || egl_make_current(c);
}

void stic_gl_close(stic_gl *gl)
{
  if (!gl->context)
    return;
  leave(gl->context);
  free(gl->context);
  gl->context = NULL;
}

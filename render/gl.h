/* An OpenGL 3.3 core context without a window, drawn by llvmpipe: opened through OSMesa, or through EGL
 * surfaceless where OSMesa is absent. Both libraries are loaded at run time, so a program that never
 * draws needs neither. Pictures are always drawn into a framebuffer object of our own: only then do both
 * ways give the same pixels. */
#ifndef STIC_GL_H
#define STIC_GL_H

#include <GL/glcorearb.h>

#include "stiction.h"

/* clang-format off */
/* Name without "gl", type of the pointer without "PFNGL" and "PROC". */
#define STIC_GL_FUNCTIONS(X)                             \
  X(AttachShader, ATTACHSHADER)                          \
  X(BindAttribLocation, BINDATTRIBLOCATION)              \
  X(BindBuffer, BINDBUFFER)                              \
  X(BindFragDataLocation, BINDFRAGDATALOCATION)          \
  X(BindFramebuffer, BINDFRAMEBUFFER)                    \
  X(BindRenderbuffer, BINDRENDERBUFFER)                  \
  X(BindVertexArray, BINDVERTEXARRAY)                    \
  X(BlendFunc, BLENDFUNC)                                \
  X(BlitFramebuffer, BLITFRAMEBUFFER)                    \
  X(BufferData, BUFFERDATA)                              \
  X(CheckFramebufferStatus, CHECKFRAMEBUFFERSTATUS)      \
  X(Clear, CLEAR)                                        \
  X(ClearBufferuiv, CLEARBUFFERUIV)                      \
  X(ClearColor, CLEARCOLOR)                              \
  X(ColorMask, COLORMASK)                                \
  X(CompileShader, COMPILESHADER)                        \
  X(CreateProgram, CREATEPROGRAM)                        \
  X(CreateShader, CREATESHADER)                          \
  X(DeleteBuffers, DELETEBUFFERS)                        \
  X(DeleteFramebuffers, DELETEFRAMEBUFFERS)              \
  X(DeleteProgram, DELETEPROGRAM)                        \
  X(DeleteRenderbuffers, DELETERENDERBUFFERS)            \
  X(DeleteShader, DELETESHADER)                          \
  X(DeleteVertexArrays, DELETEVERTEXARRAYS)              \
  X(DepthMask, DEPTHMASK)                                \
  X(DepthRange, DEPTHRANGE)                              \
  X(Disable, DISABLE)                                    \
  X(DrawArrays, DRAWARRAYS)                              \
  X(Enable, ENABLE)                                      \
  X(EnableVertexAttribArray, ENABLEVERTEXATTRIBARRAY)    \
  X(Finish, FINISH)                                      \
  X(FramebufferRenderbuffer, FRAMEBUFFERRENDERBUFFER)    \
  X(GenBuffers, GENBUFFERS)                              \
  X(GenFramebuffers, GENFRAMEBUFFERS)                    \
  X(GenRenderbuffers, GENRENDERBUFFERS)                  \
  X(GenVertexArrays, GENVERTEXARRAYS)                    \
  X(GetError, GETERROR)                                  \
  X(GetIntegerv, GETINTEGERV)                            \
  X(GetProgramInfoLog, GETPROGRAMINFOLOG)                \
  X(GetProgramiv, GETPROGRAMIV)                          \
  X(GetShaderInfoLog, GETSHADERINFOLOG)                  \
  X(GetShaderiv, GETSHADERIV)                            \
  X(GetString, GETSTRING)                                \
  X(GetUniformLocation, GETUNIFORMLOCATION)              \
  X(LinkProgram, LINKPROGRAM)                            \
  X(PixelStorei, PIXELSTOREI)                            \
  X(ReadPixels, READPIXELS)                              \
  X(RenderbufferStorage, RENDERBUFFERSTORAGE)            \
  X(Scissor, SCISSOR)                                    \
  X(ShaderSource, SHADERSOURCE)                          \
  X(Uniform1ui, UNIFORM1UI)                              \
  X(UniformMatrix4fv, UNIFORMMATRIX4FV)                  \
  X(UseProgram, USEPROGRAM)                              \
  X(VertexAttribPointer, VERTEXATTRIBPOINTER)            \
  X(Viewport, VIEWPORT)
/* clang-format on */

/* How a context is opened. */
typedef enum stic_gl_backend {
  STIC_GL_AUTO,   /* OSMesa, else EGL */
  STIC_GL_OSMESA, /* only OSMesa */
  STIC_GL_EGL     /* only EGL surfaceless */
} stic_gl_backend;

/* A context and its entry points. Filled by stic_gl_open(), read-only afterwards. */
typedef struct stic_gl {
#define X(name, type) PFNGL##type##PROC name;
  STIC_GL_FUNCTIONS(X)
#undef X
  struct stic_gl_context *context; /* owned */
  stic_gl_backend backend;         /* the one in use, never STIC_GL_AUTO */
  char renderer[128];              /* GL_RENDERER, e.g. "llvmpipe (LLVM 15.0.6, 256 bits)" */
  char version[128];               /* GL_VERSION with Mesa's version: golden images belong to it */
} stic_gl;

/* Opens a context and makes it current in the calling thread. `osmesa_library` names the OSMesa library
 * to load, NULL for the system's. STIC_CANNOT_WRITE with one message if there is no library, no core
 * 3.3, or the renderer is not llvmpipe; STIC_NO_MEMORY. Nothing is left open then. */
stic_status stic_gl_open(stic_gl *gl, stic_gl_backend backend, const char *osmesa_library, stic_error *err);

/* Makes the context current in the calling thread; cheap if it already is. False if it cannot be. */
bool stic_gl_make_current(const stic_gl *gl);

/* Ends the context. A zeroed or closed one is allowed. */
void stic_gl_close(stic_gl *gl);

#endif

#include "submit.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"

static const char vertex_source[] =
  "#version 330 core\n"
  "uniform mat4 matrix;\n"
  "in vec3 position;\n"
  "in vec4 color;\n"
  "out vec4 shade;\n"
  "void main() { gl_Position = matrix * vec4(position, 1.0); shade = color; }\n";
static const char color_source[] = "#version 330 core\n"
                                   "in vec4 shade;\n"
                                   "out vec4 pixel;\n"
                                   "void main() { pixel = shade; }\n";
static const char identity_source[] = "#version 330 core\n"
                                      "uniform uint id;\n"
                                      "in vec4 shade;\n"
                                      "out uint pixel;\n"
                                      "void main() { pixel = id; }\n";

enum { POSITION, COLOR };

/* Of one picture: bounds memory to about a gigabyte. */
#define SAMPLES_MAX 48e6

static GLuint compile(const stic_gl *gl, GLenum kind, const char *source, stic_error *err)
{
  GLuint shader = gl->CreateShader(kind);
  GLint ok = 0;
  char log[256] = "";

  gl->ShaderSource(shader, 1, &source, NULL);
  gl->CompileShader(shader);
  gl->GetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (ok)
    return shader;
  gl->GetShaderInfoLog(shader, sizeof log, NULL, log);
  gl->DeleteShader(shader);
  stic_error_set(err, STIC_CANNOT_WRITE, NULL, 0, "no usable renderer: a shader is refused: %s", log);
  return 0;
}

static GLuint make_program(const stic_gl *gl, const char *fragment_source, stic_error *err)
{
  GLuint vertex = compile(gl, GL_VERTEX_SHADER, vertex_source, err), program = 0;
  GLuint fragment = vertex ? compile(gl, GL_FRAGMENT_SHADER, fragment_source, err) : 0;
  GLint ok = 0;

  if (fragment) {
    program = gl->CreateProgram();
    gl->AttachShader(program, vertex);
    gl->AttachShader(program, fragment);
    gl->BindAttribLocation(program, POSITION, "position");
    gl->BindAttribLocation(program, COLOR, "color");
    gl->BindFragDataLocation(program, 0, "pixel");
    gl->LinkProgram(program);
    gl->GetProgramiv(program, GL_LINK_STATUS, &ok);
    if (!ok) {
      char log[256] = "";

      gl->GetProgramInfoLog(program, sizeof log, NULL, log);
      gl->DeleteProgram(program);
      program = 0;
      stic_error_set(err, STIC_CANNOT_WRITE, NULL, 0, "no usable renderer: the shaders do not link: %s", log);
    }
  }
  gl->DeleteShader(vertex);
  gl->DeleteShader(fragment);
  return program;
}

static GLuint make_buffer(const stic_gl *gl, GLenum format, GLenum attachment, int width, int height)
{
  GLuint buffer;

  gl->GenRenderbuffers(1, &buffer);
  gl->BindRenderbuffer(GL_RENDERBUFFER, buffer);
  gl->RenderbufferStorage(GL_RENDERBUFFER, format, width, height);
  gl->FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer);
  return buffer;
}

static bool make_target(const stic_gl *gl, stic_target *target, GLenum format, int width, int height)
{
  gl->GenFramebuffers(1, &target->framebuffer);
  gl->BindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
  target->color = make_buffer(gl, format, GL_COLOR_ATTACHMENT0, width, height);
  target->depth = make_buffer(gl, GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT, width, height);
  return gl->CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

static void free_target(const stic_gl *gl, stic_target *target)
{
  gl->DeleteRenderbuffers(1, &target->color);
  gl->DeleteRenderbuffers(1, &target->depth);
  gl->DeleteFramebuffers(1, &target->framebuffer);
}

static void make_vertex_array(stic_submit *s)
{
  const stic_gl *gl = s->gl;

  gl->GenVertexArrays(1, &s->vertex_array);
  gl->BindVertexArray(s->vertex_array);
  gl->GenBuffers(1, &s->buffer);
  gl->BindBuffer(GL_ARRAY_BUFFER, s->buffer);
  gl->EnableVertexAttribArray(POSITION);
  gl->EnableVertexAttribArray(COLOR);
  gl->VertexAttribPointer(POSITION, 3, GL_FLOAT, GL_FALSE, sizeof(stic_vertex), NULL);
  gl->VertexAttribPointer(COLOR, 4, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(stic_vertex),
                          (const void *)(uintptr_t)offsetof(stic_vertex, rgba));
}

static stic_status make_targets(stic_submit *s, stic_error *err)
{
  const stic_gl *gl = s->gl;
  GLint largest = 0;
  int w, h;

  gl->GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
  while (s->samples > 1 && (s->samples * s->width > largest || s->samples * s->height > largest ||
                            (double)s->samples * s->samples * s->width * s->height > SAMPLES_MAX))
    s->samples /= 2;
  w = s->samples * s->width;
  h = s->samples * s->height;
  s->readback = malloc((size_t)w * (size_t)h * sizeof *s->readback);
  if (!s->readback)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "no memory for a picture of %d x %d", s->width,
                          s->height);
  if (!make_target(gl, &s->stage, GL_RGBA8, w, h) || !make_target(gl, &s->frame, GL_RGBA8, w, h))
    return stic_error_set(err, STIC_CANNOT_WRITE, NULL, 0,
                          "no usable renderer: it has no picture buffers of %d x %d", w, h);
  return STIC_OK;
}

stic_status stic_submit_init(stic_submit *s, const stic_gl *gl, int width, int height, int samples,
                             stic_error *err)
{
  stic_status status;

  memset(s, 0, sizeof *s);
  s->gl = gl;
  s->width = width;
  s->height = height;
  s->samples = samples;
  s->program = make_program(gl, color_source, err);
  s->identity_program = s->program ? make_program(gl, identity_source, err) : 0;
  if (!s->identity_program) {
    stic_submit_free(s);
    return STIC_CANNOT_WRITE;
  }
  s->matrix_at = gl->GetUniformLocation(s->program, "matrix");
  s->identity_matrix_at = gl->GetUniformLocation(s->identity_program, "matrix");
  s->identity_id_at = gl->GetUniformLocation(s->identity_program, "id");
  make_vertex_array(s);
  gl->PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl->BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  gl->Disable(GL_DITHER);
  status = make_targets(s, err);
  if (!status)
    status = stic_submit_check(s, err);
  if (status)
    stic_submit_free(s);
  return status;
}

void stic_submit_free(stic_submit *s)
{
  const stic_gl *gl = s->gl;

  if (!gl)
    return;
  free_target(gl, &s->stage);
  free_target(gl, &s->frame);
  free_target(gl, &s->identity);
  gl->DeleteBuffers(1, &s->buffer);
  gl->DeleteVertexArrays(1, &s->vertex_array);
  gl->DeleteProgram(s->program);
  gl->DeleteProgram(s->identity_program);
  free(s->readback);
  memset(s, 0, sizeof *s);
}

static void upload(const stic_submit *s, const stic_mesh *mesh)
{
  s->gl->BindVertexArray(s->vertex_array);
  s->gl->BindBuffer(GL_ARRAY_BUFFER, s->buffer);
  s->gl->BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)((size_t)mesh->count * sizeof *mesh->vertices),
                    mesh->vertices, GL_STREAM_DRAW);
}

static void set_blend(const stic_gl *gl, bool on)
{
  if (on)
    gl->Enable(GL_BLEND);
  else
    gl->Disable(GL_BLEND);
  gl->DepthMask(!on);
  /* The picture stays opaque whatever is blended into it. */
  gl->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, !on);
}

/* The world keeps the far part of the depth buffer's range, signs on top of it the near part: cheaper than
 * to clear depths in between. */
static void set_layer(const stic_gl *gl, bool on_top)
{
  gl->DepthRange(on_top ? 0 : 0.1, on_top ? 0.1 : 1);
}

static void draw_colors(const stic_submit *s, const stic_mesh *mesh, const float matrix[16])
{
  const stic_gl *gl = s->gl;

  upload(s, mesh);
  gl->UseProgram(s->program);
  gl->UniformMatrix4fv(s->matrix_at, 1, GL_FALSE, matrix);
  gl->Enable(GL_DEPTH_TEST);
  set_layer(gl, false);
  for (int i = 0; i < mesh->draw_count; i++) {
    const stic_draw *d = &mesh->draws[i];

    set_blend(gl, d->kind == STIC_DRAW_BLEND);
    if (d->kind == STIC_DRAW_ON_TOP)
      set_layer(gl, true);
    else if (d->count)
      gl->DrawArrays(GL_TRIANGLES, d->first, d->count);
  }
  set_blend(gl, false);
}

void stic_submit_stage(stic_submit *s, const stic_mesh *mesh, const float matrix[16], stic_color background)
{
  const stic_gl *gl = s->gl;

  gl->BindFramebuffer(GL_FRAMEBUFFER, s->stage.framebuffer);
  gl->Viewport(0, 0, s->samples * s->width, s->samples * s->height);
  gl->Disable(GL_SCISSOR_TEST);
  gl->ClearColor(background.r / 255.0f, background.g / 255.0f, background.b / 255.0f, 1);
  gl->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  draw_colors(s, mesh, matrix);
}

void stic_submit_frame(stic_submit *s, const stic_mesh *mesh, const float matrix[16], stic_rect area)
{
  const stic_gl *gl = s->gl;
  int n = s->samples, x0 = n * area.x0, y0 = n * area.y0, x1 = n * area.x1, y1 = n * area.y1;

  gl->Disable(GL_SCISSOR_TEST);
  gl->BindFramebuffer(GL_READ_FRAMEBUFFER, s->stage.framebuffer);
  gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, s->frame.framebuffer);
  gl->BlitFramebuffer(x0, y0, x1, y1, x0, y0, x1, y1, GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT, GL_NEAREST);
  gl->BindFramebuffer(GL_FRAMEBUFFER, s->frame.framebuffer);
  gl->Viewport(0, 0, n * s->width, n * s->height);
  gl->Enable(GL_SCISSOR_TEST);
  gl->Scissor(x0, y0, x1 - x0, y1 - y0);
  draw_colors(s, mesh, matrix);
  gl->Finish();
}

/* Sums of the two pairs of bytes of a pixel, 16 bits each: 0xrrggbbaa -> two by two. */
#define EVEN_BYTES 0x00ff00ffu

/* One row of the picture from n rows of n times as many samples. */
static void average_row(const uint32_t *samples, int width, int n, uint32_t *out)
{
  int shift = n == 2 ? 2 : 4;
  uint32_t half = (uint32_t)(n * n / 2) * 0x00010001u;
  size_t row = (size_t)width * (size_t)n;

  for (int x = 0; x < width; x++) {
    uint32_t even = half, odd = half;

    for (int j = 0; j < n; j++) {
      for (int i = 0; i < n; i++) {
        uint32_t p = samples[(size_t)j * row + (size_t)(x * n + i)];

        even += p & EVEN_BYTES;
        odd += p >> 8 & EVEN_BYTES;
      }
    }
    out[x] = (even >> shift & EVEN_BYTES) | (odd >> shift & EVEN_BYTES) << 8;
  }
}

/* The same for n = 2, the case that has to be fast. */
static void average_row_2(const uint32_t *restrict samples, int width, uint32_t *restrict out)
{
  const uint32_t *restrict above = samples, *restrict below = samples + 2 * (size_t)width;

  for (int x = 0; x < width; x++) {
    uint32_t a = above[2 * x], b = above[2 * x + 1], c = below[2 * x], d = below[2 * x + 1];
    uint32_t even = (a & EVEN_BYTES) + (b & EVEN_BYTES) + (c & EVEN_BYTES) + (d & EVEN_BYTES) + 0x00020002u;
    uint32_t odd = (a >> 8 & EVEN_BYTES) + (b >> 8 & EVEN_BYTES) + (c >> 8 & EVEN_BYTES) +
                   (d >> 8 & EVEN_BYTES) + 0x00020002u;

    out[x] = (even >> 2 & EVEN_BYTES) | (odd >> 2 & EVEN_BYTES) << 8;
  }
}

void stic_submit_read(stic_submit *s, stic_rect area, uint8_t *pixels, int stride, int top)
{
  int n = s->samples, w = area.x1 - area.x0, h = area.y1 - area.y0;

  s->gl->BindFramebuffer(GL_READ_FRAMEBUFFER, s->frame.framebuffer);
  s->gl->ReadPixels(n * area.x0, n * area.y0, n * w, n * h, GL_RGBA, GL_UNSIGNED_BYTE, s->readback);
  for (int y = 0; y < h; y++) {
    const uint32_t *from = s->readback + (size_t)y * (size_t)n * (size_t)n * (size_t)w;
    uint32_t *to =
      (uint32_t *)(void *)pixels + ((size_t)(area.y0 + y + top) * (size_t)stride + (size_t)area.x0);

    if (n == 1)
      memcpy(to, from, (size_t)w * sizeof *to);
    else if (n == 2)
      average_row_2(from, w, to);
    else
      average_row(from, w, n, to);
  }
}

static void draw_ids(const stic_submit *s, const stic_mesh *mesh, const float matrix[16])
{
  const stic_gl *gl = s->gl;

  upload(s, mesh);
  gl->UseProgram(s->identity_program);
  gl->UniformMatrix4fv(s->identity_matrix_at, 1, GL_FALSE, matrix);
  gl->Enable(GL_DEPTH_TEST);
  set_layer(gl, false);
  for (int i = 0; i < mesh->draw_count; i++) {
    const stic_draw *d = &mesh->draws[i];

    gl->Uniform1ui(s->identity_id_at, d->id);
    if (d->kind == STIC_DRAW_ON_TOP)
      set_layer(gl, true);
    else if (d->kind == STIC_DRAW_SOLID && d->count)
      gl->DrawArrays(GL_TRIANGLES, d->first, d->count);
  }
}

stic_status stic_submit_identify(stic_submit *s, const stic_mesh *stage, const stic_mesh *mesh,
                                 const float matrix[16], uint16_t *ids, uint16_t *depths, stic_error *err)
{
  static const GLuint nobody[4] = {0, 0, 0, 0};
  const stic_gl *gl = s->gl;

  if (!s->identity.framebuffer && !make_target(gl, &s->identity, GL_R16UI, s->width, s->height))
    return stic_error_set(err, STIC_CANNOT_WRITE, NULL, 0, "no usable renderer: it has no integer pictures");
  gl->BindFramebuffer(GL_FRAMEBUFFER, s->identity.framebuffer);
  gl->Viewport(0, 0, s->width, s->height);
  gl->Disable(GL_SCISSOR_TEST);
  gl->ClearBufferuiv(GL_COLOR, 0, nobody);
  gl->Clear(GL_DEPTH_BUFFER_BIT);
  draw_ids(s, stage, matrix);
  draw_ids(s, mesh, matrix);
  gl->Finish();
  gl->ReadPixels(0, 0, s->width, s->height, GL_RED_INTEGER, GL_UNSIGNED_SHORT, ids);
  gl->ReadPixels(0, 0, s->width, s->height, GL_DEPTH_COMPONENT, GL_UNSIGNED_SHORT, depths);
  return stic_submit_check(s, err);
}

stic_status stic_submit_check(const stic_submit *s, stic_error *err)
{
  GLenum code = s->gl->GetError();

  if (code == GL_NO_ERROR)
    return STIC_OK;
  return stic_error_set(err, code == GL_OUT_OF_MEMORY ? STIC_NO_MEMORY : STIC_CANNOT_WRITE, NULL, 0,
                        "the renderer failed (OpenGL error 0x%x)", (unsigned)code);
}

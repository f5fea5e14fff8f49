/* Text of the canvas: an embedded typeface baked once into coverage bitmaps, unhinted, on whole pixels. */
#include "canvas.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "font_data.h"

/* What the library needs while it draws one sign: 32 KiB at 154 px, the most in a picture of
 * 4096 x 4096, and 42 KiB at 1000 px. Fonts so ask for
 * memory three times and not for each of a sign's parts. */
#define SCRATCH_SIZE (128 << 10)

typedef struct scratch {
  size_t used;
  bool lacking; /* the library itself would leave the sign out */
  union {
    long double alignment;
    char bytes[SCRATCH_SIZE];
  } memory;
} scratch;

static void *take_memory(size_t size, scratch *s)
{
  const size_t step = sizeof(long double), room = (size + step - 1) / step * step;
  char *memory = s->memory.bytes + s->used;

  if (room > SCRATCH_SIZE - s->used) {
    s->lacking = true;
    return NULL;
  }
  s->used += room;
  return memory;
}

#define STBTT_malloc(size, user) take_memory(size, user)
#define STBTT_free(memory, user) ((void)(memory), (void)(user))
#define STBTT_STATIC
#define STB_TRUETYPE_IMPLEMENTATION
#ifdef __GNUC__
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#endif
#include <stb/stb_truetype.h>
#ifdef __GNUC__
#pragma GCC diagnostic pop
#endif

/* Signs beside ASCII that the pictures use; all are in the embedded fonts. */
static const int signs[] = {0xb0,   0xb1,   0xb7,   0xd7,  0x2013, 0x2212, 0x2026,
                            0x2192, 0x2264, 0x2265, 0x3b8, 0x3bc,  0x3c6};
enum {
  ASCII_FIRST = 32,
  ASCII_COUNT = 95,
  SIGN_COUNT = sizeof signs / sizeof signs[0],
  GLYPH_COUNT = ASCII_COUNT + SIGN_COUNT
};

typedef struct glyph {
  int left, top, width, height; /* px of the bitmap; left and top from the pen */
  double advance;               /* px */
  const uint8_t *coverage;      /* width * height */
} glyph;

struct stic_font {
  int ascent, height;
  glyph glyphs[GLYPH_COUNT];
  uint8_t *coverage; /* of all; owned */
};

static int code_of(int index)
{
  return index < ASCII_COUNT ? ASCII_FIRST + index : signs[index - ASCII_COUNT];
}

/* All but the bitmaps; returns how many bytes these take together. */
static size_t measure(stic_font *font, const stbtt_fontinfo *info, float scale)
{
  size_t size = 0;
  int ascent, descent, gap;

  stbtt_GetFontVMetrics(info, &ascent, &descent, &gap);
  font->ascent = (int)ceilf((float)ascent * scale);
  font->height = (int)ceilf((float)(ascent - descent) * scale);
  for (int i = 0; i < GLYPH_COUNT; i++) {
    glyph *g = &font->glyphs[i];
    int advance, bearing, right, bottom;

    stbtt_GetCodepointHMetrics(info, code_of(i), &advance, &bearing);
    stbtt_GetCodepointBitmapBox(info, code_of(i), scale, scale, &g->left, &g->top, &right, &bottom);
    g->advance = (float)advance * scale;
    g->width = right - g->left;
    g->height = bottom - g->top;
    size += (size_t)g->width * (size_t)g->height;
  }
  return size;
}

static void draw_all(stic_font *font, const stbtt_fontinfo *info, float scale)
{
  scratch *s = info->userdata;
  uint8_t *at = font->coverage;

  for (int i = 0; i < GLYPH_COUNT; i++) {
    glyph *g = &font->glyphs[i];

    s->used = 0;
    stbtt_MakeCodepointBitmap(info, at, g->width, g->height, g->width, scale, scale, code_of(i));
    g->coverage = at;
    at += (size_t)g->width * (size_t)g->height;
  }
}

stic_font *stic_font_create(bool bold, double pixels)
{
  stbtt_fontinfo info;
  stic_font *font = calloc(1, sizeof *font);
  scratch *s = malloc(sizeof *s);
  bool good = font && s && stbtt_InitFont(&info, bold ? stic_font_sans_bold : stic_font_sans, 0);

  if (good) {
    const float scale = stbtt_ScaleForPixelHeight(&info, (float)pixels);

    s->lacking = false;
    info.userdata = s;
    font->coverage = malloc(measure(font, &info, scale));
    if (font->coverage)
      draw_all(font, &info, scale);
    good = font->coverage && !s->lacking;
  }
  free(s);
  if (!good) {
    stic_font_destroy(font);
    font = NULL;
  }
  return font;
}

void stic_font_destroy(stic_font *font)
{
  if (font)
    free(font->coverage);
  free(font);
}

int stic_font_height(const stic_font *font)
{
  return font->height;
}

/* Takes one character off UTF-8 text; malformed bytes count one by one. */
static int next_code(const char **text)
{
  const unsigned char *s = (const unsigned char *)*text;
  int length = s[0] >= 0xe0 && s[0] < 0xf0 ? 3 : s[0] >= 0xc0 && s[0] < 0xe0 ? 2 : 1;
  int code = length == 3 ? s[0] & 0xf : length == 2 ? s[0] & 0x1f : s[0];

  for (int i = 1; i < length; i++) {
    if ((s[i] & 0xc0) != 0x80) {
      *text += 1;
      return '?';
    }
    code = code << 6 | (s[i] & 0x3f);
  }
  *text += length;
  return code;
}

static const glyph *find_glyph(const stic_font *font, int code)
{
  if (code >= ASCII_FIRST && code < ASCII_FIRST + ASCII_COUNT)
    return &font->glyphs[code - ASCII_FIRST];
  for (int i = 0; i < SIGN_COUNT; i++) {
    if (signs[i] == code)
      return &font->glyphs[ASCII_COUNT + i];
  }
  return &font->glyphs['?' - ASCII_FIRST];
}

int stic_font_width(const stic_font *font, const char *text)
{
  double width = 0;

  while (*text)
    width += find_glyph(font, next_code(&text))->advance;
  return (int)ceil(width);
}

static void draw_glyph(const stic_canvas *canvas, const glyph *g, int x, int y, stic_color color)
{
  stic_rect r = stic_rect_intersect(canvas->clip, (stic_rect){x, y, x + g->width, y + g->height});

  for (int row = r.y0; row < r.y1; row++) {
    for (int column = r.x0; column < r.x1; column++) {
      int cover = g->coverage[(row - y) * g->width + column - x];

      if (cover > 0)
        stic_pixel_blend(canvas->pixels + ((size_t)row * (size_t)canvas->width + (size_t)column) * 4, color,
                         cover);
    }
  }
}

void stic_canvas_text(const stic_canvas *canvas, const stic_font *font, int x, int y, const char *text,
                      stic_color color)
{
  double pen = x;

  while (*text) {
    const glyph *g = find_glyph(font, next_code(&text));

    draw_glyph(canvas, g, (int)floor(pen + 0.5) + g->left, y + font->ascent + g->top, color);
    pen += g->advance;
  }
}

void stic_canvas_text_rimmed(const stic_canvas *canvas, const stic_font *font, int x, int y, const char *text,
                             stic_color color, stic_color rim)
{
  static const int around[8][2] = {{-1, -1}, {0, -1}, {1, -1}, {-1, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}};

  for (int i = 0; i < 8; i++)
    stic_canvas_text(canvas, font, x + around[i][0], y + around[i][1], text, rim);
  stic_canvas_text(canvas, font, x, y, text, color);
}

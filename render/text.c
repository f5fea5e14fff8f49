/* Text of the canvas: an embedded typeface baked once into coverage bitmaps, unhinted, on whole pixels. */
#include "canvas.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "font_data.h"

/* The library leaves signs out, asserts or crashes where memory is lacking. So all that it needs for one sign is had
 * before: 28 KiB at 8 px, 32 KiB at 154 px, the most in a picture of 4096 x 4096, and 42 KiB at 1000 px. */
#define SCRATCH_BYTES (1 << 17)
typedef struct scratch {
  uint8_t *bytes;
  size_t used;
} scratch;

static void *take_scratch(size_t size, scratch *s)
{
  uint8_t *at = s->bytes + s->used;

  assert(size <= SCRATCH_BYTES - s->used);
  s->used += (size + 15) / 16 * 16;
  return at;
}

#define STBTT_malloc(size, user) take_scratch(size, user)
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
  uint8_t *coverage;            /* width * height; owned */
} glyph;

struct stic_font {
  int ascent, height;
  glyph glyphs[GLYPH_COUNT];
};

static bool draw_coverage(glyph *g, const stbtt_fontinfo *info, int code, float scale)
{
  int advance, bearing, right, bottom;

  stbtt_GetCodepointHMetrics(info, code, &advance, &bearing);
  stbtt_GetCodepointBitmapBox(info, code, scale, scale, &g->left, &g->top, &right, &bottom);
  g->advance = (float)advance * scale;
  g->width = right - g->left;
  g->height = bottom - g->top;
  if (g->width == 0 || g->height == 0)
    return true;
  g->coverage = malloc((size_t)g->width * (size_t)g->height);
  if (!g->coverage)
    return false;
  stbtt_MakeCodepointBitmap(info, g->coverage, g->width, g->height, g->width, scale, scale, code);
  return true;
}

stic_font *stic_font_create(bool bold, double pixels)
{
  stic_font *font = calloc(1, sizeof *font);
  scratch s = {malloc(SCRATCH_BYTES), 0};
  stbtt_fontinfo info;
  int ascent, descent, gap;
  bool good = font && s.bytes && stbtt_InitFont(&info, bold ? stic_font_sans_bold : stic_font_sans, 0);

  if (good) {
    const float scale = stbtt_ScaleForPixelHeight(&info, (float)pixels);

    info.userdata = &s;
    stbtt_GetFontVMetrics(&info, &ascent, &descent, &gap);
    font->ascent = (int)ceilf((float)ascent * scale);
    font->height = (int)ceilf((float)(ascent - descent) * scale);
    for (int i = 0; good && i < GLYPH_COUNT; i++) {
      s.used = 0;
      good = draw_coverage(&font->glyphs[i], &info,
                           i < ASCII_COUNT ? ASCII_FIRST + i : signs[i - ASCII_COUNT], scale);
    }
  }
  free(s.bytes);
  if (good)
    return font;
  stic_font_destroy(font);
  return NULL;
}

void stic_font_destroy(stic_font *font)
{
  for (int i = 0; font && i < GLYPH_COUNT; i++)
    free(font->glyphs[i].coverage);
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

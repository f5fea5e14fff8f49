#include "page.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "assets.h"

/* ---- base64 -------------------------------------------------------------------------------- */

static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

static void encode_three(const unsigned char *in, char *text)
{
  text[0] = digits[in[0] >> 2];
  text[1] = digits[(in[0] & 3) << 4 | in[1] >> 4];
  text[2] = digits[(in[1] & 15) << 2 | in[2] >> 6];
  text[3] = digits[in[2] & 63];
}

void stic_base64_add(stic_base64 *s, const void *data, size_t length, stic_outfile *out)
{
  const unsigned char *at = data;

  for (size_t i = 0; i < length; i++) {
    s->rest[s->count++] = at[i];
    if (s->count == 3) {
      encode_three(s->rest, stic_outfile_reserve(out, 4));
      stic_outfile_used(out, 4);
      s->count = 0;
    }
  }
}

void stic_base64_end(stic_base64 *s, stic_outfile *out)
{
  char text[4];

  if (s->count == 0)
    return;
  memset(s->rest + s->count, 0, (size_t)(3 - s->count));
  encode_three(s->rest, text);
  memset(text + s->count + 1, '=', (size_t)(3 - s->count));
  stic_outfile_write(out, text, sizeof text);
  s->count = 0;
}

/* ---- text ---------------------------------------------------------------------------------- */

/* Length of the UTF-8 sequence at `s`, 0 if it is none (RFC 3629). */
static size_t utf8_length(const unsigned char *s, size_t left)
{
  static const unsigned char low[] = {0xa0, 0x80, 0x90, 0x80}, high[] = {0xbf, 0x9f, 0xbf, 0x8f};
  static const unsigned char special[] = {0xe0, 0xed, 0xf0, 0xf4};
  const size_t length = s[0] < 0x80                   ? 1
                        : s[0] >= 0xc2 && s[0] < 0xe0 ? 2
                        : s[0] >= 0xe0 && s[0] < 0xf0 ? 3
                                                      : 4;

  if (s[0] == 0 || (s[0] >= 0x80 && s[0] < 0xc2) || s[0] > 0xf4 || length > left)
    return 0;
  for (size_t i = 1; i < length; i++) {
    if ((s[i] & 0xc0) != 0x80)
      return 0;
  }
  for (size_t i = 0; i < sizeof special; i++) {
    if (s[0] == special[i] && (s[1] < low[i] || s[1] > high[i]))
      return 0;
  }
  return length;
}

char *stic_utf8_clean(const char *text, size_t length)
{
  char *clean = malloc(3 * length + 1), *at = clean;

  for (size_t i = 0; clean && i < length;) {
    const size_t n = utf8_length((const unsigned char *)text + i, length - i);

    memcpy(at, n > 0 ? text + i : "\xef\xbf\xbd", n > 0 ? n : 3);
    at += n > 0 ? n : 3;
    i += n > 0 ? n : 1;
  }
  if (clean)
    *at = '\0';
  return clean;
}

void stic_page_text(stic_outfile *out, const char *text)
{
  char *clean = stic_utf8_clean(text, strlen(text));

  for (const char *at = clean; at && *at; at++) {
    const char *as = *at == '&'   ? "&amp;"
                     : *at == '<' ? "&lt;"
                     : *at == '>' ? "&gt;"
                     : *at == '"' ? "&quot;"
                                  : NULL;

    stic_outfile_write(out, as ? as : at, as ? strlen(as) : 1);
  }
  free(clean);
}

/* ---- template ------------------------------------------------------------------------------ */

static const stic_asset *find_asset(const char *name)
{
  for (int i = 0; i < stic_asset_count; i++) {
    if (strcmp(stic_assets[i].name, name) == 0)
      return &stic_assets[i];
  }
  return NULL;
}

static void write_part(stic_outfile *out, const char *name, stic_page_part part, void *user)
{
  const stic_asset *asset = find_asset(name);
  bool known = true;

  if (asset)
    stic_outfile_write(out, asset->bytes, asset->size);
  else
    known = part(user, name, out);
  assert(known);
  (void)known;
}

/* Only the template itself has places; the other files may hold any text. */
void stic_page_write(stic_outfile *out, const char *name, stic_page_part part, void *user)
{
  const stic_asset *page = find_asset(name);
  const char *at, *end;

  assert(page);
  at = (const char *)page->bytes;
  end = at + page->size;
  while (at < end) {
    const char *place = at, *close;
    char place_name[40] = "";

    while (place + 1 < end && (place[0] != '{' || place[1] != '{'))
      place++;
    if (place + 1 >= end)
      place = end;
    stic_outfile_write(out, at, (size_t)(place - at));
    if (place == end)
      return;
    close = memchr(place, '}', (size_t)(end - place));
    assert(close && (size_t)(close - place) < sizeof place_name);
    memcpy(place_name, place + 2, (size_t)(close - place) - 2);
    write_part(out, place_name, part, user);
    at = close + 2;
  }
}

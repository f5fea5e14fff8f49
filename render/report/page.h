/* Putting a page together from its template: {{name}} stands for the built-in file of that name, or for
 * what the caller writes there. */
#ifndef STIC_PAGE_H
#define STIC_PAGE_H

#include "../../src/io/outfile.h"

/* Writes what {{name}} of the template stands for; false if it knows no such name. */
typedef bool (*stic_page_part)(void *user, const char *name, stic_outfile *out);

/* Writes the built-in file `name` with all its parts; built-in files are looked up first. */
void stic_page_write(stic_outfile *out, const char *name, stic_page_part part, void *user);

/* Base64 in pieces of any length; begin with all zero. */
typedef struct stic_base64 {
  unsigned char rest[3];
  int count; /* bytes in rest */
} stic_base64;

void stic_base64_add(stic_base64 *state, const void *data, size_t length, stic_outfile *out);
void stic_base64_end(stic_base64 *state, stic_outfile *out);

/* Text for HTML: & < > " are escaped, what is no UTF-8 is shown as U+FFFD. */
void stic_page_text(stic_outfile *out, const char *text);

/* A copy of foreign bytes in which what is no UTF-8, and 0, is U+FFFD; to be freed, NULL: no memory. */
char *stic_utf8_clean(const char *text, size_t length);

#endif

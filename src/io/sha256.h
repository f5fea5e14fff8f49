/* SHA-256 by nettle, as text: names files and logs by their content, as sha256sum does. */
#ifndef STIC_SHA256_H
#define STIC_SHA256_H

#include <nettle/sha2.h>
#include <stddef.h>

#define STIC_SHA256_TEXT 65 /* 64 digits and the final 0 */

typedef struct stic_sha256 {
  struct sha256_ctx state;
} stic_sha256;

void stic_sha256_begin(stic_sha256 *sha);
void stic_sha256_add(stic_sha256 *sha, const void *data, size_t length);
/* The digest in lower-case hexadecimal; `sha` is then used up. */
void stic_sha256_end(stic_sha256 *sha, char text[STIC_SHA256_TEXT]);

#endif

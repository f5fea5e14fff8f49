/* SHA-256 (FIPS 180-4), to name files by their content. */
#ifndef STIC_SHA256_H
#define STIC_SHA256_H

#include <stddef.h>
#include <stdint.h>

typedef struct stic_sha256 {
  uint32_t state[8];
  uint64_t length; /* bytes so far */
  unsigned char block[64];
} stic_sha256;

#define STIC_SHA256_TEXT 65 /* 64 digits and the final 0 */

void stic_sha256_begin(stic_sha256 *sha);
void stic_sha256_add(stic_sha256 *sha, const void *data, size_t length);
/* The digest in hexadecimal; `sha` is then used up. */
void stic_sha256_end(stic_sha256 *sha, char text[STIC_SHA256_TEXT]);

#endif

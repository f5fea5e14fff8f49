/* SHA-256 (FIPS 180-4), so that a log's hash can be checked by sha256sum as well. */
#ifndef STIC_SHA256_H
#define STIC_SHA256_H

#include <stddef.h>
#include <stdint.h>

#define STIC_SHA256_TEXT 65 /* bytes of the result as text, with its final 0 */

typedef struct stic_sha256 {
  uint32_t state[8];
  uint64_t length; /* bytes so far */
  unsigned char block[64];
} stic_sha256;

void stic_sha256_start(stic_sha256 *hash);
void stic_sha256_add(stic_sha256 *hash, const void *data, size_t length);
/* Ends; `text` gets 64 lower-case hexadecimal digits. */
void stic_sha256_end(stic_sha256 *hash, char text[STIC_SHA256_TEXT]);

#endif

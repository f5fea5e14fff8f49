#include "sha256.h"

#include <stdio.h>

void stic_sha256_begin(stic_sha256 *sha)
{
  sha256_init(&sha->state);
}

void stic_sha256_add(stic_sha256 *sha, const void *data, size_t length)
{
  sha256_update(&sha->state, length, data);
}

void stic_sha256_end(stic_sha256 *sha, char text[STIC_SHA256_TEXT])
{
  uint8_t digest[SHA256_DIGEST_SIZE];

  sha256_digest(&sha->state, sizeof digest, digest);
  for (size_t i = 0; i < sizeof digest; i++)
    snprintf(text + 2 * i, 3, "%02x", (unsigned)digest[i]);
}

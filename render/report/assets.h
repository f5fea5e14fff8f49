/* Files that are built into the program. */
#ifndef STIC_ASSETS_H
#define STIC_ASSETS_H

#include <stddef.h>

typedef struct stic_asset {
  const char *name;
  const unsigned char *bytes;
  size_t size;
} stic_asset;

extern const stic_asset stic_assets[];
extern const int stic_asset_count;

#endif

/* Pictures and hashes kept in the tree, each for the rasteriser that made it. STIC_BLESS=1 in the environment
 * writes those of this rasteriser; STIC_GOLDEN_REQUIRED=1 makes a rasteriser without any a failure. */
#ifndef STIC_TEST_GOLDEN_H
#define STIC_TEST_GOLDEN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "render.h"

typedef enum stic_verdict { STIC_SAME, STIC_DIFFERENT, STIC_NO_GOLDEN } stic_verdict;

/* Pictures agree if all channels of all but 1 in 500 pixels differ by at most 16. */
bool stic_pictures_agree(const stic_image *a, const stic_image *b);

/* Compares with golden/NAME-RASTERISER.png. */
stic_verdict stic_golden_picture(const char *name, const char *rasteriser, const stic_image *image);

/* Compares with the line "RASTERISER NAME HASH" of golden/hashes.txt. */
stic_verdict stic_golden_hash(const char *name, const char *rasteriser, uint64_t hash);

/* FNV-1a. */
uint64_t stic_hash(const void *data, size_t size);

#endif

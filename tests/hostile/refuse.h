/* Requests of our own code that can be refused: linked in by --wrap (REFUSABLE in CMakeLists.txt), so that what other
 * libraries ask for goes its usual way. Blocks are counted, too: what was asked for has to be given back. */
#ifndef STIC_TEST_REFUSE_H
#define STIC_TEST_REFUSE_H

#include <stdbool.h>

typedef enum refused {
  REFUSED_NOTHING, /* the n-th request did not come */
  REFUSED_MEMORY,
  REFUSED_SYSTEM /* a thread, a pipe, a folder, a library: whatever the system may lack */
} refused;

/* From now on the n-th request (from 1; 0: none) of the calling thread is refused, or that one and all after it. */
void refuse_begin(int n, bool all_after);
/* No more; what the n-th was. */
refused refuse_end(void);

/* How many requests the calling thread has made since refuse_begin(). */
int refuse_asked(void);

/* Blocks that any thread has got since the last refuse_begin() and not given back. */
int refuse_blocks_left(void);

#endif

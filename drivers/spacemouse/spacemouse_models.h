/* Which 3Dconnexion devices there are. */
#ifndef STIC_SPACEMOUSE_MODELS_H
#define STIC_SPACEMOUSE_MODELS_H

#include <stdbool.h>
#include <stdint.h>

/* How a model sends motion; for people only: the decoder goes by each report's ID and length. */
typedef enum stic_spacemouse_layout {
  STIC_SPACEMOUSE_SPLIT,   /* translation and rotation in reports 1 and 2 */
  STIC_SPACEMOUSE_COMBINED /* both in report 1 */
} stic_spacemouse_layout;

typedef struct stic_spacemouse_model {
  uint16_t vendor, product;
  const char *name;
  stic_spacemouse_layout layout;
  int grip_key; /* bit of report 3 that the key named 1, or the left one, sets; 0..31 */
} stic_spacemouse_model;

/* The table's entries in order; NULL past its end. Real-time: yes. */
const stic_spacemouse_model *stic_spacemouse_model_at(int index);

/* The model with these numbers; NULL: none of ours. Real-time: yes. */
const stic_spacemouse_model *stic_spacemouse_find(uint16_t vendor, uint16_t product);

/* The model of a device: by its numbers or, where they are none of the table's, by what it calls itself, since
 * adapters hide numbers and new models have new ones. `name` may be NULL. NULL: none of ours. Real-time: yes. */
const stic_spacemouse_model *stic_spacemouse_identify(uint16_t vendor, uint16_t product, const char *name);

/* Products of the same maker that are mice and keyboards without a cap, to be left alone. Real-time: yes. */
bool stic_spacemouse_never(uint16_t vendor, uint16_t product);

#endif

/* The moments of a run that tell what it is about: each change of state, the first and the largest slip, the
 * largest snap, start and end. */
#ifndef STIC_MOMENTS_H
#define STIC_MOMENTS_H

#include "../stiction.h"

#define STIC_MOMENT_TEXT_MAX 200

typedef struct stic_moment {
  int64_t row, t_ns;
  unsigned why; /* sum of STIC_MOMENT_ */
  stic_state before, state;
  char what[STIC_MOMENT_TEXT_MAX]; /* the row's events in words; "" if none */
} stic_moment;

enum {
  STIC_MOMENT_START = 1,
  STIC_MOMENT_CHANGE = 2,
  STIC_MOMENT_FIRST_SLIP = 4,
  STIC_MOMENT_LARGEST_SLIP = 8,
  STIC_MOMENT_LARGEST_SNAP = 16,
  STIC_MOMENT_END = 32
};

/* Start with all zero. */
typedef struct stic_moments {
  int64_t rows;
  stic_state state;     /* of the last row */
  stic_moment *changes; /* owned */
  int change_count, change_room;
  stic_moment start, first_slip, largest_slip, largest_snap, end; /* why 0: there is none */
  double slip, snap;                                              /* m, rad: the largest so far */
} stic_moments;

/* Notes a row and its events. False without memory. */
bool stic_moments_add(stic_moments *moments, const stic_scene *scene, const stic_result *result,
                      const stic_event *events, int event_count);

/* After the last row: at most `most` moments in order of time, evenly thinned, into out. Returns how many. If they
 * cannot all be shown, the largest slip stays longest, then end, first slip, largest snap, start. */
int stic_moments_choose(const stic_moments *moments, int most, stic_moment *out);

/* For a caption: "free -> vertex" or the state alone, and why it is shown with what happened. */
void stic_moment_title(const stic_moment *moment, char *out, size_t out_size);
void stic_moment_text(const stic_moment *moment, char *out, size_t out_size);

void stic_moments_free(stic_moments *moments);

#endif

/* The invariants of the model that a row can be held against: no oracle is needed. Tests and benches link it. */
#ifndef STIC_CHECKER_H
#define STIC_CHECKER_H

#include "../stiction.h"

/* What a checker knows between rows. */
typedef struct stic_checker {
  const stic_scene *scene;
  double ulp;  /* of the precision used, relative */
  double size; /* of the object, m */
  bool first;
  stic_result last;
  double free[2];       /* m: where the object last was without contacts, at first its start */
  double last_rounding; /* of the row before: a pose that is kept was right within that */
  char complaint[512];  /* "" while all is well */
  /* largest values seen, in units of what is allowed */
  double worst_depth, worst_residual, worst_anchor;
  double worst_relative_residual; /* of force and moment, relative to the largest term */
  long rows, contacts, flagged, tiny_slides;
} stic_checker;

/* `scene` must outlive the checker. */
void stic_checker_init(stic_checker *k, const stic_scene *scene, stic_precision precision);

/* Holds the next row and its events against the invariants; the first one broken stays in `complaint`.
 * may_slide: JUDGE may have chosen a slide in this row. Real-time: no. */
void stic_checker_row(stic_checker *k, const stic_result *r, const stic_event *events, int event_count,
                      bool may_slide);

/* Rounding of the coordinates, m: 4 ulp of the largest, in double as a row is, and in single precision of those from
 * the object's start, near which it counts. The angle rounds too, and moves a vertex by size times that. */
double stic_checker_rounding(const stic_checker *k, const stic_result *r);

/* The same vertex on the same surface? */
bool stic_same_contact(const stic_contact *a, const stic_contact *b);

#endif

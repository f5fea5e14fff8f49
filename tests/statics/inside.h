/* What a statics core compiled for tests reports about its inside, for all precisions together. */
#ifndef STICTION_TESTS_INSIDE_H
#define STICTION_TESTS_INSIDE_H

typedef struct inside {
  long holds;             /* calls of HOLD */
  double worst_rise;      /* largest rise of the spring energy by one, in units of what rounding allows */
  unsigned decisions;     /* STIC_DECISION_ bits of all judgements */
  unsigned row_decisions; /* ... since this was last set to zero */
  int stages_worst;
  double raise; /* control: HOLD leaves the object this much off, in sizes */
} inside;

extern inside inside_report;

#endif

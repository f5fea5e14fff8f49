/* The review page of a replay: feeds render/report from a session. */
#ifndef STIC_REVIEW_H
#define STIC_REVIEW_H

#include "report.h"
#include "session.h"

/* All zero is a replay without a page; every function then does nothing. */
typedef struct stic_review {
  stic_report *report;
  char *command;     /* the command line, as a shell takes it */
  const char *video; /* what the page shows; NULL: no video */
  char why[600];     /* ... and why */
} stic_review;

/* What a page is about. */
typedef struct stic_review_source {
  const char *scene, *trace; /* paths */
  int argc;                  /* the command's arguments, from its name on */
  const char *const *argv;
  int fps;
  const char *video; /* asked for beside the page; NULL: the page has its own */
} stic_review_source;

/* Prepares a page for `path` (NULL: none). Refuses what cannot be written. */
stic_status stic_review_open(stic_review *review, const char *path, const stic_session *session,
                             const stic_review_source *source, stic_error *err);

/* There will be no video, as `err` says. */
void stic_review_no_video(stic_review *review, const stic_error *err);

/* Notes the session's last step. */
void stic_review_add(stic_review *review, const stic_session *session, int64_t frame_ns);

/* Writes the page and moves it into place, once the video is in its own. */
stic_status stic_review_finish(stic_review *review, const stic_session *session, stic_error *err);

void stic_review_close(stic_review *review);

#endif

/* A page to review a run: one HTML file that needs no network, with the video beside synchronized plots,
 * events, parameters and provenance. Samples are gathered while the run goes on; the page is written at
 * its end and appears whole or not at all. */
#ifndef STIC_REPORT_H
#define STIC_REPORT_H

#include "../../src/io/timing.h"
#include "../../src/stiction.h"

/* What the page says of the run. All is borrowed until stic_report_close(). */
typedef struct stic_report_settings {
  const char *path; /* of the page; "-": standard output */
  const stic_scene *scene;
  const stic_settings *solver;
  const char *scene_path, *scene_text;
  const char *input_kind, *input; /* "trace" or "device", and its path or description */
  const char *command;            /* the command line; "": not known */
  const stic_override *overrides; /* may be NULL if override_count is 0 */
  int override_count;
  int fps; /* frames a second of the page and of the video, 1..1000 */
} stic_report_settings;

/* Opaque. */
typedef struct stic_report stic_report;

/* Refuses what cannot be written. The caller owns `*report`. Errors: STIC_USAGE, STIC_CANNOT_WRITE,
 * STIC_NO_MEMORY. Real-time: no. */
stic_status stic_report_open(const stic_report_settings *settings, stic_report **report, stic_error *err);

/* Where a video for the page alone may be put: beside the page, removed by stic_report_close(). NULL for
 * pages that go to no file. Valid as long as the report. */
const char *stic_report_video_path(const stic_report *report);

/* Notes a result with its events; `frame_ns`: what the sample cost, 0: not measured. Lack of memory shows
 * at the end. */
void stic_report_add(stic_report *report, const stic_result *result, const stic_event *events, int count,
                     int64_t frame_ns);

/* Above this a browser cannot take a video out of a page. */
#define STIC_REPORT_VIDEO_MAX (256 * 1024 * 1024)

/* Writes the page. `video` is a finished .mp4 or .webm whose frame i shows t_0 + i / fps; NULL: the page
 * draws the scene from the data and says `why_no_video`. `timing` NULL: no clock value is in the page.
 * Errors: STIC_BAD_INPUT (video or trace cannot be read), STIC_CANNOT_WRITE, STIC_NO_MEMORY. */
stic_status stic_report_finish(stic_report *report, const char *video, const char *why_no_video,
                               const stic_timing *timing, stic_error *err);

/* After finish: moves the page into place. */
stic_status stic_report_keep(stic_report *report, stic_error *err);

/* Ends; a page that was not kept leaves nothing. NULL allowed. */
void stic_report_close(stic_report *report);

#endif

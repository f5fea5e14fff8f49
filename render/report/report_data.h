/* What a report gathers; shared by its own sources. */
#ifndef STIC_REPORT_DATA_H
#define STIC_REPORT_DATA_H

#include "column.h"
#include "page.h"
#include "report.h"

/* Every column of the page's data: name and kind as the page's script knows them. Per sample, per
 * contact (all contacts of the first sample, then of the next, ...), per event. */
#define STIC_REPORT_COLUMNS(X)                                                                               \
  X(t, "f64")                                                                                                \
  X(x, "f32") X(y, "f32") X(theta, "f32") X(hand_x, "f32") X(hand_y, "f32") X(hand_theta, "f32")             \
    X(hold_x, "f32") X(hold_y, "f32") X(force_x, "f32") X(force_y, "f32") X(moment, "f32") X(slips, "u32")   \
      X(state, "u8") X(flags, "u8") X(contacts, "u8") X(frame_us, "f32") X(c_vertex, "u8")                   \
        X(c_surface, "u8") X(c_x, "f32") X(c_y, "f32") X(c_normal, "f32") X(c_friction, "f32") X(e_t, "f64") \
          X(e_kind, "u8") X(e_vertex, "i16") X(e_surface, "i16") X(e_x, "f32") X(e_y, "f32")                 \
            X(e_length, "f32")

enum {
#define X(name, kind) STIC_REPORT_##name,
  STIC_REPORT_COLUMNS(X)
#undef X
    STIC_REPORT_COLUMN_COUNT
};

struct stic_report {
  stic_report_settings settings;
  stic_outfile *out;
  char *video_path; /* for a video of ours; NULL: nowhere */
  char *scene_text; /* UTF-8 */
  int64_t first_ns, last_ns;
  int64_t rows, events;
  stic_column columns[STIC_REPORT_COLUMN_COUNT];
};

/* The video that goes into the page. */
typedef struct stic_report_video {
  const char *path; /* NULL: none */
  const char *why;  /* ... and why */
  const char *mime;
  int64_t size;
} stic_report_video;

/* The page's description of the run as JSON, safe inside a script element. To be freed. Errors:
 * STIC_BAD_INPUT, STIC_NO_MEMORY. */
stic_status stic_report_json(const stic_report *report, const stic_report_video *video,
                             const stic_timing *timing, char **json, stic_error *err);

#endif

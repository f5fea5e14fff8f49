/* stiction still: one moment of a run as a picture, or its telling moments as a contact sheet. */
#include "../error.h"
#include "../io/trace_csv.h"
#include "../number.h"
#include "cli.h"
#include "moments.h"
#include "pictures.h"
#include "png_encoder.h"
#include "session.h"
#include "sheet.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define COLUMNS_MAX 16
#define ROWS_MAX 64
#define NOT_GIVEN INT_MIN /* of them */

static const stic_cli_usage usage = {
  "still", "[OPTION...] SCENE TRACE",
  "Writes one PNG file (--out). With --at T it shows the newest result at T seconds of the trace, as replay's\n"
  "pictures do; T may also be first-slip, largest-slip or end. With --sheet it is a contact sheet: each change of\n"
  "state, the first and the largest slip, start and end, with captions, evenly thinned if they are too many.\n",
  2, 2};

typedef struct still_options {
  char *at, *out;
  int sheet, columns, rows, lenient;
  stic_session_options session;
  stic_picture_options pictures;
} still_options;

typedef struct still {
  stic_session session; /* its simulation looks at all of the trace first */
  stic_sample *samples; /* owned */
  stic_sheet_row *rows; /* owned; of the sheet, NULL: none wanted */
  size_t count, room;
  stic_moments moments;
  stic_extent extent;
  stic_render_settings render;
  stic_outfile *out;
  const stic_moment *moment; /* that --at names; NULL: at_ns */
  int64_t at_ns;
  const char *scene_path, *trace_path;
} still;

/* ---- command line ------------------------------------------------------------------------ */

static stic_status refuse(const char *what, stic_error *err)
{
  return stic_error_set(err, STIC_USAGE, NULL, 0, "still: %s", what);
}

/* A picture under a name that says something else would not open. */
static bool is_png_name(const char *path)
{
  const size_t length = strlen(path);
  struct stat there;

  return strcmp(path, "-") == 0 || (length > 4 && strcmp(path + length - 4, ".png") == 0) ||
         (stat(path, &there) == 0 && !S_ISREG(there.st_mode) && !S_ISDIR(there.st_mode));
}

static stic_status parse_at(const char *text, still *s, stic_error *err)
{
  const struct {
    const char *name;
    const stic_moment *moment;
  } named[] = {{"first-slip", &s->moments.first_slip},
               {"largest-slip", &s->moments.largest_slip},
               {"end", &s->moments.end}};

  for (size_t i = 0; i < sizeof named / sizeof named[0]; i++) {
    if (strcmp(text, named[i].name) == 0)
      s->moment = named[i].moment;
  }
  if (!s->moment && stic_number_parse_ns(text, strlen(text), &s->at_ns) != STIC_NUMBER_OK)
    return stic_error_set(err, STIC_USAGE, NULL, 0,
                          "--at %.40s: expected seconds of the trace, first-slip, largest-slip or end", text);
  return STIC_OK;
}

/* The number of the newest sample at the time wanted. */
static stic_status find_row(const still *s, size_t *row, stic_error *err)
{
  const int64_t first_ns = s->samples[0].t_ns, last_ns = s->samples[s->count - 1].t_ns;

  if (s->moment && !s->moment->why)
    return stic_error_set(err, STIC_USAGE, NULL, 0,
                          "--at: nothing slips in this trace; expected seconds or end");
  *row = s->count - 1;
  if (s->moment) {
    *row = (size_t)s->moment->row;
    return STIC_OK;
  }
  if (s->at_ns < first_ns || s->at_ns > last_ns)
    return stic_error_set(err, STIC_USAGE, NULL, 0, "--at %.9g is outside the trace; expected %.9g to %.9g s",
                          (double)s->at_ns * 1e-9, (double)first_ns * 1e-9, (double)last_ns * 1e-9);
  while (s->samples[*row].t_ns > s->at_ns)
    --*row;
  return STIC_OK;
}

static stic_status check_count(const char *option, int count, int most, stic_error *err)
{
  if (count != NOT_GIVEN && (count < 1 || count > most))
    return stic_error_set(err, STIC_USAGE, NULL, 0, "--%s %d: expected 1 to %d", option, count, most);
  return STIC_OK;
}

static stic_status check_options(const still_options *o, still *s, stic_error *err)
{
  if (!o->at == !o->sheet)
    return refuse("expected either --at T or --sheet", err);
  if (!o->out)
    return refuse("no output; expected --out FILE.png", err);
  if (!is_png_name(o->out))
    return stic_error_set(err, STIC_USAGE, NULL, 0, "--out %.200s: expected a name that ends with .png",
                          o->out);
  if (o->at && (o->columns != NOT_GIVEN || o->rows != NOT_GIVEN))
    return refuse("--columns and --rows are for --sheet", err);
  if (o->at && parse_at(o->at, s, err) != STIC_OK)
    return err->status;
  if (check_count("columns", o->columns, COLUMNS_MAX, err) != STIC_OK ||
      check_count("rows", o->rows, ROWS_MAX, err) != STIC_OK)
    return err->status;
  stic_render_settings_init(&s->render);
  if (o->sheet) {
    s->render.width = 640;
    s->render.height = 480;
  }
  return stic_pictures_apply(&o->pictures, &s->render, err);
}

/* ---- the trace --------------------------------------------------------------------------- */

static void on_problem(void *context, bool warning, const stic_error *problem)
{
  stic_error *first_skipped = context;

  if (warning)
    stic_cli_warn(problem);
  else if (first_skipped->status == STIC_OK)
    *first_skipped = *problem;
}

static void tell_skipped(const stic_trace_reader *reader, const stic_error *first)
{
  const long long count = (long long)stic_trace_skipped(reader);
  char text[800];

  if (count == 0)
    return;
  stic_error_format(first, text, sizeof text);
  stic_cli_say("%lld bad line%s passed over, the first: %s", count, count == 1 ? "" : "s", text);
}

static bool make_room(still *s, bool sheet)
{
  const size_t room = s->room > 0 ? 2 * s->room : 4096;
  stic_sample *samples = realloc(s->samples, room * sizeof *samples);
  stic_sheet_row *rows = NULL;

  if (samples)
    s->samples = samples;
  if (sheet)
    rows = realloc(s->rows, room * sizeof *rows);
  if (rows)
    s->rows = rows;
  if (!samples || (sheet && !rows))
    return false;
  s->room = room;
  return true;
}

/* Solves the sample and notes what the pictures need to know of it beforehand. */
static bool note_sample(still *s, const stic_sample *sample, bool sheet)
{
  const stic_result *r = &s->session.result;
  const stic_event *events;
  int event_count;

  if (s->count == s->room && !make_room(s, sheet))
    return false;
  s->samples[s->count] = *sample;
  stic_session_step(&s->session, sample, 0);
  stic_extent_add(&s->extent, &s->session.scene, r);
  if (sheet)
    s->rows[s->count] = (stic_sheet_row){r->t_ns, r->state, (r->flags & STIC_FLAG_SLIPPED) != 0};
  events = stic_sim_events(s->session.sim, &event_count);
  if (!stic_moments_add(&s->moments, &s->session.scene, r, events, event_count))
    return false;
  s->count++;
  return true;
}

static stic_status read_all(still *s, stic_trace_reader *reader, bool sheet, stic_error *err)
{
  stic_sample sample;

  while (stic_cli_signal() == 0) {
    switch (stic_trace_next(reader, &sample, err)) {
    case STIC_TRACE_END: return STIC_OK;
    case STIC_TRACE_BAD: return err->status;
    case STIC_TRACE_WAIT: continue;
    case STIC_TRACE_SAMPLE: break;
    }
    if (!note_sample(s, &sample, sheet))
      return stic_error_set(err, STIC_NO_MEMORY, s->trace_path, 0, "no memory for a trace of this length");
  }
  return STIC_OK;
}

static stic_status look_at_trace(still *s, const still_options *o, stic_error *err)
{
  stic_error skipped = {.status = STIC_OK};
  const stic_trace_options options = {o->lenient != 0, on_problem, &skipped};
  stic_trace_reader *reader;
  stic_status status = stic_trace_open(s->trace_path, &options, &reader, err);

  stic_extent_init(&s->extent);
  if (status == STIC_OK)
    status = read_all(s, reader, o->sheet != 0, err);
  if (status == STIC_OK)
    tell_skipped(reader, &skipped);
  stic_trace_close(reader);
  return status;
}

/* ---- pictures ---------------------------------------------------------------------------- */

/* A second way through the trace, now with pictures. */
typedef struct walk {
  stic_sim *sim;
  stic_render *render;
  size_t next; /* sample */
} walk;

static stic_status start_walk(still *s, walk *w, stic_error *err)
{
  stic_status status = stic_sim_create(&s->session.scene, &s->session.settings, &w->sim, err);

  s->render.extent = &s->extent;
  return status == STIC_OK ? stic_render_create(&s->session.scene, &s->render, &w->render, err) : status;
}

static void end_walk(walk *w)
{
  stic_render_destroy(w->render);
  stic_sim_destroy(w->sim);
}

/* The picture of row `row`, not before the last one's. */
static stic_status draw_row(const still *s, walk *w, size_t row, stic_image *image, stic_error *err)
{
  stic_result result;

  for (; w->next <= row && stic_cli_signal() == 0; w->next++) {
    stic_sim_step(w->sim, &s->samples[w->next], &result);
    stic_render_observe(w->render, &result);
  }
  return w->next > 0 ? stic_render_draw(w->render, image, err) : STIC_OK;
}

static stic_status write_png(still *s, const stic_image *image, stic_error *err)
{
  stic_png_encoder *encoder = stic_png_encoder_create(STIC_PNG_SMALL);
  size_t length = 0;
  const uint8_t *png = encoder ? stic_png_encode(encoder, image, &length) : NULL;

  if (png)
    stic_outfile_write(s->out, png, length);
  stic_png_encoder_destroy(encoder);
  return png ? STIC_OK : stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "no memory for writing a picture");
}

static stic_status make_picture(still *s, stic_error *err)
{
  walk w = {NULL, NULL, 0};
  stic_image image;
  size_t row = 0;
  stic_status status = find_row(s, &row, err);

  if (status == STIC_OK)
    status = start_walk(s, &w, err);
  if (status == STIC_OK)
    status = draw_row(s, &w, row, &image, err);
  if (status == STIC_OK && stic_cli_signal() == 0)
    status = write_png(s, &image, err);
  end_walk(&w);
  return status;
}

/* ---- sheet ------------------------------------------------------------------------------- */

/* The name alone: a sheet is the same wherever its files are. */
static const char *base_name(const char *path)
{
  const char *slash = strrchr(path, '/');

  return slash && slash[1] ? slash + 1 : path;
}

static void sheet_words(const still *s, char *title, size_t title_size, char *subtitle, size_t subtitle_size)
{
  const stic_scene *scene = &s->session.scene;
  const double length = (double)(s->samples[s->count - 1].t_ns - s->samples[0].t_ns) * 1e-9;
  const long long slips = (long long)s->session.result.slips;
  const char *const dot = " \xc2\xb7 ";
  char accuracy[40];

  stic_settings_accuracy_text(&s->session.settings, accuracy, sizeof accuracy);
  snprintf(title, title_size, "%s", scene->name[0] ? scene->name : base_name(s->scene_path));
  snprintf(
    subtitle, subtitle_size, "%s, %s%s%zu samples in %.3f s%s%lld slip%s (marks under the band)%s%s, %s",
    base_name(s->scene_path), strcmp(s->trace_path, "-") == 0 ? "standard input" : base_name(s->trace_path),
    dot, s->count, length, dot, slips, slips == 1 ? "" : "s", dot, accuracy,
    stic_precision_name(s->session.settings.precision));
}

static stic_status place_pictures(still *s, stic_sheet *sheet, const stic_moment *moments, int count,
                                  stic_error *err)
{
  walk w = {NULL, NULL, 0};
  stic_status status = start_walk(s, &w, err);

  for (int i = 0; i < count && status == STIC_OK && stic_cli_signal() == 0; i++) {
    char title[64], text[STIC_MOMENT_TEXT_MAX + 64];
    const stic_sheet_caption caption = {moments[i].t_ns, title, text};
    stic_image image;

    stic_moment_title(&moments[i], title, sizeof title);
    stic_moment_text(&moments[i], text, sizeof text);
    status = draw_row(s, &w, (size_t)moments[i].row, &image, err);
    if (status == STIC_OK && stic_cli_signal() == 0)
      stic_sheet_place(sheet, i, &image, &caption);
  }
  end_walk(&w);
  return status;
}

static stic_status fill_sheet(still *s, stic_sheet *sheet, const stic_moment *moments, int count,
                              stic_error *err)
{
  int64_t marks[COLUMNS_MAX * ROWS_MAX];
  stic_image image;
  stic_status status;

  for (int i = 0; i < count; i++)
    marks[i] = moments[i].t_ns;
  stic_sheet_draw_band(sheet, s->rows, s->count, marks, count);
  status = place_pictures(s, sheet, moments, count, err);
  image = stic_sheet_image(sheet);
  return status == STIC_OK && stic_cli_signal() == 0 ? write_png(s, &image, err) : status;
}

/* Three or four side by side, whichever leaves fewer places empty. */
static int choose_columns(int wanted, int count)
{
  const int columns = wanted != NOT_GIVEN                                           ? wanted
                      : count % 3 == 0 || (3 - count % 3) % 3 < (4 - count % 4) % 4 ? 3
                                                                                    : 4;

  return count < columns ? count : columns;
}

static stic_status make_sheet(still *s, const still_options *o, stic_error *err)
{
  const int columns = o->columns != NOT_GIVEN ? o->columns : 3, rows = o->rows != NOT_GIVEN ? o->rows : 4;
  stic_moment *moments = malloc((size_t)(columns * rows) * sizeof *moments);
  char title[128], subtitle[512];
  stic_sheet_settings settings = {columns,        0,     s->render.width, s->render.height,
                                  s->render.look, title, subtitle};
  stic_sheet *sheet;
  stic_status status;

  if (!moments)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  settings.count = stic_moments_choose(&s->moments, columns * rows, moments);
  settings.columns = choose_columns(o->columns, settings.count);
  sheet_words(s, title, sizeof title, subtitle, sizeof subtitle);
  status = stic_sheet_create(&settings, &sheet, err);
  if (status == STIC_OK)
    status = fill_sheet(s, sheet, moments, settings.count, err);
  stic_sheet_destroy(sheet);
  free(moments);
  return status;
}

/* ---- command ----------------------------------------------------------------------------- */

static int finish(still *s, stic_error *err)
{
  stic_outfile *out = s->out;

  s->out = NULL;
  return stic_outfile_commit(out, err) == STIC_OK ? STIC_OK : stic_cli_fail(err);
}

static int run(still *s, const still_options *o)
{
  stic_error err;
  stic_status status = check_options(o, s, &err);

  if (status == STIC_OK)
    status = stic_cli_check_paths((const char *const[]){s->scene_path, s->trace_path}, 2,
                                  (const char *const[]){o->out}, 1, &err);
  if (status == STIC_OK)
    status = stic_session_open(&s->session, &o->session, s->scene_path, "trace", s->trace_path, &err);
  if (status == STIC_OK)
    status = stic_outfile_open(o->out, &s->out, &err);
  if (status == STIC_OK)
    status = look_at_trace(s, o, &err);
  if (status == STIC_OK && stic_cli_signal() == 0)
    status = o->sheet ? make_sheet(s, o, &err) : make_picture(s, &err);
  if (stic_cli_signal() != 0)
    return STIC_EXIT_SIGNAL + stic_cli_signal();
  return status == STIC_OK ? finish(s, &err) : stic_cli_fail(&err);
}

int stic_cmd_still(int argc, const char **argv)
{
  still_options o = {.columns = NOT_GIVEN, .rows = NOT_GIVEN};
  const struct poptOption table[] = {
    {"at", '\0', POPT_ARG_STRING, &o.at, 0, "Show this moment: seconds of the trace, or its name", "T"},
    {"sheet", '\0', POPT_ARG_NONE, &o.sheet, 0, "Show the telling moments of the whole trace", NULL},
    {"out", 'o', POPT_ARG_STRING, &o.out, 0, "The PNG file to write ('-': standard output)", "FILE.png"},
    {"columns", '\0', POPT_ARG_INT, &o.columns, 0, "Pictures side by side on a sheet (default 3 or 4)", "N"},
    {"rows", '\0', POPT_ARG_INT, &o.rows, 0, "At most so many rows of them (default 4)", "N"},
    STIC_PICTURE_OPTIONS(&o.pictures),
    {"lenient", '\0', POPT_ARG_NONE, &o.lenient, 0, "Pass over bad lines of the trace and count them", NULL},
    STIC_SOLVER_OPTIONS(&o.session, "frame, substep=N or event (default)"),
    POPT_TABLEEND};
  still s = {.samples = NULL};
  stic_cli_args args;
  int code = stic_cli_parse(&usage, table, argc, argv, &args);

  if (code < 0) {
    s.scene_path = args.positions[0];
    s.trace_path = args.positions[1];
    code = run(&s, &o);
  }
  stic_outfile_abort(s.out);
  stic_session_close(&s.session);
  stic_moments_free(&s.moments);
  free(s.samples);
  free(s.rows);
  stic_cli_args_free(&args);
  stic_session_options_free(&o.session);
  stic_picture_options_free(&o.pictures);
  free(o.at);
  free(o.out);
  return code;
}

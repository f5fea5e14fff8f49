#include "plot.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../../src/error.h"
#include "figure.h"
#include "gnuplot.h"

/* Names while a figure is made: everything happens in a folder of its own. */
typedef struct workshop {
  char folder[256];
  char stem[208];     /* of the picture's name */
  const char *format; /* "svg", "pdf", "png" */
  const char *target;
} workshop;

static stic_state state_of(int figure)
{
  return figure <= 10 ? STIC_VERTEX : STIC_TWO_VERTEX;
}

bool stic_plot_has_state(const stic_plot *p, int figure)
{
  for (int64_t i = 0; i < p->count; i++) {
    if (p->rows[i].state == state_of(figure))
      return true;
  }
  return false;
}

bool stic_plot_has_forces(const stic_plot *p)
{
  return p->surface_count > 0;
}

/* The rows to draw: those of the given stretch, or from the first to the last of the figure's state. */
static void choose_rows(const stic_plot *p, const stic_plot_settings *s, int64_t *from, int64_t *to)
{
  const bool by_state = s->from > s->to;
  const bool has_state = by_state && stic_plot_has_state(p, s->figure);

  *from = *to = 0;
  for (int64_t i = 0; i < p->count; i++) {
    const stic_plot_row *r = &p->rows[i];
    const bool wanted =
      by_state ? !has_state || r->state == state_of(s->figure) : r->t >= s->from && r->t <= s->to;

    if (wanted && *to == 0)
      *from = i;
    if (wanted)
      *to = i + 1;
  }
  /* One more on each side where there is one: how the state came and went. */
  if (by_state && has_state) {
    *from -= *from > 0;
    *to += *to < p->count;
  }
}

/* ---- names --------------------------------------------------------------------------------- */

static stic_status name_parts(const char *path, workshop *w, stic_error *err)
{
  static const char *const formats[] = {"svg", "pdf", "png"};
  const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');

  w->format = NULL;
  w->target = path;
  for (int i = 0; dot && dot > name && i < 3; i++) {
    if (strcmp(dot + 1, formats[i]) == 0)
      w->format = formats[i];
  }
  if (!w->format || (size_t)(dot - name) >= sizeof w->stem)
    return stic_error_set(err, STIC_USAGE, path, 0, "a plot's name has to end in .svg, .pdf or .png");
  memcpy(w->stem, name, (size_t)(dot - name));
  w->stem[dot - name] = '\0';
  for (char *c = w->stem; *c; c++) {
    if ((unsigned char)*c < ' ')
      *c = '_'; /* a line's end would end a command of gnuplot's */
  }
  return STIC_OK;
}

/* A file of the workshop. */
static void inside(const workshop *w, const char *ending, char *out, size_t size)
{
  snprintf(out, size, "%s/%s.%s", w->folder, w->stem, ending);
}

/* A file beside the target. */
static char *beside(const workshop *w, const char *ending)
{
  const size_t room = strlen(w->target) + 8;
  char *path = malloc(room);

  if (path)
    snprintf(path, room, "%.*s.%s", (int)(strrchr(w->target, '.') - w->target), w->target, ending);
  return path;
}

static stic_status open_workshop(workshop *w, stic_error *err)
{
  const char *base = getenv("TMPDIR");

  snprintf(w->folder, sizeof w->folder, "%.200s/stiction-plot-XXXXXX", base && *base ? base : "/tmp");
  if (!mkdtemp(w->folder))
    return stic_error_set(err, STIC_CANNOT_WRITE, w->folder, 0, "cannot make a temporary folder: %s",
                          strerror(errno));
  return STIC_OK;
}

static void close_workshop(const workshop *w)
{
  static const char *const endings[] = {"gp", "dat", "svg", "pdf", "png"};
  char path[512];

  for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++) {
    inside(w, endings[i], path, sizeof path);
    unlink(path);
  }
  rmdir(w->folder);
}

/* ---- making -------------------------------------------------------------------------------- */

static stic_status write_part(const stic_figure *f, const workshop *w, const char *ending,
                              void (*write)(const stic_figure *, stic_outfile *), stic_error *err)
{
  stic_outfile *out = NULL;
  char path[512];
  stic_status status;

  inside(w, ending, path, sizeof path);
  status = stic_outfile_open(path, &out, err);
  if (status == STIC_OK) {
    write(f, out);
    status = stic_outfile_commit(out, err);
  }
  return status;
}

/* cairo writes the time into a PDF; the same log has to give the same file. */
static void fix_date(char *bytes, size_t size)
{
  static const char key[] = "/CreationDate (D:";
  static const char date[] = "20000101000000";

  for (size_t i = 0; i + sizeof key + sizeof date < size; i++) {
    if (memcmp(bytes + i, key, sizeof key - 1) == 0)
      memcpy(bytes + i + sizeof key - 1, date, sizeof date - 1);
  }
}

static stic_status copy_file(const char *from, const char *to, bool is_pdf, stic_error *err)
{
  FILE *file = fopen(from, "rb");
  stic_outfile *out = NULL;
  char *bytes = NULL;
  size_t size = 0;
  stic_status status = STIC_OK;

  if (file && fseek(file, 0, SEEK_END) == 0 && ftell(file) > 0) {
    size = (size_t)ftell(file);
    rewind(file);
    bytes = malloc(size);
  }
  if (size > 0 && !bytes)
    status = stic_error_set(err, STIC_NO_MEMORY, to, 0, "out of memory");
  else if (!bytes || fread(bytes, 1, size, file) != size)
    status = stic_error_set(err, STIC_CANNOT_WRITE, to, 0, "gnuplot made no picture");
  if (file)
    fclose(file);
  if (status == STIC_OK)
    status = stic_outfile_open(to, &out, err);
  if (status == STIC_OK) {
    if (is_pdf)
      fix_date(bytes, size);
    stic_outfile_write(out, bytes, size);
    status = stic_outfile_commit(out, err);
  }
  free(bytes);
  return status;
}

static stic_status keep_part(const workshop *w, const char *ending, stic_error *err)
{
  char *to = beside(w, ending), from[512];
  stic_status status;

  if (!to)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  inside(w, ending, from, sizeof from);
  status = copy_file(from, to, false, err);
  free(to);
  return status;
}

static stic_status make(const stic_figure *f, const workshop *w, bool keep, stic_error *err)
{
  char script[512], picture[512];
  stic_status status = write_part(f, w, "dat", stic_figure_data, err);

  if (status == STIC_OK)
    status = write_part(f, w, "gp", stic_figure_script, err);
  snprintf(script, sizeof script, "%s.gp", w->stem);
  if (status == STIC_OK)
    status = stic_gnuplot_run(w->folder, script, w->format, err);
  inside(w, w->format, picture, sizeof picture);
  if (status == STIC_OK)
    status = copy_file(picture, w->target, strcmp(w->format, "pdf") == 0, err);
  if (status == STIC_OK && keep)
    status = keep_part(w, "gp", err);
  if (status == STIC_OK && keep)
    status = keep_part(w, "dat", err);
  return status;
}

static stic_status no_rows(const stic_plot *p, const stic_plot_settings *s, stic_error *err)
{
  char from[40] = "", to[40] = "";

  if (s->from > -STIC_PLOT_EVER)
    snprintf(from, sizeof from, " from %.9g s", s->from);
  if (s->to < STIC_PLOT_EVER)
    snprintf(to, sizeof to, " to %.9g s", s->to);
  return stic_error_set(err, STIC_USAGE, NULL, 0, "the log has no rows%s%s; it goes from %.9g s to %.9g s",
                        from, to, p->rows[0].t, p->rows[p->count - 1].t);
}

stic_status stic_plot_draw(const stic_plot *p, const stic_plot_settings *s, const char *path, stic_error *err)
{
  stic_figure f = {.plot = p, .number = s->figure};
  workshop w;
  stic_status status = name_parts(path, &w, err);
  size_t count;

  assert(s->figure >= STIC_FIGURE_FIRST && s->figure <= STIC_FIGURE_LAST);
  choose_rows(p, s, &f.from, &f.to);
  if (status == STIC_OK && f.from == f.to)
    status = no_rows(p, s, err);
  if (status == STIC_OK && (s->figure == 10 || s->figure == 12) && !stic_plot_has_forces(p))
    status = stic_error_set(err, STIC_USAGE, NULL, 0,
                            "figure %d shows forces, and nothing is touched in this log", s->figure);
  if (status != STIC_OK)
    return status;
  count = (size_t)(f.to - f.from);
  f.stem = w.stem;
  f.jump = malloc(count * sizeof *f.jump);
  f.keep = malloc(2 * count * sizeof *f.keep);
  f.values = malloc(count * sizeof *f.values);
  status = f.jump && f.keep && f.values ? open_workshop(&w, err)
                                        : stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  if (status == STIC_OK) {
    status = make(&f, &w, s->keep, err);
    close_workshop(&w);
  }
  free(f.jump);
  free(f.keep);
  free(f.values);
  return status;
}

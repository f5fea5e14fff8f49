#include "plot_log.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../../src/error.h"

static void take_row(stic_plot_row *row, const stic_result *r)
{
  row->t = (double)r->t_ns / 1e9;
  row->x = r->x;
  row->y = r->y;
  row->theta = r->theta;
  row->hand_x = r->hand_x;
  row->hand_y = r->hand_y;
  row->hand_theta = r->hand_theta;
  row->slips = r->slips;
  row->state = (unsigned char)r->state;
  for (int i = 0; i < STIC_LOG_CONTACTS; i++) {
    const bool there = i < r->contact_count;

    row->surface[i] = (short)(there ? r->contacts[i].surface : -1);
    row->normal[i] = there ? r->contacts[i].normal : NAN;
    row->friction[i] = there ? r->contacts[i].friction : NAN;
  }
}

static bool make_room(stic_plot *p)
{
  const int64_t room = p->room > 0 ? 2 * p->room : 1024;
  stic_plot_row *rows;

  if (p->count < p->room)
    return true;
  rows = realloc(p->rows, (size_t)room * sizeof *rows);
  if (rows) {
    p->rows = rows;
    p->room = room;
  }
  return rows != NULL;
}

static void note_surfaces(stic_plot *p)
{
  bool met[STIC_SURFACES_MAX] = {false};

  for (int64_t i = 0; i < p->count; i++) {
    for (int k = 0; k < STIC_LOG_CONTACTS; k++) {
      if (p->rows[i].surface[k] >= 0)
        met[p->rows[i].surface[k]] = true;
    }
  }
  for (int s = 0; s < STIC_SURFACES_MAX && p->surface_count < STIC_PLOT_SURFACES; s++) {
    if (met[s])
      p->surfaces[p->surface_count++] = s;
  }
}

static stic_status read_rows(stic_plot *p, const char *path, stic_error *err)
{
  stic_result result;
  bool more = true;
  stic_status status = STIC_OK;

  while (status == STIC_OK && more) {
    status = stic_log_next(p->log, &result, &more, err);
    if (status != STIC_OK || !more)
      break;
    if (!make_room(p))
      return stic_error_set(err, STIC_NO_MEMORY, path, 0, "out of memory");
    take_row(&p->rows[p->count++], &result);
    p->cut |= result.contact_count > STIC_LOG_CONTACTS;
  }
  if (status == STIC_OK && p->count == 0)
    status = stic_error_set(err, STIC_BAD_INPUT, path, 0, "the log has no rows; expected at least one");
  return status;
}

stic_status stic_plot_read(const char *path, stic_plot **plot, stic_error *err)
{
  stic_plot *p = calloc(1, sizeof *p);
  stic_status status;

  *plot = NULL;
  if (!p)
    return stic_error_set(err, STIC_NO_MEMORY, path, 0, "out of memory");
  status = stic_log_open(path, &p->log, err);
  if (status == STIC_OK)
    status = read_rows(p, path, err);
  if (status != STIC_OK) {
    stic_plot_destroy(p);
    return status;
  }
  note_surfaces(p);
  *plot = p;
  return STIC_OK;
}

void stic_plot_destroy(stic_plot *p)
{
  if (!p)
    return;
  stic_log_close(p->log);
  free(p->rows);
  free(p);
}

const char *stic_plot_provenance(const stic_plot *p, const char *key, int n)
{
  return stic_log_provenance(p->log, key, n);
}

void stic_plot_set_scene(stic_plot *p, const stic_scene *scene)
{
  memcpy(p->scene, scene->surfaces, sizeof p->scene);
  p->scene_count = scene->surface_count;
  /* Taken by the button, it is wherever the hand was. */
  if (scene->hold == STIC_HOLD_START)
    memcpy(p->holding_point, scene->holding_point, sizeof p->holding_point);
  p->has_scene = true;
}

bool stic_plot_is_cut(const stic_plot *p)
{
  return p->cut;
}

static double sum_on(const stic_plot *p, const stic_plot_row *row, int n, const double *forces)
{
  double sum = NAN;

  for (int i = 0; i < STIC_LOG_CONTACTS; i++) {
    if (row->surface[i] == p->surfaces[n])
      sum = isnan(sum) ? forces[i] : sum + forces[i];
  }
  return sum;
}

double stic_plot_normal(const stic_plot *p, const stic_plot_row *row, int n)
{
  return sum_on(p, row, n, row->normal);
}

double stic_plot_friction(const stic_plot *p, const stic_plot_row *row, int n)
{
  return sum_on(p, row, n, row->friction);
}

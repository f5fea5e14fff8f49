/* A case of `stiction bench extremes` as a scene file and a trace, so that `stiction replay` shows it. */
#include "../../angle.h"
#include "../../io/outfile.h"
#include "../../io/trace_csv.h"
#include "extremes.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <sys/stat.h>

/* As the reader of scene files makes radians. */
static double radians(double degrees)
{
  return degrees / 180.0 * STIC_PI;
}

void stic_extreme_canonical(stic_scene *scene)
{
  scene->angle = radians(scene->angle / STIC_PI * 180.0);
}

/* The degrees that are read as exactly this angle. */
static double degrees_of(double angle)
{
  double up = angle / STIC_PI * 180.0, down = up;

  for (int i = 0; i < 8; i++, up = nextafter(up, INFINITY), down = nextafter(down, -INFINITY)) {
    if (radians(up) == angle)
      return up;
    if (radians(down) == angle)
      return down;
  }
  return angle / STIC_PI * 180.0;
}

static void print_scene(stic_outfile *out, const stic_scene *s)
{
  stic_outfile_print(out, "stiction: 1\nobject:\n  depth: %.17g\n  polygon:\n", s->depth);
  for (int i = 0; i < s->vertex_count; i++)
    stic_outfile_print(out, "    - [%.17g, %.17g]\n", s->vertices[i][0], s->vertices[i][1]);
  stic_outfile_print(out, "  pose: {x: %.17g, y: %.17g, z: %.17g, angle_deg: %.17g}\n", s->x, s->y, s->z,
                     degrees_of(s->angle));
  stic_outfile_print(out,
                     "hand: {stiffness: %.17g, rotational_stiffness: %.17g, hold: %s, "
                     "holding_point: [%.17g, %.17g], reach: %.17g}\nsurfaces:\n",
                     s->stiffness, s->rotational_stiffness, s->hold == STIC_HOLD_START ? "start" : "button",
                     s->holding_point[0], s->holding_point[1], s->reach);
  for (int i = 0; i < s->surface_count; i++) {
    const stic_surface *f = &s->surfaces[i];

    stic_outfile_print(
      out, "  - {point: [%.17g, %.17g], normal_deg: %.17g, friction: {static: %.17g, dynamic: %.17g}}\n",
      f->point[0], f->point[1], f->normal_deg, f->friction.mu_static, f->friction.mu_dynamic);
  }
}

static stic_status write_scene(const char *path, const stic_scene *scene, stic_error *err)
{
  stic_outfile *out;
  const stic_status status = stic_outfile_open(path, &out, err);

  if (status != STIC_OK)
    return status;
  print_scene(out, scene);
  return stic_outfile_commit(out, err);
}

static stic_status write_trace(const char *path, const stic_sample *samples, int count, stic_error *err)
{
  stic_outfile *out;
  const stic_status status = stic_outfile_open(path, &out, err);

  if (status != STIC_OK)
    return status;
  stic_outfile_print(out, STIC_TRACE_FORMAT "\n" STIC_TRACE_HEADER "\n");
  for (int i = 0; i < count; i++)
    stic_outfile_used(out, stic_trace_line(&samples[i], stic_outfile_reserve(out, STIC_TRACE_LINE_MAX)));
  return stic_outfile_commit(out, err);
}

stic_status stic_extreme_dump(const char *folder, const stic_scene *scene, const stic_sample *samples,
                              int count, stic_error *err)
{
  char path[1024];
  stic_status status;

  if (mkdir(folder, 0777) != 0 && errno != EEXIST) {
    /* opening the first file says why */
  }
  snprintf(path, sizeof path, "%s/scene.yaml", folder);
  status = write_scene(path, scene, err);
  snprintf(path, sizeof path, "%s/hand.csv", folder);
  return status == STIC_OK ? write_trace(path, samples, count, err) : status;
}

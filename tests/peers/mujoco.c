/* MuJoCo: elliptic cone, Newton's method, then noslip iterations (tuning.iterations). firmness: the impedance of its
 * soft contacts, below 1. */
#include "angle.h"
#include "peer.h"

#include <math.h>
#include <mujoco/mujoco.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct world {
  mjModel *model;
  mjData *data;
  double x, y, angle; /* where the joints are zero */
  int surfaces;
} world;

/* Friction of a pair is the larger of both geometries': the box has none. The surfaces come first. */
static mjModel *make_model(const stic_scene *scene, const peer_tuning *tuning, double inertia)
{
  static const char *const top =
    "<mujoco><option gravity='0 0 0' cone='elliptic' impratio='%g' integrator='implicitfast' iterations='20' "
    "tolerance='1e-10' noslip_iterations='%d' noslip_tolerance='0'/>"
    "<default><geom condim='3' solref='-%.17g -%.17g' solimp='%.17g %.17g 1e-6' friction='%.17g'/></default><worldbody>";
  static const char *const body =
    "<body><joint type='slide' axis='1 0 0'/><joint type='slide' axis='0 1 0'/><joint type='hinge' axis='0 0 1'/>"
    "<inertial pos='0 0 0' mass='%.17g' diaginertia='%.17g %.17g %.17g'/>"
    "<geom type='box' size='%.17g %.17g %.17g' pos='0 0 0' euler='0 0 %.17g'/></body></worldbody></mujoco>";
  char text[8192], error[512] = "";
  const double *corner = scene->vertices[2], rate = tuning->steps * 31 / 2.0;
  int n = snprintf(text, sizeof text, top, 10.0, tuning->iterations, rate * rate, 2 * rate, tuning->firmness,
                   tuning->firmness, 1e-5);
  mjSpec *spec;
  mjModel *model = NULL;

  for (int i = 0; i < scene->surface_count && n < 7000; i++) {
    const stic_surface *s = &scene->surfaces[i];
    double normal[2];

    stic_normal_from_degrees(s->normal_deg, normal);
    n += snprintf(text + n, sizeof text - (size_t)n,
                  "<geom type='plane' size='0 0 1' pos='%.17g %.17g 0' zaxis='%.17g %.17g 0'/>",
                  s->point[0] - scene->x, s->point[1] - scene->y, normal[0], normal[1]);
  }
  snprintf(text + n, sizeof text - (size_t)n, body, tuning->mass, inertia, inertia, inertia, corner[0],
           corner[1], scene->depth / 2, scene->angle * STIC_DEG_PER_RAD);
  spec = mj_parseXMLString(text, NULL, error, sizeof error);
  if (spec)
    model = mj_compile(spec, NULL);
  if (!model)
    fprintf(stderr, "MuJoCo: %s%s\n", error, spec ? mjs_getError(spec) : "");
  mj_deleteSpec(spec);
  return model;
}

static void *create(const stic_scene *scene, const peer_tuning *tuning, double inertia)
{
  world *w = calloc(1, sizeof *w);

  if (!w)
    return NULL;
  w->model = make_model(scene, tuning, inertia);
  w->data = w->model ? mj_makeData(w->model) : NULL;
  if (!w->data) {
    mj_deleteModel(w->model);
    free(w);
    return NULL;
  }
  w->x = scene->x;
  w->y = scene->y;
  w->angle = scene->angle;
  w->surfaces = scene->surface_count;
  return w;
}

static void step(void *it, const double force[2], double moment, const double *mu, double dt)
{
  world *w = it;

  for (int i = 0; i < w->surfaces; i++)
    w->model->geom_friction[3 * i] = mu[i];
  w->model->opt.timestep = dt;
  w->data->qfrc_applied[0] = force[0];
  w->data->qfrc_applied[1] = force[1];
  w->data->qfrc_applied[2] = moment;
  mj_step(w->model, w->data);
}

static void read_motion(void *it, peer_motion *m)
{
  const world *w = it;
  const mjtNum *q = w->data->qpos, *v = w->data->qvel;

  *m = (peer_motion){w->x + q[0], w->y + q[1], w->angle + q[2], v[0], v[1], v[2]};
}

static void destroy(void *it)
{
  world *w = it;

  mj_deleteData(w->data);
  mj_deleteModel(w->model);
  free(w);
}

static const peer_engine engine = {"MuJoCo",    "PyPI mujoco", "one coefficient; soft contacts", create, step,
                                   read_motion, destroy};
const peer_engine *const peer_mujoco = &engine;

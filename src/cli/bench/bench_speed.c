/* stiction bench speed: what a sample costs. */
#define _XOPEN_SOURCE 700 /* mkdtemp() */
#include "../../angle.h"
#include "../../error.h"
#include "../../io/log_csv.h"
#include "../../io/timing.h"
#include "../../io/trace_csv.h"
#include "../../sim.h"
#include "bench.h"
#include "../cli.h"
#include "trade.h"

#include <math.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define SAMPLE_NS 20000000 /* 50 Hz, the ultrasonic tracker's rate */
#define HASH_START UINT64_C(14695981039346656037)
#define HASH_STEP UINT64_C(1099511628211)

extern char **environ;

/* ---- scenes and hand --------------------------------------------------------------------- */

static void add_surface(stic_scene *scene, double x, double y, double normal_deg)
{
  stic_surface *s = &scene->surfaces[scene->surface_count++];

  memset(s, 0, sizeof *s);
  s->point[0] = x;
  s->point[1] = y;
  s->normal_deg = normal_deg;
  s->friction.mu_static = 0.5;
  s->friction.mu_dynamic = 0.3;
}

#define BOX 0

/* A box between floor and wall, or a regular polygon of about its size. */
static void make_scene(stic_scene *scene, int vertices)
{
  stic_scene_init(scene);
  if (vertices == BOX) {
    stic_scene_set_box(scene, 0.16, 0.08);
  } else {
    scene->vertex_count = vertices;
    for (int i = 0; i < vertices; i++) {
      scene->vertices[i][0] = 0.08 * cos(2 * STIC_PI * i / vertices);
      scene->vertices[i][1] = 0.08 * sin(2 * STIC_PI * i / vertices);
    }
  }
  scene->x = 0.3;
  scene->y = 0.3;
  scene->stiffness = 200;
  scene->rotational_stiffness = 0.5;
  add_surface(scene, 0, 0, 90);
  add_surface(scene, 0, 0, 0);
}

/* Sample i of a hand that presses down and to the left, never still: a slow circle, a slow turn and the
 * tremor of a hand. It goes in at the first samples and stays in contact. */
static stic_sample hand_sample(int64_t i)
{
  const double t = (double)i * (SAMPLE_NS / 1e9), press = fmin(1, (double)i / 50);
  const double angle = 0.35 + 0.3 * sin(2 * STIC_PI * 0.23 * t);
  stic_sample s;

  memset(&s, 0, sizeof s);
  s.t_ns = i * SAMPLE_NS;
  s.position[0] =
    0.3 - press * 0.25 + 0.02 * cos(2 * STIC_PI * 0.31 * t) + 0.0003 * sin(2 * STIC_PI * 9.3 * t);
  s.position[1] =
    0.3 - press * 0.27 + 0.01 * sin(2 * STIC_PI * 0.31 * t) + 0.0003 * sin(2 * STIC_PI * 10.7 * t);
  s.orientation[2] = sin(angle / 2);
  s.orientation[3] = cos(angle / 2);
  return s;
}

/* ---- solving ----------------------------------------------------------------------------- */

typedef struct measurement {
  stic_histogram step, collide, solve;
  int64_t samples, two_contacts; /* how many had both surfaces in contact */
  uint64_t hash;                 /* of all rows as a log would have them */
} measurement;

static void hash_row(uint64_t *hash, const stic_result *result)
{
  char row[STIC_LOG_ROW_MAX];
  const size_t length = stic_log_row_text(result, row);

  for (size_t i = 0; i < length; i++)
    *hash = (*hash ^ (unsigned char)row[i]) * HASH_STEP;
}

static stic_status measure(const stic_scene *scene, stic_level level, int64_t samples, measurement *m,
                           stic_error *err)
{
  stic_settings settings;
  stic_result result;
  stic_sim *sim;
  stic_status status;

  memset(m, 0, sizeof *m);
  m->hash = HASH_START;
  stic_settings_init(&settings);
  settings.level = level;
  status = stic_sim_create(scene, &settings, &sim, err);
  if (status != STIC_OK)
    return status;
  stic_sim_time_stages(sim, true);
  for (int64_t i = 0; i < samples && stic_cli_signal() == 0; i++) {
    const stic_sample sample = hand_sample(i);
    int64_t collide, total;

    stic_sim_step(sim, &sample, &result);
    stic_sim_stage_times(sim, &collide, &total);
    hash_row(&m->hash, &result);
    m->samples++;
    if (i < 50)
      continue; /* on the way in, and caches cold */
    stic_histogram_add(&m->step, total);
    stic_histogram_add(&m->collide, collide);
    stic_histogram_add(&m->solve, total - collide);
    m->two_contacts += result.contact_count >= 2;
  }
  stic_sim_destroy(sim);
  return STIC_OK;
}

static void print_histogram(const char *name, const stic_histogram *h)
{
  printf("  %-22s %9lld %9lld %9lld %9lld\n", name, (long long)stic_histogram_quantile(h, 0.5),
         (long long)stic_histogram_quantile(h, 0.99), (long long)stic_histogram_quantile(h, 0.999),
         (long long)h->max_ns);
}

static stic_status bench_levels(bool quick, measurement *m, stic_error *err)
{
  static const stic_level levels[] = {STIC_LEVEL_FRAME, STIC_LEVEL_EVENT};
  static const char *const names[] = {"frame", "event"};
  static const char *const targets[] = {"median <= 500, p99.9 <= 20000", "median <= 2000"};
  stic_scene scene;

  make_scene(&scene, BOX);
  printf("a box on two surfaces, ns a sample\n  %-22s %9s %9s %9s %9s\n", "", "median", "p99", "p99.9",
         "worst");
  for (int i = 0; i < 2; i++) {
    char name[32];
    const stic_status status = measure(&scene, levels[i], quick ? 1000 : 200000, m, err);

    if (status != STIC_OK)
      return status;
    snprintf(name, sizeof name, "%s, all", names[i]);
    print_histogram(name, &m->step);
    print_histogram("  collide", &m->collide);
    print_histogram("  solve", &m->solve);
    printf("  target: %s; both surfaces touched in %.1f %% of the samples; hash %016llx\n", targets[i],
           100.0 * (double)m->two_contacts / (double)(m->step.count > 0 ? m->step.count : 1),
           (unsigned long long)m->hash);
  }
  return STIC_OK;
}

/* Further surfaces under the floor: nearly in reach, or far out of it. */
static stic_status bench_surfaces(bool quick, double depth, const char *name, measurement *m, stic_error *err)
{
  static const int counts[] = {1, 2, 4, 16, 64, 256};
  double at_two = 0, median = 0;

  printf("%s, ns a sample at level frame (median)\n ", name);
  for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
    stic_scene scene;
    stic_status status;

    make_scene(&scene, BOX);
    while (scene.surface_count < counts[i])
      add_surface(&scene, 0, -depth * scene.surface_count, 90);
    scene.surface_count = counts[i];
    status = measure(&scene, STIC_LEVEL_FRAME, quick ? 200 : 20000, m, err);
    if (status != STIC_OK)
      return status;
    median = (double)stic_histogram_quantile(&m->step, 0.5);
    at_two = counts[i] == 2 ? median : at_two;
    printf(" %d: %.0f ", counts[i], median);
  }
  printf("\n  each further one: %.2f\n", (median - at_two) / 254);
  return STIC_OK;
}

static stic_status bench_vertices(bool quick, measurement *m, stic_error *err)
{
  static const int counts[] = {3, 4, 8, 16, 32, 64};
  double first = 0, median = 0;

  printf("vertices, ns a sample at level frame (median)\n ");
  for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
    stic_scene scene;
    stic_status status;

    make_scene(&scene, counts[i]);
    status = measure(&scene, STIC_LEVEL_FRAME, quick ? 200 : 20000, m, err);
    if (status != STIC_OK)
      return status;
    median = (double)stic_histogram_quantile(&m->step, 0.5);
    first = i == 0 ? median : first;
    printf(" %d: %.0f ", counts[i], median);
  }
  printf("\n  each further one: %.2f\n", (median - first) / 61);
  return STIC_OK;
}

/* ---- what is left out of the model --------------------------------------------------------- */

enum { CHOICES = STIC_LEAVE_ALL + 1 };

typedef struct part_case {
  const char *name;
  int vertices, further; /* BOX or a polygon's; surfaces besides the two */
  double depth;          /* m, of these under the floor, from one to the next; 0: a bowl around */
  double mu_s, mu_d, k_theta;
} part_case;

/* Mean ns of a sample, and of making the simulation. */
static stic_status time_choice(const stic_motion *motion, const stic_settings *settings, unsigned leave_out,
                               double *sample_ns, double *make_ns, stic_error *err)
{
  const int64_t start_ns = stic_clock_thread_ns();
  stic_result result;
  stic_sim *sim;
  const stic_status status = stic_sim_create_parts(&motion->scene, settings, leave_out, &sim, err);
  const int64_t made_ns = stic_clock_thread_ns();

  if (status != STIC_OK)
    return status;
  for (int i = 0; i < motion->count; i++)
    stic_sim_step(sim, &motion->samples[i], &result);
  *sample_ns = fmin(*sample_ns, (double)(stic_clock_thread_ns() - made_ns) / motion->count);
  *make_ns = fmin(*make_ns, (double)(made_ns - start_ns));
  stic_sim_destroy(sim);
  return STIC_OK;
}

/* One row: all choices in turn, the fastest run of each. */
static stic_status bench_part(const part_case *c, stic_level level, bool quick, stic_error *err)
{
  double sample_ns[CHOICES], make_ns[CHOICES];
  stic_settings settings;
  stic_motion motion;
  stic_scene scene;
  stic_status status;

  make_scene(&scene, c->vertices);
  for (int i = 0; i < c->further; i++) {
    const double way = (i + 0.5) / c->further * 90;

    if (c->depth > 0)
      add_surface(&scene, 0, -c->depth * (i + 1), 90);
    else
      add_surface(&scene, 10 * cos(way * STIC_PI / 180), 10 * sin(way * STIC_PI / 180), way + 180);
  }
  for (int s = 0; s < scene.surface_count; s++)
    scene.surfaces[s].friction = (stic_friction){c->mu_s, c->mu_d};
  scene.rotational_stiffness = c->k_theta;
  stic_settings_init(&settings);
  settings.level = level;
  status = stic_motion_along_surfaces(&motion, &scene, quick ? 100 : 1000, err);
  for (int k = 0; k < CHOICES; k++)
    sample_ns[k] = make_ns[k] = INFINITY;
  for (int run = 0; run < (quick ? 2 : 9); run++)
    for (unsigned k = 0; k < CHOICES && status == STIC_OK && stic_cli_signal() == 0; k++)
      status = time_choice(&motion, &settings, k, &sample_ns[k], &make_ns[k], err);
  if (status == STIC_OK && stic_cli_signal() == 0)
    printf("  %-38s %-5s %8.0f %8.0f %8.0f %8.0f %6.2f %6.0f %5.0f\n", c->name,
           level == STIC_LEVEL_FRAME ? "frame" : "event", sample_ns[STIC_LEAVE_NONE],
           sample_ns[STIC_LEAVE_ODE], sample_ns[STIC_LEAVE_HIDDEN], sample_ns[STIC_LEAVE_ALL],
           sample_ns[STIC_LEAVE_NONE] / sample_ns[STIC_LEAVE_ALL], make_ns[STIC_LEAVE_NONE] / 1e3,
           make_ns[STIC_LEAVE_ALL] / 1e3);
  stic_motion_free(&motion);
  return status;
}

static stic_status bench_parts(bool quick, stic_error *err)
{
  static const part_case cases[] = {
    {"box on two surfaces", BOX, 0, 0, 0.5, 0.3, 0.5},
    {"64 vertices on two surfaces", 64, 0, 0, 0.5, 0.3, 0.5},
    {"box, 14 further ones 1 mm behind", BOX, 14, 1e-3, 0.5, 0.3, 0.5},
    {"box, 254 further ones 0.1 mm behind", BOX, 254, 1e-4, 0.5, 0.3, 0.5},
    {"box in a bowl of 254 further ones", BOX, 254, 0, 0.5, 0.3, 0.5},
    {"box, mu_s = mu_d", BOX, 0, 0, 0.5, 0.5, 0.5},
    {"box, no friction", BOX, 0, 0, 0, 0, 0.5},
    {"box, k_theta = 0", BOX, 0, 0, 0.5, 0.3, 0},
  };
  stic_status status = STIC_OK;

  printf("what is left out, ns a sample (mean), pressed and dragged along each surface; us to make it\n"
         "  %-44s %8s %8s %8s %8s %6s %6s %5s\n",
         "", "full", "no ODE", "hidden", "both", "full/", "full", "both");
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
    for (int level = 0; level < 2 && status == STIC_OK && stic_cli_signal() == 0; level++)
      status = bench_part(&cases[i], level == 0 ? STIC_LEVEL_FRAME : STIC_LEVEL_EVENT, quick, err);
  return status;
}

/* ---- the program ------------------------------------------------------------------------- */

typedef struct workplace {
  char folder[64];
  char scene[96], trace[96], short_trace[96], log[96];
} workplace;

static const char scene_text[] = "stiction: 1\n"
                                 "object: {size: [0.16, 0.08, 0.1], pose: {x: 0.3, y: 0.3}}\n"
                                 "hand: {stiffness: 200, rotational_stiffness: 0.5}\n"
                                 "friction: {static: 0.5, dynamic: 0.3}\n"
                                 "surfaces:\n"
                                 "  - {name: floor, point: [0, 0], normal_deg: 90}\n"
                                 "  - {name: wall, point: [0, 0], normal_deg: 0}\n";

static stic_status write_scene(const char *path, stic_error *err)
{
  stic_outfile *out;
  const stic_status status = stic_outfile_open(path, &out, err);

  if (status != STIC_OK)
    return status;
  stic_outfile_write(out, scene_text, sizeof scene_text - 1);
  return stic_outfile_commit(out, err);
}

static stic_status write_trace(const char *path, int64_t samples, stic_error *err)
{
  stic_outfile *out;
  const stic_status status = stic_outfile_open(path, &out, err);

  if (status != STIC_OK)
    return status;
  stic_outfile_print(out, STIC_TRACE_FORMAT "\n" STIC_TRACE_HEADER "\n");
  for (int64_t i = 0; i < samples; i++) {
    const stic_sample sample = hand_sample(i);

    stic_outfile_used(out, stic_trace_line(&sample, stic_outfile_reserve(out, STIC_TRACE_LINE_MAX)));
  }
  return stic_outfile_commit(out, err);
}

static void leave(const workplace *w)
{
  unlink(w->scene);
  unlink(w->trace);
  unlink(w->short_trace);
  unlink(w->log);
  rmdir(w->folder);
}

static stic_status set_up(workplace *w, int64_t samples, stic_error *err)
{
  stic_status status;

  snprintf(w->folder, sizeof w->folder, "/tmp/stiction-bench-XXXXXX");
  if (!mkdtemp(w->folder))
    return stic_error_set(err, STIC_CANNOT_WRITE, "/tmp", 0, "cannot make a folder for the bench");
  snprintf(w->scene, sizeof w->scene, "%s/scene.yaml", w->folder);
  snprintf(w->trace, sizeof w->trace, "%s/hand.csv", w->folder);
  snprintf(w->short_trace, sizeof w->short_trace, "%s/short.csv", w->folder);
  snprintf(w->log, sizeof w->log, "%s/log.csv", w->folder);
  status = write_scene(w->scene, err);
  if (status == STIC_OK)
    status = write_trace(w->trace, samples, err);
  if (status == STIC_OK)
    status = write_trace(w->short_trace, 1, err);
  if (status != STIC_OK)
    leave(w);
  return status;
}

/* Runs this program as a child: the time in ns, or -1. */
static int64_t time_replay(const char *scene, const char *trace, const char *level, const char *log)
{
  char *argv[10] = {"stiction",
                    "replay",
                    (char *)(uintptr_t)scene,
                    (char *)(uintptr_t)trace,
                    "--accuracy",
                    (char *)(uintptr_t)level,
                    NULL};
  const int64_t start = stic_clock_ns();
  pid_t child;
  int status;

  if (log) {
    argv[6] = "--log";
    argv[7] = (char *)(uintptr_t)log;
  }
  if (posix_spawn(&child, "/proc/self/exe", NULL, NULL, argv, environ) != 0)
    return -1;
  while (waitpid(child, &status, 0) < 0)
    ;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? stic_clock_ns() - start : -1;
}

static bool bench_rate(const workplace *w, const char *level, const char *log, int64_t samples,
                       int64_t start_up_ns, int target)
{
  const int64_t ns = time_replay(w->scene, w->trace, level, log);
  const int64_t net_ns = ns > start_up_ns ? ns - start_up_ns : 1;

  if (ns < 0)
    return false;
  printf("  %-5s %-11s %10.0f   target >= %d\n", level, log ? "CSV to CSV" : "log off",
         (double)samples * 1e9 / (double)net_ns, target);
  return true;
}

static stic_status bench_program(bool quick, stic_error *err)
{
  static const char *const levels[] = {"frame", "event"};
  const int64_t samples = quick ? 2000 : 300000;
  const int starts = quick ? 3 : 41;
  stic_histogram *start_up = calloc(1, sizeof *start_up);
  workplace w;
  stic_status status =
    start_up ? set_up(&w, samples, err) : stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  bool good = true;

  if (!start_up || status != STIC_OK) {
    free(start_up);
    return status;
  }
  for (int i = 0; i < starts && good; i++) {
    const int64_t ns = time_replay(w.scene, w.short_trace, "frame", NULL);

    good = ns >= 0;
    stic_histogram_add(start_up, ns);
  }
  if (good) {
    const int64_t start_ns = stic_histogram_quantile(start_up, 0.5);

    printf("start-up to end of a replay of one sample: %.2f ms (median), worst %.2f; target < 20\n",
           (double)start_ns / 1e6, (double)start_up->max_ns / 1e6);
    printf("replay, samples a second on one core (start-up taken off)\n");
    for (int i = 0; i < 2 && good; i++)
      good = bench_rate(&w, levels[i], w.log, samples, start_ns, 30000) &&
             bench_rate(&w, levels[i], NULL, samples, start_ns, 300000);
  }
  leave(&w);
  free(start_up);
  if (stic_cli_signal() != 0)
    return STIC_OK;
  return good ? STIC_OK : stic_error_set(err, STIC_FAILED, NULL, 0, "bench: the program's own replay failed");
}

int stic_bench_speed(bool quick)
{
  measurement *m = malloc(sizeof *m);
  char machine[512];
  stic_error err;
  stic_status status;

  if (!m) {
    stic_error_set(&err, STIC_NO_MEMORY, NULL, 0, "out of memory");
    return stic_cli_fail(&err);
  }
  printf("stiction %s, %s\n", stic_version(), stic_machine_text(machine, sizeof machine));
  status = bench_levels(quick, m, &err);
  if (status == STIC_OK)
    status = bench_surfaces(quick, 1e-4, "surfaces, further ones 0.1 mm apart under the floor", m, &err);
  if (status == STIC_OK)
    status = bench_surfaces(quick, 10, "surfaces, further ones out of reach", m, &err);
  if (status == STIC_OK)
    status = bench_vertices(quick, m, &err);
  if (status == STIC_OK)
    status = bench_parts(quick, &err);
  if (status == STIC_OK)
    status = bench_program(quick, &err);
  free(m);
  if (stic_cli_signal() != 0)
    return STIC_EXIT_SIGNAL + stic_cli_signal();
  if (status != STIC_OK)
    return stic_cli_fail(&err);
  return STIC_OK;
}

/* stiction bench render: what a picture costs, on one core. */
#define _XOPEN_SOURCE 700 /* mkdtemp(), nftw() */
#include "../../angle.h"
#include "../../error.h"
#include "../../io/timing.h"
#include "bench.h"
#include "../cli.h"
#include "png_encoder.h"
#include "render.h"
#include "video.h"

#include <ftw.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define PICTURES_MAX 62 /* two seconds */
#define WARM_UP 3
#define FIRSTS_MAX 5
#define RUN_IN 124 /* samples before the first picture: trails and plots are full by then */

static const struct {
  int width, height;
  const char *name;
} sizes[] = {{640, 480, "640x480"}, {1280, 720, "1280x720"}, {1920, 1080, "1920x1080"}};

#define SIZE_COUNT (sizeof sizes / sizeof sizes[0])
#define TARGET_SIZE 1 /* the one that the targets are about */

static const char *const quality_names[] = {"fast", "good", "best"};

typedef struct bench {
  stic_scene scene;
  stic_extent extent;
  int pictures;      /* a measurement has */
  char folder[64];   /* for files that nobody keeps */
  double good, live; /* ms at the targets' size: a picture of quality good, its video; 0: not known */
} bench;

/* ---- the run that is shown --------------------------------------------------------------- */

static void add_surface(stic_scene *scene, const char *name, double normal_deg)
{
  stic_surface *s = &scene->surfaces[scene->surface_count++];

  memset(s, 0, sizeof *s);
  snprintf(s->name, sizeof s->name, "%s", name);
  s->normal_deg = normal_deg;
  s->friction = (stic_friction){0.5, 0.3};
}

/* A box between floor and wall. */
static void make_scene(stic_scene *scene)
{
  stic_scene_init(scene);
  stic_scene_set_box(scene, 0.16, 0.08);
  scene->x = scene->y = 0.25;
  scene->stiffness = 200;
  scene->rotational_stiffness = 0.5;
  add_surface(scene, "floor", 90);
  add_surface(scene, "wall", 0);
}

/* Sample i, 31 a second, of a hand that presses the box into the corner and moves and turns it about there. */
static stic_sample hand_sample(int i)
{
  const double t = i / (double)STIC_TARGET_HZ, press = fmin(1, t);
  const double angle = 0.35 + 0.3 * sin(2 * STIC_PI * 0.23 * t);
  stic_sample s;

  memset(&s, 0, sizeof s);
  s.t_ns = (int64_t)i * STIC_FRAME_NS;
  s.position[0] = 0.25 - press * 0.19 + 0.04 * cos(2 * STIC_PI * 0.31 * t);
  s.position[1] = 0.25 - press * 0.21 + 0.02 * sin(2 * STIC_PI * 0.31 * t);
  s.orientation[2] = sin(angle / 2);
  s.orientation[3] = cos(angle / 2);
  return s;
}

/* Takes the run to its next sample. */
static void advance(stic_sim *sim, int i, stic_result *result)
{
  const stic_sample sample = hand_sample(i);

  stic_sim_step(sim, &sample, result);
}

static stic_status start_run(const bench *b, stic_sim **sim, stic_error *err)
{
  stic_settings settings;

  stic_settings_init(&settings);
  return stic_sim_create(&b->scene, &settings, sim, err);
}

static stic_status measure_extent(bench *b, stic_error *err)
{
  stic_result result;
  stic_sim *sim;
  const stic_status status = start_run(b, &sim, err);

  stic_extent_init(&b->extent);
  if (status != STIC_OK)
    return status;
  for (int i = 0; i < RUN_IN + PICTURES_MAX; i++) {
    advance(sim, i, &result);
    stic_extent_add(&b->extent, &b->scene, &result);
  }
  stic_sim_destroy(sim);
  return STIC_OK;
}

/* ---- clocks ------------------------------------------------------------------------------ */

/* CPU time of the whole process: a library's threads count. */
static double cpu_ms(void)
{
  struct timespec t;

  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec * 1e3 + (double)t.tv_nsec / 1e6;
}

static int compare(const void *a, const void *b)
{
  const double x = *(const double *)a, y = *(const double *)b;

  return (x > y) - (x < y);
}

/* Sorts them. */
static double quantile(double *values, int count, double part)
{
  qsort(values, (size_t)count, sizeof *values, compare);
  return count > 0 ? values[(int)(part * (count - 1) + 0.5)] : 0;
}

/* ---- pictures ---------------------------------------------------------------------------- */

/* A renderer and the run that it shows. */
typedef struct show {
  stic_sim *sim;
  stic_render *render;
  int next; /* sample */
} show;

static stic_status open_show(const bench *b, size_t size, stic_quality quality, show *s, stic_error *err)
{
  stic_render_settings settings;
  stic_status status = start_run(b, &s->sim, err);

  s->render = NULL;
  s->next = 0;
  stic_render_settings_init(&settings);
  settings.width = sizes[size].width;
  settings.height = sizes[size].height;
  settings.quality = quality;
  settings.extent = &b->extent;
  return status == STIC_OK ? stic_render_create(&b->scene, &settings, &s->render, err) : status;
}

static void close_show(show *s)
{
  stic_render_destroy(s->render);
  stic_sim_destroy(s->sim);
}

/* One picture for every sample, but for those on the way in. */
static stic_status next_picture(show *s, stic_image *image, stic_error *err)
{
  stic_result result;

  do {
    advance(s->sim, s->next, &result);
    stic_render_observe(s->render, &result);
  } while (++s->next < RUN_IN - WARM_UP);
  return stic_render_draw(s->render, image, err);
}

static stic_status warm_up(show *s, stic_error *err)
{
  stic_status status = STIC_OK;
  stic_image image;

  for (int i = 0; i < WARM_UP && status == STIC_OK; i++)
    status = next_picture(s, &image, err);
  return status;
}

enum { BUILD, DRAW, READ, HUD, ALL, STAGE_COUNT };

static stic_status time_stages(const bench *b, show *s, double ms[STAGE_COUNT][PICTURES_MAX], stic_error *err)
{
  stic_status status = warm_up(s, err);
  stic_image image;

  for (int i = 0; i < b->pictures && status == STIC_OK && stic_cli_signal() == 0; i++) {
    stic_render_times t;

    status = next_picture(s, &image, err);
    t = stic_render_last_times(s->render);
    ms[BUILD][i] = (double)t.build_ns / 1e6;
    ms[DRAW][i] = (double)t.draw_ns / 1e6;
    ms[READ][i] = (double)t.read_ns / 1e6;
    ms[HUD][i] = (double)t.hud_ns / 1e6;
    ms[ALL][i] = ms[BUILD][i] + ms[DRAW][i] + ms[READ][i] + ms[HUD][i];
  }
  return status;
}

static stic_status bench_quality(bench *b, size_t size, stic_quality quality, stic_error *err)
{
  static const char *const targets[] = {"   target <= 8", "   target <= 20", ""};
  double ms[STAGE_COUNT][PICTURES_MAX] = {{0}}, worst;
  show s;
  stic_status status = open_show(b, size, quality, &s, err);

  if (status == STIC_OK && size == 0 && quality == STIC_QUALITY_FAST)
    printf("%s\n\na picture, ms of one core (medians of %d; CPU time)\n  %-16s %7s %7s %7s %7s %8s %8s\n",
           stic_render_rasteriser(s.render), b->pictures, "", "build", "draw", "read", "HUD", "all", "worst");
  if (status == STIC_OK)
    status = time_stages(b, &s, ms, err);
  close_show(&s);
  if (status != STIC_OK || stic_cli_signal() != 0)
    return status;
  worst = quantile(ms[ALL], b->pictures, 1);
  printf("  %-11s %-4s", sizes[size].name, quality_names[quality]);
  for (int k = 0; k < STAGE_COUNT; k++)
    printf(k == ALL ? " %8.2f" : " %7.2f", quantile(ms[k], b->pictures, 0.5));
  printf(" %8.2f%s\n", worst, size == TARGET_SIZE ? targets[quality] : "");
  if (size == TARGET_SIZE && quality == STIC_QUALITY_GOOD)
    b->good = quantile(ms[ALL], b->pictures, 0.5);
  fflush(stdout);
  return STIC_OK;
}

static stic_status bench_pictures(bench *b, stic_error *err)
{
  stic_status status = STIC_OK;

  for (size_t size = 0; size < SIZE_COUNT; size++) {
    for (int q = 0; q <= STIC_QUALITY_BEST && status == STIC_OK && stic_cli_signal() == 0; q++)
      status = bench_quality(b, size, (stic_quality)q, err);
  }
  return status;
}

/* ---- PNG --------------------------------------------------------------------------------- */

static stic_status bench_png(const bench *b, size_t size, stic_error *err)
{
  stic_png_encoder *encoder = stic_png_encoder_create(STIC_PNG_QUICK);
  double ms[PICTURES_MAX], kilobytes = 0;
  int count = 0;
  show s;
  stic_status status = open_show(b, size, STIC_QUALITY_GOOD, &s, err);

  if (status == STIC_OK)
    status = warm_up(&s, err);
  while (status == STIC_OK && encoder && count < b->pictures && stic_cli_signal() == 0) {
    stic_image image;
    size_t length = 0;
    double start;

    status = next_picture(&s, &image, err);
    if (status != STIC_OK)
      break;
    start = cpu_ms();
    stic_png_encode(encoder, &image, &length);
    ms[count++] = cpu_ms() - start;
    kilobytes += (double)length / 1e3;
  }
  close_show(&s);
  stic_png_encoder_destroy(encoder);
  if (status == STIC_OK && count > 0)
    printf("  %-11s %8.2f ms %8.0f kB%s\n", sizes[size].name, quantile(ms, count, 0.5), kilobytes / count,
           size == TARGET_SIZE ? "   target <= 11 (in threads of its own)" : "");
  return status;
}

/* ---- video ------------------------------------------------------------------------------- */

typedef struct video_kind {
  const char *name, *file, *target;
  bool live;
  bool one_size; /* only the targets' */
} video_kind;

/* `*ms`: CPU time a picture, with what is left to do at the end. */
static stic_status time_video(const bench *b, size_t size, const video_kind *kind, double *ms,
                              stic_error *err)
{
  char path[96];
  stic_video *video = NULL;
  show s;
  stic_status status = open_show(b, size, STIC_QUALITY_GOOD, &s, err);

  *ms = 0;
  snprintf(path, sizeof path, "%s/%s", b->folder, kind->file);
  if (status == STIC_OK)
    status = warm_up(&s, err);
  if (status == STIC_OK)
    status =
      stic_video_create(path, sizes[size].width, sizes[size].height, STIC_TARGET_HZ, kind->live, &video, err);
  for (int i = 0; i < b->pictures && status == STIC_OK && stic_cli_signal() == 0; i++) {
    stic_image image;
    double start;

    status = next_picture(&s, &image, err);
    start = cpu_ms();
    if (status == STIC_OK)
      status = stic_video_add(video, &image, err);
    *ms += cpu_ms() - start;
  }
  if (status == STIC_OK) {
    const double start = cpu_ms();

    status = stic_video_finish(video, err);
    *ms += cpu_ms() - start;
  }
  *ms /= b->pictures;
  stic_video_destroy(video);
  close_show(&s);
  return status;
}

static stic_status bench_video(bench *b, stic_error *err)
{
  static const video_kind kinds[] = {{"H.264 live", "live.mp4", "   target <= 5", true, false},
                                     {"H.264 file", "file.mp4", "   target <= 10", false, false},
                                     {"lossless", "lossless.mkv", "", false, true},
                                     {"VP9", "vp9.webm", "", false, true}};

  if (!stic_video_available()) {
    printf("video: this build writes none\n");
    return STIC_OK;
  }
  printf("video of quality good, ms of one core a picture (mean of %d with the end; CPU time)\n",
         b->pictures);
  for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
    for (size_t size = 0; size < SIZE_COUNT && stic_cli_signal() == 0; size++) {
      double ms;
      stic_status status;

      if (kinds[k].one_size && size != TARGET_SIZE)
        continue;
      status = time_video(b, size, &kinds[k], &ms, err);
      if (status == STIC_USAGE && kinds[k].one_size) {
        printf("  %-11s %-10s this libav has no encoder for it\n", sizes[size].name, kinds[k].name);
        continue;
      }
      if (status != STIC_OK)
        return status;
      printf("  %-11s %-10s %8.2f%s\n", sizes[size].name, kinds[k].name, ms,
             size == TARGET_SIZE ? kinds[k].target : "");
      fflush(stdout);
      if (kinds[k].live && size == TARGET_SIZE)
        b->live = ms;
    }
  }
  return STIC_OK;
}

/* ---- first picture ----------------------------------------------------------------------- */

/* Wall and CPU time until a child of ours has its first picture, ms; negative if it failed. Mesa compiles once per
 * process, so nothing of it may have been used here yet. */
typedef struct first_time {
  double wall, cpu;
} first_time;

static first_time time_first(const bench *b)
{
  int ends[2], status;
  first_time ms = {-1, -1};
  pid_t child;

  if (pipe(ends) < 0)
    return ms;
  fflush(stdout);
  child = fork();
  if (child == 0) {
    const int64_t start = stic_clock_ns();
    stic_image image;
    show s;

    if (open_show(b, TARGET_SIZE, STIC_QUALITY_GOOD, &s, NULL) == STIC_OK &&
        next_picture(&s, &image, NULL) == STIC_OK)
      ms = (first_time){(double)(stic_clock_ns() - start) / 1e6, cpu_ms()};
    _exit(write(ends[1], &ms, sizeof ms) == (ssize_t)sizeof ms ? 0 : 1);
  }
  close(ends[1]);
  if (child < 0 || read(ends[0], &ms, sizeof ms) != (ssize_t)sizeof ms)
    ms = (first_time){-1, -1};
  close(ends[0]);
  while (child > 0 && waitpid(child, &status, 0) < 0 && stic_cli_signal() == 0)
    ;
  return ms;
}

/* False if a child failed: what follows then says why. */
static bool bench_first_of(const bench *b, int repeats, const char *name, const char *target)
{
  double wall[FIRSTS_MAX], cpu[FIRSTS_MAX];

  for (int i = 0; i < repeats; i++) {
    const first_time ms = time_first(b);

    if (ms.wall < 0)
      return false;
    wall[i] = ms.wall;
    cpu[i] = ms.cpu;
  }
  printf("  %-22s %7.0f  (CPU %.0f)%s\n", name, quantile(wall, repeats, 0.5), quantile(cpu, repeats, 0.5),
         target);
  return true;
}

static void bench_first(const bench *b, int repeats)
{
  char cache[96];

  snprintf(cache, sizeof cache, "%s/cache", b->folder);
  printf("first picture, 1280x720 good, ms from nothing (medians of %d; wall time)\n", repeats);
  setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
  if (!bench_first_of(b, repeats, "Mesa's cache unused", ""))
    return;
  setenv("MESA_SHADER_CACHE_DISABLE", "false", 1);
  setenv("MESA_SHADER_CACHE_DIR", cache, 1);
  time_first(b);
  bench_first_of(b, repeats, "Mesa's cache filled", "   target < 250");
  printf("\n");
}

/* ---- command ----------------------------------------------------------------------------- */

static int remove_entry(const char *path, const struct stat *st, int kind, struct FTW *where)
{
  (void)st, (void)kind, (void)where;
  return remove(path);
}

static stic_status bench_all(bench *b, bool quick, stic_error *err)
{
  stic_status status = measure_extent(b, err);

  if (status != STIC_OK)
    return status;
  bench_first(b, quick ? 1 : FIRSTS_MAX);
  status = bench_pictures(b, err);
  if (status == STIC_OK)
    printf("PNG of quality good (medians of %d; CPU time)\n", b->pictures);
  for (size_t size = 0; size < SIZE_COUNT && status == STIC_OK && stic_cli_signal() == 0; size++)
    status = bench_png(b, size, err);
  if (status == STIC_OK && stic_cli_signal() == 0)
    status = bench_video(b, err);
  if (status == STIC_OK && b->good > 0 && b->live > 0)
    printf("good with H.264 live at 1280x720: %.0f pictures a second on one core; target >= 40\n",
           1000 / (b->good + b->live));
  return status;
}

int stic_bench_render(bool quick)
{
  bench b = {.pictures = quick ? 3 : PICTURES_MAX};
  char machine[512];
  stic_error err;
  stic_status status;

  /* Read when Mesa starts: it then draws in the calling thread. */
  setenv("LP_NUM_THREADS", "0", 1);
  make_scene(&b.scene);
  snprintf(b.folder, sizeof b.folder, "/tmp/stiction-bench-XXXXXX");
  if (!mkdtemp(b.folder)) {
    stic_error_set(&err, STIC_CANNOT_WRITE, "/tmp", 0, "cannot make a folder for the bench");
    return stic_cli_fail(&err);
  }
  printf("stiction %s, %s\n", stic_version(), stic_machine_text(machine, sizeof machine));
  status = bench_all(&b, quick, &err);
  nftw(b.folder, remove_entry, 8, FTW_DEPTH | FTW_PHYS);
  if (stic_cli_signal() != 0)
    return STIC_EXIT_SIGNAL + stic_cli_signal();
  if (status != STIC_OK)
    return stic_cli_fail(&err);
  return STIC_OK;
}

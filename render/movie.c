#include "movie.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "clock.h"
#include "error.h"
#include "png_writer.h"
#include "video.h"

#define FPS_MAX 1000
#define NS_PER_S 1000000000

struct stic_movie {
  stic_render *render;
  stic_png_writer *writer; /* NULL: no folder */
  stic_video *video;       /* NULL: none */
  int fps;
  void (*timed)(void *, stic_movie_stage, int64_t);
  void *user;
  bool (*stopped)(void);
  bool force;
  char *folder;     /* NULL: none */
  char *draft;      /* folder of the pictures until they are kept; NULL: not made yet */
  bool folder_made; /* by us: goes again if nothing is kept */
  bool begun;
  int64_t first_ns, last_ns; /* times of the first and the newest result */
  int64_t count;             /* pictures so far */
  bool late;
  int64_t dropped;  /* of them not drawn */
  stic_image image; /* drawn last */
};

void stic_movie_settings_init(stic_movie_settings *s)
{
  memset(s, 0, sizeof *s);
  stic_render_settings_init(&s->render);
  s->fps = 31;
  s->workers = 2;
}

static stic_status check(const stic_movie_settings *s, stic_error *err)
{
  if (s->fps < 1 || s->fps > FPS_MAX)
    return stic_error_set(err, STIC_USAGE, NULL, 0, "%d pictures a second; expected 1 to %d", s->fps,
                          FPS_MAX);
  if (s->workers < 1 || s->workers > STIC_PNG_WORKERS_MAX)
    return stic_error_set(err, STIC_USAGE, NULL, 0, "%d threads for pictures; expected 1 to %d", s->workers,
                          STIC_PNG_WORKERS_MAX);
  return stic_render_settings_validate(&s->render, err);
}

/* ---- folder -------------------------------------------------------------------------------- */

/* "frame_", digits, ".png" */
static bool is_picture(const char *name)
{
  size_t digits = 0;

  if (strncmp(name, "frame_", 6) != 0)
    return false;
  while (isdigit((unsigned char)name[6 + digits]))
    digits++;
  return digits > 0 && strcmp(name + 6 + digits, ".png") == 0;
}

/* How many pictures a folder has, removing them if told; -1 with errno: it cannot be read. */
static int64_t pictures_in(const char *folder, bool remove_them)
{
  DIR *dir = opendir(folder);
  const struct dirent *entry;
  int64_t count = 0;

  if (!dir)
    return -1;
  while ((entry = readdir(dir)) != NULL) {
    if (!is_picture(entry->d_name))
      continue;
    count++;
    if (remove_them)
      unlinkat(dirfd(dir), entry->d_name, 0);
  }
  closedir(dir);
  return count;
}

static stic_status refused(const char *folder, const char *what, stic_error *err)
{
  return stic_error_set(err, STIC_CANNOT_WRITE, folder, 0, "%s: %s", what, strerror(errno));
}

static stic_status refuse_older(const stic_movie *m, stic_error *err)
{
  const int64_t old = pictures_in(m->folder, false);

  if (old < 0)
    return refused(m->folder, "cannot use the folder", err);
  if (old > 0 && !m->force)
    return stic_error_set(err, STIC_CANNOT_WRITE, m->folder, 0,
                          "the folder has older pictures (frame_*.png); expected none, or --force");
  return STIC_OK;
}

static stic_status prepare_folder(stic_movie *m, stic_error *err)
{
  size_t room = strlen(m->folder) + 24;
  stic_status status;
  char *draft;

  m->folder_made = mkdir(m->folder, 0777) == 0;
  if (!m->folder_made && errno != EEXIST)
    return refused(m->folder, "cannot make the folder", err);
  status = refuse_older(m, err);
  if (status != STIC_OK)
    return status;
  draft = malloc(room);
  if (!draft)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  snprintf(draft, room, "%s/.frames-XXXXXX", m->folder);
  if (!mkdtemp(draft)) {
    free(draft);
    return refused(m->folder, "cannot write into the folder", err);
  }
  m->draft = draft;
  return STIC_OK;
}

static stic_status keep_folder(stic_movie *m, stic_error *err)
{
  const stic_status status = refuse_older(m, err);
  int64_t moved = 0;
  int from, to;
  char name[STIC_PNG_NAME_MAX], what[STIC_PNG_NAME_MAX + 40];

  if (status != STIC_OK)
    return status;
  from = open(m->draft, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  to = open(m->folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  pictures_in(m->folder, true);
  while (from >= 0 && to >= 0 && moved < m->count) {
    stic_png_sequence_name(moved, name);
    if (renameat(from, name, to, name) != 0)
      break;
    moved++;
  }
  if (moved < m->count) {
    snprintf(what, sizeof what, "cannot write %s into the folder", from >= 0 && to >= 0 ? name : "pictures");
    refused(m->folder, what, err);
    pictures_in(m->folder, true);
  }
  if (from >= 0)
    close(from);
  if (to >= 0)
    close(to);
  m->folder_made &= moved < m->count;
  return moved < m->count ? STIC_CANNOT_WRITE : STIC_OK;
}

static void drop_folder(stic_movie *m)
{
  if (m->draft) {
    pictures_in(m->draft, true);
    rmdir(m->draft);
  }
  if (m->folder_made)
    rmdir(m->folder);
}

/* ---- the movie ----------------------------------------------------------------------------- */

static stic_status open_parts(stic_movie *m, const stic_movie_settings *s, const stic_scene *scene,
                              stic_error *err)
{
  stic_status status;

  if (s->folder) {
    m->folder = malloc(strlen(s->folder) + 1);
    if (!m->folder)
      return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
    strcpy(m->folder, s->folder);
  }
  status = stic_render_create(scene, &s->render, &m->render, err);
  if (!status && m->folder)
    status = prepare_folder(m, err);
  if (!status && m->folder)
    status = stic_png_writer_create(m->draft, s->render.width, s->render.height, s->workers, &m->writer, err);
  if (!status && s->video)
    status = stic_video_create(s->video, s->render.width, s->render.height, s->fps, s->live, &m->video, err);
  return status;
}

stic_status stic_movie_open(const stic_movie_settings *s, const stic_scene *scene, stic_movie **movie,
                            stic_error *err)
{
  stic_status status = check(s, err);
  stic_movie *m;

  *movie = NULL;
  if (status)
    return status;
  m = calloc(1, sizeof *m);
  if (!m)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  m->fps = s->fps;
  m->timed = s->timed;
  m->user = s->user;
  m->stopped = s->stopped;
  m->force = s->force;
  status = open_parts(m, s, scene, err);
  if (status) {
    stic_movie_close(m);
    return status;
  }
  *movie = m;
  return STIC_OK;
}

static void tell_time(const stic_movie *m, stic_movie_stage stage, int64_t since)
{
  if (m->timed)
    m->timed(m->user, stage, stic_clock_ns() - since);
}

static stic_status draw_one(stic_movie *m, stic_error *err)
{
  int64_t start = stic_clock_ns();
  stic_status status = STIC_OK;

  if (m->late && m->count > 0) {
    m->dropped++;
  } else {
    status = stic_render_draw(m->render, &m->image, err);
    tell_time(m, STIC_MOVIE_RENDER, start);
  }
  start = stic_clock_ns();
  if (!status && m->writer)
    status = stic_png_writer_add(m->writer, m->count, &m->image, err);
  if (!status && m->video)
    status = stic_video_add(m->video, &m->image, err);
  tell_time(m, STIC_MOVIE_ENCODE, start);
  m->count += !status;
  return status;
}

/* Whether the next picture's time, t_0 + i / fps, is before t_ns, or at it. In whole numbers, so that a
 * picture at exactly a result's time shows that result. */
static bool is_due(const stic_movie *m, int64_t t_ns, bool inclusive)
{
  int64_t since = t_ns - m->first_ns, seconds = since / NS_PER_S;
  int64_t picture = m->count % m->fps * NS_PER_S,
          now = since % NS_PER_S * m->fps; /* parts of a second, ns fps */

  if (m->count / m->fps != seconds)
    return m->count / m->fps < seconds;
  return inclusive ? picture <= now : picture < now;
}

static bool goes_on(const stic_movie *m)
{
  return m->begun && !(m->stopped && m->stopped());
}

stic_status stic_movie_before(stic_movie *m, int64_t t_ns, stic_error *err)
{
  stic_status status = STIC_OK;

  while (!status && goes_on(m) && is_due(m, t_ns, false))
    status = draw_one(m, err);
  return status;
}

void stic_movie_set_late(stic_movie *m, bool late)
{
  m->late = late;
}

int64_t stic_movie_dropped(const stic_movie *m)
{
  return m->dropped;
}

void stic_movie_observe(stic_movie *m, const stic_result *result)
{
  if (!m->begun)
    m->first_ns = result->t_ns;
  m->begun = true;
  m->last_ns = result->t_ns;
  stic_render_observe(m->render, result);
}

stic_status stic_movie_finish(stic_movie *m, stic_error *err)
{
  stic_status status = STIC_OK;

  while (!status && goes_on(m) && is_due(m, m->last_ns, true))
    status = draw_one(m, err);
  if (!status && m->writer)
    status = stic_png_writer_finish(m->writer, err);
  if (!status && m->video)
    status = stic_video_finish(m->video, err);
  return status;
}

stic_status stic_movie_keep(stic_movie *m, stic_error *err)
{
  stic_status status = m->video ? stic_video_keep(m->video, err) : STIC_OK;

  return !status && m->folder ? keep_folder(m, err) : status;
}

int64_t stic_movie_count(const stic_movie *m)
{
  return m->count;
}

stic_render *stic_movie_renderer(stic_movie *m)
{
  return m->render;
}

void stic_movie_close(stic_movie *m)
{
  if (!m)
    return;
  stic_png_writer_destroy(m->writer);
  stic_video_destroy(m->video);
  stic_render_destroy(m->render);
  drop_folder(m);
  free(m->draft);
  free(m->folder);
  free(m);
}

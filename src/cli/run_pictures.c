#include "run_pictures.h"

#include <stdlib.h>
#include <string.h>

void stic_run_pictures_init(stic_run_pictures *p)
{
  memset(p, 0, sizeof *p);
  p->fps = STIC_TARGET_HZ;
}

void stic_run_pictures_free(stic_run_pictures *p)
{
  stic_picture_options_free(&p->options);
  free(p->folder);
  free(p->video);
}

bool stic_run_pictures_wanted(const stic_run_pictures *p)
{
  return p->folder || p->video;
}

static void on_stage(void *user, stic_movie_stage stage, int64_t ns)
{
  stic_run_pictures *p = user;

  stic_timing_add(&p->timing, stage == STIC_MOVIE_RENDER ? STIC_STAGE_RENDER : STIC_STAGE_ENCODE, ns);
}

static stic_status open_movie(void *user, stic_error *err)
{
  stic_run_pictures *p = user;
  stic_movie_settings settings;
  stic_status status;

  stic_movie_settings_init(&settings);
  settings.folder = p->folder;
  settings.video = p->video;
  settings.live = true;
  settings.fps = p->fps;
  settings.force = p->force != 0;
  settings.timed = on_stage;
  settings.user = p;
  status = stic_pictures_apply(&p->options, &settings.render, err);
  return status == STIC_OK ? stic_movie_open(&settings, p->scene, &p->movie, err) : status;
}

static stic_status take_result(void *user, const stic_result *result, bool late, stic_error *err)
{
  stic_run_pictures *p = user;
  stic_status status;

  stic_movie_set_late(p->movie, late);
  status = stic_movie_before(p->movie, result->t_ns, err);
  if (status == STIC_OK)
    stic_movie_observe(p->movie, result);
  return status;
}

static stic_status finish_movie(void *user, stic_error *err)
{
  stic_run_pictures *p = user;
  const stic_status status = stic_movie_finish(p->movie, err);

  return status == STIC_OK ? stic_movie_keep(p->movie, err) : status;
}

static void close_movie(void *user)
{
  stic_run_pictures *p = user;

  if (p->movie) {
    p->count = stic_movie_count(p->movie);
    p->dropped = stic_movie_dropped(p->movie);
  }
  stic_movie_close(p->movie);
  p->movie = NULL;
}

stic_live_pictures stic_run_pictures_calls(stic_run_pictures *p, const stic_scene *scene)
{
  const stic_live_pictures calls = {p, open_movie, take_result, finish_movie, close_movie};

  p->scene = scene;
  return calls;
}

#include "review.h"

#include <stdlib.h>
#include <string.h>

#include "../error.h"
#include "video.h"

/* ---- command line -------------------------------------------------------------------------- */

static bool is_plain(const char *word)
{
  static const char plain[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-+=.,:/@%^";

  return *word && strspn(word, plain) == strlen(word);
}

/* Appends a word as a shell takes it back; returns the new end. `at` has room for 4 bytes per byte and 3. */
static char *put_word(char *at, const char *word)
{
  const bool quote = !is_plain(word);

  if (quote)
    *at++ = '\'';
  for (; *word; word++) {
    if (*word == '\'') {
      memcpy(at, "'\\''", 4);
      at += 4;
    } else {
      *at++ = *word;
    }
  }
  if (quote)
    *at++ = '\'';
  return at;
}

static char *command_text(int argc, const char *const *argv)
{
  size_t room = sizeof "stiction";
  char *text, *at;

  for (int i = 0; i < argc; i++)
    room += 4 * strlen(argv[i]) + 3;
  text = malloc(room);
  if (!text)
    return NULL;
  at = put_word(text, "stiction");
  for (int i = 0; i < argc; i++) {
    *at++ = ' ';
    at = put_word(at, argv[i]);
  }
  *at = '\0';
  return text;
}

/* ---- the page ------------------------------------------------------------------------------ */

static bool ends_with(const char *text, const char *end)
{
  return strlen(text) >= strlen(end) && strcmp(text + strlen(text) - strlen(end), end) == 0;
}

/* The video that was asked for if a page can show it, else one that is made for the page. */
static void choose_video(stic_review *v, const char *asked)
{
  if (!stic_video_available())
    strcpy(v->why, "this build makes no video");
  else if (asked && !ends_with(asked, ".mp4") && !ends_with(asked, ".webm"))
    strcpy(v->why, "no browser shows the kind of video that was asked for");
  else
    v->video = asked ? asked : stic_report_video_path(v->report);
  if (!v->video && !*v->why)
    strcpy(v->why, "a page that goes into no file has no place to make one");
}

stic_status stic_review_open(stic_review *v, const char *path, const stic_session *s,
                             const stic_review_source *source, stic_error *err)
{
  stic_report_settings settings;
  stic_status status;

  if (!path)
    return STIC_OK;
  if (source->fps < 1 || source->fps > 1000)
    return stic_error_set(err, STIC_USAGE, NULL, 0, "%d pictures a second; expected 1 to 1000", source->fps);
  v->command = command_text(source->argc, source->argv);
  if (!v->command)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  settings = (stic_report_settings){.path = path,
                                    .scene = &s->scene,
                                    .solver = &s->settings,
                                    .scene_path = source->scene,
                                    .scene_text = s->scene_text,
                                    .input_kind = "trace",
                                    .input = source->trace,
                                    .command = v->command,
                                    .overrides = s->overrides,
                                    .override_count = s->override_count,
                                    .fps = source->fps};
  status = stic_report_open(&settings, &v->report, err);
  if (status == STIC_OK)
    choose_video(v, source->video);
  return status;
}

void stic_review_no_video(stic_review *v, const stic_error *err)
{
  v->video = NULL;
  stic_error_quote(err->message, strlen(err->message), v->why, sizeof v->why);
}

void stic_review_add(stic_review *v, const stic_session *s, int64_t frame_ns)
{
  int count = 0;
  const stic_event *events;

  if (!v->report)
    return;
  events = stic_sim_events(s->sim, &count);
  stic_report_add(v->report, &s->result, events, count, frame_ns);
}

stic_status stic_review_finish(stic_review *v, const stic_session *s, stic_error *err)
{
  stic_status status;

  if (!v->report)
    return STIC_OK;
  if (!v->video)
    stic_cli_say("the page draws the scene from the data, without video: %s", v->why);
  status = stic_report_finish(v->report, v->video, v->why, s->timing, err);
  return status == STIC_OK ? stic_report_keep(v->report, err) : status;
}

void stic_review_close(stic_review *v)
{
  stic_report_close(v->report);
  free(v->command);
  v->report = NULL;
  v->command = NULL;
}

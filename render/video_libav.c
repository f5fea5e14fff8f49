/* Video through libav, as a module of its own: libav brings 150 shared libraries along, which a program that
 * writes no video should not wait for. render/video.c loads it. */
#include "video_module.h"

#include "error.h"

#include <errno.h>
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* What an ending stands for. */
typedef struct video_kind {
  const char *ending, *format, *encoder;
  enum AVPixelFormat pixels;
  const char *options, *live_options; /* of the encoder: "key=value:..." */
} video_kind;

static const video_kind kinds[] = {
  {".mp4", "mp4", "libx264", AV_PIX_FMT_YUV420P, "preset=veryfast:crf=20:rc-lookahead=10:aq-mode=1",
   "preset=ultrafast:crf=20"},
  {".mkv", "matroska", "libx264rgb", AV_PIX_FMT_BGR0, "preset=ultrafast:qp=0", "preset=ultrafast:qp=0"},
  {".webm", "webm", "libvpx-vp9", AV_PIX_FMT_YUV420P, "deadline=realtime:cpu-used=8:crf=32",
   "deadline=realtime:cpu-used=8:crf=32"}};

struct stic_video_writer {
  char *path, *draft;
  const video_kind *kind;
  AVFormatContext *format;
  AVCodecContext *codec;
  AVStream *stream;
  AVFrame *frame;
  AVPacket *packet;
  struct SwsContext *scaler;
  int64_t count;
  bool header_written, finished, kept;
};

static stic_status failed(const stic_video_writer *v, const char *what, int code, stic_error *err)
{
  char reason[AV_ERROR_MAX_STRING_SIZE] = "";

  av_strerror(code, reason, sizeof reason);
  return stic_error_set(err, code == AVERROR(ENOMEM) ? STIC_NO_MEMORY : STIC_CANNOT_WRITE, v->path, 0,
                        "%s: %s", what, reason);
}

static const video_kind *find_kind(const char *path)
{
  size_t length = strlen(path);

  for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
    size_t ending = strlen(kinds[i].ending);

    if (length > ending && !strcmp(path + length - ending, kinds[i].ending))
      return &kinds[i];
  }
  return NULL;
}

static stic_status open_encoder(stic_video_writer *v, int width, int height, int fps, bool live,
                                stic_error *err)
{
  const AVCodec *encoder = avcodec_find_encoder_by_name(v->kind->encoder);
  AVCodecContext *c;
  int code;

  if (!encoder)
    return stic_error_set(err, STIC_USAGE, v->path, 0, "the libavcodec of this machine lacks the encoder %s",
                          v->kind->encoder);
  c = v->codec = avcodec_alloc_context3(encoder);
  if (!c)
    return failed(v, "cannot encode", AVERROR(ENOMEM), err);
  c->width = width;
  c->height = height;
  c->pix_fmt = v->kind->pixels;
  c->time_base = (AVRational){1, fps};
  c->framerate = (AVRational){fps, 1};
  c->sample_aspect_ratio = (AVRational){1, 1};
  c->gop_size = fps < 31 ? fps : 31; /* short enough to step and seek quickly */
  c->thread_count = 1;               /* more would make the file depend on the machine */
  c->flags |= AV_CODEC_FLAG_BITEXACT;
  c->bit_rate = 0; /* quality is given by the options alone */
  c->color_primaries = AVCOL_PRI_BT709;
  c->color_trc = AVCOL_TRC_BT709;
  c->colorspace = v->kind->pixels == AV_PIX_FMT_BGR0 ? AVCOL_SPC_RGB : AVCOL_SPC_BT709;
  c->color_range = v->kind->pixels == AV_PIX_FMT_BGR0 ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG;
  if (v->format->oformat->flags & AVFMT_GLOBALHEADER)
    c->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  code = av_set_options_string(c->priv_data, live ? v->kind->live_options : v->kind->options, "=", ":");
  if (code >= 0)
    code = avcodec_open2(c, encoder, NULL);
  return code < 0 ? failed(v, "cannot encode", code, err) : STIC_OK;
}

static stic_status open_file(stic_video_writer *v, stic_error *err)
{
  AVDictionary *options = NULL;
  int code = avcodec_parameters_from_context(v->stream->codecpar, v->codec);

  v->stream->time_base = v->codec->time_base;
  v->stream->avg_frame_rate = v->codec->framerate;
  if (code >= 0)
    code = avio_open(&v->format->pb, v->draft, AVIO_FLAG_WRITE);
  if (code < 0)
    return failed(v, "cannot write", code, err);
  /* The index goes to the front, so that a browser can start at once. */
  if (!strcmp(v->kind->format, "mp4"))
    av_dict_set(&options, "movflags", "+faststart", 0);
  code = avformat_write_header(v->format, &options);
  av_dict_free(&options);
  v->header_written = code >= 0;
  return code < 0 ? failed(v, "cannot write", code, err) : STIC_OK;
}

static stic_status open_scaler(stic_video_writer *v, stic_error *err)
{
  AVCodecContext *c = v->codec;
  const int *bt709 = sws_getCoefficients(SWS_CS_ITU709);
  int code;

  v->scaler = sws_getContext(c->width, c->height, AV_PIX_FMT_RGB0, c->width, c->height, c->pix_fmt,
                             SWS_FAST_BILINEAR, NULL, NULL, NULL);
  v->packet = av_packet_alloc();
  v->frame = av_frame_alloc();
  if (!v->scaler || !v->packet || !v->frame)
    return failed(v, "cannot encode", AVERROR(ENOMEM), err);
  sws_setColorspaceDetails(v->scaler, bt709, 1, bt709, c->color_range == AVCOL_RANGE_JPEG, 0, 1 << 16,
                           1 << 16);
  v->frame->format = c->pix_fmt;
  v->frame->width = c->width;
  v->frame->height = c->height;
  code = av_frame_get_buffer(v->frame, 0);
  return code < 0 ? failed(v, "cannot encode", code, err) : STIC_OK;
}

static char *join_text(const char *a, const char *b)
{
  size_t room = strlen(a) + strlen(b) + 1;
  char *text = malloc(room);

  if (text)
    snprintf(text, room, "%s%s", a, b);
  return text;
}

static void video_destroy(stic_video_writer *v);

static stic_status video_create(const char *path, int width, int height, int fps, bool live,
                                stic_video_writer **video, stic_error *err)
{
  const video_kind *kind = find_kind(path);
  char suffix[40];
  stic_status status;
  stic_video_writer *v;

  *video = NULL;
  if (!kind)
    return stic_error_set(err, STIC_USAGE, path, 0, "a video's name has to end in .mp4, .mkv or .webm");
  v = calloc(1, sizeof *v);
  if (!v)
    return stic_error_set(err, STIC_NO_MEMORY, path, 0, "out of memory");
  /* The encoders' chatter is not ours; libav has this one level for all of the process. */
  av_log_set_level(AV_LOG_ERROR);
  snprintf(suffix, sizeof suffix, ".%ld.tmp", (long)getpid());
  v->kind = kind;
  v->path = join_text(path, "");
  v->draft = join_text(path, suffix);
  if (v->path && v->draft && avformat_alloc_output_context2(&v->format, NULL, kind->format, v->draft) >= 0)
    v->stream = avformat_new_stream(v->format, NULL);
  if (!v->stream) {
    status = stic_error_set(err, STIC_NO_MEMORY, path, 0, "out of memory, or libav lacks the format %s",
                            kind->format);
  } else {
    v->format->flags |= AVFMT_FLAG_BITEXACT;
    status = open_encoder(v, width, height, fps, live, err);
    if (!status)
      status = open_file(v, err);
    if (!status)
      status = open_scaler(v, err);
  }
  if (status) {
    video_destroy(v);
    return status;
  }
  *video = v;
  return STIC_OK;
}

/* Encodes a picture, or what is left for NULL, and writes all that comes out. */
static stic_status encode(stic_video_writer *v, const AVFrame *frame, stic_error *err)
{
  int code = avcodec_send_frame(v->codec, frame);

  if (code < 0)
    return failed(v, "cannot encode", code, err);
  while ((code = avcodec_receive_packet(v->codec, v->packet)) >= 0) {
    v->packet->stream_index = v->stream->index;
    if (!v->packet->duration)
      v->packet->duration = 1;
    av_packet_rescale_ts(v->packet, v->codec->time_base, v->stream->time_base);
    code = av_interleaved_write_frame(v->format, v->packet);
    /* A full disk shows here, or only in the buffer's own state. */
    if (code >= 0 && v->format->pb->error < 0)
      code = v->format->pb->error;
    if (code < 0)
      return failed(v, "cannot write", code, err);
  }
  if (code != AVERROR(EAGAIN) && code != AVERROR_EOF)
    return failed(v, "cannot encode", code, err);
  return STIC_OK;
}

static stic_status video_add(stic_video_writer *v, const stic_image *image, stic_error *err)
{
  const uint8_t *rows[1] = {image->pixels};
  int stride[1] = {image->width * 4}, code = av_frame_make_writable(v->frame);

  if (code < 0)
    return failed(v, "cannot encode", code, err);
  sws_scale(v->scaler, rows, stride, 0, image->height, v->frame->data, v->frame->linesize);
  v->frame->pts = v->count++;
  return encode(v, v->frame, err);
}

static stic_status video_finish(stic_video_writer *v, stic_error *err)
{
  stic_status status = encode(v, NULL, err);
  int code;

  if (status)
    return status;
  code = av_write_trailer(v->format);
  v->header_written = false;
  if (code >= 0 && v->format->pb->error < 0)
    code = v->format->pb->error;
  if (code >= 0)
    code = avio_closep(&v->format->pb);
  if (code < 0)
    return failed(v, "cannot write", code, err);
  v->finished = true;
  return STIC_OK;
}

static stic_status video_keep(stic_video_writer *v, stic_error *err)
{
  if (!v->finished || rename(v->draft, v->path) != 0)
    return stic_error_set(err, STIC_CANNOT_WRITE, v->path, 0, "cannot write: %s",
                          v->finished ? strerror(errno) : "the video is not finished");
  v->kept = true;
  return STIC_OK;
}

static void video_destroy(stic_video_writer *v)
{
  bool created;

  if (!v)
    return;
  created = v->finished || (v->format && v->format->pb);
  if (v->format && v->format->pb)
    avio_closep(&v->format->pb);
  if (created && !v->kept)
    unlink(v->draft);
  sws_freeContext(v->scaler);
  av_frame_free(&v->frame);
  av_packet_free(&v->packet);
  avcodec_free_context(&v->codec);
  avformat_free_context(v->format);
  free(v->path);
  free(v->draft);
  free(v);
}

STIC_API const stic_video_module stic_video_libav = {
  STIC_VIDEO_MODULE, avcodec_license, video_create, video_add, video_finish, video_keep, video_destroy};

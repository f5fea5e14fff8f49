/* stiction convert: raw recordings of devices and pose files of other programs into traces. */
#include "../../drivers/motion/tracker_yaml.h"
#include "../../drivers/recording/recorded.h"
#include "../error.h"
#include "../io/format.h"
#include "../io/line_reader.h"
#include "../io/outfile.h"
#include "../io/pose_file.h"
#include "../io/trace_csv.h"
#include "cli.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BATCH 64 /* samples taken at once */

static const stic_cli_usage usage = {
  "convert", "[OPTION...] IN OUT",
  "Writes a trace ('-': standard output) from\n"
  "  hid     reports recorded by hid-recorder or by --device NAME:raw=F, decoded by the device's driver\n"
  "  serial  bytes recorded by --device logitech:port=P,raw=F (first line '" STIC_RAW_FORMAT "'), ditto\n"
  "  tum     lines 'timestamp tx ty tz qx qy qz qw', seconds\n"
  "  euroc   CSV 'timestamp,px,py,pz,qw,qx,qy,qz,...', ns\n"
  "A recording is decoded as the live device would have been: silence lets go of the grip, velocities become\n"
  "a pose. Pose files are taken to be in OpenXR's axes unless --tracker turns them, and have no buttons.\n",
  2, 2};

typedef enum format { FORMAT_AUTO, FORMAT_TUM, FORMAT_EUROC, FORMAT_HID, FORMAT_SERIAL } format;

static const char *const format_names[] = {"auto", "tum", "euroc", "hid", "serial"};

#define FORMAT_COUNT ((int)(sizeof format_names / sizeof format_names[0]))

typedef struct options {
  char *from, *device, *tracker;
  int grip, keep_time, lenient;
} options;

typedef struct conversion {
  const options *options;
  bool tracked; /* samples go through `tracker` */
  stic_tracker tracker;
  stic_outfile *out;
  bool begun;
  int64_t start_ns; /* t_ns of the first sample */
  int64_t samples, gripped, lost;
  int64_t unknown; /* samples before the first known pose, left out */
  int64_t skipped; /* bad lines */
  stic_error first_skipped;
} conversion;

/* ---- what it is -------------------------------------------------------------------------- */

static bool is_letter_and_colon(const char *text, size_t length)
{
  return length >= 2 && text[0] >= 'A' && text[0] <= 'Z' && text[1] == ':';
}

static stic_status refuse_format(const char *path, stic_line_status last, int error, stic_error *err)
{
  if (last == STIC_LINE_FAILED)
    return stic_error_set(err, STIC_BAD_INPUT, path, 0, "cannot read: %s", strerror(error));
  return stic_error_set(err, STIC_BAD_INPUT, path, 1,
                        "neither a raw recording nor a TUM or EuRoC pose file; say which by --from");
}

/* By the first lines: a recording names itself, or its first line that is no comment is one of hid-recorder's. */
static stic_status recognize(const char *path, format *found, stic_error *err)
{
  stic_line_reader *lines;
  stic_line_status status;
  stic_pose_format pose;
  const char *text = "";
  size_t length = 0;
  const stic_status opened = stic_line_reader_open(path, &lines, err);
  int error;

  if (opened != STIC_OK)
    return opened;
  *found = FORMAT_AUTO;
  do {
    status = stic_line_reader_next(lines, &text, &length);
    if (status == STIC_LINE_READ && stic_line_format_version(text, length, "serial") >= 0)
      *found = FORMAT_SERIAL;
    if (status == STIC_LINE_READ && stic_line_format_version(text, length, "trace") >= 0) {
      stic_line_reader_close(lines);
      return stic_error_set(err, STIC_BAD_INPUT, path, 1, "this is a trace already");
    }
  } while (*found == FORMAT_AUTO &&
           (status == STIC_LINE_WAIT || (status == STIC_LINE_READ && (length == 0 || text[0] == '#'))));
  if (*found == FORMAT_AUTO && status == STIC_LINE_READ && is_letter_and_colon(text, length))
    *found = FORMAT_HID;
  error = errno;
  if (*found == FORMAT_AUTO && status == STIC_LINE_READ && stic_pose_recognize(text, length, &pose))
    *found = pose == STIC_POSE_TUM ? FORMAT_TUM : FORMAT_EUROC;
  stic_line_reader_close(lines);
  return *found != FORMAT_AUTO ? STIC_OK : refuse_format(path, status, error, err);
}

static stic_status choose_format(const options *o, const char *path, format *found, stic_error *err)
{
  int i = 0;

  while (o->from && i < FORMAT_COUNT && strcmp(o->from, format_names[i]) != 0)
    i++;
  if (i == FORMAT_COUNT)
    return stic_error_set(err, STIC_USAGE, NULL, 0, "--from %.40s: expected auto, tum, euroc, hid or serial",
                          o->from);
  *found = (format)i;
  if (*found != FORMAT_AUTO)
    return STIC_OK;
  if (stic_cli_reads_once(path))
    return stic_error_set(
      err, STIC_USAGE, NULL, 0,
      "standard input or a pipe cannot be looked at first; expected --from tum, euroc, hid or serial");
  return recognize(path, found, err);
}

/* ---- what comes out ---------------------------------------------------------------------- */

static void on_bad_line(void *context, const stic_error *problem)
{
  conversion *c = context;

  if (c->first_skipped.status == STIC_OK)
    c->first_skipped = *problem;
  c->skipped++;
}

static void on_pose_problem(void *context, bool warning, const stic_error *problem)
{
  if (warning)
    stic_cli_warn(problem);
  else
    on_bad_line(context, problem);
}

static stic_status put(conversion *c, stic_sample *sample, const char *path, stic_error *err)
{
  if (!c->begun)
    c->start_ns = c->options->keep_time ? 0 : sample->t_ns;
  c->begun = true;
  if (c->start_ns < 0 && sample->t_ns > INT64_MAX + c->start_ns)
    return stic_error_set(err, STIC_BAD_INPUT, path, 0, "the times span more than 9.2e9 s");
  sample->t_ns -= c->start_ns;
  c->samples++;
  c->gripped += (sample->buttons & STIC_BUTTON_GRIP) != 0;
  c->lost += sample->lost;
  stic_outfile_used(c->out, stic_trace_line(sample, stic_outfile_reserve(c->out, STIC_TRACE_LINE_MAX)));
  return STIC_OK;
}

/* What the solver would have been given of a device's sample. */
static stic_status put_device_sample(conversion *c, stic_device_sample *from, const char *path,
                                     stic_error *err)
{
  stic_sample to;

  if (c->tracked)
    stic_tracker_apply(&c->tracker, from);
  if (!stic_tracker_solvable(from, &to)) {
    c->unknown++;
    return STIC_OK;
  }
  to.t_ns = from->t_ns;
  return put(c, &to, path, err);
}

/* ---- pose files -------------------------------------------------------------------------- */

static stic_status put_pose(conversion *c, const stic_sample *pose, const char *path, stic_error *err)
{
  stic_device_sample sample;

  memset(&sample, 0, sizeof sample);
  sample.t_ns = sample.source_ns = pose->t_ns;
  memcpy(sample.position, pose->position, sizeof sample.position);
  memcpy(sample.orientation, pose->orientation, sizeof sample.orientation);
  sample.buttons = c->options->grip ? STIC_BUTTON_GRIP : 0;
  sample.flags = STIC_SAMPLE_POSITION | STIC_SAMPLE_ORIENTATION | STIC_SAMPLE_TRACKED;
  return put_device_sample(c, &sample, path, err);
}

static stic_status convert_poses(conversion *c, const char *path, stic_pose_format kind, stic_error *err)
{
  const stic_pose_options how = {c->options->lenient != 0, on_pose_problem, c};
  stic_pose_reader *reader;
  stic_pose_status state = STIC_POSE_READ;
  stic_status status = stic_pose_open(path, kind, &how, &reader, err);

  if (status != STIC_OK)
    return status;
  while (status == STIC_OK && stic_cli_signal() == 0 && state != STIC_POSE_END) {
    stic_sample pose;

    state = stic_pose_next(reader, &pose, err);
    if (state == STIC_POSE_READ)
      status = put_pose(c, &pose, path, err);
    else if (state == STIC_POSE_BAD)
      status = STIC_BAD_INPUT;
  }
  stic_pose_close(reader);
  return status;
}

/* ---- recordings -------------------------------------------------------------------------- */

static stic_status put_all(conversion *c, stic_recorded *recorded, const char *path, stic_error *err)
{
  stic_device_sample samples[BATCH];
  stic_status status = STIC_OK;
  int count = 0;

  while (status == STIC_OK && stic_cli_signal() == 0 && count >= 0) {
    count = stic_recorded_next(recorded, samples, BATCH);
    for (int i = 0; i < count && status == STIC_OK; i++)
      status = put_device_sample(c, &samples[i], path, err);
  }
  if (count == STIC_DRIVER_BAD_DATA) {
    *err = *stic_recorded_error(recorded);
    status = STIC_BAD_INPUT;
  }
  if (status == STIC_OK && c->samples == 0 && stic_cli_signal() == 0)
    status = stic_error_set(err, STIC_BAD_INPUT, path, 0,
                            "the recording holds no sample with a known pose; expected reports of %s",
                            stic_recorded_driver(recorded)->about);
  return status;
}

static stic_status convert_recording(conversion *c, const char *path, const stic_tracker_settings *settings,
                                     stic_error *err)
{
  const stic_recorded_options how = {c->options->device, c->options->lenient != 0, on_bad_line, c};
  stic_recorded *recorded;
  stic_status status = stic_recorded_open(path, &how, &recorded, err);

  if (status != STIC_OK)
    return status;
  c->tracked = true;
  stic_tracker_begin(&c->tracker, settings, stic_recorded_driver(recorded)->kind);
  status = put_all(c, recorded, path, err);
  if (status == STIC_OK) {
    const stic_device_counters counters = stic_recorded_counters(recorded);

    if (counters.bad_records > 0 || counters.gaps > 0)
      stic_cli_say("%lld garbled records were left out; the device's count has %lld gaps",
                   (long long)counters.bad_records, (long long)counters.gaps);
  }
  stic_recorded_close(recorded);
  return status;
}

/* ---- the command ------------------------------------------------------------------------- */

static stic_status check_options(const options *o, format from, stic_error *err)
{
  const bool poses = from == FORMAT_TUM || from == FORMAT_EUROC;

  if (poses && o->device)
    return stic_error_set(err, STIC_USAGE, NULL, 0,
                          "--device is for raw recordings; a pose file has no driver");
  if (!poses && o->grip)
    return stic_error_set(err, STIC_USAGE, NULL, 0,
                          "--grip is for pose files; a recording has its own buttons");
  return STIC_OK;
}

static stic_status convert(conversion *c, const char *in, const char *out, stic_error *err)
{
  const options *o = c->options;
  stic_tracker_settings settings;
  format from = FORMAT_AUTO;
  char shown[300];
  stic_status status = stic_cli_check_paths(&in, 1, &out, 1, err);

  if (status == STIC_OK)
    status = choose_format(o, in, &from, err);
  if (status == STIC_OK)
    status = check_options(o, from, err);
  stic_tracker_settings_init(&settings);
  if (status == STIC_OK && o->tracker)
    status = stic_tracker_read(o->tracker, NULL, true, &settings, err);
  if (status == STIC_OK)
    status = stic_outfile_open(out, &c->out, err);
  if (status != STIC_OK)
    return status;
  stic_outfile_print(c->out, STIC_TRACE_FORMAT "\n# from: %s, %s\n" STIC_TRACE_HEADER "\n",
                     format_names[from], stic_error_quote(in, strlen(in), shown, sizeof shown));
  if (from == FORMAT_HID || from == FORMAT_SERIAL)
    return convert_recording(c, in, &settings, err);
  c->tracked = o->tracker != NULL;
  stic_tracker_begin(&c->tracker, &settings, STIC_DRIVER_POSE);
  return convert_poses(c, in, from == FORMAT_TUM ? STIC_POSE_TUM : STIC_POSE_EUROC, err);
}

static void tell(const conversion *c)
{
  char text[600];

  if (c->skipped > 0) {
    stic_error_format(&c->first_skipped, text, sizeof text);
    stic_cli_say("%lld bad line%s passed over, the first: %s", (long long)c->skipped,
                 c->skipped == 1 ? "" : "s", text);
  }
  stic_cli_say(
    "%lld sample%s, %lld with the grip pressed, %lld not tracked; %lld before the first known pose left out",
    (long long)c->samples, c->samples == 1 ? "" : "s", (long long)c->gripped, (long long)c->lost,
    (long long)c->unknown);
  if (c->gripped == 0)
    stic_cli_say("the grip is never pressed: a scene with hold: button will not take the object%s",
                 c->options->device || c->options->grip ? "" : "; pose files: --grip");
}

static int run(const options *o, const char *in, const char *out)
{
  conversion c;
  stic_error err;

  memset(&c, 0, sizeof c);
  c.options = o;
  if (convert(&c, in, out, &err) != STIC_OK) {
    stic_outfile_abort(c.out);
    return stic_cli_fail_to_begin(&err);
  }
  if (stic_cli_signal() != 0) {
    stic_outfile_abort(c.out);
    return STIC_EXIT_SIGNAL + stic_cli_signal();
  }
  if (stic_outfile_commit(c.out, &err) != STIC_OK)
    return stic_cli_fail(&err);
  tell(&c);
  return STIC_OK;
}

int stic_cmd_convert(int argc, const char **argv)
{
  options o = {NULL, NULL, NULL, 0, 0, 0};
  const struct poptOption table[] = {
    {"from", '\0', POPT_ARG_STRING, &o.from, 0, "auto (default), tum, euroc, hid or serial", "FORMAT"},
    {"device", 'd', POPT_ARG_STRING, &o.device, 0,
     "Recordings: the driver and its keys, e.g. hydra:hand=left; default the one that fits",
     "NAME[:key=value,...]"},
    {"tracker", '\0', POPT_ARG_STRING, &o.tracker, 0,
     "Where the tracker stands, its axes, filters and buttons, as for run", "FILE"},
    {"grip", '\0', POPT_ARG_NONE, &o.grip, 0, "Pose files: the grip is pressed in every sample", NULL},
    {"keep-time", '\0', POPT_ARG_NONE, &o.keep_time, 0, "Keep the times; default: the first is 0", NULL},
    {"lenient", '\0', POPT_ARG_NONE, &o.lenient, 0, "Pass over bad lines and count them", NULL},
    POPT_TABLEEND};
  stic_cli_args args;
  int code = stic_cli_parse(&usage, table, argc, argv, &args);

  if (code < 0)
    code = run(&o, args.positions[0], args.positions[1]);
  stic_cli_args_free(&args);
  free(o.from);
  free(o.device);
  free(o.tracker);
  return code;
}

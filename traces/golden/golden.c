#include "golden.h"

#include "../../src/error.h"
#include "../../src/io/log_csv.h"
#include "../../src/io/outfile.h"
#include "../../src/io/trace_csv.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef __GLIBC__
#include <gnu/libc-version.h>
#endif

#define EXPECTED_FORMAT "# stiction-expected 1"

/* ---- replaying --------------------------------------------------------------------------- */

static bool make_room(stic_golden_trace *trace)
{
  stic_sample *samples;

  if ((trace->count & (trace->count - 1)) != 0) /* room for the next power of two is there */
    return true;
  samples = realloc(trace->samples, (trace->count ? 2 * trace->count : 1) * sizeof *samples);
  if (samples)
    trace->samples = samples;
  return samples != NULL;
}

stic_status stic_golden_read_trace(const char *path, stic_golden_trace *trace, stic_error *err)
{
  stic_trace_reader *reader;
  stic_status status = stic_trace_open(path, NULL, &reader, err);
  stic_sample sample;

  trace->samples = NULL;
  trace->count = 0;
  while (status == STIC_OK) {
    const stic_trace_status next = stic_trace_next(reader, &sample, err);

    if (next == STIC_TRACE_END)
      break;
    if (next == STIC_TRACE_BAD)
      status = err->status;
    else if (next == STIC_TRACE_SAMPLE && !make_room(trace))
      status = stic_error_set(err, STIC_NO_MEMORY, path, 0, "out of memory");
    else if (next == STIC_TRACE_SAMPLE)
      trace->samples[trace->count++] = sample;
  }
  stic_trace_close(reader);
  return status;
}

stic_status stic_golden_replay(const stic_scene *scene, const stic_settings *settings,
                               const stic_golden_trace *trace, stic_golden_visit *visit, void *user,
                               char hash[STIC_SHA256_TEXT], stic_error *err)
{
  char text[STIC_LOG_ROW_MAX];
  stic_result row;
  stic_sim *sim;
  stic_sha256 sum;
  const stic_status status = stic_sim_create(scene, settings, &sim, err);

  if (status != STIC_OK)
    return status;
  stic_sha256_begin(&sum);
  stic_sha256_add(&sum, STIC_LOG_HEADER "\n", strlen(STIC_LOG_HEADER) + 1);
  for (size_t i = 0; i < trace->count; i++) {
    stic_sim_step(sim, &trace->samples[i], &row);
    stic_sha256_add(&sum, text, stic_log_row_text(&row, text));
    if (visit) {
      int count;
      const stic_event *events = stic_sim_events(sim, &count);

      visit(user, &row, events, count);
    }
  }
  stic_sha256_end(&sum, hash);
  stic_sim_destroy(sim);
  return STIC_OK;
}

/* ---- the machine ------------------------------------------------------------------------- */

static void hash_arithmetic(char text[STIC_SHA256_TEXT])
{
  const char evaluation = (char)('0' + FLT_EVAL_METHOD);
  uint32_t random = 1;
  stic_sha256 sum;

  stic_sha256_begin(&sum);
  stic_sha256_add(&sum, &evaluation, 1);
  for (int i = 0; i < 4096; i++) {
    double a, b, values[5];

    random = random * 1664525u + 1013904223u;
    a = (double)random * 0x1p-31 - 1;
    random = random * 1664525u + 1013904223u;
    b = (double)random * 0x1p-31 - 1;
    values[0] = sin(7 * a);
    values[1] = cos(7 * b);
    values[2] = acos(a);
    values[3] = atan2(a, b);
    values[4] = hypot(a, b);
    for (int j = 0; j < 5; j++) {
      uint64_t bits;
      unsigned char bytes[8];

      memcpy(&bits, &values[j], sizeof bits);
      for (int k = 0; k < 8; k++)
        bytes[k] = (unsigned char)(bits >> (8 * k)); /* the same in either byte order */
      stic_sha256_add(&sum, bytes, sizeof bytes);
    }
  }
  stic_sha256_end(&sum, text);
}

static const char *processor(void)
{
#if defined(__x86_64__) && defined(__GNUC__)
  const bool intel = __builtin_cpu_is("intel"), amd = __builtin_cpu_is("amd");

  if (__builtin_cpu_supports("fma"))
    return intel ? "x86-64 Intel with FMA" : amd ? "x86-64 AMD with FMA" : "x86-64 with FMA";
  return intel ? "x86-64 Intel without FMA" : amd ? "x86-64 AMD without FMA" : "x86-64 without FMA";
#elif defined(__aarch64__)
  return "aarch64 (FMA)";
#else
  return "another processor";
#endif
}

static const char *c_library(void)
{
#ifdef __GLIBC__
  return gnu_get_libc_version();
#else
  return "none";
#endif
}

void stic_golden_here(stic_golden_expected *here)
{
#if defined(__clang__)
  const char *const compiler = "";
#else
  const char *const compiler = "gcc ";
#endif

  memset(here, 0, sizeof *here);
  hash_arithmetic(here->arithmetic);
  snprintf(here->made_on, sizeof here->made_on, "%s; glibc %s; %s%s; FLT_EVAL_METHOD %d", processor(),
           c_library(), compiler, __VERSION__, (int)FLT_EVAL_METHOD);
}

/* ---- expected.hash ----------------------------------------------------------------------- */

stic_status stic_golden_write_expected(const char *path, const stic_golden_expected *expected,
                                       stic_error *err)
{
  stic_outfile *out;
  const stic_status status = stic_outfile_open(path, &out, err);

  if (status != STIC_OK)
    return status;
  stic_outfile_print(
    out, EXPECTED_FORMAT
    "\n"
    "# Of the log's column header and rows, at accuracy event in precision f64. Holds wherever the C\n"
    "# library's functions return the same bits as where it was made; that is what the second hash tells.\n");
  stic_outfile_print(out, "log-sha256: %s\narithmetic-sha256: %s\nmade-on: %s\n", expected->log,
                     expected->arithmetic, expected->made_on);
  return stic_outfile_commit(out, err);
}

static bool take(const char *line, const char *key, char *value, size_t size)
{
  const size_t skip = strlen(key);
  size_t length;

  if (strncmp(line, key, skip) != 0)
    return false;
  length = strcspn(line + skip, "\n");
  if (length >= size)
    length = size - 1;
  memcpy(value, line + skip, length);
  value[length] = '\0';
  return true;
}

stic_status stic_golden_read_expected(const char *path, stic_golden_expected *expected, stic_error *err)
{
  FILE *file = fopen(path, "r");
  char line[STIC_GOLDEN_LINE + 40];

  memset(expected, 0, sizeof *expected);
  if (!file)
    return stic_error_set(err, STIC_BAD_INPUT, path, 0, "cannot open: %s", strerror(errno));
  while (fgets(line, sizeof line, file)) {
    if (!take(line, "log-sha256: ", expected->log, sizeof expected->log) &&
        !take(line, "arithmetic-sha256: ", expected->arithmetic, sizeof expected->arithmetic))
      take(line, "made-on: ", expected->made_on, sizeof expected->made_on);
  }
  fclose(file);
  if (strlen(expected->log) != 64 || strlen(expected->arithmetic) != 64)
    return stic_error_set(err, STIC_BAD_INPUT, path, 0, "expected two hashes of 64 digits");
  return STIC_OK;
}

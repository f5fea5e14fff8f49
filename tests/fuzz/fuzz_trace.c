/* Traces, strict and lenient. What is read is a hand in order of time, and written and read again it is the same. */
#include "memory_file.h"

#include "io/trace_csv.h"

#include <math.h>
#include <string.h>

#define SAMPLES_MAX 64 /* that are written again */

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(const stic_sample *sample, const stic_sample *last)
{
  double norm = 0;

  for (int i = 0; i < 3; i++)
    require(fabs(sample->position[i]) <= 1e18);
  for (int i = 0; i < 4; i++)
    norm += sample->orientation[i] * sample->orientation[i];
  require(fabs(sqrt(norm) - 1) <= 0.01 && !(sample->buttons & STIC_TRACE_BUTTON_LOST));
  require(!last || sample->t_ns > last->t_ns);
}

static void on_problem(void *context, bool warning, const stic_error *problem)
{
  int *told = context;

  *told += !warning;
  require(problem->message[0] && problem->line > 0);
}

/* Reads all; keeps the first samples, returns how many. */
static int read_all(const char *path, bool lenient, stic_sample *samples)
{
  int told = 0, count = 0;
  const stic_trace_options options = {lenient, on_problem, &told};
  stic_trace_reader *reader;
  stic_trace_status status;
  stic_sample last, sample;
  bool first = true;
  stic_error err;

  require(stic_trace_open(path, &options, &reader, &err) == STIC_OK);
  while ((status = stic_trace_next(reader, &sample, &err)) == STIC_TRACE_SAMPLE ||
         status == STIC_TRACE_WAIT) {
    if (status == STIC_TRACE_WAIT)
      continue;
    check(&sample, first ? NULL : &last);
    if (count < SAMPLES_MAX)
      samples[count++] = sample;
    last = sample;
    first = false;
  }
  require(status == STIC_TRACE_END || err.message[0]);
  require(stic_trace_skipped(reader) == told && (lenient || told == 0));
  stic_trace_close(reader);
  return count;
}

static bool same(const stic_sample *a, const stic_sample *b)
{
  return a->t_ns == b->t_ns && a->buttons == b->buttons && a->lost == b->lost &&
         memcmp(a->position, b->position, sizeof a->position) == 0 &&
         memcmp(a->orientation, b->orientation, sizeof a->orientation) == 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  static memory_file file, copy;
  static stic_sample samples[SAMPLES_MAX], again[SAMPLES_MAX];
  static char text[64 + SAMPLES_MAX * STIC_TRACE_LINE_MAX];
  const char *path = memory_file_write(&file, data, size);
  size_t length = sizeof STIC_TRACE_FORMAT;
  int count;

  read_all(path, false, samples);
  count = read_all(path, true, samples);
  if (count == 0)
    return 0;
  memcpy(text, STIC_TRACE_FORMAT "\n", length);
  for (int i = 0; i < count; i++)
    length += stic_trace_line(&samples[i], text + length);
  require(read_all(memory_file_write(&copy, text, length), false, again) == count);
  for (int i = 0; i < count; i++)
    require(same(&samples[i], &again[i]));
  return 0;
}

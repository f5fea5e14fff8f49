/* What the tests of files and program share. */
#ifndef STIC_TEST_HELP_H
#define STIC_TEST_HELP_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdbool.h>
#include <sys/types.h>

#include "stiction.h"

/* A scene that is right, in lines 1 to 10. */
extern const char stic_test_scene[];

/* A folder of this test program, made on first use; stic_test_clean_up() removes it. */
const char *stic_test_folder(void);
int stic_test_clean_up(void **state);

/* FOLDER/name; stays valid. */
const char *stic_test_path(const char *name);

/* Writes a file of the folder whole; returns its path. */
const char *stic_test_write(const char *name, const char *text);
const char *stic_test_write_bytes(const char *name, const void *data, size_t length);

/* A file's text, to be freed; NULL if there is none. */
char *stic_test_read(const char *path);

/* The rows of a trace's or log's text: what follows its header line "t,..."; "" if there is none. */
const char *stic_test_rows(const char *text);
/* How many rows a file has; 0 without a file. */
int stic_test_count_rows(const char *path);
/* Waits until it has `count` at least; fails if the program that writes it ends before. */
void stic_test_wait_for_rows(pid_t program, const char *path, int count);

void stic_test_pause(int ms);

/* How many entries the folder has whose names contain `part`. */
int stic_test_count_entries(const char *part);

/* A text with lines of a trace: the format line, the header, `count` good samples at 50 Hz. To be freed. */
char *stic_test_trace(int count);

/* Runs the program ($STICTION) with arguments up to NULL and waits. */
typedef struct stic_test_run {
  int code;        /* exit code; 1000 + n if killed by signal n */
  char out[65536]; /* standard output */
  char err[65536]; /* standard error */
} stic_test_run;
const stic_test_run *stic_test_program(const char *first, ...);
/* Fails unless it ended with that code and its standard error contains `words`. A short name, for what is said most. */
void expect(const stic_test_run *run, int code, const char *words);

/* Starts it with standard output and error to files "out" and "err", standard input from `input` (NULL:
 * empty), and does not wait. */
pid_t stic_test_start(const char *input, const char *const *arguments);
int stic_test_wait(pid_t child);

/* Fails unless `text` contains `part`, and shows both. */
void stic_test_contains(const char *text, const char *part);

/* A file that is wrong, the line of which this is said (0: of none), and words that are said. */
typedef struct stic_test_wrong {
  const char *text;
  int line;
  const char *words;
} stic_test_wrong;

/* Fails unless the reader's answer is what is expected of the file at `path`. */
void stic_test_refused(stic_status status, const stic_error *err, const char *path, int line,
                       const char *words);

/* ... of each as a file of its own. */
typedef stic_status stic_test_reader(const char *path, stic_error *err);
void stic_test_wrong_files(const stic_test_wrong *files, size_t count, stic_test_reader *read);

#endif

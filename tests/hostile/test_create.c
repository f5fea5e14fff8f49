/* Whatever makes something is refused, in turn, each piece of memory and each thread, pipe or library that it asks for:
 * it says so, leaves nothing behind, and works the next time. The tables (makers_*.c) have every such function of the
 * headers; one that is not in them fails. */
#define _XOPEN_SOURCE 700 /* nftw() */
#include "../files/help.h"
#include "makers.h"
#include "refuse.h"

#include <dirent.h>
#include <ftw.h>
#include <jansson.h>
#include <regex.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

char poison;

static const maker_group *const groups[] = {&library_makers, &driver_makers, &picture_makers, &plot_makers};

enum { GROUPS = sizeof groups / sizeof groups[0] };

stic_status without_words(bool good, stic_error *err)
{
  return good ? STIC_OK : stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
}

void end_nothing(void *made)
{
  (void)made;
}

/* ---- the sweep ------------------------------------------------------------------------------- */

static int open_files(void)
{
  DIR *folder = opendir("/proc/self/fd");
  int count = 0;

  assert_non_null(folder);
  while (readdir(folder))
    count++;
  closedir(folder);
  return count;
}

/* What is wrong with an answer, given what was refused; NULL: nothing. */
static const char *wrong_answer(stic_status status, const stic_error *err, const void *made, refused what)
{
  if (what == REFUSED_NOTHING)
    return status == STIC_OK ? NULL : "fails by itself";
  if (status == STIC_OK) /* a second library or fewer threads may do */
    return what == REFUSED_MEMORY ? "goes on without memory" : NULL;
  if (made && made != &poison)
    return "gives something in spite of failing";
  if (what == REFUSED_MEMORY && status != STIC_NO_MEMORY)
    return "does not say that memory is short";
  if (err && (err->status != status || !err->message[0]))
    return "does not say why";
  return err && what == REFUSED_MEMORY && !strstr(err->message, "memory") ? "does not speak of memory" : NULL;
}

/* With the n-th request refused (0: none): whether there was an n-th. */
static bool make_once(const maker *m, int n, bool all_after, bool with_words)
{
  const int files = open_files();
  stic_error err = {.status = STIC_OK};
  void *made = NULL;
  const char *wrong;
  stic_status status;
  refused what;

  refuse_begin(n, all_after);
  status = m->make(&made, with_words ? &err : NULL);
  what = refuse_end();
  wrong = wrong_answer(status, with_words ? &err : NULL, made, what);
  if (status == STIC_OK)
    m->end(made);
  if (!wrong && refuse_blocks_left() > 0)
    wrong = "does not free all";
  if (!wrong && open_files() > files)
    wrong = "leaves a file open";
  if (!wrong && stic_test_count_entries(".tmp") + stic_test_count_entries(".frames") > 0)
    wrong = "leaves a temporary file";
  if (wrong)
    fail_msg("%s %s %s: request %d%s, status %d, '%s'", m->function, m->how, wrong, n,
             all_after ? " and all after" : "", (int)status, err.message);
  return what != REFUSED_NOTHING;
}

static void sweep(const maker *m)
{
  int n;

  make_once(m, 0, false, true); /* what is kept from the first time on is there now */
  for (n = 1; make_once(m, n, false, true); n++) {
    make_once(m, n, true, true);
    make_once(m, n, false, false);
  }
  if (n == 1)
    fail_msg("%s %s asks for nothing", m->function, m->how);
  print_message("%-32s %-24s %4d requests\n", m->function, m->how, n - 1);
}

static void test_refused(void **state)
{
  (void)state;
  for (int i = 0; i < GROUPS; i++) {
    groups[i]->set_up();
    for (const maker *m = groups[i]->makers; m->function; m++)
      sweep(m);
    groups[i]->tear_down();
  }
}

/* ---- the tables have all of them ------------------------------------------------------------- */

/* Those that look like makers and only give what is there, or parse without memory. */
static const char *const others[] = {
  "stic_line_reader_next", "stic_supervisor_device", "stic_hid_read_rates",     "stic_tty_read",
  "stic_movie_renderer",   "stic_outfile_reserve",   "stic_live_view",          "stic_live_reader_main",
  "stic_live_solver_main", "stic_live_writer_main",  "stic_live_pictures_main", "stic_ring_slot",
  "stic_latest_slot",      "stic_key_numbers",
#ifndef WITH_VIDEO
  "stic_video_create",     "stic_module_load",
#endif
#ifndef WITH_WINDOW
  "stic_window_load",      "stic_viewer_open",
#endif
};

static bool is_known(const char *name)
{
  bool known = false;

  for (int i = 0; i < GROUPS; i++) {
    for (const maker *m = groups[i]->makers; m->function; m++)
      known = known || strcmp(m->function, name) == 0;
  }
  for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
    known = known || strcmp(others[i], name) == 0;
  return known;
}

/* Blanks out what is no declaration: comments and the preprocessor's lines. */
static void strip(char *text)
{
  for (char *at = text; *at; at++) {
    const bool comment = at[0] == '/' && at[1] == '*', line = at[0] == '#' && (at == text || at[-1] == '\n');

    while (*at && (comment ? !(at[0] == '*' && at[1] == '/') : line && !(at[0] == '\n' && at[-1] != '\\')))
      *at++ = ' ';
    if (comment && *at)
      at[0] = at[1] = ' ';
    if (!*at)
      break;
  }
}

/* A declaration of result, name and parameters: whether it hands something out that was made, by a pointer to a pointer
 * or to what others may change, or by its name. */
static bool is_maker(const char *result, const char *name, const char *parameters)
{
  regex_t verb;
  bool makes = strstr(parameters, "**") || (strchr(result, '*') && !strstr(result, "const"));

  assert_int_equal(regcomp(&verb,
                           "_(create|open|reopen|load|new|read|init|begin|start|connect|adopt|copy)(_|$)",
                           REG_EXTENDED | REG_NOSUB),
                   0);
  makes = makes || (!strstr(result, "void") && regexec(&verb, name, 0, NULL, 0) == 0);
  regfree(&verb);
  return makes && !strstr(result, "static");
}

static int makers_seen, unknown;

static void look_into(const char *path)
{
  char *text = stic_test_read(path), result[200], name[100], parameters[1000];
  const char *at = text;
  regmatch_t part[4];
  regex_t declaration;

  assert_non_null(text);
  strip(text);
  assert_int_equal(regcomp(&declaration,
                           "([A-Za-z_][A-Za-z0-9_ ]*[ *]+)(stic_[a-z0-9_]+)\\(([^;{]*)\\)[^;{]*;",
                           REG_EXTENDED),
                   0);
  for (; regexec(&declaration, at, 4, part, 0) == 0; at += part[0].rm_eo) {
    snprintf(result, sizeof result, "%.*s", (int)(part[1].rm_eo - part[1].rm_so), at + part[1].rm_so);
    snprintf(name, sizeof name, "%.*s", (int)(part[2].rm_eo - part[2].rm_so), at + part[2].rm_so);
    snprintf(parameters, sizeof parameters, "%.*s", (int)(part[3].rm_eo - part[3].rm_so), at + part[3].rm_so);
    if (!is_maker(result, name, parameters))
      continue;
    makers_seen++;
    if (!is_known(name)) {
      unknown++;
      print_error("%s: %s() is not in the table\n", path, name);
    }
  }
  regfree(&declaration);
  free(text);
}

static int visit(const char *path, const struct stat *st, int kind, struct FTW *where)
{
  const char *end = strrchr(path, '.');

  (void)st, (void)where;
  if (kind == FTW_F && end && strcmp(end, ".h") == 0 &&
      !strstr(path, "/src/cli/")) /* the program's own: test_memory.py */
    look_into(path);
  return 0;
}

static void test_complete(void **state)
{
  static const char *const folders[] = {"src", "drivers", "render"};
  char path[4096];

  (void)state;
  for (int i = 0; i < 3; i++) {
    snprintf(path, sizeof path, SOURCE_FOLDER "/%s", folders[i]);
    assert_int_equal(nftw(path, visit, 16, FTW_PHYS), 0);
  }
  print_message("%d functions of the headers\n", makers_seen);
  assert_true(makers_seen >= 60);
  assert_int_equal(unknown, 0);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_complete),
    cmocka_unit_test(test_refused),
  };

  json_set_alloc_funcs(malloc, free); /* its requests count too */
  return cmocka_run_group_tests(tests, NULL, stic_test_clean_up);
}

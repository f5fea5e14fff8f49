/* Every way in which a scene file can be wrong: the line and the words. */
#include "help.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "angle.h"
#include "scene_yaml.h"

typedef struct wrong {
  const char *find, *replace; /* in the good scene; find NULL: `replace` is the whole file */
  int line;
  const char *words;
} wrong;

static const wrong cases[] = {
  /* the file as a whole */
  {NULL, "", 1, "empty"},
  {NULL, "# nothing\n", 1, "empty"},
  {NULL, "- 1\n", 1, "expected a mapping"},
  {NULL, "hello\n", 1, "'hello'; expected a mapping"},
  {NULL, "\xff\xfes\0", 1, "UTF-16"},
  {NULL, "stiction: 1\nname: \xff\n", 2, "not valid text"},
  {NULL, "stiction: 1\nname: [\n", 3, "not valid YAML"},
  {NULL, "stiction: 1\n\tname: x\n", 2, "indented with a tab; YAML expects spaces"},
  {"stiction: 1", "stiction: 2", 1, "format version 2; expected 1"},
  {"stiction: 1", "stiction: one", 1, "expected the format version"},
  {"stiction: 1\n", "", 1, "stiction is missing"},
  {"normal_deg: 90}\n", "normal_deg: 90}\n---\nstiction: 1\n", 12, "not valid YAML"},
  {"dynamic: 0.2}}\n", "dynamic: 0.2}}\n---\nstiction: 1\n", 12, "second document"},
  /* keys */
  {"name: test", "nme: test", 2, "unknown key 'nme' in the scene; expected stiction, name, object"},
  {"name: test", "? [a]\n: 1", 2, "unknown key"},
  {"  pose:", "  position:", 5, "unknown key 'position' in object; expected size, polygon"},
  {"{name: floor", "{name: \"a\\a\"", 9, "'a?' in quotes; expected printable text"},
  {"{name: floor", "{nam: floor", 9, "unknown key 'nam' in surfaces.0; expected name, point"},
  {"name: test", "name: test\nname: other", 3, "name is given again, first in line 2"},
  {"name: test", "name: &a test", 2, "anchor (&a)"},
  {"name: test", "name: *a", 2, "alias (*a)"},
  {"name: test", "name: !!str test", 2, "tag"},
  {"name: test", "name: [1]", 2, "name is a list of 1; expected printable text"},
  {"name: test", "name: \"a\\nb\"", 2, "expected printable text"},
  {"name: test", "name: 0123456789012345678901234567890123456789012345678901234567890123", 2, "63 bytes"},
  /* what is missing */
  {"  size: [0.16, 0.08, 0.10]\n", "", 3, "object.size is missing"},
  {"hand: {stiffness: 200, rotational_stiffness: 0.5}\n", "", 1, "hand is missing"},
  {"stiffness: 200, ", "", 6, "hand.stiffness is missing; expected a number > 0"},
  {", rotational_stiffness: 0.5", "", 6, "hand.rotational_stiffness is missing"},
  {"friction: {static: 0.5, dynamic: 0.3}\n", "", 8, "surface 0 has no static friction"},
  {"dynamic: 0.3", "", 9, "surface 0 has no dynamic friction"},
  {"point: [0, 0], normal_deg: 90", "normal_deg: 90", 9, "surfaces.0.point is missing"},
  {", normal_deg: 90", "", 9, "surfaces.0.normal_deg is missing"},
  /* types and numbers */
  {"object:\n", "object: 5\nx:\n", 3, "object is '5'; expected a mapping"},
  {"stiffness: 200", "stiffness: '200'", 6, "'200' in quotes"},
  {"stiffness: 200", "stiffness: [200]", 6, "a list of 1; expected a number"},
  {"stiffness: 200", "stiffness: .inf", 6, "'.inf'"},
  {"stiffness: 200", "stiffness: .nan", 6, "'.nan'"},
  {"stiffness: 200", "stiffness: 0x20", 6, "'0x20'"},
  {"stiffness: 200", "stiffness: 1_000", 6, "'1_000'"},
  {"stiffness: 200", "stiffness: 0200", 6, "'0200'"},
  {"stiffness: 200", "stiffness: 3:20", 6, "'3:20'"},
  {"stiffness: 200", "stiffness: 1e999", 6, "'1e999'"},
  {"stiffness: 200", "stiffness: 200 N", 6, "'200 N'"},
  {"stiffness: 200", "stiffness: ~", 6, "'~'"},
  {"stiffness: 200", "stiffness: ", 6, "nothing; expected a number"},
  {"stiffness: 200", "stiffness: 0", 6, "expected a number > 0"},
  {"stiffness: 200", "stiffness: -1", 6, "expected a number > 0"},
  {"rotational_stiffness: 0.5", "rotational_stiffness: -0.5", 6, "expected a number >= 0"},
  {"0.5}\nfr", "0.5, hold: maybe}\nfr", 6, "expected start or button"},
  {"0.5}\nfr", "0.5, reach: -1}\nfr", 6, "hand.reach is '-1'"},
  {"0.5}\nfr", "0.5, holding_point: [1]}\nfr", 6, "hand.holding_point is a list of 1"},
  {"0.5}\nfr", "0.5, holding_point: [1, a]}\nfr", 6, "hand.holding_point has 'a'"},
  {"x: 0.30", "x: 1e16", 5, "object.pose.x is '1e16'; expected a number within"},
  {"static: 0.5", "static: -0.5", 7, "friction.static is '-0.5'"},
  {"dynamic: 0.3", "dynamic: 0.6", 7, "dynamic friction 0.6 of surface 0 (floor) is above the static 0.5"},
  {"dynamic: 0.2", "dynamic: 0.6", 10, "dynamic friction 0.6 of surface 1 (wall)"},
  /* the object */
  {"[0.16, 0.08, 0.10]", "[0.16, 0.08]", 4, "object.size is a list of 2"},
  {"[0.16, 0.08, 0.10]", "[0.16,\n    -0.08, 0.10]", 5, "object.size is '-0.08'"},
  {"[0.16, 0.08, 0.10]", "[0.16, 0.08, 1e10]", 4, "object.size is '1e10'"},
  {"size: [0.16, 0.08, 0.10]", "size: [0.16, 0.08, 0.10]\n  depth: 1", 5, "object.depth beside size"},
  {"size: [0.16, 0.08, 0.10]", "size: [0.16, 0.08, 0.10]\n  polygon: [[0, 0], [1, 0], [0, 1]]", 5,
   "both size and polygon"},
  {"size: [0.16, 0.08, 0.10]", "polygon: [[0, 0], [1, 0]]", 4, "object.polygon is a list of 2"},
  {"size: [0.16, 0.08, 0.10]", "polygon:\n  - [0, 0]\n  - [1]\n  - [0, 1]", 6,
   "vertex 1 of object.polygon is a list of 1"},
  {"size: [0.16, 0.08, 0.10]", "polygon: [[0, 0], [0, 0.1], [0.1, 0]]", 4, "clockwise"},
  {"size: [0.16, 0.08, 0.10]",
   "polygon:\n  - [-0.1, -0.1]\n  - [0.1, -0.1]\n  - [0, 0]\n  - [0.1, 0.1]\n  - [-0.1, 0.1]", 7,
   "not convex"},
  {"size: [0.16, 0.08, 0.10]", "polygon:\n  - [-0.1, -0.1]\n  - [0, -0.1]\n  - [0.1, -0.1]\n  - [0, 0.1]", 6,
   "not convex"},
  {"size: [0.16, 0.08, 0.10]", "polygon:\n  - [-0.1, -0.1]\n  - [-0.1, -0.1]\n  - [0.1, -0.1]\n  - [0, 0.1]",
   6, "vertex 1 is the same as vertex 0"},
  {"size: [0.16, 0.08, 0.10]",
   "polygon: [[0, 1], [-0.59, -0.81], [0.95, 0.31], [-0.95, 0.31], [0.59, -0.81]]", 4, "not convex"},
  {"size: [0.16, 0.08, 0.10]", "polygon: [[0, 0], [1e-10, 0], [0, 1e-10]]", 4, "large; expected"},
  /* surfaces */
  {"surfaces:\n", "surfaces: []\nx:\n", 8, "expected a list of 1 to 256 surfaces"},
  {"surfaces:\n", "surfaces: {}\nx:\n", 8, "expected a list of 1 to 256 surfaces"},
  {"{name: floor, point: [0, 0], normal_deg: 90}", "floor", 9, "surfaces.0 is 'floor'; expected a mapping"},
  {"normal_deg: 90", "normal_deg: up", 9, "surfaces.0.normal_deg is 'up'"},
  {"y: 0.20", "y: 0.02", 5, "the object starts inside surface 0 (floor): vertex 0"},
};

static char *good_scene_with(const char *find, const char *replace)
{
  const char *at = find ? strstr(stic_test_scene, find) : NULL;
  char *text = malloc(strlen(stic_test_scene) + strlen(replace) + 1);

  assert_non_null(text);
  if (!find)
    return strcpy(text, replace);
  assert_non_null(at);
  memcpy(text, stic_test_scene, (size_t)(at - stic_test_scene));
  sprintf(text + (at - stic_test_scene), "%s%s", replace, at + strlen(find));
  return text;
}

static void test_wrong_scenes(void **state)
{
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    char *text = good_scene_with(cases[i].find, cases[i].replace);
    const char *path = stic_test_write("scene.yaml", text);
    stic_scene scene, before;
    stic_error err;

    memset(&scene, 0xa5, sizeof scene);
    before = scene;
    stic_test_refused(stic_scene_read(path, NULL, 0, &scene, &err), &err, path, cases[i].line,
                      cases[i].words);
    assert_memory_equal(&scene, &before, sizeof scene);
    free(text);
  }
}

static void test_good_scene(void **state)
{
  stic_scene s;
  stic_error err;

  (void)state;
  assert_int_equal(stic_scene_read(stic_test_write("scene.yaml", stic_test_scene), NULL, 0, &s, &err),
                   STIC_OK);
  assert_string_equal(s.name, "test");
  assert_int_equal(s.vertex_count, 4);
  assert_true(s.vertices[0][0] == -0.08 && s.vertices[0][1] == -0.04 && s.vertices[2][0] == 0.08);
  assert_true(s.depth == 0.1 && s.x == 0.3 && s.y == 0.2 && s.z == 0);
  assert_true(fabs(s.angle - 20.05 * STIC_PI / 180) < 1e-15);
  assert_true(s.stiffness == 200 && s.rotational_stiffness == 0.5 && s.reach == 0.05);
  assert_int_equal(s.hold, STIC_HOLD_START);
  assert_int_equal(s.surface_count, 2);
  assert_string_equal(s.surfaces[1].name, "wall");
  assert_true(s.surfaces[0].friction.mu_static == 0.5 && s.surfaces[0].friction.mu_dynamic == 0.3);
  assert_true(s.surfaces[1].friction.mu_static == 0.4 && s.surfaces[1].friction.mu_dynamic == 0.2);
  assert_int_equal(s.surfaces[1].line, 10);
}

/* A byte-order mark, carriage returns, a missing last line end and a start in touch are all fine. */
static void test_tolerated(void **state)
{
  char text[2048] = "\xef\xbb\xbf";
  size_t used = 3;
  stic_scene s;
  stic_error err;
  char *touching = good_scene_with("y: 0.20, z: 0.0, angle_deg: 20.05", "y: 0.04");
  static const char hundred[] = "stiction: 1\nobject: {size: [1, 1, 1], pose: {y: 0.5, angle_deg: 90}}\n"
                                "hand: {stiffness: 1, rotational_stiffness: 0}\nsurfaces: [{point: [0, 0], "
                                "normal_deg: 450, friction: {static: 0, dynamic: 0}}]";

  (void)state;
  for (const char *c = stic_test_scene; *c; c++) {
    if (*c == '\n')
      text[used++] = '\r';
    text[used++] = *c;
  }
  assert_int_equal(stic_scene_read(stic_test_write_bytes("s.yaml", text, used), NULL, 0, &s, &err), STIC_OK);
  assert_int_equal(s.surfaces[1].line, 10);
  assert_int_equal(stic_scene_read(stic_test_write("s.yaml", touching), NULL, 0, &s, &err), STIC_OK);
  assert_int_equal(stic_scene_read(stic_test_write("s.yaml", hundred), NULL, 0, &s, &err), STIC_OK);
  free(touching);
}

static void test_limits(void **state)
{
  char *text = malloc(1 << 21);
  size_t used = 0;
  stic_scene s;
  stic_error err;

  (void)state;
  assert_non_null(text);
  used += (size_t)sprintf(text, "stiction: 1\nobject:\n  polygon:\n");
  for (int i = 0; i < 65; i++)
    used += (size_t)sprintf(text + used, "  - [%.17g, %.17g]\n", 0.1 * cos(i * 6.283185307 / 65),
                            0.1 * sin(i * 6.283185307 / 65));
  assert_int_equal(stic_scene_read(stic_test_write("s.yaml", text), NULL, 0, &s, &err), STIC_BAD_INPUT);
  assert_int_equal(err.line, 3 + 65);
  stic_test_contains(err.message, "has 65 vertices; expected 3 to 64");

  used = (size_t)sprintf(text, "stiction: 1\nobject: {size: [1, 1, 1], pose: {y: 9}}\nhand: {stiffness: 1, "
                               "rotational_stiffness: 1}\nfriction: {static: 1, dynamic: 1}\nsurfaces:\n");
  for (int i = 0; i < 257; i++)
    used += (size_t)sprintf(text + used, "- {point: [0, 0], normal_deg: 90}\n");
  assert_int_equal(stic_scene_read(stic_test_write("s.yaml", text), NULL, 0, &s, &err), STIC_BAD_INPUT);
  assert_int_equal(err.line, 5 + 257);
  stic_test_contains(err.message, "surfaces has 257 items");

  memset(text, '#', 1 << 21);
  assert_int_equal(stic_scene_read(stic_test_write_bytes("s.yaml", text, 1 << 21), NULL, 0, &s, &err),
                   STIC_BAD_INPUT);
  stic_test_contains(err.message, "more than 1048576 bytes");
  memset(text, '[', 1 << 19);
  assert_int_equal(stic_scene_read(stic_test_write_bytes("s.yaml", text, 1 << 19), NULL, 0, &s, &err),
                   STIC_BAD_INPUT);
  assert_int_equal(stic_scene_read(stic_test_write_bytes("s.yaml", "a: 1\nb\0: 1\n", 11), NULL, 0, &s, &err),
                   STIC_BAD_INPUT);
  assert_int_equal(err.line, 2);
  stic_test_contains(err.message, "zero byte");
  assert_int_equal(stic_scene_read("/nonexistent/s.yaml", NULL, 0, &s, &err), STIC_BAD_INPUT);
  stic_test_contains(err.message, "No such file");
  assert_int_equal(stic_scene_read("/tmp", NULL, 0, &s, &err), STIC_BAD_INPUT);
  free(text);
}

typedef struct override_case {
  const char *key, *value;
  const char *words; /* NULL: fine */
} override_case;

static void test_overrides(void **state)
{
  static const override_case overrides[] = {
    {"friction.static", "0.6", NULL},
    {"object.size", "[0.1, 0.1, 0.1]", NULL},
    {"object.polygon", "[[0, 0], [0.1, 0], [0, 0.1]]", NULL},
    {"object.depth", "0.2", NULL},
    {"surfaces.floor.point", "[0, -0.1]", NULL},
    {"surfaces.1.friction.static", "0.9", NULL},
    {"hand.hold", "button", NULL},
    {"friction", "{static: 1, dynamic: 1}", NULL},
    {"friction.stat", "0.6", "unknown key 'stat' in friction; expected static, dynamic"},
    {"friction.static", "abc", "friction.static is 'abc'; expected a number"},
    {"friction.static", "", "no value"},
    {"friction.static.x", "1", "unknown key 'x' in friction.static; expected nothing more"},
    {"surfaces.roof.point", "[0, 0]", "no single surface 'roof'; expected a name or 0 to 1"},
    {"surfaces.2.point", "[0, 0]", "no single surface '2'"},
    {"friction.static", "[", "not valid YAML"},
    {"friction.static", "*a", "alias"},
  };
  const char *path = stic_test_write("scene.yaml", stic_test_scene);

  (void)state;
  for (size_t i = 0; i < sizeof overrides / sizeof overrides[0]; i++) {
    const stic_override override = {overrides[i].key, overrides[i].value};
    stic_scene s;
    stic_error err;
    const stic_status status = stic_scene_read(path, &override, 1, &s, &err);

    if (!overrides[i].words) {
      if (status != STIC_OK)
        fail_msg("--set %s=%s: %s", override.key, override.value, err.message);
      continue;
    }
    assert_int_equal(status, STIC_USAGE);
    stic_test_contains(err.message, overrides[i].words);
  }
}

/* A value that is missing in the file may come from --set; the later of two counts. */
static void test_override_values(void **state)
{
  char *text = good_scene_with("stiffness: 200, ", "");
  const char *path = stic_test_write("scene.yaml", text);
  const stic_override set[] = {{"hand.stiffness", "5"}, {"hand.stiffness", "7"}, {"friction.static", "0.9"}};
  stic_scene s;
  stic_error err;

  (void)state;
  assert_int_equal(stic_scene_read(path, set, 3, &s, &err), STIC_OK);
  assert_true(s.stiffness == 7);
  assert_true(s.surfaces[0].friction.mu_static == 0.9 && s.surfaces[1].friction.mu_static == 0.4);
  free(text);
}

typedef struct counts {
  int errors, warnings;
  char all[4096];
} counts;

static void count_problem(void *context, bool warning, const stic_error *problem)
{
  counts *c = context;
  char text[1024];

  c->errors += !warning;
  c->warnings += warning;
  stic_error_format(problem, text, sizeof text);
  if (strlen(c->all) + strlen(text) + 2 < sizeof c->all)
    strcat(strcat(c->all, text), "\n");
}

static void test_all_problems(void **state)
{
  static const char bad[] =
    "stiction: 1\nobject:\n  size: [0.16, x, 0.1]\n  colour: red\nhand: {stiffness: -1}\n"
    "friction: {static: 0.3, dynamic: 0.5}\nsurfaces:\n  - {point: [0, 0]}\n  - {point: [0, 0], normal_deg: 0}\n";
  static const char *const expected[] = {
    ":3: object.size has 'x'",    ":4: unknown key 'colour'",
    ":5: hand.stiffness is '-1'", ":5: hand.rotational_stiffness is missing",
    ":6: dynamic friction",       ":8: surfaces.0.normal_deg is missing"};
  counts c = {0, 0, ""};
  stic_scene s;

  (void)state;
  assert_int_equal(stic_scene_read_all(stic_test_write("s.yaml", bad), NULL, 0, &s, NULL, count_problem, &c),
                   STIC_BAD_INPUT);
  for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++)
    stic_test_contains(c.all, expected[i]);
  assert_int_equal(c.errors, sizeof expected / sizeof expected[0]);
}

static void test_normals(void **state)
{
  static const double exact[][3] = {{0, 1, 0},    {90, 0, 1},  {180, -1, 0},  {270, 0, -1},
                                    {-90, 0, -1}, {360, 1, 0}, {-450, 0, -1}, {1e6 * 90, 1, 0}};

  (void)state;
  for (size_t i = 0; i < sizeof exact / sizeof exact[0]; i++) {
    double n[2];

    stic_normal_from_degrees(exact[i][0], n);
    assert_true(n[0] == exact[i][1] && n[1] == exact[i][2]);
  }
}

static void test_validate(void **state)
{
  stic_scene s;
  stic_error err;

  (void)state;
  memset(&s, 0xa5, sizeof s);
  stic_scene_init(&s);
  assert_int_equal(stic_scene_validate(&s, &err), STIC_BAD_INPUT);
  stic_scene_set_box(&s, 0.2, 0.1);
  assert_true(fabs(stic_scene_size(&s) - hypot(0.2, 0.1)) < 1e-16);
  s.stiffness = 200;
  s.y = 1;
  s.surface_count = 1;
  s.surfaces[0].normal_deg = 90;
  assert_int_equal(stic_scene_validate(&s, &err), STIC_OK);
  s.y = NAN;
  assert_int_equal(stic_scene_validate(&s, &err), STIC_BAD_INPUT);
  stic_test_contains(err.message, "object.pose.y is");
  s.y = 0.05 - 1e-14;
  assert_int_equal(stic_scene_validate(&s, NULL), STIC_OK);
  s.y = 0.05 - 1e-11;
  assert_int_equal(stic_scene_validate(&s, &err), STIC_BAD_INPUT);
  stic_test_contains(err.message, "starts inside surface 0");
}

/* What only a program that fills the struct itself can get wrong. */
static void test_validate_values(void **state)
{
  stic_scene good, s;
  stic_error err;

  (void)state;
  stic_scene_init(&good);
  stic_scene_set_box(&good, 0.2, 0.1);
  good.stiffness = 200;
  good.y = 1;
  good.surface_count = 1;
  good.surfaces[0].normal_deg = 90;
  assert_int_equal(stic_scene_validate(&good, &err), STIC_OK);
  s = good;
  memset(s.name, 'x', sizeof s.name);
  assert_int_equal(stic_scene_validate(&s, &err), STIC_BAD_INPUT);
  stic_test_contains(err.message, "name has no end");
  s = good;
  memset(s.surfaces[0].name, 'x', sizeof s.surfaces[0].name);
  assert_int_equal(stic_scene_validate(&s, &err), STIC_BAD_INPUT);
  stic_test_contains(err.message, "has no end");
  s = good;
  s.vertices[2][1] = NAN;
  assert_int_equal(stic_scene_validate(&s, &err), STIC_BAD_INPUT);
  stic_test_contains(err.message, "vertex 2 is (");
  s = good;
  s.hold = (stic_hold)7;
  assert_int_equal(stic_scene_validate(&s, &err), STIC_BAD_INPUT);
  stic_test_contains(err.message, "hold is 7; expected start or button");
}

static void expect_no_sim(const stic_scene *scene, const stic_settings *settings, const char *words)
{
  stic_sim *sim = NULL;
  stic_error err;

  assert_int_equal(stic_sim_create(scene, settings, &sim, &err), STIC_USAGE);
  assert_null(sim);
  stic_test_contains(err.message, words);
}

static void test_sim_settings(void **state)
{
  static const double bad_h_min[] = {0, -1, 1.5, NAN};
  stic_scene s;
  stic_settings settings;

  (void)state;
  stic_scene_init(&s);
  stic_scene_set_box(&s, 0.2, 0.1);
  s.stiffness = 200;
  s.y = 1;
  s.surface_count = 1;
  s.surfaces[0].normal_deg = 90;
  for (size_t i = 0; i < sizeof bad_h_min / sizeof bad_h_min[0]; i++) {
    stic_settings_init(&settings);
    settings.h_min = bad_h_min[i];
    expect_no_sim(&s, &settings, "h_min must be above 0 and at most 1");
  }
  stic_settings_init(&settings);
  settings.level = STIC_LEVEL_SUBSTEP;
  for (int n = 0; n <= 1000001; n += 1000001) {
    settings.substeps = n;
    expect_no_sim(&s, &settings, "substeps must be from 1 to 1000000, not ");
  }
}

static void test_settings(void **state)
{
  static const char *const good[] = {"frame", "event", "substep=1", "substep=1000000"};
  static const char *const bad[] = {
    "",           "Frame",       "substep", "substep=", "substep=0", "substep=1000001",
    "substep=-1", "substep=1.5", "events",  "auto"};
  stic_settings s;
  char text[32];

  (void)state;
  stic_settings_init(&s);
  assert_true(s.level == STIC_LEVEL_EVENT && s.substeps == 8 && s.precision == STIC_F64 && s.h_min == 1e-4);
  for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
    assert_int_equal(stic_settings_set_accuracy(&s, good[i], NULL), STIC_OK);
    stic_settings_accuracy_text(&s, text, sizeof text);
    assert_string_equal(text, good[i]);
  }
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
    assert_int_equal(stic_settings_set_accuracy(&s, bad[i], NULL), STIC_USAGE);
  assert_int_equal(stic_settings_set_precision(&s, "f64", NULL), STIC_OK);
  assert_int_equal(stic_settings_set_precision(&s, "f16", NULL), STIC_USAGE);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_good_scene),      cmocka_unit_test(test_tolerated),
    cmocka_unit_test(test_wrong_scenes),    cmocka_unit_test(test_limits),
    cmocka_unit_test(test_overrides),       cmocka_unit_test(test_override_values),
    cmocka_unit_test(test_all_problems),    cmocka_unit_test(test_normals),
    cmocka_unit_test(test_validate),        cmocka_unit_test(test_settings),
    cmocka_unit_test(test_validate_values), cmocka_unit_test(test_sim_settings),
  };

  return cmocka_run_group_tests(tests, NULL, stic_test_clean_up);
}

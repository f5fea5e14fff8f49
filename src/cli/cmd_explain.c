/* stiction explain: which parts of the model a scene can need, and why. */
#include "../error.h"
#include "../io/json.h"
#include "../io/trace_csv.h"
#include "../needs.h"
#include "../number.h"
#include "cli.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const stic_cli_usage usage = {
  "explain", "[OPTION...] SCENE [TRACE]",
  "Says which surfaces the object can ever reach, which contacts can occur, and what friction and rotation\n"
  "come down to, for a hand that moves as in TRACE, within --workspace, or anywhere. What is said to be\n"
  "impossible is proven; what is said to be possible need not happen.\n",
  1, 2};

typedef struct explain_options {
  char *workspace;
  int json;
  char **set;
} explain_options;

typedef struct explanation {
  stic_scene scene;
  stic_hand_range range;
  stic_needs needs;
  const char *trace;                  /* NULL: none */
  int64_t touches[STIC_SURFACES_MAX]; /* seen in the trace */
  double seconds;
} explanation;

/* ---- hand -------------------------------------------------------------------------------- */

/* "X0,X1,Y0,Y1" */
static stic_status read_workspace(const char *text, explanation *e, stic_error *err)
{
  double v[4], low[2], high[2];
  const char *from = text;

  for (int i = 0; i < 4; i++) {
    const char *comma = strchr(from, ',');
    const size_t length = i < 3 && comma ? (size_t)(comma - from) : strlen(from);

    if ((i < 3 && !comma) || stic_number_parse(from, length, &v[i]) != STIC_NUMBER_OK)
      return stic_error_set(err, STIC_USAGE, NULL, 0, "--workspace %.60s: expected X0,X1,Y0,Y1 in m", text);
    from = comma ? comma + 1 : from;
  }
  if (!(v[0] <= v[1] && v[2] <= v[3]))
    return stic_error_set(err, STIC_USAGE, NULL, 0, "--workspace %.60s: expected X0 <= X1 and Y0 <= Y1",
                          text);
  low[0] = v[0], high[0] = v[1];
  low[1] = v[2], high[1] = v[3];
  stic_hand_range_box(&e->range, &e->scene, low, high);
  return STIC_OK;
}

static void count_touches(explanation *e, const stic_sim *sim)
{
  int count;
  const stic_event *events = stic_sim_events(sim, &count);

  for (int i = 0; i < count; i++)
    if (events[i].kind == STIC_EVENT_TOUCH)
      e->touches[events[i].surface]++;
}

/* The hand's range, and what the object really touches on the way. */
static stic_status read_trace(explanation *e, stic_error *err)
{
  stic_trace_reader *reader = NULL;
  stic_trace_status got = STIC_TRACE_WAIT;
  stic_sim *sim = NULL;
  stic_settings settings;
  stic_sample sample;
  stic_result result;
  int64_t first_ns = 0;
  stic_status status;

  stic_settings_init(&settings);
  status = stic_sim_create(&e->scene, &settings, &sim, err);
  if (status == STIC_OK)
    status = stic_trace_open(e->trace, NULL, &reader, err);
  stic_hand_range_begin(&e->range);
  while (status == STIC_OK && stic_cli_signal() == 0 && got != STIC_TRACE_END) {
    got = stic_trace_next(reader, &sample, err);
    if (got == STIC_TRACE_BAD)
      status = err->status;
    if (got != STIC_TRACE_SAMPLE)
      continue;
    if (e->range.samples == 0)
      first_ns = sample.t_ns;
    stic_hand_range_add(&e->range, &e->scene, &sample);
    stic_sim_step(sim, &sample, &result);
    count_touches(e, sim);
    e->seconds = (double)(sample.t_ns - first_ns) * 1e-9;
  }
  stic_trace_close(reader);
  stic_sim_destroy(sim);
  return status;
}

/* ---- words ------------------------------------------------------------------------------- */

static const char *surface_name(const stic_scene *scene, int s, char *out, size_t out_size)
{
  if (scene->surfaces[s].name[0])
    snprintf(out, out_size, "%.*s", STIC_NAME_MAX - 1, scene->surfaces[s].name);
  else
    snprintf(out, out_size, "surface %d", s);
  return out;
}

#define NAME_SIZE (STIC_NAME_MAX + 16)

static void say_hand(const explanation *e)
{
  const stic_hand_range *r = &e->range;

  if (!r->known)
    printf("Hand: anywhere.\n");
  else if (r->samples == 0)
    printf("Hand: x from %g to %g m, y from %g to %g m, at any angle and speed.\n", r->low[0], r->high[0],
           r->low[1], r->high[1]);
  else
    printf("Hand: as in %s, %lld samples in %.2f s; x from %.3f to %.3f m, y from %.3f to %.3f m.\n",
           e->trace, (long long)r->samples, e->seconds, r->low[0], r->high[0], r->low[1], r->high[1]);
}

static void say_reach(const explanation *e, int s)
{
  const stic_surface_needs *n = &e->needs.surfaces[s];
  char other[NAME_SIZE];

  switch (n->reach) {
  case STIC_REACH_BEHIND:
    printf("never: no part of it is free of %s, wherever the hand goes",
           surface_name(&e->scene, n->behind, other, sizeof other));
    break;
  case STIC_REACH_FAR:
    printf("never: no vertex comes closer than %.3g m%s", n->gap,
           n->at_rest ? " (while no row of the log has the flags 4 or 8)" : "");
    break;
  case STIC_REACH_POSSIBLE: printf("possible"); break;
  }
  if (e->range.samples > 0 && n->reach == STIC_REACH_POSSIBLE)
    printf("; in this trace (level event) %s%lld touch%s",
           e->touches[s] ? "" : "it happens not to be: ", (long long)e->touches[s],
           e->touches[s] == 1 ? "" : "es");
  printf("\n");
}

static void say_surfaces(const explanation *e)
{
  char name[NAME_SIZE];

  printf("\nSurfaces that can be touched: %d of %d.\n", e->needs.reachable, e->scene.surface_count);
  for (int s = 0; s < e->scene.surface_count; s++) {
    printf("  %-16s ", surface_name(&e->scene, s, name, sizeof name));
    say_reach(e, s);
  }
}

static void say_pairs(const explanation *e)
{
  const stic_needs *n = &e->needs;
  char first[NAME_SIZE], second[NAME_SIZE];
  const int listed = n->pair_count < STIC_NEEDS_PAIRS_MAX ? n->pair_count : STIC_NEEDS_PAIRS_MAX;

  for (int i = 0; i < listed && i < 12; i++) {
    const stic_pair_needs *p = &n->pairs[i];

    printf("    %s and %s: %s%s%s\n", surface_name(&e->scene, p->first, first, sizeof first),
           surface_name(&e->scene, p->second, second, sizeof second), p->slot ? "a slot" : "two vertices",
           p->corner ? ", one vertex in their corner" : "",
           p->wedging ? "; their friction cones can face each other: wedging"
                      : "; friction too low to wedge");
  }
  if (n->pair_count > 12)
    printf("    and %d pairs more\n", n->pair_count - 12);
}

static void say_contacts(const explanation *e)
{
  const stic_needs *n = &e->needs;

  printf("\nContact sets that can occur: free%s%s%s%s%s.\n", n->vertex ? ", vertex" : "",
         n->edge ? ", edge" : "", n->two_vertex ? ", two-vertex" : "", n->corner ? ", corner" : "",
         n->multi ? ", multi" : "");
  if (n->reachable == 0)
    printf("  Nothing can be touched: the object follows the hand.\n");
  else if (n->pair_count == 0)
    printf("  No two of the surfaces are within the object's size (%.3g m) of each other: one at a time.\n",
           n->size);
  else
    say_pairs(e);
  if (n->reachable > 0)
    printf("  Wedging (the contacts hold whatever the hand does): %s.\n",
           n->wedging ? "possible" : "impossible, no friction cones can face each other");
}

static void say_friction(const explanation *e)
{
  const stic_needs *n = &e->needs;

  if (n->reachable == 0)
    printf("\nFriction: plays no part.\n");
  else if (n->frictionless)
    printf("\nFriction: none; contacts slide freely, nothing sticks or jumps.\n");
  else if (n->jumpless)
    printf("\nFriction: static equals dynamic on all of them; contacts slide on without jumps.\n");
  else
    printf("\nFriction: static is above dynamic; contacts stick and slip by jumps.\n");
}

static void say_rotation(const explanation *e)
{
  const stic_needs *n = &e->needs;

  if (n->fixed_angle)
    printf("Rotation: the object keeps its angle, as the hand exerts no moment and nothing can turn it.\n");
  else if (n->free_rotation)
    printf("Rotation: free; the hand exerts no moment, only contacts turn the object.\n");
  else if (n->reachable == 0)
    printf("Rotation: the object has the hand's angle.\n");
  else
    printf("Rotation: drawn to the hand's angle by %g N m/rad; contacts can turn it away.\n",
           e->scene.rotational_stiffness);
}

/* What a simulation of this scene does without; the rest of what is impossible costs nothing (sim.h). */
static void say_left_out(const explanation *e)
{
  printf("Left out when solving: ");
  if (e->needs.behind > 0)
    printf("%d surface%s behind others (not with f32), and ", e->needs.behind,
           e->needs.behind == 1 ? "" : "s");
  printf("a broad phase: %d vertices x %d surfaces are %d gaps, quicker computed than sorted out.\n",
         e->scene.vertex_count, e->scene.surface_count - e->needs.behind,
         e->scene.vertex_count * (e->scene.surface_count - e->needs.behind));
}

static void say_all(const explanation *e)
{
  char title[NAME_SIZE] = "";

  if (e->scene.name[0])
    snprintf(title, sizeof title, "%.*s: ", STIC_NAME_MAX - 1, e->scene.name);
  printf("%san object of %d vertices, %.3g m large, held by %g N/m and %g N m/rad.\n", title,
         e->scene.vertex_count, e->needs.size, e->scene.stiffness, e->scene.rotational_stiffness);
  say_hand(e);
  say_surfaces(e);
  say_contacts(e);
  say_friction(e);
  say_rotation(e);
  say_left_out(e);
}

/* ---- JSON -------------------------------------------------------------------------------- */

static json_t *surfaces_json(const explanation *e)
{
  static const char *const reaches[] = {"possible", "behind", "far"};
  json_t *list = json_array();

  for (int s = 0; s < e->scene.surface_count; s++) {
    const stic_surface_needs *n = &e->needs.surfaces[s];
    json_t *item = json_pack("{s:i, s:s, s:b, s:s}", "index", s, "name", e->scene.surfaces[s].name,
                             "reachable", n->reach == STIC_REACH_POSSIBLE, "reach", reaches[n->reach]);

    if (n->reach == STIC_REACH_BEHIND)
      item = stic_json_set(item, "behind", json_integer(n->behind));
    if (n->reach == STIC_REACH_FAR) {
      item = stic_json_set(item, "least_gap", json_real(n->gap));
      item = stic_json_set(item, "only_unflagged", json_boolean(n->at_rest));
    }
    if (e->range.samples > 0)
      item = stic_json_set(item, "touches", json_integer(e->touches[s]));
    list = stic_json_append(list, item);
  }
  return list;
}

static json_t *pairs_json(const stic_needs *n)
{
  json_t *list = json_array();

  for (int i = 0; i < n->pair_count && i < STIC_NEEDS_PAIRS_MAX; i++) {
    const stic_pair_needs *p = &n->pairs[i];

    list = stic_json_append(list, json_pack("{s:i, s:i, s:b, s:b, s:b, s:b}", "first", p->first, "second",
                                            p->second, "two_vertex", p->two_vertex, "corner", p->corner,
                                            "slot", p->slot, "wedging", p->wedging));
  }
  return list;
}

static json_t *contacts_json(const stic_needs *n)
{
  const struct {
    bool can;
    const char *name;
  } sets[] = {{true, "free"},        {n->vertex, "vertex"}, {n->edge, "edge"}, {n->two_vertex, "two-vertex"},
              {n->corner, "corner"}, {n->multi, "multi"}};
  json_t *list = json_array();

  for (size_t i = 0; i < sizeof sets / sizeof sets[0]; i++)
    if (sets[i].can)
      list = stic_json_append(list, json_string(sets[i].name));
  return list;
}

static int print_json(const explanation *e)
{
  static const char *const frictions[] = {"jumps", "no-jumps", "none"};
  const stic_needs *n = &e->needs;
  const char *hand = !e->range.known ? "anywhere" : e->range.samples > 0 ? "trace" : "workspace";
  json_t *root = json_pack("{s:s, s:i, s:i, s:o, s:o, s:i, s:o, s:b, s:s, s:s, s:i}", "hand", hand,
                           "vertices", e->scene.vertex_count, "reachable", n->reachable, "surfaces",
                           surfaces_json(e), "contact_sets", contacts_json(n), "pair_count", n->pair_count,
                           "pairs", pairs_json(n), "wedging", n->wedging, "friction",
                           frictions[n->frictionless ? 2
                                     : n->jumpless   ? 1
                                                     : 0],
                           "rotation",
                           n->fixed_angle     ? "fixed"
                           : n->free_rotation ? "free"
                                              : "spring",
                           "left_out", n->behind);
  const int failed = !root || json_dumpf(root, stdout, JSON_INDENT(2)) != 0;

  json_decref(root);
  if (!root) {
    stic_cli_say("out of memory");
    return STIC_NO_MEMORY;
  }
  if (!failed)
    putchar('\n');
  return STIC_OK;
}

/* ------------------------------------------------------------------------------------------ */

static stic_status prepare(explanation *e, const stic_cli_args *args, const explain_options *o,
                           stic_error *err)
{
  stic_override *overrides = NULL;
  int count = 0;
  stic_status status = stic_cli_overrides(o->set, &overrides, &count, err);

  if (status == STIC_OK)
    status = stic_scene_read(args->positions[0], overrides, count, &e->scene, err);
  free(overrides);
  if (status != STIC_OK)
    return status;
  stic_hand_range_anywhere(&e->range);
  if (args->position_count > 1) {
    e->trace = args->positions[1];
    status = read_trace(e, err);
  } else if (o->workspace) {
    status = read_workspace(o->workspace, e, err);
  }
  if (status == STIC_OK)
    stic_needs_find(&e->scene, &e->range, &e->needs);
  return status;
}

static int explain(const stic_cli_args *args, const explain_options *o)
{
  explanation *e = calloc(1, sizeof *e);
  stic_error err;
  int code;

  if (!e) {
    stic_error_set(&err, STIC_NO_MEMORY, NULL, 0, "out of memory");
    return stic_cli_fail(&err);
  }
  if (args->position_count > 1 && o->workspace) {
    stic_cli_say("explain: --workspace and TRACE both say where the hand goes; expected one of them");
    code = STIC_USAGE;
  } else if (prepare(e, args, o, &err) != STIC_OK) {
    code = stic_cli_fail(&err);
  } else if (stic_cli_signal() != 0) {
    code = STIC_EXIT_SIGNAL + stic_cli_signal();
  } else if (o->json) {
    code = print_json(e);
  } else {
    say_all(e);
    code = STIC_OK;
  }
  free(e);
  return code;
}

int stic_cmd_explain(int argc, const char **argv)
{
  explain_options o = {NULL, 0, NULL};
  const struct poptOption table[] = {
    {"workspace", '\0', POPT_ARG_STRING, &o.workspace, 0, "The hand stays within this box (m)",
     "X0,X1,Y0,Y1"},
    {"json", '\0', POPT_ARG_NONE, &o.json, 0, "As JSON", NULL},
    {"set", '\0', POPT_ARG_ARGV, &o.set, 0, "Override a value of the scene; repeatable", "KEY=VALUE"},
    POPT_TABLEEND};
  stic_cli_args args;
  int code = stic_cli_parse(&usage, table, argc, argv, &args);

  if (code < 0)
    code = explain(&args, &o);
  stic_cli_args_free(&args);
  free(o.workspace);
  stic_cli_free_list(o.set);
  return code;
}

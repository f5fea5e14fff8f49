/* check_traces FOLDER [HAND.CSV]: replays a trace of traces/ and checks that it shows what its README
 * says, and that the log is the expected one. */
#include "golden.h"

#include "../../src/angle.h"
#include "../../src/io/log_csv.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define KEPT 4 /* contacts */

/* A row without the contacts that no trace here has. */
typedef struct row {
  stic_result head; /* not: contacts */
  stic_contact contacts[KEPT];
} row;

typedef struct check {
  stic_scene scene;
  stic_settings settings;
  stic_golden_trace trace;
  row *rows;
  size_t count;
  stic_event *events;
  size_t event_count;
  int failures;
} check;

static void fail(check *c, const char *format, ...)
#if defined(__GNUC__)
  __attribute__((format(printf, 2, 3)))
#endif
  ;

static void fail(check *c, const char *format, ...)
{
  va_list args;

  if (c->failures++ >= 20)
    return;
  printf("FAILED: ");
  va_start(args, format);
  vprintf(format, args);
  va_end(args);
  printf("\n");
}

#define EXPECT(c, claim, ...) ((claim) ? (void)0 : fail(c, __VA_ARGS__))

static double seconds(const row *r)
{
  return (double)r->head.t_ns * 1e-9;
}

static const char *state_of(const row *r)
{
  return stic_state_name(r->head.state);
}

static bool slipped(const row *r)
{
  return (r->head.flags & STIC_FLAG_SLIPPED) != 0;
}

static const row *last(const check *c)
{
  return &c->rows[c->count - 1];
}

/* ---- replaying --------------------------------------------------------------------------- */

static void *grow(void *data, size_t count, size_t size)
{
  void *grown = (count & (count - 1)) != 0 ? data : realloc(data, (count ? 2 * count : 1) * size);

  if (!grown) {
    fprintf(stderr, "out of memory\n");
    exit(STIC_NO_MEMORY);
  }
  return grown;
}

/* Copies all but the long array at the end of a result. */
static void keep(row *r, const stic_result *result)
{
  memset(r, 0, sizeof *r);
  memcpy(&r->head, result, offsetof(stic_result, contacts));
  for (int i = 0; i < result->contact_count && i < KEPT; i++)
    r->contacts[i] = result->contacts[i];
}

static void on_row(void *user, const stic_result *result, const stic_event *events, int event_count)
{
  check *c = user;

  c->rows = grow(c->rows, c->count, sizeof *c->rows);
  keep(&c->rows[c->count++], result);
  for (int i = 0; i < event_count; i++) {
    c->events = grow(c->events, c->event_count, sizeof *c->events);
    c->events[c->event_count++] = events[i];
  }
}

static void stop_on(stic_status status, const stic_error *err)
{
  char text[900];

  if (status == STIC_OK)
    return;
  stic_error_format(err, text, sizeof text);
  fprintf(stderr, "check_traces: %s\n", text);
  exit((int)status);
}

/* ---- what holds for every trace ---------------------------------------------------------- */

static double mu_static(const check *c, const stic_contact *at)
{
  return c->scene.surfaces[at->surface].friction.mu_static;
}

static void check_forces(check *c, const row *r)
{
  EXPECT(c, (r->head.flags & (STIC_FLAG_NO_ANSWER | STIC_FLAG_LIMIT | STIC_FLAG_LOST)) == 0,
         "t %.3f: flags %u", seconds(r), r->head.flags);
  EXPECT(c, r->head.residual <= 1e-12, "t %.3f: residual %g", seconds(r), r->head.residual);
  EXPECT(c, r->head.contact_count <= KEPT, "t %.3f: %d contacts", seconds(r), r->head.contact_count);
  for (int i = 0; i < r->head.contact_count && i < KEPT; i++) {
    const stic_contact *at = &r->contacts[i];

    EXPECT(c, at->normal >= 0 && fabs(at->friction) <= mu_static(c, at) * at->normal * (1 + 1e-12) + 1e-12,
           "t %.3f: vertex %d on surface %d has N %g, T %g", seconds(r), at->vertex, at->surface, at->normal,
           at->friction);
  }
}

static void check_depth(check *c, const row *r)
{
  const double co = cos(r->head.theta), si = sin(r->head.theta);

  for (int i = 0; i < c->scene.vertex_count; i++) {
    const double *v = c->scene.vertices[i];
    const double x = r->head.x + co * v[0] - si * v[1], y = r->head.y + si * v[0] + co * v[1];

    for (int j = 0; j < c->scene.surface_count; j++) {
      const stic_surface *s = &c->scene.surfaces[j];
      double n[2];

      stic_normal_from_degrees(s->normal_deg, n);
      EXPECT(c, (x - s->point[0]) * n[0] + (y - s->point[1]) * n[1] >= -1e-13,
             "t %.3f: vertex %d is below surface %d", seconds(r), i, j);
    }
  }
}

/* A contact without an event is where it was, bit for bit. */
static void check_stuck(check *c, const row *before, const row *r)
{
  if (slipped(r))
    return;
  for (int i = 0; i < r->head.contact_count && i < KEPT; i++) {
    const stic_contact *at = &r->contacts[i];

    for (int j = 0; j < before->head.contact_count && j < KEPT; j++) {
      const stic_contact *was = &before->contacts[j];

      if (was->vertex != at->vertex || was->surface != at->surface || (was->x == at->x && was->y == at->y))
        continue;
      for (size_t k = 0; k < c->event_count; k++) {
        const stic_event *e = &c->events[k];

        if (e->kind == STIC_EVENT_OPEN && e->vertex == at->vertex && e->t > seconds(before) - 1e-9 &&
            e->t < seconds(r) + 1e-9)
          goto opened;
      }
      fail(c, "t %.3f: vertex %d creeps on surface %d", seconds(r), at->vertex, at->surface);
    opened:;
    }
  }
}

static void check_every_row(check *c)
{
  for (size_t i = 0; i < c->count; i++) {
    check_forces(c, &c->rows[i]);
    check_depth(c, &c->rows[i]);
    if (i > 0)
      check_stuck(c, &c->rows[i - 1], &c->rows[i]);
  }
}

/* ---- around a slip ----------------------------------------------------------------------- */

static double hand_angle(const stic_sample *s)
{
  return 2 * atan2(s->orientation[2], s->orientation[3]);
}

/* The hand at `t_ns` between samples k and k + 1: straight in place, the shortest arc in angle. */
static stic_sample between(const stic_golden_trace *trace, size_t k, int64_t t_ns)
{
  const stic_sample *a = &trace->samples[k], *b = a + 1;
  const double part = (double)(t_ns - a->t_ns) / (double)(b->t_ns - a->t_ns);
  const double turn = remainder(hand_angle(b) - hand_angle(a), 360 * STIC_RAD_PER_DEG);
  const double angle = hand_angle(a) + part * turn;
  stic_sample s = *a;

  s.t_ns = t_ns;
  for (int i = 0; i < 3; i++)
    s.position[i] += part * (b->position[i] - a->position[i]);
  s.orientation[2] = sin(angle / 2);
  s.orientation[3] = cos(angle / 2);
  return s;
}

static void add_sample(stic_golden_trace *trace, const stic_sample *s)
{
  if (trace->count > 0 && s->t_ns <= trace->samples[trace->count - 1].t_ns)
    return;
  trace->samples = grow(trace->samples, trace->count, sizeof *trace->samples);
  trace->samples[trace->count++] = *s;
}

/* Friction over normal force of all contacts with a surface, and the normal force. */
static double friction_ratio(const row *r, int surface, double *normal)
{
  double friction = 0;

  *normal = 0;
  for (int i = 0; i < r->head.contact_count && i < KEPT; i++) {
    if (r->contacts[i].surface == surface) {
      *normal += r->contacts[i].normal;
      friction += r->contacts[i].friction;
    }
  }
  return friction / *normal;
}

enum { CLOSE_NS = 2 };

/* The rows just before and just after the moment `t_ns`: the hand is asked there too, and no further.
 * Asking everywhere at once would shift later slips: after an event the next judgement comes sooner. */
static bool rows_around(const check *c, int64_t t_ns, row *before, row *after)
{
  check around = {.scene = c->scene, .settings = c->settings, .trace = {NULL, 0}};
  char hash[STIC_SHA256_TEXT];
  stic_error err;
  stic_sample s;
  size_t k = 0;
  bool inside;

  while (k + 1 < c->trace.count && c->trace.samples[k + 1].t_ns <= t_ns)
    k++;
  inside = k + 1 < c->trace.count && t_ns - CLOSE_NS > c->trace.samples[k].t_ns &&
           t_ns + CLOSE_NS < c->trace.samples[k + 1].t_ns;
  if (inside) {
    for (size_t i = 0; i <= k; i++)
      add_sample(&around.trace, &c->trace.samples[i]);
    s = between(&c->trace, k, t_ns - CLOSE_NS);
    add_sample(&around.trace, &s);
    s = between(&c->trace, k, t_ns + CLOSE_NS);
    add_sample(&around.trace, &s);
    stop_on(stic_golden_replay(&around.scene, &around.settings, &around.trace, on_row, &around, hash, &err),
            &err);
    *before = around.rows[around.count - 2];
    *after = around.rows[around.count - 1];
  }
  free(around.rows);
  free(around.events);
  free(around.trace.samples);
  return inside;
}

/* Slips in `state` on `surface` alone: |T| is mu_s N just before and mu_d N just after, with the same
 * sign. `least`: slips under a smaller normal force (while touching and lifting off) are left out.
 * Returns how many. */
static int check_slip_forces(check *c, stic_state state, int surface, double least)
{
  const stic_friction friction = c->scene.surfaces[surface].friction;
  int64_t last_ns = -1;
  int slips = 0;

  for (size_t i = 0; i < c->event_count; i++) {
    const stic_event *e = &c->events[i];
    const int64_t t_ns = (int64_t)(e->t * 1e9 + 0.5);
    row before = c->rows[0], after = before;
    double n0, n1, t0, t1;

    if (e->kind != STIC_EVENT_SLIP || e->surface != surface || t_ns == last_ns ||
        !rows_around(c, t_ns, &before, &after) || before.head.state != state || after.head.state != state)
      continue;
    last_ns = t_ns;
    t0 = friction_ratio(&before, surface, &n0);
    t1 = friction_ratio(&after, surface, &n1);
    if (n0 < least || n1 < least)
      continue;
    slips++;
    EXPECT(c, after.head.slips == before.head.slips + 1, "t %.9f: the slip is not there", e->t);
    EXPECT(c, fabs(fabs(t0) - friction.mu_static) < 1e-6, "t %.9f: T/N is %.9f just before a slip", e->t, t0);
    EXPECT(c, fabs(fabs(t1) - friction.mu_dynamic) < 1e-6, "t %.9f: T/N is %.9f just after a slip", e->t, t1);
    EXPECT(c, t0 * t1 > 0, "t %.9f: friction changes its sign in a slip", e->t);
  }
  printf("%d slips in state %s looked at closely: T falls from %g N to %g N\n", slips, stic_state_name(state),
         friction.mu_static, friction.mu_dynamic);
  return slips;
}

/* ---- states ------------------------------------------------------------------------------ */

/* Compares the sequence of states, each named once, visits of fewer than `least` rows left out. */
static void check_sequence(check *c, const char *expected, size_t least)
{
  char text[400] = "";

  for (size_t i = 0, j; i < c->count; i = j) {
    const char *const name = state_of(&c->rows[i]);
    const size_t length = strlen(text), named = strlen(name);

    for (j = i; j < c->count && c->rows[j].head.state == c->rows[i].head.state;)
      j++;
    if (j - i < least || length + named + 2 >= sizeof text)
      continue;
    if (length >= named && strcmp(text + length - named, name) == 0 &&
        (length == named || text[length - named - 1] == ' '))
      continue;
    snprintf(text + length, sizeof text - length, "%s%s", length ? " " : "", name);
  }
  EXPECT(c, strcmp(text, expected) == 0, "states are '%s', expected '%s'", text, expected);
}

static size_t count_rows(const check *c, stic_state state)
{
  size_t n = 0;

  for (size_t i = 0; i < c->count; i++)
    n += c->rows[i].head.state == state;
  return n;
}

/* Turns of at least half a degree within a row in which contacts slid, in `state` before and after.
 * In all other rows of that state the angle stays. `direction`: +1 counter-clockwise. */
static int count_angle_jumps(check *c, stic_state state, int direction)
{
  int jumps = 0;

  for (size_t i = 1; i < c->count; i++) {
    const row *a = &c->rows[i - 1], *b = &c->rows[i];
    const double turn = b->head.theta - a->head.theta;

    if (a->head.state != state || b->head.state != state)
      continue;
    if (!slipped(b))
      EXPECT(c, fabs(turn) < 1e-12, "t %.3f: turns by %g without a slip", seconds(b), turn);
    else if (direction * turn > 0.5 * STIC_RAD_PER_DEG)
      jumps++;
  }
  return jumps;
}

/* ---- the traces -------------------------------------------------------------------------- */

static void check_single_vertex(check *c)
{
  double first = 0, final = 0;

  check_sequence(c, "free vertex free", 1);
  EXPECT(c, check_slip_forces(c, STIC_VERTEX, 0, 1.0) >= 8, "too few slips");
  for (size_t i = 0; i < c->count; i++) {
    if (c->rows[i].head.state == STIC_VERTEX) {
      EXPECT(c, c->rows[i].contacts[0].vertex == 0, "t %.3f: another vertex", seconds(&c->rows[i]));
      final = c->rows[i].contacts[0].x;
      if (first == 0)
        first = final;
    }
  }
  EXPECT(c, final - first > 0.1, "dragged by %g m only", final - first);
}

static void check_two_vertex(check *c)
{
  const int up = count_angle_jumps(c, STIC_TWO_VERTEX, 1), down = count_angle_jumps(c, STIC_TWO_VERTEX, -1);

  check_sequence(c, "free vertex two-vertex vertex free", 1);
  printf("%d jumps of the angle counter-clockwise, %d clockwise\n", up, down);
  EXPECT(c, up >= 5, "%d jumps of the angle", up);
  EXPECT(c, down >= 1, "no jump back");
}

static void check_edge_about_to_slip(check *c)
{
  const double mu = c->scene.surfaces[0].friction.mu_static;
  const row *end = last(c);
  double normal, part;

  EXPECT(c, end->head.state == STIC_EDGE, "ends in state %s", state_of(end));
  part = friction_ratio(end, 0, &normal) / mu;
  printf("in the last row T is %.4f of mu_s N, N is %.3f N\n", part, normal);
  EXPECT(c, part >= 0.95 && part <= 1, "T is %g of mu_s N", part);
  EXPECT(c, end->head.force_x < 0, "the hand does not pull left");
  EXPECT(c, check_slip_forces(c, STIC_EDGE, 0, 1.0) >= 3, "too few slips");

  { /* a millimetre more and it slips, to the left */
    stic_golden_trace more = {NULL, 0};
    check next = {.scene = c->scene, .settings = c->settings};
    char hash[STIC_SHA256_TEXT];
    stic_error err;
    stic_sample s = c->trace.samples[c->trace.count - 1];

    for (size_t i = 0; i < c->trace.count; i++)
      add_sample(&more, &c->trace.samples[i]);
    s.t_ns += 32000000;
    s.position[0] -= 0.001;
    add_sample(&more, &s);
    stop_on(stic_golden_replay(&next.scene, &next.settings, &more, on_row, &next, hash, &err), &err);
    EXPECT(c, slipped(last(&next)) && last(&next)->head.x < end->head.x - 1e-3,
           "it was not about to slip left");
    free(next.rows);
    free(next.events);
    free(more.samples);
  }
}

static void check_ccw_turn(check *c)
{
  const int jumps = count_angle_jumps(c, STIC_TWO_VERTEX, 1);
  double first = 0;

  check_sequence(c, "free vertex two-vertex", 1);
  for (size_t i = 1; i < c->count; i++) {
    if (c->rows[i - 1].head.state != STIC_TWO_VERTEX)
      first = c->rows[i].head.theta;
    else
      EXPECT(c, c->rows[i].head.theta > c->rows[i - 1].head.theta - 1e-12, "t %.3f: turns clockwise",
             seconds(&c->rows[i]));
  }
  printf("%d jumps, %.1f degrees in all\n", jumps, (last(c)->head.theta - first) / STIC_RAD_PER_DEG);
  EXPECT(c, jumps >= 5 && last(c)->head.theta - first > 25 * STIC_RAD_PER_DEG, "it does not turn far enough");
}

static bool same_pose(const row *a, const row *b)
{
  return a->head.x == b->head.x && a->head.y == b->head.y && a->head.theta == b->head.theta;
}

static void check_carry(check *c)
{
  int takes = 0, releases = 0;
  double highest = 0;

  for (size_t i = 0; i < c->event_count; i++) {
    takes += c->events[i].kind == STIC_EVENT_TAKE;
    releases += c->events[i].kind == STIC_EVENT_RELEASE;
  }
  EXPECT(c, takes == 2 && releases == 2, "%d takes, %d releases", takes, releases);
  for (size_t i = 1; i < c->count; i++) {
    const row *a = &c->rows[i - 1], *b = &c->rows[i];

    highest = fmax(highest, b->head.y);
    if (a->head.state == STIC_RELEASED)
      EXPECT(c, same_pose(a, b), "t %.3f: moves before or as it is taken", seconds(b));
    if (b->head.state == STIC_RELEASED)
      EXPECT(c, same_pose(a, b) && b->head.force_x == 0, "t %.3f: moves when it is let go", seconds(b));
  }
  EXPECT(c, highest > 0.1, "not lifted");
  EXPECT(c, fabs(last(c)->head.theta - 90 * STIC_RAD_PER_DEG) < 1e-12 && last(c)->head.state == STIC_RELEASED,
         "does not stand");
}

static void check_push_to_wall(check *c)
{
  check_sequence(c, "free edge multi edge multi edge", 2);
  for (size_t i = 0; i < c->count; i++) {
    const row *r = &c->rows[i];

    if (r->head.state == STIC_MULTI)
      EXPECT(c,
             fabs(r->head.x - 0.08) < 1e-12 && fabs(r->head.y - 0.04) < 1e-12 && fabs(r->head.theta) < 1e-12,
             "t %.3f: not flush in the corner", seconds(r));
  }
  EXPECT(c, check_slip_forces(c, STIC_EDGE, 0, 1.0) >= 20, "too few slips on the floor");
  EXPECT(c, last(c)->head.x > 0.15, "not pulled away");
}

static void check_corner(check *c)
{
  double least = 1e9, most = -1e9;

  check_sequence(c, "free vertex corner vertex edge vertex free", 8);
  for (size_t i = 0; i < c->count; i++) {
    const row *r = &c->rows[i];

    if (r->head.state != STIC_CORNER)
      continue;
    least = fmin(least, r->head.theta);
    most = fmax(most, r->head.theta);
    for (int k = 0; k < 2; k++)
      EXPECT(c, r->contacts[k].vertex == 0 && hypot(r->contacts[k].x, r->contacts[k].y) < 1e-13,
             "t %.3f: vertex %d is not in the corner", seconds(r), r->contacts[k].vertex);
  }
  printf("rocks by %.1f degrees in the corner\n", (most - least) / STIC_RAD_PER_DEG);
  EXPECT(c, most - least > 20 * STIC_RAD_PER_DEG, "rocks too little");
}

static void check_wedge(check *c)
{
  double force = 0;
  size_t i = 0;

  check_sequence(c, "free vertex two-vertex", 1);
  while (i < c->count && !(c->rows[i].head.flags & STIC_FLAG_WEDGED))
    i++;
  EXPECT(c, i < c->count && seconds(last(c)) - seconds(&c->rows[i]) > 5, "not wedged for long");
  for (size_t k = i; k < c->count; k++) {
    const row *r = &c->rows[k];

    EXPECT(c, (r->head.flags & STIC_FLAG_WEDGED) && same_pose(r, &c->rows[i]), "t %.3f: comes loose",
           seconds(r));
    force = fmax(force, hypot(r->head.force_x, r->head.force_y));
  }
  printf("held against %.1f N\n", force);
  EXPECT(c, force > 10, "pulled too weakly");
}

static void check_slot(check *c)
{
  double highest = -1e9, lowest = 1e9;
  int slips = 0;

  check_sequence(c, "free vertex two-vertex vertex free", 1);
  for (size_t i = 0; i < c->count; i++) {
    const row *r = &c->rows[i];

    if (r->head.state != STIC_TWO_VERTEX)
      continue;
    slips += slipped(r);
    highest = fmax(highest, r->head.y);
    lowest = fmin(lowest, r->head.y);
    EXPECT(c, r->contacts[0].surface != r->contacts[1].surface, "t %.3f: both on one wall", seconds(r));
  }
  printf("%d rows with slips over %.3f m\n", slips, highest - lowest);
  EXPECT(c, slips >= 20 && highest - lowest > 0.1, "moves too little");
}

static void check_slope(check *c)
{
  check_sequence(c, "free edge multi two-vertex edge free", 4);
  EXPECT(c, check_slip_forces(c, STIC_EDGE, 0, 1.0) + check_slip_forces(c, STIC_EDGE, 1, 0.5) >= 20,
         "too few slips");
  for (size_t i = 0; i < c->count; i++) {
    const row *r = &c->rows[i];

    if (r->head.state == STIC_EDGE && r->contacts[0].surface == 1)
      EXPECT(c, fabs(r->head.theta - 25 * STIC_RAD_PER_DEG) < 1e-12, "t %.3f: not flat on the slope",
             seconds(r));
  }
}

static void check_hexagon(check *c)
{
  unsigned touched = 0;
  int tips = 0;

  for (size_t i = 1; i < c->count; i++) {
    const row *r = &c->rows[i];

    for (int k = 0; k < r->head.contact_count && k < KEPT; k++)
      touched |= 1u << r->contacts[k].vertex;
    tips += r->head.state == STIC_VERTEX && c->rows[i - 1].head.state == STIC_EDGE;
  }
  printf("tips over %d times, %.1f degrees in all\n", tips, last(c)->head.theta / STIC_RAD_PER_DEG);
  EXPECT(c, touched == 0x3f, "only some vertices touch: %x", touched);
  EXPECT(c, tips >= 7 && last(c)->head.theta < -410 * STIC_RAD_PER_DEG, "does not roll once round");
}

static void check_slow_hour(check *c)
{
  EXPECT(c, c->count == 3600 * 31, "%zu rows", c->count);
  EXPECT(c, last(c)->head.slips > 1000, "%lld slips", (long long)last(c)->head.slips);
  for (stic_state state = STIC_FREE; state <= STIC_MULTI; state++) {
    if (state != STIC_CORNER)
      EXPECT(c, count_rows(c, state) > 1000, "hardly ever in state %s", stic_state_name(state));
  }
  EXPECT(c, last(c)->head.state == STIC_FREE, "ends in state %s", state_of(last(c)));
}

static const struct {
  const char *name;
  void (*claims)(check *c);
} traces[] = {
  {"single-vertex", check_single_vertex},
  {"two-vertex", check_two_vertex},
  {"edge-about-to-slip", check_edge_about_to_slip},
  {"ccw-turn", check_ccw_turn},
  {"carry", check_carry},
  {"push-to-wall", check_push_to_wall},
  {"corner", check_corner},
  {"wedge", check_wedge},
  {"slot", check_slot},
  {"slope", check_slope},
  {"hexagon", check_hexagon},
  {"slow-hour", check_slow_hour},
};

/* ---- the log ----------------------------------------------------------------------------- */

static bool close_to(double a, double b)
{
  return fabs(a - b) <= 1e-10 * fmax(1, fabs(b));
}

static bool close_rows(const row *a, const row *b)
{
  const double have[] = {a->head.x,       a->head.y,       a->head.z,      a->head.theta,
                         a->head.hand_x,  a->head.hand_y,  a->head.hand_z, a->head.hand_theta,
                         a->head.force_x, a->head.force_y, a->head.moment};
  const double want[] = {b->head.x,       b->head.y,       b->head.z,      b->head.theta,
                         b->head.hand_x,  b->head.hand_y,  b->head.hand_z, b->head.hand_theta,
                         b->head.force_x, b->head.force_y, b->head.moment};

  if (a->head.state != b->head.state || a->head.slips != b->head.slips || a->head.flags != b->head.flags ||
      a->head.contact_count != b->head.contact_count)
    return false;
  for (size_t i = 0; i < sizeof have / sizeof *have; i++) {
    if (!close_to(have[i], want[i]))
      return false;
  }
  for (int i = 0; i < a->head.contact_count && i < KEPT; i++) {
    const stic_contact *p = &a->contacts[i], *q = &b->contacts[i];

    if (p->vertex != q->vertex || p->surface != q->surface || !close_to(p->x, q->x) ||
        !close_to(p->y, q->y) || !close_to(p->normal, q->normal) || !close_to(p->friction, q->friction))
      return false;
  }
  return true;
}

static void check_reference(check *c, const char *path)
{
  stic_log_reader *reader;
  stic_error err;
  stic_result result;
  bool more;
  size_t i = 0, compared = 0;

  stop_on(stic_log_open(path, &reader, &err), &err);
  for (;;) {
    row wanted;

    stop_on(stic_log_next(reader, &result, &more, &err), &err);
    if (!more)
      break;
    keep(&wanted, &result);
    while (i < c->count && c->rows[i].head.t_ns < result.t_ns)
      i++;
    EXPECT(c, i < c->count && c->rows[i].head.t_ns == result.t_ns && close_rows(&c->rows[i], &wanted),
           "t %.3f: differs from %s", seconds(&wanted), path);
    compared++;
  }
  stic_log_close(reader);
  printf("%zu rows compared with the reference log, to 1e-10\n", compared);
  EXPECT(c, compared >= 20, "the reference log is too short");
}

static void check_hash(check *c, const char *path, const char *hash)
{
  stic_golden_expected expected, here;
  stic_error err;

  stop_on(stic_golden_read_expected(path, &expected, &err), &err);
  stic_golden_here(&here);
  if (strcmp(expected.arithmetic, here.arithmetic) != 0) {
    printf("the hash is not compared: it was made on\n  %s\nand here, on\n  %s\n"
           "the C library's functions return other last bits; the reference log decides\n",
           expected.made_on, here.made_on);
    return;
  }
  EXPECT(c, strcmp(expected.log, hash) == 0, "the log's hash is %s, expected %s", hash, expected.log);
  printf("hash %s\n", hash);
}

/* One bit of one number of the hand must be seen. */
static void check_control(check *c, const char *hash)
{
  double *const number = &c->trace.samples[c->trace.count / 2].position[0];
  const double kept = *number;
  uint64_t bits;
  char changed[STIC_SHA256_TEXT];
  stic_error err;

  memcpy(&bits, number, sizeof bits);
  bits ^= 1;
  memcpy(number, &bits, sizeof bits);
  stop_on(stic_golden_replay(&c->scene, &c->settings, &c->trace, NULL, NULL, changed, &err), &err);
  EXPECT(c, strcmp(changed, hash) != 0, "one changed bit of the trace is not seen in the hash");
  *number = kept;
  stop_on(stic_golden_replay(&c->scene, &c->settings, &c->trace, NULL, NULL, changed, &err), &err);
  EXPECT(c, strcmp(changed, hash) == 0, "a second replay gives another hash");
}

static void check_sha256(check *c)
{
  char text[STIC_SHA256_TEXT];
  stic_sha256 hash;

  stic_sha256_begin(&hash);
  stic_sha256_add(&hash, "abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq", 56);
  stic_sha256_end(&hash, text);
  EXPECT(c, strcmp(text, "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1") == 0,
         "sha256 is wrong");
}

int main(int argc, char **argv)
{
  static check c;
  char path[1024], hash[STIC_SHA256_TEXT];
  const char *name;
  stic_error err;

  setvbuf(stdout, NULL, _IOLBF, 0);
  if (argc < 2 || argc > 3) {
    fprintf(stderr, "usage: check_traces FOLDER [HAND.CSV]\n");
    return STIC_USAGE;
  }
  name = strrchr(argv[1], '/') ? strrchr(argv[1], '/') + 1 : argv[1];
  stic_settings_init(&c.settings);
  snprintf(path, sizeof path, "%s/scene.yaml", argv[1]);
  stop_on(stic_scene_read(path, NULL, 0, &c.scene, &err), &err);
  snprintf(path, sizeof path, "%s/hand.csv", argv[1]);
  stop_on(stic_golden_read_trace(argc == 3 ? argv[2] : path, &c.trace, &err), &err);
  stop_on(stic_golden_replay(&c.scene, &c.settings, &c.trace, on_row, &c, hash, &err), &err);
  printf("%s: %zu rows, %.1f s, %lld slips\n", name, c.count, seconds(last(&c)),
         (long long)last(&c)->head.slips);

  check_every_row(&c);
  for (size_t i = 0;; i++) {
    if (i == sizeof traces / sizeof *traces) {
      fail(&c, "no claims are written for this trace");
      break;
    }
    if (strcmp(traces[i].name, name) == 0) {
      traces[i].claims(&c);
      break;
    }
  }
  snprintf(path, sizeof path, "%s/reference.csv", argv[1]);
  check_reference(&c, path);
  snprintf(path, sizeof path, "%s/expected.hash", argv[1]);
  check_hash(&c, path, hash);
  check_control(&c, hash);
  check_sha256(&c);

  free(c.rows);
  free(c.events);
  free(c.trace.samples);
  if (c.failures)
    printf("%d failures\n", c.failures);
  return c.failures ? 1 : 0;
}

/* The sweeps of `stiction bench extremes`. Lengths of a tour are in units near the object's size, from a corner of
 * floor and wall at the origin. */
#include "../../angle.h"
#include "extremes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define HALF_WIDTH 0.4
#define HALF_HEIGHT 0.2

/* ---- scenes ---------------------------------------------------------------------------------- */

static stic_surface *add_surface(stic_extreme *e, double x, double y, double normal_deg)
{
  stic_surface *s = &e->scene.surfaces[e->scene.surface_count++];

  memset(s, 0, sizeof *s);
  s->point[0] = e->origin[0] + x * e->unit;
  s->point[1] = e->origin[1] + y * e->unit;
  s->normal_deg = normal_deg;
  s->friction.mu_static = 0.5;
  s->friction.mu_dynamic = 0.3;
  return s;
}

static void set_friction(stic_extreme *e, double mu_s, double mu_d)
{
  for (int i = 0; i < e->scene.surface_count; i++) {
    e->scene.surfaces[i].friction.mu_static = mu_s;
    e->scene.surfaces[i].friction.mu_dynamic = mu_d;
  }
}

static void start_at(stic_extreme *e, double x, double y)
{
  e->scene.x = e->origin[0] + x * e->unit;
  e->scene.y = e->origin[1] + y * e->unit;
}

/* A hand's place by the tour's units. */
static void hand_at(stic_extreme *e, double x, double y, double phi)
{
  e->x = e->origin[0] + x * e->unit;
  e->y = e->origin[1] + y * e->unit;
  e->phi = phi;
}

/* ---- hands ------------------------------------------------------------------------------------ */

typedef struct waypoint {
  int frame;
  double x, y, phi;
} waypoint;

/* Down to the floor, along it both ways, into the corner, up the wall, deep into both, away, flush along the floor. */
static const waypoint TOUR[] = {{0, 1.2, 0.8, 0},      {6, 1.2, 0.15, 0.1},  {14, 1.8, 0.15, 0.1},
                                {22, 0.9, 0.12, -0.1}, {30, 0.2, 0.15, 0.2}, {32, 0.2, 0.15, 0.2},
                                {38, 0.2, 0.9, 0.6},   {44, 0.1, 0.1, 1.4},  {47, -2, -2, 2.5},
                                {49, 1.5, 0.9, 0},     {51, 1.2, 0.199, 0},  {57, 1.6, 0.15, 0},
                                {58, 1.6, 0.15, 0},    {60, 1.2, 0.8, -0.3}};
enum { TOUR_FRAMES = 61 };

static void tour(stic_extreme *e, int i, const stic_result *last)
{
  const waypoint *to = TOUR;

  (void)last;
  while (to->frame < i)
    to++;
  if (to->frame == i) {
    hand_at(e, to->x, to->y, to->phi);
    return;
  }
  const waypoint *from = to - 1;
  const double part = (double)(i - from->frame) / (to->frame - from->frame);

  hand_at(e, from->x + part * (to->x - from->x), from->y + part * (to->y - from->y),
          from->phi + part * (to->phi - from->phi));
}

/* A box of size 0.8 x 0.4 units at a floor and a wall, the hand on tour. */
static void standard_case(stic_extreme *e, double unit)
{
  memset(e, 0, sizeof *e);
  e->unit = unit;
  e->buttons = STIC_BUTTON_GRIP;
  e->frames = TOUR_FRAMES;
  e->move = tour;
  stic_scene_init(&e->scene);
  stic_scene_set_box(&e->scene, 2 * HALF_WIDTH * unit, 2 * HALF_HEIGHT * unit);
  e->scene.stiffness = 200;
  e->scene.rotational_stiffness = fmin(4 * unit * unit, 1e12);
}

static void corner_case(stic_extreme *e, double unit, double origin_x, double origin_y)
{
  standard_case(e, unit);
  e->origin[0] = origin_x, e->origin[1] = origin_y;
  add_surface(e, 0, 0, 90);
  add_surface(e, 0, 0, 0);
  start_at(e, 1.2, 0.8);
}

/* ---- stiffness and friction ---------------------------------------------------------------------- */

static bool stiffness(stic_extreme *e, int index, int frames)
{
  enum { STEPS = 13 };
  const int i = index / (STEPS + 1), k = index % (STEPS + 1);

  (void)frames;
  corner_case(e, 1, 0, 0);
  e->a = e->scene.stiffness = pow(10, 2 * i - 12);
  e->b = e->scene.rotational_stiffness = k == 0 ? 0 : pow(10, 2 * (k - 1) - 12);
  return i < STEPS;
}

static const double FRICTIONS[] = {0, 1e-12, 1e-9, 1e-6, 1e-3, 0.1, 0.5, 1, 10, 1e3, 1e6};
enum { FRICTION_COUNT = sizeof FRICTIONS / sizeof FRICTIONS[0] };

static bool friction(stic_extreme *e, int index, int frames)
{
  enum { RATIOS = 8 };
  const int i = index / RATIOS;
  const double mu = i < FRICTION_COUNT ? FRICTIONS[i] : 0;
  const double dynamic[RATIOS] = {
    0, 1e-12, 1e-6 * mu, 0.5 * mu, mu * (1 - 1e-6), mu * (1 - 1e-12), nextafter(mu, 0), mu};

  (void)frames;
  corner_case(e, 1, 0, 0);
  e->a = mu;
  e->b = fmin(dynamic[index % RATIOS], mu);
  set_friction(e, e->a, e->b);
  return i < FRICTION_COUNT;
}

static bool stiffness_friction(stic_extreme *e, int index, int frames)
{
  enum { FRICTIONS_SHOWN = 13 };
  const int i = index / FRICTIONS_SHOWN;

  (void)frames;
  corner_case(e, 1, 0, 0);
  e->a = e->scene.stiffness = pow(10, i - 12);
  e->b = pow(10, index % FRICTIONS_SHOWN * 1.5 - 12);
  set_friction(e, e->b, 0.6 * e->b);
  return i <= 24;
}

/* ---- shape and place ------------------------------------------------------------------------------- */

static bool shape(stic_extreme *e, int index, int frames)
{
  enum { ASPECTS = 9 };
  const int i = index / ASPECTS;
  const double aspect = pow(10, index % ASPECTS);

  (void)frames;
  corner_case(e, pow(10, fmin(i, 18) - 9) * 1.26, 0, 0);
  stic_scene_set_box(&e->scene, 2 * HALF_WIDTH * e->unit, 2 * HALF_WIDTH * e->unit / aspect);
  e->a = stic_scene_size(&e->scene);
  e->b = aspect;
  return i < 18;
}

/* Regular; one corner that hardly stands out; two vertices that are hardly apart. */
static bool polygon(stic_extreme *e, int index, int frames)
{
  static const int counts[] = {3, 4, 5, 6, 7, 8, 12, 16, 24, 32, 48, 63, 64};
  enum { COUNTS = sizeof counts / sizeof counts[0], KINDS = 3 };
  const int kind = index % KINDS, n = counts[index / KINDS < COUNTS ? index / KINDS : 0];
  double(*v)[2];

  (void)frames;
  corner_case(e, 1, 0, 0);
  e->a = n;
  e->b = kind;
  v = e->scene.vertices;
  e->scene.vertex_count = n;
  for (int i = 0; i < n; i++) {
    v[i][0] = HALF_WIDTH * cos(2 * STIC_PI * i / n - 2.0);
    v[i][1] = HALF_WIDTH * sin(2 * STIC_PI * i / n - 2.0);
  }
  if (kind == 1 && n > 3) {
    const double x = v[2][0] - v[0][0], y = v[2][1] - v[0][1], out = 2e-8;

    v[1][0] = (v[0][0] + v[2][0]) / 2 + out * y;
    v[1][1] = (v[0][1] + v[2][1]) / 2 - out * x;
  }
  if (kind == 2) { /* far enough for the loader, on the circle */
    const double turn = 2 * STIC_PI / n - (n < 5 ? 1e-8 : 1e-3);

    v[1][0] = HALF_WIDTH * cos(2 * STIC_PI / n - turn - 2.0);
    v[1][1] = HALF_WIDTH * sin(2 * STIC_PI / n - turn - 2.0);
  }
  return index / KINDS < COUNTS;
}

static bool distance(stic_extreme *e, int index, int frames)
{
  enum { DISTANCES = 14 };
  const int i = index / DISTANCES, far = index % DISTANCES;
  const double unit = 1.2 * pow(10, fmin(i, 11) * 1.5 - 9), way = far == 0 ? 0 : unit * pow(10, far - 1);

  (void)frames;
  corner_case(e, unit, 0.8 * way, 0.6 * way);
  e->a = unit;
  e->b = way / unit;
  e->must_refuse = 0.8 * way > 9.99e14; /* the scene format's range */
  return i <= 11;
}

/* ---- surfaces ---------------------------------------------------------------------------------------- */

static const double ANGLES[] = {0, 1e-15, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-6, 1e-4, 1e-2, 0.3};
enum { ANGLE_COUNT = sizeof ANGLES / sizeof ANGLES[0] };

/* In a slot from y = 0 to y = gap: up and down, turned until it jams, pulled along, and out of the jam. */
static void slot_tour(stic_extreme *e, int i, const stic_result *last)
{
  const double t = i / 60.0, middle = e->parameter / 2;

  (void)last;
  hand_at(e, 1.2 + 0.6 * sin(9 * t), middle + 0.3 * e->parameter * sin(23 * t), 0.5 * sin(14 * t));
}

/* b: 0 two floors, 1 a slot, 2 a slot a hair wider than the box, 3 a corner at a vertex, 4 a narrow slot. */
static bool surfaces(stic_extreme *e, int index, int frames)
{
  enum { KINDS = 5 };
  const int i = index / KINDS, kind = index % KINDS;
  const double angle = i < ANGLE_COUNT ? ANGLES[i] : 0, degrees = angle / STIC_PI * 180;

  (void)frames;
  standard_case(e, 1);
  e->a = angle;
  e->b = kind;
  add_surface(e, 0, 0, 90);
  start_at(e, 1.2, 0.8);
  if (kind == 0) {
    add_surface(e, 1.2, 0, 90 + degrees);
  } else if (kind == 3) {
    add_surface(e, 0, 0, degrees);
    start_at(e, HALF_WIDTH, HALF_HEIGHT);
  } else {
    const double wider = kind == 1 ? 1.1 : kind == 2 ? 1 + 1e-7 + 4 * angle : 1 - fmax(angle, 1e-9);

    e->move = slot_tour;
    e->parameter = 2 * HALF_HEIGHT * wider;
    add_surface(e, 1.2, e->parameter, 270 + degrees);
    start_at(e, 1.2, e->parameter / 2);
    e->must_refuse = kind == 4 || (kind == 1 && angle > 0.09);
    if (kind == 4)
      start_at(e, 1.2, HALF_HEIGHT);
  }
  return i < ANGLE_COUNT;
}

/* ---- far from the world's origin ------------------------------------------------------------------- */

/* Through (x, y), but given by a point `along` its tangent. */
static void add_surface_from_afar(stic_extreme *e, double x, double y, double normal_deg, double along)
{
  double n[2];

  stic_normal_from_degrees(normal_deg, n);
  add_surface(e, x + along * n[1], y - along * n[0], normal_deg);
}

/* From far away to where the tour begins, in `pinned[0]` even steps, and on tour. */
static void carried(stic_extreme *e, int i, const stic_result *last)
{
  const int steps = (int)e->pinned[0];
  const double left = i < steps ? e->parameter * (steps - i) / steps : 0;

  tour(e, i < steps ? 0 : i - steps + 1, last);
  e->x += 0.8 * left, e->y += 0.6 * left;
}

/* A tour at the wall here, one mirrored at the wall `parameter` away, one here. */
static void there_and_back(stic_extreme *e, int i, const stic_result *last)
{
  tour(e, i % TOUR_FRAMES, last);
  if (i / TOUR_FRAMES == 1)
    e->x = e->parameter - e->x, e->phi = -e->phi;
}

/* A slot of 1.1 box heights, through (1.2, 0). */
static void slot_from_afar(stic_extreme *e, double way, double tilt_deg)
{
  const double wide = 2.2 * HALF_HEIGHT;
  double n[2];

  stic_normal_from_degrees(90 + tilt_deg, n);
  e->move = slot_tour;
  e->parameter = wide;
  e->scene.angle = tilt_deg * STIC_RAD_PER_DEG;
  add_surface_from_afar(e, 1.2, 0, 90 + tilt_deg, -way);
  add_surface_from_afar(e, 1.2 + wide * n[0], wide * n[1], 270 + tilt_deg, way);
  start_at(e, 1.2 + wide / 2 * n[0], wide / 2 * n[1]);
}

/* b: 0 surfaces given near the world's origin, 1 slopes, 2 a slot, 3 a tilted one, 4 with walls at the world's origin and beyond;
 * at the origin, where the object comes 5 from afar in steps, 6 at once; 7 there and back. */
static bool far_away(stic_extreme *e, int index, int frames)
{
  enum { DISTANCES = 12, KINDS = 8 };
  const int i = index / KINDS, kind = index % KINDS;
  const double way = pow(10, i + 1);

  (void)frames;
  standard_case(e, 1);
  e->a = way;
  e->b = kind;
  start_at(e, 1.2, 0.8);
  if (kind < 5)
    e->origin[0] = 0.8 * way, e->origin[1] = 0.6 * way;
  if (kind == 2 || kind == 3) {
    slot_from_afar(e, way, kind == 2 ? 0 : 15);
    return i < DISTANCES;
  }
  start_at(e, 1.2 + (kind == 5 || kind == 6 ? 0.8 * way : 0), 0.8 + (kind == 5 || kind == 6 ? 0.6 * way : 0));
  add_surface_from_afar(e, 0, 0, kind == 1 ? 105 : 90, kind < 2 ? -0.8 * way : 0);
  add_surface_from_afar(e, kind == 4 ? -0.8 * way : 0, 0, kind == 1 ? 10 : 0, kind < 2 ? 0.6 * way : 0);
  e->parameter = way;
  if (kind == 4) {
    add_surface(e, 0, way, 270);
  } else if (kind == 7) {
    add_surface(e, way, 0, 180);
    e->move = there_and_back;
    e->frames = 3 * TOUR_FRAMES;
  } else if (kind > 4) {
    e->pinned[0] = kind == 5 ? 12 : 1;
    e->move = carried;
    e->frames = TOUR_FRAMES - 1 + (int)e->pinned[0];
  }
  return i < DISTANCES;
}

/* ---- hands ------------------------------------------------------------------------------------------- */

/* Between its rest on the floor and a place `parameter` units away, each time in another direction. */
static void jumps(stic_extreme *e, int i, const stic_result *last)
{
  (void)last;
  if (i % 2 == 0)
    hand_at(e, 1.2, 0.15, 0.1 * (i % 5));
  else
    hand_at(e, 1.2 + e->parameter * cos(i * 2.4), 0.8 + e->parameter * sin(i * 2.4), i);
}

/* Pressed into the corner, 0.4 turns a frame, then all of them back. */
static void turns(stic_extreme *e, int i, const stic_result *last)
{
  const int back = e->frames / 2;

  (void)last;
  hand_at(e, 0.3, 0.3, 2 * STIC_PI * 0.4 * (i < back ? i : 2 * back - i));
}

/* Pressed on the floor at the origin of coordinates, then steps of `parameter` m. */
static void tiny_steps(stic_extreme *e, int i, const stic_result *last)
{
  (void)last;
  if (i < 4) {
    hand_at(e, 1.2, 0.8 - 0.16 * i, 0);
  } else {
    e->x = e->parameter * (i - 4);
    e->y = e->parameter * ((i * 7) % 5 - 2);
    e->phi = e->parameter * ((i * 3) % 4 - 2);
  }
}

/* b: 0 jumps, 1 turns, 2 tiny steps. */
static bool hands(stic_extreme *e, int index, int frames)
{
  static const double jump[] = {1, 1e3, 1e6, 1e9}, turned[] = {3, 30, 300, 3000},
                      step[] = {5e-324, 1e-310, 1e-200, 1e-30};
  const int i = index / 3;

  corner_case(e, 1, 0, 0);
  e->b = index % 3;
  if (index >= 12)
    return false;
  if (e->b == 0) {
    e->parameter = e->a = jump[i];
    e->move = jumps;
  } else if (e->b == 1) {
    e->a = fmin(turned[i], frames / 2.5);
    e->frames = (int)(e->a * 5);
    e->move = turns;
  } else {
    corner_case(e, 1, -1.2, -0.32);
    e->parameter = e->a = step[i];
    e->move = tiny_steps;
  }
  return true;
}

/* Flat on the floor and `parameter` deep, then along it by parts of that, a little lifted and away. */
static void press(stic_extreme *e, int i, const stic_result *last)
{
  const double depth = e->parameter;

  (void)last;
  if (i < 4)
    hand_at(e, 1.2, HALF_HEIGHT + (3 - i) * depth / 3, 0);
  else if (i < 50)
    hand_at(e, 1.2 + 0.08 * (i - 4) * depth, HALF_HEIGHT - depth * fmin(1, (i - 3) / 10.0),
            i > 30 ? 1e-3 * (i - 30) : 0);
  else
    hand_at(e, 1.2, HALF_HEIGHT - depth * (58 - i) / 10.0, 0.1);
}

static bool pressing(stic_extreme *e, int index, int frames)
{
  static const double mu[] = {0, 1e-6, 0.5, 1e3};
  const int i = index / 4;

  (void)frames;
  corner_case(e, 1, 0, 0);
  e->parameter = e->a = pow(10, i - 15);
  e->b = mu[index % 4];
  set_friction(e, e->b, e->b * 0.6);
  e->frames = 60;
  e->move = press;
  return i <= 21;
}

/* ---- exactly there --------------------------------------------------------------------------------------- */

static double some_ulp(double x, int ulp)
{
  for (; ulp > 0; ulp--)
    x = nextafter(x, INFINITY);
  for (; ulp < 0; ulp++)
    x = nextafter(x, -INFINITY);
  return x;
}

static const int ULPS[] = {0, 0, 1, -1, 2, -2, 3, -3, 16, -16, 0};
enum { ULP_COUNT = sizeof ULPS / sizeof ULPS[0] };

static void onto_anchor(stic_extreme *e, int i, const stic_result *last)
{
  if (i < 20) {
    tour(e, i, last);
    e->pinned[0] = e->x, e->pinned[1] = e->y;
  } else {
    if (last->contact_count > 0)
      e->pinned[0] = last->contacts[0].x, e->pinned[1] = last->contacts[0].y;
    e->x = some_ulp(e->pinned[0], ULPS[i % ULP_COUNT]);
    e->y = some_ulp(e->pinned[1], ULPS[i / 2 % ULP_COUNT]);
  }
}

/* To the angle at which the equilibrium vanishes, to the last bits. */
static void onto_fold(stic_extreme *e, int i, const stic_result *last)
{
  (void)last;
  e->phi = i < 20 ? e->pinned[0] + (e->parameter - e->pinned[0]) * i / 20
                  : some_ulp(e->parameter, ULPS[i % ULP_COUNT]);
}

/* Flat on the floor, pulled along by mu_s times the depth, to the last bits. */
static void onto_limit(stic_extreme *e, int i, const stic_result *last)
{
  const double depth = 0.05, side = i / 22 % 2 ? -1 : 1;

  if (i < 3) {
    hand_at(e, 1.2, 0.8 - 0.325 * i, 0);
    return;
  }
  hand_at(e, 1.2, HALF_HEIGHT - depth, 0);
  if (i >= 6)
    e->x = some_ulp(last->holding_x + side * 0.5 * (last->holding_y - e->y), ULPS[i % ULP_COUNT]);
}

static void fold_case(stic_extreme *e, uint64_t seed)
{
  random_case c;

  random_snap_init(&c, seed);
  e->scene = c.scene;
  const double kappa = c.scene.rotational_stiffness / c.scene.stiffness;
  const double ratio = -c.scene.holding_point[1] * -c.y / kappa, fold = acos(-1 / ratio);

  e->x = c.x, e->y = c.y;
  e->pinned[0] = c.phi;
  e->parameter = fold + ratio * sin(fold);
}

/* a: 0 on the anchor, 1 on a fold, 2 on the friction limit, 3 gripped at a vertex, 4 gripped 100 units off; b: which. */
static bool exactly(stic_extreme *e, int index, int frames)
{
  enum { KINDS = 5 };
  static stic_extreme_hand *const moves[KINDS] = {onto_anchor, onto_fold, onto_limit, tour, tour};
  const int which = index / KINDS;

  (void)frames;
  corner_case(e, 1, 0, 0);
  e->a = index % KINDS;
  e->b = which;
  e->move = moves[index % KINDS];
  if (e->a == 1)
    fold_case(e, (uint64_t)which + 1);
  if (e->a == 3)
    memcpy(e->scene.holding_point, e->scene.vertices[which % 4], sizeof e->scene.holding_point);
  if (e->a == 4)
    e->scene.holding_point[which % 2] = which & 2 ? 100 : -100;
  if (which >= 4)
    e->scene.rotational_stiffness = 0.01;
  return which < 8;
}

/* ---- standing still ------------------------------------------------------------------------------------------ */

/* Into a rest, and there it stays. */
static void stand(stic_extreme *e, int i, const stic_result *last)
{
  tour(e, i < e->stand_from - 2 ? i : e->stand_from - 2, last);
}

static bool still(stic_extreme *e, int index, int frames)
{
  static const int where[] = {4, 6, 14, 24, 30, 36, 44, 47};
  enum { PLACES = sizeof where / sizeof where[0] };

  if (index >= PLACES)
    return false;
  corner_case(e, 1, 0, 0);
  e->a = where[index];
  e->b = frames;
  e->must_stand = true;
  e->stand_from = where[index] + 2;
  e->frames = e->stand_from + frames;
  e->move = stand;
  return true;
}

const stic_sweep stic_sweeps[] = {
  {"stiffness", "k_p, N/m", "k_theta, N m/rad", 7, stiffness},
  {"friction", "mu_s", "mu_d", 3, friction},
  {"k_p-mu", "k_p, N/m", "mu_s", 11, stiffness_friction},
  {"shape", "size, m", "aspect ratio", 7, shape},
  {"polygon", "vertices", "kind", 1, polygon},
  {"distance", "size, m", "distance from the origin, sizes", 5, distance},
  {"far", "distance, sizes", "kind", 1, far_away},
  {"surfaces", "angle, rad", "kind", 1, surfaces},
  {"hand", "extent", "kind", 1, hands},
  {"press", "depth, sizes", "mu_s", 3, pressing},
  {"exact", "kind", "which", 1, exactly},
  {"still", "place", "frames", 3, still},
};
const int stic_sweep_count = sizeof stic_sweeps / sizeof stic_sweeps[0];

/* ---- random ---------------------------------------------------------------------------------------------------- */

static void move_wild(stic_extreme *e, int i, const stic_result *last)
{
  if (i > 0)
    wild_move(&e->wild, last);
  e->x = e->wild.x, e->y = e->wild.y, e->phi = e->wild.phi;
  e->buttons = e->wild.buttons;
}

void stic_extreme_random(stic_extreme *e, uint64_t seed, int64_t number)
{
  memset(e, 0, sizeof *e);
  wild_init(&e->wild, seed * UINT64_C(1000003) + (uint64_t)number);
  e->scene = e->wild.scene;
  e->unit = e->wild.size;
  e->may_refuse = true;
  e->frames = 60;
  e->move = move_wild;
}

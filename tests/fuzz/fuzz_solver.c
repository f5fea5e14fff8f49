/* Scenes and hand paths made of bytes, extremes included, solved at every level and precision. Each row is finite and
 * within its bounds, and holds the model's invariants. A failure prints its case; with FUZZ_SAY=1 set every case is
 * printed, to look into a slow one. */
#include "memory_file.h"

#include "angle.h"
#include "inside.h"
#include "statics/core.h"
#include "invariants/checker.h"
#include "invariants/wild.h"

#define SAMPLES_MAX 24

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

inside inside_report;

typedef struct bytes {
  const uint8_t *at, *end;
} bytes;

/* 0 after the end. */
static int take(bytes *b)
{
  return b->at < b->end ? *b->at++ : 0;
}

/* -1 to 1, both and 0 included. */
static double take_part(bytes *b)
{
  const int high = take(b);

  return fmax(-1, (high * 256 + take(b) - 32768) / 32767.0);
}

/* Powers of ten over a range, whole ones and those between. */
static double take_power(bytes *b, double low, double high)
{
  return pow(10, low + (high - low) * take(b) / 255.0);
}

static void take_shape(bytes *b, stic_scene *s)
{
  const int kind = take(b);
  const double aspect = kind % 4 == 0 ? take_power(b, -8, 0) : 0.1 + 0.9 * take(b) / 255.0;
  const int n = 3 + kind % 62;

  if (kind % 2 == 0) {
    stic_scene_set_box(s, 0.1, 0.1 * aspect);
    return;
  }
  s->vertex_count = n;
  for (int i = 0; i < n; i++) {
    const double t = 2 * STIC_PI * (i + 0.45 * take_part(b)) / n;

    s->vertices[i][0] = 0.05 * cos(t);
    s->vertices[i][1] = 0.05 * aspect * sin(t);
  }
}

static stic_friction take_friction(bytes *b)
{
  const int kind = take(b);
  stic_friction f = {take_power(b, -2, 1), 0};

  if (kind % 8 == 0)
    f.mu_static = 0;
  else if (kind % 8 == 1)
    f.mu_static = take_power(b, -12, 6);
  f.mu_dynamic = f.mu_static;
  if (kind & 16)
    f.mu_dynamic *= kind & 32 ? 1 - 1e-9 : take(b) / 255.0;
  return f;
}

static void take_surfaces(bytes *b, stic_scene *s)
{
  const int count = 1 + take(b) % 6;

  for (int i = 0; i < count; i++) {
    const int kind = take(b);
    double deg = 90.0 * (kind % 4);
    const double x = 0.15 * take_part(b), y = 0.15 * take_part(b);

    if (kind & 4)
      deg += take_power(b, -9, 2) * (kind & 8 ? 1 : -1);
    random_surface(s, x, y, deg, 0, 0);
    s->surfaces[i].friction = take_friction(b);
  }
}

static void take_hand(bytes *b, wild_case *c)
{
  stic_scene *s = &c->scene;
  const int kind = take(b);

  s->stiffness = kind & 1 ? take_power(b, -12, 12) : 200;
  s->rotational_stiffness = s->stiffness * (kind & 2 ? take_power(b, -12, 6) : take_power(b, -4, -1));
  if (kind % 16 == 0)
    s->rotational_stiffness = 0;
  s->rotational_stiffness = fmin(s->rotational_stiffness, 1e12);
  s->hold = kind & 4 ? STIC_HOLD_BUTTON : STIC_HOLD_START;
  if (kind & 8) {
    s->holding_point[0] = 0.1 * take_part(b);
    s->holding_point[1] = 0.1 * take_part(b);
  } else if (kind & 16) {
    memcpy(s->holding_point, s->vertices[take(b) % s->vertex_count], sizeof s->holding_point);
  }
}

/* False if the bytes make no scene. */
static bool take_case(bytes *b, wild_case *c)
{
  stic_scene *s = &c->scene;
  stic_error err;

  memset(c, 0, sizeof *c);
  stic_scene_init(s);
  take_shape(b, s);
  take_hand(b, c);
  take_surfaces(b, s);
  c->size = stic_scene_size(s);
  s->x = 0.3 * take_part(b), s->y = 0.3 * take_part(b);
  s->angle = 3 * take_part(b);
  wild_free_start(c);
  s->reach = 2 * c->size;
  if (take(b) % 4 == 1)
    wild_place(c, take_power(b, -8, 9), 0, 0);
  if (take(b) % 4 == 1)
    wild_place(c, 1, c->size * take_power(b, 0, 12) * take_part(b), c->size * take_power(b, 0, 12));
  c->x = s->x + cos(s->angle) * s->holding_point[0] - sin(s->angle) * s->holding_point[1];
  c->y = s->y + sin(s->angle) * s->holding_point[0] + cos(s->angle) * s->holding_point[1];
  c->phi = s->angle;
  c->buttons = STIC_BUTTON_GRIP;
  return stic_scene_validate(s, &err) == STIC_OK;
}

/* Onto a contact, or onto its friction limit to the last bit. */
static void seek_contact(bytes *b, wild_case *c, const stic_result *last, bool limit)
{
  const stic_contact *k = last->contacts;
  const stic_surface *s;
  double n[2], depth, along;

  if (last->contact_count == 0)
    return;
  k += take(b) % last->contact_count;
  c->x = k->x, c->y = k->y;
  if (!limit)
    return;
  s = &c->scene.surfaces[k->surface];
  stic_normal_from_degrees(s->normal_deg, n);
  depth = c->size * take(b) / 255.0;
  along = fmin(s->friction.mu_static * depth, 10 * c->size) * (take(b) & 1 ? 1 : -1);
  c->x = last->holding_x - depth * n[0] + along * n[1];
  c->y = last->holding_y - depth * n[1] - along * n[0];
}

static void take_move(bytes *b, wild_case *c, const stic_result *last)
{
  const int kind = take(b);
  const double step = c->size * take_power(b, kind & 64 ? -18 : -3, kind & 128 ? 9 : 0.5);

  switch (kind % 8) {
  case 0: break; /* stands still */
  case 1: seek_contact(b, c, last, false); break;
  case 2: seek_contact(b, c, last, true); break;
  case 3: c->phi += take_power(b, -18, 4) * take_part(b); break;
  default: c->x += step * take_part(b), c->y += step * take_part(b), c->phi += take_part(b);
  }
  if (kind & 16)
    c->buttons ^= take(b) & 1;
}

static void say_case(const wild_case *c, const stic_settings *settings)
{
  const stic_scene *s = &c->scene;
  char level[40];

  stic_settings_accuracy_text(settings, level, sizeof level);
  fprintf(stderr, "%s %s: k_p %g k_theta %g hold %d at (%.17g, %.17g), size %g, pose (%.17g, %.17g, %.17g)\n",
          level, stic_precision_name(settings->precision), s->stiffness, s->rotational_stiffness, s->hold,
          s->holding_point[0], s->holding_point[1], c->size, s->x, s->y, s->angle);
  for (int i = 0; i < s->vertex_count; i++)
    fprintf(stderr, "  vertex (%.17g, %.17g)\n", s->vertices[i][0], s->vertices[i][1]);
  for (int i = 0; i < s->surface_count; i++)
    fprintf(stderr, "  surface (%.17g, %.17g) normal %.17g mu %g %g\n", s->surfaces[i].point[0],
            s->surfaces[i].point[1], s->surfaces[i].normal_deg, s->surfaces[i].friction.mu_static,
            s->surfaces[i].friction.mu_dynamic);
}

/* What holds whatever the scene and the precision. */
static void check_always(const stic_result *r)
{
  const double numbers[] = {r->x,       r->y,          r->z,         r->theta,     r->hand_x,
                            r->hand_y,  r->hand_theta, r->holding_x, r->holding_y, r->force_x,
                            r->force_y, r->moment,     r->residual};

  for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
    require(isfinite(numbers[i]));
  require(r->contact_count >= 0 && r->contact_count <= STIC_CONTACTS_MAX && r->iterations >= 0);
  require((unsigned)r->state <= STIC_MULTI && r->flags < 32 && r->slips >= 0);
  for (int i = 0; i < r->contact_count; i++) {
    const stic_contact *k = &r->contacts[i];

    require(isfinite(k->x) && isfinite(k->y) && isfinite(k->normal) && isfinite(k->friction) &&
            k->normal >= 0);
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  static const stic_level levels[] = {STIC_LEVEL_FRAME, STIC_LEVEL_EVENT, STIC_LEVEL_SUBSTEP};
  static const stic_precision precisions[] = {STIC_F64, STIC_F64, STIC_F64, STIC_F32, STIC_F80};
  bytes b = {data, data + size};
  const int kind = take(&b);
  static wild_case c;
  static stic_checker k;
  static stic_result r;
  stic_settings settings;
  stic_sim *sim;
  stic_error err;

  stic_settings_init(&settings);
  settings.level = levels[kind % 3];
  settings.precision = precisions[kind / 3 % 5];
  settings.substeps = 3;
  if (!take_case(&b, &c))
    return 0;
  require(stic_sim_create(&c.scene, &settings, &sim, &err) == STIC_OK);
  stic_checker_init(&k, &c.scene, settings.precision);
  if (getenv("FUZZ_SAY"))
    say_case(&c, &settings);
  memset(&r, 0, sizeof r);
  for (int i = 0; i < SAMPLES_MAX && (i == 0 || b.at < b.end); i++) {
    stic_sample sample;
    const stic_event *events;
    int count;

    if (i > 0)
      take_move(&b, &c, &r);
    if (!(fabs(c.x) <= 1e18 && fabs(c.y) <= 1e18)) /* refused by the reader of traces */
      break;
    sample = wild_sample(&c, i);
    inside_report.row_decisions = 0;
    inside_report.worst_rise = 0;
    stic_sim_step(sim, &sample, &r);
    events = stic_sim_events(sim, &count);
    check_always(&r);
    stic_checker_row(&k, &r, events, count,
                     (inside_report.row_decisions & ~(unsigned)STIC_DECISION_REST) != 0);
    if (!k.complaint[0] && inside_report.worst_rise <= 1)
      continue;
    say_case(&c, &settings);
    fprintf(stderr, "row %d: %s, energy %g\n", i, k.complaint, inside_report.worst_rise);
    abort();
  }
  stic_sim_destroy(sim);
  return 0;
}

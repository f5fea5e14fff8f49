/* One number over every field of every row and event of a fixed set of random traces, at levels frame and event and
 * in all precisions. The same bits are expected from every compiler and optimisation.
 *   result_hash [flip|parts]
 * flip: one bit of one input differs, so the number must. parts: says the number after each part. */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "invariants/random_scene.h"

static uint64_t hash = UINT64_C(14695981039346656037); /* FNV-1a */

static void add_bytes(const void *data, size_t size)
{
  const unsigned char *p = data;
  for (size_t i = 0; i < size; i++)
    hash = (hash ^ p[i]) * UINT64_C(1099511628211);
}

static void add_int(int64_t v)
{
  add_bytes(&v, sizeof v);
}

static void add_double(double v)
{
  if (v == 0)
    v = 0; /* -0 is 0 */
  add_bytes(&v, sizeof v);
}

static void add_row(const stic_result *r)
{
  add_int(r->t_ns), add_int(r->state);
  add_double(r->x), add_double(r->y), add_double(r->z), add_double(r->theta);
  add_double(r->hand_x), add_double(r->hand_y), add_double(r->hand_z), add_double(r->hand_theta);
  add_double(r->holding_x), add_double(r->holding_y);
  add_double(r->force_x), add_double(r->force_y), add_double(r->moment);
  add_int(r->slips), add_int(r->flags), add_int(r->iterations), add_double(r->residual),
    add_int(r->contact_count);
  for (int i = 0; i < r->contact_count; i++) {
    const stic_contact *k = &r->contacts[i];
    add_int(k->vertex), add_int(k->surface);
    add_double(k->x), add_double(k->y), add_double(k->normal), add_double(k->friction);
  }
}

static void add_event(const stic_event *e)
{
  add_double(e->t), add_int(e->kind), add_int(e->vertex), add_int(e->surface);
  add_double(e->x), add_double(e->y), add_double(e->length);
}

enum { SEEDS = 24, FAR_SEEDS = 8 }; /* far from the world's origin after those near it */

/* The whole scene, by powers of ten of m. Returns how far. */
static double move_away(random_case *c, uint64_t seed)
{
  double way = seed > SEEDS ? pow(10, (double)(seed - SEEDS)) : 0;
  for (int i = 0; i < c->scene.surface_count; i++)
    c->scene.surfaces[i].point[0] += way, c->scene.surfaces[i].point[1] -= way;
  c->scene.x += way, c->scene.y -= way;
  return way;
}

static int run(uint64_t seed, stic_level level, stic_precision precision, int flip)
{
  random_case c;
  random_case_init(&c, seed);
  double way = move_away(&c, seed);
  stic_settings settings;
  stic_sim *sim;
  stic_error err;
  stic_settings_init(&settings);
  settings.level = level, settings.precision = precision;
  if (stic_sim_create(&c.scene, &settings, &sim, &err))
    return fprintf(stderr, "seed %" PRIu64 ": %s\n", seed, err.message), 1;
  rng r = {seed + 77};
  for (int i = 0; i < 40; i++) {
    if (i)
      random_case_move(&c, &r);
    stic_sample sample = {(int64_t)i * 32258065,
                          {c.x + way, c.y - way, 0.001 * i},
                          {0, 0, sin(c.phi / 2), cos(c.phi / 2)},
                          1,
                          false};
    if (flip && i == 20) {
      uint64_t bits;
      memcpy(&bits, &sample.position[1], sizeof bits);
      bits ^= 1;
      memcpy(&sample.position[1], &bits, sizeof bits);
    }
    stic_result res;
    stic_sim_step(sim, &sample, &res);
    add_row(&res);
    int count;
    const stic_event *events = stic_sim_events(sim, &count);
    add_int(count);
    for (int k = 0; k < count; k++)
      add_event(&events[k]);
  }
  stic_sim_destroy(sim);
  return 0;
}

int main(int argc, char **argv)
{
  int flip = argc > 1 && !strcmp(argv[1], "flip"), failed = 0;
  int parts = argc > 1 && !strcmp(argv[1], "parts");
  for (int precision = STIC_F32; precision <= STIC_F80; precision++)
    for (int event = 0; event < 2; event++) {
      for (uint64_t seed = 1; seed <= SEEDS + FAR_SEEDS; seed++)
        failed |= run(seed, event ? STIC_LEVEL_EVENT : STIC_LEVEL_FRAME, (stic_precision)precision,
                      flip && seed == 12 && event && precision == STIC_F64);
      if (parts)
        printf("f%d %s %016" PRIx64 "\n", 32 * (precision + 1) - 16 * (precision == STIC_F80),
               event ? "event" : "frame", hash);
    }
  printf("%016" PRIx64 "\n", hash);
  return failed;
}

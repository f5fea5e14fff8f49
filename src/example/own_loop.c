/* A loop of your own: a hand rubs a box to and fro over a floor, 31 times a second.
 *
 *   cc own_loop.c $(pkg-config --cflags --libs stiction) -lm -o own_loop && ./own_loop
 *
 * The hand (+) runs ahead, the box [##] sticks, jumps, and sticks again. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <stiction.h>
#include <string.h>
#include <time.h>

enum { RATE = 31, COLUMNS = 64 };

/* Or stic_scene_read() one from a file. */
static stic_scene box_on_floor(void)
{
  stic_scene scene;

  stic_scene_init(&scene);
  stic_scene_set_box(&scene, 0.04, 0.04);
  scene.y = 0.03; /* 1 cm above the floor */
  scene.stiffness = 200;
  scene.rotational_stiffness = 0.5;
  scene.surface_count = 1;
  scene.surfaces[0] = (stic_surface){.name = "floor", .normal_deg = 90, .friction = {0.8, 0.4}};
  return scene;
}

/* Your tracker goes here. This hand presses for a second, 5 cm below where the box lies, then swings 12 cm wide. */
static stic_sample read_hand(int frame)
{
  const double t = (double)frame / RATE;

  return (stic_sample){.t_ns = frame * INT64_C(1000000000) / RATE,
                       .position = {t < 1 ? 0 : 0.12 * sin(t - 1), t < 1 ? 0.03 - 0.06 * t : -0.03, 0},
                       .orientation = {0, 0, 0, 1}};
}

static void show(const stic_result *r)
{
  char strip[COLUMNS + 1];
  const int box = (int)((r->x + 0.16) / 0.32 * COLUMNS), hand = (int)((r->hand_x + 0.16) / 0.32 * COLUMNS);

  memset(strip, ' ', COLUMNS);
  strip[COLUMNS] = '\0';
  memcpy(strip + box - 4, "[######]", 8);
  strip[hand] = '+';
  printf("%s %-8s %6.2f N %4lld slips%s\n", strip, stic_state_name(r->state), r->force_x, (long long)r->slips,
         r->flags & STIC_FLAG_SLIPPED ? "  <-" : "");
}

int main(int argc, char **argv)
{
  const int frames = argc > 1 ? atoi(argv[1]) : 8 * RATE;
  const stic_scene scene = box_on_floor();
  struct timespec next;
  stic_settings settings;
  stic_sim *sim;
  stic_error error;

  stic_settings_init(&settings);
  if (stic_sim_create(&scene, &settings, &sim, &error)) {
    fprintf(stderr, "%s\n", error.message);
    return 1;
  }
  clock_gettime(CLOCK_MONOTONIC, &next);
  for (int frame = 0; frame < frames; frame++) {
    const stic_sample hand = read_hand(frame);
    stic_result result;

    stic_sim_step(sim, &hand, &result);
    show(&result);
    next.tv_nsec += 1000000000 / RATE;
    next.tv_sec += next.tv_nsec / 1000000000;
    next.tv_nsec %= 1000000000;
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, NULL);
  }
  stic_sim_destroy(sim);
  return 0;
}

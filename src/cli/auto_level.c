#include "auto_level.h"

#include "../clock.h"
#include "../error.h"
#include "bench/trade.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* 2000 samples, so that p99.9 is not the worst of them, and 13 settings within 2 s. */
enum { SAMPLES = 2000, RUNS = 3 };
#define TRY_NS 140000000

/* In the order of their errors in `bench trade`. f80 pays at level event only: elsewhere the level errs by 1e10
 * times what f64 rounds. f32 at level event errs more than `frame` on some traces, and is hardly cheaper. */
static int list_settings(const stic_settings *like, stic_auto_try *list)
{
  int count = 0;

  for (int i = LDBL_MANT_DIG == 64 ? 0 : 1; i < 12; i++) {
    stic_settings *s = &list[count++].settings;

    *s = *like;
    s->precision = i == 0 ? STIC_F80 : i == 11 ? STIC_F32 : STIC_F64;
    s->level = i < 2 ? STIC_LEVEL_EVENT : i < 10 ? STIC_LEVEL_SUBSTEP : STIC_LEVEL_FRAME;
    s->substeps = i < 10 ? 1 << (10 - i) : 1;
  }
  return count;
}

/* What reading the thread's clock costs. */
static int64_t clock_cost_ns(void)
{
  int64_t cost[101];

  for (int i = 0; i < 101; i++) {
    const int64_t start_ns = stic_clock_thread_ns();

    cost[i] = stic_clock_thread_ns() - start_ns;
  }
  return stic_cost_quantile(cost, 101, 0.5);
}

/* The fastest of several runs is what a sample costs; the rest is what the machine did meanwhile. */
static stic_status try_settings(const stic_motion *motion, stic_auto_try *attempt, int64_t *cost,
                                stic_error *err)
{
  const int64_t end_ns = stic_clock_ns() + TRY_NS, clock_ns = clock_cost_ns();
  int count = 0;

  for (int i = 0; i < motion->count; i++)
    cost[i] = INT64_MAX;
  for (int run = 0; run < RUNS && stic_clock_ns() < end_ns; run++) {
    int64_t now_ns;
    stic_sim *sim;
    stic_result result;
    const stic_status status = stic_sim_create(&motion->scene, &attempt->settings, &sim, err);

    if (status != STIC_OK)
      return status;
    now_ns = stic_clock_thread_ns();
    for (int i = 0; i < motion->count && stic_clock_ns() < end_ns; i++) {
      const int64_t start_ns = now_ns;

      stic_sim_step(sim, &motion->samples[i], &result);
      now_ns = stic_clock_thread_ns();
      if (now_ns - start_ns - clock_ns < cost[i])
        cost[i] = now_ns - start_ns - clock_ns;
      count = i >= count ? i + 1 : count;
    }
    stic_sim_destroy(sim);
  }
  attempt->whole = count == motion->count;
  attempt->p999_ns = count > 0 ? stic_cost_quantile(cost, count, 0.999) : INT64_MAX;
  return STIC_OK;
}

stic_status stic_auto_level(const stic_scene *scene, int64_t budget_ns, stic_settings *settings,
                            stic_auto_choice *choice, stic_error *err)
{
  const int64_t start_ns = stic_clock_ns();
  int64_t *cost = malloc(SAMPLES * sizeof *cost);
  stic_motion motion;
  stic_status status;
  int all;

  memset(choice, 0, sizeof *choice);
  if (!cost)
    return stic_error_set(err, STIC_NO_MEMORY, NULL, 0, "out of memory");
  status = stic_motion_along_surfaces(&motion, scene, SAMPLES, err);
  if (status != STIC_OK) {
    free(cost);
    return status;
  }
  all = list_settings(settings, choice->tried);
  for (int i = 0; i < all && status == STIC_OK && !choice->fits; i++) {
    stic_auto_try *t = &choice->tried[i];

    status = try_settings(&motion, t, cost, err);
    choice->count++;
    choice->fits = t->whole && t->p999_ns <= budget_ns;
    if (choice->fits || t->p999_ns < choice->tried[choice->chosen].p999_ns)
      choice->chosen = i;
  }
  stic_motion_free(&motion);
  free(cost);
  choice->took_ns = stic_clock_ns() - start_ns;
  *settings = choice->tried[choice->chosen].settings;
  return status;
}

/* "event f64" */
static const char *setting_text(const stic_settings *s, char out[48])
{
  char accuracy[32];

  stic_settings_accuracy_text(s, accuracy, sizeof accuracy);
  snprintf(out, 48, "%s %s", accuracy, stic_precision_name(s->precision));
  return out;
}

void stic_auto_text(const stic_auto_choice *choice, int64_t budget_ns, char *out, size_t out_size)
{
  const stic_auto_try *chosen = &choice->tried[choice->chosen];
  char text[48];
  int n = snprintf(out, out_size, "accuracy auto: %s, p99.9 %.4g us of %.4g us%s",
                   setting_text(&chosen->settings, text), (double)chosen->p999_ns / 1e3,
                   (double)budget_ns / 1e3, choice->fits ? "" : ": nothing fits, this is the cheapest");

  for (int i = 0; i < choice->count && n > 0 && (size_t)n < out_size; i++) {
    const stic_auto_try *t = &choice->tried[i];

    if (i != choice->chosen)
      n += snprintf(out + n, out_size - (size_t)n, "; %s: %.4g us%s", setting_text(&t->settings, text),
                    (double)t->p999_ns / 1e3, t->whole ? "" : " and more");
  }
  if (n > 0 && (size_t)n < out_size)
    snprintf(out + n, out_size - (size_t)n, "; found in %.0f ms", (double)choice->took_ns / 1e6);
}

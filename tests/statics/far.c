/* Far from the world's origin, through the public interface. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "rig.h"

static const stic_precision PRECISIONS[] = {STIC_F32, STIC_F64, STIC_F80};

/* A box in a slot that is as high as the box, but for the rounding of its place: it may start too deep by that. */
static void start_in_a_tight_slot(void **state)
{
  (void)state;
  for (int i = 0; i < 3 * 12; i++) {
    const double way = pow(10, i / 3) / 3;
    rig g;
    rig_init(&g, 200, 0.5);
    g.settings.precision = PRECISIONS[i % 3];
    stic_scene_set_box(&g.scene, 0.4, 0.2);
    rig_surface(&g, 0, way, 90, 0.5, 0.3);
    rig_surface(&g, 0, way + 0.2, 270, 0.5, 0.3);
    rig_pose(&g, way, way + 0.1, 0);
    rig_start(&g);
    for (int k = 0; k < 5; k++) {
      rig_to(&g, way + 0.1 * k, way + 0.1 - 0.01 * k, 0);
      if (g.r.flags & STIC_FLAG_NO_ANSWER)
        fail_msg("%s, %g m away, row %d: no answer", stic_precision_name(g.settings.precision), way, k);
    }
    rig_end(&g);
  }
}

/* Out and back, also beyond all numbers of single precision: at the hand, or the object stays, to the last bit. */
static void jump(rig *g, double x, double y)
{
  const stic_result before = g->r;
  const double near = 1e-6 + 1e-6 * fabs(x);
  rig_to(g, x, y, x < 1e3 ? 0.3 : 0);
  const bool kept = g->r.x == before.x && g->r.y == before.y && g->r.theta == before.theta;
  if (g->r.flags & STIC_FLAG_NO_ANSWER ? !kept : !(fabs(g->r.x - x) <= near && fabs(g->r.y - y) <= near))
    fail_msg("to %g: flags %u at %.9g, %.9g", x, g->r.flags, g->r.x, g->r.y);
}

static void jumps_out_and_back(void **state)
{
  (void)state;
  for (double way = 1e3; way < 1e300; way *= 1e3) {
    rig g;
    rig_init(&g, 200, 0.5);
    g.settings.precision = STIC_F32;
    stic_scene_set_box(&g.scene, 0.4, 0.2);
    rig_surface(&g, 0, 0, 90, 0.5, 0.3);
    rig_pose(&g, 0.3, 0.7, 0);
    rig_start(&g);
    rig_to(&g, 0.3, 0.7, 0);
    jump(&g, way, way);
    jump(&g, 0.3, 0.7);
    if (way < 1e13 && (g.r.flags & STIC_FLAG_NO_ANSWER))
      fail_msg("no answer on the way back from %g", way);
    rig_end(&g);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(start_in_a_tight_slot),
    cmocka_unit_test(jumps_out_and_back),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

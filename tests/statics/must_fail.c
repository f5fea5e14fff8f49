/* Must fail: shows that a failed check in this harness is a failed test. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "rig.h"

/* A pressed edge holds up to mu_s N. Here it is claimed to slip before. */
static void claims_a_slip_that_is_none(void **state)
{
  (void)state;
  rig g;
  rig_init(&g, 200, 0.5);
  stic_scene_set_box(&g.scene, 0.16, 0.08);
  rig_surface(&g, 0, 0, 90, 0.5, 0.3);
  rig_pose(&g, 0, 0.04, 0);
  rig_start(&g);
  rig_to(&g, 0, 0.03, 0);
  rig_to(&g, 0.004, 0.03, 0);
  int64_t slips = g.r.slips;
  rig_end(&g);
  assert_int_equal(slips, 1);
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(claims_a_slip_that_is_none)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}

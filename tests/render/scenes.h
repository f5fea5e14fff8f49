/* Hand-made scenes and results for tests of pictures: no solver is involved. */
#ifndef STIC_TEST_SCENES_H
#define STIC_TEST_SCENES_H

#include "stiction.h"

/* A 0.16 m x 0.08 m box over a floor, with a wall on the left if wanted. */
void stic_test_scene(stic_scene *scene, bool wall);

/* The box flat on the floor at x, pressed 2 cm, friction `share` of its limit (-1..1) at both corners. */
void stic_test_edge(stic_result *result, int64_t t_ns, double x, double share);

/* The box leaning between floor and wall at an angle (rad). */
void stic_test_two_vertex(stic_result *result, int64_t t_ns, double angle);

/* The box in the air, held but touching nothing. */
void stic_test_free(stic_result *result, int64_t t_ns, double x, double y, double angle);

#endif

/* Solver against oracle on random scenes and hand paths. Usage: compare frame|event SEED COUNT [-v] */
#include <stdio.h>
#include <stdlib.h>

#include "oracle.h"
#include "random_scene.h"

static void to_oracle(const stic_scene *s, orc_scene *o) {
  memset(o, 0, sizeof *o);
  o->nv = s->vertex_count;
  for (int i = 0; i < o->nv; i++) o->v[i][0] = s->vertices[i][0], o->v[i][1] = s->vertices[i][1];
  o->k_p = s->stiffness, o->k_theta = s->rotational_stiffness;
  o->hold[0] = s->holding_point[0], o->hold[1] = s->holding_point[1];
  o->ns = s->surface_count;
  for (int i = 0; i < o->ns; i++) {
    o->s[i].point[0] = s->surfaces[i].point[0], o->s[i].point[1] = s->surfaces[i].point[1];
    stic_normal_from_degrees(s->surfaces[i].normal_deg, o->s[i].normal);
    o->s[i].mu_s = s->surfaces[i].friction.mu_static, o->s[i].mu_d = s->surfaces[i].friction.mu_dynamic;
  }
}

int main(int argc, char **argv) {
  if (argc < 4) return 2;
  int event = !strcmp(argv[1], "event"), verbose = argc > 4;
  unsigned long seed0 = strtoul(argv[2], 0, 10), count = strtoul(argv[3], 0, 10);
  unsigned covered = 0;
  if (getenv("ORC_STEP")) orc_step_factor = atof(getenv("ORC_STEP"));
  long frames = 0, bad_cases = 0, flow = 0, noanswer = 0, limits = 0;
  double worst = 0;
  for (unsigned long seed = seed0; seed < seed0 + count; seed++) {
    random_case c;
    random_case_init(&c, seed);
    stic_settings settings;
    stic_settings_init(&settings);
    settings.level = event ? STIC_LEVEL_EVENT : STIC_LEVEL_FRAME;
    stic_sim *sim;
    stic_error err;
    if (stic_sim_create(&c.scene, &settings, &sim, &err)) { printf("seed %lu: %s\n", seed, err.message); continue; }
    orc_scene os;
    orc_state state;
    orc_report rep = {0};
    to_oracle(&c.scene, &os);
    orc_init(&os, &state, c.scene.x, c.scene.y, c.scene.angle);
    rng r = {seed + 77};
    double px = 0, py = 0, pphi = 0;
    for (int i = 0; i < 30; i++) {
      if (i) random_case_move(&c, &r);
      stic_sample sample = {(int64_t)i * 32258065, {c.x, c.y, 0}, {0, 0, sin(c.phi / 2), cos(c.phi / 2)}, 1, false};
      stic_result res;
      stic_sim_step(sim, &sample, &res);
      double phi = res.hand_theta;
      rep.rules = 0;
      int flow0 = rep.flow_stages;
      double before[3] = {state.x, state.y, state.theta};
      int nc0 = state.nc; orc_contact cc0[4]; for (int k = 0; k < nc0 && k < 4; k++) cc0[k] = state.c[k];
      if (i == 0 || !event) orc_relax(&os, &state, c.x, c.y, phi, &rep);
      else orc_move_event(&os, &state, px, py, pphi, c.x, c.y, phi, &rep);
      covered |= rep.rules;
      frames++;
      double e = fmax(fabs(res.x - state.x), fmax(fabs(res.y - state.y), fabs(res.theta - state.theta) * 0.1)) / stic_scene_size(&c.scene);
      if (rep.flow_stages > flow0) { flow++; }
      noanswer += (res.flags & STIC_FLAG_NO_ANSWER) != 0;
      limits += (res.flags & STIC_FLAG_LIMIT) != 0;
      if ((res.flags & STIC_FLAG_LIMIT) && verbose) printf("limit: seed %lu frame %d oracle limit %d stages\n", seed, i, rep.limit);
      if (e > (event ? 1e-7 : 1e-9) || state.nc != res.contact_count) {
        bad_cases++;
        if (verbose) {
          printf("seed %lu frame %d kind %d err %.3g flags %u rules %x state %s nc %d/%d flow %d\n", seed, i, c.kind, e, res.flags, rep.rules, stic_state_name(res.state), res.contact_count, state.nc, rep.flow_stages - flow0);
          printf("   hand %.9g %.9g %.9g -> %.9g %.9g %.9g\n", px, py, pphi, c.x, c.y, phi);
          printf("   before %.9g %.9g %.9g", before[0], before[1], before[2]);
          for (int k = 0; k < nc0; k++) printf(" [v%d s%d]", cc0[k].vertex, cc0[k].surface);
          printf("\n   oracle %.9g %.9g %.9g", state.x, state.y, state.theta);
          for (int k = 0; k < state.nc; k++) printf(" [v%d s%d %.6g %.6g]", state.c[k].vertex, state.c[k].surface, state.c[k].place[0], state.c[k].place[1]);
          printf("\n   solver %.9g %.9g %.9g", res.x, res.y, res.theta);
          for (int k = 0; k < res.contact_count; k++) printf(" [v%d s%d %.6g %.6g N %.4g T %.4g]", res.contacts[k].vertex, res.contacts[k].surface, res.contacts[k].x, res.contacts[k].y, res.contacts[k].normal, res.contacts[k].friction);
          int n; const stic_event *ev = stic_sim_events(sim, &n);
          printf("\n   events:");
          for (int k = 0; k < n && k < 12; k++) printf(" %s v%d s%d %.4g @%.6f;", stic_event_name(ev[k].kind), ev[k].vertex, ev[k].surface, ev[k].length, (ev[k].t*1e9 - (i-1)*32258065.)/32258065.);
          printf("  slips %lld/%d\n", (long long)res.slips, rep.slips);
        }
        break;
      }
      worst = fmax(worst, e);
      px = c.x, py = c.y, pphi = phi;
    }
    stic_sim_destroy(sim);
  }
  printf("%s: %lu cases, %ld frames, %ld cases differ, worst agreeing %.3g, oracle flow in %ld frames, rules %x, no answer %ld, limit %ld\n",
         argv[1], count, frames, bad_cases, worst, flow, covered, noanswer, limits);
  return bad_cases != 0;
}

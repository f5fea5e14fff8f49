/* The maker of plots, apart: a plot is another thing to pictures. */
#include "../../src/io/log_csv.h"
#include "../../src/io/outfile.h"
#include "../files/help.h"
#include "makers.h"
#include "plot.h"

static const char *path;

static void set_up(void)
{
  const stic_settings settings = {.level = STIC_LEVEL_EVENT, .precision = STIC_F64};
  const stic_provenance provenance = {"scene.yaml", "trace", "hand.csv", NULL, &settings, NULL, 0};
  stic_result row = {.state = STIC_FREE};
  stic_outfile *out;

  path = stic_test_path("plot.log");
  assert_int_equal(stic_outfile_open(path, &out, NULL), STIC_OK);
  stic_log_begin(out, &provenance);
  for (int i = 0; i < 10; i++, row.t_ns += 10000000)
    stic_log_row(out, &row);
  assert_int_equal(stic_outfile_commit(out, NULL), STIC_OK);
}

static void tear_down(void)
{
}

MAKE(plot, stic_plot_read, stic_plot, stic_plot_destroy, path)

static const maker makers[] = {
  {"stic_plot_read", "", make_plot, end_plot},
  {NULL, NULL, NULL, NULL},
};

const maker_group plot_makers = {set_up, tear_down, makers};

/* The script and the data of one figure. Internal to the plots. */
#ifndef STIC_FIGURE_H
#define STIC_FIGURE_H

#include "../../src/io/outfile.h"
#include "plot_log.h"

/* A figure of the rows [from, to) of a log. */
typedef struct stic_figure {
  const stic_plot *plot;
  int number;
  int64_t from, to;
  const char *stem;  /* of the names of data and picture, for the script */
  bool *jump, *keep; /* work space of to - from each */
  double *values;
} stic_figure;

/* Curves in blocks, each thinned for itself. */
void stic_figure_data(const stic_figure *figure, stic_outfile *out);
/* Draws them; `format` in gnuplot is svg, pdf or png. */
void stic_figure_script(const stic_figure *figure, stic_outfile *out);

#endif

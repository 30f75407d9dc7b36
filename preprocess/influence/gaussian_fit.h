/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Range, noise and deviation of a Gaussian process from readings: those that make them most probable by the restricted likelihood (the
   mean of each body at each instant is unknown; Patterson & Thompson, 1971). Instants count as independent. Thread: one. */
#ifndef PREPROCESS_INFLUENCE_GAUSSIAN_FIT_H
#define PREPROCESS_INFLUENCE_GAUSSIAN_FIT_H
#include "preprocess/influence/gaussian.h"

struct readings_table {     /* instants without a gap */
    size_t count, instants; /* sensors */
    double *values;         /* [instant][sensor] */
    size_t left_out;        /* instants of which some sensor has no number */
};

/* Reads a CSV file: a header line with names, of which those of the `count` sensors are taken; then a line for each instant. Returns false
   with the reason in why: file, line and name. The caller calls readings_table_finish() in both cases. */
bool readings_table_read(struct readings_table *table, const char *path, const char *const *names, size_t count, char why[300]);
void readings_table_finish(struct readings_table *table);

/* Replaces what is NaN in *params; range_m is sought between least_m and most_m. Returns false if that fails, with the reason in why. */
bool gaussian_fit(struct gaussian_params *params, struct log *log, struct workers *workers, const struct influence_mesh *mesh,
                  const struct readings_table *table, double least_m, double most_m, char why[300]);

#endif

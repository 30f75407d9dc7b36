/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fits range, noise and deviation of a Gaussian process to readings. Uses maximum restricted likelihood (Patterson & Thompson,
 * 1971), because the mean of each body at each instant is unknown. Treats instants as independent. Call from one thread only.
 * */
#ifndef PREPROCESS_INFLUENCE_GAUSSIAN_FIT_H
#define PREPROCESS_INFLUENCE_GAUSSIAN_FIT_H
#include "preprocess/influence/gaussian.h"

struct readings_table {     /* readings, only of instants at which every sensor has one */
    size_t count, instants; /* count: number of sensors; instants: number of instants */
    double *values;         /* readings, [instant][sensor] */
    size_t left_out;        /* number of instants left out because a sensor has no reading */
};

/* Reads a CSV file of readings: a header line of names, then one line of readings per instant; uses only the columns of the
 * `count` named sensors. Returns false with file, line and name in why. In either case, call readings_table_finish(). */
bool readings_table_read(struct readings_table *table, const char *path, const char *const *names, size_t count, char why[300]);
void readings_table_finish(struct readings_table *table);

struct gaussian_data { /* readings of the sensors, and the mesh of the surface that the sensors are on */
    struct log *log;
    struct workers *workers;
    const struct influence_mesh *mesh;
    const struct readings_table *table;
};

/* Replaces NaN members of *params by fitted values; searches range_m between least_m and most_m. Returns false with the reason in why. */
bool gaussian_fit(struct gaussian_params *params, const struct gaussian_data *data, double least_m, double most_m, char why[300]);

#endif

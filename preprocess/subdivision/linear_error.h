/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear interpolation error: how wrong a triangle or edge can be that interpolates the field linearly between its corners. For any
 * readings (within MIN and MAX), a value is the sum of readings times interpolation weights. So the largest error at a point, as a share of
 * the range, is a sum over sensors: of the amounts by which weights exceed their linear interpolation, or of those by which weights fall
 * below it, the larger sum. The maximum is taken over all groups with sensors on the asset, both interpolations and both kinds of distance,
 * with the plant file's parameters. Sensors with an assumed position are ignored: they show nothing, or colour the whole asset evenly.
 * Groups whose field each pixel evaluates (plant/exact.h) are ignored too.
 * Where no sensor of a group reaches, there is no data, and the nearest sensor's value is continued. Thread: any, once initialised. */
#ifndef PREPROCESS_SUBDIVISION_LINEAR_ERROR_H
#define PREPROCESS_SUBDIVISION_LINEAR_ERROR_H
#include "plant/plant.h"
#include "plant/sensors.h"
#include "preprocess/subdivision/interp_weights.h"

struct linear_error_group {
    uint32_t *columns; /* the group's sensors as columns of the asset */
    bool in_a_row;     /* the columns are consecutive */
    bool papers;       /* errors of Algorithm 1 (paper) are included */
    size_t count;
    double radius_m[2];     /* radius R of Algorithm 1, by distance mode */
    struct interp_group of; /* parameters of the group's sensors, padded */
};

struct linear_error {
    struct linear_error_group *groups;
    size_t group_count, sensor_count, share_count;
    size_t most_count; /* padded sensor count of the largest group */
    float *axes_m[3];  /* x, y and z of the sensors' positions on the surface, by column, padded */
};

/* Returns whether errors of Algorithm 1 are included for a group with this many sensors on an asset. */
bool straight_looks_at_paper(const struct plant_group *group, size_t sensor_count);

/* Prepares the error measure for a plant's groups and an asset's sensors, whose positions on the surface are places_m (copied). Radii that
 * the plant file does not state must be set with linear_error_set_radius(). Finish with linear_error_finish(). */
void linear_error_init(struct linear_error *linear, const struct plant *plant, const struct plant_sensor *sensors, size_t sensor_count,
                       const float (*places_m)[3]);
/* Frees the arrays. */
void linear_error_finish(struct linear_error *linear);
/* Sets the radii of Algorithm 1 that the plant file does not state. largest_m[mode][column]: each sensor's largest distance over all
 * vertices. */
void linear_error_set_radius(struct linear_error *linear, const float *const largest_m[2]);

/* Returns the length of a sample (linear_error_weights()). */
size_t linear_error_sample_count(const struct linear_error *linear);
/* Computes a sample at a point: the sensors' interpolation weights for geodesic and then for straight-line distances, group by group,
 * Shepard's and then Algorithm 1's. In the same order follow the largest changes of a value per metre (0 for Shepard without `slopes`).
 * geodesic_m: by sensor column; INFINITY: not connected. norms: receives two normalisations per group. */
void linear_error_weights(const struct linear_error *linear, const float point_m[3], const float *geodesic_m, bool slopes, float *interp,
                          struct interp_norm *norms);
/* Computes only the normalisations of a sample. */
void linear_error_norms(const struct linear_error *linear, const float point_m[3], const float *geodesic_m, struct interp_norm *norms);
/* Computes the weights of a sample from its normalisations, which is faster unless Algorithm 1 is used. Does not write the changes per
 * metre. */
void linear_error_weights_again(const struct linear_error *linear, const float point_m[3], const float *geodesic_m,
                                const struct interp_norm *norms, float *interp);
/* Returns, from a sample's normalisations, a lower bound of the distance in metres to the nearest point where a group's data ends, because
 * all its sensors are out of reach. Where the reaches of two sensors end at the same point, the field has a peak. */
double linear_error_rim_of(const struct linear_error *linear, const struct interp_norm *norms);
/* Returns, from a sample's normalisations, the distance in metres to the nearest sensor (straight line) or to the nearest point where a
 * group's data ends, the shorter distance. */
double linear_error_nearest_of(const struct linear_error *linear, const struct interp_norm *norms);
/* Return the error of a sample, as a share of the range: linear_error_on_edge() compares with the linear interpolation at fraction t
 * between the samples at the edge's ends, linear_error_in_triangle() with the interpolation of three corners by these weights. modes: kinds
 * of distance to include. The change of the value within slack_m, at most one colour step, is subtracted. Outside a group's data, farther
 * than wide_m from its end, the error is 0; nearer, the wrong values would bleed into the data across so wide an edge or triangle. */
enum linear_error_modes {
    LINEAR_ERROR_GEODESIC = 1 << DISTANCE_GEODESIC,
    LINEAR_ERROR_EUCLIDEAN = 1 << DISTANCE_EUCLIDEAN,
    LINEAR_ERROR_BOTH = 3
};
double linear_error_on_edge(const struct linear_error *linear, enum linear_error_modes modes, const float *a, const float *b, double t,
                            const float *between, double wide_m, double slack_m);
double linear_error_in_triangle(const struct linear_error *linear, enum linear_error_modes modes, const float *const corners[3],
                                const double weights[3], const float *inside, double wide_m, double slack_m);
/* Returns the straight-line distance in metres from the point to the nearest sensor. */
double linear_error_nearest(const struct linear_error *linear, const float point_m[3]);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear interpolation error: by how much a triangle or edge that interpolates the field linearly between its corners can be wrong.

   Whatever the readings (within MIN and MAX), a value is the sum of readings times the sensors' interpolation weights. So the largest
   error at a point between two others is the sum of the weights that are larger than interpolation says, or of those that are smaller, in
   parts of the range. It is taken over every group with sensors on the asset, both interpolations and both kinds of distance, with the
   plant file's parameters.

   Sensors whose place is assumed are left out: they paint nothing, or all of the asset evenly.
   Where no sensor of a group reaches, there is no data, and the nearest sensor's value is carried on. Thread: any, once initialised. */
#ifndef PREPROCESS_SUBDIVISION_LINEAR_ERROR_H
#define PREPROCESS_SUBDIVISION_LINEAR_ERROR_H
#include "plant/plant.h"
#include "plant/sensors.h"
#include "preprocess/subdivision/interp_weights.h"

struct linear_error_group {
    uint32_t *columns; /* of the asset's sensors */
    bool in_a_row;     /* columns follow one another */
    bool papers;       /* paper is looked at */
    size_t count;
    double radius_m[2];     /* paper's R, by distance_mode */
    struct interp_group of; /* its sensors', padded */
};

struct linear_error {
    struct linear_error_group *groups;
    size_t group_count, sensor_count, share_count;
    size_t most_count; /* sensors of the largest group, padded */
    float *axes_m[3];  /* of the sensors' places on the surface, by column, padded */
};

/* Tells whether a group with so many sensors on an asset is looked at in paper, too. */
bool straight_looks_at_paper(const struct plant_group *group, size_t sensor_count);

/* Prepares the error measure for a plant's groups and an asset's sensors, whose positions on the surface are places_m (copied). Radii that
   the plant file leaves open must be set by linear_error_set_radius(). Finish with linear_error_finish(). */
void linear_error_init(struct linear_error *linear, const struct plant *plant, const struct plant_sensor *sensors, size_t sensor_count,
                       const float (*places_m)[3]);
/* Frees the arrays. */
void linear_error_finish(struct linear_error *linear);
/* Sets the radii of Algorithm 1 that the plant file leaves open. largest_m[mode][column]: each sensor's largest distance over all
   vertices. */
void linear_error_set_radius(struct linear_error *linear, const float *const largest_m[2]);

/* Returns how many numbers one sample (linear_error_weights()) has. */
size_t linear_error_sample_count(const struct linear_error *linear);
/* Computes a sample at a point: the sensors' interpolation weights for geodesic and then for straight-line distances, group by group,
   Shepard's and then Algorithm 1's; then, in that order, the largest change of a value per metre (0 for Shepard without `slopes`).
   geodesic_m: by sensor column; INFINITY: not connected. norms: receives two normalisations per group. */
void linear_error_weights(const struct linear_error *linear, const float point_m[3], const float *geodesic_m, bool slopes, float *interp,
                          struct interp_norm *norms);
/* Computes only the normalisations of a sample. */
void linear_error_norms(const struct linear_error *linear, const float point_m[3], const float *geodesic_m, struct interp_norm *norms);
/* Computes the sample's weights, given its normalisations, in less time where Algorithm 1 is not used; the changes per metre are not
   written. */
void linear_error_weights_again(const struct linear_error *linear, const float point_m[3], const float *geodesic_m,
                                const struct interp_norm *norms, float *interp);
/* Returns, from a sample's normalisations, a lower bound of the distance in metres to where some group's data end. Where the reaches of two
   sensors end at once, the field has a peak. */
double linear_error_rim_of(const struct linear_error *linear, const struct interp_norm *norms);
/* Returns, from a sample's normalisations, the distance in metres to the nearest sensor (straight line) or to where data end, whichever is
   less. */
double linear_error_nearest_of(const struct linear_error *linear, const struct interp_norm *norms);
/* Errors in parts of the range: a sample at a point against the line between two others, at fraction t; against the plane
   through three corners, with these weights.
   modes: on which distances. Less what a value may change over slack_m, up to one step of colour. Farther than wide_m from where a group
   has data, it does not err; nearer, what is shown there goes into what is shown of the data, if the edge or triangle is so wide. */
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

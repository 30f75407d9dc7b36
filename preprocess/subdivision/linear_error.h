/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear interpolation error: how wrong a triangle or edge can be if it interpolates the field linearly between its corners. A
 * value is the sum of readings times interpolation weights, for any readings within MIN and MAX. The error at a point, as a
 * share of the range, is therefore the larger of two sums over sensors: the amounts by which weights exceed their linear
 * interpolation, and the amounts by which they fall below it. The result is the maximum over all groups with sensors on the
 * asset, over both interpolations (Shepard, and Algorithm 1 of Kim & Suh, `paper` in PLANT.md), and over geodesic and
 * straight-line distances. Parameters come from the plant file. Ignored are sensors with an assumed position, which show
 * nothing or colour the whole asset evenly, and groups whose field is evaluated at each pixel (plant/exact.h). Out of reach of
 * all its sensors, a group has no data, and the nearest sensor's value is continued. Call from any thread, once initialised. */
#ifndef PREPROCESS_SUBDIVISION_LINEAR_ERROR_H
#define PREPROCESS_SUBDIVISION_LINEAR_ERROR_H
#include "plant/plant.h"
#include "plant/sensors.h"
#include "preprocess/subdivision/interp_weights.h"

struct linear_error_group {
    uint32_t *columns; /* the sensors' indices in the list of the asset's sensors (columns) */
    bool in_a_row;     /* true: `columns` are consecutive numbers */
    bool papers;       /* true: include errors of Algorithm 1 (Kim & Suh) */
    size_t count;
    double radius_m[2];     /* radius R of Algorithm 1, by enum distance_mode (geodesic, Euclidean) */
    struct interp_group of; /* interpolation parameters of the group's sensors, padded to INTERP_LANES */
};

struct linear_error {
    struct linear_error_group *groups;
    size_t group_count, sensor_count, share_count;
    size_t most_count; /* sensor count of the largest group, padded to INTERP_LANES */
    /* x, y and z of the sensors' positions on the surface, as three arrays by sensor of the asset, padded to INTERP_LANES */
    float *axes_m[3];
};

/* Prepares to measure interpolation errors for a plant's groups and an asset's sensors. places_m: positions of the sensors on
 * the surface; copied. Set radii that the plant file omits with linear_error_set_radius(). Finish with linear_error_finish().
 * */
void linear_error_init(struct linear_error *linear, const struct plant *plant, const struct plant_sensor *sensors, size_t sensor_count,
                       const float (*places_m)[3]);
/* Frees the arrays. */
void linear_error_finish(struct linear_error *linear);
/* Sets the radii of Algorithm 1 that the plant file omits. largest_m[mode][sensor]: largest distance of any vertex from the
 * sensor, by enum distance_mode. */
void linear_error_set_radius(struct linear_error *linear, const float *const largest_m[2]);

/* Returns the number of floats in a sample: the weights and their changes per metre at one point, as written by linear_error_weights(). */
size_t linear_error_sample_count(const struct linear_error *linear);
/* Computes a sample at a point. It begins with the sensors' interpolation weights for geodesic distances, then for
 * straight-line distances. Each set is sorted by group; a group has its Shepard weights, followed by those of Algorithm 1 if
 * included. Then, in the same order, come the largest changes of the interpolated value per metre (0 for Shepard without
 * `slopes`). geodesic_m: by sensor; INFINITY: no path. norms: receives two normalisations per group (geodesic, straight-line).
 * */
void linear_error_weights(const struct linear_error *linear, const float point_m[3], const float *geodesic_m, bool slopes, float *interp,
                          struct interp_norm *norms);
/* Computes only the normalisations (sums of relative weights), as linear_error_weights() writes them to norms. */
void linear_error_norms(const struct linear_error *linear, const float point_m[3], const float *geodesic_m, struct interp_norm *norms);
/* Computes the weights of a sample from its normalisations (linear_error_norms()). Faster than linear_error_weights(), except in groups
 * with Algorithm 1. Does not write the changes per metre. */
void linear_error_weights_again(const struct linear_error *linear, const float point_m[3], const float *geodesic_m,
                                const struct interp_norm *norms, float *interp);
/* Computes, from what linear_error_norms() wrote for a point, the distance to the nearest point where a group's data ends,
   because all its sensors are farther away than the group's reach (maximum distance of influence). Returns a lower bound in
   metres. The interpolated value may peak there, so edges near such a point must be short. */
double linear_error_rim_of(const struct linear_error *linear, const struct interp_norm *norms);
/* Returns, from what linear_error_norms() wrote for a point, the smaller of two lengths in metres: the distance to the nearest sensor,
   shorter in proportion to the power of its group above 2, and the bound that linear_error_rim_of() returns. */
double linear_error_nearest_of(const struct linear_error *linear, const struct interp_norm *norms);
/* Return the interpolation error at a point whose sample is `between` or `inside`, as a share of the range.
   linear_error_on_edge() compares it with the linear interpolation at fraction t between the samples of the edge's ends;
   linear_error_in_triangle() with three corners' samples interpolated by `weights`. modes: kinds of distance to include.
   slack_m: the drawn point may be this far from the right one, so the change of the value over that distance (at most one
   colour step) is subtracted from the error. wide_m: about the size of the edge or triangle. At points outside the area where a
   group has data, the error counts only up to the distance wide_m from that area, because the edge or triangle may reach into
   it; farther away the error is 0. */
enum linear_error_modes {
    LINEAR_ERROR_GEODESIC = 1 << DISTANCE_GEODESIC,
    LINEAR_ERROR_EUCLIDEAN = 1 << DISTANCE_EUCLIDEAN,
    LINEAR_ERROR_BOTH = 3
};
double linear_error_on_edge(const struct linear_error *linear, enum linear_error_modes modes, const float *const ends[2], double t,
                            const float *between, double wide_m, double slack_m);
double linear_error_in_triangle(const struct linear_error *linear, enum linear_error_modes modes, const float *const corners[3],
                                const double weights[3], const float *inside, double wide_m, double slack_m);
/* Returns the straight-line distance in metres from the point to the nearest sensor of any group, shorter in proportion to the largest
   power of a group above 2. Weights change over lengths that are proportional to the result. */
double linear_error_nearest(const struct linear_error *linear, const float point_m[3]);

#endif

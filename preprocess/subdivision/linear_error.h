/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far the field between two points is from a straight line: what a triangle's edge would show wrongly.

   Whatever the readings (within MIN and MAX), a value is the sum of readings times the sensors' shares there. So the worst error at a point
   between two others is the sum of the shares that are larger than the line says, or of those that are smaller, in parts of the range. It
   is looked for over every group with sensors on the asset, in both interpolations and on both distances, with the parameters that the
   plant file gives. Where a group has a single sensor, paper is looked at only if plant_cuts_singles says so: by shepard its field is
   constant.

   Where no sensor of a group reaches, there is no data, and the nearest's value is carried on. */
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

/* places_m: of the sensors, on the surface. Radii that the plant file leaves open are to be set by linear_error_set_radius. */
void linear_error_init(struct linear_error *linear, const struct plant *plant, const struct plant_sensor *sensors, size_t sensor_count,
                       const float (*places_m)[3]);
void linear_error_finish(struct linear_error *linear);
/* largest_m[mode][column]: of each sensor over all vertices. */
void linear_error_set_radius(struct linear_error *linear, const float *const largest_m[2]);

/* The sensors' shares at a point: share_count numbers, for geodesic distances and then for straight ones: group by group, shepard's and
   then paper's (of groups with few sensors). Then, in that order, the most that a value may change there over a metre. geodesic_m: by
   column; INFINITY: not reached. */
size_t linear_error_sample_count(const struct linear_error *linear); /* numbers that linear_error_weights makes */
/* norms: two of each group, for geodesic distances and then for straight ones. Without `slopes` what shepard may change is left 0. */
void linear_error_weights(const struct linear_error *linear, const float point_m[3], const float *geodesic_m, bool slopes, float *interp,
                          struct interp_norm *norms);
void linear_error_norms(const struct linear_error *linear, const float point_m[3], const float *geodesic_m, struct interp_norm *norms);
/* The same shares, in less time where paper is not looked at; nothing after them. */
void linear_error_weights_again(const struct linear_error *linear, const float point_m[3], const float *geodesic_m,
                                const struct interp_norm *norms, float *interp);
/* From norms: metres to where a group's data end, at least. Where reaches of two sensors end at once, its field peaks. */
double linear_error_rim_of(const struct linear_error *linear, const struct interp_norm *norms);
/* And metres to the nearest sensor, as the crow flies, or to there, whichever is less. */
double linear_error_nearest_of(const struct linear_error *linear, const struct interp_norm *norms);
/* In parts of the range: samples at a point against a line between two others, at share t of the way; against the plane
   through three corners, with these weights.
   modes: on which distances. Less what a value may change over slack_m, up to two steps of colour. Farther than wide_m from where a group
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
/* Metres from the point to the nearest sensor, as the crow flies. */
double linear_error_nearest(const struct linear_error *linear, const float point_m[3]);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far the field between two points is from a straight line: what a triangle's edge would show wrongly.

   Whatever the readings (within MIN and MAX), a value is the sum of readings times the sensors' shares there. So the worst error at a point
   between two others is the sum of the shares that are larger than the line says, or of those that are smaller, in parts of the range. It
   is looked for over every group with sensors on the asset, in both interpolations and on both distances, with the parameters that the
   plant file gives. Where a group has a single sensor, paper is looked at only if plant_cuts_singles says so: by shepard its field is
   constant.

   Where no sensor of a group reaches, there is no data, and the nearest's value is carried on. */
#ifndef PREPROCESS_STRAIGHT_H
#define PREPROCESS_STRAIGHT_H
#include "plant/plant.h"
#include "plant/sensors.h"
#include "preprocess/shares.h"

struct straight_group {
    uint32_t *columns; /* of the asset's sensors */
    bool in_a_row;     /* columns follow one another */
    bool papers;       /* paper is looked at */
    size_t count;
    double radius_m[2]; /* paper's R, by distance_mode */
    struct shares_group of; /* its sensors', padded */
};

struct straight {
    struct straight_group *groups;
    size_t group_count, sensor_count, share_count;
    size_t most_count;    /* sensors of the largest group, padded */
    float *axes_m[3];     /* of the sensors' places on the surface, by column, padded */
};

/* Tells whether a group with so many sensors on an asset is looked at in paper, too. */
bool straight_looks_at_paper(const struct plant_group *group, size_t sensor_count);

/* places_m: of the sensors, on the surface. Radii that the plant file leaves open are to be set by straight_set_radius. */
void straight_init(struct straight *straight, const struct plant *plant, const struct plant_sensor *sensors, size_t sensor_count,
                   const float (*places_m)[3]);
void straight_finish(struct straight *straight);
/* largest_m[mode][column]: of each sensor over all vertices. */
void straight_set_radius(struct straight *straight, const float *const largest_m[2]);

/* The sensors' shares at a point: share_count numbers, for geodesic distances and then for straight ones: group by group, shepard's and
   then paper's (of groups with few sensors). Then, in that order, the most that a value may change there over a metre. geodesic_m: by
   column; INFINITY: not reached. */
size_t straight_sample_count(const struct straight *straight); /* numbers that straight_shares makes */
/* norms: two of each group, for geodesic distances and then for straight ones. Without `slopes` what shepard may change is left 0. */
void straight_shares(const struct straight *straight, const float point_m[3], const float *geodesic_m, bool slopes, float *shares,
                     struct shares_norm *norms);
void straight_norms(const struct straight *straight, const float point_m[3], const float *geodesic_m, struct shares_norm *norms);
/* The same shares, in less time where paper is not looked at; nothing after them. */
void straight_shares_again(const struct straight *straight, const float point_m[3], const float *geodesic_m,
                           const struct shares_norm *norms, float *shares);
/* From norms: metres to where a group's data end, at least. Where reaches of two sensors end at once, its field peaks. */
double straight_rim_of(const struct straight *straight, const struct shares_norm *norms);
/* And metres to the nearest sensor, as the crow flies, or to there, whichever is less. */
double straight_nearest_of(const struct straight *straight, const struct shares_norm *norms);
/* In parts of the range: samples at a point against a line between two others, at share t of the way; against the plane
   through three corners, with these weights.
   modes: on which distances. Less what a value may change over slack_m, up to two steps of colour. Farther than wide_m from where a group
   has data, it does not err; nearer, what is shown there goes into what is shown of the data, if the edge or triangle is so wide. */
enum straight_modes { STRAIGHT_GEODESIC = 1 << DISTANCE_GEODESIC, STRAIGHT_EUCLIDEAN = 1 << DISTANCE_EUCLIDEAN, STRAIGHT_BOTH = 3 };
double straight_error(const struct straight *straight, enum straight_modes modes, const float *a, const float *b, double t,
                      const float *between, double wide_m, double slack_m);
double straight_error_inside(const struct straight *straight, enum straight_modes modes, const float *const corners[3],
                             const double weights[3], const float *inside, double wide_m, double slack_m);
/* Metres from the point to the nearest sensor, as the crow flies. */
double straight_nearest(const struct straight *straight, const float point_m[3]);

#endif

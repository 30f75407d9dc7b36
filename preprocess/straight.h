/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far the field between two points is from a straight line: what a triangle's edge would show wrongly.

   Whatever the readings (within MIN and MAX), a value is the sum of readings times the sensors' shares there. So the worst error at a point
   between two others is the sum of the shares that are larger than the line says, or of those that are smaller, in parts of the range. It
   is looked for over every group with sensors on the asset, in both interpolations and on both distances, with the parameters that the
   plant file gives.

   Some errors no cutting mends, and they do not count. A distance along a surface grows by no more than the way gone, which bounds
   the error on an edge of length h at distance D from the nearest sensor: power h / 2 D for shepard, (2 strength + decay) h / 2 R for
   paper. What is more is a jump: the two ends do not hang together. Below a fiftieth of D (of R) only kinks and the
   inexactness of distances are left. A sensor's limited reach is left aside: it makes a jump too. */
#ifndef PREPROCESS_STRAIGHT_H
#define PREPROCESS_STRAIGHT_H
#include "plant/plant.h"
#include "plant/sensors.h"

struct straight_group {
    uint32_t *columns; /* of the asset's sensors */
    size_t count;
    double power, radius_m[2]; /* paper's R, by distance_mode */
    double steepness;          /* paper: most change of a value over R */
};

struct straight {
    struct straight_group *groups;
    size_t group_count, sensor_count, share_count;
    double *strength, *decay;   /* by column */
    const float (*places_m)[3]; /* of the sensors, on the surface */
};

/* places_m must outlive it. Radii that the plant file leaves open are to be set by straight_set_radius. */
void straight_init(struct straight *straight, const struct plant *plant, const struct plant_sensor *sensors, size_t sensor_count,
                   const float (*places_m)[3]);
void straight_finish(struct straight *straight);
/* largest_m[mode][column]: of each sensor over all vertices. */
void straight_set_radius(struct straight *straight, const float *const largest_m[2]);

/* The sensors' shares at a point: share_count numbers, then near_count: metres to the nearest sensor, by mode and group. geodesic_m: by
   column; INFINITY: not reached. */
void straight_shares(const struct straight *straight, const float point_m[3], const float *geodesic_m, float *shares);
size_t straight_sample_count(const struct straight *straight); /* numbers that straight_shares makes */
/* In parts of the range, at share t of the way from a to b, which are length_m apart. `between` is used up. */
double straight_error(const struct straight *straight, const float *a, const float *b, double t, double length_m, float *between);
/* The same at the middle of a triangle whose longest edge is length_m. */
double straight_error_inside(const struct straight *straight, const float *const corners[3], double length_m, float *inside);
/* Metres from the point to the nearest sensor, as the crow flies. */
double straight_nearest(const struct straight *straight, const float point_m[3]);
/* Edges up to this length have no error that counts, at that distance from the nearest sensor. */
double straight_finest(const struct straight *straight, double nearest_m);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sensor coverage: how far the points of an asset's surface are from its sensors, and how much of the area no usable sensor
   covers. Considers all points of the surface, also those inside large triangles: distances there follow from those of the
   vertices by the field's definition (layout_distances() in field/layout.h). No input or output. Call from any thread. */
#ifndef PLACING_SENSOR_COVERAGE_H
#define PLACING_SENSOR_COVERAGE_H
#include "field/layout.h"

struct sensor_coverage_query {
    const struct scene *scene;
    /* trial (set of sensor positions that a user tries out) that moves some of the sensors; NULL: all sensors are where the
       plant file has them */
    const struct trial *trial;
    int asset, group;
    enum distance_mode mode;
    double reach_m; /* a sensor farther than this from a point does not cover it, in metres; INFINITY: no limit */
    /* metres; a point at least this far from all sensors counts as far. 0: half of reach_m or, without a limit, a fifth of the asset's
       size */
    double far_m;
    long work;           /* maximum number of evaluations of a sensor's distances inside faces; 0: 4 million, about half a second */
    const uint8_t *good; /* [tag]: 1: the tag's reading is usable now; 0: it is not */
};

struct sensor_coverage {
    size_t sensors; /* number of the group's sensors that affect the asset's field */
    bool assumed;   /* true: the positions of all sensors are assumed, so the members below are not computed */
    double far_m; /* distance in metres from which points count as far: query->far_m or, if that is 0, the default */
    /* distance in metres between the surface point that is farthest from all sensors and its nearest sensor; ignores points
       that no path along the surface connects with a sensor */
    double farthest_m;
    double farthest_at_m[3]; /* position of the farthest surface point, in plant coordinates */
    /* no point is farther than farthest_m + farthest_error_m, in metres: 0.01 % of farthest_m, more if the work limit was reached */
    double farthest_error_m;
    /* fraction of the surface's area that counts as far (far_m), 0..1. Its border consists of straight lines of at most far_m / 8
       around a sensor, and of a thousandth of the asset's size where sensors meet */
    double far_share;
    double lost_share;       /* fraction of the area that no sensor reaches, or whose nearest sensor has no usable reading */
    double unsure_share;     /* fraction of the area that was not examined as finely, because the work limit was reached; usually 0 */
    double next_m;           /* largest distance in metres between a sensor and its nearest other sensor; 0: there is only one sensor */
    int next_tags[2];        /* indices of the tags of the two sensors that are next_m apart; -1: none */
};

/* Computes the coverage of the asset by the group's sensors into *out. Sensors that have no effect on the field
   (layout_remove_ineffective() in field/layout.h) do not count. Returns false if the asset has no other sensor of the group, or
   memory ran out. */
bool sensor_coverage_find(const struct sensor_coverage_query *order, struct sensor_coverage *out);

#endif

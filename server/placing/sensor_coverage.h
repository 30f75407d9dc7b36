/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sensor coverage: how far an asset's surface is from its sensors, and how much of its area no usable sensor covers. Pure. Thread: any. */
#ifndef PLACING_SENSOR_COVERAGE_H
#define PLACING_SENSOR_COVERAGE_H
#include "field/layout.h"

struct sensor_coverage_query {
    const struct scene *scene;
    const struct trial *trial; /* places that are tried out; NULL: none */
    int asset, group;
    enum distance_mode mode;
    double reach_m;      /* INFINITY: no limit */
    double far_m;        /* farther than that from every sensor is far; 0: half of the reach, or a fifth of the asset's size */
    const uint8_t *good; /* by tag: its reading can be used now */
};

struct sensor_coverage {
    size_t sensors;
    double far_m;            /* as above */
    double farthest_m;       /* of the surface from the nearest sensor, as far as a way leads to one */
    double farthest_at_m[3]; /* plant frame */
    double far_share;        /* of the surface's area, 0..1 */
    double lost_share;       /* likewise: no sensor reaches it, or the nearest one's reading cannot be used now */
    double next_m;           /* the sensor that is farthest from its next one: how far; 0: there is only one */
    int next_tags[2];        /* which, and that one; -1: none */
};

/* Computes the coverage that the query asks for into *out. Returns false if no sensor of the group is on the asset. */
bool sensor_coverage_find(const struct sensor_coverage_query *order, struct sensor_coverage *out);

/* Returns the area that each vertex stands for, a third of each triangle of the finest level around it, in square metres. The caller frees
   it (mem_free). */
double *sensor_coverage_areas(const struct asset_view *view);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A plant for benchmarks: many instances of one model in a grid, each with its own sensors. It is written as files and really prepared. */
#ifndef TESTS_SUPPORT_CROWD_H
#define TESTS_SUPPORT_CROWD_H
#include <stdint.h>

#include "base/workers.h"
#include "scene/scene.h"
#include "value/snapshot.h"

struct crowd_params {
    const char *folder;       /* folder in which the plant is written and prepared; earlier results in it are reused */
    const char *model;        /* glTF or GLB file */
    const char *nodes, *up;   /* the model's nodes and its upward axis, as in a plant file; nodes NULL: the whole model */
    const char *keys;         /* further keys of the group in the plant file, such as "distance: euclidean"; NULL: none */
    int instances, sensors;   /* sensors: number on each instance, spread evenly over its surface */
};

struct sensor_crowd {
    struct plant *plant;
    struct scene *scene;
    struct snapshot *snapshot;
    uint64_t random;
};

/* On failure, logs the reason and returns false. Call crowd_finish() in both cases. */
bool crowd_init(struct sensor_crowd *crowd, struct log *log, struct workers *workers, const struct crowd_params *params);
void crowd_finish(struct sensor_crowd *crowd);
void crowd_change(struct sensor_crowd *crowd, int64_t mono_ns); /* changes every reading to another value within the range */

#endif

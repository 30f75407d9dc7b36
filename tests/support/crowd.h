/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A plant for benchmarks: many instances of one model in a grid, each with its own sensors. Its files are written to a folder
   and prepared like those of a real plant. */
#ifndef TESTS_SUPPORT_CROWD_H
#define TESTS_SUPPORT_CROWD_H
#include <stdint.h>

#include "base/workers.h"
#include "scene/scene.h"
#include "value/snapshot.h"

struct crowd_params {
    /* folder to which the plant is written and in which it is prepared; files that an earlier run prepared there are used again
       */
    const char *folder;
    const char *model;        /* glTF or GLB file */
    /* nodes of the model that form an instance, and the model's upward axis, as in a plant file; nodes NULL: the whole model */
    const char *nodes, *up;
    const char *keys;         /* further settings of the group in the plant file, such as "distance: euclidean"; NULL: none */
    int instances, sensors;   /* instances: number of copies of the model; sensors: number on each copy, spread evenly over its surface */
};

struct sensor_crowd {
    struct plant *plant;
    struct scene *scene;
    struct snapshot *snapshot;
    uint64_t random;
};

/* Writes, prepares and loads the plant. On failure, logs the reason and returns false. Call crowd_finish() in both cases. */
bool crowd_init(struct sensor_crowd *crowd, struct log *log, struct workers *workers, const struct crowd_params *params);
void crowd_finish(struct sensor_crowd *crowd);
/* gives every tag a new reading, dated mono_ns, that differs from its last one and lies within the range */
void crowd_change(struct sensor_crowd *crowd, int64_t mono_ns);

#endif

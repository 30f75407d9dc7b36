/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All assets of a plant: what is there already stays, the rest is built. */
#ifndef PREPROCESS_PREPARE_H
#define PREPROCESS_PREPARE_H
#include <stdio.h>

#include "base/diag.h"
#include "preprocess/build.h"

enum prepare_state { PREPARE_FAILED, PREPARE_UNCHANGED, PREPARE_SHARED, PREPARE_BUILT };

struct prepare_asset {
    const struct plant_asset *plant;
    struct plant_sensor *sensors;
    size_t sensor_count;
    float *surface_distances_m; /* of each sensor; NULL: failed */
    uint64_t key;
    enum prepare_state state;
    char *rebuilt_because; /* what was wrong with the file that was there, or NULL */
    uint32_t triangles, vertices;
    struct build_report report; /* where it was built */
    double seconds;
};

struct prepare {
    const struct plant *plant;
    struct prepare_asset *assets;
    size_t asset_count;
    size_t removed;
    double seconds;
};

struct prepare_params {
    const char *folder;
    const char *only; /* this asset alone; the manifest is left as it is. NULL: all */
    FILE *progress;   /* one line per asset; NULL: silent */
};

/* Findings go to diag (errors by the plant file's or tag list's line). False: something failed; what is good was written, but the manifest
   is as it was. Finish in both cases. */
bool prepare_run(struct prepare *prepare, struct log *log, struct workers *workers, const struct plant *plant,
                 const struct prepare_params *params, struct diag *diag);
void prepare_finish(struct prepare *prepare);

#endif

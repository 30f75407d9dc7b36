/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prepares all assets of a plant: files that are up to date stay, the rest is built. Each finished asset is on disk at once, so an
   interrupted run is continued by the next one. Thread: one. */
#ifndef PREPROCESS_PIPELINE_PREPARE_H
#define PREPROCESS_PIPELINE_PREPARE_H
#include <stdatomic.h>
#include <stdio.h>

#include "base/text/diag.h"
#include "preprocess/pipeline/build.h"
#include "preprocess/model/model_files.h"
#include "preprocess/pipeline/geometry_cache.h"

enum prepare_state { PREPARE_LEFT /* not begun: interrupted */, PREPARE_FAILED, PREPARE_UNCHANGED, PREPARE_SHARED, PREPARE_BUILT };

struct prepare_asset {
    const struct plant_asset *plant;
    bool wanted;  /* else nothing below is set */
    size_t model; /* in prepare->models */
    struct plant_sensor *sensors;
    size_t sensor_count;
    float *surface_distances_m;                        /* of each sensor; NULL: failed */
    double size_m[3];                                  /* in the asset frame, the last is the height; 0: not known */
    double far_m;                                      /* a sensor farther from its surface than this is worth a warning */
    uint64_t recipe, key, geometry_key, distances_key; /* recipe: build_recipe */
    char *missing;               /* failed because of the model: why it, or a sensor's node, cannot be found there; else NULL */
    struct geometry_cache cache; /* while it is built; parts.bytes NULL: none */
    size_t same_as;              /* the first asset with this key, which has the file */
    enum prepare_state state;
    char *rebuilt_because; /* what was wrong with the file that was there, or NULL */
    uint32_t triangles, vertices;
    bool reported; /* report is set: always where it was built, else where the file's report was kept */
    struct build_report report;
    double seconds, work;
};

struct prepare {
    const struct plant *plant;
    struct prepare_asset *assets;
    size_t asset_count;
    struct model_files models;
    size_t removed;
    double seconds;
    bool interrupted;
};

struct prepare_params {
    const char *folder;
    const char *only;                  /* this asset alone; the manifest is left as it is. NULL: all */
    FILE *progress;                    /* NULL: silent */
    struct service_patience *patience; /* gets the status after each asset; NULL: nobody waits */
    const atomic_bool *stop;           /* no asset is begun any more once it is true. NULL: never */
};

/* Prepares the plant's assets into params->folder, one process at a time per folder. Errors go to diag, by line of the plant file or tag
   list. Returns false if something failed or was interrupted; what is good was written. The manifest stays as it was, unless only models
   are to blame: then it lists what is good and says why the rest is missing. Call prepare_finish() in both cases. */
bool prepare_run(struct prepare *prepare, struct log *log, struct workers *workers, const struct plant *plant,
                 const struct prepare_params *params, struct diag *diag);
/* Frees the results. */
void prepare_finish(struct prepare *prepare);

/* Returns the parameters by which this asset is cut out of its model. */
struct geometry_params prepare_geometry(const struct plant_asset *asset);
/* Returns the distance from the surface, in metres, beyond which a sensor is worth a warning, for an asset whose bounding box has this
   diagonal. */
double prepare_far_m(double diagonal_m);

#endif

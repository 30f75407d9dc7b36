/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prepares all assets of a plant: keeps up-to-date files and builds the others. Each asset is written to disk as soon as it is
 * finished, so that after an interruption the next run continues from there. Call from one thread only. */
#ifndef PREPROCESS_PIPELINE_PREPARE_H
#define PREPROCESS_PIPELINE_PREPARE_H
#include <stdatomic.h>
#include <stdio.h>

#include "base/text/diag.h"
#include "preprocess/pipeline/build.h"
#include "preprocess/model/model_files.h"
#include "preprocess/pipeline/geometry_cache.h"

/* PREPARE_LEFT: the run was interrupted before this asset */
enum prepare_state { PREPARE_LEFT, PREPARE_FAILED, PREPARE_UNCHANGED, PREPARE_SHARED, PREPARE_BUILT };

struct prepare_asset {
    const struct plant_asset *plant;
    bool wanted;  /* true: the asset is to be prepared; false: no other member of this struct is set */
    size_t model; /* index of the asset's model in prepare.models */
    struct plant_sensor *sensors;
    size_t sensor_count;
    float *surface_distances_m; /* by sensor: its distance from the surface, metres; NULL: the asset could not be prepared */
    double size_m[3];           /* size of the asset in its own frame, metres; size_m[2] is the height; 0: unknown */
    double far_m;               /* distance of a sensor from the surface above which a warning is printed, metres */
    /* recipe: hash of the model and of the parameters by which the asset is cut out (build_recipe()) */
    uint64_t recipe, key, geometry_key, distances_key;
    char *missing;               /* why the model, or a sensor's node, cannot be used; NULL: no such failure */
    struct geometry_cache cache; /* cached geometry of the asset, open while the asset is built; parts.bytes NULL: not open */
    size_t same_as;              /* index of the first asset with the same key, whose file both assets use */
    enum prepare_state state;
    char *rebuilt_because; /* path and defect of a damaged prepared file that was therefore rebuilt; NULL: none */
    uint32_t triangles, vertices;
    bool reported; /* true: `report` is valid; always for a built asset, but for an unchanged asset only if KEY.report.json exists */
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
    const char *only;                  /* id of the only asset to prepare, leaving the manifest unchanged; NULL: all assets */
    FILE *progress;                    /* stream for progress lines; NULL: prints nothing */
    struct service_patience *patience; /* service manager that gets a status line after each asset; NULL: none */
    const atomic_bool *stop;           /* the caller sets it to true to stop: no further asset is begun; NULL: never stops */
};

/* Prepares the plant's assets into params->folder; only one process at a time can use a folder. Errors go to diag, with their
 * line in the plant file or tag list. Returns false if something failed or the run was interrupted; good assets have been
 * written. After a failure the manifest stays unchanged, unless only faulty models caused it: the manifest then lists the good
 * assets, and for each other asset the reason why it is missing. In either case, call prepare_finish(). */
bool prepare_run(struct prepare *prepare, struct log *log, struct workers *workers, const struct plant *plant,
                 const struct prepare_params *params, struct diag *diag);
/* Frees the results of prepare_run(). */
void prepare_finish(struct prepare *prepare);

/* Returns the parameters by which an asset is cut out of its model. */
struct geometry_params prepare_geometry(const struct plant_asset *asset);
/* Returns the distance between a sensor and the surface above which a warning is printed, in metres. diagonal_m: diagonal of
 * the asset's bounding box. */
double prepare_far_m(double diagonal_m);

#endif

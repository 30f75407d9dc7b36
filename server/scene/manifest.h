/* SPDX-License-Identifier: GPL-3.0-or-later */
/* FOLDER/manifest.json: the prepared file of each asset (protocol/ASSET.md). Call from one thread only. */
#ifndef SCENE_MANIFEST_H
#define SCENE_MANIFEST_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log/log.h"

struct manifest {
    char *path;
    struct manifest_entry {
        char *id, *file;          /* file: name of the asset's prepared file in the manifest's folder */
        char *surface;            /* file name of the asset's stored surface (surface_store.h); NULL: none */
        char *missing;            /* reason why the asset could not be prepared and has no file; NULL: it was prepared */
        uint64_t recipe;          /* hash of all inputs of the asset except its sensors (plant/recipe.h) */
        /* hash of the model file and of all files that it refers to, when they were prepared; 0: an older plantcast-prep wrote none */
        uint64_t model;
        uint64_t cuts;            /* hash of the parameters for which triangles were cut (plant_cuts_recipe()); 0: older file */
        uint64_t resolved_levels; /* bit mask of levels of detail, as in struct asset (scene/asset.h) */
        /* names of textures and extensions of the asset's model that are not drawn. If several assets use a model, only the
           first one has this list */
        char **left_out;
        size_t left_out_count;
    } * entries;
    size_t count;
};

/* Reads the manifest. On failure, logs the reason with advice and returns false. */
bool manifest_read(struct log *log, const char *folder, struct manifest *manifest);
void manifest_finish(struct manifest *manifest);
/* returns the entry of the asset with this id; NULL if the manifest has none */
const struct manifest_entry *manifest_find(const struct manifest *manifest, const char *id);

#endif

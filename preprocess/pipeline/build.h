/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One asset from a parsed model: geometry, sensors dropped onto it, distances, bytes of its file. */
#ifndef PREPROCESS_PIPELINE_BUILD_H
#define PREPROCESS_PIPELINE_BUILD_H
#include "base/log.h"
#include "base/workers.h"
#include "plant/sensors.h"
#include "preprocess/cache/folder.h"
#include "preprocess/levels/levels.h"
#include "surface/surface.h"

#define BUILD_REVISION 43u /* grows when the same input shall give another file */

struct geometry_cache;
struct build_input {
    const struct gltf_model *model; /* not looked at where there is a stock */
    struct geometry_params geometry;
    const struct plant *plant;          /* its groups and tags say where the field bends */
    const struct plant_sensor *sensors; /* position_m also where it is a node's */
    size_t sensor_count;
    uint64_t key;
    const struct geometry_cache *cache; /* of this geometry_key; NULL: there is none */
    const char *folder;                 /* where stock and columns are kept; NULL: nowhere */
    uint64_t geometry_key, distances_key;
};

struct build_level {
    uint32_t triangles;       /* as simplified */
    uint32_t split_triangles; /* after splitting */
    uint32_t vertices;        /* the prefix */
    float error_m;
    struct level_left left[LEVEL_LIMITS]; /* what splitting left */
};

struct build_report {
    uint32_t nodes, triangles, vertices, primitives, materials, textures, degenerate_triangles, repeated_triangles, computed_normals;
    uint32_t skipped_lines, skipped_points; /* primitives that are no triangles */
    struct surface_report surface;          /* zero where the asset has no sensor */
    size_t unreachable_vertices;            /* no sensor's distance is finite there */
    uint32_t stocked, kept_sensors;         /* stocked: 1 if the model need not be read; sensors whose distances were there */
    struct build_level levels[LEVELS_MAX];
    size_t level_count, levels_given_up;
    size_t split_measured, split_kept; /* findings of the splitting: of this time, and of the last that still hold */
    double read_s, surface_s, solve_s, levels_s, split_s;
};

struct build_output {
    struct folder_draft file;
    struct asset_view view; /* of its bytes */
    struct build_report report;
};

/* output->file is to be put in its place, and closed. False: why says what is wrong, and there is none. Thread: any; work is spread over
   workers. */
bool build_asset(struct log *log, struct workers *workers, const struct build_input *input, struct build_output *output,
                 char why[MODEL_WHY_BYTES]);

/* In the asset frame. False: why says that its node is not in the model, or not the only one. */
bool build_sensor_place(const struct gltf_model *model, const struct geometry_params *geometry, const struct plant_sensor *sensor,
                        double place_m[3], char why[MODEL_WHY_BYTES]);

/* Of a model and the way in which an asset is cut out of it: where it is known, so is what comes out. */
uint64_t build_recipe(uint64_t model_hash, const struct geometry_params *geometry);
/* The key of all that no sensor has a part in. geometry_hash: what geometry_hash says. */
uint64_t build_geometry_key(uint64_t geometry_hash, const struct geometry_params *geometry);
/* The key of a file that would be made of this. */
uint64_t build_key(uint64_t geometry_key, const struct plant *plant, const struct plant_sensor *sensors, size_t sensor_count);

#endif

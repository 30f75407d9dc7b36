/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What building one asset takes and gives. */
#ifndef PREPROCESS_PIPELINE_BUILD_IO_H
#define PREPROCESS_PIPELINE_BUILD_IO_H
#include "plant/sensors.h"
#include "preprocess/cache/folder.h"
#include "preprocess/geometry/stray.h"
#include "preprocess/influence/influence_file.h"
#include "preprocess/levels/levels.h"
#include "surface/surface.h"

struct geometry_cache;
struct build_input {
    const struct gltf_model *model; /* not used where `cache` is set */
    struct geometry_params geometry;
    const struct plant *plant;          /* its groups and tags say where the field bends */
    const struct plant_sensor *sensors; /* position_m also where it is a node's */
    size_t sensor_count;
    uint64_t key;
    const struct geometry_cache *cache; /* of geometry_key; NULL: there is none */
    const char *folder;                 /* of prepared files, with the build cache; NULL: none */
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
    uint32_t turned_triangles, closed_gaps;
    uint32_t skipped_lines, skipped_points; /* primitives that are no triangles */
    struct surface_report surface;          /* zero where the asset has no sensor */
    size_t unreachable_vertices;            /* no sensor's distance is finite there */
    uint32_t stocked, kept_sensors;         /* stocked: 1 if the model need not be read; sensors whose distances were there */
    struct build_level levels[LEVELS_MAX];
    size_t level_count, levels_given_up;
    size_t split_measured, split_kept; /* findings of the splitting: of this time, and of the last that still hold */
    struct bend_report bend;   /* of harmonic, fin and gp between corners; zero: no group asks for them */
    struct cloud_report cloud; /* of the heat method on a point cloud; zero: no group asks for it */
    char stray[STRAY_TEXT_BYTES]; /* pieces far from the rest (geometry/stray.h); "": none */
    double read_s, surface_s, solve_s, levels_s, split_s;
};

struct build_output {
    struct folder_draft file;
    struct asset_view view; /* of its bytes */
    struct build_report report;
};

#endif

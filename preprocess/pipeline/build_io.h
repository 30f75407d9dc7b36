/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Input and output of building one asset. */
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
    const struct gltf_model *model; /* parsed model to cut the asset out of; unused if `cache` is set */
    struct geometry_params geometry;
    /* the plant; its groups and tags determine where smaller triangles are needed, so that values interpolated between vertices
       are right */
    const struct plant *plant;
    const struct plant_sensor *sensors; /* the asset's sensors; position_m is set for all sensors, including those placed by a node */
    size_t sensor_count;
    uint64_t key;
    const struct geometry_cache *cache; /* cached geometry for geometry_key; NULL: there is none */
    const char *folder;                 /* folder of prepared files and of the build cache; NULL: none */
    uint64_t geometry_key, distances_key;
};

struct build_level {
    uint32_t triangles;       /* number of triangles after simplification */
    uint32_t split_triangles; /* number of triangles after subdivision */
    uint32_t vertices;        /* number of vertices that the level uses, which are the first of the asset's array */
    float error_m;
    struct level_left left[LEVEL_LIMITS]; /* edges that still have an interpolation error after subdivision, by reason */
};

struct build_report {
    uint32_t nodes, triangles, vertices, primitives, materials, textures, degenerate_triangles, repeated_triangles, computed_normals;
    uint32_t turned_triangles, closed_gaps;
    uint32_t skipped_lines, skipped_points; /* numbers of primitives skipped because they consist of lines or points */
    struct surface_report surface;          /* numbers about the surface for the report; zero if the asset has no sensor */
    size_t unreachable_vertices;            /* number of vertices that no path along the surface connects to a sensor */
    /* stocked: 1 if the geometry came from the cache, else 0; kept_sensors: number of sensors whose distances came from the cache */
    uint32_t stocked, kept_sensors;
    struct build_level levels[LEVELS_MAX];
    size_t level_count, levels_given_up;
    /* number of edges and triangles whose interpolation error was measured in this run (split_measured) or came from the last
     * run's cache (split_kept) */
    size_t split_measured, split_kept;
    /* measured interpolation error of harmonic, fin and gp inside triangles; all zero: not requested by any group */
    struct bend_report bend;
    struct cloud_report cloud; /* numbers for the report about distances by heat on a point cloud; zero: not requested by any group */
    /* description, for the report, of triangles far from the asset's main part (geometry/stray.h); "": there are none */
    char stray[STRAY_TEXT_BYTES];
    double read_s, surface_s, solve_s, levels_s, split_s;
};

struct build_output {
    struct folder_draft file;
    struct asset_view view; /* view into the contents of `file` */
    struct build_report report;
};

#endif

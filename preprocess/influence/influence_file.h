/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From an asset's surface to its file KEY.influence (protocol/ASSET.md). Thread: one; it spreads its work over the workers. */
#ifndef PREPROCESS_INFLUENCE_INFLUENCE_FILE_H
#define PREPROCESS_INFLUENCE_INFLUENCE_FILE_H
#include "base/log/log.h"
#include "base/workers.h"
#include "plant/sensors.h"
#include "preprocess/influence/influence_bend.h"
#include "surface/surface.h"

/* How distances by the heat method on a point cloud differ from ours, as shares of the largest: of CLOUD_CHECKED sensors at each vertex. */
struct cloud_report {
    size_t points;
    int k;
    double spacing_m, mean, worst;
    size_t reached, unreached; /* vertices: by it alone (through what is thin); by ours alone */
};
enum { CLOUD_CHECKED = 4 };

struct influence_input {
    const struct plant *plant;
    const struct plant_sensor *sensors;
    const double (*places_m)[3]; /* of the sensors, in the surface's frame */
    size_t sensor_count;
    const struct surface *surface;
    const float (*positions_m)[3]; /* vertices, as the asset file has them */
    const float (*normals)[3];
    const uint32_t *triangles; /* triangles of all levels of detail, the finest first */
    size_t vertex_count, triangle_count;
    const struct bend_level *levels;
    size_t level_count;
    const char *folder;
    uint64_t key; /* of the asset file */
    struct cloud_report *cloud; /* filled in where a group asks for distances by heat */
    struct bend_report *bend;   /* filled in where one asks for harmonic, fin or gp */
};

/* Returns whether some group of these sensors has anything prepared but distances. */
bool influence_is_wanted(const struct plant *plant, const struct plant_sensor *sensors, size_t sensor_count);
/* Computes what the groups ask for, and writes the file. Returns false with the reason in why. */
bool influence_file_make(struct log *log, struct workers *workers, const struct influence_input *input, char why[200]);
/* Returns whether the file is there and whole. */
bool influence_file_good(const char *folder, uint64_t key);

#endif

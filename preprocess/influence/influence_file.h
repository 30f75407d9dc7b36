/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the influence of an asset's sensors and writes the file KEY.influence (protocol/ASSET.md). Call from one thread at a
 * time, which uses the threads of the `struct workers` passed in. */
#ifndef PREPROCESS_INFLUENCE_INFLUENCE_FILE_H
#define PREPROCESS_INFLUENCE_INFLUENCE_FILE_H
#include "base/files/cache_file.h"
#include "base/log/log.h"
#include "base/workers.h"
#include "plant/sensors.h"
#include "preprocess/influence/influence_bend.h"
#include "surface/surface.h"

/* Differences between distances by heat on the point cloud and plantcast-prep's usual distances along the mesh. They are taken
   at all vertices, as shares of the largest distance, for CLOUD_CHECKED sensors. */
struct cloud_report {
    size_t points;
    int k;
    double spacing_m, mean, worst;
    /* reached: number of vertices that heat distances reach, through thin walls, but distances along the mesh do not;
       unreached: number of vertices for which the reverse is true */
    size_t reached, unreached;
};
enum { CLOUD_CHECKED = 4 };

struct influence_input {
    const struct plant *plant;
    const struct plant_sensor *sensors;
    const double (*places_m)[3]; /* positions of the sensors, in the surface's frame */
    size_t sensor_count;
    const struct surface *surface;
    const float (*positions_m)[3]; /* vertex positions as stored in the asset file */
    const float (*normals)[3];
    const uint32_t *triangles; /* triangles of all levels of detail, finest first */
    size_t vertex_count, triangle_count;
    const struct bend_level *levels;
    size_t level_count;
    const char *folder;
    uint64_t key;               /* key of the asset file */
    struct cloud_report *cloud; /* receives a comparison of heat distances with mesh distances if a group requests heat distances */
    struct bend_report *bend;   /* receives the measured interpolation errors if a group requests harmonic, fin or gp */
};

/* Returns whether an influence file is needed: any of these sensors has a known position and belongs to a group with an
   interpolation that plantcast-prep computes and stores there. */
bool influence_is_wanted(const struct plant *plant, const struct plant_sensor *sensors, size_t sensor_count);
/* Computes the interpolations that the groups request and writes the file. Returns false with the reason in why. */
bool influence_file_make(struct log *log, struct workers *workers, const struct influence_input *input, char why[200]);
/* Returns whether this asset's influence file exists and is complete; if not, why receives the reason. */
bool influence_file_good(const char *folder, uint64_t key, char why[CACHE_FILE_WHY_BYTES]);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Projects an asset's sensors onto its surface and computes the distances of every surface point from them. */
#ifndef PREPROCESS_PIPELINE_SENSOR_DISTANCES_H
#define PREPROCESS_PIPELINE_SENSOR_DISTANCES_H
#include "base/log/log.h"
#include "base/workers.h"
#include "preprocess/pipeline/build_io.h"
#include "preprocess/subdivision/distance_rows.h"

struct sensor_distances {
    struct surface *surface;
    struct surface_field field;
    struct asset_sensor *sensors;
    double (*places_m)[3]; /* less the origin */
};

/* Builds the surface unless `measured` has one, projects the sensors onto it and computes their distances, taking known ones from the
   distance cache. Fills in the report's part about it. Returns false with the reason in why. Call sensor_distances_finish() in both
   cases. */
bool sensor_distances_find(struct sensor_distances *measured, struct log *log, struct workers *workers, const struct build_input *input,
                           const struct geometry *geometry, struct build_output *output, char why[MODEL_WHY_BYTES]);
/* Returns whether any sensor stands at a place that is known. Those whose place is assumed stand for the whole asset, evenly: without
   others no distance from them says anything, and no surface is needed. */
bool sensor_distances_matter(const struct plant *plant, const struct plant_sensor *sensors, size_t count);
/* Instead of sensor_distances_find(), where no distance matters: projects the sensors onto the nearest triangle of the geometry, also of
   one that other parts hide. */
void sensor_distances_assume(struct sensor_distances *measured, struct workers *workers, const struct build_input *input,
                             const struct geometry *geometry);
/* Makes the distances of sensors that stand for the whole asset: 0 at every vertex. The caller finishes them. */
void sensor_distances_even(struct distance_rows *distances, size_t sensor_count, uint32_t vertex_count);
/* Frees surface, distances and sensors. */
void sensor_distances_finish(struct sensor_distances *measured);

/* Finds a sensor's position in the asset frame: its own, or its node's. Returns false with the reason in why if the node is not in the
   model, or not unique. */
bool build_sensor_place(const struct gltf_model *model, const struct geometry_params *geometry, const struct plant_sensor *sensor,
                        double place_m[3], char why[MODEL_WHY_BYTES]);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Projects an asset's sensors onto its surface and computes the distances from them to all points of the surface. */
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
    double (*places_m)[3]; /* sensor positions relative to the origin of the asset's geometry */
};

/* Builds the asset's surface unless `measured` already has one, and projects the sensors onto it. Computes the distances that
 * are not in the distance cache. Fills in the surface part of the report. Returns false with the reason in why. In either case,
 * call sensor_distances_finish(). */
bool sensor_distances_find(struct sensor_distances *measured, struct log *log, struct workers *workers, const struct build_input *input,
                           const struct geometry *geometry, struct build_output *output, char why[MODEL_WHY_BYTES]);
/* Returns whether any sensor has a known position. A sensor with an assumed position (only its equipment is known) colours the
   whole asset evenly. If all positions are assumed, distances have no effect and no surface is needed. */
bool sensor_distances_matter(const struct plant *plant, const struct plant_sensor *sensors, size_t count);
/* Replaces sensor_distances_find() if sensor_distances_matter() is false: projects each sensor onto the nearest triangle of the
 * geometry, even if other parts hide it. */
void sensor_distances_assume(struct sensor_distances *measured, struct workers *workers, const struct build_input *input,
                             const struct geometry *geometry);
/* Creates distances for sensors with assumed positions (only their equipment is known): 0 at every vertex, so that each sensor
   colours the whole asset evenly. The caller frees them (distance_rows_finish()). */
void sensor_distances_even(struct distance_rows *distances, size_t sensor_count, uint32_t vertex_count);
/* Frees surface, distances and sensors. */
void sensor_distances_finish(struct sensor_distances *measured);

/* Writes the sensor's position, or that of its node, to place_m, in the asset frame. Returns false with the reason in why if
 * the model has no such node, or several. */
bool build_sensor_place(const struct gltf_model *model, const struct geometry_params *geometry, const struct plant_sensor *sensor,
                        double place_m[3], char why[MODEL_WHY_BYTES]);

#endif

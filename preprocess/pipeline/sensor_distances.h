/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sensors of an asset on its surface, and how far they are from everywhere. */
#ifndef PREPROCESS_PIPELINE_SENSOR_DISTANCES_H
#define PREPROCESS_PIPELINE_SENSOR_DISTANCES_H
#include "base/log.h"
#include "base/workers.h"
#include "preprocess/pipeline/build_io.h"

struct sensor_distances {
    struct surface *surface;
    struct surface_field field;
    struct asset_sensor *sensors;
    double (*places_m)[3]; /* less the origin */
};

/* measured is zero-initialised, or has its surface already. Fills in what the report says about it. False: why says what is wrong; finish
   all the same. */
bool sensor_distances_find(struct sensor_distances *measured, struct log *log, struct workers *workers, const struct build_input *input,
                           const struct geometry *geometry, struct build_output *output, char why[MODEL_WHY_BYTES]);
void sensor_distances_finish(struct sensor_distances *measured);

/* Finds the place of a sensor in the asset frame. Returns false if its node is not in the model, or not unique, with the reason in why. */
bool build_sensor_place(const struct gltf_model *model, const struct geometry_params *geometry, const struct plant_sensor *sensor,
                        double place_m[3], char why[MODEL_WHY_BYTES]);

#endif

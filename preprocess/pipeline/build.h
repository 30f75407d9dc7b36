/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One asset from a parsed model: geometry, sensors dropped onto it, distances, bytes of its file. */
#ifndef PREPROCESS_PIPELINE_BUILD_H
#define PREPROCESS_PIPELINE_BUILD_H
#include "base/log.h"
#include "base/workers.h"
#include "preprocess/pipeline/build_io.h"

#define BUILD_REVISION 43u /* grows when the same input shall give another file */

/* output->file is to be put in its place, and closed. False: why says what is wrong, and there is none. Thread: any; work is spread over
   workers. */
bool build_asset(struct log *log, struct workers *workers, const struct build_input *input, struct build_output *output,
                 char why[MODEL_WHY_BYTES]);

/* Of a model and the way in which an asset is cut out of it: where it is known, so is what comes out. */
uint64_t build_recipe(uint64_t model_hash, const struct geometry_params *geometry);
/* The key of all that no sensor has a part in. geometry_hash: what geometry_hash says. */
uint64_t build_geometry_key(uint64_t geometry_hash, const struct geometry_params *geometry);
/* The key of a file that would be made of this. */
uint64_t build_key(uint64_t geometry_key, const struct plant *plant, const struct plant_sensor *sensors, size_t sensor_count);

#endif

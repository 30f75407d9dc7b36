/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds one asset from a parsed model, or from the geometry cache: mesh, levels of detail, distances from sensors, and the bytes of its
 * file. */
#ifndef PREPROCESS_PIPELINE_BUILD_H
#define PREPROCESS_PIPELINE_BUILD_H
#include "base/log/log.h"
#include "base/workers.h"
#include "preprocess/pipeline/build_io.h"

/* revision of the contents of asset files; increment it whenever the same input gives a different file than before */
#define BUILD_REVISION 63u

/* Builds the asset into output->file, a draft that the caller names (folder_put()) and closes. Uses all workers. Returns false
 * with the reason in why and without a file. Call from any thread. */
bool build_asset(struct log *log, struct workers *workers, const struct build_input *input, struct build_output *output,
                 char why[MODEL_WHY_BYTES]);

/* Returns an asset's recipe: a hash of its model and of the parameters by which it is cut out of the model. Equal recipes mean
 * equal geometry. */
uint64_t build_recipe(uint64_t model_hash, const struct geometry_params *geometry);
/* Returns the key (hash) of everything in the asset that does not depend on sensors. geometry_hash: result of geometry_hash(). */
uint64_t build_geometry_key(uint64_t geometry_hash, const struct geometry_params *geometry);
/* Returns the key (hash) of the asset file for this geometry, plant and sensors. */
uint64_t build_key(uint64_t geometry_key, const struct plant *plant, const struct plant_sensor *sensors, size_t sensor_count);

#endif

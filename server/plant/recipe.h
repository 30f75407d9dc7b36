/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hashes of all that a prepared file depends on, except sensors, which are compared one by one (plant/sensors.h). plantcast-prep writes
   them into the manifest and scene_create() compares them, so that outdated prepared files are not used. Thread: any. */
#ifndef PLANT_RECIPE_H
#define PLANT_RECIPE_H
#include <stdbool.h>
#include <stdint.h>

#include "plant/plant.h"

/* Computes the hash of a model file, without the files that a .gltf refers to. Returns false if it cannot be read, with errno. */
bool plant_model_hash(const char *path, uint64_t *out);
/* Returns the hash of the model, the nodes, the units, the up axis and the tolerance of an asset. */
uint64_t plant_recipe(const struct plant_asset *asset, uint64_t model_hash);

#endif

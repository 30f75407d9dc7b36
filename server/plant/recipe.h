/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hashes of everything that a prepared asset file depends on, except sensors, which are compared one by one (plant/sensors.h).
   plantcast-prep writes the hashes into the manifest, and scene_create() compares them to reject outdated asset files. Call
   from any thread. */
#ifndef PLANT_RECIPE_H
#define PLANT_RECIPE_H
#include <stdbool.h>
#include <stdint.h>

#include "plant/sensors.h"

/* Computes the hash of a model file, excluding files that a .gltf refers to. Returns false with errno if the file cannot be read. */
bool plant_model_hash(const char *path, uint64_t *out);
/* Returns the hash of the asset's settings that affect its asset file: model, nodes, units, up axis and tolerance. */
uint64_t plant_recipe(const struct plant_asset *asset, uint64_t model_hash);
/* Returns the hash of the parameters of an asset's groups and tags for which plantcast-prep cuts its triangles, in the order of its
   sensors; 0 without sensors. A reload can change these parameters without another run of plantcast-prep. */
uint64_t plant_cuts_recipe(const struct plant *plant, const struct plant_sensor *sensors, size_t count);

#endif

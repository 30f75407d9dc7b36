/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What of a plant file and a model decides how a prepared file looks. plantcast-prep notes it in the manifest and scene_create
   compares, so that a changed plant is not shown as it was before. Sensors are compared one by one (plant/sensors.h). Thread: any. */
#ifndef PLANT_RECIPE_H
#define PLANT_RECIPE_H
#include <stdbool.h>
#include <stdint.h>

#include "plant/plant.h"

/* Of the model's own file; what a .gltf names besides is not looked at. False: it cannot be read, errno says why. */
bool plant_model_hash(const char *path, uint64_t *out);
/* Of the model, the nodes, the units, the up axis and the tolerance. */
uint64_t plant_recipe(const struct plant_asset *asset, uint64_t model_hash);

#endif

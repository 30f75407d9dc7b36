/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Outermost points of a plant in many directions, for views that must contain the whole plant. Call from any thread. */
#ifndef SCENE_EXTREMES_H
#define SCENE_EXTREMES_H
#include <stdbool.h>

#include "scene/scene.h"

/* Computes scene->extremes_m (owned by the scene) from all assets except those hidden at start, and except the ground if the
   plant has other assets. */
void extremes_find(struct scene *scene);

#endif

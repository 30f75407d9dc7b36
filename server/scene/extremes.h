/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Outermost points of a plant in many directions, for views that must contain the whole plant. Call from any thread. */
#ifndef SCENE_EXTREMES_H
#define SCENE_EXTREMES_H
#include <stdbool.h>

#include "scene/scene.h"

/* Sets scene->extremes_m, owned by the scene. Ignores assets hidden at start, and the ground if the plant has other assets. */
void extremes_find(struct scene *scene);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The outermost places of a plant, each way: what a view of the whole has to hold. Thread: any. */
#ifndef SCENE_EXTREMES_H
#define SCENE_EXTREMES_H
#include <stdbool.h>

#include "scene/scene.h"

/* Sets scene->extremes_m, which is the scene's. Without the ground, where there is more than that, and without what starts hidden. */
void extremes_find(struct scene *scene);

#endif

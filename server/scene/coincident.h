/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decides which asset is visible where faces of two assets coincide, as in CAD models: an asset with sensors before one
   without; else the one that comes first in the plant file. */
#ifndef SCENE_COINCIDENT_H
#define SCENE_COINCIDENT_H
#include "scene/scene.h"

/* Sets `front` of every asset: 0, or a rank higher than that of each asset that it must hide where faces of the two coincide. */
void coincident_find(struct scene *scene);
/* Returns how far the asset is shifted towards the viewer, relative to its distance (in an orthographic view, to camera_parallel_m()). */
double coincident_forward(const struct scene_asset *asset);

#endif

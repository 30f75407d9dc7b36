/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Faces of two assets in one place, as CAD has them: which one is seen. The asset with sensors is, before one without; else the one
   that the plant file names first. */
#ifndef SCENE_COINCIDENT_H
#define SCENE_COINCIDENT_H
#include "scene/scene.h"

/* Sets `front` of every asset: 0, or above that of all assets that it hides where their faces coincide. */
void coincident_find(struct scene *scene);
/* So much of its distance (or, in an orthographic view, of what would be the distance in perspective) an asset is brought forward. */
double coincident_forward(const struct scene_asset *asset);

#endif

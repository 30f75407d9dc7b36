/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The main part of a plant, which an initial view frames: everything except stray pieces, which are so far away that the plant
 * would appear as a dot. */
#ifndef SCENE_MAIN_PART_H
#define SCENE_MAIN_PART_H
#include <stdbool.h>

#include "base/log/log.h"
#include "scene/scene.h"

/* Sets the scene's bounds to the box of the main part, which the rule of gap_split.h determines; sets scene->outside and the
   assets' stray members. Logs the stray pieces (log may be NULL). */
void main_part_find(struct log *log, struct scene *scene);
/* Returns whether a point is within the scene's bounds, with a margin for rounding. */
bool main_part_holds(const struct scene *scene, const double place_m[3]);

#endif

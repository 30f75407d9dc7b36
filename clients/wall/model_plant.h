/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A plant without geometry, out of the server's greeting. Thread: any one at a time. */
#ifndef WALL_MODEL_PLANT_H
#define WALL_MODEL_PLANT_H
#include <jansson.h>

#include "scene/scene.h"

/* Reads a `welcome`, whose texts the plant goes on using. Returns false, with both as model_plant_finish() leaves them, if it makes no
   sense. */
bool model_plant_init(struct plant *plant, struct scene *scene, const json_t *welcome);
/* Frees what they own; leaves them empty. Empty ones are fine. */
void model_plant_finish(struct plant *plant, struct scene *scene);

#endif

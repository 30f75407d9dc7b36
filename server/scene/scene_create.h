/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes the scene of a plant from its prepared files. Call from any thread. */
#ifndef SCENE_SCENE_CREATE_H
#define SCENE_SCENE_CREATE_H
#include "base/log/log.h"
#include "scene/scene.h"

/* Opens the prepared files of a plant and makes its scene. prepared_folder: as plant_prepared_folder() returns it. Refuses
   files that do not match the plant and logs asset and reason. If plantcast-prep could not prepare an asset, the scene has it
   marked as missing, and a warning is logged. `plant` must outlive the scene. Returns NULL on failure, all errors logged. */
struct scene *scene_create(struct log *log, const struct plant *plant, const char *prepared_folder);
void scene_destroy(struct scene **scene); /* destroys the scene and sets *scene to NULL; accepts a pointer to NULL */
/* Sets the initial camera: the plant file's view, or else a view of the whole plant from above a corner. */
void scene_home(const struct scene *scene, double aspect, struct camera *camera);

#endif

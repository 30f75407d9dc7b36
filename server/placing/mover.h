/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes geodesic distances from new sensor positions on an asset of a loaded plant. Uses the asset's prepared surface, or
   builds a surface. Call from any thread. */
#ifndef PLACING_MOVER_H
#define PLACING_MOVER_H
#include "scene/scene.h"
#include "surface/relocation.h"

/* Starts to load or build the surface of an asset, on which distances are computed (surface/relocation.h). folder: folder of
   the prepared files. The scene must outlive the result. Never returns NULL; the caller destroys the result. */
struct relocation *mover_create(struct log *log, struct workers *workers, const struct scene *scene, const char *folder, int asset);

#endif

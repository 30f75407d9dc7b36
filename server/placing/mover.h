/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Distances from new places on an asset of a loaded plant: its surface as plantcast-prep kept it, or made anew. Thread: any. */
#ifndef PLACING_MOVER_H
#define PLACING_MOVER_H
#include "scene/scene.h"
#include "surface/relocation.h"

/* Begins to make the surface of an asset (surface/relocation.h). folder: of the prepared files. The scene must outlive it. Never NULL; the
   caller destroys it. */
struct relocation *mover_create(struct log *log, struct workers *workers, const struct scene *scene, const char *folder, int asset);

#endif

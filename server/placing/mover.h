/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes distances from new positions on an asset of a loaded plant, on its stored surface or a new one. Thread: any. */
#ifndef PLACING_MOVER_H
#define PLACING_MOVER_H
#include "scene/scene.h"
#include "surface/relocation.h"

/* Starts to build the surface of an asset (surface/relocation.h). folder: of the prepared files. The scene must outlive the result. Never
   NULL; the caller destroys it. */
struct relocation *mover_create(struct log *log, struct workers *workers, const struct scene *scene, const char *folder, int asset);

#endif

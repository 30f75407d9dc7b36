/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes a model as glTF 2.0 binary (GLB): Y up, metres, one node per node of the model with its name and, as extras, its attributes.
 * Positions are stored relative to each node's own place, so that a plant far from its origin keeps its precision. Thread: any. */
#ifndef PREPROCESS_IMPORT_CAD_GLB_H
#define PREPROCESS_IMPORT_CAD_GLB_H
#include "preprocess/import/cad_model.h"

/* `name`: of the node above all others. Returns 0 or -errno (-EFBIG: more than 4 GiB, which GLB cannot hold). */
int cad_glb_write(const struct cad_model *model, const char *name, const char *path);

#endif

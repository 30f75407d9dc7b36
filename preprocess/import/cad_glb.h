/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes a CAD model as glTF 2.0 binary (GLB): Y up, metres, one glTF node per node of the model, with its name and, as extras,
 * its attributes. Positions are relative to their node's origin, so that a plant far from the coordinate origin keeps its
 * precision. Call from any thread. */
#ifndef PREPROCESS_IMPORT_CAD_GLB_H
#define PREPROCESS_IMPORT_CAD_GLB_H
#include "preprocess/import/cad_model.h"

/* Writes the CAD model to the file `path`. `name` becomes the name of the root node. Returns 0 or -errno (-EFBIG: more than the 4 GiB that
 * GLB can hold). */
int cad_glb_write(const struct cad_model *model, const char *name, const char *path);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Packs a glTF model, its buffers and its images into one GLB file. Call from any thread. */
#ifndef PREPROCESS_IMPORT_GLTF_PACK_H
#define PREPROCESS_IMPORT_GLTF_PACK_H
#include "plant/models/model_refusal.h"

/* Copies the model at `path` to the file `glb`. A GLB file that refers to no other file is copied unchanged; otherwise the
 * buffers and images referred to by URI are embedded. Returns false with the reason in why. */
bool gltf_pack(const char *path, const char *glb, char why[MODEL_WHY_BYTES]);

#endif

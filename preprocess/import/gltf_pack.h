/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A glTF model with all that belongs to it as one GLB file. Thread: any. */
#ifndef PREPROCESS_IMPORT_GLTF_PACK_H
#define PREPROCESS_IMPORT_GLTF_PACK_H
#include "preprocess/model/refusal.h"

/* Copies the model at `path` to the file `glb`: as it is if all of it is in one GLB file, else with buffers and images that its URIs name
 * taken in. Returns false with the reason in why. */
bool gltf_pack(const char *path, const char *glb, char why[MODEL_WHY_BYTES]);

#endif

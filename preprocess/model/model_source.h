/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A model file as stored on disk: its bytes, and one hash over the file and all files it refers to by URI. Call from any thread;
   each source from one thread at a time. */
#ifndef PREPROCESS_MODEL_SOURCE_H
#define PREPROCESS_MODEL_SOURCE_H
#include <stddef.h>
#include <stdint.h>

#include "plant/models/model_refusal.h"

#ifdef __cplusplus
extern "C" {
#endif

struct model_source {
    char *path, *folder; /* folder: the model's folder, as returned by realpath() */
    unsigned char *bytes;
    size_t size;
    uint64_t hash; /* XXH3-64 over the file and the files it refers to */
};

/* Reads the file at `path` and hashes it together with the files it refers to. Checks a GLB's chunk lengths, JSON syntax and
 * nesting depth, and that every referenced file exists inside the model's folder. Returns false with the reason in why;
 * model_source_finish() then need not be called. */
bool model_source_open(struct model_source *source, const char *path, char why[MODEL_WHY_BYTES]);
/* Frees the bytes of the model file. */
void model_source_finish(struct model_source *source);

#ifdef __cplusplus
}
#endif
#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A model file as it lies on disk: its bytes, and a hash over it and every file it names. */
#ifndef PREPROCESS_MODEL_SOURCE_H
#define PREPROCESS_MODEL_SOURCE_H
#include <stddef.h>
#include <stdint.h>

#include "preprocess/model/refusal.h"

#ifdef __cplusplus
extern "C" {
#endif

struct model_source {
    char *path, *folder; /* folder: as realpath names it */
    unsigned char *bytes;
    size_t size;
    uint64_t hash; /* XXH3-64 over the file and the files its URIs name */
};

/* False: why says what is wrong; nothing to finish. Checked so far: a GLB's lengths, JSON's syntax and depth, and that every file it names
   is there, inside the folder. */
bool model_source_open(struct model_source *source, const char *path, char why[MODEL_WHY_BYTES]);
void model_source_finish(struct model_source *source);

#ifdef __cplusplus
}
#endif
#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A model file as it lies on disk: its bytes, a hash over it and every file it names, and a first check of its JSON, before a
   library that trusts its input sees it. */
#ifndef PREPROCESS_MODEL_SOURCE_H
#define PREPROCESS_MODEL_SOURCE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define MODEL_WHY_BYTES 400
#define MODEL_MAX_BYTES ((size_t)4 << 30)

struct model_source {
    char *path, *folder; /* folder: as realpath names it */
    unsigned char *bytes;
    size_t size;
    bool binary;   /* GLB */
    uint64_t hash; /* XXH3-64 over the file and the files its URIs name */
};

/* False: why says what is wrong; nothing to finish. Checked: a GLB's lengths, JSON syntax and depth, URIs that leave the folder, buffer
   views that leave their buffer. */
bool model_source_open(struct model_source *source, const char *path, char why[MODEL_WHY_BYTES]);
void model_source_finish(struct model_source *source);

/* The file that a relative URI (decoded) names, if it is a file inside `folder`; free with free(). NULL: it is not. */
char *model_source_resolve(const char *folder, const char *name);

#ifdef __cplusplus
}
#endif
#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A glTF document reduced to its plain form: JSON checked and without compression, external files or data URIs; buffers and images are in
   memory beside it. */
#ifndef PREPROCESS_MODEL_DOCUMENT_H
#define PREPROCESS_MODEL_DOCUMENT_H
#include "preprocess/model/model_source.h"

#ifdef __cplusplus
extern "C" {
#endif

struct document_bytes {
    const unsigned char *at; /* in `own`, the source's bytes, or another's */
    size_t size;
    unsigned char *own; /* NULL: somebody else's */
};

struct document_image {
    char *name, *missing;        /* missing: why it could not be read; NULL: it was */
    struct document_bytes bytes; /* as it lies in the file: PNG, JPEG, WebP */
};

struct model_document {
    char *json; /* no buffers, images, skins or animations in it; every buffer view lies inside buffers[its buffer] */
    size_t json_bytes;
    struct document_bytes *buffers;
    struct document_image *images;
    char **looks; /* a text for each extension that is left out */
    size_t buffer_count, image_count, look_count;
    size_t total_bytes; /* of the buffers, but for those that are all zeros */
};

/* Builds the plain document of a source file, which must outlive it. Returns false with the reason in why, and then there is nothing to
   finish. */
bool model_document_open(struct model_document *document, const struct model_source *source, char why[MODEL_WHY_BYTES]);
/* Frees the document. */
void model_document_finish(struct model_document *document);

#ifdef __cplusplus
}
#endif
#endif

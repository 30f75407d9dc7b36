/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A normalised glTF document: checked JSON without compression, external files or data URIs; buffers and images are in memory. */
#ifndef PREPROCESS_MODEL_DOCUMENT_H
#define PREPROCESS_MODEL_DOCUMENT_H
#include "preprocess/model/model_source.h"

#ifdef __cplusplus
extern "C" {
#endif

struct document_bytes {
    const unsigned char *at; /* the buffer's bytes: in `own`, in the source file, or in another buffer */
    size_t size;
    unsigned char *own; /* allocation to free; NULL: the bytes belong to another object */
};

struct document_image {
    /* name: name of the image, for messages; missing: why the image could not be read; NULL: it was read */
    char *name, *missing;
    struct document_bytes bytes; /* bytes of the image as stored in the file: PNG, JPEG or WebP */
};

struct model_document {
    char *json; /* JSON text without buffers, images, skins and animations; each buffer view lies within its buffer in buffers[] */
    size_t json_bytes;
    struct document_bytes *buffers;
    struct document_image *images;
    char **looks; /* texts for the report, one for each ignored extension */
    size_t buffer_count, image_count, look_count;
    size_t total_bytes; /* total bytes of all buffers, except those with only zeros */
};

/* Normalises a source file, which must outlive the document. Returns false with the reason in why; model_document_finish() then
 * need not be called. */
bool model_document_open(struct model_document *document, const struct model_source *source, char why[MODEL_WHY_BYTES]);
/* Frees the document. */
void model_document_finish(struct model_document *document);

#ifdef __cplusplus
}
#endif
#endif

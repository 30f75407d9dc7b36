/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files that make a model plain (model_document*.c). */
#ifndef PREPROCESS_MODEL_DOCUMENT_IMPL_H
#define PREPROCESS_MODEL_DOCUMENT_IMPL_H
#include "preprocess/model/model_document.h"
#include "preprocess/model/model_json.h"

struct document_work { /* a document in the making; root's types and references are right (model_rules.h) */
    json_t *root;
    const struct model_source *source;
    struct model_bytes binary;
    struct model_document *document;
    size_t buffer_room;
    char *why;
};

/* Takes `own`, also on failure. The buffer's number. */
size_t document_add_buffer(struct document_work *work, unsigned char *own, size_t size);
/* Appends a buffer view of that buffer and makes the accessor use it. */
void document_point_accessor(struct document_work *work, json_t *accessor, size_t buffer);
/* Bytes of a buffer, if they are there; `what` begins the reason. */
bool document_range(const struct document_work *work, size_t buffer, uint64_t offset, uint64_t length, const char *what,
                    struct model_bytes *out);

/* Bytes of one element of an accessor. 0: its type is not of glTF 2.0. */
size_t document_element_bytes(const json_t *accessor, int *component_type, int *width);

/* EXT_meshopt_compression: views become plain ones, of buffers of their own. */
bool document_expand_meshopt(struct document_work *work);
/* KHR_draco_mesh_compression: primitives get plain accessors. */
bool document_expand_draco(struct document_work *work);

#endif

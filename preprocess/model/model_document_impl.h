/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declarations shared by the files that normalise a glTF document (model_document*.c). */
#ifndef PREPROCESS_MODEL_DOCUMENT_IMPL_H
#define PREPROCESS_MODEL_DOCUMENT_IMPL_H
#include "preprocess/model/model_document.h"
#include "preprocess/model/model_json.h"

struct document_work { /* a document being normalised; model_rules.h has already checked types and references in `root` */
    json_t *root;
    const struct model_source *source;
    struct model_bytes binary;
    struct model_document *document;
    size_t buffer_room;
    char *why;
};

/* Returns the integer under `key` of a JSON object, or 0 if there is none. */
static inline uint64_t document_number(const json_t *object, const char *key)
{
    return (uint64_t)json_integer_value(json_object_get(object, key));
}

/* Appends a buffer to the glTF document and takes ownership of bytes.own, even on failure. Returns the buffer's index. */
size_t document_add_buffer(struct document_work *work, struct document_bytes bytes);
/* Appends a buffer view over the whole of `buffer`, and points the accessor to it. */
void document_point_accessor(struct document_work *work, json_t *accessor, size_t buffer);
/* Writes the address of `length` bytes at `offset` of a buffer to *out. Returns false if the buffer is too short; the error
 * text in work->why begins with `what`. */
bool document_range(const struct document_work *work, size_t buffer, uint64_t offset, uint64_t length, const char *what,
                    struct model_bytes *out);

/* Returns the size in bytes of an accessor's element, and writes the component type and the number of components. Returns 0 if
 * glTF 2.0 has no such type. */
size_t document_element_bytes(const json_t *accessor, int *component_type, int *width);

/* Decodes EXT_meshopt_compression: each compressed buffer view becomes a plain one over a new buffer. Returns false with the reason in
   work->why. */
bool document_expand_meshopt(struct document_work *work);
/* Decodes KHR_draco_mesh_compression: compressed primitives get plain accessors over new buffers. Returns false with the reason in
   work->why. */
bool document_expand_draco(struct document_work *work);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Manages a document's buffers, byte ranges within them, and accessors over them. */
#include <inttypes.h>
#include <string.h>

#include "base/mem.h"
#include "preprocess/model/model_document_impl.h"

size_t document_add_buffer(struct document_work *work, struct document_bytes bytes)
{
    struct model_document *d = work->document;
    mem_grow(&d->buffers, &work->buffer_room, d->buffer_count + 1, sizeof(*d->buffers));
    d->buffers[d->buffer_count] = bytes;
    d->total_bytes += bytes.size;
    return d->buffer_count++;
}

bool document_range(const struct document_work *work, size_t buffer, uint64_t offset, uint64_t length, const char *what,
                    struct model_bytes *out)
{
    const struct document_bytes *b = &work->document->buffers[buffer];
    if (length > 0 && !b->at)
        return wrong(work->why, "incomplete glTF file: %s refers to buffer %zu, which has no data", what, buffer);
    if (offset > b->size || length > b->size - offset)
        return wrong(work->why,
                     "incomplete glTF file: %s: its bytes, from %" PRIu64 " on, %" PRIu64 " bytes, lie outside its buffer of %zu bytes",
                     what, offset, length, b->size);
    *out = (struct model_bytes){ length ? b->at + offset : NULL, (size_t)length };
    return true;
}

size_t document_element_bytes(const json_t *accessor, int *component_type, int *width)
{
    static const char *const types[] = { "SCALAR", "VEC2", "VEC3", "VEC4", "MAT4" };
    static const int widths[] = { 1, 2, 3, 4, 16 };
    const char *type = json_string_value(json_object_get(accessor, "type"));
    *component_type = (int)document_number(accessor, "componentType");
    *width = 0;
    for (size_t i = 0; type && i < sizeof(types) / sizeof(types[0]); i++)
        if (strcmp(type, types[i]) == 0)
            *width = widths[i];
    switch (*component_type) {
    case 5120:
    case 5121: return (size_t)*width;
    case 5122:
    case 5123: return 2 * (size_t)*width;
    case 5125:
    case 5126: return 4 * (size_t)*width;
    default: return 0;
    }
}

void document_point_accessor(struct document_work *work, json_t *accessor, size_t buffer)
{
    json_t *views = json_object_get(work->root, "bufferViews");
    if (!views) {
        views = json_array();
        json_object_set_new(work->root, "bufferViews", views);
    }
    json_array_append_new(views, json_pack("{s:I,s:I}", "buffer", (json_int_t)buffer, "byteLength",
                                           (json_int_t)work->document->buffers[buffer].size));
    json_object_set_new(accessor, "bufferView", json_integer((json_int_t)json_array_size(views) - 1));
    json_object_del(accessor, "byteOffset");
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes EXT_meshopt_compression: compressed buffer views become plain buffer views. */
#include <inttypes.h>
#include <meshoptimizer.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "preprocess/model/model_document_impl.h"

enum mode { ATTRIBUTES, TRIANGLES, INDICES };
enum meshopt_filter { NONE, OCTAHEDRAL, QUATERNION, EXPONENTIAL };
static const char *const modes[] = { "ATTRIBUTES", "TRIANGLES", "INDICES" };
static const char *const filters[] = { "NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL" };

/* Largest accepted ratio of decoded to compressed bytes. The compression itself reaches at most 64 (vertex data: 1 byte for 64
   bytes; indices: a third of a byte for up to 4 bytes). */
#define BYTES_PER_BYTE 128u

struct meshopt_view {
    uint64_t count, stride;
    int mode, filter; /* compression mode and filter (EXT_meshopt_compression); -1: unknown value */
    struct model_bytes from;
};

static int number_in(const char *const *names, int count, const char *name)
{
    for (int i = 0; i < count; i++)
        if (strcmp(names[i], name) == 0)
            return i;
    return -1;
}

static bool shape_good(const struct meshopt_view *p, const char *what, char *why)
{
    bool index = p->mode == TRIANGLES || p->mode == INDICES;
    if (p->mode < 0 || p->filter < 0)
        return wrong(why, "invalid glTF file: %s: EXT_meshopt_compression has an unknown mode or filter", what);
    if (index ? (p->stride != 2 && p->stride != 4) || p->filter != NONE || (p->mode == TRIANGLES && p->count % 3 != 0)
              : p->stride < 4 || p->stride > 256 || p->stride % 4 != 0)
        return wrong(why, "invalid glTF file: %s: EXT_meshopt_compression: %" PRIu64 " elements of %" PRIu64 " bytes cannot be of mode %s",
                     what, p->count, p->stride, modes[p->mode]);
    if ((p->filter == OCTAHEDRAL && p->stride != 4 && p->stride != 8) || (p->filter == QUATERNION && p->stride != 8))
        return wrong(why, "invalid glTF file: %s: EXT_meshopt_compression: filter %s is not allowed for elements of %" PRIu64 " bytes",
                     what, filters[p->filter], p->stride);
    if (p->count > UINT32_MAX || p->count * p->stride > (uint64_t)p->from.size * BYTES_PER_BYTE)
        return wrong(why, "invalid glTF file: %s: EXT_meshopt_compression: %zu bytes cannot hold %" PRIu64 " elements of %" PRIu64 " bytes",
                     what, p->from.size, p->count, p->stride);
    return true;
}

static bool decode(const struct meshopt_view *p, unsigned char *out)
{
    int status = p->mode == ATTRIBUTES  ? meshopt_decodeVertexBuffer(out, p->count, p->stride, p->from.at, p->from.size)
                 : p->mode == TRIANGLES ? meshopt_decodeIndexBuffer(out, p->count, p->stride, p->from.at, p->from.size)
                                        : meshopt_decodeIndexSequence(out, p->count, p->stride, p->from.at, p->from.size);
    if (status != 0)
        return false;
    if (p->filter == OCTAHEDRAL)
        meshopt_decodeFilterOct(out, p->count, p->stride);
    else if (p->filter == QUATERNION)
        meshopt_decodeFilterQuat(out, p->count, p->stride);
    else if (p->filter == EXPONENTIAL)
        meshopt_decodeFilterExp(out, p->count, p->stride);
    return true;
}

static bool expand(struct document_work *work, const char *what, json_t *view, const json_t *extension)
{
    const char *filter = json_string_value(json_object_get(extension, "filter"));
    struct meshopt_view p = { .count = (uint64_t)json_integer_value(json_object_get(extension, "count")),
                              .stride = (uint64_t)json_integer_value(json_object_get(extension, "byteStride")),
                              .mode = number_in(modes, 3, json_string_value(json_object_get(extension, "mode"))),
                              .filter = filter ? number_in(filters, 4, filter) : NONE };
    size_t buffer = (size_t)json_integer_value(json_object_get(extension, "buffer"));
    uint64_t offset = (uint64_t)json_integer_value(json_object_get(extension, "byteOffset"));
    uint64_t length = (uint64_t)json_integer_value(json_object_get(extension, "byteLength"));
    if (!document_range(work, buffer, offset, length, what, &p.from) || !shape_good(&p, what, work->why))
        return false;
    size_t size = (size_t)(p.count * p.stride);
    if (size != (size_t)json_integer_value(json_object_get(view, "byteLength")))
        return wrong(work->why, "invalid glTF file: %s: EXT_meshopt_compression: the data decodes to %zu bytes, but byteLength is %lld",
                     what, size, json_integer_value(json_object_get(view, "byteLength")));
    unsigned char *own = mem_try_array(size + 1, 1);
    if (!own)
        return wrong(work->why, "%s: cannot decode %zu bytes of meshopt-compressed data: out of memory", what, size);
    if (size > 0 && !decode(&p, own)) {
        mem_free(own);
        return wrong(work->why, "invalid glTF file: %s: the %zu bytes of compressed data (EXT_meshopt_compression) are damaged", what,
                     p.from.size);
    }
    json_object_set_new(view, "buffer", json_integer((json_int_t)document_add_buffer(work, (struct document_bytes){ own, size, own })));
    json_object_set_new(view, "byteOffset", json_integer(0));
    return true;
}

bool document_expand_meshopt(struct document_work *work)
{
    json_t *views = json_object_get(work->root, "bufferViews");
    for (size_t i = 0; i < json_array_size(views); i++) {
        char what[40];
        json_t *view = json_array_get(views, i);
        const json_t *extension = json_object_get(json_object_get(view, "extensions"), "EXT_meshopt_compression");
        snprintf(what, sizeof(what), "bufferView %zu", i);
        if (extension && !expand(work, what, view, extension))
            return false;
        json_object_del(view, "extensions");
    }
    return true;
}

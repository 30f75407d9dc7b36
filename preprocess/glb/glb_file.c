/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds a GLB file's accessors as JSON (jansson), and its buffer as bytes. */
#include "preprocess/glb/glb_file.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/files/atomic_file.h"

void glb_file_init(struct glb_file *file)
{
    *file = (struct glb_file){ .views = json_array(), .accessors = json_array() };
}

void glb_file_finish(struct glb_file *file)
{
    json_decref(file->views);
    json_decref(file->accessors);
    text_finish(&file->bytes);
}

/* `each` (bytes per element) is a multiple of 4, so all buffer views are aligned */
int glb_file_add(struct glb_file *file, const void *bytes, size_t each, size_t count, int component, const char *type, int target)
{
    json_array_append_new(file->views, json_pack("{s:i,s:I,s:I,s:i}", "buffer", 0, "byteOffset", (json_int_t)file->bytes.length,
                                                 "byteLength", (json_int_t)(each * count), "target", target));
    text_add_bytes(&file->bytes, bytes, each * count);
    json_t *accessor = json_pack("{s:I,s:i,s:I,s:s}", "bufferView", (json_int_t)json_array_size(file->views) - 1, "componentType",
                                 component, "count", (json_int_t)count, "type", type);
    if (component == GLB_USHORT)
        json_object_set_new(accessor, "normalized", json_true());
    json_array_append_new(file->accessors, accessor);
    return (int)json_array_size(file->accessors) - 1;
}

int glb_file_add_positions(struct glb_file *file, const float (*positions)[3], size_t count)
{
    int number = glb_file_add(file, positions, sizeof(*positions), count, GLB_FLOAT, "VEC3", GLB_VERTICES);
    json_t *low = json_array(), *high = json_array(), *accessor = json_array_get(file->accessors, (size_t)number);
    for (int axis = 0; axis < 3; axis++) {
        float least = INFINITY, most = -INFINITY;
        for (size_t i = 0; i < count; i++) {
            least = fminf(least, positions[i][axis]);
            most = fmaxf(most, positions[i][axis]);
        }
        json_array_append_new(low, json_real((double)least));
        json_array_append_new(high, json_real((double)most));
    }
    json_object_set_new(accessor, "min", low);
    json_object_set_new(accessor, "max", high);
    return number;
}

static void begin_chunk(struct text *out, const char *type, size_t count)
{
    uint32_t padded = (uint32_t)(count + 3) / 4 * 4;
    text_add_bytes(out, &padded, 4);
    text_add_bytes(out, type, 4);
}

/* Writes the buffer's bytes to the file without copying them in memory, because they may be gigabytes. */
int glb_file_put(json_t *root, const struct text *bytes, const char *path)
{
    char *json = json_dumps(root, JSON_COMPACT | JSON_REAL_PRECISION(17));
    if (!json)
        return -ENOMEM;
    int status = -EFBIG;
    size_t json_bytes = strlen(json), json_fill = (4 - json_bytes % 4) % 4, fill = (4 - bytes->length % 4) % 4;
    if (bytes->length + json_bytes < UINT32_MAX - 64) {
        struct text head = { 0 }, middle = { 0 };
        uint32_t total = (uint32_t)(12 + 8 + json_bytes + json_fill + (bytes->length ? 8 + bytes->length + fill : 0));
        text_add_bytes(&head, "glTF\2\0\0\0", 8);
        text_add_bytes(&head, &total, 4);
        begin_chunk(&head, "JSON", json_bytes);
        text_add_bytes(&middle, "   ", json_fill);
        if (bytes->length)
            begin_chunk(&middle, "BIN\0", bytes->length);
        const struct atomic_file_part parts[] = {
            { head.at, head.length }, { json, json_bytes }, { middle.at, middle.length }, { bytes->at, bytes->length }, { "\0\0\0", fill }
        };
        status = atomic_file_put_parts(path, parts, sizeof(parts) / sizeof(parts[0]));
        text_finish(&head);
        text_finish(&middle);
    }
    free(json);
    return status;
}

int glb_file_save(struct glb_file *file, json_t *root, const char *path)
{
    if (file->bytes.length > 0) { /* glTF forbids empty arrays */
        json_object_set(root, "accessors", file->accessors);
        json_object_set(root, "bufferViews", file->views);
        json_object_set_new(root, "buffers", json_pack("[{s:I}]", "byteLength", (json_int_t)file->bytes.length));
    }
    return glb_file_put(root, &file->bytes, path);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Accessors grow by jansson, the one buffer as bytes. */
#include "preprocess/glb/glb_file.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/atomic_file.h"

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

/* Every element is a multiple of 4 bytes long, so every view begins at one. */
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

static void add_chunk(struct text *out, const char *type, const void *bytes, size_t count, char fill)
{
    uint32_t padded = (uint32_t)(count + 3) / 4 * 4;
    text_add_bytes(out, &padded, 4);
    text_add_bytes(out, type, 4);
    text_add_bytes(out, bytes, count);
    for (size_t i = count; i < padded; i++)
        text_add_bytes(out, &fill, 1);
}

int glb_file_save(struct glb_file *file, json_t *root, const char *path)
{
    if (file->bytes.length > 0) { /* glTF allows no empty lists */
        json_object_set(root, "accessors", file->accessors);
        json_object_set(root, "bufferViews", file->views);
        json_object_set_new(root, "buffers", json_pack("[{s:I}]", "byteLength", (json_int_t)file->bytes.length));
    }
    char *json = json_dumps(root, JSON_COMPACT | JSON_REAL_PRECISION(17));
    if (!json)
        return -ENOMEM;
    int status = -EFBIG;
    if (file->bytes.length + strlen(json) < UINT32_MAX - 64) {
        struct text out = { 0 };
        text_add_bytes(&out, "glTF\2\0\0\0\0\0\0\0", 12);
        add_chunk(&out, "JSON", json, strlen(json), ' ');
        if (file->bytes.length > 0)
            add_chunk(&out, "BIN\0", file->bytes.at, file->bytes.length, 0);
        uint32_t total = (uint32_t)out.length;
        memcpy(out.at + 8, &total, sizeof(total));
        status = atomic_file_put(path, out.at, out.length);
        text_finish(&out);
    }
    free(json);
    return status;
}

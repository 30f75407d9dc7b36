/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Putting a GLB file together: JSON grows by jansson, its one buffer as bytes. */
#include "preprocess/debug/glb_writer.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/atomic_file.h"
#include "base/mem.h"

enum { FLOAT = 5126, USHORT = 5123, UINT = 5125, VERTICES = 34962, INDICES = 34963 };

struct glb_writer {
    json_t *root, *views, *accessors, *materials, *meshes, *nodes, *children;
    struct text bytes;
};

uint16_t glb_linear(uint8_t srgb)
{
    double c = srgb / 255.0;
    return (uint16_t)lround(65535 * (c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4)));
}

struct glb_writer *glb_writer_create(const char *name)
{
    struct glb_writer *w = mem_new(sizeof(*w));
    w->views = json_array();
    w->accessors = json_array();
    w->materials = json_array();
    w->meshes = json_array();
    w->children = json_array();
    w->nodes = json_pack("[{s:s,s:O}]", "name", name, "children", w->children);
    w->root = json_pack("{s:{s:s,s:s},s:[s],s:i,s:[{s:[i]}],s:O,s:O,s:O,s:O,s:O}", "asset", "version", "2.0", "generator", "plantcast-prep",
                        "extensionsUsed", "KHR_materials_unlit", "scene", 0, "scenes", "nodes", 0, "nodes", w->nodes, "meshes", w->meshes,
                        "materials", w->materials, "accessors", w->accessors, "bufferViews", w->views);
    return w;
}

void glb_writer_destroy(struct glb_writer **writer)
{
    struct glb_writer *w = *writer;
    if (!w)
        return;
    json_t *const owned[] = { w->root, w->views, w->accessors, w->materials, w->meshes, w->nodes, w->children };
    for (size_t i = 0; i < sizeof(owned) / sizeof(owned[0]); i++)
        json_decref(owned[i]);
    text_finish(&w->bytes);
    mem_free(w);
    *writer = NULL;
}

/* Every element is a multiple of 4 bytes long, so every view begins at one. */
static int add_accessor(struct glb_writer *w, const void *bytes, size_t each, size_t count, int component, const char *type, int target)
{
    json_t *view = json_pack("{s:i,s:I,s:I,s:i}", "buffer", 0, "byteOffset", (json_int_t)w->bytes.length, "byteLength",
                             (json_int_t)(each * count), "target", target);
    json_array_append_new(w->views, view);
    text_add_bytes(&w->bytes, bytes, each * count);
    json_t *accessor = json_pack("{s:I,s:i,s:I,s:s}", "bufferView", (json_int_t)json_array_size(w->views) - 1, "componentType", component,
                                 "count", (json_int_t)count, "type", type);
    if (component == USHORT)
        json_object_set_new(accessor, "normalized", json_true());
    json_array_append_new(w->accessors, accessor);
    return (int)json_array_size(w->accessors) - 1;
}

static int add_positions(struct glb_writer *w, const struct glb_shape *shape)
{
    int number = add_accessor(w, shape->positions, sizeof(*shape->positions), shape->vertex_count, FLOAT, "VEC3", VERTICES);
    json_t *low = json_array(), *high = json_array(), *accessor = json_array_get(w->accessors, (size_t)number);
    for (int axis = 0; axis < 3; axis++) {
        float least = INFINITY, most = -INFINITY;
        for (size_t i = 0; i < shape->vertex_count; i++) {
            least = fminf(least, shape->positions[i][axis]);
            most = fmaxf(most, shape->positions[i][axis]);
        }
        json_array_append_new(low, json_real((double)least));
        json_array_append_new(high, json_real((double)most));
    }
    json_object_set_new(accessor, "min", low);
    json_object_set_new(accessor, "max", high);
    return number;
}

static int add_material(struct glb_writer *w, const struct glb_shape *shape)
{
    json_t *color = json_array();
    for (int i = 0; i < 4; i++)
        json_array_append_new(color, json_real(shape->colors || i == 3 ? 1 : glb_linear(shape->color[i]) / 65535.0));
    json_array_append_new(w->materials,
                          json_pack("{s:{s:o,s:f,s:f},s:b,s:{s:{}}}", "pbrMetallicRoughness", "baseColorFactor", color, "metallicFactor",
                                    0.0, "roughnessFactor", 1.0, "doubleSided", 1, "extensions", "KHR_materials_unlit"));
    return (int)json_array_size(w->materials) - 1;
}

void glb_writer_add(struct glb_writer *w, const char *name, const struct glb_shape *shape)
{
    if (shape->vertex_count == 0 || (shape->indices && shape->index_count == 0))
        return;
    json_t *primitive = json_pack("{s:{s:i},s:i,s:i}", "attributes", "POSITION", add_positions(w, shape), "mode", (int)shape->mode,
                                  "material", add_material(w, shape));
    if (shape->colors)
        json_object_set_new(json_object_get(primitive, "attributes"), "COLOR_0",
                            json_integer(
                                add_accessor(w, shape->colors, sizeof(*shape->colors), shape->vertex_count, USHORT, "VEC4", VERTICES)));
    if (shape->indices)
        json_object_set_new(primitive, "indices",
                            json_integer(
                                add_accessor(w, shape->indices, sizeof(*shape->indices), shape->index_count, UINT, "SCALAR", INDICES)));
    json_array_append_new(w->meshes, json_pack("{s:s,s:[o]}", "name", name, "primitives", primitive));
    json_array_append_new(w->nodes, json_pack("{s:s,s:I}", "name", name, "mesh", (json_int_t)json_array_size(w->meshes) - 1));
    json_array_append_new(w->children, json_integer((json_int_t)json_array_size(w->nodes) - 1));
}

static void add_chunk(struct text *file, const char *type, const void *bytes, size_t count, char fill)
{
    uint32_t padded = (uint32_t)(count + 3) / 4 * 4;
    text_add_bytes(file, &padded, 4);
    text_add_bytes(file, type, 4);
    text_add_bytes(file, bytes, count);
    for (size_t i = count; i < padded; i++)
        text_add_bytes(file, &fill, 1);
}

int glb_writer_save(struct glb_writer *w, const char *path)
{
    struct text file = { 0 };
    if (w->bytes.length > UINT32_MAX / 2)
        return -EFBIG;
    json_object_set_new(w->root, "buffers", json_pack("[{s:I}]", "byteLength", (json_int_t)w->bytes.length));
    char *json = json_dumps(w->root, JSON_COMPACT | JSON_REAL_PRECISION(17));
    if (!json)
        return -ENOMEM;
    text_add_bytes(&file, "glTF\2\0\0\0\0\0\0\0", 12);
    add_chunk(&file, "JSON", json, strlen(json), ' ');
    add_chunk(&file, "BIN\0", w->bytes.at, w->bytes.length, 0);
    uint32_t total = (uint32_t)file.length;
    memcpy(file.at + 8, &total, sizeof(total));
    int status = atomic_file_put(path, file.at, file.length);
    text_finish(&file);
    free(json);
    return status;
}

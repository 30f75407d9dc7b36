/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds a GLB file: the JSON with jansson, the buffer as bytes. */
#include "preprocess/debug/glb_writer.h"

#include <jansson.h>
#include <math.h>

#include "base/files/atomic_file.h"
#include "base/image/srgb.h"
#include "base/mem.h"
#include "preprocess/glb/glb_file.h"

struct glb_writer {
    json_t *root, *materials, *meshes, *nodes, *children;
    struct glb_file file;
};

uint16_t glb_linear(uint8_t srgb)
{
    return (uint16_t)lround(65535 * linear_from_srgb(srgb / 255.0));
}

struct glb_writer *glb_writer_create(const char *name)
{
    struct glb_writer *w = mem_new(sizeof(*w));
    glb_file_init(&w->file);
    w->materials = json_array();
    w->meshes = json_array();
    w->children = json_array();
    w->nodes = json_pack("[{s:s,s:O}]", "name", name, "children", w->children);
    w->root = json_pack("{s:{s:s,s:s},s:[s],s:i,s:[{s:[i]}],s:O,s:O,s:O}", "asset", "version", "2.0", "generator", "plantcast-prep",
                        "extensionsUsed", "KHR_materials_unlit", "scene", 0, "scenes", "nodes", 0, "nodes", w->nodes, "meshes", w->meshes,
                        "materials", w->materials);
    return w;
}

void glb_writer_destroy(struct glb_writer **writer)
{
    struct glb_writer *w = *writer;
    if (!w)
        return;
    json_t *const owned[] = { w->root, w->materials, w->meshes, w->nodes, w->children };
    for (size_t i = 0; i < sizeof(owned) / sizeof(owned[0]); i++)
        json_decref(owned[i]);
    glb_file_finish(&w->file);
    mem_free(w);
    *writer = NULL;
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
    json_t *primitive =
        json_pack("{s:{s:i},s:i,s:i}", "attributes", "POSITION", glb_file_add_positions(&w->file, shape->positions, shape->vertex_count),
                  "mode", (int)shape->mode, "material", add_material(w, shape));
    if (shape->colors)
        json_object_set_new(json_object_get(primitive, "attributes"), "COLOR_0",
                            json_integer(glb_file_add(&w->file, shape->colors, sizeof(*shape->colors), shape->vertex_count, GLB_USHORT,
                                                      "VEC4", GLB_VERTICES)));
    if (shape->indices)
        json_object_set_new(primitive, "indices",
                            json_integer(glb_file_add(&w->file, shape->indices, sizeof(*shape->indices), shape->index_count, GLB_UINT,
                                                      "SCALAR", GLB_INDICES)));
    json_array_append_new(w->meshes, json_pack("{s:s,s:[o]}", "name", name, "primitives", primitive));
    json_array_append_new(w->nodes, json_pack("{s:s,s:I}", "name", name, "mesh", (json_int_t)json_array_size(w->meshes) - 1));
    json_array_append_new(w->children, json_integer((json_int_t)json_array_size(w->nodes) - 1));
}

int glb_writer_save(struct glb_writer *w, const char *path)
{
    return glb_file_save(&w->file, w->root, path);
}

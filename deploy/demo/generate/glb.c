/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The binary glTF 2.0 container: a JSON chunk and one buffer of vertices and indices. */
#include "glb.h"

#include <float.h>
#include <jansson.h>
#include <string.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "base/text/text.h"

#define GL_FLOAT 5126
#define GL_UNSIGNED_INT 5125
#define GL_ARRAY_BUFFER 34962
#define GL_ELEMENT_ARRAY_BUFFER 34963

struct glb {
    const struct model *model;
    json_t *views, *accessors, *meshes, *materials, *nodes;
    struct text buffer;
};

static void append_u32(struct text *out, uint32_t value)
{
    unsigned char bytes[4] = { value & 255, value >> 8 & 255, value >> 16 & 255, value >> 24 & 255 };
    text_add_bytes(out, bytes, 4);
}

static json_t *triple(const float v[3])
{
    return json_pack("[f,f,f]", (double)v[0], (double)v[1], (double)v[2]);
}

/* Views are for what was appended since `offset`. Returns the accessor's index. */
static json_int_t add_accessor(struct glb *glb, size_t offset, size_t count, int component, const char *type, int target)
{
    json_array_append_new(glb->views, json_pack("{s:i,s:I,s:I,s:i}", "buffer", 0, "byteOffset", (json_int_t)offset, "byteLength",
                                                (json_int_t)(glb->buffer.length - offset), "target", target));
    json_array_append_new(glb->accessors, json_pack("{s:I,s:i,s:I,s:s}", "bufferView", (json_int_t)json_array_size(glb->views) - 1,
                                                    "componentType",
                                                    component, "count", (json_int_t)count, "type", type));
    return (json_int_t)json_array_size(glb->accessors) - 1;
}

static void add_mesh(struct glb *glb, const struct model_mesh *part)
{
    const struct mesh *mesh = &part->mesh;
    float low[3] = { FLT_MAX, FLT_MAX, FLT_MAX }, high[3] = { -FLT_MAX, -FLT_MAX, -FLT_MAX };
    size_t offset = glb->buffer.length;
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        const float *p = mesh->vertices[i].position;
        text_add_bytes(&glb->buffer, p, sizeof(mesh->vertices[i].position));
        for (int k = 0; k < 3; k++) {
            low[k] = p[k] < low[k] ? p[k] : low[k];
            high[k] = p[k] > high[k] ? p[k] : high[k];
        }
    }
    json_int_t positions = add_accessor(glb, offset, mesh->vertex_count, GL_FLOAT, "VEC3", GL_ARRAY_BUFFER);
    json_t *accessor = json_array_get(glb->accessors, (size_t)positions);
    json_object_set_new(accessor, "min", triple(low));
    json_object_set_new(accessor, "max", triple(high));
    offset = glb->buffer.length;
    for (size_t i = 0; i < mesh->vertex_count; i++)
        text_add_bytes(&glb->buffer, mesh->vertices[i].normal, sizeof(mesh->vertices[i].normal));
    json_int_t normals = add_accessor(glb, offset, mesh->vertex_count, GL_FLOAT, "VEC3", GL_ARRAY_BUFFER);
    offset = glb->buffer.length;
    for (size_t i = 0; i < mesh->index_count; i++)
        append_u32(&glb->buffer, mesh->indices[i]);
    json_int_t indices = add_accessor(glb, offset, mesh->index_count, GL_UNSIGNED_INT, "SCALAR", GL_ELEMENT_ARRAY_BUFFER);
    json_array_append_new(glb->meshes, json_pack("{s:s,s:[{s:{s:I,s:I},s:I,s:i}]}", "name", part->name, "primitives", "attributes",
                                                 "POSITION",
                                                 positions, "NORMAL", normals, "indices", indices, "material", (int)part->material));
}

static double linear(double srgb)
{
    return srgb <= 0.04045 ? srgb / 12.92 : pow((srgb + 0.055) / 1.055, 2.4);
}

static void add_materials(struct glb *glb)
{
    for (int i = 0; i < MATERIAL_COUNT; i++) {
        const struct material_look *look = material_looks + i;
        const double *srgb = look->srgb;
        json_t *color = json_pack("[f,f,f,f]", linear(srgb[0]), linear(srgb[1]), linear(srgb[2]), 1.0);
        json_t *pbr = json_pack("{s:o,s:f,s:f}", "baseColorFactor", color, "metallicFactor", look->metallic, "roughnessFactor",
                                look->roughness);
        json_array_append_new(glb->materials, json_pack("{s:s,s:o}", "name", look->name, "pbrMetallicRoughness", pbr));
    }
}

static void add_placement(json_t *node, const struct frame *at)
{
    const struct frame straight = frame_at(at->o.x, at->o.y, at->o.z);
    if (memcmp(&straight, at, sizeof(straight)) != 0)
        json_object_set_new(node, "matrix", json_pack("[f,f,f,i,f,f,f,i,f,f,f,i,f,f,f,i]", at->x.x, at->x.y, at->x.z, 0, at->y.x, at->y.y,
                                                      at->y.z, 0,
                                                      at->z.x, at->z.y, at->z.z, 0, at->o.x, at->o.y, at->o.z, 1));
    else if (vec_length(at->o) > 0.0)
        json_object_set_new(node, "translation", json_pack("[f,f,f]", at->o.x, at->o.y, at->o.z));
}

/* Node 0 is the root; the model's node i is node i + 1. */
static void add_nodes(struct glb *glb)
{
    const struct model *model = glb->model;
    json_t **children = mem_array(model->node_count + 1, sizeof(*children));
    json_t *root = json_pack("{s:s,s:[i,i,i,i,i,i,i,i,i,i,i,i,i,i,i,i]}", "name", "plant", "matrix", 1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0,
                             0, 0, 0, 1);
    json_array_append_new(glb->nodes, root);
    for (size_t i = 0; i < model->node_count; i++) {
        const struct model_node *node = model->nodes + i;
        json_t *object = json_pack("{s:s}", "name", node->name);
        if (node->mesh >= 0)
            json_object_set_new(object, "mesh", json_integer(node->mesh));
        add_placement(object, &node->at);
        json_array_append_new(glb->nodes, object);
        size_t parent = (size_t)(node->parent + 1);
        if (!children[parent])
            children[parent] = json_array();
        json_array_append_new(children[parent], json_integer((json_int_t)i + 1));
    }
    for (size_t i = 0; i <= model->node_count; i++)
        if (children[i])
            json_object_set_new(json_array_get(glb->nodes, i), "children", children[i]);
    mem_free(children);
}

static int write_chunks(const char *json, const struct text *buffer, const char *path)
{
    struct text out = { 0 };
    size_t json_length = strlen(json), padded = (json_length + 3) / 4 * 4;
    text_add_bytes(&out, "glTF", 4);
    append_u32(&out, 2);
    append_u32(&out, (uint32_t)(12 + 8 + padded + 8 + buffer->length));
    append_u32(&out, (uint32_t)padded);
    text_add_bytes(&out, "JSON", 4);
    text_add_bytes(&out, json, json_length);
    text_add_bytes(&out, "   ", padded - json_length);
    append_u32(&out, (uint32_t)buffer->length);
    text_add_bytes(&out, "BIN", 4);
    text_add_bytes(&out, buffer->at, buffer->length);
    int status = atomic_file_put(path, out.at, out.length);
    text_finish(&out);
    return status;
}

int glb_write(const struct model *model, const char *path)
{
    struct glb glb = { model, json_array(), json_array(), json_array(), json_array(), json_array(), { 0 } };
    for (size_t i = 0; i < model->mesh_count; i++)
        add_mesh(&glb, model->meshes[i]);
    add_materials(&glb);
    add_nodes(&glb);
    json_t *asset = json_pack("{s:s,s:s,s:s}", "version", "2.0", "generator", "plantcast-demo", "copyright", "GPL-3.0-or-later");
    json_t *scenes = json_pack("[{s:s,s:[i]}]", "name", "demo plant", "nodes", 0);
    json_t *buffers = json_pack("[{s:I}]", "byteLength", (json_int_t)glb.buffer.length);
    json_t *root = json_pack("{s:o,s:i,s:o,s:o,s:o,s:o,s:o,s:o,s:o}", "asset", asset, "scene", 0, "scenes", scenes, "nodes", glb.nodes,
                             "meshes", glb.meshes, "materials", glb.materials, "accessors", glb.accessors, "bufferViews", glb.views,
                             "buffers", buffers);
    char *json = json_dumps(root, JSON_COMPACT | JSON_REAL_PRECISION(9));
    int status = write_chunks(json, &glb.buffer, path);
    mem_free(json);
    json_decref(root);
    text_finish(&glb.buffer);
    return status;
}

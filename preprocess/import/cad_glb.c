/* SPDX-License-Identifier: GPL-3.0-or-later */
/* JSON grows by jansson, the one buffer as bytes. */
#include "preprocess/import/cad_glb.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/atomic_file.h"
#include "base/mem.h"
#include "base/text.h"

enum { FLOAT = 5126, UINT = 5125, VERTICES = 34962, INDICES = 34963, LINES = 1, TRIANGLES = 4 };

struct writer {
    const struct cad_model *model;
    json_t *views, *accessors, *materials, *meshes, *nodes;
    struct text bytes;
    double (*origins)[3]; /* of each node, in the plant's frame */
    int *material_of;     /* by the model's colours */
    int plain, line;      /* materials; -1: not made yet */
};

static double linear_of(uint8_t srgb)
{
    double c = srgb / 255.0;
    return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

static int add_material(struct writer *w, const double rgb[3])
{
    json_array_append_new(w->materials, json_pack("{s:{s:[f,f,f,f],s:f,s:f},s:b}", "pbrMetallicRoughness", "baseColorFactor", rgb[0],
                                                  rgb[1], rgb[2], 1.0, "metallicFactor", 0.1, "roughnessFactor", 0.6, "doubleSided", 1));
    return (int)json_array_size(w->materials) - 1;
}

static int material_of(struct writer *w, const struct cad_node *node)
{
    for (size_t i = 0; i < w->model->color_count; i++)
        if (w->model->colors[i].material == node->material) {
            const uint8_t *rgb = w->model->colors[i].rgb;
            if (w->material_of[i] < 0)
                w->material_of[i] = add_material(w, (double[3]){ linear_of(rgb[0]), linear_of(rgb[1]), linear_of(rgb[2]) });
            return w->material_of[i];
        }
    if (w->plain < 0)
        w->plain = add_material(w, (double[3]){ 0.35, 0.35, 0.35 });
    return w->plain;
}

static json_t *add_accessor(struct writer *w, const void *bytes, size_t each, size_t count, int component, const char *type, int target)
{
    json_array_append_new(w->views, json_pack("{s:i,s:I,s:I,s:i}", "buffer", 0, "byteOffset", (json_int_t)w->bytes.length, "byteLength",
                                              (json_int_t)(each * count), "target", target));
    text_add_bytes(&w->bytes, bytes, each * count);
    json_t *accessor = json_pack("{s:I,s:i,s:I,s:s}", "bufferView", (json_int_t)json_array_size(w->views) - 1, "componentType", component,
                                 "count", (json_int_t)count, "type", type);
    json_array_append_new(w->accessors, accessor);
    return accessor;
}

static json_int_t last_accessor(const struct writer *w)
{
    return (json_int_t)json_array_size(w->accessors) - 1;
}

/* Positions with Y up, and their range, which glTF demands. */
static json_int_t add_positions(struct writer *w, const float (*positions)[3], size_t count)
{
    json_t *accessor = add_accessor(w, positions, sizeof(*positions), count, FLOAT, "VEC3", VERTICES);
    json_t *low = json_array(), *high = json_array();
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
    return last_accessor(w);
}

static void place(const double from[3], const double origin[3], float out[3])
{
    out[0] = (float)(from[0] - origin[0]);
    out[1] = (float)(from[2] - origin[2]);
    out[2] = (float)-(from[1] - origin[1]);
}

static json_t *triangles_of(struct writer *w, const struct cad_node *node, const double origin[3])
{
    float(*positions)[3] = mem_array(node->vertex_count, sizeof(*positions)),
    (*normals)[3] = mem_array(node->vertex_count, sizeof(*normals));
    for (size_t i = 0; i < node->vertex_count; i++) {
        const float *n = node->vertices[i].normal;
        place(node->vertices[i].position_m, origin, positions[i]);
        memcpy(normals[i], (float[3]){ n[0], n[2], -n[1] }, sizeof(*normals));
    }
    json_int_t position = add_positions(w, (const float(*)[3])positions, node->vertex_count);
    add_accessor(w, normals, sizeof(*normals), node->vertex_count, FLOAT, "VEC3", VERTICES);
    json_int_t normal = last_accessor(w);
    add_accessor(w, node->triangles, sizeof(uint32_t), node->triangle_count * 3, UINT, "SCALAR", INDICES);
    mem_free(positions);
    mem_free(normals);
    return json_pack("{s:{s:I,s:I},s:I,s:i,s:i}", "attributes", "POSITION", position, "NORMAL", normal, "indices", last_accessor(w), "mode",
                     TRIANGLES, "material", material_of(w, node));
}

static json_t *lines_of(struct writer *w, const struct cad_node *node, const double origin[3])
{
    float(*positions)[3] = mem_array(node->line_count * 2, sizeof(*positions));
    for (size_t i = 0; i < node->line_count * 2; i++)
        place(node->lines_m[i / 2][i % 2], origin, positions[i]);
    json_int_t position = add_positions(w, (const float(*)[3])positions, node->line_count * 2);
    mem_free(positions);
    if (w->line < 0)
        w->line = add_material(w, (double[3]){ 0.1, 0.1, 0.1 });
    return json_pack("{s:{s:I},s:i,s:i}", "attributes", "POSITION", position, "mode", LINES, "material", w->line);
}

/* The middle of what the node shows, to the millimetre; that of its parent where it shows nothing. */
static void find_origin(const struct writer *w, const struct cad_node *node, double out[3])
{
    static const double zero[3];
    memcpy(out, node->parent >= 0 ? w->origins[node->parent] : zero, sizeof(zero));
    if (node->vertex_count + node->line_count == 0)
        return;
    for (int axis = 0; axis < 3; axis++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < node->vertex_count; i++) {
            low = fmin(low, node->vertices[i].position_m[axis]);
            high = fmax(high, node->vertices[i].position_m[axis]);
        }
        for (size_t i = 0; i < node->line_count * 2; i++) {
            low = fmin(low, node->lines_m[i / 2][i % 2][axis]);
            high = fmax(high, node->lines_m[i / 2][i % 2][axis]);
        }
        out[axis] = round((low + high) / 2 * 1000) / 1000;
    }
}

static void add_node(struct writer *w, const struct cad_node *node, size_t number)
{
    static const double zero[3];
    double *origin = w->origins[number];
    const double *above = node->parent >= 0 ? w->origins[node->parent] : zero;
    find_origin(w, node, origin);
    json_t *out = json_pack("{s:s}", "name", node->name), *primitives = json_array();
    if (memcmp(origin, above, sizeof(zero)) != 0)
        json_object_set_new(out, "translation", json_pack("[f,f,f]", origin[0] - above[0], origin[2] - above[2], -(origin[1] - above[1])));
    if (node->triangle_count > 0)
        json_array_append_new(primitives, triangles_of(w, node, origin));
    if (node->line_count > 0)
        json_array_append_new(primitives, lines_of(w, node, origin));
    if (json_array_size(primitives) > 0) {
        json_array_append_new(w->meshes, json_pack("{s:s,s:O}", "name", node->name, "primitives", primitives));
        json_object_set_new(out, "mesh", json_integer((json_int_t)json_array_size(w->meshes) - 1));
    }
    json_decref(primitives);
    if (node->attribute_count > 0) {
        json_t *extras = json_object();
        for (size_t i = 0; i < node->attribute_count; i++)
            json_object_set_new(extras, node->attributes[i].name, json_string(node->attributes[i].value));
        json_object_set_new(out, "extras", extras);
    }
    json_array_append_new(w->nodes, out);
    json_t *parent = json_array_get(w->nodes, (size_t)(node->parent + 1)), *children = json_object_get(parent, "children");
    if (!children) {
        children = json_array();
        json_object_set_new(parent, "children", children);
    }
    json_array_append_new(children, json_integer((json_int_t)number + 1));
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

static int save(struct writer *w, const char *path)
{
    struct text file = { 0 };
    json_t *root = json_pack("{s:{s:s,s:s},s:i,s:[{s:[i]}],s:O}", "asset", "version", "2.0", "generator", "plantcast-import", "scene", 0,
                             "scenes", "nodes", 0, "nodes", w->nodes);
    const struct {
        const char *name;
        json_t *list;
    } lists[] = { { "meshes", w->meshes }, { "materials", w->materials }, { "accessors", w->accessors }, { "bufferViews", w->views } };
    for (size_t i = 0; i < sizeof(lists) / sizeof(lists[0]); i++) /* glTF allows no empty lists */
        if (json_array_size(lists[i].list) > 0)
            json_object_set(root, lists[i].name, lists[i].list);
    if (w->bytes.length > 0)
        json_object_set_new(root, "buffers", json_pack("[{s:I}]", "byteLength", (json_int_t)w->bytes.length));
    char *json = json_dumps(root, JSON_COMPACT | JSON_REAL_PRECISION(17));
    json_decref(root);
    if (!json)
        return -ENOMEM;
    int status = -EFBIG;
    if (w->bytes.length + strlen(json) < UINT32_MAX - 64) {
        text_add_bytes(&file, "glTF\2\0\0\0\0\0\0\0", 12);
        add_chunk(&file, "JSON", json, strlen(json), ' ');
        if (w->bytes.length > 0)
            add_chunk(&file, "BIN\0", w->bytes.at, w->bytes.length, 0);
        uint32_t total = (uint32_t)file.length;
        memcpy(file.at + 8, &total, sizeof(total));
        status = atomic_file_put(path, file.at, file.length);
    }
    text_finish(&file);
    free(json);
    return status;
}

int cad_glb_write(const struct cad_model *model, const char *name, const char *path)
{
    struct writer w = { .model = model,
                        .views = json_array(),
                        .accessors = json_array(),
                        .materials = json_array(),
                        .meshes = json_array(),
                        .plain = -1,
                        .line = -1 };
    w.nodes = json_pack("[{s:s}]", "name", name);
    w.origins = mem_array(model->node_count + 1, sizeof(*w.origins));
    w.material_of = mem_array(model->color_count + 1, sizeof(*w.material_of));
    for (size_t i = 0; i < model->color_count; i++)
        w.material_of[i] = -1;
    for (size_t i = 0; i < model->node_count; i++)
        add_node(&w, &model->nodes[i], i);
    int status = save(&w, path);
    json_t *const owned[] = { w.views, w.accessors, w.materials, w.meshes, w.nodes };
    for (size_t i = 0; i < sizeof(owned) / sizeof(owned[0]); i++)
        json_decref(owned[i]);
    text_finish(&w.bytes);
    mem_free(w.origins);
    mem_free(w.material_of);
    return status;
}

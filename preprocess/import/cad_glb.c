/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes a CAD model's nodes as glTF nodes, one after the other, with positions relative to each node's origin. */
#include "preprocess/import/cad_glb.h"

#include <jansson.h>
#include <math.h>
#include <string.h>

#include "base/image/srgb.h"
#include "base/mem.h"
#include "preprocess/glb/glb_file.h"

enum { LINES = 1, TRIANGLES = 4 }; /* primitive modes of glTF */

struct cad_writer {
    const struct cad_model *model;
    json_t *materials, *meshes, *nodes;
    struct glb_file file;
    double (*origins)[3]; /* by node: origin in the plant's coordinates */
    int *material_of;     /* by colour of the CAD model: index of the glTF material */
    int plain, line;      /* indices of the glTF materials for faces and lines without a colour; -1: not created yet */
};

static int add_material(struct cad_writer *w, const double rgb[3])
{
    json_array_append_new(w->materials, json_pack("{s:{s:[f,f,f,f],s:f,s:f},s:b}", "pbrMetallicRoughness", "baseColorFactor", rgb[0],
                                                  rgb[1], rgb[2], 1.0, "metallicFactor", 0.1, "roughnessFactor", 0.6, "doubleSided", 1));
    return (int)json_array_size(w->materials) - 1;
}

static int material_of(struct cad_writer *w, const struct cad_node *node)
{
    for (size_t i = 0; i < w->model->color_count; i++)
        if (w->model->colors[i].material == node->material) {
            const uint8_t *rgb = w->model->colors[i].rgb;
            if (w->material_of[i] < 0)
                w->material_of[i] = add_material(w, (double[3]){ linear_from_srgb(rgb[0] / 255.0), linear_from_srgb(rgb[1] / 255.0),
                                                                 linear_from_srgb(rgb[2] / 255.0) });
            return w->material_of[i];
        }
    if (w->plain < 0)
        w->plain = add_material(w, (double[3]){ 0.35, 0.35, 0.35 });
    return w->plain;
}

static void place(const double from[3], const double origin[3], float out[3])
{
    out[0] = (float)(from[0] - origin[0]);
    out[1] = (float)(from[2] - origin[2]);
    out[2] = (float)-(from[1] - origin[1]);
}

static json_t *triangles_of(struct cad_writer *w, const struct cad_node *node, const double origin[3])
{
    float(*positions)[3] = mem_array(node->vertex_count, sizeof(*positions)),
    (*normals)[3] = mem_array(node->vertex_count, sizeof(*normals));
    for (size_t i = 0; i < node->vertex_count; i++) {
        const float *n = node->vertices[i].normal;
        place(node->vertices[i].position_m, origin, positions[i]);
        memcpy(normals[i], (float[3]){ n[0], n[2], -n[1] }, sizeof(*normals));
    }
    int position = glb_file_add_positions(&w->file, (const float(*)[3])positions, node->vertex_count);
    int normal = glb_file_add(&w->file, normals, sizeof(*normals), node->vertex_count, GLB_FLOAT, "VEC3", GLB_VERTICES);
    int corners = glb_file_add(&w->file, node->triangles, sizeof(uint32_t), node->triangle_count * 3, GLB_UINT, "SCALAR", GLB_INDICES);
    mem_free(positions);
    mem_free(normals);
    return json_pack("{s:{s:i,s:i},s:i,s:i,s:i}", "attributes", "POSITION", position, "NORMAL", normal, "indices", corners, "mode",
                     TRIANGLES, "material", material_of(w, node));
}

static json_t *lines_of(struct cad_writer *w, const struct cad_node *node, const double origin[3])
{
    float(*positions)[3] = mem_array(node->line_count * 2, sizeof(*positions));
    for (size_t i = 0; i < node->line_count * 2; i++)
        place(node->lines_m[i / 2][i % 2], origin, positions[i]);
    int position = glb_file_add_positions(&w->file, (const float(*)[3])positions, node->line_count * 2);
    mem_free(positions);
    if (w->line < 0)
        w->line = add_material(w, (double[3]){ 0.1, 0.1, 0.1 });
    return json_pack("{s:{s:i},s:i,s:i}", "attributes", "POSITION", position, "mode", LINES, "material", w->line);
}

/* Computes a node's origin: the centre of its geometry rounded to a millimetre, or its parent's origin if it has no geometry. */
static void find_origin(const struct cad_writer *w, const struct cad_node *node, double out[3])
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

static void add_node(struct cad_writer *w, const struct cad_node *node, size_t number)
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

static int save(struct cad_writer *w, const char *path)
{
    json_t *root = json_pack("{s:{s:s,s:s},s:i,s:[{s:[i]}],s:O}", "asset", "version", "2.0", "generator", "plantcast-import", "scene", 0,
                             "scenes", "nodes", 0, "nodes", w->nodes);
    if (json_array_size(w->meshes) > 0) { /* glTF forbids empty arrays */
        json_object_set(root, "meshes", w->meshes);
        json_object_set(root, "materials", w->materials);
    }
    int status = glb_file_save(&w->file, root, path);
    json_decref(root);
    return status;
}

int cad_glb_write(const struct cad_model *model, const char *name, const char *path)
{
    struct cad_writer w = { .model = model, .materials = json_array(), .meshes = json_array(), .plain = -1, .line = -1 };
    glb_file_init(&w.file);
    w.nodes = json_pack("[{s:s}]", "name", name);
    w.origins = mem_array(model->node_count + 1, sizeof(*w.origins));
    w.material_of = mem_array(model->color_count + 1, sizeof(*w.material_of));
    for (size_t i = 0; i < model->color_count; i++)
        w.material_of[i] = -1;
    for (size_t i = 0; i < model->node_count; i++)
        add_node(&w, &model->nodes[i], i);
    int status = save(&w, path);
    json_t *const owned[] = { w.materials, w.meshes, w.nodes };
    for (size_t i = 0; i < sizeof(owned) / sizeof(owned[0]); i++)
        json_decref(owned[i]);
    glb_file_finish(&w.file);
    mem_free(w.origins);
    mem_free(w.material_of);
    return status;
}

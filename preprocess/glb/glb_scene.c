/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds a scene's glTF lists (nodes, meshes, materials) as JSON, and one buffer with all vertex data. */
#include "preprocess/glb/glb_scene.h"

#include <string.h>

#include "base/mem.h"
#include "base/text/utf8.h"
#include "preprocess/glb/glb_file.h"

enum { TRIANGLES = 4 }; /* primitive mode of glTF */

struct glb_scene {
    char *generator;
    json_t *nodes, *meshes, *materials, *roots;
    json_t *material_numbers; /* index of each material, keyed by its colour as text */
    struct glb_file file;
};

struct glb_scene *glb_scene_create(const char *generator)
{
    struct glb_scene *scene = mem_new(sizeof(*scene));
    *scene = (struct glb_scene){ .generator = mem_strdup(generator),
                                 .nodes = json_array(),
                                 .meshes = json_array(),
                                 .materials = json_array(),
                                 .roots = json_array(),
                                 .material_numbers = json_object() };
    glb_file_init(&scene->file);
    return scene;
}

void glb_scene_destroy(struct glb_scene **pointer)
{
    struct glb_scene *scene = *pointer;
    if (!scene)
        return;
    json_t *const owned[] = { scene->nodes, scene->meshes, scene->materials, scene->roots, scene->material_numbers };
    for (size_t i = 0; i < sizeof(owned) / sizeof(owned[0]); i++)
        json_decref(owned[i]);
    glb_file_finish(&scene->file);
    mem_free(scene->generator);
    mem_free(scene);
    *pointer = NULL;
}

static json_t *text_of(const char *text)
{
    size_t length = strlen(text);
    bool valid = true;
    for (size_t i = 0, bytes; i < length && valid; i += bytes) {
        bytes = utf8_length(text + i, length - i);
        valid = bytes > 0;
    }
    if (valid)
        return json_string(text);
    struct text latin1 = { 0 };
    for (size_t i = 0; i < length; i++) {
        unsigned char c = (unsigned char)text[i];
        if (c < 128)
            text_add_bytes(&latin1, text + i, 1);
        else
            text_add_bytes(&latin1, (const char[2]){ (char)(0xc0 | c >> 6), (char)(0x80 | (c & 63)) }, 2);
    }
    json_t *out = json_string(latin1.at);
    text_finish(&latin1);
    return out;
}

int glb_scene_material(struct glb_scene *scene, const double rgba[4])
{
    char *key = mem_printf("%.4f %.4f %.4f %.3f", rgba[0], rgba[1], rgba[2], rgba[3]);
    const json_t *known = json_object_get(scene->material_numbers, key);
    int number = known ? (int)json_integer_value(known) : (int)json_array_size(scene->materials);
    if (!known) {
        json_t *material = json_pack("{s:{s:[f,f,f,f],s:f,s:f},s:b}", "pbrMetallicRoughness", "baseColorFactor", rgba[0], rgba[1], rgba[2],
                                     rgba[3], "metallicFactor", 0.1, "roughnessFactor", 0.6, "doubleSided", 1);
        if (rgba[3] < 1)
            json_object_set_new(material, "alphaMode", json_string("BLEND"));
        json_array_append_new(scene->materials, material);
        json_object_set_new(scene->material_numbers, key, json_integer(number));
    }
    mem_free(key);
    return number;
}

int glb_scene_add_mesh(struct glb_scene *scene, const char *name)
{
    json_t *mesh = json_pack("{s:[]}", "primitives");
    if (name[0])
        json_object_set_new(mesh, "name", text_of(name));
    json_array_append_new(scene->meshes, mesh);
    return (int)json_array_size(scene->meshes) - 1;
}

void glb_scene_add_triangles(struct glb_scene *scene, int mesh, const struct glb_scene_triangles *triangles)
{
    int position = glb_file_add_positions(&scene->file, triangles->positions, triangles->vertex_count);
    int corners =
        glb_file_add(&scene->file, triangles->corners, sizeof(uint32_t), triangles->corner_count, GLB_UINT, "SCALAR", GLB_INDICES);
    json_t *primitive = json_pack("{s:{s:i},s:i,s:i}", "attributes", "POSITION", position, "indices", corners, "mode", TRIANGLES);
    if (triangles->normals)
        json_object_set_new(json_object_get(primitive, "attributes"), "NORMAL",
                            json_integer(glb_file_add(&scene->file, triangles->normals, sizeof(*triangles->normals),
                                                      triangles->vertex_count, GLB_FLOAT, "VEC3", GLB_VERTICES)));
    if (triangles->material >= 0)
        json_object_set_new(primitive, "material", json_integer(triangles->material));
    json_array_append_new(json_object_get(json_array_get(scene->meshes, (size_t)mesh), "primitives"), primitive);
}

int glb_scene_add_node(struct glb_scene *scene, int parent, const char *name, int mesh, const double matrix[16])
{
    int number = (int)json_array_size(scene->nodes);
    json_t *node = json_object(), *list = scene->roots;
    if (name[0])
        json_object_set_new(node, "name", text_of(name));
    if (mesh >= 0)
        json_object_set_new(node, "mesh", json_integer(mesh));
    if (matrix) {
        json_t *values = json_array();
        for (int i = 0; i < 16; i++)
            json_array_append_new(values, json_real(matrix[i]));
        json_object_set_new(node, "matrix", values);
    }
    json_array_append_new(scene->nodes, node);
    if (parent >= 0) {
        json_t *above = json_array_get(scene->nodes, (size_t)parent);
        if (!json_object_get(above, "children"))
            json_object_set_new(above, "children", json_array());
        list = json_object_get(above, "children");
    }
    json_array_append_new(list, json_integer(number));
    return number;
}

void glb_scene_set_property(struct glb_scene *scene, int node, const char *key, const char *value)
{
    json_t *object = json_array_get(scene->nodes, (size_t)node);
    if (!json_object_get(object, "extras"))
        json_object_set_new(object, "extras", json_object());
    json_object_set_new(json_object_get(object, "extras"), key, text_of(value));
}

int glb_scene_write(struct glb_scene *scene, const char *path)
{
    json_t *root = json_pack("{s:{s:s,s:s},s:i,s:[{s:O}],s:O}", "asset", "version", "2.0", "generator", scene->generator, "scene", 0,
                             "scenes", "nodes", scene->roots, "nodes", scene->nodes);
    if (json_array_size(scene->meshes) > 0) /* glTF forbids empty arrays */
        json_object_set(root, "meshes", scene->meshes);
    if (json_array_size(scene->materials) > 0)
        json_object_set(root, "materials", scene->materials);
    int status = glb_file_save(&scene->file, root, path);
    json_decref(root);
    return status;
}

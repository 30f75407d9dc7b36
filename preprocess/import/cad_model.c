/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Creates, fills and frees CAD models. */
#include "preprocess/import/cad_model.h"

#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"

struct cad_model *cad_model_create(void)
{
    return mem_new(sizeof(struct cad_model));
}

void cad_model_destroy(struct cad_model **pointer)
{
    struct cad_model *model = *pointer;
    if (!model)
        return;
    for (size_t i = 0; i < model->node_count; i++) {
        struct cad_node *node = &model->nodes[i];
        for (size_t a = 0; a < node->attribute_count; a++) {
            mem_free(node->attributes[a].name);
            mem_free(node->attributes[a].value);
        }
        mem_free(node->attributes);
        mem_free(node->vertices);
        mem_free(node->triangles);
        mem_free(node->lines_m);
        mem_free(node->name);
    }
    mem_free(model->nodes);
    mem_free(model->colors);
    mem_free(model);
    *pointer = NULL;
}

int cad_model_add_node(struct cad_model *model, int parent, const char *name)
{
    mem_grow(&model->nodes, &model->node_room, model->node_count + 1, sizeof(*model->nodes));
    model->nodes[model->node_count] = (struct cad_node){ .parent = parent, .name = mem_strdup(name) };
    return (int)model->node_count++;
}

uint32_t cad_node_add_vertex(struct cad_node *node, const double position_m[3], const double normal[3])
{
    mem_grow(&node->vertices, &node->vertex_room, node->vertex_count + 1, sizeof(*node->vertices));
    struct cad_vertex *vertex = &node->vertices[node->vertex_count];
    double length = vec_length(normal);
    for (int axis = 0; axis < 3; axis++) {
        vertex->position_m[axis] = position_m[axis];
        vertex->normal[axis] = length > 0 ? (float)(normal[axis] / length) : axis == 2;
    }
    return (uint32_t)node->vertex_count++;
}

void cad_node_add_triangle(struct cad_node *node, uint32_t a, uint32_t b, uint32_t c)
{
    mem_grow(&node->triangles, &node->triangle_room, node->triangle_count + 1, sizeof(*node->triangles));
    memcpy(node->triangles[node->triangle_count++], (uint32_t[3]){ a, b, c }, sizeof(*node->triangles));
}

void cad_node_add_line(struct cad_node *node, const double from_m[3], const double to_m[3])
{
    mem_grow(&node->lines_m, &node->line_room, node->line_count + 1, sizeof(*node->lines_m));
    memcpy(node->lines_m[node->line_count][0], from_m, sizeof(node->lines_m[0][0]));
    memcpy(node->lines_m[node->line_count++][1], to_m, sizeof(node->lines_m[0][1]));
}

void cad_node_add_attribute(struct cad_node *node, const char *name, const char *value)
{
    mem_grow(&node->attributes, &node->attribute_room, node->attribute_count + 1, sizeof(*node->attributes));
    node->attributes[node->attribute_count++] = (struct cad_attribute){ mem_strdup(name), mem_strdup(value) };
}

void cad_model_add_color(struct cad_model *model, uint32_t material, const uint8_t rgb[3])
{
    mem_grow(&model->colors, &model->color_room, model->color_count + 1, sizeof(*model->colors));
    model->colors[model->color_count++] = (struct cad_color){ material, { rgb[0], rgb[1], rgb[2] } };
}

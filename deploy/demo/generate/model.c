/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nodes, shared meshes and named nozzles. */
#include "model.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

void model_finish(struct model *model)
{
    for (size_t i = 0; i < model->mesh_count; i++) {
        mesh_finish(&model->meshes[i]->mesh);
        mem_free(model->meshes[i]->name);
        mem_free(model->meshes[i]);
    }
    for (size_t i = 0; i < model->node_count; i++)
        mem_free(model->nodes[i].name);
    for (size_t i = 0; i < model->nozzle_count; i++)
        mem_free(model->nozzles[i].name);
    mem_free(model->meshes);
    mem_free(model->nodes);
    mem_free(model->nozzles);
    *model = (struct model){ 0 };
}

int model_add_node(struct model *model, const char *name, int parent, int mesh, struct frame at)
{
    mem_grow(&model->nodes, &model->node_capacity, model->node_count + 1, sizeof(*model->nodes));
    model->nodes[model->node_count] = (struct model_node){ mem_strdup(name), parent, mesh, at };
    return (int)model->node_count++;
}

int model_find_node(const struct model *model, const char *name)
{
    for (size_t i = 0; i < model->node_count; i++)
        if (strcmp(model->nodes[i].name, name) == 0)
            return (int)i;
    return -1;
}

int model_add_mesh(struct model *model, const char *name, enum material material)
{
    mem_grow(&model->meshes, &model->mesh_capacity, model->mesh_count + 1, sizeof(struct model_mesh *));
    struct model_mesh *mesh = mem_new(sizeof(*mesh));
    mesh->name = mem_strdup(name);
    mesh->material = material;
    model->meshes[model->mesh_count] = mesh;
    return (int)model->mesh_count++;
}

const struct model_nozzle *model_nozzle(const struct model *model, const char *name)
{
    for (size_t i = 0; i < model->nozzle_count; i++)
        if (strcmp(model->nozzles[i].name, name) == 0)
            return model->nozzles + i;
    fprintf(stderr, "plantcast-demo: no nozzle %s\n", name);
    abort();
}

struct item item_begin(struct model *model, const char *name, struct frame at)
{
    return (struct item){ .model = model, .name = mem_strdup(name), .node = model_add_node(model, name, -1, -1, at), .at = at };
}

struct item item_begin_group(struct item *asset, const char *name, struct frame at)
{
    char *whole_name = mem_printf("%s %s", asset->name, name);
    int node = model_add_node(asset->model, whole_name, asset->node, -1, frame_inside(&asset->at, at));
    return (struct item){ .model = asset->model, .name = whole_name, .node = node, .at = at };
}

void item_end(struct item *item)
{
    mem_free(item->name);
    *item = (struct item){ 0 };
}

struct mesh *item_part(struct item *item, const char *part, enum material material)
{
    char *name = mem_printf("%s %s", item->name, part);
    int node = model_find_node(item->model, name);
    if (node < 0)
        node = model_add_node(item->model, name, item->node, model_add_mesh(item->model, name, material), frame_at(0, 0, 0));
    mem_free(name);
    return &item->model->meshes[item->model->nodes[node].mesh]->mesh;
}

static void model_add_nozzle(struct model *model, char *owned_name, struct frame at, double r)
{
    mem_grow(&model->nozzles, &model->nozzle_capacity, model->nozzle_count + 1, sizeof(*model->nozzles));
    model->nozzles[model->nozzle_count++] = (struct model_nozzle){ owned_name, at, r };
}

void item_connect(struct item *item, const char *nozzle, struct frame at, double r)
{
    model_add_nozzle(item->model, mem_printf("%s/%s", item->name, nozzle), frame_in(&item->at, at), r);
}

void model_add_instance(struct model *model, const char *name, const char *original, struct frame at)
{
    int source = model_find_node(model, original), root = model_add_node(model, name, -1, -1, at);
    size_t original_length = strlen(original), nodes = model->node_count, nozzles = model->nozzle_count;
    for (size_t i = 0; i < nodes; i++) {
        if (model->nodes[i].parent != source || model->nodes[i].mesh < 0)
            continue;
        char *part = mem_printf("%s%s", name, model->nodes[i].name + original_length);
        model_add_node(model, part, root, model->nodes[i].mesh, model->nodes[i].at);
        mem_free(part);
    }
    for (size_t i = 0; i < nozzles; i++) {
        const struct model_nozzle *nozzle = model->nozzles + i;
        const struct frame *from = &model->nodes[source].at;
        if (strncmp(nozzle->name, original, original_length) != 0 || nozzle->name[original_length] != '/')
            continue;
        struct frame local = frame_inside(from, nozzle->at);
        model_add_nozzle(model, mem_printf("%s%s", name, nozzle->name + original_length), frame_in(&at, local), nozzle->r);
    }
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Feeds bytes to gltf_load as a model file in a folder with a few others. A model that loads must satisfy the checks of
   promise.h, and so must geometry extracted from it. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include "preprocess/geometry/geometry.h"
#include "tests/support/temp.h"
#include "tests/fuzz/promise.h"

/* maximum number of triangle corners of a model that is also cut into assets; cutting larger ones would only be slow */
#define MOST_CUT 100000u

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static char *folder; /* one folder for all inputs */

static void require_finite(const float *values, size_t count, const char *what)
{
    for (size_t i = 0; i < count; i++)
        require(isfinite(values[i]), what);
}

static void check_primitive(const struct gltf_model *model, const struct gltf_primitive *p)
{
    require(p->index_count % 3 == 0 && p->material >= -1 && p->material < (int)model->material_count, "whole triangles of a material");
    for (uint32_t i = 0; i < p->index_count; i++)
        require(p->indices[i] < p->vertex_count, "indices name vertices");
    if (p->vertex_count == 0)
        return;
    require_finite(p->positions[0], 3 * (size_t)p->vertex_count, "positions are finite");
    if (p->normals)
        require_finite(p->normals[0], 3 * (size_t)p->vertex_count, "normals are finite");
    if (p->second_texcoords)
        require_finite(p->second_texcoords[0], 2 * (size_t)p->vertex_count, "second texture coordinates are finite");
    if (p->texcoords)
        require_finite(p->texcoords[0], 2 * (size_t)p->vertex_count, "texture coordinates are finite");
    unsigned sum = 0;
    for (uint32_t v = 0; p->colors && v < p->vertex_count; v++)
        sum += p->colors[v][3];
    require(sum <= 255ull * p->vertex_count, "colours are there");
}

/* Returns the number of corners that all nodes together draw. */
static uint64_t check_nodes(const struct gltf_model *model)
{
    uint64_t corners = 0;
    for (uint32_t i = 0; i < model->node_count; i++) {
        const struct gltf_node *node = &model->nodes[i];
        require(node->name && node->end > i && node->end <= model->node_count && node->parent < (int)i, "nodes are in order");
        require(node->parent < 0 || node->end <= model->nodes[node->parent].end, "sub-trees lie inside each other");
        require(node->mesh >= -1 && node->mesh < (int)model->mesh_count, "meshes are there");
        for (int k = 0; k < 16; k++)
            require(isfinite(node->world[k]), "places are finite");
        for (uint32_t p = 0; node->mesh >= 0 && p < model->meshes[node->mesh].primitive_count; p++)
            corners += model->primitives[model->meshes[node->mesh].first_primitive + p].index_count;
    }
    return corners;
}

static void check_model(const struct gltf_model *model)
{
    for (uint32_t i = 0; i < model->mesh_count; i++)
        require(model->meshes[i].first_primitive + model->meshes[i].primitive_count <= model->primitive_count, "meshes have primitives");
    for (uint32_t i = 0; i < model->primitive_count; i++)
        check_primitive(model, &model->primitives[i]);
    for (uint32_t i = 0; i < model->texture_count; i++)
        require(model->textures[i].image < model->image_count, "textures have images");
    for (uint32_t i = 0; i < model->material_count; i++) {
        const struct asset_material *m = &model->materials[i];
        require(model->material_names[i] && m->roughness >= 0 && m->roughness <= 1 && isfinite(m->alpha_cutoff), "materials");
        require(m->base_color_texture == ASSET_NO_TEXTURE || m->base_color_texture < model->texture_count, "materials have textures");
    }
}

/* Lays the extracted geometry out as an asset file and asserts that the reader of asset files accepts it. */
static void check_asset(const struct geometry *g)
{
    struct asset_parts parts = {
        .positions_m = (const float(*)[3])g->positions_m,
        .normals = (const float(*)[3])g->normals,
        .texcoords = (const float(*)[2])g->texcoords,
        .second_texcoords = (const float(*)[2])g->second_texcoords,
        .colors = (const uint8_t(*)[4])g->colors,
        .indices = g->indices,
        .primitives = g->primitives,
        .materials = g->materials,
        .textures = g->textures,
        .texels = g->texels,
        .names = g->names.at,
        .vertex_count = g->vertex_count,
        .index_count = g->index_count,
        .primitive_count = g->primitive_count,
        .material_count = g->material_count,
        .texture_count = g->texture_count,
        .texel_bytes = g->texel_bytes,
        .name_bytes = g->names.length,
    };
    struct asset_view view;
    char why[200];
    size_t size;
    void *bytes = asset_build(&parts, &size);
    require(bytes && asset_view_init(&view, bytes, size, why), bytes ? why : "memory");
    free(bytes);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    static const struct geometry_params whole = { .unit_m = 0.001, .up = AXIS_Y }, pattern = { .nodes = "*e*", .unit_m = 1, .up = AXIS_Z };
    char why[MODEL_WHY_BYTES] = "";
    struct gltf_model model;
    if (!folder) {
        folder = temp_folder();
        temp_write_text(folder, "a picture.png", "no picture");
        temp_write_text(folder, "buffer.bin", "000011112222333344445555666677778888");
    }
    struct model_source source = { .folder = folder, .bytes = (unsigned char *)(uintptr_t)bytes, .size = count };
    if (!gltf_load(&model, &source, why)) {
        require(why[0], "a reason");
        return 0;
    }
    check_model(&model);
    if (check_nodes(&model) <= MOST_CUT)
        for (int i = 0; i < 2; i++) {
            struct geometry geometry;
            why[0] = 0;
            if (geometry_cut(&geometry, &model, i ? &pattern : &whole, why)) {
                check_asset(&geometry);
                geometry_finish(&geometry);
            } else {
                require(why[0], "a reason");
            }
        }
    gltf_free(&model);
    return 0;
}

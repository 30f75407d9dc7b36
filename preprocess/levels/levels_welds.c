/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Groups equal vertices into welds, so that the simplifier can collapse edges where vertices with different normals share a
 * position. Finds the connected parts of a model. */
#include <math.h>
#include <meshoptimizer.h>
#include <string.h>

#include "base/math/gap_split.h"
#include "base/mem.h"
#include "preprocess/levels/levels_impl.h"
#include "preprocess/geometry/welded_positions.h"
#include "surface/mesh/trimesh.h"

/* attributes of a vertex; vertices that differ in any of these are in different welds (groups), so that the simplifier
 * preserves borders of materials and textures as seams */
struct weld_key {
    float position[3], texcoord[2], second_texcoord[2];
    uint32_t primitive;
    uint8_t color[4];
};

static void fill_keys(const struct geometry *g, struct weld_key *keys)
{
    for (uint32_t p = 0; p < g->primitive_count; p++) {
        const struct asset_primitive *primitive = &g->primitives[p];
        const struct asset_material *m = &g->materials[primitive->material];
        bool textured = m->base_color_texture != ASSET_NO_TEXTURE || m->metallic_roughness_texture != ASSET_NO_TEXTURE ||
                        m->normal_texture != ASSET_NO_TEXTURE || m->occlusion_texture != ASSET_NO_TEXTURE ||
                        m->emissive_texture != ASSET_NO_TEXTURE;
        for (uint32_t i = primitive->first_index; i < primitive->first_index + primitive->index_count; i++) {
            uint32_t v = g->indices[i];
            struct weld_key *key = &keys[v];
            memcpy(key->position, g->positions_m[v], sizeof(key->position));
            key->primitive = p;
            if (textured && g->texcoords)
                memcpy(key->texcoord, g->texcoords[v], sizeof(key->texcoord));
            if (m->second && g->second_texcoords)
                memcpy(key->second_texcoord, g->second_texcoords[v], sizeof(key->second_texcoord));
            if (g->colors)
                memcpy(key->color, g->colors[v], sizeof(key->color));
        }
    }
}

static void list_vertices(struct welds *welds, const struct weld_key *keys)
{
    for (uint32_t v = 0; v < welds->geometry->vertex_count; v++) {
        uint32_t k = welds->of_vertex[v];
        memcpy(welds->positions_m[k], keys[v].position, sizeof(*welds->positions_m));
        welds->primitive[k] = keys[v].primitive;
        welds->first[k + 2]++;
    }
    for (size_t k = 2; k < welds->count + 2; k++)
        welds->first[k] += welds->first[k - 1];
    for (uint32_t v = 0; v < welds->geometry->vertex_count; v++)
        welds->vertices[welds->first[welds->of_vertex[v] + 1]++] = v;
}

static bool weld(struct welds *welds)
{
    size_t count = welds->geometry->vertex_count;
    struct weld_key *keys = mem_try_array(count, sizeof(*keys));
    welds->of_vertex = mem_try_array(count, sizeof(*welds->of_vertex));
    welds->positions_m = mem_try_array(count, sizeof(*welds->positions_m));
    welds->primitive = mem_try_array(count, sizeof(*welds->primitive));
    welds->first = mem_try_array(count + 2, sizeof(*welds->first));
    welds->vertices = mem_try_array(count, sizeof(*welds->vertices));
    bool good = keys && welds->of_vertex && welds->positions_m && welds->primitive && welds->first && welds->vertices;
    if (good) {
        fill_keys(welds->geometry, keys);
        welds->count = meshopt_generateVertexRemap(welds->of_vertex, NULL, count, keys, count, sizeof(*keys));
        list_vertices(welds, keys);
    }
    mem_free(keys);
    return good;
}

/* --- parts ---------------------------------------------------------------------------------------------------------------- */

static void number_parts(struct welds *welds, const struct welded_positions *welded, uint32_t *parent)
{
    const struct geometry *g = welds->geometry;
    uint32_t *number = mem_array(welded->count, sizeof(*number));
    memset(number, 0xff, welded->count * sizeof(*number));
    for (uint32_t v = 0; v < g->vertex_count; v++) {
        uint32_t root = trimesh_root(parent, welded->of_vertex[v]);
        if (number[root] == UINT32_MAX)
            number[root] = (uint32_t)welds->part_count++;
        welds->part[welds->of_vertex[v]] = number[root];
    }
    mem_free(number);
}

static void find_first_there(struct welds *welds, const struct welded_positions *welded)
{
    uint32_t *first = mem_array(welded->count, sizeof(*first));
    memset(first, 0xff, welded->count * sizeof(*first));
    welds->first_there = mem_array(welds->count, sizeof(*welds->first_there));
    for (uint32_t k = 0; k < welds->count; k++) {
        uint32_t *at = &first[welded->of_vertex[welds->vertices[welds->first[k]]]];
        *at = *at == UINT32_MAX ? k : *at;
        welds->first_there[k] = *at;
    }
    mem_free(first);
}

static float diagonal(const float low[3], const float high[3])
{
    return hypotf(high[0] - low[0], hypotf(high[1] - low[1], high[2] - low[2]));
}

static void widen(float low[3], float high[3], const float point[3])
{
    for (int axis = 0; axis < 3; axis++) {
        low[axis] = fminf(low[axis], point[axis]);
        high[axis] = fmaxf(high[axis], point[axis]);
    }
}

static void measure_parts(struct welds *welds)
{
    const float low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
    const struct geometry *g = welds->geometry;
    welds->low_m = mem_array(welds->part_count, sizeof(*welds->low_m));
    welds->high_m = mem_array(welds->part_count, sizeof(*welds->high_m));
    welds->size_m = mem_array(welds->part_count, sizeof(*welds->size_m));
    for (size_t p = 0; p < welds->part_count; p++) {
        memcpy(welds->low_m[p], low, sizeof(low));
        memcpy(welds->high_m[p], high, sizeof(high));
    }
    for (size_t k = 0; k < welds->count; k++)
        widen(welds->low_m[welds->part[k]], welds->high_m[welds->part[k]], welds->positions_m[k]);
    for (size_t p = 0; p < welds->part_count; p++)
        welds->size_m[p] = diagonal(welds->low_m[p], welds->high_m[p]);
    welds->whole_m = gap_main_size((const float(*)[3])g->positions_m, g->indices, g->index_count / 3);
}

static bool find_parts(struct welds *welds)
{
    const struct geometry *g = welds->geometry;
    struct welded_positions welded;
    if (!welded_init(&welded, (const float(*)[3])g->positions_m, g->vertex_count))
        return false;
    uint32_t *parent = mem_array(welded.count, sizeof(*parent));
    for (uint32_t i = 0; i < welded.count; i++)
        parent[i] = i;
    for (uint32_t i = 0; i < g->index_count; i += 3)
        for (uint32_t c = 1; c < 3; c++)
            trimesh_join(parent, welded.of_vertex[g->indices[i + c]], welded.of_vertex[g->indices[i]]);
    welds->part = mem_array(welds->count, sizeof(*welds->part));
    number_parts(welds, &welded, parent);
    find_first_there(welds, &welded);
    mem_free(parent);
    welded_finish(&welded);
    measure_parts(welds);
    return true;
}

bool welds_init(struct welds *welds, const struct geometry *geometry)
{
    *welds = (struct welds){ .geometry = geometry };
    return weld(welds) && find_parts(welds);
}

void welds_finish(struct welds *welds)
{
    mem_free(welds->of_vertex);
    mem_free(welds->positions_m);
    mem_free(welds->primitive);
    mem_free(welds->first);
    mem_free(welds->vertices);
    mem_free(welds->part);
    mem_free(welds->first_there);
    mem_free(welds->low_m);
    mem_free(welds->high_m);
    mem_free(welds->size_m);
    *welds = (struct welds){ 0 };
}

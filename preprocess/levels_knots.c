/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vertices welded for the simplifier (split normals would stall it), and the parts of a model that do not hang together. */
#include <math.h>
#include <meshoptimizer.h>
#include <string.h>

#include "base/mem.h"
#include "preprocess/levels_impl.h"
#include "preprocess/places.h"
#include "surface/trimesh.h"

struct key { /* what keeps vertices apart for the simplifier: a border of material or texture is then a seam, which it keeps */
    float position[3], texcoord[2], second_texcoord[2];
    uint32_t primitive;
    uint8_t color[4];
};

static void fill_keys(const struct geometry *g, struct key *keys)
{
    for (uint32_t p = 0; p < g->primitive_count; p++) {
        const struct asset_primitive *primitive = &g->primitives[p];
        const struct asset_material *m = &g->materials[primitive->material];
        bool textured = m->base_color_texture != ASSET_NO_TEXTURE || m->metallic_roughness_texture != ASSET_NO_TEXTURE ||
                        m->normal_texture != ASSET_NO_TEXTURE || m->occlusion_texture != ASSET_NO_TEXTURE ||
                        m->emissive_texture != ASSET_NO_TEXTURE;
        for (uint32_t i = primitive->first_index; i < primitive->first_index + primitive->index_count; i++) {
            uint32_t v = g->indices[i];
            struct key *key = &keys[v];
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

static void list_vertices(struct knots *knots, const struct key *keys)
{
    for (uint32_t v = 0; v < knots->geometry->vertex_count; v++) {
        uint32_t k = knots->of_vertex[v];
        memcpy(knots->positions_m[k], keys[v].position, sizeof(*knots->positions_m));
        knots->primitive[k] = keys[v].primitive;
        knots->first[k + 2]++;
    }
    for (size_t k = 2; k < knots->count + 2; k++)
        knots->first[k] += knots->first[k - 1];
    for (uint32_t v = 0; v < knots->geometry->vertex_count; v++)
        knots->vertices[knots->first[knots->of_vertex[v] + 1]++] = v;
}

static bool weld(struct knots *knots)
{
    size_t count = knots->geometry->vertex_count;
    struct key *keys = mem_try_array(count, sizeof(*keys));
    knots->of_vertex = mem_try_array(count, sizeof(*knots->of_vertex));
    knots->positions_m = mem_try_array(count, sizeof(*knots->positions_m));
    knots->primitive = mem_try_array(count, sizeof(*knots->primitive));
    knots->first = mem_try_array(count + 2, sizeof(*knots->first));
    knots->vertices = mem_try_array(count, sizeof(*knots->vertices));
    bool good = keys && knots->of_vertex && knots->positions_m && knots->primitive && knots->first && knots->vertices;
    if (good) {
        fill_keys(knots->geometry, keys);
        knots->count = meshopt_generateVertexRemap(knots->of_vertex, NULL, count, keys, count, sizeof(*keys));
        list_vertices(knots, keys);
    }
    mem_free(keys);
    return good;
}

/* --- parts ---------------------------------------------------------------------------------------------------------------- */

static void number_parts(struct knots *knots, const struct places *places, uint32_t *parent)
{
    const struct geometry *g = knots->geometry;
    uint32_t *number = mem_array(places->count, sizeof(*number));
    memset(number, 0xff, places->count * sizeof(*number));
    for (uint32_t v = 0; v < g->vertex_count; v++) {
        uint32_t root = trimesh_root(parent, places->of_vertex[v]);
        if (number[root] == UINT32_MAX)
            number[root] = (uint32_t)knots->part_count++;
        knots->part[knots->of_vertex[v]] = number[root];
    }
    mem_free(number);
}

static void find_first_there(struct knots *knots, const struct places *places)
{
    uint32_t *first = mem_array(places->count, sizeof(*first));
    memset(first, 0xff, places->count * sizeof(*first));
    knots->first_there = mem_array(knots->count, sizeof(*knots->first_there));
    for (uint32_t k = 0; k < knots->count; k++) {
        uint32_t *at = &first[places->of_vertex[knots->vertices[knots->first[k]]]];
        *at = *at == UINT32_MAX ? k : *at;
        knots->first_there[k] = *at;
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

static void measure_parts(struct knots *knots)
{
    float low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
    knots->low_m = mem_array(knots->part_count, sizeof(*knots->low_m));
    knots->high_m = mem_array(knots->part_count, sizeof(*knots->high_m));
    knots->size_m = mem_array(knots->part_count, sizeof(*knots->size_m));
    for (size_t p = 0; p < knots->part_count; p++) {
        memcpy(knots->low_m[p], low, sizeof(low));
        memcpy(knots->high_m[p], high, sizeof(high));
    }
    for (size_t k = 0; k < knots->count; k++) {
        widen(knots->low_m[knots->part[k]], knots->high_m[knots->part[k]], knots->positions_m[k]);
        widen(low, high, knots->positions_m[k]);
    }
    for (size_t p = 0; p < knots->part_count; p++)
        knots->size_m[p] = diagonal(knots->low_m[p], knots->high_m[p]);
    knots->whole_m = (double)diagonal(low, high);
}

static bool find_parts(struct knots *knots)
{
    const struct geometry *g = knots->geometry;
    struct places places;
    if (!places_init(&places, (const float(*)[3])g->positions_m, g->vertex_count))
        return false;
    uint32_t *parent = mem_array(places.count, sizeof(*parent));
    for (uint32_t i = 0; i < places.count; i++)
        parent[i] = i;
    for (uint32_t i = 0; i < g->index_count; i += 3)
        for (uint32_t c = 1; c < 3; c++)
            trimesh_join(parent, places.of_vertex[g->indices[i + c]], places.of_vertex[g->indices[i]]);
    knots->part = mem_array(knots->count, sizeof(*knots->part));
    number_parts(knots, &places, parent);
    find_first_there(knots, &places);
    mem_free(parent);
    places_finish(&places);
    measure_parts(knots);
    return true;
}

bool knots_init(struct knots *knots, const struct geometry *geometry)
{
    *knots = (struct knots){ .geometry = geometry };
    return weld(knots) && find_parts(knots);
}

void knots_finish(struct knots *knots)
{
    mem_free(knots->of_vertex);
    mem_free(knots->positions_m);
    mem_free(knots->primitive);
    mem_free(knots->first);
    mem_free(knots->vertices);
    mem_free(knots->part);
    mem_free(knots->first_there);
    mem_free(knots->low_m);
    mem_free(knots->high_m);
    mem_free(knots->size_m);
    *knots = (struct knots){ 0 };
}

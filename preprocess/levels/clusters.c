/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds clusters (groups of adjacent triangles) from meshoptimizer's meshlets, which grow over adjacent triangles. */
#include "preprocess/levels/clusters.h"

#include <meshoptimizer.h>
#include <string.h>

#include "base/mem.h"

#define MAX_VERTICES 255 /* meshoptimizer's limit of vertices per meshlet */
/* weight (0 to 1) by which meshoptimizer prefers flat clusters, whose triangles face in similar directions, to compact ones */
#define CONE_WEIGHT 0.5f

struct clusters_making {
    struct workers_task *task;
    struct level level; /* the level of detail being partitioned; its arrays belong to the caller */
    float (*positions_m)[3];
    uint32_t vertex_count;
    struct clusters made; /* clusters of the level of detail; their index offsets are relative to the level's first index */
};

/* A primitive whose vertices are renumbered from 0, because meshoptimizer's run time depends on the number of vertices passed in. */
struct local {
    uint32_t *of; /* by vertex of the geometry: 1 + its index in the current primitive; 0: not used by the primitive */
    uint32_t *indices, *vertices;
    float (*positions_m)[3];
    uint32_t count;
};

static void number_locally(struct local *local, const float (*positions_m)[3], const uint32_t *indices, uint32_t index_count)
{
    local->count = 0;
    for (uint32_t i = 0; i < index_count; i++) {
        uint32_t v = indices[i];
        if (!local->of[v]) {
            local->vertices[local->count] = v;
            memcpy(local->positions_m[local->count], positions_m[v], sizeof(*local->positions_m));
            local->of[v] = ++local->count;
        }
        local->indices[i] = local->of[v] - 1;
    }
    for (uint32_t i = 0; i < local->count; i++)
        local->of[local->vertices[i]] = 0;
}

static void add_meshlet(struct clusters *clusters, const struct local *local, const struct meshopt_Meshlet *meshlet,
                        const unsigned *vertices, const unsigned char *triangles, uint32_t first, uint32_t *out)
{
    unsigned count = 3 * meshlet->triangle_count, room[3 * CLUSTERS_MAX_TRIANGLES] = { 0 };
    for (unsigned i = 0; i < count; i++)
        room[i] = triangles[meshlet->triangle_offset + i];
    meshopt_optimizeVertexCache(room, room, count, meshlet->vertex_count);
    for (unsigned i = 0; i < count; i++)
        out[i] = local->vertices[vertices[meshlet->vertex_offset + room[i]]];
    clusters->at[clusters->count++] = (struct asset_cluster){ .first_index = first, .index_count = count };
}

static void cut_primitive(struct clusters_making *making, struct local *local, const struct asset_primitive *primitive)
{
    struct clusters *made = &making->made;
    uint32_t *indices = making->level.indices + primitive->first_index, done = 0;
    size_t most = meshopt_buildMeshletsBound(primitive->index_count, MAX_VERTICES, CLUSTERS_MAX_TRIANGLES);
    struct meshopt_Meshlet *meshlets = mem_array(most, sizeof(*meshlets));
    unsigned *vertices = mem_array(most * MAX_VERTICES, sizeof(*vertices));
    unsigned char *triangles = mem_array(most * CLUSTERS_MAX_TRIANGLES * 3, 1);
    local->indices = mem_array(primitive->index_count, sizeof(*local->indices));
    local->vertices = mem_array(primitive->index_count, sizeof(*local->vertices));
    local->positions_m = mem_array(primitive->index_count, sizeof(*local->positions_m));
    number_locally(local, (const float(*)[3])making->positions_m, indices, primitive->index_count);
    size_t count = meshopt_buildMeshlets(meshlets, vertices, triangles, local->indices, primitive->index_count, local->positions_m[0],
                                         local->count, sizeof(*local->positions_m), MAX_VERTICES, CLUSTERS_MAX_TRIANGLES, CONE_WEIGHT);
    mem_grow(&made->at, &made->capacity, made->count + count, sizeof(*made->at));
    for (size_t m = 0; m < count; m++) {
        add_meshlet(made, local, &meshlets[m], vertices, triangles, primitive->first_index + done, indices + done);
        done += 3 * meshlets[m].triangle_count;
    }
    mem_free(local->indices);
    mem_free(local->vertices);
    mem_free(local->positions_m);
    mem_free(meshlets);
    mem_free(vertices);
    mem_free(triangles);
}

static void cut_level(void *arg)
{
    struct clusters_making *making = arg;
    const struct level *level = &making->level;
    struct local local = { .of = mem_array(making->vertex_count, sizeof(*local.of)) };
    for (uint32_t p = 0; p < level->primitive_count; p++)
        if (level->primitives[p].index_count)
            cut_primitive(making, &local, &level->primitives[p]);
    for (uint32_t c = 0; c < making->made.count; c++)
        asset_cluster_measure(&making->made.at[c], (const float(*)[3])making->positions_m, level->indices);
    mem_free(local.of);
    mem_free(making->positions_m);
}

struct clusters_making *clusters_begin(struct workers *workers, const struct level *level, const float (*positions_m)[3],
                                       uint32_t vertex_count)
{
    struct clusters_making *making = mem_new(sizeof(*making));
    *making = (struct clusters_making){ .level = *level, .vertex_count = vertex_count };
    making->positions_m = mem_array(vertex_count, sizeof(*positions_m));
    memcpy(making->positions_m, positions_m, vertex_count * sizeof(*positions_m));
    making->task = workers_begin(workers, cut_level, making);
    return making;
}

void clusters_end(struct clusters_making **making_ptr, uint32_t first_index, struct clusters *clusters)
{
    struct clusters_making *making = *making_ptr;
    workers_end(&making->task);
    mem_grow(&clusters->at, &clusters->capacity, clusters->count + making->made.count, sizeof(*clusters->at));
    for (uint32_t c = 0; c < making->made.count; c++) {
        clusters->at[clusters->count] = making->made.at[c];
        clusters->at[clusters->count++].first_index += first_index;
    }
    clusters_finish(&making->made);
    mem_free(making);
    *making_ptr = NULL;
}

void clusters_finish(struct clusters *clusters)
{
    mem_free(clusters->at);
    *clusters = (struct clusters){ 0 };
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Clusters by meshoptimizer's meshlets, which grow over neighbouring triangles. */
#include "preprocess/clusters.h"

#include <math.h>
#include <meshoptimizer.h>
#include <string.h>

#include "base/mem.h"

#define MOST_VERTICES 255 /* of a meshlet, says meshoptimizer */
#define CONE_WEIGHT 0.5f  /* flat clusters against round ones */

struct piece { /* what one primitive became */
    struct asset_cluster *at;
    uint32_t count;
};

struct job {
    struct geometry *geometry;
    struct piece *pieces;
};

/* A primitive's own vertices, numbered from 0: meshoptimizer looks at all vertices that it is given. */
struct local {
    uint32_t *of; /* by vertex of the geometry: number + 1 in the primitive in hand, else 0 */
    uint32_t *indices, *vertices;
    float (*positions_m)[3];
    uint32_t count;
};

static void number_locally(struct local *local, const struct geometry *g, const uint32_t *indices, uint32_t index_count)
{
    local->count = 0;
    for (uint32_t i = 0; i < index_count; i++) {
        uint32_t v = indices[i];
        if (!local->of[v]) {
            local->vertices[local->count] = v;
            memcpy(local->positions_m[local->count], g->positions_m[v], sizeof(*local->positions_m));
            local->of[v] = ++local->count;
        }
        local->indices[i] = local->of[v] - 1;
    }
    for (uint32_t i = 0; i < local->count; i++)
        local->of[local->vertices[i]] = 0;
}

static void add_meshlet(struct piece *piece, const struct local *local, const struct meshopt_Meshlet *meshlet, const unsigned *vertices,
                        const unsigned char *triangles, uint32_t first, uint32_t *out)
{
    unsigned count = 3 * meshlet->triangle_count, room[3 * CLUSTERS_MAX_TRIANGLES] = { 0 };
    for (unsigned i = 0; i < count; i++)
        room[i] = triangles[meshlet->triangle_offset + i];
    meshopt_optimizeVertexCache(room, room, count, meshlet->vertex_count);
    for (unsigned i = 0; i < count; i++)
        out[i] = local->vertices[vertices[meshlet->vertex_offset + room[i]]];
    piece->at[piece->count++] = (struct asset_cluster){ .first_index = first, .index_count = count };
}

static void cut_primitive(struct piece *piece, struct local *local, struct geometry *g, const struct asset_primitive *primitive)
{
    uint32_t *indices = g->indices + primitive->first_index, done = 0;
    size_t most = meshopt_buildMeshletsBound(primitive->index_count, MOST_VERTICES, CLUSTERS_MAX_TRIANGLES);
    struct meshopt_Meshlet *meshlets = mem_array(most, sizeof(*meshlets));
    unsigned *vertices = mem_array(most * MOST_VERTICES, sizeof(*vertices));
    unsigned char *triangles = mem_array(most * CLUSTERS_MAX_TRIANGLES * 3, 1);
    local->indices = mem_array(primitive->index_count, sizeof(*local->indices));
    local->vertices = mem_array(primitive->index_count, sizeof(*local->vertices));
    local->positions_m = mem_array(primitive->index_count, sizeof(*local->positions_m));
    number_locally(local, g, indices, primitive->index_count);
    size_t count = meshopt_buildMeshlets(meshlets, vertices, triangles, local->indices, primitive->index_count, local->positions_m[0],
                                         local->count, sizeof(*local->positions_m), MOST_VERTICES, CLUSTERS_MAX_TRIANGLES, CONE_WEIGHT);
    piece->at = mem_array(count, sizeof(*piece->at));
    for (size_t m = 0; m < count; m++) {
        add_meshlet(piece, local, &meshlets[m], vertices, triangles, primitive->first_index + done, indices + done);
        done += 3 * meshlets[m].triangle_count;
    }
    mem_free(local->indices);
    mem_free(local->vertices);
    mem_free(local->positions_m);
    mem_free(meshlets);
    mem_free(vertices);
    mem_free(triangles);
}

static void cut_primitives(void *arg, size_t begin, size_t end)
{
    const struct job *job = arg;
    struct geometry *g = job->geometry;
    struct local local = { .of = mem_array(g->vertex_count, sizeof(*local.of)) };
    for (size_t p = begin; p < end; p++) {
        struct piece *piece = &job->pieces[p];
        if (g->primitives[p].index_count)
            cut_primitive(piece, &local, g, &g->primitives[p]);
        for (uint32_t c = 0; c < piece->count; c++)
            asset_cluster_measure(&piece->at[c], (const float(*)[3])g->positions_m, g->indices);
    }
    mem_free(local.of);
}

void clusters_make(struct clusters *clusters, struct geometry *geometry, struct workers *workers)
{
    struct job job = { .geometry = geometry, .pieces = mem_array(geometry->primitive_count, sizeof(*job.pieces)) };
    size_t capacity = 0;
    *clusters = (struct clusters){ 0 };
    if (workers)
        workers_for(workers, geometry->primitive_count, geometry->primitive_count / 16 + 1, cut_primitives, &job);
    else
        cut_primitives(&job, 0, geometry->primitive_count);
    for (uint32_t p = 0; p < geometry->primitive_count; p++) {
        const struct piece *piece = &job.pieces[p];
        mem_grow(&clusters->at, &capacity, clusters->count + piece->count, sizeof(*clusters->at));
        if (piece->count)
            memcpy(clusters->at + clusters->count, piece->at, piece->count * sizeof(*piece->at));
        clusters->count += piece->count;
        mem_free(piece->at);
    }
    mem_free(job.pieces);
}

void clusters_finish(struct clusters *clusters)
{
    mem_free(clusters->at);
    *clusters = (struct clusters){ 0 };
}

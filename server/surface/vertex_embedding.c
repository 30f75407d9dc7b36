/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds, for each vertex of an asset file, the surface point or triangle at its position (vertex_embedding.h). */
#include "surface/vertex_embedding.h"

#include <math.h>
#include <string.h>
#include <xxhash.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "surface/surface_impl.h"

#define GRAIN 512
#define ON_SURFACE 1e-3 /* a vertex counts as lying on a face up to this distance, in multiples of the mean edge length */

struct anchor {
    /* index of the surface point at the vertex's position; TRIMESH_NONE: no surface point is there, and `hit` is the vertex's position on
       the surface */
    uint32_t point;
    struct surface_point hit;
};

struct vertex_embedding {
    const struct surface *surface;
    size_t count;
    struct anchor *at;
};

struct point_table { /* hash table that finds the surface point at a position, among points that have triangles */
    const struct trimesh *mesh;
    uint32_t *points;
    size_t mask;
};

static size_t hash_of(const struct point_table *table, const double place_m[3])
{
    return XXH3_64bits(place_m, 3 * sizeof(*place_m)) & table->mask;
}

/* Returns the index of the hash table's slot for this position: the slot with the point, or the free slot where it would be inserted. */
static size_t slot_of(const struct point_table *table, const double place_m[3])
{
    size_t slot = hash_of(table, place_m);
    while (table->points[slot] != TRIMESH_NONE &&
           memcmp(table->mesh->points[table->points[slot]], place_m, sizeof(*table->mesh->points)) != 0)
        slot = (slot + 1) & table->mask;
    return slot;
}

static bool table_init(struct point_table *table, const struct trimesh *mesh)
{
    size_t size = 16;
    while (size < 2 * mesh->point_count)
        size *= 2;
    *table = (struct point_table){ mesh, mem_try_array(size, sizeof(*table->points)), size - 1 };
    if (!table->points)
        return false;
    memset(table->points, 0xff, size * sizeof(*table->points));
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++)
            table->points[slot_of(table, mesh->points[mesh->tris[t][i]])] = mesh->tris[t][i];
    return true;
}

struct embedding_job {
    struct vertex_embedding *embedding;
    struct point_table table;
    const float (*positions_m)[3];
    double (*normals)[3]; /* not normalised */
    /* by vertex: 1 if only coarser levels of detail use it, not the finest. Such a vertex may be nearer to the other side of a
       wall than to its own */
    char *is_off;
};

static bool find_normals(struct embedding_job *job, const float (*normals)[3], const uint32_t *triangles, size_t triangle_count)
{
    const size_t count = job->embedding->count;
    job->normals = mem_try_array(count, sizeof(*job->normals));
    job->is_off = mem_try_array(count, 1);
    if (!job->normals || !job->is_off)
        return false;
    memset(job->is_off, 1, count);
    for (size_t t = 0; t < triangle_count; t++) {
        const uint32_t *v = triangles + 3 * t;
        double p[3][3], n[3];
        for (int i = 0; i < 3; i++)
            for (int axis = 0; axis < 3; axis++)
                p[i][axis] = (double)job->positions_m[v[i]][axis];
        vec_normal(p[0], p[1], p[2], n);
        for (int i = 0; i < 3; i++) {
            job->is_off[v[i]] = 0;
            for (int axis = 0; axis < 3; axis++)
                job->normals[v[i]][axis] += n[axis];
        }
    }
    for (size_t v = 0; v < count && normals; v++)
        for (int axis = 0; axis < 3 && job->is_off[v]; axis++)
            job->normals[v][axis] = (double)normals[v][axis];
    return true;
}

static void project(const struct surface *surface, const double place_m[3], const double normal[3], bool is_off, struct surface_point *hit)
{
    struct bvh_place at;
    const struct surface_facing facing = { &surface->visible, normal };
    bvh_nearest(surface->bvh, place_m, is_off ? INFINITY : ON_SURFACE * surface->edge_m, surface_faces, &facing, &at);
    if (at.tri == TRIMESH_NONE) {
        surface_find_point(surface, place_m, normal, hit);
        return;
    }
    *hit = (struct surface_point){ .tri = at.tri, .distance_m = at.distance_m };
    memcpy(hit->point_m, at.point, sizeof(hit->point_m));
    memcpy(hit->weights, at.weights, sizeof(hit->weights));
}

static void find_some(void *arg, size_t begin, size_t end)
{
    struct embedding_job *job = arg;
    for (size_t v = begin; v < end; v++) {
        const float *p = job->positions_m[v];
        const double place_m[3] = { (double)p[0], (double)p[1], (double)p[2] };
        struct anchor *anchor = &job->embedding->at[v];
        anchor->point = job->table.points[slot_of(&job->table, place_m)];
        if (anchor->point == TRIMESH_NONE)
            project(job->embedding->surface, place_m, job->normals[v], job->is_off[v], &anchor->hit);
    }
}

struct vertex_embedding *vertex_embedding_create(const struct surface *surface, const float (*positions_m)[3], const float (*normals)[3],
                                                 size_t count, const uint32_t *triangles, size_t triangle_count)
{
    struct vertex_embedding *embedding = mem_new(sizeof(*embedding));
    struct embedding_job job = { .embedding = embedding, .positions_m = positions_m };
    *embedding = (struct vertex_embedding){ surface, count, mem_try_array(count, sizeof(*embedding->at)) };
    if (!embedding->at || !table_init(&job.table, &surface->mesh) || !find_normals(&job, normals, triangles, triangle_count)) {
        log_err(surface->log, "cannot map an asset's %zu vertices onto its surface of %zu points: out of memory", count,
                surface->mesh.point_count);
        vertex_embedding_destroy(&embedding);
    } else if (surface->workers) {
        workers_for(surface->workers, count, GRAIN, find_some, &job);
    } else {
        find_some(&job, 0, count);
    }
    mem_free(job.table.points);
    mem_free(job.normals);
    mem_free(job.is_off);
    return embedding;
}

void vertex_embedding_destroy(struct vertex_embedding **embedding)
{
    if (!*embedding)
        return;
    mem_free((*embedding)->at);
    mem_free(*embedding);
    *embedding = NULL;
}

bool vertex_embedding_distances(const struct vertex_embedding *embedding, const double point_m[3], float *out)
{
    const struct surface *surface = embedding->surface;
    struct surface_field field;
    if (!surface_field_init(&field, surface, (const double(*)[3])point_m, 1, NULL))
        return false;
    for (size_t v = 0; v < embedding->count; v++) {
        const struct anchor *anchor = &embedding->at[v];
        if (anchor->point != TRIMESH_NONE)
            out[v] = field.distances_m[anchor->point];
        else
            surface_field_at_point(&field, surface, &anchor->hit, &out[v]);
    }
    surface_field_finish(&field);
    return true;
}

uint32_t vertex_embedding_place(const struct vertex_embedding *embedding, size_t vertex, struct surface_point *hit)
{
    const struct surface *surface = embedding->surface;
    const struct anchor *anchor = &embedding->at[vertex];
    if (anchor->point != TRIMESH_NONE && !surface->propagation.hidden[anchor->point])
        return anchor->point;
    *hit = anchor->hit;
    if (anchor->point != TRIMESH_NONE)
        surface_find_point(surface, surface->mesh.points[anchor->point], NULL, hit);
    return TRIMESH_NONE;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the point of another body that a point of the mesh faces (line_of_sight.h). */
#include "surface/repair/line_of_sight.h"

#include "base/math/vec.h"
#include "base/mem.h"

#define LOOKS 0.5    /* minimum cosine between a face's normal and the direction to a point for the face to face the point */
#define NEXT_TO 1e-3 /* relative to the distance */

static void list_triangles(struct line_of_sight *sight)
{
    const struct trimesh *mesh = sight->mesh;
    sight->first = mem_array(mesh->point_count + 2, sizeof(*sight->first));
    sight->at = mem_array(3 * mesh->tri_count, sizeof(*sight->at));
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++)
            sight->first[mesh->tris[t][i] + 2]++;
    for (size_t p = 2; p < mesh->point_count + 2; p++)
        sight->first[p] += sight->first[p - 1];
    for (uint32_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++)
            sight->at[sight->first[mesh->tris[t][i] + 1]++] = t;
}

void line_of_sight_init(struct line_of_sight *sight, const struct trimesh *mesh, const struct body_parts *parts, const uint32_t *body,
                        const struct bvh *bvh)
{
    bool any_thin = false;
    *sight = (struct line_of_sight){ .mesh = mesh, .parts = parts, .body = body, .bvh = bvh };
    for (size_t p = 0; p < parts->count; p++)
        any_thin = any_thin || parts->thin[p];
    if (any_thin)
        list_triangles(sight);
}

void line_of_sight_finish(struct line_of_sight *sight)
{
    mem_free(sight->first);
    mem_free(sight->at);
}

/* Returns whether the triangle's part is open, so that its outer side is unknown and the triangle faces both ways. */
static bool looks_both_ways(const struct line_of_sight *sight, uint32_t tri)
{
    return !sight->parts->closed[sight->parts->of_source[sight->mesh->tri_source[tri]]];
}

/* Computes the outward unit normal. It is zero if the triangle bounds no body and so faces nothing: a wall between two bodies,
 * or a fin (a sheet that stands on a body). */
static void find_normal(const struct line_of_sight *sight, uint32_t tri, double n[3])
{
    const struct trimesh *mesh = sight->mesh;
    trimesh_normal(mesh, tri, n);
    double length = vec_length(n);
    for (int axis = 0; axis < 3; axis++)
        n[axis] *= length > 0 ? sight->parts->side_of_source[mesh->tri_source[tri]] / length : 0;
}

struct looking {
    const struct line_of_sight *sight;
    const double *from;
};

static bool looks_back(const void *arg, uint32_t tri)
{
    const struct looking *looking = arg;
    const struct trimesh *mesh = looking->sight->mesh;
    double n[3], up[3];
    if (looks_both_ways(looking->sight, tri))
        return true;
    find_normal(looking->sight, tri, n);
    vec_sub(looking->from, mesh->points[mesh->tris[tri][0]], up);
    return vec_dot(up, n) > 0;
}

static bool looks_at(const struct line_of_sight *sight, uint32_t point, const double way[3], double distance_m)
{
    double n[3];
    for (uint32_t i = sight->first[point]; i < sight->first[point + 1]; i++) {
        find_normal(sight, sight->at[i], n);
        if (looks_both_ways(sight, sight->at[i]) || vec_dot(n, way) > LOOKS * distance_m)
            return true;
    }
    return false;
}

struct sight_ray {
    const struct line_of_sight *sight;
    uint32_t own;
    bool is_blocked;
};

static void block(void *arg, uint32_t tri, double t)
{
    struct sight_ray *ray = arg;
    ray->is_blocked = ray->is_blocked || (t > NEXT_TO && t < 1 + NEXT_TO && ray->sight->body[tri] == ray->own);
}

/* Returns whether the body `own` of the point `from` blocks the view along `way` to the other point. Without this test, a wall between two
   bodies of one part would be joined to objects behind one of these bodies. */
static bool is_blocked(const struct line_of_sight *sight, const double from[3], const double way[3], uint32_t own)
{
    struct sight_ray ray = { sight, own, false };
    bvh_ray(sight->bvh, from, way, block, &ray);
    return ray.is_blocked;
}

bool line_of_sight_find(const struct line_of_sight *sight, uint32_t point, uint32_t own, struct bvh_place *place)
{
    const double *from = sight->mesh->points[point];
    const struct looking looking = { sight, from };
    double way[3];
    if (!sight->first)
        return false;
    bvh_nearest_unlike(sight->bvh, from, sight->parts->tolerance_m, own, looks_back, &looking, place);
    if (place->tri == TRIMESH_NONE)
        return false;
    vec_sub(place->point, from, way);
    return looks_at(sight, point, way, place->distance_m) && !is_blocked(sight, from, way, own);
}

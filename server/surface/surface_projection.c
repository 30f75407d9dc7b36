/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Projects points onto a surface: finds the nearest surface point, optionally with a fitting normal or on given model triangles. */
#include <math.h>
#include <string.h>

#include "base/math/vec.h"
#include "surface/surface_impl.h"

#define SPOT_ON_SURFACE 1e-3 /* a point counts as lying on a triangle below this distance, in multiples of the mean edge length */
/* A model triangle has pieces: the surface's triangles that lie in it, or at most SHORT_SIDES_WITHIN from its plane. The search for the
   nearest piece ends when one is found within this distance of the point, in multiples of the mean edge length. */
#define ON_PIECE 1e-5
/* if the given model triangles are divided into more surface triangles (pieces) than this, the bounding volume hierarchy is searched
   instead of each piece */
#define MAX_TRIED_PIECES 24
/* a triangle whose front faces along the requested normal is preferred to the nearest triangle, up to this many times its distance */
#define FACING_FACTOR 4.0
#define ROUNDING 1e-9 /* relative enlargement of search limits, because computed distances have rounding errors */

void surface_nearest(const struct surface *surface, const double point_m[3], struct surface_place *place)
{
    struct bvh_place at;
    bvh_nearest(surface->bvh, point_m, INFINITY, NULL, NULL, &at);
    memcpy(place->position_m, at.point, sizeof(at.point));
    place->distance_m = at.distance_m;
    double best2 = INFINITY;
    for (size_t v = 0; v < surface->vertex_count; v++) {
        double d2 = vec_distance2(surface->mesh.points[surface->vertex_point[v]], at.point);
        if (d2 < best2) {
            best2 = d2;
            place->vertex = (uint32_t)v;
        }
    }
}

bool surface_faces(const void *arg, uint32_t tri)
{
    const struct surface_facing *facing = arg;
    double n[3];
    trimesh_normal(facing->mesh, tri, n);
    return vec_dot(n, facing->normal) > 0;
}

bool surface_find_point_within(const struct surface *surface, const double point_m[3], const double normal[3], double limit_m,
                               struct surface_point *hit)
{
    struct bvh_place any, facing = { .tri = TRIMESH_NONE };
    bvh_nearest(surface->bvh, point_m, limit_m * (1 + ROUNDING), NULL, NULL, &any);
    if (normal && any.tri != TRIMESH_NONE && any.distance_m > surface->edge_m * SPOT_ON_SURFACE)
        bvh_nearest(surface->bvh, point_m, any.distance_m * FACING_FACTOR, surface_faces,
                    &(struct surface_facing){ &surface->visible, normal }, &facing);
    const struct bvh_place *at = facing.tri == TRIMESH_NONE ? &any : &facing;
    hit->tri = at->tri;
    hit->distance_m = at->distance_m;
    memcpy(hit->point_m, at->point, sizeof(hit->point_m));
    memcpy(hit->weights, at->weights, sizeof(hit->weights));
    return hit->tri != TRIMESH_NONE && hit->distance_m <= limit_m;
}

void surface_find_point(const struct surface *surface, const double point_m[3], const double normal[3], struct surface_point *hit)
{
    surface_find_point_within(surface, point_m, normal, INFINITY, hit);
}

bool surface_point_on(const struct surface *surface, const double point_m[3], double limit_m, uint32_t tri, struct surface_point *hit)
{
    if (tri >= surface->visible.tri_count)
        return false;
    const uint32_t *v = surface->visible.tris[tri];
    const double(*points)[3] = (const double(*)[3])surface->visible.points;
    hit->tri = tri;
    triangle_nearest(point_m, points[v[0]], points[v[1]], points[v[2]], hit->weights);
    for (int axis = 0; axis < 3; axis++)
        hit->point_m[axis] =
            hit->weights[0] * points[v[0]][axis] + hit->weights[1] * points[v[1]][axis] + hit->weights[2] * points[v[2]][axis];
    hit->distance_m = vec_distance(hit->point_m, point_m);
    return hit->distance_m <= limit_m;
}

struct among {
    const uint32_t *source;
    bool (*allowed)(const void *arg, uint32_t triangle);
    const void *arg;
};

static bool is_among(const void *arg, uint32_t tri)
{
    const struct among *among = arg;
    return among->allowed(among->arg, among->source[tri]);
}

bool surface_find_point_among(const struct surface *surface, const double point_m[3], double limit_m,
                              bool (*allowed)(const void *arg, uint32_t triangle), const void *arg, struct surface_point *hit)
{
    const struct among among = { surface->visible.tri_source, allowed, arg };
    struct bvh_place at;
    bvh_nearest(surface->bvh, point_m, limit_m, is_among, &among, &at);
    return surface_point_on(surface, point_m, INFINITY, at.tri, hit);
}

struct tri_planes {
    const uint32_t *of;
    uint32_t at[2];
};

static bool is_in_one_of(const void *arg, uint32_t triangle)
{
    const struct tri_planes *planes = arg;
    return planes->of[triangle] == planes->at[0] || planes->of[triangle] == planes->at[1];
}

static void try_piece(const struct surface *surface, const double point_m[3], uint32_t tri, struct surface_point *hit)
{
    struct surface_point at;
    if (surface_point_on(surface, point_m, hit->distance_m, tri, &at))
        *hit = at;
}

bool surface_find_point_on(const struct surface *surface, const double point_m[3], double limit_m, const uint32_t triangles[2],
                           struct surface_point *hit)
{
    const uint32_t *first = surface->piece_first;
    const struct tri_planes planes = { surface->plane, { surface->plane[triangles[0]], surface->plane[triangles[1]] } };
    size_t count = planes.at[0] == planes.at[1] ? 1 : 2, pieces = 0;
    *hit = (struct surface_point){ .tri = TRIMESH_NONE, .distance_m = limit_m };
    for (size_t i = 0; i < count; i++)
        pieces += first[planes.at[i] + 1] - first[planes.at[i]];
    if (pieces > MAX_TRIED_PIECES)
        return surface_find_point_among(surface, point_m, limit_m, is_in_one_of, &planes, hit);
    double enough_m = fmin(surface->edge_m * ON_PIECE, limit_m / 2);
    for (size_t i = 0; i < count; i++)
        for (uint32_t p = first[planes.at[i]]; p < first[planes.at[i] + 1] && hit->distance_m > enough_m; p++)
            try_piece(surface, point_m, surface->pieces[p], hit);
    return hit->tri != TRIMESH_NONE;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dropping points onto a surface. */
#include <string.h>

#include "surface/surface_state.h"
#include "surface/vec.h"

#define SPOT_ON_SURFACE 1e-3 /* mean edges: nearer than that, a point lies on its triangle */
#define SPOT_PATIENCE 4.0    /* how much farther than the nearest a triangle may be that faces the right way */

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

struct facing {
    const struct trimesh *mesh;
    const double *normal;
};

static bool faces(const void *arg, uint32_t tri)
{
    const struct facing *facing = arg;
    const uint32_t *v = facing->mesh->tris[tri];
    double ab[3], ac[3], n[3];
    vec_sub(facing->mesh->points[v[1]], facing->mesh->points[v[0]], ab);
    vec_sub(facing->mesh->points[v[2]], facing->mesh->points[v[0]], ac);
    vec_cross(ab, ac, n);
    return vec_dot(n, facing->normal) > 0;
}

void surface_find_spot(const struct surface *surface, const double point_m[3], const double normal[3], struct surface_spot *spot)
{
    struct bvh_place any, facing = { .tri = TRIMESH_NONE };
    bvh_nearest(surface->bvh, point_m, INFINITY, NULL, NULL, &any);
    if (normal && any.distance_m > surface->edge_m * SPOT_ON_SURFACE)
        bvh_nearest(surface->bvh, point_m, any.distance_m * SPOT_PATIENCE, faces, &(struct facing){ &surface->visible, normal }, &facing);
    const struct bvh_place *at = facing.tri == TRIMESH_NONE ? &any : &facing;
    spot->tri = at->tri;
    spot->distance_m = at->distance_m;
    memcpy(spot->point_m, at->point, sizeof(spot->point_m));
    memcpy(spot->weights, at->weights, sizeof(spot->weights));
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vertices where the sensors stand. */
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "base/vec.h"
#include "preprocess/split_impl.h"
#include "surface/bvh.h"

#define ON_OF_SIZE 1e-5 /* a sensor as near to a vertex or an edge stands on it */
#define MOST_CUTS 30    /* of edges that the other levels cut elsewhere */
#define FEW 32          /* sensors, for which a search tree of the level is not worth making */

struct hit { /* where a sensor meets a level */
    size_t tri;
    double weights[3], point[3];
};

static void corners_of(const struct split *split, const struct cut_tri *tri, double corners[3][3])
{
    for (int c = 0; c < 3; c++)
        for (int axis = 0; axis < 3; axis++)
            corners[c][axis] = (double)split_position(split, tri->v[c])[axis];
}

static void place_of(const struct split *split, size_t sensor, double point[3])
{
    for (int axis = 0; axis < 3; axis++)
        point[axis] = (double)split->in->sensors[sensor].surface_m[axis];
}

static double try_piece(const struct split *split, size_t t, const double point[3], double best_m, struct hit *hit)
{
    double corners[3][3], weights[3], at[3];
    corners_of(split, &split->mesh.tris[t], corners);
    triangle_nearest(point, corners[0], corners[1], corners[2], weights);
    for (int axis = 0; axis < 3; axis++)
        at[axis] = weights[0] * corners[0][axis] + weights[1] * corners[1][axis] + weights[2] * corners[2][axis];
    double distance_m = vec_distance(at, point);
    if (!(distance_m < best_m))
        return best_m;
    hit->tri = t;
    memcpy(hit->weights, weights, sizeof(weights));
    memcpy(hit->point, at, sizeof(at));
    return distance_m;
}

/* Among the pieces of a triangle that the level had at first: in its own place, and behind the first ones. */
static double find_piece(const struct split *split, uint32_t tri, const double point[3], struct hit *hit)
{
    double best_m = try_piece(split, tri, point, INFINITY, hit);
    for (size_t t = split->first_count; t < split->mesh.tri_count; t++)
        if (split->mesh.tris[t].origin == split->mesh.tris[tri].origin)
            best_m = try_piece(split, t, point, best_m, hit);
    return best_m;
}

/* The distance of a vertex from a point. */
static double off(const struct split *split, uint32_t vertex, const float point[3])
{
    return split_length(split_position(split, vertex), point);
}

static void know_place(struct split *split, uint32_t place, uint32_t part, const uint32_t *edge)
{
    split_add_place(split, place, part);
    split_measure_places(split, place, edge, 1);
}

/* Cuts the edge of the triangle that runs through the point, if one does. */
static bool cut_edge_at(struct split *split, const struct hit *hit, const float point[3])
{
    struct cutmesh *mesh = &split->mesh;
    struct cut_tri tri = mesh->tris[hit->tri];
    for (int i = 0; i < 3; i++) {
        struct cut_edge *edge = &mesh->cuts[tri.e[i]];
        double t = hit->weights[(i + 1) % 3] / fmax(hit->weights[i] + hit->weights[(i + 1) % 3], 1e-30);
        float foot[3];
        split_mix(split_position(split, tri.v[i]), split_position(split, tri.v[(i + 1) % 3]), t, foot);
        if (split_length(foot, point) > ON_OF_SIZE * split->size_m)
            continue;
        edge->share = edge->middle != TRIMESH_NONE
                          ? edge->share
                          : (float)(mesh->places.of_vertex[tri.v[i]] == mesh->places.of_vertex[edge->a] ? t : 1 - t);
        if (cutmesh_cut(mesh, tri.e[i], point))
            know_place(split, edge->middle, split->part[mesh->places.of_vertex[tri.v[i]]], &tri.e[i]);
        cutmesh_apply(mesh);
        return true;
    }
    return false;
}

static uint32_t put_into_triangle(struct split *split, const struct hit *hit, const float point[3])
{
    struct cutmesh *mesh = &split->mesh;
    uint32_t vertex = cutmesh_insert(mesh, hit->tri, hit->weights, point), place = mesh->places.of_vertex[vertex];
    know_place(split, place, split->part[mesh->places.of_vertex[mesh->tris[hit->tri].v[0]]], &mesh->tris[hit->tri].e[2]);
    return vertex;
}

/* A vertex that is there, or a new one in an edge or in a triangle. An edge that another level cut elsewhere is cut there first. False: the
   part that the sensor stands on is not in this level. */
static bool find_vertex(struct split *split, uint32_t tri, const double point[3], double error_m, uint32_t *vertex)
{
    struct hit hit = { 0 };
    for (int tries = 0; tries < MOST_CUTS; tries++) {
        float at[3];
        if (find_piece(split, tri, point, &hit) > 2 * error_m + ON_OF_SIZE * split->size_m)
            return false;
        for (int axis = 0; axis < 3; axis++)
            at[axis] = (float)hit.point[axis];
        for (int c = 0; c < 3; c++) {
            *vertex = split->mesh.tris[hit.tri].v[c];
            if (off(split, *vertex, at) <= ON_OF_SIZE * split->size_m)
                return true;
        }
        if (!cut_edge_at(split, &hit, at)) {
            *vertex = put_into_triangle(split, &hit, at);
            return true;
        }
    }
    return false;
}

static void stand(struct split *split, uint32_t tri, size_t sensor, double error_m)
{
    struct asset_sensor *at = &split->in->sensors[sensor];
    double point[3];
    uint32_t vertex, place;
    place_of(split, sensor, point);
    if (!find_vertex(split, tri, point, error_m, &vertex) || !split->finest)
        return;
    place = split->mesh.places.of_vertex[vertex];
    at->nearest_vertex = vertex;
    memcpy(at->surface_m, split_position(split, vertex), sizeof(at->surface_m));
    split->geodesic_m[place * split->sensors + sensor] = 0;
    split_measure_places(split, place, NULL, 1);
}

/* --- where they are nearest to the level: of triangles that are as near, the first ----------------------------------------------- */

static void look_at_all(const struct split *split, uint32_t *nearest)
{
    double *best2 = mem_array(split->sensors, sizeof(*best2));
    for (size_t s = 0; s < split->sensors; s++)
        best2[s] = INFINITY;
    for (size_t t = 0; t < split->mesh.tri_count; t++) {
        double corners[3][3], point[3], weights[3], at[3];
        corners_of(split, &split->mesh.tris[t], corners);
        for (size_t s = 0; s < split->sensors; s++) {
            place_of(split, s, point);
            if (triangle_is_farther(point, corners[0], corners[1], corners[2], sqrt(best2[s])))
                continue;
            triangle_nearest(point, corners[0], corners[1], corners[2], weights);
            for (int axis = 0; axis < 3; axis++)
                at[axis] = weights[0] * corners[0][axis] + weights[1] * corners[1][axis] + weights[2] * corners[2][axis];
            double distance2 = vec_distance2(at, point);
            if (distance2 < best2[s]) {
                best2[s] = distance2;
                nearest[s] = (uint32_t)t;
            }
        }
    }
    mem_free(best2);
}

static void look_in_tree(const struct split *split, uint32_t *nearest)
{
    const struct cutmesh *mesh = &split->mesh;
    struct trimesh trimesh = { 0 };
    for (size_t p = 0; p < mesh->places.count; p++) {
        const float *at = mesh->places.positions_m[p];
        trimesh_add_point(&trimesh, (const double[3]){ (double)at[0], (double)at[1], (double)at[2] });
    }
    for (size_t t = 0; t < mesh->tri_count; t++)
        trimesh_add_tri(&trimesh, mesh->places.of_vertex[mesh->tris[t].v[0]], mesh->places.of_vertex[mesh->tris[t].v[1]],
                        mesh->places.of_vertex[mesh->tris[t].v[2]], (uint32_t)t);
    struct bvh *bvh = bvh_create(&trimesh);
    for (size_t s = 0; s < split->sensors; s++) {
        struct bvh_place place;
        double point[3];
        place_of(split, s, point);
        bvh_nearest(bvh, point, INFINITY, NULL, NULL, &place);
        nearest[s] = place.tri;
    }
    bvh_destroy(&bvh);
    trimesh_finish(&trimesh);
}

void split_place_sensors(struct split *split, double error_m)
{
    uint32_t *nearest = mem_array(split->sensors, sizeof(*nearest));
    (split->sensors <= FEW ? look_at_all : look_in_tree)(split, nearest);
    split->first_count = split->mesh.tri_count;
    for (size_t s = 0; s < split->sensors; s++)
        stand(split, nearest[s], s, error_m);
    mem_free(nearest);
}

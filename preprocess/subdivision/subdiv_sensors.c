/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inserts vertices at the sensors. */
#include <math.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "preprocess/subdivision/subdivide_impl.h"
#include "surface/mesh/bvh.h"

/* distance of a sensor from a vertex or an edge, relative to the asset's size, up to which that vertex, or a new vertex on that
   edge, becomes the sensor's */
#define ON_OF_SIZE 1e-5
/* maximum number of edges split to find the vertex at one sensor; another level of detail may have split these edges at other
   points */
#define MAX_CUTS 30
/* number of sensors up to which every triangle is compared with every sensor; for more, a bounding volume hierarchy is built */
#define FEW 32

struct sensor_hit { /* point of a level of detail nearest to a sensor */
    size_t tri;
    double weights[3], point[3];
};

static void corners_of(const struct subdiv *subdiv, const struct subdiv_tri *tri, double corners[3][3])
{
    for (int c = 0; c < 3; c++)
        for (int axis = 0; axis < 3; axis++)
            corners[c][axis] = (double)subdiv_position(subdiv, tri->v[c])[axis];
}

static void place_of(const struct subdiv *subdiv, size_t sensor, double point[3])
{
    for (int axis = 0; axis < 3; axis++)
        point[axis] = (double)subdiv->in->sensors[sensor].surface_m[axis];
}

static double try_piece(const struct subdiv *subdiv, size_t t, const double point[3], double best_m, struct sensor_hit *hit)
{
    double corners[3][3], weights[3], at[3];
    corners_of(subdiv, &subdiv->mesh.tris[t], corners);
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

/* Finds the piece of original triangle `tri` that is nearest to a point. One piece has the index of the original; the others
 * were appended. Returns the distance. */
static double find_piece(const struct subdiv *subdiv, uint32_t tri, const double point[3], struct sensor_hit *hit)
{
    double best_m = try_piece(subdiv, tri, point, INFINITY, hit);
    for (size_t t = subdiv->first_count; t < subdiv->mesh.tri_count; t++)
        if (subdiv->mesh.tris[t].origin == subdiv->mesh.tris[tri].origin)
            best_m = try_piece(subdiv, t, point, best_m, hit);
    return best_m;
}

/* Returns the distance in metres of a vertex from a point. */
static double off(const struct subdiv *subdiv, uint32_t vertex, const float point[3])
{
    return subdiv_length(subdiv_position(subdiv, vertex), point);
}

static void know_place(struct subdiv *subdiv, uint32_t place, uint32_t part, const uint32_t *edge)
{
    subdiv_add_place(subdiv, place, part);
    subdiv_measure_places(subdiv, place, edge, 1);
}

/* Splits the edge of the triangle on which the point lies. Returns false if the point is on none of its edges. */
static bool cut_edge_at(struct subdiv *subdiv, const struct sensor_hit *hit, const float point[3])
{
    struct subdiv_mesh *mesh = &subdiv->mesh;
    struct subdiv_tri tri = mesh->tris[hit->tri];
    for (int i = 0; i < 3; i++) {
        struct subdiv_edge *edge = &mesh->cuts[tri.e[i]];
        double t = hit->weights[(i + 1) % 3] / fmax(hit->weights[i] + hit->weights[(i + 1) % 3], 1e-30);
        float foot[3];
        subdiv_mix(subdiv_position(subdiv, tri.v[i]), subdiv_position(subdiv, tri.v[(i + 1) % 3]), t, foot);
        if (subdiv_length(foot, point) > ON_OF_SIZE * subdiv->size_m)
            continue;
        edge->share = edge->middle != TRIMESH_NONE
                          ? edge->share
                          : (float)(mesh->welded.of_vertex[tri.v[i]] == mesh->welded.of_vertex[edge->a] ? t : 1 - t);
        if (subdiv_mesh_split_edge(mesh, tri.e[i], point))
            know_place(subdiv, edge->middle, subdiv->part[mesh->welded.of_vertex[tri.v[i]]], &tri.e[i]);
        subdiv_mesh_apply(mesh);
        return true;
    }
    return false;
}

static uint32_t put_into_triangle(struct subdiv *subdiv, const struct sensor_hit *hit, const float point[3])
{
    struct subdiv_mesh *mesh = &subdiv->mesh;
    uint32_t vertex = subdiv_mesh_insert(mesh, hit->tri, hit->weights, point), place = mesh->welded.of_vertex[vertex];
    know_place(subdiv, place, subdiv->part[mesh->welded.of_vertex[mesh->tris[hit->tri].v[0]]], &mesh->tris[hit->tri].e[2]);
    return vertex;
}

/* Finds or creates the vertex at a sensor: an existing one, or a new one on an edge or inside a triangle. If another level of
 * detail split an edge elsewhere, splits it there first. Returns false if the current level omits the connected component that
 * the sensor is on. */
static bool find_vertex(struct subdiv *subdiv, uint32_t tri, const double point[3], double error_m, uint32_t *vertex)
{
    struct sensor_hit hit = { 0 };
    for (int tries = 0; tries < MAX_CUTS; tries++) {
        float at[3];
        if (find_piece(subdiv, tri, point, &hit) > 2 * error_m + ON_OF_SIZE * subdiv->size_m)
            return false;
        for (int axis = 0; axis < 3; axis++)
            at[axis] = (float)hit.point[axis];
        for (int c = 0; c < 3; c++) {
            *vertex = subdiv->mesh.tris[hit.tri].v[c];
            if (off(subdiv, *vertex, at) <= ON_OF_SIZE * subdiv->size_m)
                return true;
        }
        if (!cut_edge_at(subdiv, &hit, at)) {
            *vertex = put_into_triangle(subdiv, &hit, at);
            return true;
        }
    }
    return false;
}

static void stand(struct subdiv *subdiv, uint32_t tri, size_t sensor, double error_m)
{
    struct asset_sensor *at = &subdiv->in->sensors[sensor];
    double point[3];
    uint32_t vertex, place;
    place_of(subdiv, sensor, point);
    if (!find_vertex(subdiv, tri, point, error_m, &vertex) || !subdiv->finest)
        return;
    place = subdiv->mesh.welded.of_vertex[vertex];
    at->nearest_vertex = vertex;
    memcpy(at->surface_m, subdiv_position(subdiv, vertex), sizeof(at->surface_m));
    subdiv->geodesic_m[place * subdiv->sensors + sensor] = 0;
    subdiv_measure_places(subdiv, place, NULL, 1);
}

/* --- the triangle nearest to each sensor; if several are equally near, the one with the lowest index ------------------------------ */

static void look_at_all(const struct subdiv *subdiv, uint32_t *nearest)
{
    double *best2 = mem_array(subdiv->sensors, sizeof(*best2));
    for (size_t s = 0; s < subdiv->sensors; s++)
        best2[s] = INFINITY;
    for (size_t t = 0; t < subdiv->mesh.tri_count; t++) {
        double corners[3][3], point[3], weights[3], at[3];
        corners_of(subdiv, &subdiv->mesh.tris[t], corners);
        for (size_t s = 0; s < subdiv->sensors; s++) {
            place_of(subdiv, s, point);
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

static void look_in_tree(const struct subdiv *subdiv, uint32_t *nearest)
{
    const struct subdiv_mesh *mesh = &subdiv->mesh;
    struct trimesh trimesh = { 0 };
    for (size_t p = 0; p < mesh->welded.count; p++) {
        const float *at = mesh->welded.positions_m[p];
        trimesh_add_point(&trimesh, (const double[3]){ (double)at[0], (double)at[1], (double)at[2] });
    }
    for (size_t t = 0; t < mesh->tri_count; t++)
        trimesh_add_tri(&trimesh, mesh->welded.of_vertex[mesh->tris[t].v[0]], mesh->welded.of_vertex[mesh->tris[t].v[1]],
                        mesh->welded.of_vertex[mesh->tris[t].v[2]], (uint32_t)t);
    struct bvh *bvh = bvh_create(&trimesh);
    for (size_t s = 0; s < subdiv->sensors; s++) {
        struct bvh_place place;
        double point[3];
        place_of(subdiv, s, point);
        bvh_nearest(bvh, point, INFINITY, NULL, NULL, &place);
        nearest[s] = place.tri;
    }
    bvh_destroy(&bvh);
    trimesh_finish(&trimesh);
}

void subdiv_place_sensors(struct subdiv *subdiv, double error_m)
{
    uint32_t *nearest = mem_array(subdiv->sensors, sizeof(*nearest));
    (subdiv->sensors <= FEW ? look_at_all : look_in_tree)(subdiv, nearest);
    subdiv->first_count = subdiv->mesh.tri_count;
    for (size_t s = 0; s < subdiv->sensors; s++)
        stand(subdiv, nearest[s], s, error_m);
    mem_free(nearest);
}

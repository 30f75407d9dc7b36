/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes distances between surfaces, and the rigid motion between equal shapes. */
#include "preprocess/diff/diff_shape.h"

#include <math.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "plant/models/transform.h"
#include "preprocess/geometry/rigid_fit.h"
#include "surface/mesh/bvh.h"

/* Density of the points at which a shape's distance from the other shape is measured: this many along a line as long as the
   shape's diagonal. */
#define SPREAD 100.0
#define PLACES_MAX 64 /* maximum number of points along a side of a triangle at which its distance from the other shape is measured */

struct diff_shape {
    struct trimesh mesh;
    struct bvh *bvh;
    double low[3], high[3];
};

/* Copies the vertices that the asset's triangles use, keeping their order. A prepared asset has other vertices too, which
 * belong to coarser levels of detail and are not on the surface. */
static void take_points(struct trimesh *mesh, const struct diff_side_shape *from)
{
    char *used = mem_array(from->vertex_count, 1);
    uint32_t *number = mem_array(from->vertex_count, sizeof(*number));
    for (size_t i = 0; i < from->index_count; i++)
        used[from->indices[i]] = 1;
    for (size_t v = 0; v < from->vertex_count; v++) {
        if (!used[v])
            continue;
        for (int axis = 0; axis < 3; axis++)
            mesh->points[mesh->point_count][axis] = (double)from->positions_m[v][axis];
        number[v] = (uint32_t)mesh->point_count++;
    }
    for (size_t i = 0; i < from->index_count; i++)
        mesh->tris[i / 3][i % 3] = number[from->indices[i]];
    mem_free(used);
    mem_free(number);
}

struct diff_shape *diff_shape_create(const struct diff_side_shape *from)
{
    struct diff_shape *shape = mem_new(sizeof(*shape));
    struct trimesh *mesh = &shape->mesh;
    mesh->points = mem_array(from->vertex_count, sizeof(*mesh->points));
    mesh->tris = mem_array(from->index_count / 3, sizeof(*mesh->tris));
    mesh->tri_count = from->index_count / 3;
    take_points(mesh, from);
    for (int axis = 0; axis < 3; axis++) {
        shape->low[axis] = INFINITY;
        shape->high[axis] = -INFINITY;
        for (size_t v = 0; v < mesh->point_count; v++) {
            shape->low[axis] = min_of(shape->low[axis], mesh->points[v][axis]);
            shape->high[axis] = max_of(shape->high[axis], mesh->points[v][axis]);
        }
    }
    shape->bvh = bvh_create(mesh);
    return shape;
}

void diff_shape_destroy(struct diff_shape **shape)
{
    if (!*shape)
        return;
    bvh_destroy(&(*shape)->bvh);
    trimesh_finish(&(*shape)->mesh);
    mem_free(*shape);
    *shape = NULL;
}

void diff_shape_box(const struct diff_shape *shape, double low_m[3], double high_m[3])
{
    memcpy(low_m, shape->low, sizeof(shape->low));
    memcpy(high_m, shape->high, sizeof(shape->high));
}

double diff_shape_diagonal(const struct diff_shape *shape)
{
    return vec_distance(shape->low, shape->high);
}

double diff_shape_nearest(const struct diff_shape *shape, const double point_m[3], double place_m[3])
{
    struct bvh_place at;
    bvh_nearest(shape->bvh, point_m, INFINITY, NULL, NULL, &at);
    memcpy(place_m, at.point, sizeof(at.point));
    return at.distance_m;
}

/* --- distance between surfaces ---------------------------------------------------------------------------------------------------- */

struct shape_distance_search {
    const struct diff_shape *to;
    const double *motion;
    double worst_m, enough_m;
};

static bool try_place(struct shape_distance_search *search, const double p[3])
{
    struct bvh_place at;
    double q[3];
    transform_point(search->motion, p, q);
    bvh_nearest(search->to->bvh, q, INFINITY, NULL, NULL, &at);
    search->worst_m = max_of(search->worst_m, at.distance_m);
    return search->enough_m > 0 && search->worst_m > search->enough_m;
}

/* Measures the distance of points in a triangle from the other shape; the points lie in rows parallel to one side. Larger
 * triangles have more points. Returns true as soon as a distance exceeds enough_m. */
static bool try_triangle(struct shape_distance_search *search, const double *a, const double *b, const double *c, double spacing_m)
{
    double longest_m = max_of(vec_distance(a, b), max_of(vec_distance(b, c), vec_distance(c, a)));
    int n = (int)min_of(ceil(longest_m / spacing_m), PLACES_MAX);
    for (int i = 0; i < n; i++)
        for (int j = 0; i + j < n; j++) {
            double p[3], u = (i + 1 / 3.0) / n, v = (j + 1 / 3.0) / n;
            for (int axis = 0; axis < 3; axis++)
                p[axis] = a[axis] + u * (b[axis] - a[axis]) + v * (c[axis] - a[axis]);
            if (try_place(search, p))
                return true;
        }
    return false;
}

static double one_way(const struct diff_shape *from, const struct diff_shape *to, const double motion[16], double enough_m)
{
    struct shape_distance_search search = { .to = to, .motion = motion, .enough_m = enough_m };
    const struct trimesh *mesh = &from->mesh;
    double spacing_m = max_of(diff_shape_diagonal(from) / SPREAD, 1e-9);
    bool enough = false;
    for (size_t v = 0; v < mesh->point_count && !enough; v++)
        enough = try_place(&search, mesh->points[v]);
    for (size_t t = 0; t < mesh->tri_count && !enough; t++)
        enough = try_triangle(&search, mesh->points[mesh->tris[t][0]], mesh->points[mesh->tris[t][1]], mesh->points[mesh->tris[t][2]],
                              spacing_m);
    return search.worst_m;
}

double diff_shape_apart(const struct diff_shape *a, const struct diff_shape *b, const double b_to_a[16], double enough_m)
{
    double a_to_b[16], first_m = one_way(b, a, b_to_a, enough_m);
    if ((enough_m > 0 && first_m > enough_m) || !transform_invert(b_to_a, a_to_b))
        return first_m;
    return max_of(first_m, one_way(a, b, a_to_b, enough_m));
}

/* --- motions ------------------------------------------------------------------------------------------------------------------------ */

bool diff_shape_motion(const struct diff_shape *a, const struct diff_shape *b, double b_to_a[16])
{
    if (a->mesh.point_count != b->mesh.point_count || a->mesh.point_count == 0)
        return false;
    rigid_fit((const double(*)[3])b->mesh.points, (const double(*)[3])a->mesh.points, a->mesh.point_count, b_to_a);
    return true;
}

double diff_shape_moved(const struct diff_shape *shape, const double motion[16])
{
    double most_m = 0;
    for (int corner = 0; corner < 8; corner++) {
        double p[3], q[3];
        for (int axis = 0; axis < 3; axis++)
            p[axis] = corner >> axis & 1 ? shape->high[axis] : shape->low[axis];
        transform_point(motion, p, q);
        most_m = max_of(most_m, vec_distance(p, q));
    }
    return most_m;
}

double diff_turned_deg(const double motion[16])
{
    double cosine = (motion[0] + motion[5] + motion[10] - 1) / 2;
    return acos(min_of(max_of(cosine, -1), 1)) * 180 / M_PI;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Queries of the BVH (tree of bounding boxes over triangles), compared with loops over all triangles. Of several equally near
   triangles, the query must return the one with the lowest number. */
#include "tests/support/test.h"

#include "base/math/vec.h"
#include "surface/mesh/bvh.h"
#include "tests/support/surface_case.h"

#define POINTS 400
/* distances that differ by less than this fraction of the coordinates are treated as equal, because only rounding decides
   between them */
#define FAR 1e-9

/* Makes a mesh of triangles on a lattice of points, so that many share a corner or an edge, and of separate triangles of all
   sizes and shapes. */
static void make_mesh(struct trimesh *mesh, size_t tri_count, double shift_m)
{
    const uint32_t side = 6;
    *mesh = (struct trimesh){ 0 };
    for (uint32_t p = 0; p < side * side * side; p++)
        trimesh_add_point(mesh, (const double[3]){ shift_m + p % side, shift_m + p / side % side, p / (side * side) });
    for (uint32_t p = 0; p < 100; p++)
        trimesh_add_point(mesh, (const double[3]){ shift_m + between(-3, 9), shift_m + between(-3, 9), between(-3, 9) });
    while (mesh->tri_count < tri_count) {
        uint32_t a = (uint32_t)between(0, side * side * side - side * side - side - 1), v[3] = { a, a + 1, a + side };
        if (mesh->tri_count % 3 == 1)
            v[2] = a + side * side;
        if (mesh->tri_count % 3 == 2)
            for (int c = 0; c < 3; c++)
                v[c] = side * side * side + (uint32_t)between(0, 99.9);
        if (v[0] != v[1] && v[1] != v[2] && v[2] != v[0])
            trimesh_add_tri(mesh, v[0], v[1], v[2], (uint32_t)mesh->tri_count);
    }
}

static bool of_third(const void *arg, uint32_t tri)
{
    return tri % 3 == *(const uint32_t *)arg;
}

static double distance_of(const struct trimesh *mesh, uint32_t tri, const double point[3])
{
    const uint32_t *v = mesh->tris[tri];
    double w[3], q[3];
    triangle_nearest(point, mesh->points[v[0]], mesh->points[v[1]], mesh->points[v[2]], w);
    for (int axis = 0; axis < 3; axis++)
        q[axis] = w[0] * mesh->points[v[0]][axis] + w[1] * mesh->points[v[1]][axis] + w[2] * mesh->points[v[2]][axis];
    return sqrt(vec_distance2(point, q));
}

static double distance_to_edge(const double p[3], const double a[3], const double b[3])
{
    double ab[3], ap[3], at[3];
    vec_sub(b, a, ab);
    vec_sub(p, a, ap);
    vec_mix(a, b, fmin(fmax(vec_dot(ab, ap) / vec_dot(ab, ab), 0), 1), at);
    return vec_distance(p, at);
}

/* Reference: returns the distance from p to a triangle, from its three edges and, if p projects inside, from its plane. */
static double distance_plainly(const double p[3], const double at[3][3])
{
    double n[3], found_m = INFINITY, ap[3];
    bool inside = true;
    vec_normal(at[0], at[1], at[2], n);
    for (int i = 0; i < 3; i++) {
        const double *a = at[i], *b = at[(i + 1) % 3];
        double ab[3], to_inside[3];
        found_m = fmin(found_m, distance_to_edge(p, a, b));
        vec_sub(b, a, ab);
        vec_cross(n, ab, to_inside);
        vec_sub(p, a, ap);
        inside &= vec_dot(ap, to_inside) >= 0;
    }
    return inside ? fmin(found_m, fabs(vec_dot(ap, n)) / vec_length(n)) : found_m;
}

/* Distances to triangles of all shapes, up to 10,000 times as long as high, from points close by and up to a hundred triangle
   sizes away. */
TEST(test_nearest_of_a_triangle)
{
    for (int i = 0; i < 200000; i++) {
        double at[3][3], p[3], w[3], q[3], height = pow(10, between(-4, 0)), far = pow(10, between(-3, 2)), along = between(-1, 2);
        for (int axis = 0; axis < 3; axis++) {
            at[0][axis] = between(-1, 1);
            at[1][axis] = between(-1, 1);
            at[2][axis] = at[0][axis] + along * (at[1][axis] - at[0][axis]) + height * between(-1, 1);
        }
        double u = between(-0.5, 1.5), v = between(-0.5, 1.5);
        for (int axis = 0; axis < 3; axis++)
            p[axis] = u * at[0][axis] + v * at[1][axis] + (1 - u - v) * at[2][axis] + far * between(-1, 1);
        triangle_nearest(p, at[0], at[1], at[2], w);
        for (int axis = 0; axis < 3; axis++)
            q[axis] = w[0] * at[0][axis] + w[1] * at[1][axis] + w[2] * at[2][axis];
        assert_true(w[0] >= 0 && w[1] >= 0 && w[2] >= 0);
        assert_float_equal(w[0] + w[1] + w[2], 1, 1e-12);
        double plain_m = distance_plainly(p, at);
        if (fabs(vec_distance(p, q) - plain_m) > 1e-7 * (1 + far))
            print_message("# %d: %.12g m, plainly %.12g m\n", i, vec_distance(p, q), plain_m);
        assert_float_equal(vec_distance(p, q), plain_m, 1e-7 * (1 + far));
    }
}

/* Reference for bvh_nearest(): tries every triangle and returns the nearest; of several equally near ones, the first. */
static uint32_t find_slowly(const struct trimesh *mesh, const double point[3], const uint32_t *third, double *distance_m)
{
    uint32_t best = TRIMESH_NONE;
    *distance_m = INFINITY;
    for (uint32_t t = 0; t < mesh->tri_count; t++) {
        double m = third && !of_third(third, t) ? INFINITY : distance_of(mesh, t, point);
        if (m < *distance_m) {
            *distance_m = m;
            best = t;
        }
    }
    return best;
}

/* Asserts bvh_any_within(): if `any`, it finds a triangle within the limit, and otherwise none. A found triangle is never too
   far away or excluded. first: triangle that the search tests first. */
static void check_any(const struct trimesh *mesh, const struct bvh *bvh, const double point[3], const uint32_t *third, double limit_m,
                      size_t first, bool any)
{
    uint32_t tri = (uint32_t)first;
    assert_int_equal(bvh_any_within(bvh, point, limit_m, third ? of_third : NULL, third, &tri), any);
    if (any)
        assert_true(tri < mesh->tri_count && (!third || of_third(third, tri)) && distance_of(mesh, tri, point) <= limit_m * (1 + FAR));
    else
        assert_int_equal(tri, first);
}

static void check_point(const struct trimesh *mesh, const struct bvh *bvh, const double point[3], const uint32_t *third)
{
    struct bvh_place place;
    double distance_m, at[3] = { 0 };
    uint32_t tri = find_slowly(mesh, point, third, &distance_m);
    const double near_m = FAR * (1 + fabs(point[0]) + fabs(point[1]));
    bvh_nearest(bvh, point, INFINITY, third ? of_third : NULL, third, &place);
    if (tri == TRIMESH_NONE) {
        assert_int_equal(place.tri, TRIMESH_NONE);
        return;
    }
    assert_true(place.tri < mesh->tri_count && (!third || of_third(third, place.tri)));
    assert_true(fabs(place.distance_m - distance_m) <= near_m);
    assert_true(fabs(distance_of(mesh, place.tri, point) - distance_m) <= near_m);
    for (int c = 0; c < 3; c++)
        for (int axis = 0; axis < 3; axis++)
            at[axis] += place.weights[c] * mesh->points[mesh->tris[place.tri][c]][axis];
    assert_true(vec_distance(at, place.point) <= near_m);
    check_any(mesh, bvh, point, third, distance_m + near_m, TRIMESH_NONE, true);
    check_any(mesh, bvh, point, third, distance_m + near_m, tri, true);
    check_any(mesh, bvh, point, third, distance_m + near_m, mesh->tri_count / 2, true);
    if (distance_m <= near_m)
        return;
    bvh_nearest(bvh, point, distance_m - near_m, third ? of_third : NULL, third, &place);
    assert_int_equal(place.tri, TRIMESH_NONE);
    check_any(mesh, bvh, point, third, distance_m - near_m, TRIMESH_NONE, false);
    check_any(mesh, bvh, point, third, distance_m - near_m, tri, false);
}

/* --- intersections of a ray and of a box with triangles -------------------------------------------------------------------------- */

static void mark(void *arg, uint32_t tri)
{
    ((char *)arg)[tri]++;
}

static void mark_hit(void *arg, uint32_t tri, double t)
{
    assert_true(t > 0);
    mark(arg, tri);
}

/* Reference: intersects a ray with a triangle by Cramer's rule. Returns 1: hit; 0: miss; -1: so near to an edge or to the ray's
   origin that rounding decides. */
static int meets_slowly(const struct trimesh *mesh, uint32_t tri, const double from[3], const double way[3])
{
    const uint32_t *v = mesh->tris[tri];
    double ab[3], ac[3], ao[3], n[3], side[3];
    vec_sub(mesh->points[v[1]], mesh->points[v[0]], ab);
    vec_sub(mesh->points[v[2]], mesh->points[v[0]], ac);
    vec_sub(from, mesh->points[v[0]], ao);
    vec_cross(ab, ac, n);
    double det = -vec_dot(way, n), t = vec_dot(ao, n) / det;
    vec_cross(ao, way, side);
    double u = vec_dot(ac, side) / det, w = -vec_dot(ab, side) / det, least = min_of(min_of(u, w), min_of(1 - u - w, t));
    return fabs(det) < 1e-9 || fabs(least) < 1e-6 ? -1 : least > 0;
}

static void check_ray(const struct trimesh *mesh, const struct bvh *bvh, const double from[3], const double way[3], int counts[2])
{
    char *met = test_memory(mem_array(mesh->tri_count, 1));
    bvh_ray(bvh, from, way, mark_hit, met);
    for (uint32_t t = 0; t < mesh->tri_count; t++) {
        int expected = meets_slowly(mesh, t, from, way);
        if (expected >= 0) {
            assert_int_equal(met[t], expected);
            counts[expected]++;
        }
    }
}

/* Asserts that bvh_overlaps() visits exactly once each triangle whose bounding box is within margin_m of the box, and no
   triangle that is clearly farther away. */
static void check_box(const struct trimesh *mesh, const struct bvh *bvh, const double low[3], const double high[3], double margin_m)
{
    char *met = test_memory(mem_array(mesh->tri_count, 1));
    bvh_overlaps(bvh, low, high, margin_m, mark, met);
    for (uint32_t t = 0; t < mesh->tri_count; t++) {
        double apart_m = -INFINITY;
        for (int axis = 0; axis < 3; axis++) {
            const uint32_t *v = mesh->tris[t];
            double a = mesh->points[v[0]][axis], b = mesh->points[v[1]][axis], c = mesh->points[v[2]][axis];
            apart_m = max_of(apart_m, max_of(min_of(a, min_of(b, c)) - high[axis], low[axis] - max_of(a, max_of(b, c))));
        }
        if (apart_m <= margin_m)
            assert_int_equal(met[t], 1);
        else
            assert_true(met[t] == 0 || apart_m < margin_m + 0.1);
    }
}

TEST(test_what_rays_and_boxes_meet)
{
    static const size_t counts[] = { 0, 1, 8, 9, 65, 513, 3000 };
    static const double shifts_m[] = { 0, 3e4 };
    int met[2] = { 0 };
    for (size_t i = 0; i < sizeof(counts) / sizeof(*counts); i++)
        for (size_t j = 0; j < 2; j++) {
            struct trimesh mesh;
            make_mesh(&mesh, counts[i], shifts_m[j]);
            struct bvh *bvh = bvh_create(&mesh);
            for (int p = 0; p < 60; p++) {
                double from[3], way[3], high[3];
                for (int axis = 0; axis < 3; axis++) {
                    from[axis] = (axis < 2 ? shifts_m[j] : 0) + between(-4, 10);
                    way[axis] = p % 4 == 3 && axis != p % 3 ? 0 : between(-1, 1); /* some rays run along an axis */
                    high[axis] = from[axis] + (p % 5 ? between(0, 4) : 0);        /* some boxes are points */
                }
                check_ray(&mesh, bvh, from, way, met);
                check_box(&mesh, bvh, from, high, p % 3 ? 0 : between(0, 1));
            }
            bvh_destroy(&bvh);
            trimesh_finish(&mesh);
        }
    assert_true(met[0] > 100000 && met[1] > 1000);
}

/* Meshes whose number of triangles exactly fills the tree's nodes, or is one less or more, also far from the origin, where
   floats are coarse. Points are far away, on corners and in planes of triangles. */
TEST(test_finds_the_nearest)
{
    static const size_t counts[] = { 0, 1, 7, 8, 9, 63, 64, 65, 512, 513, 3000 };
    static const double shifts_m[] = { 0, 3e4 };
    for (size_t i = 0; i < sizeof(counts) / sizeof(*counts); i++)
        for (size_t j = 0; j < 2; j++) {
            struct trimesh mesh;
            make_mesh(&mesh, counts[i], shifts_m[j]);
            struct bvh *bvh = bvh_create(&mesh);
            for (int p = 0; p < POINTS; p++) {
                double reach = p % 5 == 0 ? 1e5 : 12, point[3];
                const uint32_t third = (uint32_t)p % 3;
                for (int axis = 0; axis < 3; axis++)
                    point[axis] = (axis < 2 ? shifts_m[j] : 0) + between(-reach, reach);
                if (p % 4 == 1)
                    point[p % 3] = round(point[p % 3]);
                if (p % 4 == 2)
                    memcpy(point, mesh.points[(size_t)p % mesh.point_count], sizeof(point));
                check_point(&mesh, bvh, point, NULL);
                check_point(&mesh, bvh, point, &third);
            }
            bvh_destroy(&bvh);
            trimesh_finish(&mesh);
        }
}

struct labelled {
    const uint32_t *label;
    uint32_t skipped;
};

static bool is_other(const void *arg, uint32_t tri)
{
    const struct labelled *l = arg;
    return l->label[tri] != l->skipped;
}

/* A search that skips a label (a number per triangle) must find the same triangle as a search with an equivalent predicate.
   Labels depend on the position, so that all triangles of some nodes have the same label. */
TEST(test_skipping_a_label_finds_what_a_predicate_finds)
{
    uint32_t label[3000];
    struct trimesh mesh;
    make_mesh(&mesh, 3000, 0);
    struct bvh *bvh = bvh_create(&mesh);
    for (size_t t = 0; t < mesh.tri_count; t++)
        label[t] = (uint32_t)(mesh.points[mesh.tris[t][0]][0] + 4) / 4;
    bvh_set_labels(bvh, label);
    for (int p = 0; p < POINTS; p++) {
        const struct labelled l = { label, (uint32_t)p % 4 };
        const double point[3] = { between(-4, 10), between(-4, 10), between(-4, 10) }, limit_m = p % 3 ? INFINITY : between(0, 3);
        struct bvh_place at, slow;
        bvh_nearest_unlike(bvh, point, limit_m, l.skipped, p % 2 ? of_third : NULL, &(uint32_t){ 1 }, &at);
        if (p % 2 == 0) {
            bvh_nearest(bvh, point, limit_m, is_other, &l, &slow);
            assert_int_equal(at.tri, slow.tri);
            assert_true(at.distance_m == slow.distance_m);
        }
        assert_true(at.tri == TRIMESH_NONE || is_other(&l, at.tri));
    }
    bvh_destroy(&bvh);
    trimesh_finish(&mesh);
}

/* Points on a lattice and above it have exactly the same distance from several triangles: the one with the lowest number must
   be found. */
TEST(test_equally_near_ones_go_by_number)
{
    struct trimesh mesh;
    make_mesh(&mesh, 3000, 0);
    struct bvh *bvh = bvh_create(&mesh);
    for (int p = 0; p < 216; p++)
        for (int raised = 0; raised < 2; raised++) {
            const double point[3] = { p % 6, p / 6 % 6, p / 36 + 3 * raised };
            const uint32_t third = (uint32_t)(p / 2) % 2;
            struct bvh_place place;
            double distance_m;
            uint32_t tri = find_slowly(&mesh, point, &third, &distance_m);
            bvh_nearest(bvh, point, INFINITY, of_third, &third, &place);
            assert_int_equal(place.tri, tri);
            assert_true(place.distance_m == distance_m);
        }
    bvh_destroy(&bvh);
    trimesh_finish(&mesh);
}

/* Random segments in a triangle's plane, parallel to one of its sides and outside it. Computed exactly, they never cross the triangle,
   but rounding moves them to either side. */
TEST(test_a_parallel_segment_crosses_nothing)
{
    size_t crossed = 0;
    for (int n = 0; n < 100000; n++) {
        double corners[3][3], p[3], q[3], place[3], weights[3], t;
        for (int i = 0; i < 9; i++)
            corners[i / 3][i % 3] = between(-1, 1);
        vec_mix(corners[0], corners[1], between(-0.5, 0.5), p);
        vec_mix(corners[0], corners[1], between(0.5, 1.5), q);
        vec_mix(corners[0], corners[2], -0.2, place);
        for (int axis = 0; axis < 3; axis++) {
            p[axis] += place[axis] - corners[0][axis];
            q[axis] += place[axis] - corners[0][axis];
        }
        crossed += triangle_crossed(p, q, corners[0], corners[1], corners[2], &t, weights);
    }
    assert_int_equal(crossed, 0);
}

TEST_GROUP(surface_case_set_up, surface_case_tear_down)

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Simplification by edge collapses with a bound on the error: few triangles remain, none deviates by more than the bound, and
   borders and seams stay in place. */
#include "tests/support/test.h"

#include "preprocess/levels/levels_bounded.h"
#include "tests/support/geometry_case.h"

#define ROUND 96u /* corners of a circle */

struct bounded_shape { /* a mesh to be simplified, of one part whose triangles have one or two materials */
    struct geometry g;
    struct welds welds;
    struct trimesh mesh;
    struct bvh *bvh;
    uint32_t *corners;
    struct bounded *bounded;
};

static uint32_t add_vertex(struct bounded_shape *s, double x, double y, double z)
{
    float *at = s->g.positions_m[s->g.vertex_count];
    at[0] = (float)x;
    at[1] = (float)y;
    at[2] = (float)z;
    s->g.normals[s->g.vertex_count][2] = 1;
    return s->g.vertex_count++;
}

static void add_triangle(struct bounded_shape *s, uint32_t a, uint32_t b, uint32_t c)
{
    const uint32_t v[3] = { a, b, c };
    memcpy(s->g.indices + s->g.index_count, v, sizeof(v));
    s->g.index_count += 3;
    s->g.primitives[s->g.primitive_count - 1].index_count += 3;
}

static void begin_primitive(struct bounded_shape *s)
{
    s->g.primitives[s->g.primitive_count++] = (struct asset_primitive){ .first_index = s->g.index_count };
}

static void shape_begin(struct bounded_shape *s)
{
    const size_t most = 64 * (size_t)ROUND;
    *s = (struct bounded_shape){ 0 };
    geometry_begin(&s->g, most, 2 * most);
}

static void shape_end(struct bounded_shape *s)
{
    assert_true(welds_init(&s->welds, &s->g));
    assert_int_equal(s->welds.part_count, 1);
    s->corners = mem_array(s->g.index_count, sizeof(*s->corners));
    for (size_t k = 0; k < s->welds.count; k++) {
        const float *p = s->welds.positions_m[k];
        trimesh_add_point(&s->mesh, (const double[3]){ (double)p[0], (double)p[1], (double)p[2] });
    }
    for (uint32_t i = 0; i < s->g.index_count; i++)
        s->corners[i] = s->welds.of_vertex[s->g.indices[i]];
    for (uint32_t i = 0; i < s->g.index_count; i += 3)
        trimesh_add_tri(&s->mesh, s->corners[i], s->corners[i + 1], s->corners[i + 2], i / 3);
    s->bvh = bvh_create(&s->mesh);
    uint32_t *places = mem_array(s->welds.count, sizeof(*places));
    for (uint32_t k = 0; k < s->welds.count; k++)
        places[k] = k;
    s->bounded = bounded_create(&s->welds, s->corners, s->g.index_count, places, s->welds.count, s->bvh);
    mem_free(places);
}

static void shape_finish(struct bounded_shape *s)
{
    bounded_destroy(&s->bounded);
    bvh_destroy(&s->bvh);
    trimesh_finish(&s->mesh);
    welds_finish(&s->welds);
    geometry_finish(&s->g);
    mem_free(s->corners);
}

/* Returns the deviation by brute force: the larger of the largest distance from the model's vertices to the simplified mesh and
   the largest distance from the centres of its triangles to the model. */
static double stray(const struct bounded_shape *s)
{
    size_t count = bounded_count(s->bounded);
    uint32_t *left = mem_array(3 * count, sizeof(*left));
    struct trimesh mesh = { 0 };
    double most_m = 0;
    struct bvh_place place;
    bounded_read(s->bounded, left);
    for (size_t p = 0; p < s->mesh.point_count; p++)
        trimesh_add_point(&mesh, s->mesh.points[p]);
    for (size_t t = 0; t < count; t++)
        trimesh_add_tri(&mesh, left[3 * t], left[3 * t + 1], left[3 * t + 2], (uint32_t)t);
    struct bvh *bvh = bvh_create(&mesh);
    for (size_t p = 0; p < mesh.point_count; p++) {
        bvh_nearest(bvh, mesh.points[p], INFINITY, NULL, NULL, &place);
        most_m = fmax(most_m, place.distance_m);
    }
    for (size_t t = 0; t < count; t++) {
        double middle[3];
        for (int axis = 0; axis < 3; axis++)
            middle[axis] = (mesh.points[left[3 * t]][axis] + mesh.points[left[3 * t + 1]][axis] + mesh.points[left[3 * t + 2]][axis]) / 3;
        bvh_nearest(s->bvh, middle, INFINITY, NULL, NULL, &place);
        most_m = fmax(most_m, place.distance_m);
    }
    bvh_destroy(&bvh);
    trimesh_finish(&mesh);
    mem_free(left);
    return most_m;
}

static double angle_of(uint32_t i)
{
    return 2 * acos(-1) * i / ROUND;
}

/* A flat disc of radius 1 m. A polygon that deviates by at most half of the error has a known number n of corners, so about n -
   2 triangles must suffice. */
TEST(a_disc_takes_few_triangles)
{
    for (double error_m = 0.005; error_m < 0.2; error_m *= 2) {
        struct bounded_shape s;
        shape_begin(&s);
        uint32_t middle = add_vertex(&s, 0, 0, 0);
        for (uint32_t i = 0; i < ROUND; i++)
            add_vertex(&s, cos(angle_of(i)), sin(angle_of(i)), 0);
        for (uint32_t i = 0; i < ROUND; i++)
            add_triangle(&s, middle, middle + 1 + i, middle + 1 + (i + 1) % ROUND);
        shape_end(&s);
        bounded_simplify(s.bounded, error_m);
        double corners = acos(-1) / acos(1 - error_m / 2), found_m = stray(&s);
        print_message("# %.3f m: %zu triangles, %.1f at least; %.4f m off\n", error_m, bounded_count(s.bounded), corners - 2, found_m);
        assert_true((double)bounded_count(s.bounded) <= 2.1 * corners);
        assert_true(found_m <= 0.5 * error_m + 1e-6);
        shape_finish(&s);
    }
}

/* A bent tube with open ends is simplified with larger and larger errors. No result may have more triangles than the one
   before, and each must keep its error. */
TEST(errors_grow_with_what_is_asked)
{
    struct bounded_shape s;
    size_t before = SIZE_MAX;
    shape_begin(&s);
    for (uint32_t r = 0; r < 40; r++)
        for (uint32_t i = 0; i < 24; i++) {
            double turn = acos(-1) / 2 * r / 39, out = 2 + 0.5 * cos(angle_of(4 * i));
            add_vertex(&s, out * cos(turn), out * sin(turn), 0.5 * sin(angle_of(4 * i)));
        }
    for (uint32_t r = 0; r + 1 < 40; r++)
        for (uint32_t i = 0; i < 24; i++) {
            uint32_t a = 24 * r + i, b = 24 * r + (i + 1) % 24;
            add_triangle(&s, a, a + 24, b + 24);
            add_triangle(&s, a, b + 24, b);
        }
    shape_end(&s);
    for (double error_m = 0.01; error_m < 0.3; error_m *= 1.5) {
        bounded_simplify(s.bounded, error_m);
        double found_m = stray(&s);
        print_message("# %.3f m: %zu triangles, %.4f m off\n", error_m, bounded_count(s.bounded), found_m);
        assert_true(bounded_count(s.bounded) <= before);
        assert_true(found_m <= 1.02 * error_m);
        before = bounded_count(s.bounded);
    }
    assert_true(before <= 40);
    shape_finish(&s);
}

/* Returns the number of edges that belong to one triangle only. */
static size_t count_open(const struct bounded_shape *s)
{
    size_t count = 3 * bounded_count(s->bounded), open = 0;
    uint32_t *left = mem_array(count, sizeof(*left));
    bounded_read(s->bounded, left);
    for (size_t i = 0; i < count; i++) {
        uint32_t a = left[i], b = left[i % 3 == 2 ? i - 2 : i + 1];
        int along = 0, against = 0;
        for (size_t k = 0; k < count; k++) {
            uint32_t c = left[k], d = left[k % 3 == 2 ? k - 2 : k + 1];
            along += a == c && b == d;
            against += a == d && b == c;
        }
        open += along != 1 || against != 1;
    }
    mem_free(left);
    return open;
}

/* Tori whose tubes have 5 to 12 corners must stay closed, and no edge may get four triangles, even if the allowed error exceeds
   the tube's thickness. */
TEST(what_is_closed_stays_so)
{
    for (uint32_t around = 5; around <= 12; around++) {
        struct bounded_shape s;
        shape_begin(&s);
        for (uint32_t r = 0; r < ROUND; r++)
            for (uint32_t i = 0; i < around; i++) {
                double turn = 2 * acos(-1) * i / around, out = 2 + 0.5 * cos(turn);
                add_vertex(&s, out * cos(angle_of(r)), out * sin(angle_of(r)), 0.5 * sin(turn));
            }
        for (uint32_t r = 0; r < ROUND; r++)
            for (uint32_t i = 0; i < around; i++) {
                uint32_t next = (r + 1) % ROUND, a = around * r + i, b = around * r + (i + 1) % around;
                uint32_t c = around * next + i, d = around * next + (i + 1) % around;
                add_triangle(&s, a, c, d);
                add_triangle(&s, a, d, b);
            }
        shape_end(&s);
        for (double error_m = 0.1; error_m < 1.5; error_m *= 1.3) {
            bounded_simplify(s.bounded, error_m);
            size_t open = count_open(&s);
            if (open)
                print_message("# %u around, %.3f m: %zu open of %zu triangles\n", around, error_m, open, bounded_count(s.bounded));
            assert_int_equal(open, 0);
        }
        shape_finish(&s);
    }
}

/* A plate on which two materials meet along a wavy line. The line may move by at most half of the error, and no triangle may
   cover both materials. */
TEST(seams_stay)
{
    struct bounded_shape s;
    const double error_m = 0.05;
    shape_begin(&s);
    for (uint32_t side = 0; side < 2; side++) {
        uint32_t first = s.g.vertex_count;
        if (side == 1)
            begin_primitive(&s);
        for (uint32_t i = 0; i <= ROUND; i++)
            for (uint32_t k = 0; k < 4; k++) {
                double x = 4.0 * i / ROUND, wave = 0.2 * sin(angle_of(2 * i));
                add_vertex(&s, x, side == 0 ? wave - (3 - k) / 3.0 * (1 + wave) : wave + k / 3.0 * (1 - wave), 0);
            }
        for (uint32_t i = 0; i < ROUND; i++)
            for (uint32_t k = 0; k < 3; k++) {
                uint32_t a = first + 4 * i + k;
                add_triangle(&s, a, a + 4, a + 5);
                add_triangle(&s, a, a + 5, a + 1);
            }
    }
    shape_end(&s);
    bounded_simplify(s.bounded, error_m);
    size_t count = bounded_count(s.bounded);
    uint32_t *left = test_memory(mem_array(3 * count, sizeof(*left)));
    bounded_read(s.bounded, left);
    print_message("# %zu of %u triangles\n", count, s.g.index_count / 3);
    assert_true(count * 10 < s.g.index_count / 3);
    for (size_t t = 0; t < count; t++) {
        const uint32_t *v = left + 3 * t;
        uint32_t primitive = s.welds.primitive[v[0]];
        assert_true(primitive == s.welds.primitive[v[1]] && primitive == s.welds.primitive[v[2]]);
        /* tests 20 points along each edge: each must lie on its material's side of the wavy line, within the allowed deviation
           */
        for (uint32_t k = 0; k <= 20; k++) {
            for (int e = 0; e < 3; e++) {
                const float *a = s.welds.positions_m[v[e]], *b = s.welds.positions_m[v[(e + 1) % 3]];
                double x = (double)a[0] + k / 20.0 * ((double)b[0] - (double)a[0]),
                       y = (double)a[1] + k / 20.0 * ((double)b[1] - (double)a[1]);
                double wave = 0.2 * sin(acos(-1) * x);
                assert_true(primitive == 0 ? y <= wave + 0.6 * error_m : y >= wave - 0.6 * error_m);
            }
        }
    }
    shape_finish(&s);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Merging points at short sides of needles: which are merged, and how far the surface moves. */
#include "surface/mesh/short_sides.h"

#include "base/math/vec.h"
#include "tests/support/test.h"

enum { MOST_TRIS = 2 * 4800 };

struct ring {
    struct trimesh mesh;
    uint32_t plane[MOST_TRIS];
};

/* Makes a band of needles between two circles of `around` points: a plate with a round hole (rise_m 0), or a cone or tube. */
static void make_ring(struct ring *ring, uint32_t around, double outer_m, double rise_m)
{
    for (uint32_t i = 0; i < 2 * around; i++) {
        const double angle = 2 * M_PI * (i / 2) / around, radius_m = i % 2 ? outer_m : 1;
        trimesh_add_point(&ring->mesh, (const double[3]){ radius_m * cos(angle), radius_m * sin(angle), i % 2 ? rise_m : 0 });
    }
    for (uint32_t i = 0; i < 2 * around; i += 2) {
        const uint32_t next = (i + 2) % (2 * around);
        trimesh_add_tri(&ring->mesh, i, i + 1, next + 1, i);
        trimesh_add_tri(&ring->mesh, i, next + 1, next, i + 1);
        ring->plane[i] = i;
        ring->plane[i + 1] = i + 1;
    }
}

static size_t merged(struct ring *ring, uint32_t around, double outer_m, double rise_m)
{
    *ring = (struct ring){ 0 };
    make_ring(ring, around, outer_m, rise_m);
    return short_sides_merge(&ring->mesh, 10, 1, ring->plane);
}

/* Returns the largest distance of the middle of a border edge from the circles. Asserts that the mesh stays one closed band. */
static double sag_of(const struct ring *ring, double outer_m, double rise_m)
{
    double most_m = 0;
    size_t borders = 0;
    struct edge_table edges;
    edge_table_init(&edges, 16);
    unsigned char *faces = mem_array(3 * ring->mesh.tri_count, 1);
    for (int pass = 0; pass < 2; pass++)
        for (size_t t = 0; t < ring->mesh.tri_count; t++)
            for (int i = 0; i < 3; i++) {
                const uint32_t a = ring->mesh.tris[t][i], b = ring->mesh.tris[t][(i + 1) % 3], e = edge_table_add(&edges, a, b);
                double middle[3];
                if (pass == 0)
                    faces[e]++;
                assert_true(faces[e] <= 2);
                if (pass == 0 || faces[e] != 1)
                    continue;
                vec_mix(ring->mesh.points[a], ring->mesh.points[b], 0.5, middle);
                const double radius_m = a % 2 ? outer_m : 1;
                assert_true(a % 2 == b % 2);
                most_m = fmax(most_m, hypot(hypot(middle[0], middle[1]) - radius_m, middle[2] - (a % 2 ? rise_m : 0)));
                borders++;
            }
    /* a band between two circles has as many border edges as triangles */
    assert_int_equal(borders, ring->mesh.tri_count);
    edge_table_finish(&edges);
    mem_free(faces);
    return most_m;
}

TEST(fine_circles_become_coarser_within_the_tolerance)
{
    static const double shapes[][2] = { { 4, 0 }, { 2, 3 }, { 1, 6 } }; /* plate, cone, tube: outer radius and height, metres */
    static struct ring ring;
    for (size_t i = 0; i < sizeof(shapes) / sizeof(*shapes); i++) {
        const size_t count = merged(&ring, 4800, shapes[i][0], shapes[i][1]);
        print_message("# 4800 needles: %zu of 9600 points merged, %.2g m off\n", count, sag_of(&ring, shapes[i][0], shapes[i][1]));
        assert_true(count > 7000 && count < 9600 - 300);
        assert_true(sag_of(&ring, shapes[i][0], shapes[i][1]) <= 10 * SHORT_SIDES_WITHIN);
        /* model triangles that lost their pieces belong to a plane with pieces */
        static char has_pieces[MOST_TRIS];
        memset(has_pieces, 0, sizeof(has_pieces));
        for (size_t t = 0; t < ring.mesh.tri_count; t++)
            has_pieces[trimesh_root(ring.plane, ring.mesh.tri_source[t])] = 1;
        for (uint32_t s = 0; s < 2 * 4800; s++)
            assert_true(has_pieces[trimesh_root(ring.plane, s)]);
        trimesh_finish(&ring.mesh);
    }
}

/* The polygon of a coarse circle is the model's shape. */
TEST(coarse_circles_stay)
{
    static struct ring ring;
    for (uint32_t around = 12; around <= 300; around *= 2) {
        assert_int_equal(merged(&ring, around, 4, 0), 0);
        assert_int_equal(ring.mesh.tri_count, 2 * around);
        trimesh_finish(&ring.mesh);
    }
}

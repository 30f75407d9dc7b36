/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decimation of flat regions: the shape, the hidden parts and the borders between parts must stay. */
#include "surface/mesh/decimate.h"

#include "tests/support/test.h"

#include "tests/support/surface_case.h"

#define ADDED 300
#define WITHIN_M 1e-7
#define MOST_TRIS (4 * ADDED + 8)
/* points that decimation may leave behind: it must remove at least half of the added ones, not all, because many triangles are
   so thin that no neighbour can absorb them */
#define MOST_LEFT (ADDED / 2)

/* A plate of two triangles that share the diagonal from (0, 0, 0) to (1, 1, 0). Their third corners are (1, 0, 0) and (0, 1,
   lift_m), which bends the plate if lift_m is not 0. */
struct flat_plate {
    struct trimesh mesh;
    uint32_t part[MOST_TRIS], plane[2];
    char hidden[MOST_TRIS], keep[ADDED + 8];
    uint32_t target[ADDED + 8];
};

static void plate_init(struct flat_plate *plate, double lift_m)
{
    const double corners[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, lift_m } };
    memset(plate, 0, sizeof(*plate));
    for (int i = 0; i < 4; i++) {
        trimesh_add_point(&plate->mesh, corners[i]);
        plate->keep[i] = 1;
    }
    trimesh_add_tri(&plate->mesh, 0, 1, 2, 0);
    trimesh_add_tri(&plate->mesh, 0, 2, 3, 1);
}

static void set_corner(struct flat_plate *plate, size_t tri, int corner, uint32_t point)
{
    plate->mesh.tris[tri][corner] = point;
}

/* Adds a triangle like number `of`, but with the vertex `point` as its corner number `corner`. */
static void add_piece(struct flat_plate *plate, size_t of, int corner, uint32_t point)
{
    struct trimesh *mesh = &plate->mesh;
    const uint32_t v[3] = { mesh->tris[of][0], mesh->tris[of][1], mesh->tris[of][2] };
    trimesh_add_tri(mesh, v[0], v[1], v[2], mesh->tri_source[of]);
    set_corner(plate, mesh->tri_count - 1, corner, point);
}

static void put_inside(struct flat_plate *plate, size_t tri)
{
    struct trimesh *mesh = &plate->mesh;
    double weights[3], sum = 0, at[3] = { 0 };
    for (int c = 0; c < 3; c++)
        sum += weights[c] = between(0.1, 1);
    for (int c = 0; c < 3; c++)
        for (int axis = 0; axis < 3; axis++)
            at[axis] += weights[c] / sum * mesh->points[mesh->tris[tri][c]][axis];
    uint32_t point = trimesh_add_point(mesh, at);
    add_piece(plate, tri, 0, point);
    add_piece(plate, tri, 1, point);
    set_corner(plate, tri, 2, point);
}

/* Inserts a new point on the edge a-b, into all triangles that have this edge. */
static void put_on_edge(struct flat_plate *plate, uint32_t a, uint32_t b)
{
    struct trimesh *mesh = &plate->mesh;
    double share = between(0.2, 0.8), at[3];
    for (int axis = 0; axis < 3; axis++)
        at[axis] = mesh->points[a][axis] + share * (mesh->points[b][axis] - mesh->points[a][axis]);
    uint32_t point = trimesh_add_point(mesh, at);
    for (size_t t = 0, count = mesh->tri_count; t < count; t++)
        for (int c = 0; c < 3; c++) {
            int next = (c + 1) % 3;
            const uint32_t *v = mesh->tris[t];
            if ((v[c] != a || v[next] != b) && (v[c] != b || v[next] != a))
                continue;
            add_piece(plate, t, c, point);
            set_corner(plate, t, next, point);
            break;
        }
}

static void cut_up(struct flat_plate *plate)
{
    for (int i = 0; i < ADDED; i++) {
        size_t tri = (size_t)between(0, (double)plate->mesh.tri_count - 0.5);
        int c = (int)between(0, 2.9);
        if (i % 2)
            put_inside(plate, tri);
        else
            put_on_edge(plate, plate->mesh.tris[tri][c], plate->mesh.tris[tri][(c + 1) % 3]);
    }
}

static void thin(struct flat_plate *plate)
{
    plate->plane[1] = 1;
    decimate_mesh(&plate->mesh, plate->hidden,
                  &(struct decimate_params){ .part = plate->part, .keep = plate->keep, .within_m = WITHIN_M, .longest_m = 10 },
                  plate->plane, 2, plate->target);
}

/* Returns the total area of the triangles on one side of the plate's diagonal. Asserts that each faces along `normal`. */
static double area_of(const struct flat_plate *plate, int side, const double normal[3])
{
    double sum = 0;
    for (size_t t = 0; t < plate->mesh.tri_count; t++) {
        const uint32_t *v = plate->mesh.tris[t];
        const double(*p)[3] = (const double(*)[3])plate->mesh.points;
        double ab[3], ac[3], beside = 0, area2 = 0;
        for (int axis = 0; axis < 3; axis++) {
            ab[axis] = p[v[1]][axis] - p[v[0]][axis];
            ac[axis] = p[v[2]][axis] - p[v[0]][axis];
        }
        for (int c = 0; c < 3; c++)
            beside += p[v[c]][1] - p[v[c]][0];
        if ((beside > 0) != (side == 1))
            continue;
        for (int axis = 0; axis < 3; axis++)
            area2 += normal[axis] * (ab[(axis + 1) % 3] * ac[(axis + 2) % 3] - ab[(axis + 2) % 3] * ac[(axis + 1) % 3]);
        assert_true(area2 > 0);
        sum += area2 / 2;
    }
    return sum;
}

static void same_areas(const struct flat_plate *plate, double lift_m)
{
    const double length = sqrt(1 + 2 * lift_m * lift_m), across[3] = { lift_m / length, -lift_m / length, 1 / length };
    assert_float_equal(area_of(plate, 0, (const double[3]){ 0, 0, 1 }), 0.5, 1e-6);
    assert_float_equal(area_of(plate, 1, across), 0.5 * length, 1e-6);
}

TEST(a_flat_plate_has_its_corners_left)
{
    struct flat_plate plate;
    plate_init(&plate, 0);
    cut_up(&plate);
    assert_int_equal(plate.mesh.point_count, ADDED + 4);
    thin(&plate);
    assert_in_range(plate.mesh.point_count, 4, 4 + MOST_LEFT);
    for (uint32_t p = 0; p < 4; p++)
        assert_int_equal(plate.target[p], p);
    for (uint32_t p = 4; p < ADDED + 4; p++)
        assert_true(plate.target[p] == TRIMESH_NONE || plate.target[p] < plate.mesh.point_count);
    double normal[3] = { 0, 0, 1 };
    assert_float_equal(area_of(&plate, 0, normal) + area_of(&plate, 1, normal), 1, 1e-6);
    trimesh_finish(&plate.mesh);
}

TEST(triangles_of_the_model_that_share_pieces_are_one_plane)
{
    struct flat_plate plate;
    plate_init(&plate, 0);
    put_on_edge(&plate, 0, 2);
    put_on_edge(&plate, 1, 4);
    thin(&plate);
    assert_int_equal(plate.mesh.point_count, 4);
    assert_int_equal(plate.mesh.tri_count, 2);
    assert_int_equal(plate.plane[0], 0);
    assert_int_equal(plate.plane[1], 0);
    trimesh_finish(&plate.mesh);
}

TEST(a_fold_stays_where_it_is)
{
    struct flat_plate plate;
    plate_init(&plate, 0.3);
    put_on_edge(&plate, 0, 2);
    cut_up(&plate);
    thin(&plate);
    assert_in_range(plate.mesh.point_count, 4, 4 + MOST_LEFT);
    same_areas(&plate, 0.3);
    assert_int_equal(plate.plane[0], 0);
    assert_int_equal(plate.plane[1], 1);
    trimesh_finish(&plate.mesh);
}

/* Within a plane, decimation must not move the border between two parts, nor that between visible and hidden triangles. */
TEST(a_border_stays_where_it_is)
{
    for (int hides = 0; hides < 2; hides++) {
        struct flat_plate plate;
        plate_init(&plate, 0);
        put_on_edge(&plate, 0, 2);
        cut_up(&plate);
        for (size_t t = 0; t < plate.mesh.tri_count; t++) {
            plate.part[t] = hides ? 0 : plate.mesh.tri_source[t];
            plate.hidden[t] = (char)(hides && plate.mesh.tri_source[t]);
        }
        thin(&plate);
        assert_in_range(plate.mesh.point_count, 4, 4 + MOST_LEFT);
        same_areas(&plate, 0);
        double hidden = 0;
        for (size_t t = 0; t < plate.mesh.tri_count; t++) {
            const uint32_t *v = plate.mesh.tris[t];
            double beside = 0;
            for (int c = 0; c < 3; c++)
                beside += plate.mesh.points[v[c]][1] - plate.mesh.points[v[c]][0];
            assert_int_equal(plate.mesh.tri_source[t], beside > 0);
            hidden += plate.hidden[t];
            assert_int_equal(plate.hidden[t], hides && beside > 0);
        }
        assert_int_equal(hidden > 0, hides);
        trimesh_finish(&plate.mesh);
    }
}

TEST(what_is_not_flat_stays)
{
    struct flat_plate plate;
    plate_init(&plate, 0);
    put_inside(&plate, 0);
    plate.mesh.points[4][2] = 1e-3;
    put_on_edge(&plate, 0, 1); /* adds a point on the plate's rim and moves it off the straight rim: decimation must keep that point */
    plate.mesh.points[5][1] = -1e-3;
    thin(&plate);
    assert_int_equal(plate.mesh.point_count, 6);
    trimesh_finish(&plate.mesh);
}

TEST_GROUP(surface_case_set_up, surface_case_tear_down)

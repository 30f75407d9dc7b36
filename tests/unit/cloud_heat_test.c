/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Distances along a surface, computed by the heat method on a point cloud, compared with formulas for spheres, tubes and
   plates. The tests also print and limit the method's errors. */
#include "tests/support/test.h"

#include "preprocess/influence/cloud_heat.h"
#include "tests/support/cad.h"
#include "tests/support/surface_case.h"

struct made {
    struct cad cad;
    struct surface *surface;
    struct cloud_heat *cloud;
    float *along_m;
};

static void make(struct made *made, const double source_m[3])
{
    struct cad *cad = &made->cad;
    made->surface = surface_of(cad);
    made->cloud = cloud_heat_create(the_log, made->surface);
    assert_non_null(made->cloud);
    made->along_m = mem_array(cad->vertex_count, sizeof(*made->along_m));
    assert_true(cloud_heat_distances(made->cloud, source_m, (const float(*)[3])cad->positions, cad->vertex_count, made->along_m));
}

static void finish(struct made *made)
{
    cloud_heat_destroy(&made->cloud);
    cad_finish(&made->cad);
    mem_free(made->along_m);
}

/* Compares the computed distances with the exact ones (`truth`). mean, worst: allowed mean and largest error, as shares of the
   largest distance. */
static void expect_errors(const struct made *made, const char *what, const double *truth, double mean, double worst)
{
    double sum = 0, most = 0, largest_m = 0;
    for (size_t v = 0; v < made->cad.vertex_count; v++) {
        double error_m = fabs((double)made->along_m[v] - truth[v]);
        sum += error_m;
        most = fmax(most, error_m);
        largest_m = fmax(largest_m, truth[v]);
    }
    sum /= (double)made->cad.vertex_count;
    printf("# %s: %zu points, k %d: mean error %.3f %%, worst %.3f %% (may be %.3f, %.3f)\n", what, cloud_heat_count(made->cloud),
           cloud_heat_k(made->cloud), 100 * sum / largest_m, 100 * most / largest_m, 100 * mean, 100 * worst);
    assert_true(sum <= mean * largest_m && most <= worst * largest_m);
}

TEST(test_sphere)
{
    struct made made = { 0 };
    cad_sphere(&made.cad, &chance, 24);
    make(&made, (const double[3]){ 0, 0, 1 });
    double *truth = test_memory(mem_array(made.cad.vertex_count, sizeof(*truth)));
    for (size_t v = 0; v < made.cad.vertex_count; v++)
        truth[v] = acos(fmax(-1, fmin(1, (double)made.cad.positions[v][2])));
    expect_errors(&made, "sphere", truth, 0.008, 0.02);
    assert_in_range(cloud_heat_count(made.cloud), 15000, 60000);
    finish(&made);
}

TEST(test_tube)
{
    struct made made = { 0 };
    cad_cylinder(&made.cad, &chance, 64, 40, 4, 0);
    const float *at = made.cad.positions[0];
    const double source_m[3] = { (double)at[0], (double)at[1], (double)at[2] };
    make(&made, source_m);
    int axis = 0; /* index of the coordinate axis along which the tube lies: that of the largest extent */
    double spread[3] = { 0 };
    for (size_t v = 0; v < made.cad.vertex_count; v++)
        for (int k = 0; k < 3; k++)
            spread[k] = fmax(spread[k], fabs((double)made.cad.positions[v][k] - source_m[k]));
    for (int k = 0; k < 3; k++)
        axis = spread[k] > spread[axis] ? k : axis;
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    double *truth = test_memory(mem_array(made.cad.vertex_count, sizeof(*truth)));
    for (size_t v = 0; v < made.cad.vertex_count; v++) {
        const float *p = made.cad.positions[v];
        double turn = fabs(remainder(atan2((double)p[b], (double)p[a]) - atan2(source_m[b], source_m[a]), 2 * M_PI));
        truth[v] = hypot(turn, (double)p[axis] - source_m[axis]);
    }
    expect_errors(&made, "open tube", truth, 0.006, 0.04);
    finish(&made);
}

/* Adds a square plate at height z_m that does not touch the other plate. If the gap is smaller than the cloud resolves, the
   point cloud lets heat pass between the plates, while distances along the mesh do not. */
static void add_plate(struct cad *cad, double z_m)
{
    uint32_t first = (uint32_t)cad->vertex_count;
    size_t corner = cad->triangle_count * 3;
    mem_grow(&cad->positions, &cad->position_capacity, cad->vertex_count + 4, sizeof(*cad->positions));
    mem_grow(&cad->triangles, &cad->index_capacity, corner + 6, sizeof(*cad->triangles));
    for (int i = 0; i < 4; i++) {
        cad->positions[cad->vertex_count][0] = (float)(i % 2);
        cad->positions[cad->vertex_count][1] = (float)(i / 2);
        cad->positions[cad->vertex_count++][2] = (float)z_m;
    }
    const uint32_t corners[6] = { 0, 1, 2, 1, 3, 2 };
    for (int i = 0; i < 6; i++)
        cad->triangles[corner + (size_t)i] = first + corners[i];
    cad->triangle_count += 2;
}

TEST(test_reaches_through_what_is_thin)
{
    for (int thin = 0; thin < 2; thin++) {
        struct made made = { 0 };
        float along_m[8];
        double gap_m = thin ? 0.004 : 0.1;
        add_plate(&made.cad, 0);
        add_plate(&made.cad, gap_m);
        make(&made, (const double[3]){ 0, 0, 0 });
        /* distance between opposite corners of the plate on which the source lies */
        assert_true(fabs((double)made.along_m[3] - sqrt(2)) < 0.03);
        /* the distance to the other plate must be infinite, unless the gap is too narrow for the cloud */
        assert_int_equal(isinf((double)made.along_m[7]) != 0, !thin);
        assert_true(surface_distances(made.surface, (const double(*)[3])(double[3]){ 0, 0, 0 }, 1, along_m));
        assert_true(isinf((double)along_m[7]) || gap_m < surface_report(made.surface)->tolerance_m);
        finish(&made);
    }
}

/* A ribbon of 120 m length, folded back and forth. The distance along it is many times the size of its bounding box, and the
   heat must not vanish on such a long way. */
TEST(test_serpentine)
{
    struct made made = { 0 };
    const double leg_m = 1, gap_m = 0.2, long_m = 120;
    cad_plate(&made.cad, &chance, 1201, 3, long_m, 0.1, 0);
    double *truth = test_memory(mem_array(made.cad.vertex_count, sizeof(*truth)));
    for (size_t v = 0; v < made.cad.vertex_count; v++) {
        float *p = made.cad.positions[v];
        double along_m = (double)p[0], turn = floor(along_m / (leg_m + gap_m) + 1e-6), rest_m = along_m - turn * (leg_m + gap_m);
        double on_leg_m = fmin(fmax(rest_m, 0), leg_m);
        truth[v] = hypot(along_m, (double)p[1]);
        p[0] = (float)(fmod(turn, 2) > 0 ? leg_m - on_leg_m : on_leg_m);
        p[2] = (float)(turn * gap_m + fmax(rest_m - leg_m, 0));
    }
    make(&made, (const double[3]){ 0, 0, 0 });
    /* larger errors are allowed, because paths through the point cloud cut the corners at the ribbon's bends */
    expect_errors(&made, "serpentine", truth, 0.04, 0.08);
    finish(&made);
}

TEST_GROUP(surface_case_set_up, surface_case_tear_down)

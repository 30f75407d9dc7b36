/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is said of fields between the corners of drawn triangles holds at places by chance, for the readings that are worst there. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "base/mem.h"
#include "preprocess/influence/gaussian.h"
#include "preprocess/influence/influence_bend.h"
#include "tests/support/surface_case.h"

enum { SENSORS = 5, PLACES = 4000, MOST = 400000 };
static const double DISC_M = 0.1;
static const double places_m[SENSORS][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { -0.577, -0.577, 0.577 }, { 0.6, 0, -0.8 } };

struct drawn { /* coarse triangles, and places in them by chance */
    struct cad shape;
    float (*positions)[3]; /* vertices, then places */
    uint32_t tri[PLACES];
    double weights[PLACES][3];
};

static void draw(struct drawn *drawn)
{
    const size_t vertices = drawn->shape.vertex_count;
    drawn->positions = mem_array(vertices + PLACES, sizeof(*drawn->positions));
    memcpy(drawn->positions, drawn->shape.positions, vertices * sizeof(*drawn->positions));
    for (size_t i = 0; i < PLACES; i++) {
        double a = cad_random(&chance), b = cad_random(&chance);
        drawn->tri[i] = (uint32_t)(cad_random(&chance) * (double)drawn->shape.triangle_count) % (uint32_t)drawn->shape.triangle_count;
        a = a + b > 1 ? 1 - a : a, b = a + b > 1 ? 1 - b : b;
        const double w[3] = { 1 - a - b, a, b };
        for (int k = 0; k < 3; k++)
            drawn->weights[i][k] = fmax(w[k], 0);
        for (int axis = 0; axis < 3; axis++) {
            double at = 0;
            for (int k = 0; k < 3; k++)
                at += drawn->weights[i][k] * (double)drawn->shape.positions[drawn->shape.triangles[3 * drawn->tri[i] + k]][axis];
            drawn->positions[vertices + i][axis] = (float)at;
        }
    }
}

/* Of MAX - MIN: readings that are MAX where that makes it worse, and MIN elsewhere; then the other way round. */
static double worst_at(const struct drawn *drawn, const struct influence *influence, size_t place, double around)
{
    double plus = 0, minus = 0;
    for (size_t s = 0; s < influence->count; s++) {
        const float *share = influence->shares + s * influence->vertex_count;
        double differs = (double)share[drawn->shape.vertex_count + place];
        for (int k = 0; k < 3; k++)
            differs -= drawn->weights[place][k] * (double)share[drawn->shape.triangles[3 * drawn->tri[place] + k]];
        plus += fmax(differs * (1 - around), differs * (0 - around));
        minus += fmin(differs * (1 - around), differs * (0 - around));
    }
    return 255 * fmax(plus, -minus);
}

typedef bool solve_fn(struct influence *influence, const struct influence_mesh *mesh, const struct influence_anchor *anchors, size_t count);

static bool solve_harmonic(struct influence *influence, const struct influence_mesh *mesh, const struct influence_anchor *anchors,
                           size_t count)
{
    return influence_conduct(influence, the_log, workers, mesh, (double)INFINITY, anchors, count);
}

static bool solve_fin(struct influence *influence, const struct influence_mesh *mesh, const struct influence_anchor *anchors, size_t count)
{
    return influence_conduct(influence, the_log, workers, mesh, 0.3, anchors, count);
}

static bool solve_gp(struct influence *influence, const struct influence_mesh *mesh, const struct influence_anchor *anchors, size_t count)
{
    return gaussian_solve(influence, the_log, workers, mesh, &(struct gaussian_params){ 0.8, 0.1, 5 }, anchors, count);
}

static void holds(solve_fn *solve, double around)
{
    struct drawn drawn = { 0 };
    struct influence_mesh mesh;
    struct influence_bend bend;
    struct influence ours = { 0 }, truth = { 0 }, plain = { 0 };
    struct bend_report report = { 0 };
    cad_sphere(&drawn.shape, &chance, 7);
    draw(&drawn);
    const size_t vertices = drawn.shape.vertex_count, triangles = drawn.shape.triangle_count;
    struct surface *surface = surface_create(the_log, workers, (const float(*)[3])drawn.shape.positions, vertices, drawn.shape.triangles,
                                             triangles, &(struct surface_params){ 0 });
    assert_true(surface && influence_mesh_init(&mesh, surface, places_m, SENSORS, DISC_M, 0.16));
    assert_true(influence_bend_init(&bend, &mesh, (const float(*)[3])drawn.shape.positions, vertices, drawn.shape.triangles, triangles,
                                    MOST));
    struct vertex_embedding *embedding = vertex_embedding_create(surface, (const float(*)[3])drawn.positions, NULL, vertices + PLACES,
                                                                 drawn.shape.triangles, triangles);
    size_t most = PLACES > bend.count ? PLACES : bend.count;
    struct influence_anchor *anchors = mem_array(vertices + most, sizeof(*anchors));
    influence_mesh_anchors(&mesh, embedding, vertices + PLACES, anchors);
    assert_true(solve(&truth, &mesh, anchors, vertices + PLACES));
    assert_true(solve(&plain, &mesh, anchors, vertices));
    memcpy(anchors + vertices, bend.anchors, bend.count * sizeof(*anchors));
    assert_true(solve(&ours, &mesh, anchors, vertices + bend.count));
    float *steps = mem_array(triangles, sizeof(*steps));
    influence_bend_measure(&bend, &ours, vertices, around, steps, &report);
    double worst = 0, nearest = 0;
    for (size_t i = 0; i < PLACES; i++) {
        double found = worst_at(&drawn, &truth, i, around), bound = (double)steps[drawn.tri[i]];
        worst = fmax(worst, found);
        nearest = fmax(nearest, bound > 0.01 ? found / bound : 0);
        if (found > bound + 0.02)
            fail_msg("a place is off by %.4f steps, and %.4f was said to be the most", found, bound);
    }
    print_message("said: %.3f steps; seen: %.3f; nearest to what was said of its triangle: %.3f; %zu places, %.2g unknown\n", report.steps,
                  worst, nearest, bend.count, report.unknown_share);
    assert_true(worst <= report.steps + 0.02 && nearest > 0.8 && worst > 1); /* it bends, and no more is said than need be */
    assert_true(report.measured == 1 && report.unmeasured == 0 && report.unknown_share == 0 && report.over_share > 0);
    influence_bend_remove(&bend, &ours, vertices);
    for (size_t i = 0; i < SENSORS * vertices; i++)
        assert_float_equal(ours.shares[i], plain.shares[i], 1e-6);
    mem_free(steps);
    mem_free(anchors);
    influence_finish(&ours);
    influence_finish(&truth);
    influence_finish(&plain);
    vertex_embedding_destroy(&embedding);
    influence_bend_finish(&bend);
    influence_mesh_finish(&mesh);
    surface_destroy(&surface);
    mem_free(drawn.positions);
    cad_finish(&drawn.shape);
}

static void test_harmonic(void **state)
{
    (void)state;
    holds(solve_harmonic, 0);
}

static void test_fin(void **state)
{
    (void)state;
    holds(solve_fin, 0.2);
}

static void test_gp(void **state)
{
    (void)state;
    holds(solve_gp, 0);
}

/* Triangles that lie elsewhere are not said to be good. */
static void test_what_is_not_on_the_surface_is_unknown(void **state)
{
    (void)state;
    struct cad shape = { 0 };
    struct influence_mesh mesh;
    struct influence_bend bend;
    cad_sphere(&shape, &chance, 5);
    struct surface *surface = surface_create(the_log, workers, (const float(*)[3])shape.positions, shape.vertex_count, shape.triangles,
                                             shape.triangle_count, &(struct surface_params){ 0 });
    assert_true(surface && influence_mesh_init(&mesh, surface, places_m, SENSORS, DISC_M, (double)INFINITY));
    for (int axis = 0; axis < 3; axis++)
        shape.positions[shape.triangles[0]][axis] *= 1.2f;
    assert_true(influence_bend_init(&bend, &mesh, (const float(*)[3])shape.positions, shape.vertex_count, shape.triangles,
                                    shape.triangle_count, MOST));
    size_t unknown = 0;
    for (size_t t = 0; t < shape.triangle_count; t++) {
        bool moved = false;
        for (int k = 0; k < 3; k++)
            moved |= shape.triangles[3 * t + k] == shape.triangles[0];
        unknown += bend.area_m2[t] < 0;
        assert_true(!moved || bend.area_m2[t] < 0);
    }
    assert_true(unknown > 0 && unknown < shape.triangle_count / 4);
    influence_bend_finish(&bend);
    assert_false(influence_bend_init(&bend, &mesh, (const float(*)[3])shape.positions, shape.vertex_count, shape.triangles,
                                     shape.triangle_count, 10));
    influence_bend_finish(&bend);
    influence_mesh_finish(&mesh);
    surface_destroy(&surface);
    cad_finish(&shape);
}

int main(void)
{
    cmocka_set_message_output(CM_OUTPUT_TAP);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_harmonic),
        cmocka_unit_test(test_fin),
        cmocka_unit_test(test_gp),
        cmocka_unit_test(test_what_is_not_on_the_surface_is_unknown),
    };
    return cmocka_run_group_tests(tests, surface_case_set_up, surface_case_tear_down);
}

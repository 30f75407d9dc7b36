/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Distances along surfaces, compared with an exact polyhedral solver on shapes that have no formula (surface_test.c has those
   with one). Each shape is tested clean and with every fault of CAD exports. The reference is the solver's result on the clean
   shape, or on the union of interpenetrating pipes. */
#include "surface/surface.h"

#include "tests/support/test.h"

#include "tests/oracle/geodesic.h"
#include "tests/support/surface_case.h"

#define MEAN_MAX 0.006 /* of the largest distance */
#define WORST_MAX 0.03
#define SOURCES 2

/* --- the truth ---------------------------------------------------------------------------------------------------------------- */

struct distance_truth {
    double sources[SOURCES][3];
    /* by source: exact distances to the vertices of the clean shape; NaN: the vertex is not on the outer surface */
    double *distances[SOURCES];
};

static struct oracle_mesh mesh_of(const struct cad *cad, size_t first_vertex, size_t vertex_count, size_t first_triangle,
                                  size_t triangle_count)
{
    return (struct oracle_mesh){ (const float(*)[3])cad->positions + first_vertex, cad->triangles + 3 * first_triangle, vertex_count,
                                 triangle_count };
}

/* Source 0 is a vertex, source 1 lies inside a triangle. PLANTCAST_LONG=1 tests both; the default run tests one of them,
   alternating by shape. */
static bool is_source_tried(int row, int source)
{
    return sweep_takes(row, source, SOURCES);
}

/* Returns the number of grid cells in each direction of a test shape: `whole` in a long run (PLANTCAST_LONG=1), otherwise half
   of it, which makes the exact solver five times faster. */
static int cells(int whole)
{
    return sweep(whole, whole / 2);
}

static void find_truth(struct distance_truth *truth, int row, const struct cad *clean, const struct oracle_mesh *outer)
{
    double *all = mem_array(outer->vertex_count, sizeof(*all));
    long *outer_of = mem_array(clean->vertex_count, sizeof(*outer_of));
    bool is_itself = (const float(*)[3])clean->positions == outer->positions;
    for (size_t v = 0; v < clean->vertex_count; v++)
        outer_of[v] = is_itself ? (long)v : oracle_vertex_at(outer, clean->positions[v]);
    for (int s = 0; s < SOURCES; s++) {
        size_t t = (size_t)(cad_random(&chance) * (double)outer->triangle_count);
        double w[3] = { 1, 0, 0 };
        if (s > 0) {
            w[0] = cad_random(&chance);
            w[1] = (1 - w[0]) * cad_random(&chance);
            w[2] = 1 - w[0] - w[1];
        }
        for (int axis = 0; axis < 3; axis++)
            for (size_t i = 0; i < 3; i++)
                truth->sources[s][axis] += w[i] * (double)outer->positions[outer->triangles[3 * t + i]][axis];
        if (!is_source_tried(row, s))
            continue;
        assert_true(oracle_distances(outer, t, w, all));
        truth->distances[s] = mem_array(clean->vertex_count, sizeof(double));
        for (size_t v = 0; v < clean->vertex_count; v++)
            truth->distances[s][v] = outer_of[v] < 0 ? (double)NAN : all[outer_of[v]];
    }
    mem_free(all);
    mem_free(outer_of);
}

/* --- scoring ------------------------------------------------------------------------------------------------------------------ */

static void score(const char *name, int fault, int source, const struct distance_truth *truth, const struct cad *clean,
                  const float *distances, const uint32_t *vertex_of, double scale)
{
    double mean = 0, worst = 0, largest = 0, count = 0;
    for (size_t v = 0; v < clean->vertex_count; v++) {
        double right = truth->distances[source][v];
        if (isnan(right))
            continue;
        double error = fabs((double)distances[vertex_of[v]] / scale - right);
        mean += error;
        count++;
        worst = fmax(worst, error);
        largest = fmax(largest, right);
    }
    mean /= count * largest;
    worst /= largest;
    print_message("# %-15s %-17s source %-9s mean %.3f %%  worst %.3f %%\n", name, cad_fault_names[fault],
                  source ? "in a face" : "at vertex", 100 * mean, 100 * worst);
    assert_true(mean <= MEAN_MAX);
    assert_true(worst <= WORST_MAX);
}

/* Tests the clean shape and each fault. The default run tests only one fault per shape, a different one for each shape. */
static void test_faults(const char *name, int row, const struct cad *clean, const struct oracle_mesh *outer)
{
    struct distance_truth truth = { 0 };
    struct cad_place place;
    double sources[SOURCES][3];
    uint32_t *vertex_of = mem_array(clean->vertex_count, sizeof(*vertex_of));
    assert_true(clean->vertex_count >= (size_t)sweep(20000, 5000));
    find_truth(&truth, row, clean, outer);
    cad_random_place(&place, &chance);
    for (int s = 0; s < SOURCES; s++)
        cad_put_point(&place, truth.sources[s], sources[s]);
    for (int fault = 0; fault < CAD_FAULTS; fault++) {
        if (fault != CAD_CLEAN && !sweep_takes(row, fault, 5))
            continue;
        struct cad broken;
        cad_break(&broken, clean, (enum cad_fault)fault, &chance, vertex_of);
        cad_put(&broken, &place);
        struct surface *surface = surface_of(&broken);
        float *distances = mem_array(SOURCES * broken.vertex_count, sizeof(*distances));
        assert_true(surface_distances(surface, (const double(*)[3])sources, SOURCES, distances));
        for (int s = 0; s < SOURCES; s++)
            if (is_source_tried(row, s))
                score(name, fault, s, &truth, clean, distances + (size_t)s * broken.vertex_count, vertex_of, place.scale);
        cad_finish(&broken);
        mem_free(distances);
    }
    for (int s = 0; s < SOURCES; s++)
        mem_free(truth.distances[s]);
    mem_free(vertex_of);
}

static void test_alone(const char *name, int row, struct cad *clean)
{
    struct oracle_mesh mesh = mesh_of(clean, 0, clean->vertex_count, 0, clean->triangle_count);
    test_faults(name, row, clean, &mesh);
    cad_finish(clean);
}

TEST(torus)
{
    struct cad clean = { 0 };
    skip_if_watched();
    cad_torus(&clean, &chance, cells(250), cells(84), 0.2 + 0.4 * cad_random(&chance), 0.5);
    test_alone("torus", 0, &clean);
}

TEST(bent_pipe)
{
    struct cad clean = { 0 };
    skip_if_watched();
    cad_bent_pipe(&clean, &chance, cells(270), cells(76), 0.15 + 0.1 * cad_random(&chance), 0.5);
    test_alone("S-bent pipe", 1, &clean);
}

TEST(thin_walled_box)
{
    struct cad clean = { 0 };
    skip_if_watched();
    cad_thin_box(&clean, &chance, cells(64 + (int)(20 * cad_random(&chance))), cells(44), cells(36), 0.01);
    test_alone("thin-walled box", 2, &clean);
}

TEST(interpenetrating_pipes)
{
    const double middle[3] = { 0, 0, 0 }, beside[3] = { 0.1 * cad_random(&chance), 0.1 * cad_random(&chance), 0.3 * cad_random(&chance) };
    struct cad *clean = test_cad();
    struct oracle_mesh outer;
    skip_if_watched();
    cad_closed_pipe(clean, &chance, 0.5, 4, cells(100), cells(110), cells(10), 0, middle);
    size_t vertices = clean->vertex_count, triangles = clean->triangle_count;
    struct cad *second = test_cad();
    cad_closed_pipe(second, &chance, 0.35, 3.5, cells(80), cells(110), cells(8), 0.9 + 0.4 * cad_random(&chance), beside);
    struct oracle_mesh a = mesh_of(clean, 0, vertices, 0, triangles),
                       b = mesh_of(second, 0, second->vertex_count, 0, second->triangle_count);
    assert_true(oracle_union(&a, &b, &outer));
    mem_grow(&clean->positions, &clean->position_capacity, vertices + second->vertex_count, sizeof(*clean->positions));
    mem_grow(&clean->triangles, &clean->index_capacity, 3 * (triangles + second->triangle_count), sizeof(*clean->triangles));
    memcpy(clean->positions + vertices, second->positions, second->vertex_count * sizeof(*clean->positions));
    for (size_t i = 0; i < 3 * second->triangle_count; i++)
        clean->triangles[3 * triangles + i] = (uint32_t)vertices + second->triangles[i];
    clean->vertex_count += second->vertex_count;
    clean->triangle_count += second->triangle_count;
    test_faults("two pipes", 3, clean, &outer);
    free((void *)outer.positions);
    free((void *)outer.triangles);
}

TEST_GROUP(surface_case_set_up, surface_case_tear_down)

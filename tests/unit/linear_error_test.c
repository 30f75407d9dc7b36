/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Distances along a surface must never be shorter than the straight line. Tested on shapes with every fault that CAD exports
   have, and on real models (shared/data/models). */
#include "surface/surface.h"

#include "tests/support/test.h"
#include <unistd.h>

#include "base/math/vec.h"
#include "preprocess/geometry/geometry.h"
#include "preprocess/model/model_source.h"
#include "tests/support/surface_case.h"

#define SOURCES 6
#define MODELS "../shared/data/models/"
/* longest edge allowed in the resampled surface, in multiples of the samples' spacing; twice, for edges across faces that were
   cut on two sides */
#define LONGEST 2.0
#define ROUNDING 1e-5 /* of the straight line: floats */

static size_t draw(size_t count)
{
    return (size_t)(cad_random(&chance) * (double)count);
}

/* For each source, checks the distances to all vertices against the straight line. Joining parts may move a point by at most
   the tolerance, so the line is measured from the vertex's moved position. */
static void check_sources(const char *name, const struct surface *surface, const float (*positions_m)[3], size_t vertex_count,
                          const double (*sources_m)[3], int count)
{
    double tolerance_m = surface_report(surface)->tolerance_m, least_m = 0;
    float *found = mem_array((size_t)count * vertex_count, sizeof(*found));
    size_t below = 0;
    assert_true(surface_distances(surface, sources_m, (size_t)count, found));
    for (int s = 0; s < count; s++) {
        struct surface_place dropped;
        surface_nearest(surface, sources_m[s], &dropped);
        for (size_t v = 0; v < vertex_count; v++) {
            const double p[3] = { (double)positions_m[v][0], (double)positions_m[v][1], (double)positions_m[v][2] };
            double straight_m = vec_distance(p, dropped.position_m), by_m = straight_m - (double)found[(size_t)s * vertex_count + v];
            below += by_m > tolerance_m + ROUNDING * straight_m;
            least_m = fmax(least_m, by_m);
        }
    }
    if (below)
        print_message("# %s: %zu of %zu are below the straight line, by %g m at most; the tolerance is %g m\n", name, below,
                      (size_t)count * vertex_count, least_m, tolerance_m);
    assert_int_equal(below, 0);
    mem_free(found);
}

/* Asserts that sample points cover the whole surface: no edge of the resampled mesh is much longer than the spacing. */
static void check_edges(const char *name, const struct surface *surface)
{
    struct surface_debug_mesh look;
    double longest_m = 0;
    surface_debug_mesh(surface, &look);
    for (size_t t = 0; t < look.visible_count; t++)
        for (int i = 0; i < 3; i++)
            longest_m = fmax(longest_m, vec_distance(look.points_m[look.tris[t][i]], look.points_m[look.tris[t][(i + 1) % 3]]));
    if (longest_m > LONGEST * surface_report(surface)->spacing_m)
        print_message("# %s: an edge is %.2f spacings long\n", name, longest_m / surface_report(surface)->spacing_m);
    assert_true(longest_m <= LONGEST * surface_report(surface)->spacing_m);
}

/* --- shapes ------------------------------------------------------------------------------------------------------------------- */

static void check_shape(const char *name, struct cad *clean, int faults)
{
    uint32_t *vertex_of = mem_array(clean->vertex_count, sizeof(*vertex_of));
    for (int fault = 0; fault < faults; fault++) {
        struct cad broken;
        struct cad_place place;
        double sources_m[SOURCES][3];
        cad_random_place(&place, &chance);
        cad_break(&broken, clean, (enum cad_fault)fault, &chance, vertex_of);
        cad_put(&broken, &place);
        struct surface *surface = surface_of(&broken);
        for (int s = 0; s < SOURCES; s++) {
            const uint32_t *tri = broken.triangles + 3 * draw(broken.triangle_count);
            for (int axis = 0; axis < 3; axis++)
                sources_m[s][axis] = 0.5 * (double)broken.positions[tri[0]][axis] + 0.3 * (double)broken.positions[tri[1]][axis] +
                                     0.2 * (double)broken.positions[tri[2]][axis];
        }
        char *what = test_printf("%s, %s", name, cad_fault_names[fault]);
        check_sources(what, surface, (const float(*)[3])broken.positions, broken.vertex_count, (const double(*)[3])sources_m, SOURCES);
        check_edges(what, surface);
        cad_finish(&broken);
    }
    mem_free(vertex_of);
    cad_finish(clean);
}

TEST(shapes)
{
    const double middle[3] = { 0, 0, 0 };
    struct cad cad = { 0 };
    cad_plate(&cad, &chance, 40, 30, 1.2, 1, 0.5);
    check_shape("plate", &cad, CAD_FAULTS);
    cad_slotted_plate(&cad, &chance, 40, 30, 1.3, 1, 12 + (int)draw(12), 1, 20);
    check_shape("slotted plate", &cad, CAD_FAULTS);
    cad_sphere(&cad, &chance, 16);
    check_shape("sphere", &cad, CAD_FAULTS);
    cad_cylinder(&cad, &chance, 24, 30, 4, 0.5);
    check_shape("cylinder", &cad, CAD_FAULTS);
    cad_torus(&cad, &chance, 50, 14, 0.1 + 0.3 * cad_random(&chance), 0.5);
    check_shape("torus", &cad, CAD_FAULTS);
    cad_bent_pipe(&cad, &chance, 60, 12, 0.05 + 0.1 * cad_random(&chance), 0.5);
    check_shape("bent pipe", &cad, CAD_FAULTS);
    cad_thin_box(&cad, &chance, 20, 14, 12, 0.05);
    check_shape("thin-walled box", &cad, CAD_FAULTS);
    cad_eight(&cad, &chance, 80, 12, 0.05 + 0.1 * cad_random(&chance), 0);
    check_shape("tube through itself", &cad, CAD_FAULTS);
    cad_closed_pipe(&cad, &chance, 0.01, 10, 5, 1, 1, 0.4, middle);
    check_shape("rod", &cad, CAD_FAULTS);
}

/* A grating: two layers of crossing rods that touch. From the area, 15,000 sample points would suffice, but thin rods need
   more. */
TEST(a_grating_of_rods)
{
    struct cad cad = { 0 };
    for (int i = 0; i < 200; i++) {
        const double along = 0.05 * (i / 2 - 50) + 0.01 * cad_random(&chance);
        const double centre[3] = { i % 2 ? along : 0, i % 2 ? 0 : along, i % 2 ? 0.0101 : 0 };
        size_t first = cad.vertex_count;
        cad_closed_pipe(&cad, &chance, 0.005, 6, 5, 1, 1, M_PI / 2, (const double[3]){ 0, 0, 0 });
        for (size_t v = first; v < cad.vertex_count; v++) {
            float *p = cad.positions[v], x = p[0], y = p[1];
            p[0] = (i % 2 ? y : x) + (float)centre[0];
            p[1] = (i % 2 ? x : y) + (float)centre[1];
            p[2] += (float)centre[2];
        }
    }
    check_shape("grating", &cad, 1);
}

/* --- real models -------------------------------------------------------------------------------------------------------------- */

static void check_part(const struct gltf_model *model, const char *nodes, const double source_m[3])
{
    struct geometry g;
    char why[MODEL_WHY_BYTES];
    double sources_m[SOURCES][3];
    assert_true(geometry_cut(&g, model, &(struct geometry_params){ .nodes = nodes, .unit_m = 1, .up = AXIS_Y }, why));
    struct surface *surface = surface_create(the_log, workers, (const float(*)[3])g.positions_m, g.vertex_count, g.indices,
                                             g.index_count / 3, &(struct surface_params){ 0 });
    assert_non_null(surface);
    for (int s = 0; s < SOURCES; s++) {
        const float *p = g.positions_m[draw(g.vertex_count)];
        for (int axis = 0; axis < 3; axis++)
            sources_m[s][axis] = s == 0 && source_m ? source_m[axis] - g.origin_m[axis] : (double)p[axis];
    }
    check_sources(nodes, surface, (const float(*)[3])g.positions_m, g.vertex_count, (const double(*)[3])sources_m, SOURCES);
    check_edges(nodes, surface);
    surface_destroy(&surface);
    geometry_finish(&g);
}

static void check_model(const char *path, const char *const *parts, const double source_m[3])
{
    struct model_source source;
    struct gltf_model model;
    char why[MODEL_WHY_BYTES];
    if (access(path, R_OK) != 0) {
        print_message("# %s is not there\n", path);
        skip();
    }
    assert_true(model_source_open(&source, path, why));
    assert_true(gltf_load(&model, &source, why));
    for (size_t i = 0; parts[i]; i++)
        check_part(&model, parts[i], i == 0 ? source_m : NULL);
    gltf_free(&model);
    model_source_finish(&source);
}

/* Part of a real support frame. When long rods had no sample points, a tenth of the distances from this corner were shorter
   than the straight line, by up to 0.2 m of 1.1 m. */
TEST(supports)
{
    static const char *const parts[] = { "/PS/WD1/0003", "/PS/WD1/0022", "/PS/WD1/0036", NULL };
    check_model(MODELS "huldra_wd1_psup.glb", parts, (const double[3]){ -8.7267, 8.7477, 1.8313 });
}

TEST(plant_room)
{
    static const char *const parts[] = { "/-HZ-05--C", "/-HZ", NULL };
    check_model(MODELS "plm_plant_5parts.glb", parts, NULL);
}

TEST(platform)
{
    static const char *const parts[] = { "*", NULL };
    check_model(MODELS "offshore_platform_overview.glb", parts, NULL);
}

TEST_GROUP(surface_case_set_up, surface_case_tear_down)

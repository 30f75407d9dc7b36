/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rods close to a thin sheet, within the tolerance for bridging gaps. A rod must be joined to the side of the sheet that faces
   it, and never through the sheet to the other side. */
#include "surface/repair/line_of_sight.h"

#include "tests/support/test.h"

#include "surface/surface.h"
#include "tests/support/surface_case.h"

#define ACROSS 40
#define UP 24
#define CELL 0.025
#define WIDE (ACROSS * CELL) /* of the sheet, m */
#define HIGH (UP * CELL)
#define TOLERANCE 5.5e-4    /* smallest tolerance in metres that the surface's repair chooses for these shapes */
#define TOLERANCE_MOST 1e-3 /* largest one in metres; it depends on the shape's rotation */
#define ALONG 16            /* cells of the rod */
#define OFF 0.02            /* metres; allowed error of the distances. If a rod is joined to the wrong side, the error is larger */

struct sheet_and_rod { /* a sheet whose lower side is at z = 0, and a rod along x, which lies above it, below it, or next to its rim */
    struct cad cad;
    size_t sheet_count; /* number of vertices of the sheet, which come first; all others belong to the rod */
    double thick, rod, source[3];
};

static void stretch(struct cad *cad, size_t from, double x, double y, double z, const double low[3])
{
    const double by[3] = { x, y, z };
    for (size_t v = from; v < cad->vertex_count; v++)
        for (int axis = 0; axis < 3; axis++)
            cad->positions[v][axis] = (float)((double)cad->positions[v][axis] * by[axis] + low[axis]);
}

/* Makes a sheet and a rod of these thicknesses. low: the rod's lowest corner; source: point from which distances are computed,
   on the rod's side that faces away from the sheet. */
static void make_pair(struct sheet_and_rod *pair, double thick, double rod, const double low[3], const double source[3])
{
    *pair = (struct sheet_and_rod){ .thick = thick, .rod = rod };
    cad_box(&pair->cad, &chance, ACROSS, UP, 1, CELL);
    stretch(&pair->cad, 0, 1, 1, thick / CELL, (const double[3]){ 0, 0, 0 });
    pair->sheet_count = pair->cad.vertex_count;
    struct cad *bar = test_cad();
    cad_box(bar, &chance, ALONG, 1, 1, CELL);
    stretch(bar, 0, 1, rod / CELL, rod / CELL, low);
    cad_append(&pair->cad, bar, (double[3]){ 0 });
    memcpy(pair->source, source, sizeof(pair->source));
}

/* Returns the distance from p on one side of the sheet to q on the other side, on the shortest way around a rim. */
static double way_round(const struct sheet_and_rod *pair, const double p[3], const double q[3])
{
    double least = INFINITY;
    for (int axis = 0; axis < 2; axis++)
        for (int end = 0; end < 2; end++) {
            double size = axis ? HIGH : WIDE, a = end ? size - p[axis] : p[axis], b = end ? size - q[axis] : q[axis];
            least = fmin(least, hypot(a + b + pair->thick, p[!axis] - q[!axis]));
        }
    return least;
}

/* Compares distances from the rod to both sides of the sheet with the exact ones. below: the rod is below the sheet; beside: it
   lies along a rim; pieces: expected number of components, 1 if the rod is joined to the sheet, 2 if it stays separate. */
static void test_pair(const char *name, const struct sheet_and_rod *pair, bool below, bool beside, size_t pieces)
{
    /* without CAD_GAPS, whose gaps would be as wide as the sheet is thick */
    static const enum cad_fault faults[] = { CAD_CLEAN, CAD_SOUP, CAD_REPEATED };
    for (size_t i = 0; i < sizeof(faults) / sizeof(faults[0]); i++) {
        struct cad broken;
        struct cad_place place;
        uint32_t *vertex_of = mem_array(pair->cad.vertex_count, sizeof(*vertex_of));
        double source[1][3], worst[2] = { 0, 0 };
        cad_random_place(&place, &chance);
        cad_put_point(&place, pair->source, source[0]);
        cad_break(&broken, &pair->cad, faults[i], &chance, vertex_of);
        cad_put(&broken, &place);
        struct surface *surface = surface_of(&broken);
        float *found = mem_array(broken.vertex_count, sizeof(*found));
        assert_true(surface_distances(surface, (const double(*)[3])source, 1, found));
        double tolerance = surface_report(surface)->tolerance_m / place.scale;
        assert_true(tolerance > TOLERANCE && tolerance < TOLERANCE_MOST);
        for (size_t v = 0; v < pair->sheet_count; v++) {
            const float *p = pair->cad.positions[v];
            const double q[3] = { (double)p[0], (double)p[1], (double)p[2] }, off = hypot(q[0] - pair->source[0], q[1] - pair->source[1]);
            bool far_side = !beside && (q[2] > pair->thick / 2) == below;
            double truth = far_side ? way_round(pair, pair->source, q) : off, metres = (double)found[vertex_of[v]] / place.scale;
            if (pieces == 1)
                worst[far_side] = fmax(worst[far_side], fabs(metres - truth));
            else
                assert_false(isfinite(metres));
        }
        print_message("# %-30s %-17s %zu pieces, near side errs by %.4f m at most, far side by %.4f m\n", name, cad_fault_names[faults[i]],
                      surface_report(surface)->components_after, worst[0], worst[1]);
        assert_int_equal(surface_report(surface)->components_after, pieces);
        assert_true(worst[0] < 2 * pair->rod + OFF && worst[1] < 2 * pair->rod + OFF);
        cad_finish(&broken);
        mem_free(found);
        mem_free(vertex_of);
    }
}

/* The sheet is so thin that its far side is within the tolerance too, and the gap may be wider than half its thickness. The rod
   must be joined to the near side. */
TEST(a_rod_is_joined_to_the_side_that_looks_at_it)
{
    static const double gaps[] = { 0, 0.4, 0.6 }; /* tolerances */
    for (int i = 0; i < 12; i++) {
        struct sheet_and_rod pair;
        bool below = i % 2, thin = i / 2 % 2;
        double thick = 0.3 * TOLERANCE, rod = (thin ? 0.8 : 6) * TOLERANCE, gap = gaps[i / 4] * TOLERANCE;
        double x = 0.25 + 0.1 * cad_random(&chance), y = 0.3 + 0.05 * cad_random(&chance), z = below ? -gap - rod : thick + gap;
        char name[64];
        make_pair(&pair, thick, rod, (const double[3]){ x, y, z },
                  (const double[3]){ x + ALONG * CELL / 2, y + rod / 2, below ? z : z + rod });
        snprintf(name, sizeof(name), "%s rod %s, gap %.2f mm", thin ? "thin" : "thick", below ? "below" : "above", 1000 * gap);
        test_pair(name, &pair, below, false, 1);
        cad_finish(&pair.cad);
    }
}

TEST(a_rod_farther_than_the_tolerance_hangs_apart)
{
    for (int below = 0; below < 2; below++) {
        struct sheet_and_rod pair;
        double thick = 0.3 * TOLERANCE, rod = 6 * TOLERANCE, z = below ? -1.2 * TOLERANCE_MOST - rod : thick + 1.2 * TOLERANCE_MOST;
        make_pair(&pair, thick, rod, (const double[3]){ 0.3, 0.3, z }, (const double[3]){ 0.45, 0.3 + rod / 2, below ? z : z + rod });
        test_pair("rod too far off", &pair, below, false, 2);
        cad_finish(&pair.cad);
    }
}

/* A rod next to the rim of a sheet is equally near to both sides, so it must be joined to the rim itself. */
TEST(a_rod_is_joined_to_the_rim)
{
    static const double gaps[] = { 0, 0.4, 0.8 };
    for (int i = 0; i < 3; i++) {
        struct sheet_and_rod pair;
        double thick = 0.3 * TOLERANCE, rod = 4 * TOLERANCE, x = 0.3 + 0.1 * cad_random(&chance), y = -gaps[i] * TOLERANCE - rod;
        make_pair(&pair, thick, rod, (const double[3]){ x, y, (thick - rod) / 2 }, (const double[3]){ x + ALONG * CELL / 2, y, thick / 2 });
        test_pair("rod beside the rim", &pair, false, true, 1);
        cad_finish(&pair.cad);
    }
}

TEST_GROUP(surface_case_set_up, surface_case_tear_down)

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Distances along surfaces, compared with formulas on clean shapes and with every fault of CAD exports; also, which parts are
   joined, kept separate and hidden. */
#include "surface/repair/repair.h"
#include "surface/surface.h"

#include "tests/support/test.h"

#include "tests/support/surface_case.h"

#define MEAN_MAX 0.003 /* of the largest distance */
#define WORST_MAX 0.01
#define METHODS_MAX 0.02

/* --- accuracy: shapes with a formula --------------------------------------------------------------------------------------- */

struct surface_shape {
    const char *name;
    void (*make)(struct cad *cad, double size[3]);
    double (*distance)(const double size[3], const double a[3], const double b[3]);
};

static double hypot3(const double a[3], const double b[3])
{
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

static void make_plate(struct cad *cad, double size[3])
{
    size[0] = 1 + cad_random(&chance);
    cad_plate(cad, &chance, 170, 130, size[0], 1, 0.5);
}

static double plate_distance(const double size[3], const double a[3], const double b[3])
{
    (void)size;
    return hypot3(a, b);
}

static void make_sphere(struct cad *cad, double size[3])
{
    (void)size;
    cad_sphere(cad, &chance, 60);
}

static double sphere_distance(const double size[3], const double a[3], const double b[3])
{
    (void)size;
    return 2 * asin(fmin(hypot3(a, b) / 2, 1));
}

static void make_cylinder(struct cad *cad, double size[3])
{
    size[0] = 3 + cad_random(&chance);
    cad_cylinder(cad, &chance, 150, 150, size[0], 0.5);
}

static double cylinder_distance(const double size[3], const double a[3], const double b[3])
{
    double turn = fabs(atan2(a[1], a[0]) - atan2(b[1], b[0]));
    (void)size;
    return hypot(turn > M_PI ? 2 * M_PI - turn : turn, a[2] - b[2]);
}

/* Makes a plate of 1.3 m x 1 m with a slot that is open at its lower edge: from x = size[0] to size[1] and up to y = size[2].
   */
static void make_slot(struct cad *cad, double size[3], int wide)
{
    int first = 60 + (int)(40 * cad_random(&chance)), high = 60 + (int)(40 * cad_random(&chance));
    size[0] = 1.3 * first / 170;
    size[1] = 1.3 * (first + wide) / 170;
    size[2] = high / 130.0;
    cad_slotted_plate(cad, &chance, 170, 130, 1.3, 1, first, wide, high);
}

static void make_wide_slot(struct cad *cad, double size[3])
{
    make_slot(cad, size, 8);
}

static void make_narrow_slot(struct cad *cad, double size[3])
{
    make_slot(cad, size, 2);
}

/* Returns whether the straight line from a to b passes through the plate's slot. */
static bool is_blocked(const double slot[3], const double a[3], const double b[3])
{
    double low = 0, high = 1, dx = b[0] - a[0], dy = b[1] - a[1];
    const double from[3] = { a[0] - slot[0], slot[1] - a[0], slot[2] - a[1] }, slope[3] = { dx, -dx, -dy };
    /* narrows [low, high] to the part of the line inside the slot: where from + t slope > 0 for each of the slot's three
       sides */
    for (int i = 0; i < 3; i++) {
        if (slope[i] == 0 && from[i] <= 1e-6)
            return false;
        if (slope[i] > 0)
            low = fmax(low, (1e-6 - from[i]) / slope[i]);
        else if (slope[i] < 0)
            high = fmin(high, (1e-6 - from[i]) / slope[i]);
    }
    return high - low > 1e-6;
}

static double slot_distance(const double slot[3], const double a[3], const double b[3])
{
    const double corners[2][3] = { { slot[0], slot[2], 0 }, { slot[1], slot[2], 0 } };
    if (!is_blocked(slot, a, b))
        return hypot3(a, b);
    double best = INFINITY;
    for (int i = 0; i < 2; i++) {
        if (is_blocked(slot, a, corners[i]))
            continue;
        if (!is_blocked(slot, corners[i], b))
            best = fmin(best, hypot3(a, corners[i]) + hypot3(corners[i], b));
        if (!is_blocked(slot, corners[1 - i], b))
            best = fmin(best, hypot3(a, corners[i]) + hypot3(corners[i], corners[1 - i]) + hypot3(corners[1 - i], b));
    }
    return best;
}

static const struct surface_shape shapes[] = {
    { "plate", make_plate, plate_distance },
    { "sphere", make_sphere, sphere_distance },
    { "cylinder", make_cylinder, cylinder_distance },
    { "plate, wide slot", make_wide_slot, slot_distance },
    { "plate, narrow slot", make_narrow_slot, slot_distance },
};

/* Chooses a random point from which to measure distances: inside a triangle, or at a vertex. */
static void choose_source(const struct cad *cad, bool inside, double out[3])
{
    size_t t = (size_t)(cad_random(&chance) * (double)cad->triangle_count);
    double w[3] = { 1, 0, 0 };
    if (inside) {
        w[0] = cad_random(&chance);
        w[1] = (1 - w[0]) * cad_random(&chance);
        w[2] = 1 - w[0] - w[1];
    }
    for (int axis = 0; axis < 3; axis++) {
        out[axis] = 0;
        for (size_t i = 0; i < 3; i++)
            out[axis] += w[i] * (double)cad->positions[cad->triangles[3 * t + i]][axis];
    }
}

struct score {
    double mean, worst;
};

static struct score score_of(const struct surface_shape *shape, const double size[3], const struct cad *clean, const double source[3],
                             double scale, const float *distances, const uint32_t *vertex_of)
{
    struct score score = { 0 };
    double largest = 0;
    for (size_t v = 0; v < clean->vertex_count; v++) {
        const double p[3] = { (double)clean->positions[v][0], (double)clean->positions[v][1], (double)clean->positions[v][2] };
        double truth = shape->distance(size, source, p), error = fabs((double)distances[vertex_of[v]] / scale - truth);
        score.mean += error / (double)clean->vertex_count;
        score.worst = fmax(score.worst, error);
        largest = fmax(largest, truth);
    }
    return (struct score){ score.mean / largest, score.worst / largest };
}

/* Tests the distances on a shape with each fault of CAD exports; the default run tests every second fault, which ones depends
   on the shape. */
static void test_shape(const struct surface_shape *shape)
{
    struct cad *clean = test_cad();
    struct cad_place place;
    double size[3] = { 0 }, sources[2][3], put[2][3];
    shape->make(clean, size);
    assert_true(clean->vertex_count >= 20000);
    cad_random_place(&place, &chance);
    uint32_t *vertex_of = mem_array(clean->vertex_count, sizeof(*vertex_of));
    for (int s = 0; s < 2; s++) {
        choose_source(clean, s == 1, sources[s]);
        cad_put_point(&place, sources[s], put[s]);
    }
    for (int fault = 0; fault < CAD_FAULTS; fault++) {
        struct cad broken;
        if (!sweep_takes((int)(shape - shapes), fault, 2))
            continue;
        cad_break(&broken, clean, (enum cad_fault)fault, &chance, vertex_of);
        cad_put(&broken, &place);
        struct surface *surface = surface_of(&broken);
        float *distances = mem_array(2 * broken.vertex_count, sizeof(*distances));
        assert_true(surface_distances(surface, (const double(*)[3])put, 2, distances));
        for (int s = 0; s < 2; s++) {
            struct score score =
                score_of(shape, size, clean, sources[s], place.scale, distances + (size_t)s * broken.vertex_count, vertex_of);
            print_message("# %-18s %-17s source %-9s mean %.3f %%  worst %.3f %%\n", shape->name, cad_fault_names[fault],
                          s ? "in a face" : "at vertex", 100 * score.mean, 100 * score.worst);
            assert_true(score.mean <= MEAN_MAX);
            assert_true(score.worst <= WORST_MAX);
        }
        assert_int_equal(surface_report(surface)->components_after, 1);
        struct surface_field field;
        assert_true(surface_field_init(&field, surface, (const double(*)[3])put, 2, NULL));
        assert_true(surface_check(surface, &field));
        surface_field_finish(&field);
        assert_true(surface_report(surface)->heat_disagreement > 0);
        assert_true(surface_report(surface)->heat_disagreement < METHODS_MAX);
        cad_finish(&broken);
        mem_free(distances);
    }
    mem_free(vertex_of);
}

TEST(shapes_with_every_fault_are_exact_enough)
{
    for (size_t i = 0; i < sizeof(shapes) / sizeof(shapes[0]); i++)
        test_shape(&shapes[i]);
}

/* Distance on a plate with a round hole of radius 1 around the origin. */
static double round_hole_distance(const double a[3], const double b[3])
{
    const double from_a = hypot(a[0], a[1]), from_b = hypot(b[0], b[1]);
    const double turn = fabs(remainder(atan2(a[1], a[0]) - atan2(b[1], b[0]), 2 * M_PI));
    const double around = turn - acos(fmin(1 / from_a, 1)) - acos(fmin(1 / from_b, 1));
    return around <= 0 ? hypot3(a, b) : sqrt(fmax(from_a * from_a - 1, 0)) + around + sqrt(fmax(from_b * from_b - 1, 0));
}

#define TILT_RAD 0.3

/* Errors of distances at points that see the source, and at points behind the hole, relative to the exact distance. */
struct hole_errors {
    double seen_mean, seen_worst, behind_mean, behind_worst;
};

/* Tilts a point by TILT_RAD about the y axis, and moves it by away_m along each axis. */
static void tilt(const double p[3], double away_m, double out[3])
{
    out[0] = p[0] * cos(TILT_RAD) - p[2] * sin(TILT_RAD) + away_m;
    out[1] = p[1] + away_m;
    out[2] = p[0] * sin(TILT_RAD) + p[2] * cos(TILT_RAD) + away_m;
}

/* The inverse of tilt(). */
static void level(const double p[3], double away_m, double out[3])
{
    const double x = p[0] - away_m, z = p[2] - away_m;
    out[0] = x * cos(TILT_RAD) + z * sin(TILT_RAD);
    out[1] = p[1] - away_m;
    out[2] = z * cos(TILT_RAD) - x * sin(TILT_RAD);
}

/* Measures distances along a square plate of needles from the rim of a round hole to the outer edge, at all points of the mesh that
   are not close to the source. away_m: distance of the plate from the origin along each axis. Coordinates have single precision,
   so that a distant plate is not quite flat. */
static struct hole_errors round_hole_errors(int needles, double away_m)
{
    enum { SOURCES = 12 };
    struct cad *plate = test_cad();
    double sources[SOURCES][3] = { 0 }, seen = 0, behind = 0;
    struct hole_errors errors = { 0 };
    cad_cylinder(plate, &chance, needles, 1, 1, 0);
    for (size_t v = 0; v < plate->vertex_count; v++) {
        float *p = plate->positions[v], outer = 4 / fmaxf(fabsf(p[0]), fabsf(p[1]));
        p[0] *= p[2] > 0 ? outer : 1;
        p[1] *= p[2] > 0 ? outer : 1;
        double placed[3];
        tilt((const double[3]){ (double)p[0], (double)p[1], 0 }, away_m, placed);
        for (int i = 0; i < 3; i++)
            p[i] = (float)placed[i];
    }
    for (int s = 0; s < SOURCES; s++) {
        const double radius_m = between(1.2, 3.9), angle = between(-M_PI, M_PI);
        tilt((const double[3]){ radius_m * cos(angle), radius_m * sin(angle), 0 }, away_m, sources[s]);
    }
    struct surface *surface = surface_of(plate);
    struct surface_debug_mesh mesh;
    struct surface_field field;
    surface_debug_mesh(surface, &mesh);
    assert_true(surface_field_init(&field, surface, (const double(*)[3])sources, SOURCES, NULL));
    char *used = mem_array(mesh.point_count, 1); /* merged points have no triangles */
    for (size_t t = 0; t < mesh.tri_count; t++)
        for (int i = 0; i < 3; i++)
            used[mesh.tris[t][i]] = 1;
    for (size_t s = 0; s < SOURCES; s++)
        for (size_t v = 0; v < mesh.point_count; v++) {
            double p[3], source[3];
            if (!used[v])
                continue;
            level(mesh.points_m[v], away_m, p);
            level(sources[s], away_m, source);
            const double truth = round_hole_distance(source, p);
            const double error = fabs((double)field.distances_m[v * SOURCES + s] - truth) / truth;
            if (truth < 0.2)
                continue;
            if (truth > hypot3(source, p)) {
                errors.behind_mean += error;
                errors.behind_worst = fmax(errors.behind_worst, error);
                behind++;
            } else {
                errors.seen_mean += error;
                errors.seen_worst = fmax(errors.seen_worst, error);
                seen++;
            }
        }
    mem_free(used);
    surface_field_finish(&field);
    errors.seen_mean /= seen;
    errors.behind_mean /= behind;
    print_message("# %d needles: %.4f %%, %.3f %% off at most; behind the hole %.3f %%, %.3f %%\n", needles, 100 * errors.seen_mean,
                  100 * errors.seen_worst, 100 * errors.behind_mean, 100 * errors.behind_worst);
    return errors;
}

/* Paths between needles are straight, and those to points behind the hole bend around it. */
TEST(distances_around_a_round_hole_are_exact)
{
    const struct hole_errors some = round_hole_errors(320, 0), many = round_hole_errors(1200, 0), far = round_hole_errors(1200, 1000);
    const struct hole_errors most = round_hole_errors(4800, 0);
    assert_true(some.seen_mean < 0.0002 && some.seen_worst < 0.004);
    assert_true(some.behind_mean < 0.0025 && some.behind_worst < 0.005);
    assert_true(many.seen_mean < 0.0003 && many.seen_worst < 0.01);
    assert_true(many.behind_mean < 0.003 && many.behind_worst < 0.02);
    assert_true(most.seen_mean < 0.0003 && most.seen_worst < 0.005);
    assert_true(most.behind_mean < 0.0025 && most.behind_worst < 0.01);
    assert_true(far.seen_mean < 0.0003 && far.seen_worst < 0.01);
    assert_true(far.behind_mean < 0.004 && far.behind_worst < 0.02);
}

/* --- which parts are joined and which are kept apart -------------------------------------------------------------------------- */

static float *distances_from(struct surface *surface, const struct cad *cad, double x, double y, double z)
{
    const double source[1][3] = { { x, y, z } };
    float *distances = mem_array(cad->vertex_count, sizeof(*distances));
    assert_true(surface_distances(surface, source, 1, distances));
    return distances;
}

/* Makes two plates of 1 m; the second is shifted by (dx, 10 mm, dz). Returns whether it can be reached from the first along the
   surface. */
static bool second_plate_reached(double dx, double dz)
{
    struct cad *plate = test_cad(), *both = test_cad();
    cad_plate(plate, &chance, 30, 30, 1, 1, 0);
    cad_append(both, plate, (double[3]){ 0, 0, 0 });
    cad_append(both, plate, (double[3]){ dx, 0.01, dz });
    struct surface *surface = surface_of(both);
    float *distances = distances_from(surface, both, 0.1, 0.1, 0);
    bool reached = isfinite(distances[plate->vertex_count]);
    for (size_t v = 0; v < plate->vertex_count; v++) {
        assert_true(isfinite(distances[v]));
        assert_true(isfinite(distances[plate->vertex_count + v]) == reached);
    }
    mem_free(distances);
    return reached;
}

TEST(gaps_are_closed_and_walls_are_not_passed)
{
    assert_true(second_plate_reached(1.0003, 0));   /* two plates with a gap of 0.3 mm are joined */
    assert_false(second_plate_reached(1.02, 0));    /* a slot of 20 mm */
    assert_false(second_plate_reached(0, 0.01));    /* two sheets 10 mm apart */
    assert_true(second_plate_reached(0.5, 0.0002)); /* reached: the second plate lies half on the first, 0.2 mm above it */
}

/* Asserts that the debug mesh contains every bridge (joint between parts) that the report counts, and that all lie between
   low_x and high_x. */
static void assert_bridges_are_shown(const struct surface *surface, double low_x, double high_x)
{
    const struct surface_report *report = surface_report(surface);
    struct surface_debug_mesh look;
    double longest_m = 0;
    surface_debug_mesh(surface, &look);
    assert_true(look.bridge_count > 0);
    assert_int_equal(look.bridge_count, report->bridges);
    for (size_t i = 0; i < look.bridge_count; i++) {
        const struct crack_bridge *bridge = &look.bridges[i];
        assert_true(bridge->from_m[0] > low_x && bridge->from_m[0] < high_x);
        longest_m = fmax(longest_m, hypot3(bridge->from_m, bridge->to_m));
    }
    assert_float_equal(longest_m, report->longest_bridge_m, 1e-12);
}

TEST(bridges_lie_in_the_gap)
{
    struct cad *plate = test_cad(), *both = test_cad();
    cad_plate(plate, &chance, 30, 30, 1, 1, 0);
    cad_append(both, plate, (double[3]){ 0, 0, 0 });
    cad_append(both, plate, (double[3]){ 1.0003, 0, 0 });
    struct surface *surface = surface_of(both);
    assert_int_equal(surface_report(surface)->components, 2);
    assert_int_equal(surface_report(surface)->components_after, 1);
    assert_int_equal(surface_report(surface)->bridges, 31); /* 31 bridges: one for each pair of opposite vertices along the gap */
    assert_float_equal(surface_report(surface)->longest_bridge_m, 0.0003, 1e-6);
    assert_bridges_are_shown(surface, 0.9999, 1.0004);
}

TEST(a_pipe_that_ends_inside_a_shell_is_joined_to_it)
{
    struct cad *pipe = test_cad(), *both = test_cad();
    cad_sphere(both, &chance, 40);
    cad_cylinder(pipe, &chance, 48, 60, 3, 0);
    /* makes the pipe 0.2 m in radius and moves it along its axis, so that it leads from inside the sphere to the outside */
    for (size_t v = 0; v < pipe->vertex_count; v++) {
        pipe->positions[v][0] *= 0.2f;
        pipe->positions[v][1] *= 0.2f;
        pipe->positions[v][2] += 0.5f;
    }
    size_t sphere_count = both->vertex_count;
    cad_append(both, pipe, (double[3]){ 0, 0, 0 });
    struct surface *surface = surface_of(both);
    float *distances = test_memory(distances_from(surface, both, 0, 0, -1));
    const struct surface_report *report = surface_report(surface);
    assert_int_equal(report->components, 2);
    assert_int_equal(report->components_after, 1);
    assert_bridges_are_shown(surface, -0.25, 0.25);
    assert_true(report->hidden_vertices >= 48 * 8); /* at least 8 rings of the pipe's vertices lie inside the sphere and are hidden */
    /* the true distance from the sphere's pole to the pipe's end: over the sphere to the pipe, then along the pipe */
    double seam = asin(0.2), truth = M_PI - seam + (3.5 - cos(seam));
    assert_float_equal(distances[both->vertex_count - 1], truth, 0.01 * truth);
    for (size_t v = sphere_count; v < both->vertex_count; v++)
        /* hidden vertices of the pipe need distances, too, because triangles that pass through the sphere's shell have corners
           there */
        assert_true(isfinite(distances[v]));
}

TEST(nothing_leads_through_a_closed_part)
{
    struct cad *pipes = test_cad();
    cad_closed_pipe(pipes, &chance, 0.5, 2, 80, 60, 12, 0, (const double[3]){ 0, 0, 0 });
    size_t first = pipes->vertex_count;
    /* a thinner pipe across, whose middle is inside the first pipe */
    cad_closed_pipe(pipes, &chance, 0.3, 4, 60, 120, 8, M_PI / 2, (const double[3]){ 0, 0, 0 });
    struct surface *surface = surface_of(pipes);
    const struct surface_report *report = surface_report(surface);
    float *distances = distances_from(surface, pipes, 2, 0, 0); /* measures from one end of the second pipe to the other */
    assert_int_equal(report->components_after, 1);
    assert_true(report->hidden_vertices > 60 * 20);
    /* The way to the other end is 1.5 m along the second pipe, around half of the first pipe (at its shortest between the
       circles where the pipes meet), and 1.5 m again. */
    double least = 2 * 1.5 + 0.5 * (M_PI - 2 * asin(0.6));
    double other_end = INFINITY;
    for (size_t v = first; v < pipes->vertex_count; v++)
        if (pipes->positions[v][0] < -1.999f)
            other_end = fmin(other_end, (double)distances[v]);
    assert_true(other_end > least);
    assert_true(other_end < 5.5);
    mem_free(distances);
}

/* Adds a closed box from `low` to `high`, of 12 triangles. */
static void add_box(struct cad *all, const double low[3], const double high[3])
{
    struct cad *box = test_cad();
    cad_box(box, &chance, 1, 1, 1, 1);
    for (size_t v = 0; v < box->vertex_count; v++)
        for (int axis = 0; axis < 3; axis++)
            box->positions[v][axis] = (float)(low[axis] + (double)box->positions[v][axis] * (high[axis] - low[axis]));
    cad_append(all, box, (double[3]){ 0, 0, 0 });
}

/* Two ducts end in flanges of 3.9 mm that touch each other. The tolerance for joining parts, derived from the ducts' length, is
   larger than that. All the same, what touches one side of a flange must not be joined to the flange's other side: the way
   leads around the rim. */
TEST(thin_flanges_are_not_bridged)
{
    struct cad *ducts = test_cad();
    const double low = 4 - 0.0039, high = 4 + 0.0039, truth = hypot(0.2, 8 + 2 * 0.1); /* unrolled: over the flanges' rim */
    add_box(ducts, (const double[3]){ 0, 0, 0 }, (const double[3]){ 0.4, 0.4, low });
    add_box(ducts, (const double[3]){ -0.1, -0.1, low }, (const double[3]){ 0.5, 0.5, 4 });
    add_box(ducts, (const double[3]){ -0.1, -0.1, 4 }, (const double[3]){ 0.5, 0.5, high });
    add_box(ducts, (const double[3]){ 0, 0, high }, (const double[3]){ 0.4, 0.4, 8 });
    struct surface *surface = surface_of(ducts);
    const struct surface_report *report = surface_report(surface);
    float *distances = test_memory(distances_from(surface, ducts, 0.2, 0, 0));
    assert_true(report->tolerance_m > 0.0039);
    assert_int_equal(report->components_after, 1);
    assert_true(report->longest_bridge_m < 1e-6);
    for (size_t v = 0; v < ducts->vertex_count; v++)
        if (ducts->positions[v][2] > 7.9f && ducts->positions[v][1] < 0.1f)
            assert_float_equal(distances[v], truth, 0.003 * truth);
}

/* One duct ends inside a plate of 3.9 mm, at several depths; a second one stands on the plate's other side. Although the
   tolerance exceeds the plate's thickness, the way from one duct to the other must lead around the plate's rim. */
TEST(nothing_leads_through_a_thin_plate)
{
    enum { DEPTHS = 8 };
    const double thick = 0.0039, truth = hypot(0.2, 8 + 2 * 0.1 + thick); /* unrolled: over the plate's rim */
    double worst = 0;
    for (int i = 0; i < DEPTHS; i++) {
        struct cad ducts = { 0 };
        add_box(&ducts, (const double[3]){ 0, 0, 0 }, (const double[3]){ 0.4, 0.4, 4 + thick * (i ? cad_random(&chance) : 1) });
        add_box(&ducts, (const double[3]){ -0.1, -0.1, 4 }, (const double[3]){ 0.5, 0.5, 4 + thick });
        add_box(&ducts, (const double[3]){ 0, 0, 4 + thick }, (const double[3]){ 0.4, 0.4, 8 });
        struct surface *surface = surface_of(&ducts);
        float *distances = distances_from(surface, &ducts, 0.2, 0, 0);
        assert_true(surface_report(surface)->tolerance_m > thick);
        for (size_t v = 0; v < ducts.vertex_count; v++)
            if (ducts.positions[v][2] > 7.9f && ducts.positions[v][1] < 0.1f)
                worst = fmax(worst, fabs((double)distances[v] - truth) / truth);
        cad_finish(&ducts);
        mem_free(distances);
    }
    print_message("# through a thin plate: %.3f %% off at most\n", 100 * worst);
    assert_true(worst < 0.003);
}

/* --- places -------------------------------------------------------------------------------------------------------------------- */

TEST(a_sensor_is_dropped_onto_the_surface)
{
    struct cad *plate = test_cad();
    struct surface_place place;
    cad_plate(plate, &chance, 10, 10, 1, 1, 0);
    struct surface *surface = surface_of(plate);
    surface_nearest(surface, (const double[3]){ 0.42, 0.68, 0.3 }, &place);
    assert_float_equal(place.distance_m, 0.3, 1e-6);
    assert_float_equal(place.position_m[0], 0.42, 1e-6);
    assert_float_equal(place.position_m[2], 0, 1e-6);
    assert_float_equal(plate->positions[place.vertex][0], 0.4, 1e-6);
    assert_float_equal(plate->positions[place.vertex][1], 0.7, 1e-6);
    surface_nearest(surface, (const double[3]){ -3, -4, 0 }, &place);
    assert_float_equal(place.distance_m, 5, 1e-6);
    float *distances = test_memory(distances_from(surface, plate, 0.4, 0.7, 0.05));
    for (size_t v = 0; v < plate->vertex_count; v++) {
        double truth = hypot((double)plate->positions[v][0] - 0.4, (double)plate->positions[v][1] - 0.7);
        /* expects the straight-line distance from the source, (0.4, 0.7) on the plate, at each vertex */
        assert_float_equal(distances[v], truth, 1e-4);
    }
}

TEST(nearest_is_the_nearest)
{
    struct cad *torus = test_cad();
    cad_torus(torus, &chance, 160, 64, 0.3, 0.5);
    struct surface *surface = surface_of(torus);
    for (int i = 0; i < 200; i++) {
        const double p[3] = { 4 * cad_random(&chance) - 2, 4 * cad_random(&chance) - 2, 2 * cad_random(&chance) - 1 };
        struct surface_place place;
        surface_nearest(surface, p, &place);
        /* expected: the distance from a smooth torus; the mesh lies up to 6 mm inside of it */
        double truth = fabs(hypot(hypot(p[0], p[1]) - 1, p[2]) - 0.3);
        assert_float_equal(place.distance_m, truth, 0.006);
        assert_float_equal(hypot3(p, place.position_m), place.distance_m, 1e-9);
    }
}

/* Searching for the nearest point within a limit finds the same point as searching without, or none if that is farther away;
   also if the limit excludes all triangles that face the given direction, as for points inside the tube. */
TEST(within_a_limit_is_the_same_spot_or_none)
{
    struct cad *torus = test_cad();
    int within = 0, beyond = 0, other_side = 0;
    cad_torus(torus, &chance, 160, 64, 0.3, 0.5);
    struct surface *surface = surface_of(torus);
    for (int i = 0; i < 2000; i++) {
        double p[3], normal[3];
        for (int axis = 0; axis < 3; axis++) {
            p[axis] = 2.8 * cad_random(&chance) - 1.4;
            normal[axis] = 2 * cad_random(&chance) - 1;
        }
        p[2] *= 0.25;
        struct surface_point hit, near, any;
        surface_find_point(surface, p, normal, &hit);
        surface_find_point(surface, p, NULL, &any);
        double limit_m = hit.distance_m * (0.2 + 1.6 * cad_random(&chance));
        bool found = surface_find_point_within(surface, p, normal, limit_m, &near);
        assert_int_equal(found, hit.distance_m <= limit_m);
        if (found) {
            assert_int_equal(near.tri, hit.tri);
            assert_memory_equal(near.weights, hit.weights, sizeof(hit.weights));
            assert_memory_equal(near.point_m, hit.point_m, sizeof(hit.point_m));
        }
        within += found;
        beyond += !found;
        other_side += !found && any.distance_m <= limit_m;
    }
    assert_true(within > 500 && beyond > 500 && other_side > 20);
    assert_false(surface_find_point_within(surface, (const double[3]){ 9, 9, 9 }, NULL, 1, &(struct surface_point){ 0 }));
}

/* A pipe as CAD programs triangulate it, from long strips: distances between points in the middle of strips, far from any
   vertex, must be exact, too. */
TEST(long_thin_strips_are_exact_near_a_source_too)
{
    enum { SOURCES = 8, PLACES = 400 };
    struct cad *pipe = test_cad();
    double size[3] = { 12 }, sources[SOURCES][3], worst = 0, sum = 0;
    cad_cylinder(pipe, &chance, 96, 2, size[0], 0);
    for (int s = 0; s < SOURCES; s++)
        choose_source(pipe, true, sources[s]);
    struct surface *surface = surface_of(pipe);
    struct surface_field field;
    assert_true(surface_field_init(&field, surface, (const double(*)[3])sources, SOURCES, NULL));
    for (int i = 0; i < PLACES; i++) {
        double place[3];
        float found[SOURCES];
        struct surface_point hit;
        choose_source(pipe, true, place);
        if (i % 2) { /* near a source */
            const double *near = sources[i / 2 % SOURCES];
            double turn = atan2(near[1], near[0]) + 0.4 * (cad_random(&chance) - 0.5);
            place[0] = cos(turn);
            place[1] = sin(turn);
            place[2] = fmin(fmax(near[2] + 0.4 * (cad_random(&chance) - 0.5), 0), size[0]);
        }
        surface_find_point(surface, place, NULL, &hit);
        surface_field_at_point(&field, surface, &hit, found);
        for (int s = 0; s < SOURCES; s++) {
            double truth = cylinder_distance(size, hit.point_m, sources[s]), error = fabs((double)found[s] - truth);
            sum += error / (truth + 0.05) / (PLACES * SOURCES);
            worst = fmax(worst, error / (truth + 0.05));
        }
    }
    print_message("# pipe of 96 strips: places are %.3f %% off on average, %.3f %% at most, of the way itself\n", 100 * sum, 100 * worst);
    assert_true(sum < 0.005);
    assert_true(worst < 0.03);
    surface_field_finish(&field);
}

/* Returns the largest relative error of distances over short ways, where a small error is relatively large. The plate's cells
   are distorted, so that resampling flips the edges of most triangles. */
static double worst_short_way(int across, int up)
{
    enum { SOURCES = 8, PLACES = 800 };
    struct cad *plate = test_cad();
    double sources[SOURCES][3] = { 0 }, worst = 0;
    cad_plate(plate, &chance, across, up, 2, 1, 0.6);
    for (int s = 0; s < SOURCES; s++) {
        sources[s][0] = 2 * cad_random(&chance);
        sources[s][1] = cad_random(&chance);
    }
    struct surface *surface = surface_of(plate);
    struct surface_field field;
    assert_true(surface_field_init(&field, surface, (const double(*)[3])sources, SOURCES, NULL));
    for (int i = 0; i < PLACES; i++) {
        const double *near = sources[i % SOURCES], turn = 2 * M_PI * cad_random(&chance), far_m = 0.1 * cad_random(&chance);
        float found[SOURCES];
        struct surface_point hit;
        surface_find_point(surface, (const double[3]){ near[0] + far_m * cos(turn), near[1] + far_m * sin(turn), 0 }, NULL, &hit);
        surface_field_at_point(&field, surface, &hit, found);
        for (int s = 0; s < SOURCES; s++) {
            double truth = hypot3(hit.point_m, sources[s]);
            worst = fmax(worst, fabs((double)found[s] - truth) / (truth + 0.002));
        }
    }
    surface_field_finish(&field);
    return worst;
}

TEST(short_ways_are_exact_whatever_edges_are_flipped)
{
    enum { PLATES = 6, HARD = 3 };
    static const struct {
        int across, up;
        uint64_t state;
    } hard[HARD] = {
        /* random states that make plates on which the propagation of distances once failed: here, a triangle's corner lies
           behind an end of the opposite edge */
        { 1, 5, 1558015352152668877u },
        { 5, 5, 12376468115645539828u }, /* here, the source lies exactly on an edge */
        { 1, 6, 15378426302762057891u }, /* here, an edge is reached at its farther end before its nearer one */
    };
    struct cad_random usual;
    double worst = 0;
    for (int n = 0; n < PLATES; n++) {
        int across = 1 + (int)(6 * cad_random(&chance)), up = 1 + (int)(6 * cad_random(&chance));
        worst = fmax(worst, worst_short_way(across, up));
    }
    usual = chance;
    for (int n = 0; n < HARD; n++) {
        chance.state = hard[n].state;
        worst = fmax(worst, worst_short_way(hard[n].across, hard[n].up));
    }
    chance = usual;
    print_message("# plates of few cells: places are off by %.3f %% of the way itself at most\n", 100 * worst);
    assert_true(worst < 0.03);
}

/* Distances from many sources, computed at once on all threads, must equal those computed one by one, although some sources are
   on a small piece where the computation ends sooner. */
TEST(many_sources_at_once_are_as_one_by_one)
{
    enum { SOURCES = 21 };
    struct cad *both = test_cad(), *torus = test_cad(), *plate = test_cad();
    double sources[SOURCES][3];
    cad_torus(torus, &chance, 60, 24, 0.3, 0.5);
    cad_plate(plate, &chance, 16, 16, 1, 1, 0);
    cad_append(both, torus, (double[3]){ 0, 0, 0 });
    cad_append(both, plate, (double[3]){ 5, 0, 0 });
    for (int s = 0; s < SOURCES; s++)
        choose_source(both, true, sources[s]);
    struct surface *surface = surface_of(both);
    float *together = test_memory(mem_array(SOURCES * both->vertex_count, sizeof(*together)));
    assert_true(surface_distances(surface, (const double(*)[3])sources, SOURCES, together));
    for (size_t s = 0; s < SOURCES; s++) {
        float *alone = distances_from(surface, both, sources[s][0], sources[s][1], sources[s][2]);
        assert_memory_equal(alone, together + s * both->vertex_count, both->vertex_count * sizeof(*alone));
        mem_free(alone);
    }
}

TEST(vertices_of_flat_triangles_take_their_neighbours_distance)
{
    struct cad *plate = test_cad();
    cad_plate(plate, &chance, 10, 10, 1, 1, 0);
    struct cad *with = test_cad();
    cad_append(with, plate, (double[3]){ 0, 0, 0 });
    const float lone[3] = { 0.55f, 0.5f, 0 };
    mem_grow(&with->positions, &with->position_capacity, with->vertex_count + 1, sizeof(*with->positions));
    memcpy(with->positions[with->vertex_count++], lone, sizeof(lone));
    mem_grow(&with->triangles, &with->index_capacity, 3 * with->triangle_count + 3, sizeof(*with->triangles));
    uint32_t last = (uint32_t)with->vertex_count - 1;
    memcpy(with->triangles + 3 * with->triangle_count++, (const uint32_t[3]){ last, last, 0 }, 3 * sizeof(uint32_t));
    struct surface *surface = surface_of(with);
    float *distances = test_memory(distances_from(surface, with, 0, 0.5, 0));
    assert_float_equal(distances[last], 0.55, 1e-3);
    assert_int_equal(surface_report(surface)->degenerate_triangles, 1);
}

TEST(a_surface_without_area_is_refused)
{
    static const float line[3][3] = { { 0, 0, 0 }, { 1, 1, 1 }, { 2, 2, 2 } };
    static const uint32_t triangle[3] = { 0, 1, 2 };
    struct log *quiet = test_log();
    assert_null(surface_create(quiet, NULL, line, 3, triangle, 1, &(struct surface_params){ 0 }));
    assert_null(surface_create(quiet, NULL, line, 3, triangle, 0, &(struct surface_params){ 0 }));
}

/* A model so small that squares of its lengths are zero in floating point: the result may be anything, but the computation must
   end. */
TEST(a_speck_ends)
{
    static const float sizes[] = { 1e-15f, 1e-24f, 1e-30f };
    for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
        struct cad plate = { 0 };
        cad_plate(&plate, &chance, 10, 10, 1, 1, 0);
        for (size_t v = 0; v < plate.vertex_count; v++)
            for (int axis = 0; axis < 3; axis++)
                plate.positions[v][axis] *= sizes[i];
        const double source[1][3] = { { 0.41 * (double)sizes[i], 0.37 * (double)sizes[i], 0 } };
        struct surface *surface =
            surface_create(the_log, workers, (const float(*)[3])plate.positions, plate.vertex_count, plate.triangles, plate.triangle_count,
                           /* the spacing of sample points is so large that each search visits all triangles */
                           &(struct surface_params){ .spacing_m = 0.2 * (double)sizes[i] });
        assert_non_null(surface);
        float *distances = mem_array(plate.vertex_count, sizeof(*distances));
        surface_distances(surface, source, 1, distances);
        mem_free(distances);
        surface_destroy(&surface);
        cad_finish(&plate);
    }
}

TEST_GROUP(surface_case_set_up, surface_case_tear_down)

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Within a drawn triangle, the field is interpolated linearly between the corners. The reported bound of the resulting error is
   compared with the true error at random points, for the readings that make this error largest. */
#include "tests/support/test.h"

#include "base/math/vec.h"
#include "preprocess/influence/gaussian.h"
#include "preprocess/influence/influence_bend.h"
#include "tests/support/surface_case.h"

/* FEW, MANY: numbers of sensors; MANY gives more than one block of equations, and the last block is not full. PLACES: number of
   random points */
enum { FEW = 5, MANY = 70, PLACES = 4000, MOST = 400000 };
static const double DISC_M = 0.1, ON_SURFACE_M = 1e-6, FINER_M = 0.04;

struct bend_case { /* a shape with coarse triangles, and random points within these triangles at which the field is compared */
    struct cad shape;
    /* positions: those of the vertices, followed by those of the random points; facing: normals in the same order, used for the
       random points only */
    float (*positions)[3], (*facing)[3];
    uint32_t tri[PLACES];
    double weights[PLACES][3], normals[PLACES][3];
};

static void draw(struct bend_case *drawn)
{
    const size_t vertices = drawn->shape.vertex_count;
    drawn->positions = mem_array(vertices + PLACES, sizeof(*drawn->positions));
    drawn->facing = mem_array(vertices + PLACES, sizeof(*drawn->facing));
    memcpy(drawn->positions, drawn->shape.positions, vertices * sizeof(*drawn->positions));
    for (size_t i = 0; i < PLACES; i++) {
        double a = cad_random(&chance), b = cad_random(&chance), p[3][3];
        drawn->tri[i] = (uint32_t)(cad_random(&chance) * (double)drawn->shape.triangle_count) % (uint32_t)drawn->shape.triangle_count;
        a = a + b > 1 ? 1 - a : a, b = a + b > 1 ? 1 - b : b;
        const double w[3] = { 1 - a - b, a, b };
        for (int k = 0; k < 3; k++)
            drawn->weights[i][k] = fmax(w[k], 0);
        for (int axis = 0; axis < 3; axis++) {
            double at = 0;
            for (int k = 0; k < 3; k++) {
                p[k][axis] = (double)drawn->shape.positions[drawn->shape.triangles[3 * drawn->tri[i] + k]][axis];
                at += drawn->weights[i][k] * p[k][axis];
            }
            drawn->positions[vertices + i][axis] = (float)at;
        }
        vec_normal(p[0], p[1], p[2], drawn->normals[i]);
        for (int axis = 0; axis < 3; axis++)
            drawn->facing[vertices + i][axis] = (float)drawn->normals[i][axis];
    }
}

/* Adds a copy of another shape, moved by move_m, to the shape. */
static void join(struct cad *shape, const struct cad *other, const double move_m[3])
{
    const size_t vertices = shape->vertex_count + other->vertex_count, indices = 3 * (shape->triangle_count + other->triangle_count);
    mem_grow(&shape->positions, &shape->position_capacity, vertices, sizeof(*shape->positions));
    mem_grow(&shape->triangles, &shape->index_capacity, indices, sizeof(*shape->triangles));
    for (size_t v = 0; v < other->vertex_count; v++)
        for (int axis = 0; axis < 3; axis++)
            shape->positions[shape->vertex_count + v][axis] = other->positions[v][axis] + (float)move_m[axis];
    for (size_t i = 0; i < 3 * other->triangle_count; i++)
        shape->triangles[3 * shape->triangle_count + i] = (uint32_t)shape->vertex_count + other->triangles[i];
    shape->vertex_count = vertices;
    shape->triangle_count = indices / 3;
}

static void make_sphere(struct cad *shape)
{
    cad_sphere(shape, &chance, 7);
}

/* Makes a sphere and a box that intersects its wall, so that a part of each lies inside the other. */
static void make_crossing(struct cad *shape)
{
    struct cad *box = test_cad();
    const double move_m[3] = { 0.5 + 0.2 * cad_random(&chance), -0.3, -0.35 };
    cad_sphere(shape, &chance, 7);
    cad_box(box, &chance, 4, 3, 3, 0.2);
    join(shape, box, move_m);
}

/* Makes the sphere and the box with gaps in their meshes, which the surface's repair bridges. */
static void make_gaps(struct cad *shape)
{
    struct cad *clean = test_cad();
    make_crossing(clean);
    uint32_t *vertex_of = mem_array(clean->vertex_count, sizeof(*vertex_of));
    cad_break(shape, clean, CAD_GAPS, &chance, vertex_of);
    mem_free(vertex_of);
}

/* Returns the largest error at a point that any readings between MIN and MAX can cause, as a share of MAX - MIN. The error is
   largest if each reading is MAX or MIN, depending on the sign of its effect. */
static double worst_at(const struct bend_case *drawn, const struct influence *influence, size_t place, double around)
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

typedef bool solve_fn(struct influence *influence, const struct influence_task *task);

static bool solve_harmonic(struct influence *influence, const struct influence_task *task)
{
    return influence_conduct(influence, task, (double)INFINITY);
}

static bool solve_fin(struct influence *influence, const struct influence_task *task)
{
    return influence_conduct(influence, task, 0.3);
}

static bool solve_gp(struct influence *influence, const struct influence_task *task)
{
    return gaussian_solve(influence, task, &(struct gaussian_params){ 0.8, 0.1, 5 });
}

struct case_of {
    void (*make)(struct cad *shape);
    solve_fn *solve;
    double around;
    size_t sensors;
};

/* Compares the drawn field with a solution on much smaller triangles, which counts as exact. The difference may exceed the
   bound by the errors at the triangle's corners. */
static void compare_finer(const struct case_of *of, const struct bend_case *drawn, const struct surface *surface,
                          const double (*places_m)[3], const struct vertex_embedding *embedding, const float *errors)
{
    struct influence_mesh mesh;
    struct influence exact = { 0 };
    const size_t count = drawn->shape.vertex_count + PLACES;
    double worst = 0, beyond = 0, nearest = 0;
    size_t compared = 0, right = 0, unmarked = 0;
    assert_true(influence_mesh_init(&mesh, surface, places_m, of->sensors, DISC_M, FINER_M));
    struct influence_anchor *anchors = mem_array(count, sizeof(*anchors));
    influence_mesh_anchors(&mesh, embedding, count, anchors);
    assert_true(of->solve(&exact, &(struct influence_task){ the_log, workers, &mesh, anchors, count, NULL }));
    for (size_t i = 0; i < PLACES; i++) {
        struct surface_point hit;
        double place_m[3], bound = 0, found = worst_at(drawn, &exact, i, 0);
        for (int axis = 0; axis < 3; axis++)
            place_m[axis] = (double)drawn->positions[drawn->shape.vertex_count + i][axis];
        if (!surface_find_point_within(surface, place_m, drawn->normals[i], ON_SURFACE_M, &hit))
            continue;
        for (int k = 0; k < 3; k++)
            bound = fmax(bound, 255 * (double)errors[drawn->shape.triangles[3 * drawn->tri[i] + k]]);
        worst = fmax(worst, found);
        beyond = fmax(beyond, found - bound);
        nearest = fmax(nearest, found / fmax(bound, 0.1));
        compared++;
        unmarked += bound <= 1;
        right += found <= 1;
    }
    print_message("finer: off by %.2f steps at most, %.2f beyond what was said, %.2f times it; of %zu places %zu are right, %zu unmarked\n",
                  worst, beyond, nearest, compared, right, unmarked);
    assert_true(worst > 1 && beyond < 0.1);
    mem_free(anchors);
    influence_finish(&exact);
    influence_mesh_finish(&mesh);
}

static void holds(const struct case_of *of)
{
    struct bend_case drawn = { 0 };
    struct influence_mesh mesh;
    struct influence_bend bend;
    struct influence ours = { 0 }, truth = { 0 };
    struct bend_report report = { 0 };
    double places_m[MANY][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { -0.577, -0.577, 0.577 }, { 0.6, 0, -0.8 } };
    for (size_t s = FEW; s < of->sensors; s++)
        for (int axis = 0; axis < 3; axis++)
            places_m[s][axis] = 2 * cad_random(&chance) - 1;
    of->make(&drawn.shape);
    draw(&drawn);
    const size_t vertices = drawn.shape.vertex_count, triangles = drawn.shape.triangle_count;
    struct surface *surface = surface_of(&drawn.shape);
    assert_true(surface && influence_mesh_init(&mesh, surface, (const double(*)[3])places_m, of->sensors, DISC_M, 0.16));
    struct vertex_embedding *embedding =
        vertex_embedding_create(surface, (const float(*)[3])drawn.positions, (const float(*)[3])drawn.facing, vertices + PLACES,
                                drawn.shape.triangles, triangles);
    struct influence_anchor *anchors = mem_array(vertices + PLACES, sizeof(*anchors));
    influence_mesh_anchors(&mesh, embedding, vertices + PLACES, anchors);
    const struct bend_drawn on = { (const float(*)[3])drawn.shape.positions, drawn.shape.triangles, vertices, triangles, anchors, NULL, 0 };
    assert_true(influence_bend_init(&bend, &mesh, surface, &on, MOST));
    assert_true(of->solve(&truth, &(struct influence_task){ the_log, workers, &mesh, anchors, vertices + PLACES, NULL }));
    assert_true(of->solve(&ours, &(struct influence_task){ the_log, workers, &mesh, anchors, vertices, &bend }));
    for (size_t s = 0; s < of->sensors; s++)
        assert_memory_equal(ours.shares + s * vertices, truth.shares + s * (vertices + PLACES), vertices * sizeof(*ours.shares));
    float *steps = mem_array(triangles, sizeof(*steps)), *errors = mem_array(vertices, sizeof(*errors));
    influence_bend_measure(&bend, of->around, steps, errors, &report);
    compare_finer(of, &drawn, surface, (const double(*)[3])places_m, embedding, errors);
    double worst = 0, nearest = 0, whole_m2 = 0, hidden_m2 = 0;
    for (size_t i = 0; i < PLACES; i++) {
        struct surface_point hit;
        double place_m[3], found = worst_at(&drawn, &truth, i, of->around), bound = (double)steps[drawn.tri[i]];
        double area_m2 = vec_length(drawn.normals[i]);
        for (int axis = 0; axis < 3; axis++)
            place_m[axis] = (double)drawn.positions[vertices + i][axis];
        whole_m2 += area_m2;
        if (!surface_find_point_within(surface, place_m, drawn.normals[i], ON_SURFACE_M, &hit)) {
            hidden_m2 += surface_find_point_within(surface, place_m, drawn.normals[i], surface_report(surface)->tolerance_m, &hit)
                             ? 0
                             /* Sums the area of the points that are hidden inside the other body. Points near the surface count
                                0, because bridging of gaps may have moved them. */
                             : area_m2;
            continue;
        }
        worst = fmax(worst, found);
        nearest = fmax(nearest, bound > 0.01 ? found / bound : 0);
        if (found > bound + 0.02)
            fail_msg("a place is off by %.4f steps, and %.4f was said to be the most", found, bound);
    }
    print_message("said: %.3f steps; seen: %.3f; nearest to what was said of its triangle: %.3f; %zu places, hidden %.3f (%.3f of the "
                  "places), %.2g unknown\n",
                  report.steps, worst, nearest, bend.count, report.hidden_share, hidden_m2 / whole_m2, report.unknown_share);
    /* no error exceeds the reported bound; at some point the error is more than 80 % of the bound, and more than one colour
       step, so the test is a sharp one */
    assert_true(worst <= report.steps + 0.02 && nearest > 0.8 && worst > 1);
    assert_true(report.measured == 1 && report.unmeasured == 0 && report.over_share > 0);
    assert_true(report.unknown_share < 0.01 && fabs(report.hidden_share - hidden_m2 / whole_m2) < 0.04);
    assert_true(of->make == make_sphere ? report.hidden_share == 0 && report.unknown_share == 0 : report.hidden_share > 0.02);
    mem_free(steps);
    mem_free(errors);
    mem_free(anchors);
    influence_finish(&ours);
    influence_finish(&truth);
    vertex_embedding_destroy(&embedding);
    influence_bend_finish(&bend);
    influence_mesh_finish(&mesh);
    mem_free(drawn.positions);
    mem_free(drawn.facing);
    cad_finish(&drawn.shape);
}

TEST(test_harmonic)
{
    holds(&(struct case_of){ make_sphere, solve_harmonic, 0, FEW });
    holds(&(struct case_of){ make_sphere, solve_harmonic, 0, MANY });
}

TEST(test_fin)
{
    holds(&(struct case_of){ make_sphere, solve_fin, 0.2, FEW });
}

TEST(test_gp)
{
    holds(&(struct case_of){ make_sphere, solve_gp, 0, FEW });
    holds(&(struct case_of){ make_sphere, solve_gp, 0, MANY });
}

TEST(test_parts_inside_each_other)
{
    holds(&(struct case_of){ make_crossing, solve_harmonic, 0, FEW });
    holds(&(struct case_of){ make_crossing, solve_gp, 0, MANY });
}

TEST(test_bridged_cracks)
{
    holds(&(struct case_of){ make_gaps, solve_fin, 0.2, FEW });
}

/* If drawn triangles do not lie on the prepared surface, their error must be reported as unknown. */
TEST(test_what_is_not_on_the_surface_is_unknown)
{
    const double places_m[1][3] = { { 1, 0, 0 } };
    struct cad *shape = test_cad();
    struct influence_mesh mesh;
    struct influence_bend bend;
    cad_sphere(shape, &chance, 5);
    struct surface *surface = surface_of(shape);
    assert_true(surface && influence_mesh_init(&mesh, surface, places_m, 1, DISC_M, (double)INFINITY));
    for (int axis = 0; axis < 3; axis++)
        shape->positions[shape->triangles[0]][axis] *= 1.2f;
    struct influence_anchor *anchors = test_memory(mem_array(shape->vertex_count, sizeof(*anchors)));
    const struct bend_drawn on = {
        (const float(*)[3])shape->positions, shape->triangles, shape->vertex_count, shape->triangle_count, anchors, NULL, 0
    };
    assert_true(influence_bend_init(&bend, &mesh, surface, &on, MOST));
    size_t unknown = 0;
    for (size_t t = 0; t < shape->triangle_count; t++) {
        bool moved = false;
        for (int k = 0; k < 3; k++)
            moved |= shape->triangles[3 * t + k] == shape->triangles[0];
        unknown += bend.unknown_m2[t] > 0;
        assert_true(moved ? bend.unknown_m2[t] > 0.5 * bend.area_m2[t] : bend.unknown_m2[t] == 0);
    }
    assert_true(unknown > 0 && unknown < shape->triangle_count / 4);
    influence_bend_finish(&bend);
    assert_false(influence_bend_init(&bend, &mesh, surface, &on, 10));
    influence_bend_finish(&bend);
    influence_mesh_finish(&mesh);
}

TEST_GROUP(surface_case_set_up, surface_case_tear_down)

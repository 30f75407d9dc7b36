/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Interpolation by heat conduction (influence of each sensor on each vertex), compared with formulas for a rod, a fin and a
   sphere. Also tests lost sensors and difficult positions. */
#include "tests/support/test.h"

#include "field/influence_fill.h"
#include "preprocess/influence/influence.h"
#include "tests/support/surface_case.h"

struct influence_case {
    struct cad shape;
    struct surface *surface;
    struct influence influence;
    float *errors; /* by vertex */
};

static void solve(struct influence_case *s, const double (*places_m)[3], size_t count, double disc_m, double decay_m)
{
    struct influence_mesh mesh;
    const size_t vertices = s->shape.vertex_count;
    if (!s->surface)
        s->surface = surface_of(&s->shape);
    struct vertex_embedding *embedding = vertex_embedding_create(s->surface, (const float(*)[3])s->shape.positions, NULL, vertices,
                                                                 s->shape.triangles, s->shape.triangle_count);
    struct influence_anchor *anchors = mem_array(vertices, sizeof(*anchors));
    assert_true(influence_mesh_init(&mesh, s->surface, places_m, count, disc_m, INFINITY));
    influence_mesh_anchors(&mesh, embedding, vertices, anchors);
    influence_finish(&s->influence);
    mem_free(s->errors);
    s->errors = mem_array(vertices, sizeof(*s->errors));
    struct influence_bend bend;
    const struct bend_drawn drawn = {
        (const float(*)[3])s->shape.positions, s->shape.triangles, vertices, s->shape.triangle_count, anchors, NULL, 0
    };
    assert_true(influence_bend_init(&bend, &mesh, s->surface, &drawn, 1000000));
    const struct influence_task task = { the_log, workers, &mesh, anchors, vertices, &bend };
    assert_true(influence_conduct(&s->influence, &task, decay_m));
    influence_bend_measure(&bend, 0, NULL, s->errors, &(struct bend_report){ 0 });
    influence_bend_finish(&bend);
    influence_mesh_finish(&mesh);
    mem_free(anchors);
    vertex_embedding_destroy(&embedding);
}

static void finish(struct influence_case *s)
{
    influence_finish(&s->influence);
    mem_free(s->errors);
    cad_finish(&s->shape);
}

/* Size of a strip that conducts heat like a rod, because each sensor's disc covers the strip's whole width. */
#define STRIP_M 10.0
#define WIDTH_M 0.1
#define DISC_M 0.1
static const double rod_places[3][3] = { { 1, 0.05, 0 }, { 5, 0.05, 0 }, { 9, 0.05, 0 } };

static void make_strip(struct influence_case *s)
{
    cad_plate(&s->shape, &chance, 200, 3, STRIP_M, WIDTH_M, 0);
}

/* half the length of the strip that a sensor's disc covers, averaged over the strip's width */
static const double covered_m = 0.0957;

TEST(test_rod_is_straight_between_sensors)
{
    struct influence_case s = { 0 };
    const double readings[3] = { 20, 100, 60 };
    make_strip(&s);
    solve(&s, rod_places, 3, DISC_M, (double)INFINITY);
    for (size_t v = 0; v < s.shape.vertex_count; v++) {
        double x = (double)s.shape.positions[v][0], expected = readings[2], from = x < 5 ? 1 : 5;
        double t = (x - from - covered_m) / (4 - 2 * covered_m);
        if (x < 1)
            expected = readings[0];
        else if (x < 9)
            expected = readings[x >= 5] + fmin(fmax(t, 0), 1) * (readings[1 + (x >= 5)] - readings[x >= 5]);
        if (fabs(influence_value(&s.influence, readings, v) - expected) > 0.6)
            fail_msg("at %g m: %g, expected %g", x, influence_value(&s.influence, readings, v), expected);
    }
    finish(&s);
}

/* In a fin (rod that loses heat to the air), the field between two sensors is a combination of sinh, and beyond the last sensor
   it falls exponentially: Incropera, Fundamentals of Heat and Mass Transfer, 3.6. */
TEST(test_fin_falls_by_its_decay_length)
{
    struct influence_case s = { 0 };
    const double decay_m = 0.8, readings[3] = { 80, 80, 80 };
    make_strip(&s);
    solve(&s, rod_places, 3, DISC_M, decay_m);
    for (size_t v = 0; v < s.shape.vertex_count; v++) {
        double x = (double)s.shape.positions[v][0], gap = 4 - 2 * covered_m, expected = 80;
        double from = fmod(x - 1, 4) - covered_m;
        if (x < 1 - covered_m) /* the strip's end is insulated */
            expected = 80 * cosh(x / decay_m) / cosh((1 - covered_m) / decay_m);
        else if (x > 9 + covered_m)
            expected = 80 * cosh((STRIP_M - x) / decay_m) / cosh((1 - covered_m) / decay_m);
        else if (x > 1 && from > 0 && from < gap)
            expected = 80 * (sinh(from / decay_m) + sinh((gap - from) / decay_m)) / sinh(gap / decay_m);
        if (fabs(influence_value(&s.influence, readings, v) - expected) > 0.8)
            fail_msg("at %g m: %g, expected %g", x, influence_value(&s.influence, readings, v), expected);
    }
    finish(&s);
}

/* Two sensors at the poles of a sphere, each a cap of constant temperature. Between them the exact temperature is linear in ln
   tan(theta / 2), where theta is the angle from the pole. */
TEST(test_sphere_between_caps)
{
    struct influence_case s = { 0 };
    const double disc_m = 0.1, cap = 2 * asin(disc_m / 2), places[2][3] = { { 0, 0, 1 }, { 0, 0, -1 } }, readings[2] = { 1, 0 };
    double worst = 0;
    cad_sphere(&s.shape, &chance, 20);
    solve(&s, places, 2, disc_m, (double)INFINITY);
    for (size_t v = 0; v < s.shape.vertex_count; v++) {
        double theta = acos(fmin(fmax((double)s.shape.positions[v][2], -1), 1));
        if (theta < 2 * cap || theta > M_PI - 2 * cap)
            continue;
        double expected = 0.5 + log(tan(theta / 2)) / (2 * log(tan(cap / 2)));
        worst = fmax(worst, fabs(influence_value(&s.influence, readings, v) - expected));
    }
    print_message("sphere: worst difference %.4f of what the caps differ by\n", worst);
    assert_true(worst < 0.003);
    finish(&s);
}

/* --- errors of the field drawn inside triangles --------------------------------------------------------------------------------- */

struct tally {
    /* in colour steps: worst: largest error at a point inside a triangle; beyond: largest excess of an error over the error
       reported at the triangle's corners */
    double worst, beyond;
    size_t compared, marked;
};

/* Compares random points inside triangles with the function `exact`, which returns NAN for points to skip. spread: range of the
   readings, for which the error is scaled. */
static void tally_places(const struct influence_case *s, const double *readings, double spread, double (*exact)(const double at[3]),
                         struct tally *tally)
{
    *tally = (struct tally){ 0 };
    for (int i = 0; i < 20000; i++) {
        const uint32_t *corners = s->shape.triangles + 3 * (size_t)(cad_random(&chance) * (double)s->shape.triangle_count);
        double a = cad_random(&chance), b = cad_random(&chance) * (1 - a), w[3] = { 1 - a - b, a, b }, at[3] = { 0 }, drawn = 0, error = 0;
        for (int k = 0; k < 3; k++) {
            for (int c = 0; c < 3; c++)
                at[c] += w[k] * (double)s->shape.positions[corners[k]][c];
            drawn += w[k] * influence_value(&s->influence, readings, corners[k]);
            error = fmax(error, (double)s->errors[corners[k]]);
        }
        double truth = exact(at);
        if (isnan(truth))
            continue;
        double off = fabs(drawn - truth) / spread;
        tally->worst = fmax(tally->worst, 255 * off);
        tally->beyond = fmax(tally->beyond, 255 * (off - error));
        tally->compared++;
        tally->marked += error > 1.0 / 255;
    }
}

/* Distance from the sensors within which points are not compared. Between the two points at this distance, the exact field of a
   fin is a sum of two sinh terms, which the field's values at these points determine. */
#define NEAR_M 0.4
static struct {
    /* decay_m: decay length of the fin; low, high: the field's values at x = 1 + NEAR_M and x = 5 - NEAR_M, between the sensors
       at x = 1 and 5 */
    double decay_m, low, high;
} fin;

static double exact_fin(const double at[3])
{
    double from = at[0] - 1 - NEAR_M, to = 5 - NEAR_M - at[0];
    if (from < 0 || to < 0)
        return NAN;
    return (fin.low * sinh(to / fin.decay_m) + fin.high * sinh(from / fin.decay_m)) / sinh((4 - 2 * NEAR_M) / fin.decay_m);
}

static double value_near(const struct influence_case *s, const double *readings, double x)
{
    size_t best = 0;
    for (size_t v = 1; v < s->shape.vertex_count; v++)
        if (fabs((double)s->shape.positions[v][0] - x) < fabs((double)s->shape.positions[best][0] - x))
            best = v;
    return influence_value(&s->influence, readings, best);
}

/* A fin on triangles that are short compared with its decay length must be accurate and not marked uncertain. On triangles that
   are too long it must be marked, even where the finite elements themselves are too large (decay length 0.2 m). */
TEST(test_fin_on_long_triangles_is_marked)
{
    static const struct {
        int across;
        double decay_m;
        bool marked;
    } cases[] = { { 200, 0.8, false }, { 10, 0.8, true }, { 5, 0.8, true }, { 200, 0.2, false }, { 25, 0.2, true }, { 5, 0.2, true } };
    const double readings[3] = { 80, 40, 80 };
    struct influence_case fine = { 0 };
    make_strip(&fine);
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        struct influence_case s = { 0 };
        struct tally tally;
        solve(&fine, rod_places, 3, DISC_M, cases[i].decay_m);
        fin.decay_m = cases[i].decay_m;
        fin.low = value_near(&fine, readings, 1 + NEAR_M);
        fin.high = value_near(&fine, readings, 5 - NEAR_M);
        cad_plate(&s.shape, &chance, cases[i].across, 1, STRIP_M, WIDTH_M, 0);
        solve(&s, rod_places, 3, DISC_M, cases[i].decay_m);
        tally_places(&s, readings, 80, exact_fin, &tally);
        print_message("fin of %g m on triangles of %g m: off by %.2f steps, %.2f beyond what is said; marked %zu of %zu\n",
                      cases[i].decay_m, STRIP_M / cases[i].across, tally.worst, tally.beyond, tally.marked, tally.compared);
        assert_true(tally.compared > 5000 && tally.beyond < 0.2);
        assert_true(cases[i].marked ? tally.worst > 10 && tally.marked > tally.compared / 2 : tally.worst < 1 && tally.marked == 0);
        finish(&s);
    }
    finish(&fine);
}

static double log_slope; /* slope of the exact temperature between the caps over ln tan(theta / 2), see exact_sphere() */

static double exact_sphere(const double at[3])
{
    double theta = acos(at[2] / sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]));
    return theta < 0.3 || theta > M_PI - 0.3 ? (double)NAN : 0.5 + log_slope * log(tan(theta / 2));
}

/* Spheres with coarse triangles show the field inexactly and must be marked uncertain. The reference slope comes from a fine
   sphere, because the effective size of the caps depends on the vertices within the sensors' discs. */
TEST(test_coarse_spheres_are_marked)
{
    const double places_m[2][3] = { { 0, 0, 1 }, { 0, 0, -1 } }, readings[2] = { 1, 0 };
    static const int cells[] = { 30, 12, 5 };
    for (int i = 0; i < 3; i++) {
        struct influence_case s = { 0 };
        struct tally tally;
        double up = 0, down = 0;
        cad_sphere(&s.shape, &chance, cells[i]);
        solve(&s, places_m, 2, 0.1, (double)INFINITY);
        for (size_t v = 0; v < s.shape.vertex_count; v++) {
            double theta = acos(fmin(fmax((double)s.shape.positions[v][2], -1), 1)), along = log(tan(theta / 2));
            if (theta < 0.5 || theta > M_PI - 0.5)
                continue;
            up += along * (influence_value(&s.influence, readings, v) - 0.5);
            down += along * along;
        }
        log_slope = up / down;
        tally_places(&s, readings, 1, exact_sphere, &tally);
        print_message("sphere of %d cells: off by %.2f steps, %.2f beyond what is said; marked %zu of %zu\n", cells[i], tally.worst,
                      tally.beyond, tally.marked, tally.compared);
        assert_true(tally.beyond < 0.2);
        assert_true(i == 0 ? tally.worst < 1 && tally.marked < tally.compared / 100 : tally.worst > 1);
        finish(&s);
    }
}

TEST(test_shares_are_those_of_an_average)
{
    struct influence_case s = { 0 };
    const double places[4][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { -0.577, -0.577, 0.577 } };
    cad_sphere(&s.shape, &chance, 16);
    solve(&s, places, 4, 0.05, (double)INFINITY);
    for (size_t v = 0; v < s.shape.vertex_count; v++) {
        const double ones[4] = { 1, 1, 1, 1 };
        for (size_t i = 0; i < 4; i++)
            assert_in_range((int)(1e4f * s.influence.shares[i * s.shape.vertex_count + v]), 0, 10001);
        assert_true(fabs(influence_value(&s.influence, ones, v) - 1) < 1e-4);
    }
    finish(&s);
}

TEST(test_readings_are_met)
{
    struct influence_case s = { 0 };
    const double places[2][3] = { { 1, 0, 0 }, { -1, 0, 0 } }, readings[2] = { 100, 0 };
    double best = 1;
    cad_sphere(&s.shape, &chance, 16);
    solve(&s, places, 2, 0.1, (double)INFINITY);
    for (size_t v = 0; v < s.shape.vertex_count; v++)
        if ((double)s.shape.positions[v][0] > 0.9999)
            best = fmin(best, fabs(influence_value(&s.influence, readings, v) - 100));
    assert_true(best < 0.01);
    finish(&s);
}

/* The field without a lost sensor's reading must equal the field of a plant that never had this sensor, except for a small
   effect of the lost sensor's disc, which still conducts. */
TEST(test_lost_sensor_leaves_the_field_of_the_others)
{
    struct influence_case all = { 0 }, others = { 0 };
    double readings[3] = { 20, 0, 60 };
    const double two[2][3] = { { 1, 0.05, 0 }, { 9, 0.05, 0 } };
    const uint8_t used[3] = { 1, 0, 1 };
    make_strip(&all);
    make_strip(&others);
    solve(&all, rod_places, 3, DISC_M, (double)INFINITY);
    solve(&others, two, 2, DISC_M, (double)INFINITY);
    struct influence_fill *fill = influence_fill_create(all.influence.precision, 3, used);
    influence_fill_values(fill, readings);
    assert_true(fabs(readings[1] - 40) < 0.1);
    for (size_t v = 0; v < all.shape.vertex_count; v++)
        assert_true(fabs(influence_value(&all.influence, readings, v) -
                    influence_value(&others.influence, (const double[2]){ 20, 60 }, v)) < 1.1);
    influence_fill_destroy(&fill);
    finish(&all);
    finish(&others);
}

TEST(test_two_sensors_at_one_place_share_it)
{
    struct influence_case s = { 0 };
    const double places[3][3] = { { 1, 0.05, 0 }, { 1, 0.05, 0 }, { 9, 0.05, 0 } };
    double readings[3] = { 20, 40, 60 };
    const uint8_t one_left[3] = { 1, 0, 1 };
    make_strip(&s);
    solve(&s, places, 3, DISC_M, (double)INFINITY);
    assert_true(fabs(influence_value(&s.influence, readings, 0) - 30) < 0.01); /* a corner beyond both */
    struct influence_fill *fill = influence_fill_create(s.influence.precision, 3, one_left);
    influence_fill_values(fill, readings);
    assert_true(fabs(readings[1] - 20) < 0.01 && fabs(influence_value(&s.influence, readings, 0) - 20) < 0.01);
    influence_fill_destroy(&fill);
    finish(&s);
}

TEST(test_one_sensor_and_bodies_apart)
{
    struct influence_case s = { 0 };
    const double places[1][3] = { { 0, 0, 1 } }, reading[1] = { 50 };
    cad_sphere(&s.shape, &chance, 10);
    const size_t own = s.shape.vertex_count;
    add_triangle_apart(&s.shape);
    solve(&s, places, 1, 0.05, (double)INFINITY);
    for (size_t v = 0; v < s.shape.vertex_count; v++)
        assert_true(fabs(influence_value(&s.influence, reading, v) - (v < own ? 50 : 0)) < 0.01);
    finish(&s);
}

/* Solves for so many sensors that there are several blocks of right-hand sides, of which the last is smaller. The result must
   be the same on one thread and on several, which use blocks of different size. */
TEST(test_many_sensors_are_solved_in_blocks)
{
    enum { MANY = 75 };
    struct influence_case s = { 0 };
    double places[MANY][3], ones[MANY];
    for (size_t i = 0; i < MANY; i++) { /* spreads the sensors evenly over the sphere, on a spiral from pole to pole */
        double z = 1 - (2 * (double)i + 1) / MANY, turn = 2.4 * (double)i, across = sqrt(1 - z * z);
        memcpy(places[i], (const double[3]){ across * cos(turn), across * sin(turn), z }, sizeof(places[i]));
        ones[i] = 1;
    }
    cad_sphere(&s.shape, &chance, 16);
    solve(&s, (const double(*)[3])places, MANY, 0.05, 0.5);
    const size_t shares = MANY * s.shape.vertex_count;
    float *threads = test_memory(mem_array(shares, sizeof(*threads)));
    memcpy(threads, s.influence.shares, shares * sizeof(*threads));
    struct workers *own = workers;
    workers = NULL;
    solve(&s, (const double(*)[3])places, MANY, 0.05, 0.5);
    workers = own;
    for (size_t i = 0; i < shares; i++)
        assert_true(fabs((double)(s.influence.shares[i] - threads[i])) < 1e-6);
    solve(&s, (const double(*)[3])places, MANY, 0.05, (double)INFINITY);
    for (size_t v = 0; v < s.shape.vertex_count; v++)
        assert_true(fabs(influence_value(&s.influence, ones, v) - 1) < 1e-4);
    finish(&s);
}

/* If all sensors of a body are lost, influence_fill_values() must set their values to 0. */
TEST(test_all_lost)
{
    const double precision[4] = { 1, -1, -1, 1 };
    double values[2] = { 7, 7 };
    struct influence_fill *fill = influence_fill_create(precision, 2, (const uint8_t[2]){ 0, 0 });
    influence_fill_values(fill, values);
    assert_true(values[0] == 0 && values[1] == 0);
    influence_fill_destroy(&fill);
}

TEST_GROUP(surface_case_set_up, surface_case_tear_down)

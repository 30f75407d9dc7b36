/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Interpolation by a Gaussian process, compared with the same results by dense algebra. The kernel is compared with an inverted
   matrix, and the weights with ordinary kriging that has one mean per body (Cressie, Statistics for Spatial Data, 3.2). Lost
   sensors are compared with leaving them out. Also tests difficult positions and numbers. */
#include "tests/support/test.h"

#include "base/math/vec.h"
#include "field/influence_fill.h"
#include "preprocess/influence/gaussian_covariance.h"
#include "preprocess/influence/gaussian_fit.h"
#include "surface/geodesic/laplacian.h"
#include "tests/support/surface_case.h"

struct gaussian_case {
    struct cad shape;
    struct surface *surface;
    struct influence_mesh mesh;
    struct influence_anchor *anchors;
    struct influence influence;
};

static void prepare(struct gaussian_case *s, const double (*places_m)[3], size_t count, double disc_m, double edge_m)
{
    const size_t vertices = s->shape.vertex_count;
    s->surface = surface_of(&s->shape);
    struct vertex_embedding *embedding = vertex_embedding_create(s->surface, (const float(*)[3])s->shape.positions, NULL, vertices,
                                                                 s->shape.triangles, s->shape.triangle_count);
    s->anchors = mem_array(vertices, sizeof(*s->anchors));
    assert_true(influence_mesh_init(&s->mesh, s->surface, places_m, count, disc_m, edge_m));
    influence_mesh_anchors(&s->mesh, embedding, vertices, s->anchors);
    vertex_embedding_destroy(&embedding);
}

/* Prepares the case with the shape's own triangles and without subdivision, so that the system of equations is small enough for
   dense algebra. */
static void prepare_coarse(struct gaussian_case *s, const double (*places_m)[3], size_t count, double disc_m)
{
    const struct cad *shape = &s->shape;
    struct influence_mesh *mesh = &s->mesh;
    *mesh = (struct influence_mesh){ .source_count = count };
    for (size_t v = 0; v < shape->vertex_count; v++) {
        const double point[3] = { (double)shape->positions[v][0], (double)shape->positions[v][1], (double)shape->positions[v][2] };
        trimesh_add_point(&mesh->mesh, point);
    }
    for (uint32_t t = 0; t < shape->triangle_count; t++)
        trimesh_add_tri(&mesh->mesh, shape->triangles[3 * t], shape->triangles[3 * t + 1], shape->triangles[3 * t + 2], t);
    intrinsic_init(&mesh->intrinsic, &mesh->mesh);
    mesh->discs = mem_array(count, sizeof(*mesh->discs));
    for (size_t i = 0; i < count; i++) {
        struct influence_disc *disc = &mesh->discs[i];
        disc->points = mem_array(shape->vertex_count, sizeof(*disc->points));
        disc->shares = mem_array(shape->vertex_count, sizeof(*disc->shares));
        for (uint32_t v = 0; v < shape->vertex_count; v++)
            if (vec_distance(mesh->mesh.points[v], places_m[i]) < disc_m)
                disc->points[disc->count++] = v;
        for (size_t k = 0; k < disc->count; k++)
            disc->shares[k] = 1 / (double)disc->count;
    }
    s->anchors = mem_array(shape->vertex_count, sizeof(*s->anchors));
    for (uint32_t v = 0; v < shape->vertex_count; v++)
        s->anchors[v] = (struct influence_anchor){ { v, v, v }, { 1, 0, 0 } };
}

static void solve(struct gaussian_case *s, struct gaussian_params params)
{
    influence_finish(&s->influence);
    const struct influence_task task = { the_log, workers, &s->mesh, s->anchors, s->shape.vertex_count, NULL };
    assert_true(gaussian_solve(&s->influence, &task, &params));
}

static void finish(struct gaussian_case *s)
{
    influence_finish(&s->influence);
    influence_mesh_finish(&s->mesh);
    mem_free(s->anchors);
    cad_finish(&s->shape);
}

static size_t nearest_vertex(const struct gaussian_case *s, const double place[3])
{
    size_t best = 0;
    double least = INFINITY;
    for (size_t v = 0; v < s->shape.vertex_count; v++) {
        double square = 0;
        for (int axis = 0; axis < 3; axis++)
            square += pow((double)s->shape.positions[v][axis] - place[axis], 2);
        best = square < least ? v : best;
        least = fmin(least, square);
    }
    return best;
}

/* --- plain algebra ----------------------------------------------------------------------------------------------------------- */

/* Solves a * x = b by Gaussian elimination with pivoting; the solution replaces b. columns: number of right-hand sides. */
static void gauss(size_t n, double *a, size_t columns, double *b)
{
    for (size_t k = 0; k < n; k++) {
        size_t pivot = k;
        for (size_t i = k + 1; i < n; i++)
            pivot = fabs(a[i * n + k]) > fabs(a[pivot * n + k]) ? i : pivot;
        for (size_t j = 0; j < n; j++) {
            double kept = a[k * n + j];
            a[k * n + j] = a[pivot * n + j];
            a[pivot * n + j] = kept;
        }
        for (size_t j = 0; j < columns; j++) {
            double kept = b[k * columns + j];
            b[k * columns + j] = b[pivot * columns + j];
            b[pivot * columns + j] = kept;
        }
        for (size_t i = 0; i < n; i++) {
            if (i == k || a[i * n + k] == 0)
                continue;
            double times = a[i * n + k] / a[k * n + k];
            for (size_t j = k + 1; j < n; j++)
                a[i * n + j] -= times * a[k * n + j];
            for (size_t j = 0; j < columns; j++)
                b[i * columns + j] -= times * b[k * columns + j];
        }
    }
    for (size_t k = 0; k < n; k++)
        for (size_t j = 0; j < columns; j++)
            b[k * columns + j] /= a[k * n + k];
}

struct dense {
    size_t rows, sensors;
    double *kernel;  /* by pair of vertices: their covariance for a deviation of 1, without the part that is constant on the body */
    double *sensing; /* [sensor][row] */
};

/* Makes the dense reference for a mesh whose sensors are all on one body. */
static void make_dense(struct dense *d, const struct influence_mesh *mesh, double range_m)
{
    struct laplacian laplacian;
    cholmod_common common;
    const double k2 = 8 / (range_m * range_m);
    double area_m2 = 0, mean = 0;
    assert_true(laplacian_init(&laplacian, &mesh->intrinsic));
    laplacian_start(&common);
    const size_t n = d->rows = laplacian.row_count;
    double *diagonal = mem_array(n, sizeof(*diagonal)), *a = mem_array(n * n, sizeof(*a)), *inverse = mem_array(n * n, sizeof(*inverse));
    for (size_t i = 0; i < n; i++) {
        diagonal[i] = k2 * laplacian.mass_m2[i];
        area_m2 += laplacian.mass_m2[i];
        inverse[i * (n + 1)] = 1;
    }
    cholmod_sparse *matrix = laplacian_assemble(&laplacian, diagonal, 1, &common);
    const int *first = matrix->p, *rows = matrix->i;
    for (size_t c = 0; c < n; c++)
        for (int at = first[c]; at < first[c + 1]; at++)
            a[(size_t)rows[at] * n + c] = a[c * n + (size_t)rows[at]] = ((double *)matrix->x)[at];
    gauss(n, a, n, inverse);
    d->kernel = mem_array(n * n, sizeof(*d->kernel));
    for (size_t i = 0; i < n; i++)
        for (size_t l = 0; l < n; l++)
            for (size_t j = 0; j < n; j++)
                d->kernel[i * n + j] += inverse[i * n + l] * laplacian.mass_m2[l] * inverse[l * n + j];
    for (size_t i = 0; i < n * n; i++)
        d->kernel[i] -= 1 / (k2 * k2 * area_m2);
    d->sensors = mesh->source_count;
    d->sensing = mem_array(d->sensors * n, sizeof(*d->sensing));
    for (size_t s = 0; s < d->sensors; s++)
        for (size_t i = 0; i < mesh->discs[s].count; i++)
            d->sensing[s * n + laplacian.row_of[mesh->discs[s].points[i]]] = mesh->discs[s].shares[i];
    for (size_t s = 0; s < d->sensors; s++)
        for (size_t i = 0; i < n; i++)
            for (size_t j = 0; d->sensing[s * n + i] > 0 && j < n; j++)
                mean += d->sensing[s * n + i] * d->sensing[s * n + j] * d->kernel[i * n + j] / (double)d->sensors;
    for (size_t i = 0; i < n * n; i++)
        d->kernel[i] /= mean;
    cholmod_free_sparse(&matrix, &common);
    cholmod_finish(&common);
    laplacian_finish(&laplacian);
    mem_free(diagonal);
    mem_free(a);
    mem_free(inverse);
}

static double covariance(const struct dense *d, const double *a, const double *b)
{
    double sum = 0;
    for (size_t i = 0; i < d->rows; i++)
        for (size_t j = 0; a[i] != 0 && j < d->rows; j++)
            sum += a[i] * b[j] * d->kernel[i * d->rows + j];
    return sum;
}

/* Predicts the value at a place by ordinary kriging from the sensors in `used`: sets their weights and returns the variance of
   the prediction error. place: weights of mesh vertices. */
static double krige(const struct dense *d, const struct gaussian_params *p, const uint8_t *used, const double *place, double *weights)
{
    const size_t n = d->sensors + 1;
    const double v = p->deviation * p->deviation;
    double *a = mem_array(n * n, sizeof(*a)), *b = mem_array(n, sizeof(*b)), *right = mem_array(n, sizeof(*right));
    for (size_t i = 0; i < d->sensors; i++) {
        for (size_t j = 0; j < d->sensors; j++)
            if (used[i] && used[j])
                a[i * n + j] = v * covariance(d, d->sensing + i * d->rows, d->sensing + j * d->rows) + (i == j) * p->noise * p->noise;
        if (!used[i])
            a[i * n + i] = 1;
        a[i * n + n - 1] = a[(n - 1) * n + i] = used[i];
        b[i] = right[i] = used[i] ? v * covariance(d, d->sensing + i * d->rows, place) : 0;
    }
    b[n - 1] = right[n - 1] = 1;
    gauss(n, a, 1, b);
    double variance = v * covariance(d, place, place);
    for (size_t i = 0; i < n; i++)
        variance -= b[i] * right[i];
    memcpy(weights, b, d->sensors * sizeof(*weights));
    mem_free(a);
    mem_free(b);
    mem_free(right);
    return variance;
}

static double *place_of(const struct dense *d, const struct gaussian_case *s, size_t vertex)
{
    struct laplacian laplacian;
    double *place = mem_array(d->rows, sizeof(*place));
    assert_true(laplacian_init(&laplacian, &s->mesh.intrinsic));
    for (int i = 0; i < 3; i++)
        place[laplacian.row_of[s->anchors[vertex].points[i]]] += (double)s->anchors[vertex].weights[i];
    laplacian_finish(&laplacian);
    return place;
}

/* --- against it -------------------------------------------------------------------------------------------------------------- */

enum { FEW = 5 };
static const double few_places[FEW][3] = { { 0.2, 0.3, 0 }, { 1.7, 0.2, 0 }, { 1.1, 0.8, 0 }, { 0.4, 0.9, 0 }, { 1.5, 0.7, 0 } };

TEST(test_agrees_with_a_dense_one)
{
    /* range in metres, noise and deviation; the last range, 40 m, is far longer than the body */
    static const struct gaussian_params cases[3] = { { 0.8, 0.5, 10 }, { 3, 0.1, 4 }, { 40, 0.2, 20 } };
    for (int c = 0; c < 3; c++) {
        struct gaussian_case s = { 0 };
        struct dense d = { 0 };
        uint8_t all[FEW], some[FEW];
        double weights[FEW], worst = 0, worst_share = 0;
        cad_plate(&s.shape, &chance, 17, 9, 2, 1, 0.3);
        prepare_coarse(&s, few_places, FEW, 0.2);
        solve(&s, cases[c]);
        make_dense(&d, &s.mesh, cases[c].range_m);
        memset(all, 1, FEW);
        memset(some, 1, FEW);
        some[1] = some[3] = 0;
        struct influence_fill *fill = influence_fill_create(s.influence.precision, FEW, some);
        for (size_t v = 0; v < s.shape.vertex_count; v += 3) {
            double *place = place_of(&d, &s, v), readings[FEW] = { 3, 0, -7, 0, 11 }, wanted = 0;
            double variance = krige(&d, &cases[c], all, place, weights), more = 0;
            for (size_t i = 0; i < FEW; i++)
                worst_share = fmax(worst_share, fabs(weights[i] - (double)s.influence.shares[i * s.shape.vertex_count + v]));
            worst = fmax(worst, fabs((double)s.influence.deviations[v] / sqrt(variance) - 1));
            double with = (double)s.influence.deviations[v], without = (double)s.influence.deviations[s.shape.vertex_count + v];
            double prior = cases[c].deviation * cases[c].deviation * covariance(&d, place, place), taken = fmax(prior - variance, 0);
            assert_true(fabs(without * without - with * with - taken) < 1e-3 * prior);
            double less = krige(&d, &cases[c], some, place, weights); /* reference for lost sensors: kriging without them */
            for (size_t i = 0; i < FEW; i++)
                wanted += readings[i] * weights[i];
            influence_fill_values(fill, readings);
            influence_fill_variances(fill, s.influence.shares + v, s.shape.vertex_count, 1, &more);
            assert_true(fabs(influence_value(&s.influence, readings, v) - wanted) < 1e-3);
            assert_true(fabs(variance + more - less) < 1e-3 * less);
            mem_free(place);
        }
        print_message("range %g: weights differ by %.1e, deviations by up to %.1f %%\n", cases[c].range_m, worst_share, 100 * worst);
        assert_true(worst_share < 1e-4);
        /* The deviations are estimated from 256 random samples, which gives them a standard error of 4.4 %. Four times that is
           allowed. */
        assert_true(worst < 4 * 0.044);
        influence_fill_destroy(&fill);
        mem_free(d.kernel);
        mem_free(d.sensing);
        finish(&s);
    }
}

/* The value of each sensor that the others predict must be its reading minus (P v)_i / P_ii, with variance 1 / P_ii. P:
   precision matrix, v: readings. */
TEST(test_precision_says_what_the_others_say)
{
    const struct gaussian_params p = { 0.8, 0.5, 10 };
    const double readings[FEW] = { 20, 35, 28, 22, 90 };
    struct gaussian_case s = { 0 };
    struct dense d = { 0 };
    cad_plate(&s.shape, &chance, 17, 9, 2, 1, 0.3);
    prepare_coarse(&s, few_places, FEW, 0.2);
    solve(&s, p);
    make_dense(&d, &s.mesh, p.range_m);
    for (size_t i = 0; i < FEW; i++) {
        uint8_t used[FEW] = { 1, 1, 1, 1, 1 };
        double weights[FEW], expected = 0, residual = 0;
        used[i] = 0;
        double variance = krige(&d, &p, used, d.sensing + i * d.rows, weights) + p.noise * p.noise;
        for (size_t j = 0; j < FEW; j++) {
            expected += weights[j] * readings[j];
            residual += s.influence.precision[i * FEW + j] * readings[j];
        }
        const double own = s.influence.precision[i * (FEW + 1)];
        assert_true(fabs(readings[i] - residual / own - expected) < 1e-4);
        assert_true(fabs(1 / own / variance - 1) < 1e-5);
    }
    mem_free(d.kernel);
    mem_free(d.sensing);
    finish(&s);
}

static void sphere_of(struct gaussian_case *s, const double (*places_m)[3], size_t count, struct gaussian_params params)
{
    cad_sphere(&s->shape, &chance, 16);
    prepare(s, places_m, count, 0.08, params.range_m / 5);
    solve(s, params);
}

/* If the readings come from a smooth field, the interpolated values must match them within the noise, and the weights of each
   vertex must sum to 1. */
TEST(test_readings_are_met_within_noise)
{
    enum { MANY = 40 };
    struct gaussian_case s = { 0 };
    double places[MANY][3], readings[MANY], ones[MANY];
    for (size_t i = 0; i < MANY; i++) { /* spreads the sensors evenly over a sphere, on a spiral from pole to pole */
        double z = 1 - (2 * (double)i + 1) / MANY, turn = 2.4 * (double)i, across = sqrt(1 - z * z);
        memcpy(places[i], (const double[3]){ across * cos(turn), across * sin(turn), z }, sizeof(places[i]));
        readings[i] = 50 + 20 * z + 10 * places[i][0];
        ones[i] = 1;
    }
    sphere_of(&s, (const double(*)[3])places, MANY, (struct gaussian_params){ 1, 0.5, 15 });
    for (size_t i = 0; i < MANY; i++) {
        size_t v = nearest_vertex(&s, places[i]);
        double there = 50 + 20 * (double)s.shape.positions[v][2] + 10 * (double)s.shape.positions[v][0];
        assert_true(fabs(influence_value(&s.influence, readings, v) - there) < 0.5);
        /* `untold` is the expected share of the variance that remains at the vertex nearest to the sensor, because a sensor is
           a disc and the vertex is not at its centre. The correlation is x K_1(x), approximated for small x. */
        double away = 0, x;
        for (int axis = 0; axis < 3; axis++)
            away += pow((double)s.shape.positions[v][axis] - places[i][axis], 2);
        x = sqrt(8) * (sqrt(away) + 0.08);
        double untold = 1 - pow(1 - x * x / 2 * (-log(x / 2) - 0.077), 2);
        assert_true((double)s.influence.deviations[v] < 1.3 * 15 * sqrt(untold));
    }
    for (size_t v = 0; v < s.shape.vertex_count; v++)
        assert_true(fabs(influence_value(&s.influence, ones, v) - 1) < 1e-5);
    finish(&s);
}

TEST(test_two_sensors_at_one_place_that_disagree)
{
    const double places[3][3] = { { 0, 0, 1 }, { 0, 0, 1 }, { 0, 0, -1 } }, readings[3] = { 20, 40, 60 };
    for (int i = 0; i < 2; i++) {
        struct gaussian_case s = { 0 };
        sphere_of(&s, places, 3, (struct gaussian_params){ 2, i ? 0.5 : 0, 10 }); /* also without noise */
        const double met = influence_value(&s.influence, readings, nearest_vertex(&s, places[0]));
        assert_true(fabs(met - 30) < 0.2);
        assert_true(fabs(influence_value(&s.influence, readings, nearest_vertex(&s, places[2])) - 60) < 0.2);
        finish(&s);
    }
}

/* A body with a single sensor gets that sensor's value everywhere, with a deviation that grows with the distance. A body
   without a sensor gets no value. */
TEST(test_one_sensor_and_bodies_apart)
{
    struct gaussian_case s = { 0 };
    const double places[1][3] = { { 0, 0, 1 } }, reading[1] = { 50 };
    cad_sphere(&s.shape, &chance, 16);
    const size_t own = s.shape.vertex_count;
    add_triangle_apart(&s.shape);
    prepare(&s, places, 1, 0.08, 0.2);
    solve(&s, (struct gaussian_params){ 1, 0.5, 10 });
    for (size_t v = 0; v < s.shape.vertex_count; v++)
        assert_true(fabs(influence_value(&s.influence, reading, v) - (v < own ? 50 : 0)) < 0.01);
    const double near = (double)s.influence.deviations[nearest_vertex(&s, places[0])];
    const double far = (double)s.influence.deviations[nearest_vertex(&s, (const double[3]){ 0, 0, -1 })];
    print_message("one sensor: deviation %.2f at it, %.2f at the other pole\n", near, far);
    /* Far from the sensor the deviation is about sqrt(2) times that of the process (10), because a single sensor does not
       determine the mean. */
    assert_true(near < 2 && far > 12 && far < 17);
    assert_true(s.influence.precision[0] < 1e-9);
    finish(&s);
}

TEST(test_all_in_a_line_and_a_kernel_longer_than_all)
{
    struct gaussian_case s = { 0 };
    double places[6][3] = { { 0 } }, readings[6];
    for (size_t i = 0; i < 6; i++) {
        places[i][0] = 0.1 + 0.36 * (double)i;
        places[i][1] = 0.5;
        readings[i] = 10 + 5 * (double)i;
    }
    cad_plate(&s.shape, &chance, 41, 21, 2, 1, 0.2);
    prepare(&s, (const double(*)[3])places, 6, 0.05, (double)INFINITY);
    solve(&s, (struct gaussian_params){ 20, 0.05, 10 });
    for (size_t v = 0; v < s.shape.vertex_count; v++)
        assert_true(influence_value(&s.influence, readings, v) > 5 && influence_value(&s.influence, readings, v) < 40);
    for (size_t i = 0; i < 6; i++)
        assert_true(fabs(influence_value(&s.influence, readings, nearest_vertex(&s, places[i])) - readings[i]) < 1);
    finish(&s);
}

TEST(test_threads_change_nothing)
{
    struct gaussian_case s = { 0 };
    cad_plate(&s.shape, &chance, 41, 21, 2, 1, 0.2);
    prepare(&s, few_places, FEW, 0.15, (double)INFINITY);
    solve(&s, (struct gaussian_params){ 1, 0.2, 10 });
    struct influence first = s.influence;
    s.influence = (struct influence){ 0 };
    struct workers *own = workers;
    workers = NULL;
    solve(&s, (struct gaussian_params){ 1, 0.2, 10 });
    workers = own;
    assert_memory_equal(first.deviations, s.influence.deviations, s.shape.vertex_count * sizeof(*first.deviations));
    assert_memory_equal(first.shares, s.influence.shares, FEW * s.shape.vertex_count * sizeof(*first.shares));
    influence_finish(&first);
    finish(&s);
}

/* The sensors' covariance, which is computed without solving an equation for each sensor, is compared with dense algebra.
   Ranges are from a tenth of the plate's size to ten times that size. */
TEST(test_covariance_agrees_with_a_dense_one)
{
    static const double ranges_m[4] = { 0.25, 0.8, 3, 20 };
    struct gaussian_case s = { 0 };
    struct gaussian_covariance found;
    cad_plate(&s.shape, &chance, 17, 9, 2, 1, 0.3);
    prepare_coarse(&s, few_places, FEW, 0.2);
    assert_true(gaussian_covariance_init(&found, the_log, &s.mesh));
    for (int r = 0; r < 4; r++) {
        struct dense d = { 0 };
        double worst = 0;
        make_dense(&d, &s.mesh, ranges_m[r]);
        assert_true(gaussian_covariance_find(&found, the_log, r % 2 ? workers : NULL, ranges_m[r]));
        for (size_t i = 0; i < FEW; i++)
            for (size_t j = 0; j < FEW; j++) {
                double expected = covariance(&d, d.sensing + i * d.rows, d.sensing + j * d.rows);
                worst = fmax(worst, fabs(found.values[i * FEW + j] - expected));
            }
        print_message("range %g m: covariances %.1e off at most\n", ranges_m[r], worst);
        assert_true(worst < 2e-4);
        mem_free(d.kernel);
        mem_free(d.sensing);
    }
    gaussian_covariance_finish(&found);
    finish(&s);
}

/* --- fitting ----------------------------------------------------------------------------------------------------------------- */

static double gaussian(void)
{
    return sqrt(-2 * log(1 - cad_random(&chance))) * cos(2 * M_PI * cad_random(&chance));
}

/* Draws random readings from a process with range 0.7, deviation 6 and noise 0.8, and fits the parameters to them: they must be
   nearly these. The sensors stand in close pairs, because only close neighbours distinguish noise from a rough field. */
TEST(test_fit_finds_what_made_the_readings)
{
    enum { SENSORS = 24, INSTANTS = 200 };
    struct gaussian_case s = { 0 };
    struct readings_table table = { .count = SENSORS, .instants = INSTANTS };
    struct gaussian_covariance kernel;
    double places[SENSORS][3] = { { 0 } }, *root;
    char why[300];
    for (size_t i = 0; i < SENSORS; i++) {
        places[i][0] = i % 2 ? places[i - 1][0] + 0.02 : 1.97 * cad_random(&chance);
        places[i][1] = i % 2 ? places[i - 1][1] : cad_random(&chance);
    }
    cad_plate(&s.shape, &chance, 31, 16, 2, 1, 0.2);
    prepare(&s, (const double(*)[3])places, SENSORS, 0.03, 0.05);
    assert_true(gaussian_covariance_init(&kernel, the_log, &s.mesh));
    assert_true(gaussian_covariance_find(&kernel, the_log, workers, 0.7));
    root = mem_array(SENSORS * SENSORS, sizeof(*root));
    for (size_t i = 0; i < SENSORS; i++)
        for (size_t j = 0; j <= i; j++) {
            double sum = kernel.values[i * SENSORS + j] + (i == j) * 1e-9;
            for (size_t k = 0; k < j; k++)
                sum -= root[i * SENSORS + k] * root[j * SENSORS + k];
            root[i * SENSORS + j] = i == j ? sqrt(sum) : sum / root[j * SENSORS + j];
        }
    table.values = mem_array(SENSORS * INSTANTS, sizeof(*table.values));
    for (size_t t = 0; t < INSTANTS; t++) {
        double z[SENSORS];
        for (size_t i = 0; i < SENSORS; i++)
            z[i] = gaussian();
        for (size_t i = 0; i < SENSORS; i++) {
            double sum = 300 + 0.1 * (double)t;
            for (size_t k = 0; k <= i; k++)
                sum += 6 * root[i * SENSORS + k] * z[k];
            table.values[t * SENSORS + i] = sum + 0.8 * gaussian();
        }
    }
    struct gaussian_params p = { (double)NAN, (double)NAN, (double)NAN }, stated = { 0.7, (double)NAN, 6 };
    const struct gaussian_data data = { the_log, workers, &s.mesh, &table };
    assert_true(gaussian_fit(&p, &data, 0.1, 6, why));
    print_message("fitted: range %.3f (0.7), noise %.3f (0.8), deviation %.3f (6)\n", p.range_m, p.noise, p.deviation);
    assert_true(p.range_m > 0.55 && p.range_m < 0.9);
    assert_true(p.noise > 0.7 && p.noise < 0.9);
    assert_true(p.deviation > 4.8 && p.deviation < 7.5);
    assert_true(gaussian_fit(&stated, &data, 0.1, 6, why));
    assert_true(stated.range_m == 0.7 && fabs(stated.deviation - 6) < 1e-9 && stated.noise > 0.7 && stated.noise < 0.9);
    /* stated parameters stay as they are, to the last bit: exp(log(3)) is not 3, and 0.9 / 7 * 7 is not 0.9 */
    const struct gaussian_params exact[] = { { 3, (double)NAN, (double)NAN }, { 0.7, 0, (double)NAN }, { (double)NAN, 0.9, 7 } };
    for (size_t i = 0; i < sizeof(exact) / sizeof(*exact); i++) {
        stated = exact[i];
        if (!gaussian_fit(&stated, &data, 0.1, 6, why))
            fail_msg("%zu: %s", i, why);
        assert_true(isnan(exact[i].range_m) || stated.range_m == exact[i].range_m);
        assert_true(isnan(exact[i].noise) || stated.noise == exact[i].noise);
        assert_true(isnan(exact[i].deviation) || stated.deviation == exact[i].deviation);
        assert_true(stated.range_m > 0 && stated.noise >= 0 && stated.deviation > 0);
    }
    table.count = 2;
    assert_false(gaussian_fit(&p, &data, 0.1, 6, why));
    readings_table_finish(&table);
    gaussian_covariance_finish(&kernel);
    mem_free(root);
    finish(&s);
}

static void expect_table(const char *folder, const char *text, const char *wrong)
{
    static const char *const names[2] = { "TI-1", "TI-2" };
    struct readings_table table;
    char why[300], *path = temp_write(folder, "readings.csv", text, strlen(text));
    bool good = readings_table_read(&table, path, names, 2, why);
    assert_int_equal(good, !wrong);
    if (good) {
        assert_int_equal(table.instants, 8);
        assert_int_equal(table.left_out, 2);
        assert_true(table.values[0] == 2.5 && table.values[1] == 1 && table.values[15] == 8);
    } else if (!strstr(why, wrong))
        fail_msg("%s", why);
    readings_table_finish(&table);
}

TEST(test_tables)
{
    char *folder = temp_folder();
    expect_table(folder,
                 "\xef\xbb\xbf"
                 "time,\"TI-2\",other, TI-1\r\n"
                 "0,1,x,2.5\r\n1,2,x,2\n2,,x,2\n3,bad,x,2\n4,3,,2\n5,4,,2\n6,5,,2\n7,6,,2\n8,7,,2\n9,8,,2\n",
                 NULL);
    expect_table(folder, "time;TI-2;TI-3\n", "line 1: no column 'TI-1'");
    expect_table(
        folder, "TI-1,TI-2\n1,2\n",
        "only 1 lines of this `fit` file have a value for each of the 2 sensors, 0 lines do not; the fit of `gp` needs at least 8");
    expect_table(
        folder, "TI-1;TI-2\n1,5;2,5\n2,5;3\n",
        "only 0 lines of this `fit` file have a value for each of the 2 sensors, 2 lines do not; the fit of `gp` needs at least 8");
    expect_table(folder, "TI-1,TI-2\n1,2\n1,5,2,5\n", "line 3: the row has a cell 3, but the header has only 2 columns");
    expect_table(folder, "", "is empty");
}

TEST_GROUP(surface_case_set_up, surface_case_tear_down)

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves the Gaussian process (letters: gaussian.h) with one sparse factorisation of k^2 C + G, two solves per sensor and one
 * per random sample. All other algebra is dense. */
#include "preprocess/influence/gaussian.h"

#include <cblas.h>
#include <math.h>
#include <stdatomic.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "preprocess/influence/gaussian_bodies.h"
#include "preprocess/influence/gaussian_contrast.h"
#include "surface/geodesic/laplacian.h"
#include "surface/geodesic/solver.h"

#define BLOCK 32 /* number of right-hand sides per solve; fixed, so that random samples do not depend on the thread count */
#define TILE 256 /* number of mesh points that one thread processes at a time */
#define STRIP 64 /* number of vertices that one thread processes at a time */
/* fixed-point scale for the sums of the samples' squared errors, in units of the squared standard deviation; unlike floating
 * point, integer sums do not depend on the order of addition */
#define FIXED 1e9
#define FIXED_MAX 1e7

struct solving {
    const struct influence_mesh *mesh;
    const struct influence_anchor *anchors;
    struct influence *influence;
    struct influence_bend *bend;
    struct gaussian_params params;
    struct laplacian laplacian;
    cholmod_factor *factor;
    struct gaussian_bodies bodies;
    double *covariance;  /* covariance between the sensors before scaling, [sensor][sensor] */
    double *root_mass_m; /* by row of the sparse system (one row per mesh point): square root of the point's area */
    double *root_scale;  /* by connected component: square root of scale[component] */
    /* by connected component: factor from the variance in the sparse system to the variance given in the plant file; 0: the
     * component has no sensor */
    double *scale;
    double *means;             /* by sensor: weight of its reading in the estimated mean of its body (connected component) */
    /* by sensor: smallest possible variance of a weighted mean of the readings on its body (mean_variance()) */
    double *levels;
    /* [mesh point][sensor]: first the "kernel": covariance of the interpolated quantity at the point with the sensor's reading;
       later replaced by the weights H of the readings */
    float *at_points;
    float *taken;              /* by vertex: variance of the interpolated quantity before any reading, minus that with all readings */
    _Atomic uint64_t *squares; /* by vertex: sum of the random samples' squared errors, in fixed point */
    atomic_bool failed;
};

/* --- the system -------------------------------------------------------------------------------------------------------------- */

static bool begin(struct solving *solving, cholmod_common *common)
{
    const struct trimesh *mesh = &solving->mesh->mesh;
    const size_t count = solving->mesh->source_count;
    const double k = sqrt(8) / solving->params.range_m;
    if (!laplacian_init(&solving->laplacian, &solving->mesh->intrinsic))
        return false;
    const struct laplacian *laplacian = &solving->laplacian;
    for (size_t r = 0; r < laplacian->row_count; r++)
        laplacian->mass_m2[r] = max_of(laplacian->mass_m2[r], 1e-30);
    gaussian_bodies_init(&solving->bodies, solving->mesh, laplacian);
    solving->scale = mem_array(mesh->point_count, sizeof(*solving->scale));
    solving->root_scale = mem_array(mesh->point_count, sizeof(*solving->root_scale));
    solving->root_mass_m = mem_array(laplacian->row_count, sizeof(*solving->root_mass_m));
    for (size_t r = 0; r < laplacian->row_count; r++)
        solving->root_mass_m[r] = sqrt(laplacian->mass_m2[r]);
    solving->means = mem_array(count, sizeof(*solving->means));
    solving->covariance = mem_try_array(count * count, sizeof(*solving->covariance));
    double *diagonal = mem_array(laplacian->row_count, sizeof(*diagonal));
    for (size_t r = 0; r < laplacian->row_count; r++)
        diagonal[r] = k * k * laplacian->mass_m2[r];
    cholmod_sparse *matrix = solving->covariance ? laplacian_assemble(laplacian, diagonal, 1, common) : NULL;
    mem_free(diagonal);
    solving->factor = matrix ? cholmod_analyze(matrix, common) : NULL;
    bool good = solving->factor && cholmod_factorize(matrix, solving->factor, common) && common->status == CHOLMOD_OK;
    cholmod_free_sparse(&matrix, common);
    return good;
}

static void finish(struct solving *solving, cholmod_common *common)
{
    cholmod_free_factor(&solving->factor, common);
    laplacian_finish(&solving->laplacian);
    gaussian_bodies_finish(&solving->bodies);
    mem_free(solving->scale);
    mem_free(solving->root_scale);
    mem_free(solving->root_mass_m);
    mem_free(solving->means);
    mem_free(solving->covariance);
    mem_free((void *)solving->squares);
    mem_free(solving->at_points);
    mem_free(solving->taken);
    mem_free(solving->levels);
}

static double on_disc(const struct solving *solving, size_t sensor, const double *u)
{
    const struct influence_disc *disc = &solving->mesh->discs[sensor];
    double sum = 0;
    for (size_t i = 0; i < disc->count; i++)
        sum += disc->shares[i] * u[solving->laplacian.row_of[disc->points[i]]];
    return sum;
}

static uint32_t body_of_vertex(const struct solving *solving, size_t vertex)
{
    return solving->bodies.component[solving->anchors[vertex].points[0]];
}

/* --- kernels ----------------------------------------------------------------------------------------------------------------- */

/* Returns the constant part of a body's prior covariance. Subtract it from each solution of the sparse system immediately:
 * subtracting it from later results would lose digits to cancellation. */
static double constant_of(const struct solving *solving, uint32_t body)
{
    const double k2 = 8 / (solving->params.range_m * solving->params.range_m);
    return gaussian_bodies_constant(&solving->bodies, body) / (k2 * k2);
}

static void take_covariance(const struct solving *solving, size_t sensor, const double *u)
{
    const size_t count = solving->mesh->source_count;
    const uint32_t body = solving->bodies.of_sensor[sensor];
    const double constant = constant_of(solving, body);
    for (size_t other = 0; other < count; other++)
        solving->covariance[sensor * count + other] = solving->bodies.of_sensor[other] == body ? on_disc(solving, other, u) - constant : 0;
}

/* Converts solutions u of the sparse system to kernels: the covariances of each mesh point with each sensor's reading. u has
 * one column for each of the `width` sensors from index `first` on. Subtracts the constant part. */
static void take_kernels(const struct solving *solving, size_t first, size_t width, const double *u)
{
    const size_t count = solving->mesh->source_count, rows = solving->laplacian.row_count;
    const uint32_t *component = solving->bodies.component, *body = solving->bodies.of_sensor + first;
    double constants[BLOCK];
    for (size_t k = 0; k < width; k++) {
        take_covariance(solving, first + k, u + k * rows);
        constants[k] = constant_of(solving, body[k]);
    }
    for (size_t p = 0; p < solving->mesh->mesh.point_count; p++) {
        const uint32_t row = solving->laplacian.row_of[p];
        for (size_t k = 0; k < width && row != TRIMESH_NONE; k++)
            solving->at_points[p * count + first + k] = component[p] == body[k] ? (float)(u[k * rows + row] - constants[k]) : 0;
    }
}

static void solve_kernels(void *arg, size_t begin, size_t end)
{
    struct solving *solving = arg;
    const size_t rows = solving->laplacian.row_count;
    struct solver solver;
    solver_init(&solver);
    for (size_t first = begin; first < end && !solving->failed; first += BLOCK) {
        size_t count = end - first < BLOCK ? end - first : BLOCK;
        double *b = solver_begin(&solver, rows, count);
        for (size_t k = 0; b && k < count; k++) {
            const struct influence_disc *disc = &solving->mesh->discs[first + k];
            for (size_t i = 0; i < disc->count; i++)
                b[k * rows + solving->laplacian.row_of[disc->points[i]]] += disc->shares[i];
        }
        const double *u = b ? solver_solve(&solver, solving->factor) : NULL;
        for (size_t k = 0; u && k < count; k++)
            for (size_t i = 0; i < rows; i++)
                b[k * rows + i] = u[k * rows + i] * solving->laplacian.mass_m2[i];
        u = u ? solver_solve(&solver, solving->factor) : NULL;
        if (u)
            take_kernels(solving, first, count, u);
        else
            solving->failed = true;
    }
    solver_finish(&solver);
}

/* --- influence H (weights of sensors) at mesh points, from kernels --------------------------------------------------------------- */

static double variance_of(const struct solving *solving, size_t sensor)
{
    return solving->params.deviation * solving->params.deviation * solving->scale[solving->bodies.of_sensor[sensor]];
}

/* Returns the smallest possible variance of a weighted mean of the readings on this sensor's body. That is the sensor's element
 * of S m (S: covariance of the readings, m: weights of the mean), which is equal for all sensors of a body. */
static double mean_variance(const struct solving *solving, size_t sensor)
{
    const size_t n = solving->influence->count;
    const double noise = max_of(solving->params.noise, solving->params.deviation * GAUSSIAN_LEAST_NOISE);
    double sum = noise * noise * solving->means[sensor];
    for (size_t j = 0; j < n; j++)
        sum += solving->params.deviation * solving->params.deviation * solving->covariance[sensor * n + j] * solving->means[j];
    return sum;
}

/* Replaces the kernels k (covariances with readings) of mesh points [begin * TILE, end * TILE) by the influence H = P k + m. P:
 * precision matrix; m: weights of the estimated mean. */
static void weigh_tiles(void *arg, size_t begin, size_t end)
{
    struct solving *solving = arg;
    const size_t n = solving->influence->count, points = solving->mesh->mesh.point_count;
    double *in = mem_array(n * TILE, sizeof(*in)), *out = mem_array(n * TILE, sizeof(*out));
    for (size_t tile = begin; tile < end; tile++) {
        const size_t first = tile * TILE, width = points - first < TILE ? points - first : TILE;
        float *at = solving->at_points + first * n;
        for (size_t p = 0; p < width; p++)
            for (size_t i = 0; i < n; i++)
                in[p * n + i] = variance_of(solving, i) * (double)at[p * n + i];
        cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, (int)width, (int)n, (int)n, 1, in, (int)n, solving->influence->precision,
                    (int)n, 0, out, (int)n);
        for (size_t p = 0; p < width; p++) {
            const uint32_t body = solving->bodies.component[first + p];
            for (size_t i = 0; i < n; i++)
                at[p * n + i] = body == solving->bodies.of_sensor[i] ? (float)(out[p * n + i] + solving->means[i]) : 0;
        }
    }
    mem_free(in);
    mem_free(out);
}

static void add_bends(void *arg, size_t begin, size_t end)
{
    struct solving *solving = arg;
    const size_t n = solving->influence->count;
    for (size_t first = begin; first < end; first += BEND_WIDTH)
        influence_bend_add(solving->bend, solving->at_points + first, n, end - first < BEND_WIDTH ? end - first : BEND_WIDTH);
}

/* --- influence H and standard deviation at vertices, from those at mesh points --------------------------------------------------- */

static void at_vertex(const struct solving *solving, size_t vertex, float *out)
{
    const struct influence_anchor *at = &solving->anchors[vertex];
    const size_t n = solving->influence->count;
    const float *a = solving->at_points + at->points[0] * n, *b = solving->at_points + at->points[1] * n;
    const float *c = solving->at_points + at->points[2] * n;
    for (size_t i = 0; i < n; i++)
        out[i] = at->weights[0] * a[i] + at->weights[1] * b[i] + at->weights[2] * c[i];
}

static void turn_to_shares(const struct solving *solving, size_t first, size_t width, const float *strip)
{
    const size_t n = solving->influence->count, vertices = solving->influence->vertex_count;
    for (size_t i = 0; i < n; i++)
        for (size_t v = 0; v < width; v++)
            solving->influence->shares[i * vertices + first + v] = strip[v * n + i];
}

/* Writes the kernels (covariances with each sensor's reading) at vertices [begin * STRIP, end * STRIP) to `shares`;
 * weigh_strips() then replaces them by H, the weights of the readings in the estimate at each vertex. */
static void keep_kernels(void *arg, size_t begin, size_t end)
{
    struct solving *solving = arg;
    const size_t n = solving->influence->count, vertices = solving->influence->vertex_count;
    float *strip_h = mem_array(n * STRIP, sizeof(*strip_h));
    for (size_t strip = begin; strip < end; strip++) {
        const size_t first = strip * STRIP, width = vertices - first < STRIP ? vertices - first : STRIP;
        for (size_t v = 0; v < width; v++)
            at_vertex(solving, first + v, strip_h + v * n);
        turn_to_shares(solving, first, width, strip_h);
    }
    mem_free(strip_h);
}

/* At vertices [begin * STRIP, end * STRIP), replaces the kernels k by H, and computes the variance removed by the readings: k'
 * P k + 2 m' k - m' S m (P: precision matrix, m: weights of the estimated mean, S: covariance of the readings). */
static void weigh_strips(void *arg, size_t begin, size_t end)
{
    struct solving *solving = arg;
    const size_t n = solving->influence->count, vertices = solving->influence->vertex_count;
    float *strip_h = mem_array(n * STRIP, sizeof(*strip_h));
    double *levels = mem_array(solving->mesh->mesh.point_count, sizeof(*levels));
    for (size_t i = 0; i < n; i++)
        levels[solving->bodies.of_sensor[i]] = solving->levels[i];
    for (size_t strip = begin; strip < end; strip++) {
        const size_t first = strip * STRIP, width = vertices - first < STRIP ? vertices - first : STRIP;
        double taken[STRIP] = { 0 };
        for (size_t v = 0; v < width; v++)
            at_vertex(solving, first + v, strip_h + v * n);
        for (size_t i = 0; i < n; i++) /* a vertex's influence H (weights of the sensors) is 0 for sensors of other bodies */
            for (size_t v = 0; v < width; v++)
                if (body_of_vertex(solving, first + v) == solving->bodies.of_sensor[i])
                    taken[v] += variance_of(solving, i) * (double)solving->influence->shares[i * vertices + first + v] *
                                ((double)strip_h[v * n + i] + solving->means[i]);
        for (size_t v = 0; v < width; v++)
            solving->taken[first + v] = (float)(taken[v] - levels[body_of_vertex(solving, first + v)]);
        turn_to_shares(solving, first, width, strip_h);
    }
    mem_free(strip_h);
    mem_free(levels);
}

static bool find_precision(struct solving *solving)
{
    const size_t n = solving->mesh->source_count;
    const double noise = max_of(solving->params.noise, GAUSSIAN_LEAST_NOISE * solving->params.deviation);
    const double variance = solving->params.deviation * solving->params.deviation;
    double log_det, *sum = mem_try_array(n * n, sizeof(*sum));
    for (size_t i = 0; sum && i < n * n; i++)
        sum[i] = variance * solving->covariance[i] + (i % (n + 1) == 0 ? noise * noise : 0);
    bool good = sum && gaussian_contrast(n, solving->bodies.of_sensor, sum, solving->influence->precision, solving->means, &log_det);
    mem_free(sum);
    return good;
}

/* --- standard error ---------------------------------------------------------------------------------------------------------- */

/* SplitMix64 (Steele, Lea & Flood, 2014), as a source of the random signs from which samples of the prior are made. Random
 * signs give the same variance as normally distributed numbers, with an estimation error no larger (Hutchinson, 1990). */
struct signs {
    uint64_t state, bits;
    int left;
};

static double next_sign(struct signs *signs)
{
    if (signs->left == 0) {
        uint64_t z = signs->state += 0x9e3779b97f4a7c15;
        z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
        z = (z ^ z >> 27) * 0x94d049bb133111eb;
        signs->bits = z ^ z >> 31;
        signs->left = 64;
    }
    double sign = signs->bits & 1 ? 1 : -1;
    signs->bits >>= 1;
    signs->left--;
    return sign;
}

/* Simulates readings: takes a random field u, drawn from the prior, and computes each sensor's reading in units of the standard
 * deviation. The readings are negated, because callers subtract the prediction from the field. To keep digits, first subtracts
 * each body's level (the value at its first sensor, returned in levels[component]); this does not change the prediction error.
 * */
static void take_readings(const struct solving *solving, const double *u, struct signs *signs, double *levels, float *readings)
{
    const size_t n = solving->mesh->source_count;
    const double noise = max_of(solving->params.noise / solving->params.deviation, GAUSSIAN_LEAST_NOISE);
    for (size_t i = n; i-- > 0;)
        levels[solving->bodies.of_sensor[i]] = on_disc(solving, i, u);
    for (size_t i = 0; i < n; i++) {
        double size = sqrt(solving->scale[solving->bodies.of_sensor[i]]);
        readings[i] = -(float)(size * (on_disc(solving, i, u) - levels[solving->bodies.of_sensor[i]]) + noise * next_sign(signs));
    }
}

struct gaussian_samples { /* one thread's buffers for a block of samples */
    float *missed;        /* random field of the simulation minus its prediction from the simulated readings, [mesh point][sample] */
    float *readings;      /* simulated readings, [sample][sensor] */
    double *levels;       /* by connected component: the current sample's value at the component's first sensor */
    struct solver solver;
};

static bool take_samples(const struct solving *solving, struct gaussian_samples *samples, size_t block)
{
    const size_t rows = solving->laplacian.row_count, n = solving->influence->count, points = solving->mesh->mesh.point_count;
    struct signs signs[BLOCK];
    double *b = solver_begin(&samples->solver, rows, BLOCK);
    for (size_t k = 0; b && k < BLOCK; k++) {
        signs[k] = (struct signs){ .state = (block * BLOCK + k) << 32 };
        for (size_t i = 0; i < rows; i++)
            b[k * rows + i] = solving->root_mass_m[i] * next_sign(&signs[k]);
    }
    const double *u = b ? solver_solve(&samples->solver, solving->factor) : NULL;
    for (size_t k = 0; u && k < BLOCK; k++) {
        take_readings(solving, u + k * rows, &signs[k], samples->levels, samples->readings + k * n);
        for (size_t p = 0; p < points; p++) {
            const uint32_t body = solving->bodies.component[p], row = solving->laplacian.row_of[p];
            samples->missed[p * BLOCK + k] =
                row == TRIMESH_NONE ? 0 : (float)(solving->root_scale[body] * (u[k * rows + row] - samples->levels[body]));
        }
    }
    return u != NULL;
}

/* Adds the squared prediction errors of the random samples to the sums at each vertex. */
static void add_squares(const struct solving *solving, const float *missed)
{
    for (size_t v = 0; v < solving->influence->vertex_count; v++) {
        const struct influence_anchor *at = &solving->anchors[v];
        const float *a = missed + at->points[0] * BLOCK, *b = missed + at->points[1] * BLOCK, *c = missed + at->points[2] * BLOCK;
        uint64_t sum = 0;
        for (size_t k = 0; k < BLOCK; k++) {
            double miss = (double)(at->weights[0] * a[k] + at->weights[1] * b[k] + at->weights[2] * c[k]);
            sum += (uint64_t)(min_of(miss * miss, FIXED_MAX) * FIXED);
        }
        atomic_fetch_add_explicit(&solving->squares[v], sum, memory_order_relaxed);
    }
}

/* Processes the blocks with indices [begin, end), each of BLOCK random samples. */
static void sample_blocks(void *arg, size_t begin, size_t end)
{
    struct solving *solving = arg;
    const size_t n = solving->influence->count, points = solving->mesh->mesh.point_count;
    struct gaussian_samples samples = { .missed = mem_try_array(BLOCK * points, sizeof(*samples.missed)),
                                        .readings = mem_array(BLOCK * n, sizeof(*samples.readings)),
                                        .levels = mem_array(points, sizeof(*samples.levels)) };
    solver_init(&samples.solver);
    bool good = samples.missed;
    for (size_t block = begin; good && block < end; block++) {
        good = take_samples(solving, &samples, block);
        if (good) {
            cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasTrans, (int)points, BLOCK, (int)n, 1, solving->at_points, (int)n,
                        samples.readings, (int)n, 1, samples.missed, BLOCK);
            add_squares(solving, samples.missed);
        }
    }
    if (!good)
        solving->failed = true;
    solver_finish(&samples.solver);
    mem_free(samples.missed);
    mem_free(samples.readings);
    mem_free(samples.levels);
}

static void find_deviations(struct solving *solving)
{
    struct influence *influence = solving->influence;
    for (size_t v = 0; v < influence->vertex_count; v++) {
        double square = (double)solving->squares[v] / (FIXED * GAUSSIAN_SAMPLES);
        bool known = solving->scale[body_of_vertex(solving, v)] > 0;
        double deviation = solving->params.deviation * (known ? sqrt(square) : 1), taken = known ? (double)solving->taken[v] : 0;
        influence->deviations[v] = (float)deviation;
        influence->deviations[influence->vertex_count + v] = (float)sqrt(deviation * deviation + max_of(taken, 0));
    }
}

/* --- the whole --------------------------------------------------------------------------------------------------------------- */

static bool allocate(struct solving *solving)
{
    struct influence *influence = solving->influence;
    const size_t count = influence->count, vertices = influence->vertex_count;
    influence->shares = mem_try_array(count * vertices, sizeof(*influence->shares));
    influence->precision = mem_try_array(count * count, sizeof(*influence->precision));
    influence->deviations = mem_try_array(2 * vertices + 1, sizeof(*influence->deviations));
    solving->at_points = mem_try_array(count * solving->mesh->mesh.point_count, sizeof(*solving->at_points));
    solving->taken = mem_try_array(vertices + 1, sizeof(*solving->taken));
    solving->levels = mem_array(count + 1, sizeof(*solving->levels));
    solving->squares = mem_try_array(vertices, sizeof(*solving->squares));
    return influence->shares && influence->precision && influence->deviations && solving->at_points && solving->squares && solving->taken;
}

static void weigh(struct solving *solving, struct workers *workers)
{
    const size_t points = solving->mesh->mesh.point_count, vertices = solving->influence->vertex_count;
    for (size_t i = 0; i < solving->influence->count; i++)
        solving->levels[i] = mean_variance(solving, i);
    for (size_t i = 0; i < points; i++)
        solving->root_scale[i] = sqrt(solving->scale[i]);
    workers_for(workers, (vertices + STRIP - 1) / STRIP, 32, keep_kernels, solving);
    workers_for(workers, (points + TILE - 1) / TILE, 8, weigh_tiles, solving);
    workers_for(workers, (vertices + STRIP - 1) / STRIP, 32, weigh_strips, solving);
    if (solving->bend)
        workers_for(workers, solving->influence->count, BEND_WIDTH, add_bends, solving);
    workers_for(workers, GAUSSIAN_SAMPLES / BLOCK, 1, sample_blocks, solving);
}

bool gaussian_solve(struct influence *influence, const struct influence_task *task, const struct gaussian_params *params)
{
    const struct influence_mesh *mesh = task->mesh;
    struct solving solving = { .influence = influence, .mesh = mesh, .anchors = task->anchors, .params = *params, .bend = task->bend };
    cholmod_common common;
    laplacian_start(&common);
    *influence = (struct influence){ .count = mesh->source_count, .vertex_count = task->vertex_count };
    bool good = allocate(&solving) && begin(&solving, &common);
    if (good)
        workers_for(task->workers, influence->count, BLOCK, solve_kernels, &solving);
    good = good && !solving.failed;
    if (good)
        gaussian_bodies_scale(&solving.bodies, influence->count, solving.covariance, solving.scale);
    good = good && find_precision(&solving);
    if (good)
        weigh(&solving, task->workers);
    good = good && !solving.failed;
    if (good)
        find_deviations(&solving);
    else
        log_err(task->log, "cannot compute the Gaussian process of %zu sensors on %zu surface points with range %g m: %s", influence->count,
                mesh->mesh.point_count, params->range_m,
                common.status == CHOLMOD_NOT_POSDEF ? "the equations for the asset's surface cannot be solved: check its model for "
                                                      "extremely thin triangles, and `range_m` (matrix not positive definite)"
                                                    : "out of memory");
    finish(&solving, &common);
    cholmod_finish(&common);
    return good;
}

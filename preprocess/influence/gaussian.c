/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One sparse factor of k^2 C + G; two solves for each sensor, one for each sample; the rest is dense. */
#include "preprocess/influence/gaussian.h"

#include <cblas.h>
#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "base/mem.h"
#include "base/vec.h"
#include "preprocess/influence/gaussian_bodies.h"
#include "preprocess/influence/gaussian_contrast.h"
#include "surface/geodesic/laplacian.h"
#include "surface/geodesic/solver.h"

#define BLOCK 32  /* right-hand sides solved together; also samples, so that these do not depend on how many threads there are */
#define TILE 256  /* vertices that a thread works on at once */
#define FIXED 1e9 /* steps of squares, as shares of the deviation's: whole numbers add up to the same in any order */
#define FIXED_MOST 1e7

struct solving {
    const struct influence_mesh *mesh;
    const struct influence_anchor *anchors;
    struct influence *influence;
    struct gaussian_params params;
    struct laplacian laplacian;
    cholmod_factor *factor;
    struct gaussian_bodies bodies;
    double *covariance;        /* [sensor][sensor], as the system gives it */
    double *scale;             /* by component: to that of the stated deviation; 0: no sensor */
    double *means;             /* by sensor: its weight in the mean of its body */
    double *levels;            /* by sensor: S m, of its body */
    float *taken;              /* by vertex: the variance that sensors take away */
    _Atomic uint64_t *squares; /* by vertex: of what samples miss */
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
    mem_free(solving->means);
    mem_free(solving->covariance);
    mem_free((void *)solving->squares);
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

static double at_vertex(const struct solving *solving, size_t vertex, const double *u)
{
    const struct influence_anchor *at = &solving->anchors[vertex];
    double sum = 0;
    for (int i = 0; i < 3; i++)
        sum += (double)at->weights[i] * u[solving->laplacian.row_of[at->points[i]]];
    return sum;
}

static uint32_t body_of_vertex(const struct solving *solving, size_t vertex)
{
    return solving->bodies.component[solving->anchors[vertex].points[0]];
}

/* --- the kernel of each sensor ----------------------------------------------------------------------------------------------- */

/* What is the same everywhere on the body is taken out here, where there are digits for it. */
static void take_kernel(const struct solving *solving, size_t sensor, const double *u)
{
    const size_t count = solving->mesh->source_count;
    const uint32_t body = solving->bodies.of_sensor[sensor];
    const double k2 = 8 / (solving->params.range_m * solving->params.range_m);
    const double constant = gaussian_bodies_constant(&solving->bodies, body) / (k2 * k2);
    for (size_t other = 0; other < count; other++)
        solving->covariance[sensor * count + other] = solving->bodies.of_sensor[other] == body ? on_disc(solving, other, u) - constant : 0;
    const size_t vertices = solving->influence->vertex_count;
    float *share = solving->influence->shares + sensor * vertices;
    for (size_t v = 0; v < vertices; v++)
        share[v] = body_of_vertex(solving, v) == body ? (float)(at_vertex(solving, v, u) - constant) : 0;
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
        for (size_t k = 0; u && k < count; k++)
            take_kernel(solving, first + k, u + k * rows);
        if (!u)
            solving->failed = true;
    }
    solver_finish(&solver);
}

static void over(struct workers *workers, size_t count, size_t grain, void (*body)(void *arg, size_t begin, size_t end), void *arg)
{
    if (workers)
        workers_for(workers, count, grain, body, arg);
    else
        body(arg, 0, count);
}

/* --- from kernels to influence ----------------------------------------------------------------------------------------------- */

/* H = P k + the weights in the mean, in place of k. Vertices [begin, end) in tiles. */
/* S m of a sensor, the same for all of its body: the least variance of a weighted mean of its readings. */
static double mean_variance(const struct solving *solving, size_t sensor)
{
    const size_t n = solving->influence->count;
    const double noise = max_of(solving->params.noise, solving->params.deviation * GAUSSIAN_LEAST_NOISE);
    double sum = noise * noise * solving->means[sensor];
    for (size_t j = 0; j < n; j++)
        sum += solving->params.deviation * solving->params.deviation * solving->covariance[sensor * n + j] * solving->means[j];
    return sum;
}

static void weigh_tiles(void *arg, size_t begin, size_t end)
{
    struct solving *solving = arg;
    struct influence *influence = solving->influence;
    const size_t n = influence->count, vertices = influence->vertex_count;
    const double variance = solving->params.deviation * solving->params.deviation;
    double *in = mem_array(n * TILE, sizeof(*in)), *out = mem_array(n * TILE, sizeof(*out));
    for (size_t tile = begin; tile < end; tile++) {
        const size_t first = tile * TILE, width = vertices - first < TILE ? vertices - first : TILE;
        for (size_t i = 0; i < n; i++)
            for (size_t v = 0; v < width; v++)
                in[i * TILE + v] =
                    variance * solving->scale[solving->bodies.of_sensor[i]] * (double)influence->shares[i * vertices + first + v];
        cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, (int)n, (int)width, (int)n, 1, influence->precision, (int)n, in, TILE, 0,
                    out, TILE);
        for (size_t v = 0; v < width; v++) { /* k' P k + 2 m' k - m' S m: what is left of the variance around the body's mean, less that */
            const uint32_t body = body_of_vertex(solving, first + v);
            double taken = 0;
            size_t of_body = n;
            for (size_t i = 0; i < n; i++)
                if (solving->bodies.of_sensor[i] == body) {
                    taken += in[i * TILE + v] * (out[i * TILE + v] + 2 * solving->means[i]);
                    of_body = i;
                }
            solving->taken[first + v] = of_body < n ? (float)(taken - solving->levels[of_body]) : 0;
        }
        for (size_t i = 0; i < n; i++)
            for (size_t v = 0; v < width; v++) {
                bool own = body_of_vertex(solving, first + v) == solving->bodies.of_sensor[i];
                influence->shares[i * vertices + first + v] = own ? (float)(out[i * TILE + v] + solving->means[i]) : 0;
            }
    }
    mem_free(in);
    mem_free(out);
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

/* --- how far it may err ------------------------------------------------------------------------------------------------------ */

/* SplitMix64 (Steele, Lea & Flood, 2014), two numbers of the normal distribution at a time (Box & Muller, 1958). */
struct normal {
    uint64_t state;
    double spare;
    bool has_spare;
};

static double uniform(struct normal *normal)
{
    uint64_t z = normal->state += 0x9e3779b97f4a7c15;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
    z = (z ^ z >> 27) * 0x94d049bb133111eb;
    return ((double)((z ^ z >> 31) >> 11) + 0.5) * 0x1p-53;
}

static double next_normal(struct normal *normal)
{
    normal->has_spare = !normal->has_spare;
    if (!normal->has_spare)
        return normal->spare;
    double radius = sqrt(-2 * log(uniform(normal))), turn = 2 * M_PI * uniform(normal);
    normal->spare = radius * sin(turn);
    return radius * cos(turn);
}

/* One field out of the prior (in shares of the deviation) at the vertices, and what the sensors read of it, negative. The constant of each
   body is of no matter: it is taken out at the first sensor, where there are digits for it. */
static void take_sample(const struct solving *solving, const double *u, struct normal *normal, float *field, float *readings)
{
    const size_t n = solving->mesh->source_count;
    double *level = mem_array(solving->mesh->mesh.point_count, sizeof(*level));
    const double noise = max_of(solving->params.noise / solving->params.deviation, GAUSSIAN_LEAST_NOISE);
    for (size_t i = n; i-- > 0;)
        level[solving->bodies.of_sensor[i]] = on_disc(solving, i, u);
    for (size_t i = 0; i < n; i++) {
        double size = sqrt(solving->scale[solving->bodies.of_sensor[i]]);
        readings[i] = -(float)(size * (on_disc(solving, i, u) - level[solving->bodies.of_sensor[i]]) + noise * next_normal(normal));
    }
    for (size_t v = 0; v < solving->influence->vertex_count; v++) {
        uint32_t body = body_of_vertex(solving, v);
        field[v] = (float)(sqrt(solving->scale[body]) * (at_vertex(solving, v, u) - level[body]));
    }
    mem_free(level);
}

static void add_squares(const struct solving *solving, const float *missed, size_t samples)
{
    const size_t vertices = solving->influence->vertex_count;
    for (size_t v = 0; v < vertices; v++) {
        uint64_t sum = 0;
        for (size_t k = 0; k < samples; k++) {
            double square = (double)missed[k * vertices + v] * (double)missed[k * vertices + v];
            sum += (uint64_t)(min_of(square, FIXED_MOST) * FIXED);
        }
        atomic_fetch_add_explicit(&solving->squares[v], sum, memory_order_relaxed);
    }
}

/* Blocks of samples [begin, end). */
static void sample_blocks(void *arg, size_t begin, size_t end)
{
    struct solving *solving = arg;
    const struct influence *influence = solving->influence;
    const size_t rows = solving->laplacian.row_count, n = influence->count, vertices = influence->vertex_count;
    float *fields = mem_try_array(BLOCK * vertices, sizeof(*fields)), *readings = mem_array(BLOCK * n, sizeof(*readings));
    struct solver solver;
    solver_init(&solver);
    double *b = solver_begin(&solver, rows, BLOCK);
    bool good = fields && b;
    for (size_t block = begin; good && block < end; block++) {
        struct normal normals[BLOCK];
        for (size_t k = 0; k < BLOCK; k++) {
            normals[k] = (struct normal){ .state = (block * BLOCK + k) << 32 };
            for (size_t i = 0; i < rows; i++)
                b[k * rows + i] = sqrt(solving->laplacian.mass_m2[i]) * next_normal(&normals[k]);
        }
        const double *u = solver_solve(&solver, solving->factor);
        good = u != NULL;
        for (size_t k = 0; good && k < BLOCK; k++)
            take_sample(solving, u + k * rows, &normals[k], fields + k * vertices, readings + k * n);
        if (good)
            cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, BLOCK, (int)vertices, (int)n, 1, readings, (int)n, influence->shares,
                        (int)vertices, 1, fields, (int)vertices);
        if (good)
            add_squares(solving, fields, BLOCK);
    }
    if (!good)
        solving->failed = true;
    solver_finish(&solver);
    mem_free(fields);
    mem_free(readings);
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

bool gaussian_solve(struct influence *influence, struct log *log, struct workers *workers, const struct influence_mesh *mesh,
                    const struct gaussian_params *params, const struct influence_anchor *anchors, size_t vertex_count)
{
    struct solving solving = { .influence = influence, .mesh = mesh, .anchors = anchors, .params = *params };
    const size_t count = mesh->source_count, tiles = (vertex_count + TILE - 1) / TILE;
    cholmod_common common;
    laplacian_start(&common);
    *influence = (struct influence){ .count = count, .vertex_count = vertex_count };
    influence->shares = mem_try_array(count * vertex_count, sizeof(*influence->shares));
    influence->precision = mem_try_array(count * count, sizeof(*influence->precision));
    influence->deviations = mem_try_array(2 * vertex_count + 1, sizeof(*influence->deviations));
    solving.taken = mem_try_array(vertex_count + 1, sizeof(*solving.taken));
    solving.levels = mem_array(count + 1, sizeof(*solving.levels));
    solving.squares = mem_try_array(vertex_count, sizeof(*solving.squares));
    bool good = influence->shares && influence->precision && influence->deviations && solving.squares && solving.taken;
    good = good && begin(&solving, &common);
    if (good)
        over(workers, count, BLOCK, solve_kernels, &solving);
    good = good && !solving.failed;
    if (good)
        gaussian_bodies_scale(&solving.bodies, count, solving.covariance, solving.scale);
    good = good && find_precision(&solving);
    if (good) {
        for (size_t i = 0; i < count; i++)
            solving.levels[i] = mean_variance(&solving, i);
        over(workers, tiles, 8, weigh_tiles, &solving);
        over(workers, GAUSSIAN_SAMPLES / BLOCK, 1, sample_blocks, &solving);
    }
    good = good && !solving.failed;
    if (good)
        find_deviations(&solving);
    else
        log_err(log, "Gaussian process between %zu sensors on %zu points, range %g m: %s", count, mesh->mesh.point_count, params->range_m,
                common.status == CHOLMOD_NOT_POSDEF ? "system is not positive definite" : "out of memory");
    finish(&solving, &common);
    cholmod_finish(&common);
    return good;
}

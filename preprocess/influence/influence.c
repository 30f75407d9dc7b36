/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves heat conduction between the sensors' discs on a surface: one sparse Cholesky factorisation, then solves for blocks of sensors. */
#include "preprocess/influence/influence.h"

#include <math.h>
#include <stdatomic.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "surface/geodesic/laplacian.h"
#include "surface/geodesic/solver.h"

/* contact conductance between a sensor's disc and the surface, relative to the surface's conductance; with this value, the
   interpolated value at a disc deviates from its reading by about 1e-5 of the difference between neighbouring readings */
#define CONTACT 1e5
/* added to the diagonal, as a share of the body's area, so that rounding does not make the matrix singular */
#define REGULARISATION 1e-9
/* minimum number of right-hand sides per solve; a larger number means that the sparse factor is read from memory less often */
#define MIN_BLOCK 8
#define MAX_BLOCK BEND_WIDTH
/* memory limit in bytes for a block of more than MIN_BLOCK right-hand sides (sensors solved at a time); each thread has three
   such blocks */
#define BLOCK_BYTES (64 << 20)

struct conduct {
    struct influence *influence;
    const struct influence_mesh *mesh;
    const struct influence_anchor *anchors;
    struct influence_bend *bend;
    struct laplacian laplacian;
    cholmod_factor *factor;
    size_t block; /* number of sensors (right-hand sides) solved at a time */
    atomic_bool failed;
};

/* Returns the diagonal of the linear system at each mesh point: heat loss of the surface (the equipment's metal wall) to the
   surroundings, plus contact conductance of the sensors' discs. */
static double *diagonal_of(const struct conduct *conduct, double decay_m)
{
    const struct laplacian *laplacian = &conduct->laplacian;
    const size_t points = conduct->mesh->mesh.point_count;
    double *diagonal = mem_array(laplacian->row_count, sizeof(*diagonal)), *area_m2 = mem_array(points, sizeof(*area_m2));
    uint32_t *component = mem_array(points, sizeof(*component));
    char *touched = mem_array(points, 1);
    double loss = isfinite(decay_m) ? 1 / (decay_m * decay_m) : 0;
    trimesh_components(&conduct->mesh->mesh, component);
    for (size_t p = 0; p < points; p++)
        if (laplacian->row_of[p] != TRIMESH_NONE)
            area_m2[component[p]] += laplacian->mass_m2[laplacian->row_of[p]];
    for (size_t s = 0; s < conduct->mesh->source_count; s++) {
        const struct influence_disc *disc = &conduct->mesh->discs[s];
        for (size_t i = 0; i < disc->count; i++)
            diagonal[laplacian->row_of[disc->points[i]]] += CONTACT * disc->shares[i];
        touched[component[disc->points[0]]] = 1;
    }
    /* if a body has no sensor, its temperature is undetermined and never shown; any positive diagonal makes the matrix regular */
    for (size_t p = 0; p < points; p++)
        if (laplacian->row_of[p] != TRIMESH_NONE)
            diagonal[laplacian->row_of[p]] +=
                laplacian->mass_m2[laplacian->row_of[p]] * (loss + (touched[component[p]] ? REGULARISATION : 1) / area_m2[component[p]]);
    mem_free(touched);
    mem_free(component);
    mem_free(area_m2);
    return diagonal;
}

static bool factor(struct conduct *conduct, double decay_m, cholmod_common *common)
{
    double *diagonal = diagonal_of(conduct, decay_m);
    cholmod_sparse *matrix = laplacian_assemble(&conduct->laplacian, diagonal, 1, common);
    mem_free(diagonal);
    conduct->factor = matrix ? cholmod_analyze(matrix, common) : NULL;
    bool good = conduct->factor && cholmod_factorize(matrix, conduct->factor, common) && common->status == CHOLMOD_OK;
    cholmod_free_sparse(&matrix, common);
    return good;
}

/* Stores a sensor's solution u: a column of H (weights of sensors at vertices) and a row of the precision matrix. */
static void take(const struct conduct *conduct, size_t sensor, const double *u)
{
    struct influence *influence = conduct->influence;
    const uint32_t *row_of = conduct->laplacian.row_of;
    float *share = influence->shares + sensor * influence->vertex_count;
    for (size_t v = 0; v < influence->vertex_count; v++) {
        const struct influence_anchor *at = &conduct->anchors[v];
        double sum = 0;
        for (int i = 0; i < 3; i++)
            sum += (double)at->weights[i] * u[row_of[at->points[i]]];
        share[v] = (float)max_of(sum, 0); /* a weight is never negative: replaces negative results, which are rounding errors, by 0 */
    }
    for (size_t other = 0; other < influence->count; other++) {
        const struct influence_disc *disc = &conduct->mesh->discs[other];
        double flux = 0;
        for (size_t i = 0; i < disc->count; i++)
            flux += disc->shares[i] * ((other == sensor) - u[row_of[disc->points[i]]]);
        influence->precision[sensor * influence->count + other] = CONTACT * flux;
    }
}

/* Passes the solutions of a block of sensors (one column each) at the mesh points to the measurement of interpolation errors
 * (influence_bend.h). */
static void add_bend(const struct conduct *conduct, const double *u, size_t count, float *at_points)
{
    const uint32_t *row_of = conduct->laplacian.row_of;
    const size_t rows = conduct->laplacian.row_count;
    for (size_t p = 0; p < conduct->mesh->mesh.point_count; p++)
        for (size_t k = 0; k < count && row_of[p] != TRIMESH_NONE; k++)
            at_points[p * count + k] = (float)u[k * rows + row_of[p]];
    influence_bend_add(conduct->bend, at_points, count, count);
}

/* Returns the number of sensors solved at a time. Memory limits it, and so does the number of sensors per thread, so that all
 * threads have work. */
static size_t block_of(const struct conduct *conduct, const struct workers *workers)
{
    const size_t threads = workers ? (size_t)workers_count(workers) : 1, each = (conduct->influence->count + threads - 1) / threads;
    size_t block = BLOCK_BYTES / (sizeof(double) * (conduct->laplacian.row_count + 1));
    block = block < MAX_BLOCK ? block : MAX_BLOCK;
    block = block < each ? block : each;
    return block > MIN_BLOCK ? block : MIN_BLOCK;
}

static void solve_some(void *arg, size_t begin, size_t end)
{
    struct conduct *conduct = arg;
    const size_t rows = conduct->laplacian.row_count;
    float *at_points = conduct->bend ? mem_try_array(conduct->mesh->mesh.point_count * conduct->block, sizeof(*at_points)) : NULL;
    struct solver solver;
    solver_init(&solver);
    if (conduct->bend && !at_points)
        conduct->failed = true;
    for (size_t first = begin; first < end && !conduct->failed; first += conduct->block) {
        size_t count = end - first < conduct->block ? end - first : conduct->block;
        double *b = solver_begin(&solver, rows, count);
        for (size_t k = 0; b && k < count; k++) {
            const struct influence_disc *disc = &conduct->mesh->discs[first + k];
            for (size_t i = 0; i < disc->count; i++)
                b[k * rows + conduct->laplacian.row_of[disc->points[i]]] += CONTACT * disc->shares[i];
        }
        const double *u = b ? solver_solve(&solver, conduct->factor) : NULL;
        for (size_t k = 0; u && k < count; k++)
            take(conduct, first + k, u + k * rows);
        if (u && conduct->bend)
            add_bend(conduct, u, count, at_points);
        if (!u)
            conduct->failed = true;
    }
    mem_free(at_points);
    solver_finish(&solver);
}

static void make_symmetric(struct influence *influence)
{
    for (size_t i = 0; i < influence->count; i++)
        for (size_t j = 0; j < i; j++) {
            double *a = &influence->precision[i * influence->count + j], *b = &influence->precision[j * influence->count + i];
            *a = *b = (*a + *b) / 2;
        }
}

bool influence_conduct(struct influence *influence, const struct influence_task *task, double decay_m)
{
    const struct influence_mesh *mesh = task->mesh;
    struct conduct conduct = { .influence = influence, .mesh = mesh, .anchors = task->anchors, .bend = task->bend };
    cholmod_common common;
    laplacian_start(&common);
    *influence = (struct influence){ .count = mesh->source_count, .vertex_count = task->vertex_count };
    influence->shares = mem_try_array(influence->count * task->vertex_count, sizeof(*influence->shares));
    influence->precision = mem_try_array(influence->count * influence->count, sizeof(*influence->precision));
    bool good = influence->shares && influence->precision && laplacian_init(&conduct.laplacian, &mesh->intrinsic) &&
                factor(&conduct, decay_m, &common);
    conduct.block = block_of(&conduct, task->workers);
    if (good)
        workers_for(task->workers, influence->count, conduct.block, solve_some, &conduct);
    good = good && !conduct.failed;
    if (good)
        make_symmetric(influence);
    else
        log_err(task->log, "cannot compute heat conduction between %zu sensors (%zu surface points): %s", influence->count,
                mesh->mesh.point_count,
                common.status == CHOLMOD_NOT_POSDEF ? "the equations for the asset's surface cannot be solved: check its model for "
                                                      "extremely thin triangles (matrix not positive definite)"
                                                    : "out of memory");
    cholmod_free_factor(&conduct.factor, &common);
    cholmod_finish(&common);
    laplacian_finish(&conduct.laplacian);
    return good;
}

void influence_finish(struct influence *influence)
{
    mem_free(influence->shares);
    mem_free(influence->precision);
    mem_free(influence->deviations);
    mem_free(influence->errors);
    *influence = (struct influence){ 0 };
}

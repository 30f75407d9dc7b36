/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Heat method (Crane, Weischedel, Wardetzky 2013) by sparse Cholesky factors. */
#include "surface/geodesic/heat.h"

#include <cblas.h>
#include <cholmod.h>
#include <float.h>
#include <math.h>
#include <pthread.h>
#include <string.h>

#include "base/mem.h"
#include "base/vec.h"

/* L alone is singular on every piece of surface; this much of M, in shares of the piece's area, moves distances by a millionth. */
#define REGULARISATION 1e-6

struct slope {               /* gradients of the three hat functions in the triangle's plane, and its area */
    double x1, y1, y2, area; /* of corner 1: (x1, y1), of corner 2: (0, y2), of corner 0: minus both */
};

struct heat {
    struct log *log;
    const struct intrinsic *in;
    double time_m2;
    uint32_t *row_of; /* point -> row, TRIMESH_NONE: no triangle */
    size_t row_count;
    struct slope *slopes;
    double *mass_m2;
    cholmod_factor *diffusion, *poisson;
    cholmod_common common;
};

static pthread_once_t blas_once = PTHREAD_ONCE_INIT;
static void blas_alone(void)
{
    openblas_set_num_threads(1); /* the workers share the cores; threads below them would fight */
}

static void number_rows(struct heat *heat)
{
    const struct intrinsic *in = heat->in;
    for (size_t i = 0; i < in->point_count; i++)
        heat->row_of[i] = TRIMESH_NONE;
    for (size_t t = 0; t < in->tri_count; t++)
        for (int i = 0; i < 3; i++)
            heat->row_of[in->points[t][i]] = 0;
    for (size_t i = 0; i < in->point_count; i++)
        if (heat->row_of[i] == 0)
            heat->row_of[i] = (uint32_t)heat->row_count++;
}

static void measure(struct heat *heat)
{
    const struct intrinsic *in = heat->in;
    for (size_t t = 0; t < in->tri_count; t++) {
        double x, y, a = in->lengths[t][0];
        intrinsic_layout(in->lengths[t], &x, &y);
        y = max_of(y, 1e-6 * a); /* a triangle that rounding made flat */
        heat->slopes[t] = (struct slope){ .x1 = 1 / a, .y1 = -x / (a * y), .y2 = 1 / y, .area = a * y / 2 };
        for (int i = 0; i < 3; i++)
            heat->mass_m2[heat->row_of[in->points[t][i]]] += a * y / 6;
    }
}

/* diag(mass) + stiffness * L, lower triangle. */
static cholmod_sparse *assemble(struct heat *heat, const double *mass, double stiffness)
{
    const struct intrinsic *in = heat->in;
    cholmod_triplet *list =
        cholmod_allocate_triplet(heat->row_count, heat->row_count, heat->row_count + 6 * in->tri_count, -1, CHOLMOD_REAL, &heat->common);
    if (!list)
        return NULL;
    int *rows = list->i, *columns = list->j;
    double *values = list->x;
    size_t n = 0;
    for (size_t i = 0; i < heat->row_count; i++, n++) {
        rows[n] = columns[n] = (int)i;
        values[n] = mass[i];
    }
    for (size_t t = 0; t < in->tri_count; t++) {
        const struct slope *s = &heat->slopes[t];
        const double gx[3] = { -s->x1, s->x1, 0 }, gy[3] = { -s->y1 - s->y2, s->y1, s->y2 };
        for (int i = 0; i < 3; i++)
            for (int j = 0; j <= i; j++, n++) {
                int a = (int)heat->row_of[in->points[t][i]], b = (int)heat->row_of[in->points[t][j]];
                rows[n] = a > b ? a : b;
                columns[n] = a > b ? b : a;
                values[n] = stiffness * s->area * (gx[i] * gx[j] + gy[i] * gy[j]);
                if (i != j && a == b) /* an edge from a point to itself, which flips can make: counts for both corners */
                    values[n] *= 2;
            }
    }
    list->nnz = n;
    cholmod_sparse *matrix = cholmod_triplet_to_sparse(list, n, &heat->common);
    cholmod_free_triplet(&list, &heat->common);
    return matrix;
}

/* Shares of each piece's own area. */
static double *regularisation(const struct heat *heat, const uint32_t *component)
{
    double *area_m2 = mem_array(heat->in->point_count, sizeof(*area_m2)), *share = mem_array(heat->row_count, sizeof(*share));
    for (size_t i = 0; i < heat->in->point_count; i++)
        if (heat->row_of[i] != TRIMESH_NONE)
            area_m2[component[i]] += heat->mass_m2[heat->row_of[i]];
    for (size_t i = 0; i < heat->in->point_count; i++)
        if (heat->row_of[i] != TRIMESH_NONE)
            share[heat->row_of[i]] = REGULARISATION * heat->mass_m2[heat->row_of[i]] / area_m2[component[i]];
    mem_free(area_m2);
    return share;
}

static bool factor(struct heat *heat, const uint32_t *component)
{
    double *share = regularisation(heat, component);
    cholmod_sparse *diffusion = assemble(heat, heat->mass_m2, heat->time_m2), *poisson = diffusion ? assemble(heat, share, 1) : NULL;
    mem_free(share);
    if (poisson) {
        heat->diffusion = cholmod_analyze(diffusion, &heat->common);
        heat->poisson = heat->diffusion ? cholmod_copy_factor(heat->diffusion, &heat->common) : NULL;
    }
    bool good = heat->poisson && cholmod_factorize(diffusion, heat->diffusion, &heat->common) && heat->common.status == CHOLMOD_OK &&
                cholmod_factorize(poisson, heat->poisson, &heat->common) && heat->common.status == CHOLMOD_OK;
    cholmod_free_sparse(&diffusion, &heat->common);
    cholmod_free_sparse(&poisson, &heat->common);
    return good;
}

struct heat *heat_create(struct log *log, const struct intrinsic *in, const uint32_t *component, double time_m2)
{
    struct heat *heat = mem_new(sizeof(*heat));
    *heat = (struct heat){ .log = log, .in = in, .time_m2 = time_m2 };
    pthread_once(&blas_once, blas_alone);
    cholmod_start(&heat->common);
    heat->common.print = 0;
    heat->common.final_ll = 1;
    heat->common.nmethods = 1;
    heat->common.method[0].ordering = CHOLMOD_AMD;
    heat->common.postorder = 1;
    heat->row_of = mem_try_array(in->point_count, sizeof(*heat->row_of));
    heat->slopes = mem_try_array(in->tri_count, sizeof(*heat->slopes));
    heat->mass_m2 = mem_try_array(in->point_count, sizeof(*heat->mass_m2));
    if (!heat->row_of || !heat->slopes || !heat->mass_m2)
        goto error;
    number_rows(heat);
    measure(heat);
    if (!factor(heat, component))
        goto error;
    return heat;
error:
    log_err(log, "heat method: %zu points, %zu triangles: %s", in->point_count, in->tri_count,
            heat->common.status == CHOLMOD_NOT_POSDEF ? "system is not positive definite" : "out of memory");
    heat_destroy(&heat);
    return NULL;
}

void heat_destroy(struct heat **heat_ptr)
{
    struct heat *heat = *heat_ptr;
    if (!heat)
        return;
    cholmod_free_factor(&heat->diffusion, &heat->common);
    cholmod_free_factor(&heat->poisson, &heat->common);
    cholmod_finish(&heat->common);
    mem_free(heat->row_of);
    mem_free(heat->slopes);
    mem_free(heat->mass_m2);
    mem_free(heat);
    *heat_ptr = NULL;
}

/* From heat to the weak divergence of its unit gradient, in place of `u`'s column: b_i = integral of grad psi_i . X. */
static void flow(const struct heat *heat, double *u, double *b)
{
    const struct intrinsic *in = heat->in;
    memset(b, 0, heat->row_count * sizeof(*b));
    for (size_t i = 0; i < heat->row_count; i++)
        u[i] = -log(max_of(u[i], DBL_MIN)); /* Varadhan: distance over the root of t */
    for (size_t t = 0; t < in->tri_count; t++) {
        const struct slope *s = &heat->slopes[t];
        const uint32_t r0 = heat->row_of[in->points[t][0]], r1 = heat->row_of[in->points[t][1]], r2 = heat->row_of[in->points[t][2]];
        double d1 = u[r1] - u[r0], d2 = u[r2] - u[r0];
        double x = d1 * s->x1, y = d1 * s->y1 + d2 * s->y2;
        double length = sqrt(x * x + y * y);
        if (length <= 0)
            continue;
        double scale = s->area / length, f1 = scale * (x * s->x1 + y * s->y1), f2 = scale * y * s->y2;
        b[r0] -= f1 + f2;
        b[r1] += f1;
        b[r2] += f2;
    }
}

bool heat_solve(const struct heat *heat, const struct heat_source *sources, size_t source_count, double *out)
{
    cholmod_common common;
    cholmod_dense *u = NULL, *d = NULL, *y = NULL, *e = NULL;
    cholmod_start(&common);
    common.print = 0;
    size_t n = heat->row_count;
    cholmod_dense *b = cholmod_zeros(n, source_count, CHOLMOD_REAL, &common);
    bool good = b != NULL;
    for (size_t s = 0; good && s < source_count; s++)
        for (int i = 0; i < 3; i++)
            ((double *)b->x)[s * n + heat->row_of[sources[s].points[i]]] += sources[s].weights[i];
    good = good && cholmod_solve2(CHOLMOD_A, heat->diffusion, b, NULL, &u, NULL, &y, &e, &common);
    for (size_t s = 0; good && s < source_count; s++)
        flow(heat, (double *)u->x + s * n, (double *)b->x + s * n);
    good = good && cholmod_solve2(CHOLMOD_A, heat->poisson, b, NULL, &d, NULL, &y, &e, &common);
    for (size_t s = 0; good && s < source_count; s++)
        for (size_t i = 0; i < heat->in->point_count; i++)
            out[s * heat->in->point_count + i] = heat->row_of[i] == TRIMESH_NONE ? 0 : ((double *)d->x)[s * n + heat->row_of[i]];
    if (!good)
        log_err(heat->log, "heat method: %zu sources on %zu points: out of memory", source_count, n);
    cholmod_free_dense(&b, &common);
    cholmod_free_dense(&u, &common);
    cholmod_free_dense(&d, &common);
    cholmod_free_dense(&y, &common);
    cholmod_free_dense(&e, &common);
    cholmod_finish(&common);
    return good;
}

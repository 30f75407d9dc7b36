/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Implements the heat method (Crane, Weischedel, Wardetzky 2013) for geodesic distances with sparse Cholesky factors. */
#include "surface/geodesic/heat.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "surface/geodesic/laplacian.h"
#include "surface/geodesic/solver.h"

/* Fraction used to make the Laplacian L regular: L alone is singular on each connected component of the surface. Adds the area
   matrix M, times this fraction, divided by the component's area. Distances change by only a millionth. */
#define REGULARISATION 1e-6

struct heat {
    struct log *log;
    const struct intrinsic *in;
    double time_m2;
    struct laplacian laplacian;
    cholmod_factor *diffusion, *poisson;
    cholmod_common common;
};

/* Returns the regularisation added to the diagonal element of each row of the heat method's matrices. It is REGULARISATION
   times the area at the row's point, divided by the area of the point's connected component. The caller frees the array. */
static double *regularisation(const struct heat *heat, const uint32_t *component)
{
    double *area_m2 = mem_array(heat->in->point_count, sizeof(*area_m2)), *share = mem_array(heat->laplacian.row_count, sizeof(*share));
    for (size_t i = 0; i < heat->in->point_count; i++)
        if (heat->laplacian.row_of[i] != TRIMESH_NONE)
            area_m2[component[i]] += heat->laplacian.mass_m2[heat->laplacian.row_of[i]];
    for (size_t i = 0; i < heat->in->point_count; i++)
        if (heat->laplacian.row_of[i] != TRIMESH_NONE)
            share[heat->laplacian.row_of[i]] = REGULARISATION * heat->laplacian.mass_m2[heat->laplacian.row_of[i]] / area_m2[component[i]];
    mem_free(area_m2);
    return share;
}

static bool factor(struct heat *heat, const uint32_t *component)
{
    double *share = regularisation(heat, component);
    const struct laplacian *of = &heat->laplacian;
    cholmod_sparse *diffusion = laplacian_assemble(of, of->mass_m2, heat->time_m2, &heat->common);
    cholmod_sparse *poisson = diffusion ? laplacian_assemble(of, share, 1, &heat->common) : NULL;
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
    laplacian_start(&heat->common);
    if (!laplacian_init(&heat->laplacian, in))
        goto error;
    if (!factor(heat, component))
        goto error;
    return heat;
error:
    log_err(log, "cannot prepare the heat method for a surface of %zu points and %zu triangles: %s", in->point_count, in->tri_count,
            heat->common.status == CHOLMOD_NOT_POSDEF ? "the equations for the asset's surface cannot be solved: check its model for "
                                                        "extremely thin triangles (matrix not positive definite)"
                                                      : "out of memory");
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
    laplacian_finish(&heat->laplacian);
    mem_free(heat);
    *heat_ptr = NULL;
}

/* Replaces the heat `u` by its logarithm, whose unit gradient is X. Then computes the weak divergence of X: b_i = integral of grad psi_i .
   X (psi_i: hat function of point i). */
static void flow(const struct heat *heat, double *u, double *b)
{
    const struct intrinsic *in = heat->in;
    memset(b, 0, heat->laplacian.row_count * sizeof(*b));
    for (size_t i = 0; i < heat->laplacian.row_count; i++)
        /* u[i] becomes about distance / sqrt(t), by Varadhan's formula, where t is the diffusion time */
        u[i] = -log(max_of(u[i], DBL_MIN));
    for (size_t t = 0; t < in->tri_count; t++) {
        const struct laplacian_slope *s = &heat->laplacian.slopes[t];
        const uint32_t r0 = heat->laplacian.row_of[in->points[t][0]], r1 = heat->laplacian.row_of[in->points[t][1]],
                       r2 = heat->laplacian.row_of[in->points[t][2]];
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
    struct solver solver;
    solver_init(&solver);
    size_t n = heat->laplacian.row_count;
    double *b = solver_begin(&solver, n, source_count);
    for (size_t s = 0; b && s < source_count; s++)
        for (int i = 0; i < 3; i++)
            b[s * n + heat->laplacian.row_of[sources[s].points[i]]] += sources[s].weights[i];
    double *u = b ? solver_solve(&solver, heat->diffusion) : NULL;
    for (size_t s = 0; u && s < source_count; s++)
        flow(heat, u + s * n, b + s * n);
    u = u ? solver_solve(&solver, heat->poisson) : NULL;
    for (size_t s = 0; u && s < source_count; s++)
        for (size_t i = 0; i < heat->in->point_count; i++)
            out[s * heat->in->point_count + i] = heat->laplacian.row_of[i] == TRIMESH_NONE ? 0 : u[s * n + heat->laplacian.row_of[i]];
    if (!u)
        log_err(heat->log, "cannot compute distances by the heat method from %zu sensors on %zu points: out of memory", source_count, n);
    solver_finish(&solver);
    return u != NULL;
}

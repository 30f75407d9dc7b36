/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves linear systems with cholmod_solve2(), and reuses its working memory from call to call. */
#include "surface/geodesic/solver.h"

#include <string.h>

#include "surface/geodesic/laplacian.h"

void solver_init(struct solver *solver)
{
    *solver = (struct solver){ 0 };
    laplacian_start(&solver->common);
}

double *solver_begin(struct solver *solver, size_t rows, size_t count)
{
    cholmod_dense *b = solver->b;
    if (b && b->nrow == rows && b->ncol == count) {
        memset(b->x, 0, rows * count * sizeof(double));
        return b->x;
    }
    cholmod_free_dense(&solver->b, &solver->common);
    solver->b = cholmod_zeros(rows, count, CHOLMOD_REAL, &solver->common);
    return solver->b ? solver->b->x : NULL;
}

double *solver_solve(struct solver *solver, cholmod_factor *factor)
{
    bool good = cholmod_solve2(CHOLMOD_A, factor, solver->b, NULL, &solver->x, NULL, &solver->y, &solver->e, &solver->common);
    return good ? solver->x->x : NULL;
}

void solver_finish(struct solver *solver)
{
    cholmod_free_dense(&solver->b, &solver->common);
    cholmod_free_dense(&solver->x, &solver->common);
    cholmod_free_dense(&solver->y, &solver->common);
    cholmod_free_dense(&solver->e, &solver->common);
    cholmod_finish(&solver->common);
}

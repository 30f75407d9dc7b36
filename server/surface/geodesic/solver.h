/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves linear systems with CHOLMOD factors, a block of right-hand sides at a time; reuses the working memory from block to
   block. Call from one thread at a time per solver; several solvers may use one factor simultaneously. */
#ifndef SURFACE_GEODESIC_SOLVER_H
#define SURFACE_GEODESIC_SOLVER_H
#include <stddef.h>
#include <cholmod.h>

struct solver {
    cholmod_common common;
    cholmod_dense *b, *x, *y, *e;
};

void solver_init(struct solver *solver);
/* Returns zeroed memory for `count` right-hand sides, as [right-hand side][row], which the caller fills in before solver_solve(). Valid
   until the next solver_begin(). NULL: out of memory. */
double *solver_begin(struct solver *solver, size_t rows, size_t count);
/* Solves for the right-hand sides that the caller wrote after solver_begin(). Returns the solutions, [right-hand side][row], valid until
 * the next call; the caller may modify them. NULL: out of memory. */
double *solver_solve(struct solver *solver, cholmod_factor *factor);
void solver_finish(struct solver *solver);

#endif

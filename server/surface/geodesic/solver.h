/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves with factors of CHOLMOD for one block of right-hand sides after the other, and keeps the room for it. Thread: one at a time; a
   factor may serve several solvers at once. */
#ifndef SURFACE_GEODESIC_SOLVER_H
#define SURFACE_GEODESIC_SOLVER_H
#include <stddef.h>
#include <cholmod.h>

struct solver {
    cholmod_common common;
    cholmod_dense *b, *x, *y, *e;
};

void solver_init(struct solver *solver);
/* Returns zeros for so many right-hand sides, [side][row], to be filled in; they stay as they are until the next call of this function.
   NULL: out of memory. */
double *solver_begin(struct solver *solver, size_t rows, size_t count);
/* Solves for them. Returns the solutions, [side][row], until the next call; the caller may change them. NULL: out of memory. */
double *solver_solve(struct solver *solver, cholmod_factor *factor);
void solver_finish(struct solver *solver);

#endif

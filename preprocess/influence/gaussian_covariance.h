/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the covariance between sensors that Gaussian process regression (gaussian.h) assumes before any reading. The range
 * is the correlation length in metres: at this distance, the correlation is about 0.14. Fitting tries one range after another;
 * each takes two sparse factorisations, but no solve per sensor. A = k^2 C + G, with k = sqrt(8) / range, C the diagonal matrix
 * of areas, and G the stiffness matrix; D: one column of weights per sensor. The covariance D' A^-1 C A^-1 D is the derivative
 * of -D' A^-1 D with respect to k^2. D' A^-1 D is a Schur complement: the last rows of the factor of A bordered by D contain
 * it. Call from one thread only, which uses the workers. */
#ifndef PREPROCESS_INFLUENCE_GAUSSIAN_COVARIANCE_H
#define PREPROCESS_INFLUENCE_GAUSSIAN_COVARIANCE_H
#include <cholmod.h>

#include "base/log/log.h"
#include "base/workers.h"
#include "preprocess/influence/gaussian_bodies.h"
#include "preprocess/influence/influence_mesh.h"

struct gaussian_covariance {
    size_t count; /* number of sensors */
    struct gaussian_bodies bodies;
    double *values; /* covariance [sensor][sensor] for a standard deviation of 1 and sensors without noise */
    size_t row_count;
    double *mass_m2, *scale; /* mass_m2: by row: area of its mesh point; scale: scratch array, one element per component */
    /* upper bound of k^2 D' A^-1 D (letters above); the border's diagonal must exceed it for the matrix to be positive definite */
    double bound;
    cholmod_common common;
    /* matrix to factorise: lower triangle of the stiffness matrix G, the sensors' weights D' below it, and the border's
     * diagonal, which is set for each range */
    cholmod_sparse *bordered;
    cholmod_factor *symbolic; /* CHOLMOD's symbolic factor: elimination order and sparsity */
};

/* Prepares everything that does not depend on the correlation length. Returns false after logging if out of memory. In either
 * case, call gaussian_covariance_finish(). */
bool gaussian_covariance_init(struct gaussian_covariance *covariance, struct log *log, const struct influence_mesh *mesh);
/* Frees what gaussian_covariance_init() allocated. */
void gaussian_covariance_finish(struct gaussian_covariance *covariance);
/* Computes `values` for the correlation length range_m, with errors of about 1e-4 of the squared deviation. workers may be NULL. Returns
 * false after logging if out of memory or if the system is singular. */
bool gaussian_covariance_find(struct gaussian_covariance *covariance, struct log *log, struct workers *workers, double range_m);

#endif

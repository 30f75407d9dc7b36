/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Between sensors alone, what gaussian.h's prior says for one range after another: from two sparse factors a range, without solving for a
   sensor. With A = k^2 C + G and sensors D, the covariance D' A^-1 C A^-1 D is the slope of -D' A^-1 D along k^2, and D' A^-1 D is what the
   factor of a matrix bordered by D leaves for its last rows (a Schur complement). Thread: one; the workers are used. */
#ifndef PREPROCESS_INFLUENCE_GAUSSIAN_COVARIANCE_H
#define PREPROCESS_INFLUENCE_GAUSSIAN_COVARIANCE_H
#include <cholmod.h>

#include "base/log/log.h"
#include "base/workers.h"
#include "preprocess/influence/gaussian_bodies.h"
#include "preprocess/influence/influence_mesh.h"

struct gaussian_covariance {
    size_t count; /* sensors */
    struct gaussian_bodies bodies;
    double *values; /* [sensor][sensor]: for deviation 1 and no noise */
    size_t row_count;
    double *mass_m2, *scale; /* by row; room, by component */
    double bound;            /* that k^2 D' A^-1 D stays below: what the border's diagonal has to exceed */
    cholmod_common common;
    cholmod_sparse *bordered; /* the lower triangle of G, below it D', then a diagonal still to be filled */
    cholmod_factor *symbolic; /* its order and places */
};

/* Sets up what all ranges share. Returns false if out of memory, logged. Call gaussian_covariance_finish() in both cases. */
bool gaussian_covariance_init(struct gaussian_covariance *covariance, struct log *log, const struct influence_mesh *mesh);
/* Frees it. */
void gaussian_covariance_finish(struct gaussian_covariance *covariance);
/* Fills values; they err by about 1e-4 of the deviation's square. workers may be NULL. Returns false if out of memory or if the system
   has no solution, logged. */
bool gaussian_covariance_find(struct gaussian_covariance *covariance, struct log *log, struct workers *workers, double range_m);

#endif

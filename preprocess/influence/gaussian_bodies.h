/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The connected bodies of a surface with sensors: each has a Gaussian process of its own, about a mean of its own. Thread: any. */
#ifndef PREPROCESS_INFLUENCE_GAUSSIAN_BODIES_H
#define PREPROCESS_INFLUENCE_GAUSSIAN_BODIES_H
#include "preprocess/influence/influence_mesh.h"
#include "surface/geodesic/laplacian.h"

struct gaussian_bodies {
    uint32_t *component; /* by point */
    double *area_m2;     /* by component */
    uint32_t *of_sensor; /* its component */
};

/* Finds the bodies. The caller calls gaussian_bodies_finish(). */
void gaussian_bodies_init(struct gaussian_bodies *bodies, const struct influence_mesh *mesh, const struct laplacian *laplacian);
/* Frees the arrays. */
void gaussian_bodies_finish(struct gaussian_bodies *bodies);

/* What is the same everywhere on a body has this part in the covariance of all its places, for k^2 = 1; it belongs to the mean. */
static inline double gaussian_bodies_constant(const struct gaussian_bodies *bodies, uint32_t component)
{
    return bodies->area_m2[component] > 0 ? 1 / bodies->area_m2[component] : 0;
}

/* Makes the covariance [sensor][sensor] symmetric, and 1 in the mean over the sensors of each body. *scale, by component: by what it
   was multiplied; 0: no sensor. */
void gaussian_bodies_scale(const struct gaussian_bodies *bodies, size_t count, double *covariance, double *scale);

#endif

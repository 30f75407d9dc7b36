/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The connected bodies of a surface; each has an independent Gaussian process and mean. Call from any thread. */
#ifndef PREPROCESS_INFLUENCE_GAUSSIAN_BODIES_H
#define PREPROCESS_INFLUENCE_GAUSSIAN_BODIES_H
#include "preprocess/influence/influence_mesh.h"
#include "surface/geodesic/laplacian.h"

struct gaussian_bodies {
    uint32_t *component; /* by mesh point: index of its connected component */
    double *area_m2;     /* by connected component: its area */
    uint32_t *of_sensor; /* by sensor: index of its connected component */
};

/* Finds the connected bodies of the mesh. The caller frees the arrays with gaussian_bodies_finish(). */
void gaussian_bodies_init(struct gaussian_bodies *bodies, const struct influence_mesh *mesh, const struct laplacian *laplacian);
/* Frees the arrays. */
void gaussian_bodies_finish(struct gaussian_bodies *bodies);

/* Returns the covariance that the constant part of the field adds between any two points of a body, for k^2 = 1 (k: gaussian.h). Callers
 * subtract it, because the mean of each body is estimated separately. */
static inline double gaussian_bodies_constant(const struct gaussian_bodies *bodies, uint32_t component)
{
    return bodies->area_m2[component] > 0 ? 1 / bodies->area_m2[component] : 0;
}

/* Makes the covariance matrix [sensor][sensor] symmetric, and scales it so that the variances of each body's sensors average 1.
 * Writes the scale factor of each body (connected component) to scale[]; 0: the body has no sensor. */
void gaussian_bodies_scale(const struct gaussian_bodies *bodies, size_t count, double *covariance, double *scale);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The heat method (Crane, Weischedel, Wardetzky 2013) on an intrinsic triangulation: approximate geodesic distances from two
   sparse linear systems. Their matrices are factored once and solved for many sources at a time. */
#ifndef SURFACE_GEODESIC_HEAT_H
#define SURFACE_GEODESIC_HEAT_H
#include "base/log/log.h"
#include "surface/geodesic/intrinsic.h"

struct heat;

/* Builds and factors the systems (M + t L) u = source and L d = div(grad u / |grad u|). M: areas, L: Laplacian, t = time_m2, u:
 * heat, d: distance. component[point]: connected component of the point. `in` must outlive the result. Logs and returns NULL
 * when out of memory. */
struct heat *heat_create(struct log *log, const struct intrinsic *in, const uint32_t *component, double time_m2);
/* Frees the factored systems and sets *heat to NULL. *heat may be NULL. */
void heat_destroy(struct heat **heat);

/* source from which distances are computed by heat: a point on the surface, given as a triangle and the weights of its three
   points */
struct heat_source {
    uint32_t points[3];
    double weights[3];
};

/* Computes the distance of each point from each source, up to an unknown constant per source: out[source * point_count +
 * point]. Points without a triangle get 0. Logs and returns false if out of memory. Any number of threads may call at the same
 * time. */
bool heat_solve(const struct heat *heat, const struct heat_source *sources, size_t source_count, double *out);

#endif

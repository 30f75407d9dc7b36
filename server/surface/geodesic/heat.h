/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The heat method on an intrinsic triangulation: two sparse systems, factored once, solved for blocks of sources. */
#ifndef SURFACE_GEODESIC_HEAT_H
#define SURFACE_GEODESIC_HEAT_H
#include "base/log.h"
#include "surface/geodesic/intrinsic.h"

struct heat;

/* (M + t L) u = source and L d = div(grad / |grad|), t = time_m2; component[point]: the piece of surface it is on. NULL: out of memory,
   logged. in must outlive it. */
struct heat *heat_create(struct log *log, const struct intrinsic *in, const uint32_t *component, double time_m2);
void heat_destroy(struct heat **heat);

struct heat_source { /* a place: weights of three points */
    uint32_t points[3];
    double weights[3];
};

/* Distances up to a constant for each source: out[source * point_count + point]; points without a triangle get 0. Thread: any
   number at a time, each with a solver of its own. False: out of memory, logged. */
bool heat_solve(const struct heat *heat, const struct heat_source *sources, size_t source_count, double *out);

#endif

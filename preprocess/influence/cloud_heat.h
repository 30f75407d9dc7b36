/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Distances as Kim & Suh (Electronics 2025, 14(15), 2938) find them, to compare with ours: the heat method (Crane, Weischedel, Wardetzky
   2013) on points sampled from the surface, which know their neighbours and nothing of the mesh. So they reach through thin walls and
   across gaps narrower than CLOUD_REACH spacings: that is the method's, and to be seen.

   Points lie a spacing apart and further (Poisson discs), about CLOUD_POINTS of them. Neighbours: all within CLOUD_REACH spacings, by
   FLANN. Tangent planes: the plane of least squares through a point's neighbours. Laplacian: Belkin, Sun & Wang (2009), made symmetric:
   w_ij = A_i A_j exp(-|p_i - p_j|^2 / 4 tau) / (4 pi tau^2), A_i = pi r^2 / (neighbours + 1). Heat: (A + t L) u = source; its direction X
   in each tangent plane by weighted least squares; distances d make sum w_ij (d_j - d_i - (X_i + X_j) (p_j - p_i) / 2)^2 least. */
#ifndef PREPROCESS_INFLUENCE_CLOUD_HEAT_H
#define PREPROCESS_INFLUENCE_CLOUD_HEAT_H
#include "base/log/log.h"
#include "surface/surface.h"

#define CLOUD_POINTS 30000.0
#define CLOUD_REACH 2.5

struct cloud_heat;

/* Samples the visible triangles of the surface and factors the systems. Returns NULL if out of memory, logged. */
struct cloud_heat *cloud_heat_create(struct log *log, const struct surface *surface);
/* Frees it. &NULL is fine; leaves NULL. */
void cloud_heat_destroy(struct cloud_heat **cloud);
/* The number of points, the most neighbours that FLANN was asked for, and the spacing. */
size_t cloud_heat_count(const struct cloud_heat *cloud);
int cloud_heat_k(const struct cloud_heat *cloud);
double cloud_heat_spacing_m(const struct cloud_heat *cloud);

/* Writes the distance of each of `count` positions (metres, in the surface's frame) from a place on the surface; INFINITY where no chain of
   neighbours leads. Returns false if out of memory, logged. Thread: any number of calls at a time. */
bool cloud_heat_distances(const struct cloud_heat *cloud, const double source_m[3], const float (*positions_m)[3], size_t count,
                          float *out);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes distances along the surface by the method of Kim & Suh (Electronics 2025, 14(15), 2938), for comparison with our
 * distances on the mesh. It is the heat method (Crane, Weischedel, Wardetzky 2013) on points sampled from the surface;
 * neighbours are the nearest points, whether or not the mesh connects them. Therefore these distances cross thin walls, and
 * gaps narrower than CLOUD_REACH spacings. The comparison is meant to show this error. 1. Points: about CLOUD_POINTS
 * Poisson-disc samples, at least one spacing apart. 2. Neighbours of a point: all points within r = CLOUD_REACH spacings
 * (FLANN). Tangent plane: least-squares plane through them. 3. Laplacian L (Belkin, Sun & Wang 2009), made symmetric: w_ij =
 * A_i A_j exp(-|p_i - p_j|^2 / 4 tau) / (4 pi tau^2). w_ij is the weight of the points at p_i and p_j, tau the diffusion time,
 * and A_i = pi r^2 / (neighbours + 1) the area of a point. 4. Heat u from the source: (A + t L) u = source, with time t and the
 * areas on the diagonal of A. 5. X_i: unit direction of the heat flow in the tangent plane of point i, by weighted least
 * squares. 6. Distances d minimise sum w_ij (d_j - d_i - (X_i + X_j) (p_j - p_i) / 2)^2. */
#ifndef PREPROCESS_INFLUENCE_CLOUD_HEAT_H
#define PREPROCESS_INFLUENCE_CLOUD_HEAT_H
#include "base/log/log.h"
#include "surface/surface.h"

#define CLOUD_POINTS 30000.0
#define CLOUD_REACH 2.5

struct cloud_heat;

/* Samples the visible triangles of the surface and factorises both linear systems. Returns NULL after logging if out of memory. */
struct cloud_heat *cloud_heat_create(struct log *log, const struct surface *surface);
/* Frees the point cloud and sets *cloud to NULL. *cloud may be NULL. */
void cloud_heat_destroy(struct cloud_heat **cloud);
/* Return, in this order: the number of sample points, the largest neighbour count requested from FLANN, and the point spacing in metres. */
size_t cloud_heat_count(const struct cloud_heat *cloud);
int cloud_heat_k(const struct cloud_heat *cloud);
double cloud_heat_spacing_m(const struct cloud_heat *cloud);

/* Writes the distance of each of `count` positions (metres, in the surface's frame) from a position on the surface; INFINITY
 * for positions not connected by a chain of neighbours. Returns false after logging if out of memory. Any number of threads may
 * call at the same time. */
bool cloud_heat_distances(const struct cloud_heat *cloud, const double source_m[3], const float (*positions_m)[3], size_t count,
                          float *out);

#endif

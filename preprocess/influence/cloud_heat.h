/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes distances with the method of Kim & Suh (Electronics 2025, 14(15), 2938), to compare them with our mesh distances: the heat
 * method (Crane, Weischedel, Wardetzky 2013) on points sampled from the surface, with neighbours by distance instead of mesh connectivity.
 * Therefore these distances cut through thin walls and across gaps narrower than CLOUD_REACH spacings. This error of the method is kept on
 * purpose, because the comparison should show it. Points: about CLOUD_POINTS Poisson-disc samples, at least one spacing apart. Neighbours:
 * all points within CLOUD_REACH spacings, found with FLANN. Tangent plane: least-squares plane through a point's neighbours. Laplacian:
 * Belkin, Sun & Wang (2009), made symmetric: w_ij = A_i A_j exp(-|p_i - p_j|^2 / 4 tau) / (4 pi tau^2). w_ij: weight of points i and j at
 * positions p_i and p_j; tau: diffusion time; A_i = pi r^2 / (neighbours + 1): area of a point; r: reach of the neighbours, in metres. Heat
 * u solves (A + t L) u = source (L: Laplacian, t: time, A: areas on the diagonal). X is the unit direction of the heat flow in each tangent
 * plane, by weighted least squares. Distances d minimise sum w_ij (d_j - d_i - (X_i + X_j) (p_j - p_i) / 2)^2. */
#ifndef PREPROCESS_INFLUENCE_CLOUD_HEAT_H
#define PREPROCESS_INFLUENCE_CLOUD_HEAT_H
#include "base/log/log.h"
#include "surface/surface.h"

#define CLOUD_POINTS 30000.0
#define CLOUD_REACH 2.5

struct cloud_heat;

/* Samples the visible triangles of the surface and factors both linear systems. Returns NULL after logging if out of memory. */
struct cloud_heat *cloud_heat_create(struct log *log, const struct surface *surface);
/* Frees the point cloud and sets *cloud to NULL. *cloud may be NULL. */
void cloud_heat_destroy(struct cloud_heat **cloud);
/* Return, in this order: the number of sample points, the largest neighbour count requested from FLANN, and the point spacing in metres. */
size_t cloud_heat_count(const struct cloud_heat *cloud);
int cloud_heat_k(const struct cloud_heat *cloud);
double cloud_heat_spacing_m(const struct cloud_heat *cloud);

/* Writes the distance of each of `count` positions (metres, in the surface's frame) from a position on the surface; INFINITY for positions
 * not connected by a chain of neighbours. Returns false after logging if out of memory. Thread: any number of concurrent calls. */
bool cloud_heat_distances(const struct cloud_heat *cloud, const double source_m[3], const float (*positions_m)[3], size_t count,
                          float *out);

#endif

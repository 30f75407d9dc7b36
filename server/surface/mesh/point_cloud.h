/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds nearest neighbours in a point cloud with the FLANN library, which only this module includes. Call from any thread. */
#ifndef SURFACE_MESH_POINT_CLOUD_H
#define SURFACE_MESH_POINT_CLOUD_H
#include <stdbool.h>
#include <stddef.h>

/* maximum number of neighbours requested per point */
#define POINT_CLOUD_MAX_K 256
/* Calls visit(arg, point, other, distance_m) for every ordered pair of points within radius_m of each other. For each point,
 * the nearest others come first. Requests k neighbours of each point from FLANN and doubles k until the farthest lies beyond
 * the radius, all points are found, or k is POINT_CLOUD_MAX_K. Returns that k, or -1 if out of memory. */
int point_cloud_neighbours(const double (*points)[3], size_t count, double radius_m,
                           void (*visit)(void *arg, size_t point, size_t other, double distance_m), void *arg);

#endif

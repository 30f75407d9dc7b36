/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nearest neighbours in a point cloud. FLANN stays behind this header. Thread: any. */
#ifndef SURFACE_MESH_POINT_CLOUD_H
#define SURFACE_MESH_POINT_CLOUD_H
#include <stdbool.h>
#include <stddef.h>

/* For every point, all other points within radius_m: visit(arg, point, other, distance_m), nearest first. k, the number of neighbours
   asked for, doubles until every point's farthest neighbour lies beyond the radius (or there are no more, or k is POINT_CLOUD_MAX_K); it is
   returned. -1: out of memory. Thread: any. */
#define POINT_CLOUD_MAX_K 256
/* Calls visit(arg, point, other, distance_m) for every ordered pair of points within radius_m of each other, for each point the nearest
   first. Asks for k neighbours of each point and doubles k until the farthest lies beyond the radius, all points are found, or k is
   POINT_CLOUD_MAX_K. Returns that k, or -1 if out of memory. */
int point_cloud_neighbours(const double (*points)[3], size_t count, double radius_m,
                           void (*visit)(void *arg, size_t point, size_t other, double distance_m), void *arg);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Estimates the discretisation error of a finite-element solution: how far the exact solution may be from the one that is linear on the
   mesh's triangles. Where the exact solution has second derivative k across an edge, the gradients of the triangles at that edge differ
   (fluxes towards them add up to k / 2 times their heights), and k h^2 / 8 is the error of a triangle of height h. Across creases and
   where several parts meet the same holds, since fluxes are measured within each triangle. Thread: one, unless said otherwise. */
#ifndef PREPROCESS_INFLUENCE_MESH_ERROR_H
#define PREPROCESS_INFLUENCE_MESH_ERROR_H
#include "preprocess/influence/influence_mesh.h"

enum { BEND_WIDTH = 32 }; /* sensors that are added at a time */
struct mesh_error;
/* Creates the sums for a mesh, which must outlive them. Edges within a sensor's disc do not count: the solution has a kink at the rim of
   the disc. Returns NULL if out of memory. The caller destroys it. */
struct mesh_error *mesh_error_create(const struct influence_mesh *mesh);
/* Frees it. &NULL is fine; leaves NULL. */
void mesh_error_destroy(struct mesh_error **error);
/* Adds the shares of `width` sensors, at most BEND_WIDTH; at_points: as influence_bend_add(). Thread: any number of calls at a time. */
void mesh_error_add(struct mesh_error *error, const float *at_points, size_t stride, size_t width);
/* Writes for each point of the mesh the error in the triangles around it, for the worst readings, in parts of the spread of the readings.
   Begins again at zero. */
void mesh_error_take(struct mesh_error *error, float *by_point);

#endif

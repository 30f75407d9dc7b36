/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Estimates the discretisation error of a finite-element solution: how far the exact solution may be from the piecewise linear
 * one. If the exact solution has second derivative k across an edge, the gradients of the adjacent triangles differ: their
 * fluxes towards the edge sum to k / 2 times their heights. k h^2 / 8 then bounds the error in a triangle of height h. Fluxes
 * are measured within each triangle, so this also holds across creases and where more than two triangles meet. Call from one
 * thread only, unless a function says otherwise. */
#ifndef PREPROCESS_INFLUENCE_MESH_ERROR_H
#define PREPROCESS_INFLUENCE_MESH_ERROR_H
#include "preprocess/influence/influence_mesh.h"

enum { BEND_WIDTH = 32 }; /* sensors processed per call */
struct mesh_error;
/* Creates zeroed error sums for a mesh, which must outlive them. Edges within a sensor's disc are ignored, because the exact solution
 * itself has a kink at the disc's rim. Returns NULL if out of memory. The caller frees the result with mesh_error_destroy(). */
struct mesh_error *mesh_error_create(const struct influence_mesh *mesh);
/* Frees the error sums and sets *error to NULL. *error may be NULL. */
void mesh_error_destroy(struct mesh_error **error);
/* Computes the flux imbalance at each mesh edge for `width` sensors, at most BEND_WIDTH, and adds it to the error sums.
   at_points: the sensors' interpolation weights ("shares"). Each mesh point has `stride` numbers there, of which the first
   `width` are weights, one per sensor. Any number of threads may call at the same time. */
void mesh_error_add(struct mesh_error *error, const float *at_points, size_t stride, size_t width);
/* Writes, by mesh point, the largest discretisation error in the adjacent triangles, for the worst possible readings, as a
 * fraction of the spread of readings. Resets the sums to zero. */
void mesh_error_take(struct mesh_error *error, float *by_point);

#endif

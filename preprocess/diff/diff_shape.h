/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares two triangle meshes: largest distance, rigid motion, nearest points. Call from any thread. */
#ifndef PREPROCESS_DIFF_SHAPE_H
#define PREPROCESS_DIFF_SHAPE_H
#include "preprocess/diff/diff_side.h"

/* A triangle mesh with a bounding volume hierarchy. */
struct diff_shape;

/* Builds a shape from an asset's triangles, which must outlive it. The caller frees it with diff_shape_destroy(). */
struct diff_shape *diff_shape_create(const struct diff_side_shape *shape);
/* Frees the shape and sets *shape to NULL. *shape may be NULL. */
void diff_shape_destroy(struct diff_shape **shape);
/* Writes the corners of the shape's bounding box, in metres. */
void diff_shape_box(const struct diff_shape *shape, double low_m[3], double high_m[3]);
/* Returns the diagonal of the shape's bounding box in metres. */
double diff_shape_diagonal(const struct diff_shape *shape);

/* Writes the surface point nearest to point_m to place_m, and returns its distance from point_m in metres. */
double diff_shape_nearest(const struct diff_shape *shape, const double point_m[3], double place_m[3]);

/* Moves shape b by the matrix b_to_a. Returns the largest distance, in metres, of a point of either surface from the other
 * surface, measured at corners and at points spread over the triangles. If enough_m is not 0, stops as soon as the distance
 * exceeds enough_m. */
double diff_shape_apart(const struct diff_shape *a, const struct diff_shape *b, const double b_to_a[16], double enough_m);

/* Finds the rigid motion that maps the vertices of shape b to those of shape a, assuming that both list them in the same order.
 * Returns false if the vertex counts differ. */
bool diff_shape_motion(const struct diff_shape *a, const struct diff_shape *b, double b_to_a[16]);

/* Returns how far `motion` moves a corner of the shape's bounding box at most, in metres. */
double diff_shape_moved(const struct diff_shape *shape, const double motion[16]);
/* Returns the rotation angle of a rigid motion, in degrees. */
double diff_turned_deg(const double motion[16]);

#endif

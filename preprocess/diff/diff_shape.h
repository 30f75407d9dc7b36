/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Two shapes held against each other. Thread: any. */
#ifndef PREPROCESS_DIFF_SHAPE_H
#define PREPROCESS_DIFF_SHAPE_H
#include "preprocess/diff/diff_side.h"

struct diff_shape; /* with a tree of boxes around its triangles */

struct diff_shape *diff_shape_create(const struct diff_side_shape *shape);
void diff_shape_destroy(struct diff_shape **shape);
void diff_shape_box(const struct diff_shape *shape, double low_m[3], double high_m[3]);
double diff_shape_diagonal(const struct diff_shape *shape); /* m */

/* The place on the surface nearest to a point, and how far. */
double diff_shape_nearest(const struct diff_shape *shape, const double point_m[3], double place_m[3]);

/* How far the two surfaces are apart at most, either way, where b has been moved by b_to_a: at corners and at places spread over the
   triangles. No more exact than it takes to say that it is beyond enough_m, where that is not 0. */
double diff_shape_apart(const struct diff_shape *a, const struct diff_shape *b, const double b_to_a[16], double enough_m);

/* The motion that takes b's corners to a's, if there are as many and they come in the same order. False: there are not. */
bool diff_shape_motion(const struct diff_shape *a, const struct diff_shape *b, double b_to_a[16]);

/* How far this motion moves any corner of the shape's box; its angle. */
double diff_shape_moved(const struct diff_shape *shape, const double motion[16]);
double diff_turned_deg(const double motion[16]);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear interpolation error of the drawn field: how far a triangle's corners, interpolated, may be from the weights that the sensors have
   inside it. Preparing cuts triangles until that is less than a step of colour, for the plant file's parameters, but may run out of
   triangles; and a view may choose other parameters. So the error is measured for the parameters in use. Thread: one. */
#ifndef FIELD_DRAWN_ERROR_H
#define FIELD_DRAWN_ERROR_H
#include "base/workers.h"
#include "field/weights.h"

/* Measures the error in the triangles of the level of detail that needs `vertices` vertices, unless it is known, and adds it to
   weights->errors: by vertex, the largest of the triangles around it; for shepard in parts of the spread of the readings, for paper in
   parts of the largest. params and usable are those of weights_create(); in_range: the readings differ by no more than preparing assumed.
   Adds nothing where preparing left no error for such parameters and all sensors are used, where the weights are prepared (linear in
   triangles by definition), or out of memory. */
void drawn_error_measure(struct weights *weights, const struct field_params *params, const uint8_t *usable, size_t vertices,
                         bool in_range, struct workers *workers);

#endif

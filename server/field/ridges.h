/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the errors of values at ridges, which are the places where paths along the surface from two sides of an obstacle meet.
   The distance from a sensor bends there, so that the distances inside a triangle do not follow from those of its corners. */
#ifndef FIELD_RIDGES_H
#define FIELD_RIDGES_H
#include "field/weights.h"

enum { RIDGE_GROUP = 16384 }; /* number of triangles to examine in one call for good speed */

struct ridge_job {
    const struct weights *weights; /* prepared for all vertices */
    const float *errors;           /* [triangle]: its other errors; it is left out if they are at least 1 */
    /* [triangle]: receives the error for the worst readings, relative to their spread (paper: to the largest); 1 also if memory is
       missing */
    float *ridges;
};

/* Measures triangles begin..end-1 of the asset. Several threads may measure different triangles at the same time. */
void ridges_measure(const struct ridge_job *job, size_t begin, size_t end);

#endif

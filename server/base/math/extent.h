/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Axis-aligned bounding box of points. Call from any thread. */
#ifndef BASE_MATH_EXTENT_H
#define BASE_MATH_EXTENT_H
#include "base/math/vec.h"

struct extent {
    double low[3], high[3];
};

/* Returns an empty box, to be enlarged with extent_add(). */
static inline struct extent extent_empty(void)
{
    return (struct extent){ { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
}

/* Enlarges the box so that it contains a point, which must be finite. */
static inline void extent_add(struct extent *extent, const double point[3])
{
    for (int axis = 0; axis < 3; axis++) {
        extent->low[axis] = min_of(extent->low[axis], point[axis]);
        extent->high[axis] = max_of(extent->high[axis], point[axis]);
    }
}

/* Like extent_add(), for a point in single precision. */
static inline void extent_addf(struct extent *extent, const float point[3])
{
    extent_add(extent, (double[3]){ (double)point[0], (double)point[1], (double)point[2] });
}

/* Returns the length of the box's diagonal; infinite if the box is empty. */
static inline double extent_size(const struct extent *extent)
{
    return vec_distance(extent->low, extent->high);
}

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fields (interpolated values) that pictures show exactly: the interpolations `shepard` and `paper` with straight-line
   distances are evaluated at each pixel (field/pixel_field.h). plantcast-prep does not subdivide triangles for such fields.
   Call from any thread. */
#ifndef PLANT_EXACT_H
#define PLANT_EXACT_H
#include "plant/influence.h"
#include "plant/plant.h"

/* Relative error, positive or negative, of the distances along the surface that plantcast-prep computes. Single distances may err
   by more, but values err by more than errors of this size explain at only one place in 1,000 (along_truth_test, powers 2 to 16).
   The interpolation `shepard` weights a sensor by its distance to the power of -p, so a weight's relative error is up to p times
   as large. */
#define PLANT_DISTANCE_ERROR 0.0031
/* smallest power p for which plantcast-prep and pictures report values that may be wrong due to errors of distances. With a power of
   4, at most 5 of 1,000 places err by more than a colour step. */
#define PLANT_HIGH_POWER 5

/* Returns whether a field with this interpolation and kind of distance is evaluated at each pixel. */
static inline bool plant_is_exact(enum interpolation interpolation, enum distance_mode distance)
{
    return (interpolation == INTERPOLATION_SHEPARD || interpolation == INTERPOLATION_PAPER) && distance == DISTANCE_EUCLIDEAN;
}
/* Returns whether plantcast-prep need not subdivide triangles for this group, because its field is evaluated at each pixel. */
static inline bool plant_group_is_exact(const struct plant_group *group)
{
    return plant_is_exact(group->interpolation, group->distance) && !plant_prepares_any(group);
}

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the rigid motion (rotation and translation) that maps one set of points to another. Thread: any. */
#ifndef PREPROCESS_RIGID_FIT_H
#define PREPROCESS_RIGID_FIT_H
#include <stddef.h>

/* Writes the rotation and translation that map from[i] to to[i] with the least sum of squared distances (Horn 1987), as a column-major
 * matrix. count must be at least 1. */
void rigid_fit(const double (*from)[3], const double (*to)[3], size_t count, double motion[16]);

#endif

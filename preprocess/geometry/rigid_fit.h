/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the rigid motion (rotation and translation) that maps one point set to another. Call from any thread. */
#ifndef PREPROCESS_RIGID_FIT_H
#define PREPROCESS_RIGID_FIT_H
#include <stddef.h>

/* Writes, as a column-major matrix, the rotation and translation from from[i] to to[i] that minimise the sum of squared
 * distances (Horn 1987). count must be at least 1. */
void rigid_fit(const double (*from)[3], const double (*to)[3], size_t count, double motion[16]);

#endif

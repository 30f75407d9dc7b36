/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dense algebra between sensors for generalised least squares, with a covariance matrix and one unknown mean per body. Call from
   any thread. */
#ifndef PREPROCESS_INFLUENCE_GAUSSIAN_CONTRAST_H
#define PREPROCESS_INFLUENCE_GAUSSIAN_CONTRAST_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Inverts the covariance matrix S of `count` readings and overwrites it. Computes (1: a vector of ones; ': transpose) precision = S^-1 - w
 * w' / (1' w) within each body, with w = S^-1 1, and means = w / (1' w). Sensors of different bodies have zero covariance. *log_det
 * receives log |S| + sum over bodies of log(1' w), a term of the restricted likelihood (Patterson & Thompson, 1971). All matrices are
 * [sensor][sensor]. Returns false if S is not positive definite. */
bool gaussian_contrast(size_t count, const uint32_t *body, double *covariance, double *precision, double *means, double *log_det);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inverts a dense covariance matrix of readings by Cholesky factorisation and removes the mean of each body. */
#include "preprocess/influence/gaussian_contrast.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"

/* LAPACK routines, with Fortran's calling convention. Fortran's columns are our rows, so "U" selects our lower triangle. */
void dpotrf_(const char *uplo, const int *n, double *a, const int *lda, int *info, size_t uplo_length);
void dpotri_(const char *uplo, const int *n, double *a, const int *lda, int *info, size_t uplo_length);

/* Computes the Cholesky factor L of matrix a, so that a = L L'. L overwrites the lower triangle of a. */
static bool factor(size_t count, double *a, double *log_det)
{
    const int n = (int)count, pitch = n > 1 ? n : 1;
    int info = 0;
    dpotrf_("U", &n, a, &pitch, &info, 1);
    *log_det = 0;
    for (size_t i = 0; info == 0 && i < count; i++)
        *log_det += 2 * log(a[i * (count + 1)]);
    return info == 0 && isfinite(*log_det);
}

/* Computes the full inverse of L L' from the lower triangular factor L. */
static bool invert(size_t count, const double *lower, double *inverse)
{
    const int n = (int)count, pitch = n > 1 ? n : 1;
    int info = 0;
    memcpy(inverse, lower, count * count * sizeof(*inverse));
    dpotri_("U", &n, inverse, &pitch, &info, 1);
    for (size_t i = 0; i < count; i++)
        for (size_t j = i + 1; j < count; j++)
            inverse[i * count + j] = inverse[j * count + i];
    return info == 0;
}

bool gaussian_contrast(size_t count, const uint32_t *body, double *covariance, double *precision, double *means, double *log_det)
{
    if (!factor(count, covariance, log_det) || !invert(count, covariance, precision))
        return false;
    double *weights = mem_array(count, sizeof(*weights)), *wholes = mem_array(count, sizeof(*wholes));
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < count; j++)
            weights[i] += body[i] == body[j] ? precision[i * count + j] : 0;
    for (size_t i = 0; i < count; i++) {
        bool first = true;
        for (size_t j = 0; j < count; j++) {
            wholes[i] += body[i] == body[j] ? weights[j] : 0;
            first = first && (j >= i || body[j] != body[i]);
        }
        *log_det += first ? log(wholes[i]) : 0;
        means[i] = weights[i] / wholes[i];
    }
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < count; j++)
            precision[i * count + j] = body[i] == body[j] ? precision[i * count + j] - weights[i] * means[j] : 0;
    mem_free(weights);
    mem_free(wholes);
    return true;
}

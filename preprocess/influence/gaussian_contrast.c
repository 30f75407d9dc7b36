/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A dense Cholesky factor, its inverse, and a mean taken out of each body. */
#include "preprocess/influence/gaussian_contrast.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"

static bool factor(size_t n, double *a, double *log_det)
{
    *log_det = 0;
    for (size_t i = 0; i < n; i++) {
        double *row = a + i * n;
        for (size_t j = 0; j <= i; j++) {
            double sum = row[j];
            for (size_t k = 0; k < j; k++)
                sum -= row[k] * a[j * n + k];
            if (i != j)
                row[j] = sum / a[j * n + j];
            else if (!(sum > 0))
                return false;
            else
                *log_det += log(sum), row[i] = sqrt(sum);
        }
    }
    return true;
}

/* L^-1 over L, then its transpose times itself. */
static void invert(size_t n, double *lower, double *inverse)
{
    for (size_t j = 0; j < n; j++) { /* columns of L^-1, kept as rows of `inverse` */
        double *column = inverse + j * n;
        memset(column, 0, n * sizeof(*column));
        column[j] = 1 / lower[j * n + j];
        for (size_t i = j + 1; i < n; i++) {
            double sum = 0;
            for (size_t k = j; k < i; k++)
                sum -= lower[i * n + k] * column[k];
            column[i] = sum / lower[i * n + i];
        }
    }
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++) {
            double sum = 0;
            for (size_t k = i; k < n; k++)
                sum += inverse[i * n + k] * inverse[j * n + k];
            lower[i * n + j] = sum;
        }
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            inverse[i * n + j] = lower[i > j ? i * n + j : j * n + i];
}

bool gaussian_contrast(size_t count, const uint32_t *body, double *covariance, double *precision, double *means, double *log_det)
{
    if (!factor(count, covariance, log_det))
        return false;
    invert(count, covariance, precision);
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

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the values of lost sensors, those without a usable reading (influence_fill.h). Uses a dense Cholesky factor of the
   precision matrix's block that belongs to the lost sensors. */
#include "field/influence_fill.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"

/* Smallest valid pivot of the Cholesky factorisation, as a fraction of the lost sensor's precision. With a smaller pivot, no
   used sensor determines the lost sensor, whose value is then set to 0. */
#define MIN_PIVOT_PART 1e-9

struct influence_fill {
    const double *precision;
    size_t count, lost_count;
    uint32_t *lost;
    uint8_t *used;
    double *factor; /* lower triangle, [row][column] */
};

static void factor(struct influence_fill *fill)
{
    const size_t n = fill->lost_count;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++) {
            double own = fill->precision[fill->lost[i] * fill->count + fill->lost[j]], sum = own;
            for (size_t k = 0; k < j; k++)
                sum -= fill->factor[i * n + k] * fill->factor[j * n + k];
            if (i == j)
                fill->factor[i * n + i] = sqrt(sum > MIN_PIVOT_PART * fabs(own) ? sum : fabs(own) + 1e-30);
            else
                fill->factor[i * n + j] = sum / fill->factor[j * n + j];
        }
}

struct influence_fill *influence_fill_create(const double *precision, size_t count, const uint8_t *used)
{
    struct influence_fill *fill = mem_new(sizeof(*fill));
    *fill = (struct influence_fill){ .precision = precision, .count = count };
    fill->lost = mem_array(count, sizeof(*fill->lost));
    fill->used = mem_array(count, 1);
    memcpy(fill->used, used, count);
    for (uint32_t i = 0; i < count; i++)
        if (!used[i])
            fill->lost[fill->lost_count++] = i;
    fill->factor = mem_array(fill->lost_count * fill->lost_count, sizeof(*fill->factor));
    factor(fill);
    return fill;
}

void influence_fill_destroy(struct influence_fill **fill_ptr)
{
    struct influence_fill *fill = *fill_ptr;
    if (!fill)
        return;
    mem_free(fill->lost);
    mem_free(fill->used);
    mem_free(fill->factor);
    mem_free(fill);
    *fill_ptr = NULL;
}

/* Solves a triangular system: replaces x with L^-1 x, where L is the Cholesky factor and x is 0 before index `first`. */
static void solve_lower(const struct influence_fill *fill, size_t first, double *x)
{
    const size_t n = fill->lost_count;
    for (size_t i = first; i < n; i++) {
        for (size_t k = first; k < i; k++)
            x[i] -= fill->factor[i * n + k] * x[k];
        x[i] /= fill->factor[i * n + i];
    }
}

void influence_fill_values(const struct influence_fill *fill, double *values)
{
    const size_t n = fill->lost_count;
    double *x = mem_array(n, sizeof(*x));
    for (size_t i = 0; i < n; i++) {
        const double *row = fill->precision + fill->lost[i] * fill->count;
        for (size_t j = 0; j < fill->count; j++)
            x[i] -= fill->used[j] ? row[j] * values[j] : 0;
    }
    solve_lower(fill, 0, x);
    for (size_t i = n; i-- > 0;) {
        for (size_t k = i + 1; k < n; k++)
            x[i] -= fill->factor[k * n + i] * x[k];
        x[i] /= fill->factor[i * n + i];
        values[fill->lost[i]] = x[i];
    }
    mem_free(x);
}

static double own_of_used(const struct influence_fill *fill, size_t sensor, double *x)
{
    const size_t n = fill->lost_count;
    double own = fill->precision[sensor * fill->count + sensor];
    for (size_t i = 0; i < n; i++)
        x[i] = fill->precision[fill->lost[i] * fill->count + sensor];
    solve_lower(fill, 0, x);
    for (size_t i = 0; i < n; i++)
        own -= x[i] * x[i];
    return own;
}

/* Returns the precision (1 / variance) of lost sensor l given the used sensors: 1 / ((P_LL)^-1)_ll, where P_LL is the lost
   sensors' block of the precision matrix. Computed from a column of the Cholesky factor's inverse. x: scratch buffer. */
static double own_of_lost(const struct influence_fill *fill, size_t lost, double *x)
{
    const size_t n = fill->lost_count;
    double inverse = 0;
    for (size_t i = lost; i < n; i++)
        x[i] = i == lost;
    solve_lower(fill, lost, x);
    for (size_t i = lost; i < n; i++)
        inverse += x[i] * x[i];
    return 1 / inverse;
}

void influence_fill_own(const struct influence_fill *fill, double *own)
{
    double *x = mem_array(fill->lost_count + 1, sizeof(*x));
    for (size_t i = 0; i < fill->count; i++)
        own[i] = fill->used[i] ? own_of_used(fill, i, x) : 0;
    for (size_t i = 0; i < fill->lost_count; i++)
        own[fill->lost[i]] = own_of_lost(fill, i, x);
    mem_free(x);
}

void influence_fill_variances(const struct influence_fill *fill, const float *shares, size_t stride, size_t count, double *out)
{
    const size_t n = fill->lost_count;
    double *x = mem_array(n * count, sizeof(*x)); /* L^-1 H_L, row by row */
    for (size_t i = 0; i < n; i++) {
        const float *share = shares + fill->lost[i] * stride;
        double *row = x + i * count;
        for (size_t v = 0; v < count; v++)
            row[v] = (double)share[v];
        for (size_t k = 0; k < i; k++) {
            const double times = fill->factor[i * n + k], *other = x + k * count;
            for (size_t v = 0; v < count; v++)
                row[v] -= times * other[v];
        }
        for (size_t v = 0; v < count; v++) {
            row[v] /= fill->factor[i * n + i];
            out[v] += row[v] * row[v];
        }
    }
    mem_free(x);
}

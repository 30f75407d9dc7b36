/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A dense Cholesky factor of as many rows as sensors are lost. */
#include "field/influence_fill.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"

#define LEAST 1e-9 /* of a sensor's own precision: where all sensors of a body are lost, nothing follows, and 0 is taken */

struct influence_fill {
    const double *precision;
    size_t count, lost_count;
    uint32_t *lost;
    uint8_t *used;
    double *factor; /* [row][column], lower */
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
                fill->factor[i * n + i] = sqrt(sum > LEAST * fabs(own) ? sum : fabs(own) + 1e-30);
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

void influence_fill_values(const struct influence_fill *fill, double *values)
{
    const size_t n = fill->lost_count;
    double *x = mem_array(n, sizeof(*x));
    for (size_t i = 0; i < n; i++) {
        const double *row = fill->precision + fill->lost[i] * fill->count;
        for (size_t j = 0; j < fill->count; j++)
            x[i] -= fill->used[j] ? row[j] * values[j] : 0;
        for (size_t k = 0; k < i; k++)
            x[i] -= fill->factor[i * n + k] * x[k];
        x[i] /= fill->factor[i * n + i];
    }
    for (size_t i = n; i-- > 0;) {
        for (size_t k = i + 1; k < n; k++)
            x[i] -= fill->factor[k * n + i] * x[k];
        x[i] /= fill->factor[i * n + i];
        values[fill->lost[i]] = x[i];
    }
    mem_free(x);
}

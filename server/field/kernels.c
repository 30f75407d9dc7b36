/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The field's inner loops. They are branch-free and sum over the sensors in order at each vertex, so that every machine and
   every division into blocks gives identical bits. */
#include "field/kernels.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/math/simd.h"
#include "field/scalars.h"
#include "protocol/asset_distance.h"

#define KERNEL SIMD_CLONES("avx512f", "avx2")

#if defined(__GNUC__) && !defined(__clang__)
/* lets the compiler evaluate both sides of a conditional expression, as SIMD code must; floating-point exceptions do not matter here */
#pragma GCC optimize("no-trapping-math")
#endif
/* this header is included after the pragma, so that the pragma also makes SIMD code of the header's functions */
#include "field/weight_formula.h"

static inline void fade(const struct kernel_column *column, float *restrict weight)
{
    const float *distance_m = column->distance_m, *near_m = column->near_m;
    const float reach_m = column->reach_m;
    for (size_t j = 0; j < column->count; j++)
        weight[j] = weight_faded(weight[j], distance_m[j], near_m[j], reach_m);
}

KERNEL void kernel_euclidean(const float (*positions_m)[3], size_t count, const float point_m[3], float *restrict out_m)
{
    float px = point_m[0], py = point_m[1], pz = point_m[2];
    for (size_t j = 0; j < count; j++) {
        float x = positions_m[j][0] - px, y = positions_m[j][1] - py, z = positions_m[j][2] - pz;
        out_m[j] = sqrtf(x * x + y * y + z * z);
    }
}

KERNEL void kernel_distances(const uint16_t *restrict codes, size_t count, float *restrict out_m)
{
    for (size_t j = 0; j < count; j++)
        out_m[j] = asset_distance_of(codes[j]);
}

KERNEL void kernel_nearest(const float *restrict distance_m, size_t count, float *restrict near_m)
{
    for (size_t j = 0; j < count; j++)
        near_m[j] = distance_m[j] < near_m[j] ? distance_m[j] : near_m[j];
}

/* compares the bits of the floats as integers: non-negative floats sort like their bits, and the compiler may reorder an
   integer maximum, which makes SIMD code of the loop possible */
KERNEL float kernel_largest(const float *distance_m, size_t count, float most_m)
{
    int32_t most, infinity = 0x7f800000;
    memcpy(&most, &most_m, sizeof(most));
    for (size_t j = 0; j < count; j++) {
        int32_t bits;
        memcpy(&bits, &distance_m[j], sizeof(bits));
        bits = bits < infinity ? bits : 0;
        most = bits > most ? bits : most;
    }
    memcpy(&most_m, &most, sizeof(most_m));
    return most_m;
}

KERNEL void kernel_top_shepard(const float *restrict distance_m, const float *restrict near_m, size_t count, float strength,
                               float *restrict top)
{
    for (size_t j = 0; j < count; j++) {
        float mine = distance_m[j] <= near_m[j] ? strength : 0.0f;
        top[j] = mine > top[j] ? mine : top[j];
    }
}

KERNEL void kernel_top_paper(const float *restrict distance_m, const float *restrict near_m, size_t count, float reach_m, float radius_m,
                             float strength, float *restrict top)
{
    const float per_radius = 1.0f / radius_m;
    for (size_t j = 0; j < count; j++) {
        float d, mine = weight_exponent(distance_m[j], radius_m, per_radius, strength, &d);
        mine = weight_takes_part(distance_m[j], near_m[j], reach_m) ? mine : 0.0f;
        top[j] = mine > top[j] ? mine : top[j];
    }
}

KERNEL void kernel_log2(const float *restrict x, size_t count, float *restrict out)
{
    for (size_t j = 0; j < count; j++)
        out[j] = weight_log2(x[j]);
}

KERNEL void kernel_shepard(const struct kernel_column *column, float *restrict weight)
{
    const float *distance_m = column->distance_m, *near_m = column->near_m, *top = column->top;
    const float reach_m = column->reach_m, strength = column->strength;
    const float *near_log2 = column->near_log2, power = column->power;
    for (size_t j = 0; power == 2.0f && j < column->count; j++)
        weight[j] = weight_part_squared(distance_m[j], near_m[j]);
    for (size_t j = 0; power != 2.0f && j < column->count; j++)
        weight[j] = weight_part(distance_m[j], near_m[j], near_log2[j], power);
    for (size_t j = 0; !column->alike && j < column->count; j++)
        weight[j] = weight[j] * strength / top[j];
    if (reach_m < INFINITY)
        fade(column, weight);
    for (size_t j = 0; !(reach_m < INFINITY) && j < column->count; j++)
        weight[j] = weight_takes_part(distance_m[j], near_m[j], reach_m) ? weight[j] : 0.0f;
}

KERNEL void kernel_paper(const struct kernel_column *column, float *restrict weight, float *restrict term)
{
    const float *distance_m = column->distance_m, *near_m = column->near_m, *top = column->top;
    const float reach_m = column->reach_m, strength = column->strength, decay = column->decay;
    const float radius_m = column->radius_m, per_radius = 1.0f / radius_m;
    float d[KERNEL_BLOCK], exponent[KERNEL_BLOCK];
    for (size_t j = 0; j < column->count; j++) {
        float above = weight_exponent(distance_m[j], radius_m, per_radius, strength, &d[j]) - top[j];
        exponent[j] = weight_takes_part(distance_m[j], near_m[j], reach_m) ? above : -1e6f;
    }
    if (weight || decay == 1.0f || decay == 0.0f) {
        float *at = weight ? weight : term;
        for (size_t j = 0; j < column->count; j++)
            at[j] = weight_exp2(exponent[j]);
    }
    const float *from = weight ? weight : term;
    if (decay == 1.0f)
        for (size_t j = 0; j < column->count; j++)
            term[j] = from[j] * d[j];
    else if (decay == 0.0f && weight) /* 0^0 is 1 */
        memcpy(term, weight, column->count * sizeof(*term));
    else if (decay != 0.0f)
        for (size_t j = 0; j < column->count; j++)
            term[j] = weight_raised(exponent[j], d[j], decay);
    if (reach_m < INFINITY)
        fade(column, term);
    if (reach_m < INFINITY && weight)
        fade(column, weight);
}

KERNEL static void add_one(double *restrict sum, const float *restrict a, double factor, size_t count)
{
    for (size_t j = 0; j < count; j++)
        sum[j] += (double)a[j] * factor;
}

/* Adds the weights of KERNEL_COLUMNS sensors (columns), each multiplied by its sensor's factor, to vertices begin..end-1 of
   `sum`. */
SIMD_BODY void add_eight(double *restrict sum, const float *const *columns, const double *factors, size_t begin, size_t end)
{
    const float *restrict a = columns[0], *restrict b = columns[1], *restrict c = columns[2], *restrict d = columns[3];
    const float *restrict e = columns[4], *restrict f = columns[5], *restrict g = columns[6], *restrict h = columns[7];
    const double fa = factors[0], fb = factors[1], fc = factors[2], fd = factors[3], fe = factors[4], ff = factors[5], fg = factors[6],
                 fh = factors[7];
    for (size_t j = begin; j < end; j++) {
        double first = ((double)a[j] * fa + (double)b[j] * fb) + ((double)c[j] * fc + (double)d[j] * fd);
        double second = ((double)e[j] * fe + (double)f[j] * ff) + ((double)g[j] * fg + (double)h[j] * fh);
        sum[j] += first + second;
    }
}

KERNEL void kernel_add(double *restrict sum, const float *const *columns, const double *factors, size_t column_count, size_t count,
                       const float *const *next)
{
    size_t begin = 0;
    if (column_count < KERNEL_COLUMNS) {
        for (size_t i = 0; i < column_count; i++)
            add_one(sum, columns[i], factors[i], count);
        return;
    }
    for (; next && begin + KERNEL_LINE <= count; begin += KERNEL_LINE) {
        for (int k = 0; k < KERNEL_COLUMNS; k++)
            __builtin_prefetch(next[k] + begin, 0, 2);
        add_eight(sum, columns, factors, begin, begin + KERNEL_LINE);
    }
    add_eight(sum, columns, factors, begin, count);
}

KERNEL void kernel_add_both(double *restrict sum, double *restrict total, const float *const columns[KERNEL_COLUMNS],
                            const double factors[KERNEL_COLUMNS], size_t count)
{
    const float *restrict a = columns[0], *restrict b = columns[1], *restrict c = columns[2], *restrict d = columns[3];
    const float *restrict e = columns[4], *restrict f = columns[5], *restrict g = columns[6], *restrict h = columns[7];
    const double fa = factors[0], fb = factors[1], fc = factors[2], fd = factors[3], fe = factors[4], ff = factors[5], fg = factors[6],
                 fh = factors[7];
    for (size_t j = 0; j < count; j++) {
        double va = (double)a[j], vb = (double)b[j], vc = (double)c[j], vd = (double)d[j];
        double ve = (double)e[j], vf = (double)f[j], vg = (double)g[j], vh = (double)h[j];
        sum[j] += ((va * fa + vb * fb) + (vc * fc + vd * fd)) + ((ve * fe + vf * ff) + (vg * fg + vh * fh));
        total[j] += ((va + vb) + (vc + vd)) + ((ve + vf) + (vg + vh));
    }
}

static inline float value_of(const struct kernel_value *rule, double sum, float weight)
{
    float v = (float)sum / weight * rule->scale + rule->offset;
    v = v > rule->low ? v : rule->low;
    v = v < rule->high ? v : rule->high;
    return weight > 0.0f ? v : rule->empty;
}

KERNEL void kernel_value(const struct kernel_value *rule, const double *restrict sum, const float *restrict weight, size_t count,
                         float *restrict value)
{
    const struct kernel_value own = *rule;
    for (size_t j = 0; j < count; j++)
        value[j] = value_of(&own, sum[j], weight[j]);
}

/* Stores a value in a vertex's struct scalar. Reads and writes the struct as one 64-bit number: the value is the lower half,
   and the flags in the upper half stay unchanged. Returns the absolute change as its bits, which sort as integers like the
   changes themselves (kernel_largest). */
static inline int32_t put(struct scalar *restrict at, float value)
{
    _Static_assert(sizeof(*at) == 8 && offsetof(struct scalar, value) == 0 && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "value first");
    uint64_t both;
    uint32_t bits;
    float before, change;
    int32_t change_bits;
    memcpy(&both, at, sizeof(both));
    bits = (uint32_t)both;
    memcpy(&before, &bits, sizeof(before));
    change = fabsf(value - before);
    memcpy(&change_bits, &change, sizeof(change_bits));
    memcpy(&bits, &value, sizeof(bits));
    both = (both & 0xffffffff00000000u) | bits;
    memcpy(at, &both, sizeof(both));
    return change_bits;
}

static inline float change_of(int32_t most, bool *changed)
{
    float change;
    memcpy(&change, &most, sizeof(change));
    *changed |= most > 0;
    return change;
}

KERNEL float kernel_store(const float *restrict value, size_t count, struct scalar *restrict at, bool *changed)
{
    int32_t most = 0;
    for (size_t j = 0; j < count; j++) {
        int32_t change = put(&at[j], value[j]);
        most = change > most ? change : most;
    }
    return change_of(most, changed);
}

/* Does the work of kernel_few() for one block of vertices. column_count is a constant after inlining, so that the compiler
   unrolls the loops. */
SIMD_BODY int32_t put_few(const struct kernel_value *rule, const struct kernel_columns *columns, size_t column_count,
                          const float *restrict weight, size_t count, struct scalar *restrict at)
{
    const struct kernel_value own_rule = *rule;
    const struct kernel_columns own = *columns;
    int32_t most = 0;
    for (size_t j = 0; j < count; j++) {
        double sum = 0;
        for (size_t k = 0; k < column_count; k++)
            sum += (double)own.column[k][j] * own.factor[k];
        int32_t change = put(&at[j], value_of(&own_rule, sum, weight[j]));
        most = change > most ? change : most;
    }
    return most;
}

KERNEL float kernel_few(const struct kernel_value *rule, const struct kernel_columns *columns, const float *restrict weight, size_t count,
                        struct scalar *restrict at, bool *changed)
{
    int32_t most = 0;
    switch (columns->count) {
    case 1: most = put_few(rule, columns, 1, weight, count, at); break;
    case 2: most = put_few(rule, columns, 2, weight, count, at); break;
    case 3: most = put_few(rule, columns, 3, weight, count, at); break;
    case 4: most = put_few(rule, columns, 4, weight, count, at); break;
    case 5: most = put_few(rule, columns, 5, weight, count, at); break;
    case 6: most = put_few(rule, columns, 6, weight, count, at); break;
    case 7: most = put_few(rule, columns, 7, weight, count, at); break;
    default: assert(!"few columns");
    }
    return change_of(most, changed);
}

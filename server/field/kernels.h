/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The arithmetic of the field on plain arrays: no files, no scene, no threads. Loops that the compiler turns into SIMD.
   `restrict` throughout: no two arrays overlap. Distances are metres, >= 0 or INFINITY (does not reach at all). */
#ifndef FIELD_KERNELS_H
#define FIELD_KERNELS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define KERNEL_BLOCK 256         /* vertices done at a time: what a block needs stays in the nearest cache */
#define KERNEL_COLUMNS 8         /* columns added at a time */
#define KERNEL_FACTOR_LIMIT 1e4f /* of strength and decay: exponents stay within what the loops can turn into integers */

struct scalar;

void kernel_euclidean(const float (*positions_m)[3], size_t count, const float point_m[3], float *restrict out_m);
/* near = min(near, distance) */
void kernel_nearest(const float *restrict distance_m, size_t count, float *restrict near_m);
/* The larger of most_m and the largest finite distance. */
float kernel_largest(const float *distance_m, size_t count, float most_m);

/* The scale of each vertex' weights, so that the largest is 1 and none overflows: for Shepard the largest strength among the
   nearest sensors, for Algorithm 1 the largest exponent. A sensor takes part where it is within reach or the nearest: where none is within
   reach, the nearest alone carries its value on, so that a triangle with one reached corner can be interpolated. */
void kernel_top_shepard(const float *restrict distance_m, const float *restrict near_m, size_t count, float strength, float *restrict top);
void kernel_top_paper(const float *restrict distance_m, const float *restrict near_m, size_t count, float reach_m, float radius_m,
                      float strength, float *restrict top);

/* log2 of x, or of 1e-37 where x is less. */
void kernel_log2(const float *restrict x, size_t count, float *restrict out);

struct kernel_column {
    const float *distance_m, *near_m, *top;
    size_t count;
    float reach_m, strength, decay;
    float power;            /* shepard */
    const float *near_log2; /* shepard with a power other than 2: of near_m */
    bool alike;             /* shepard: all strengths are equal */
    float radius_m;         /* paper */
};
/* (strength / top) (near / distance)^power; exactly 1 for the strongest of the nearest, exactly 0 for all others where near is 0.
   Either way, with a reach, times ((reach - distance) / (reach - near))^2: 1 for the nearest, 0 for others from the reach on. */
void kernel_shepard(const struct kernel_column *column, float *restrict weight);
/* weight = exp(d strength - top) (NULL: not wanted), term = weight d^decay, d = max(0, 1 - distance / radius). */
void kernel_paper(const struct kernel_column *column, float *restrict weight, float *restrict term);

/* sum += columns[0] factor[0] + ... , column_count <= KERNEL_COLUMNS. next: as many columns that are read after these, which are then
   on their way from memory; NULL: not known. */
void kernel_add(double *restrict sum, const float *const *columns, const double *factors, size_t column_count, size_t count,
                const float *const *next);

/* All KERNEL_COLUMNS of them: as kernel_add, and total += columns[0] + ... */
void kernel_add_both(double *restrict sum, double *restrict total, const float *const columns[KERNEL_COLUMNS],
                     const double factors[KERNEL_COLUMNS], size_t count);

struct kernel_value { /* value = clamp(sum / weight * scale + offset, low, high); `empty` where weight is 0 */
    float scale, offset, low, high, empty;
};
void kernel_value(const struct kernel_value *rule, const double *restrict sum, const float *restrict weight, size_t count,
                  float *restrict value);
/* Puts values in their places. Returns the largest change; *changed is set when any differs. */
float kernel_store(const float *restrict value, size_t count, struct scalar *restrict at, bool *changed);
/* kernel_add to zeros, kernel_value and kernel_store at once, with the same bits; column_count < KERNEL_COLUMNS. */
float kernel_few(const struct kernel_value *rule, const float *const *columns, const double *factors, size_t column_count,
                 const float *restrict weight, size_t count, struct scalar *restrict at, bool *changed);

#endif

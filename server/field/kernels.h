/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The field's inner loops on plain arrays: no files, no scene, no threads; written so that the compiler vectorises them.
   `restrict`: no two arrays overlap. Distances are metres, >= 0, or INFINITY (not connected). Call from any thread. */
#ifndef FIELD_KERNELS_H
#define FIELD_KERNELS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define KERNEL_BLOCK 256         /* number of vertices processed together, so that their data stays in the L1 cache */
#define KERNEL_COLUMNS 8         /* maximum number of columns (one sensor's weights at a block of vertices) that one call adds to a sum */
#define KERNEL_LINE 16           /* floats per cache line */
#define KERNEL_FACTOR_LIMIT 1e4f /* largest strength and decay; beyond it, exponents would overflow the loops' integer conversions */

struct scalar;

/* Decodes distance codes from an asset file (protocol/asset_distance.h) to metres. */
void kernel_distances(const uint16_t *restrict codes, size_t count, float *restrict out_m);
/* Writes the straight-line distance of each position from the point. */
void kernel_euclidean(const float (*positions_m)[3], size_t count, const float point_m[3], float *restrict out_m);
/* Takes the distances of all vertices from one sensor: lowers near_m[i], the distance from vertex i to the nearest sensor so
   far, to distance_m[i] if that is smaller. */
void kernel_nearest(const float *restrict distance_m, size_t count, float *restrict near_m);
/* Returns the largest finite one of `count` distances, but at least most_m. */
float kernel_largest(const float *distance_m, size_t count, float most_m);

/* Call once for each sensor: raises top[i] to the sensor's strength if no sensor is nearer to vertex i. Afterwards top[i] is
   the largest strength of all sensors that are nearest to the vertex at equal distance. kernel_shepard() divides by it, so that
   weights cannot overflow. */
void kernel_top_shepard(const float *restrict distance_m, const float *restrict near_m, size_t count, float strength, float *restrict top);
/* Call once for each sensor, with `top` all zero before the first call. Afterwards top[i] is the largest exponent of the
   sensors that contribute to vertex i in Algorithm 1 (Kim & Suh 2025). A sensor's exponent, to base 2, is max(0, 1 - distance /
   radius) strength / ln 2. Sensors contribute within their reach. If no sensor reaches vertex i, the nearest one contributes
   alone and continues its value, so that a triangle with one reached corner can be interpolated. */
void kernel_top_paper(const float *restrict distance_m, const float *restrict near_m, size_t count, float reach_m, float radius_m,
                      float strength, float *restrict top);

/* Writes log2 of x, or of 1e-37 for smaller x. */
void kernel_log2(const float *restrict x, size_t count, float *restrict out);

/* Inputs for computing one sensor's weights at a block of vertices. */
struct kernel_column {
    const float *distance_m, *near_m, *top;
    size_t count;
    float reach_m, strength, decay;
    /* power p of the interpolation shepard (inverse distance weighting): weights are proportional to 1 / distance^p */
    float power;
    /* [vertex]: log2 of near_m; only for the interpolation shepard (inverse distance weighting) with a power other than 2 */
    const float *near_log2;
    /* true: all sensors have the same strength, which allows a faster loop; only for the interpolation shepard (inverse
       distance weighting) */
    bool alike;
    float radius_m;         /* radius R, for interpolation paper */
};
/* Writes the sensor's Shepard weight at each vertex: (strength / top) (near / distance)^power, with near the distance of the
   nearest sensor. The weight is exactly 1 for the strongest of the nearest sensors; at a vertex where near is 0, it is exactly
   0 for all other sensors. If the reach is finite, the weight is multiplied by ((reach - distance) / (reach - near))^2: 1 for
   the nearest sensor, 0 for others from the reach on. */
void kernel_shepard(const struct kernel_column *column, float *restrict weight);
/* Writes two factors of Algorithm 1 (Kim & Suh 2025) for one sensor at each vertex: to `weight`, unless NULL, exp(d strength -
   top), with d = max(0, 1 - distance / radius); and to `term`, that weight times d^decay. A finite reach reduces both as in
   kernel_shepard(). */
void kernel_paper(const struct kernel_column *column, float *restrict weight, float *restrict term);

/* Adds columns[c] * factors[c] to sum, for column_count <= KERNEL_COLUMNS columns (one sensor's weights at a block of
   vertices). next: as many columns that will be read next, for prefetching; NULL: unknown. */
void kernel_add(double *restrict sum, const float *const *columns, const double *factors, size_t column_count, size_t count,
                const float *const *next);

/* Like kernel_add() for exactly KERNEL_COLUMNS columns, but also adds the columns to total, without their factors. */
void kernel_add_both(double *restrict sum, double *restrict total, const float *const columns[KERNEL_COLUMNS],
                     const double factors[KERNEL_COLUMNS], size_t count);

/* Rule for converting sums to values: value = clamp(sum / weight * scale + offset, low, high); `empty` where weight is 0. */
struct kernel_value {
    float scale, offset, low, high, empty;
};
/* Converts `count` sums (one per vertex), each with the sum of its weights, to field values, by the formula at struct
   kernel_value. */
void kernel_value(const struct kernel_value *rule, const double *restrict sum, const float *restrict weight, size_t count,
                  float *restrict value);
/* Stores the values of vertices in their scalars. Returns the largest change of a value, and sets *changed if any value
   differs. */
float kernel_store(const float *restrict value, size_t count, struct scalar *restrict at, bool *changed);
/* Columns of fewer than KERNEL_COLUMNS sensors, each with the factor of its sensor. */
struct kernel_columns {
    const float *column[KERNEL_COLUMNS - 1];
    double factor[KERNEL_COLUMNS - 1];
    size_t count;
};
/* Equivalent to kernel_add() on a sum of zeros, kernel_value() and kernel_store(), in one pass and with identical bits, for
   fewer than KERNEL_COLUMNS sensors. Returns the largest change, and sets *changed if any value differs. */
float kernel_few(const struct kernel_value *rule, const struct kernel_columns *columns, const float *restrict weight, size_t count,
                 struct scalar *restrict at, bool *changed);

#endif

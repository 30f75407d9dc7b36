/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values of lost sensors (those without usable reading) for a prepared interpolation. With P the precision matrix of all
   sensors, L the lost and U the used ones, the values v_L solve P_LL v_L = -P_LU v_U. With these values, the weights prepared
   for all sensors give the same field as the used sensors alone. Call from any thread; immutable once made. */
#ifndef FIELD_INFLUENCE_FILL_H
#define FIELD_INFLUENCE_FILL_H
#include <stddef.h>
#include <stdint.h>

struct influence_fill;

/* Computes the Cholesky factor of P_LL. precision: [sensor][sensor], must outlive the result; used: [sensor], 1 if used. The
   caller destroys the result. */
struct influence_fill *influence_fill_create(const double *precision, size_t count, const uint8_t *used);
/* Frees the factorisation. Accepts a pointer to NULL; sets the pointer to NULL. */
void influence_fill_destroy(struct influence_fill **fill);
/* Replaces the elements of `values` that belong to lost sensors (those without a usable reading) with the values that follow
   from the used sensors. Takes (lost * sensors) steps. */
void influence_fill_values(const struct influence_fill *fill, double *values);

/* Writes each sensor's precision given the used sensors: P_ii - P_iL (P_LL)^-1 P_Li, with L the lost sensors; for a lost sensor
   i, as if i were used again. Takes (lost * lost * sensors) steps. */
void influence_fill_own(const struct influence_fill *fill, double *own);

/* Adds to out[v], for `count` vertices, the variance due to the lost sensors: H_L (P_LL)^-1 H_L', with H_L the lost sensors'
   weights at the vertex. shares: H from the first of these vertices on, `stride` elements per sensor. For interpolations whose
   precision is in 1/unit^2. */
void influence_fill_variances(const struct influence_fill *fill, const float *shares, size_t stride, size_t count, double *out);

#endif

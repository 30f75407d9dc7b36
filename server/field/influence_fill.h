/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What lost sensors would say by a prepared interpolation: with precision P over all sensors, the lost ones L and the used ones U,
   P_LL v_L = -P_LU v_U. With these values in place of theirs, the weights prepared for all sensors give the field of the used ones alone.
   Thread: any; immutable once made. */
#ifndef FIELD_INFLUENCE_FILL_H
#define FIELD_INFLUENCE_FILL_H
#include <stddef.h>
#include <stdint.h>

struct influence_fill;

/* Factors P_LL. precision: [sensor][sensor], must outlive it; used: by sensor, 1 where it takes part. The caller destroys it. */
struct influence_fill *influence_fill_create(const double *precision, size_t count, const uint8_t *used);
/* Frees it. &NULL is fine; leaves NULL. */
void influence_fill_destroy(struct influence_fill **fill);
/* Replaces the values of lost sensors. Takes (lost * sensors) steps. */
void influence_fill_values(const struct influence_fill *fill, double *values);

#endif

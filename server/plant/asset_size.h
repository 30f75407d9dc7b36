/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How large assets are, and whether that can be: wrong units and axes show there. Pure. Thread: any. */
#ifndef PLANT_ASSET_SIZE_H
#define PLANT_ASSET_SIZE_H
#include "plant/plant.h"

enum { SIZE_WHY_BYTES = 300, SIZE_TEXT_BYTES = 64 };

/* "12.3 x 4.5 x 3.2 m": three digits of each; the last is the height. */
const char *asset_size_text(const double size_m[3], char out[SIZE_TEXT_BYTES]);
/* Not believable: by itself, or beside median_m, the median of the longest sides of the plant's assets (0: unknown). why: which unit would
   make it so. */
bool asset_size_doubtful(const struct plant_asset *asset, const double size_m[3], double median_m, char why[SIZE_WHY_BYTES]);
double asset_longest_m(const double size_m[3]);
double asset_median_m(const double *longest_m, size_t count); /* 0 of less than 3 */

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks whether the sizes of assets are plausible, which reveals wrong units and axes. Pure. Call from any thread. */
#ifndef PLANT_MODELS_ASSET_SIZE_H
#define PLANT_MODELS_ASSET_SIZE_H
#include "plant/plant.h"

enum { SIZE_WHY_BYTES = 300, SIZE_TEXT_BYTES = 64 };

/* Writes a size as "12.3 x 4.5 x 3.2 m", with three significant digits; the last number is the height. Returns `out`. */
const char *asset_size_text(const double size_m[3], char out[SIZE_TEXT_BYTES]);
/* Returns whether a size is implausible, by itself or compared with median_m, the median over all assets of the longest side
   (0: unknown). If so, `why` names a unit that would make the size plausible. */
bool asset_size_doubtful(const struct plant_asset *asset, const double size_m[3], double median_m, char why[SIZE_WHY_BYTES]);
double asset_longest_m(const double size_m[3]);               /* Returns the longest side. */
/* Returns the median of `count` lengths, the usual size of a plant's assets; 0 (unknown) if count < 3. */
double asset_median_m(const double *longest_m, size_t count);

#endif

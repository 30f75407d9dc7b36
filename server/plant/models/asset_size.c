/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decides whether the size of a piece of equipment or a building is plausible, and which units would make it plausible. */
#include "plant/models/asset_size.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/math/search.h"
#include "base/mem.h"

/* A plausible size of an asset is below LARGE_M, as halls and platforms are, and above SMALL_M, as transmitters are, in metres.
   A size is also implausible if it exceeds both LARGE_BESIDE_M metres and TIMES_MEDIAN times the median size of the plant's
   assets. */
#define LARGE_M 300.0
#define SMALL_M 0.03
#define LARGE_BESIDE_M 60.0
#define TIMES_MEDIAN 50.0
/* The longest side of most assets is between USUAL_LOW_M and USUAL_HIGH_M metres. */
#define USUAL_LOW_M 0.1
#define USUAL_HIGH_M 60.0

const char *asset_size_text(const double size_m[3], char out[SIZE_TEXT_BYTES])
{
    size_t length = 0;
    for (int axis = 0; axis < 3; axis++)
        length += (size_t)snprintf(out + length, SIZE_TEXT_BYTES - length, size_m[axis] < 99.95 ? "%s%.3g" : "%s%.0f", axis ? " x " : "",
                                   size_m[axis]);
    snprintf(out + length, SIZE_TEXT_BYTES - length, " m");
    return out;
}

double asset_longest_m(const double size_m[3])
{
    return fmax(size_m[0], fmax(size_m[1], size_m[2]));
}

double asset_median_m(const double *longest_m, size_t count)
{
    if (count < 3)
        return 0;
    double *sorted = mem_array(count, sizeof(*sorted));
    memcpy(sorted, longest_m, count * sizeof(*sorted));
    qsort(sorted, count, sizeof(*sorted), compare_doubles);
    double median_m = sorted[count / 2];
    mem_free(sorted);
    return median_m;
}

bool asset_size_doubtful(const struct plant_asset *asset, const double size_m[3], double median_m, char why[SIZE_WHY_BYTES])
{
    static const struct {
        const char *name;
        double m;
    } units[] = { { "mm", 1e-3 }, { "m", 1 }, { "cm", 1e-2 }, { "in", 0.0254 }, { "ft", 0.3048 } };
    double longest_m = asset_longest_m(size_m);
    bool beside = median_m > 0 && longest_m > LARGE_BESIDE_M && longest_m > TIMES_MEDIAN * median_m;
    char text[SIZE_TEXT_BYTES];
    if (longest_m <= LARGE_M && longest_m >= SMALL_M && !beside)
        return false;
    size_t length = (size_t)snprintf(why, SIZE_WHY_BYTES, "its size is %s", asset_size_text(size_m, text));
    if (beside && longest_m <= LARGE_M)
        length += (size_t)snprintf(why + length, SIZE_WHY_BYTES - length, ", %.0f times the size of other assets", longest_m / median_m);
    length += (size_t)snprintf(why + length, SIZE_WHY_BYTES - length, ": check its units");
    for (size_t i = 0; i < sizeof(units) / sizeof(*units); i++) {
        double times = units[i].m / asset->unit_m, other_m[3] = { size_m[0] * times, size_m[1] * times, size_m[2] * times };
        if (fabs(times - 1) < 1e-9 || longest_m * times < USUAL_LOW_M || longest_m * times > USUAL_HIGH_M)
            continue;
        snprintf(why + length, SIZE_WHY_BYTES - length, ". If the numbers of the model are in %s (`units: %s`), its size is %s",
                 units[i].name, units[i].name, asset_size_text(other_m, text));
        break;
    }
    return true;
}

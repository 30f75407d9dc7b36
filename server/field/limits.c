/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts readings to positions between the alarm limits of their tags (limits.h). */
#include "field/limits.h"

#include <math.h>

#define MAX_ALONE 1.999 /* position of a reading far above H if its tag has no HH limit: just below +2, because HH has position 2 */

/* The limits of one side (high or low); the low side is mirrored, so that larger values are always closer to an alarm. */
struct limit_side {
    double inner, outer; /* inner: the limit nearer to the normal range, H or L; outer: HH or LL; NaN: the tag has no such limit */
};

static double middle_of(const struct plant_group *group, const struct limit_side *low, const struct limit_side *high)
{
    double l = isfinite(low->inner) ? low->inner : low->outer, h = isfinite(high->inner) ? high->inner : high->outer;
    double range = group->max - group->min;
    if (isfinite(l) && isfinite(h))
        return (l + h) / 2;
    if (isfinite(h))
        return group->min < h ? group->min : h - range / 2;
    return group->max > l ? group->max : l + range / 2;
}

/* Returns a value's position between the limits of one side (high or low). value, inner and outer are relative to the middle,
   which has position 0. */
static double side_place(double value, double inner, double outer)
{
    if (!isfinite(inner) && !isfinite(outer))
        return 0;
    if (!isfinite(inner))
        return value < outer ? value / outer * 0.999 : 2 + (value - outer) / (2 * outer);
    if (value < inner)
        return value / inner;
    if (!isfinite(outer))
        return fmin(value / inner, MAX_ALONE);
    return 1 + (value - inner) / (outer - inner);
}

double limit_place(const struct plant_group *group, const struct plant_tag *tag, double value)
{
    const double *limits = tag->alarms.limits;
    struct limit_side low = { limits[LIMIT_L], limits[LIMIT_LL] }, high = { limits[LIMIT_H], limits[LIMIT_HH] };
    if (!isfinite(low.inner) && !isfinite(low.outer) && !isfinite(high.inner) && !isfinite(high.outer))
        return NAN;
    double middle = middle_of(group, &low, &high);
    double place = value >= middle ? side_place(value - middle, high.inner - middle, high.outer - middle)
                                   : -side_place(middle - value, middle - low.inner, middle - low.outer);
    return fmin(fmax(place, -LIMIT_PLACE_MOST), LIMIT_PLACE_MOST);
}

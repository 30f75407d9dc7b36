/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Alarms by the limits of a tag. */
#include "value/alarms.h"

#include <math.h>

#include "value/quality.h"

int alarm_active(const struct plant_tag *tag, const struct reading *reading)
{
    const double *limits = tag->limits, value = reading->value;
    if (!quality_is_good(reading->quality) || !isfinite(value))
        return ALARM_NONE;
    if (value >= limits[LIMIT_HH]) /* false where there is none */
        return LIMIT_HH;
    if (value <= limits[LIMIT_LL])
        return LIMIT_LL;
    if (value >= limits[LIMIT_H])
        return LIMIT_H;
    return value <= limits[LIMIT_L] ? LIMIT_L : ALARM_NONE;
}

const char *alarm_name(int alarm)
{
    return alarm == ALARM_NONE ? NULL : plant_limit_names[alarm];
}

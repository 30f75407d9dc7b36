/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decides which shift is on duty, and which rules of `notify` apply to an alarm. */
#include "notify/shift.h"

#include <fnmatch.h>
#include <time.h>

enum { DAYS = 7, MIN_PER_HOUR = 60 };

bool shift_is_on(const struct notify_shift *shift, int64_t utc_us)
{
    time_t s = (time_t)(utc_us / 1000000);
    struct tm local;
    if (!localtime_r(&s, &local))
        return true;
    int minute = local.tm_hour * MIN_PER_HOUR + local.tm_min, day = (local.tm_wday + DAYS - 1) % DAYS;
    bool today = shift->days >> day & 1, since_yesterday = shift->days >> ((day + DAYS - 1) % DAYS) & 1;
    if (shift->from_min == shift->to_min && shift->from_min == 0)
        return today;
    if (shift->from_min < shift->to_min)
        return today && minute >= shift->from_min && minute < shift->to_min;
    return (today && minute >= shift->from_min) || (since_yesterday && minute < shift->to_min);
}

static bool in_area(const struct notify_rule *rule, const struct plant_asset *asset, const char *name)
{
    for (size_t i = 0; i < rule->areas.count; i++) {
        const char *pattern = rule->areas.at[i];
        if (fnmatch(pattern, name, 0) == 0)
            return true;
        if (asset && (fnmatch(pattern, asset->area, 0) == 0 || fnmatch(pattern, asset->id, 0) == 0 || fnmatch(pattern, asset->tag, 0) == 0))
            return true;
    }
    return rule->areas.count == 0;
}

uint32_t rules_for(const struct plant *plant, const char *name, int tag, int priority, int64_t utc_us)
{
    int of = tag < 0 ? -1 : plant->tags[tag].asset;
    const struct plant_asset *asset = of < 0 ? NULL : &plant->assets[of];
    uint32_t rules = 0;
    for (size_t i = 0; i < plant->notify->rule_count; i++) {
        const struct notify_rule *rule = &plant->notify->rules[i];
        if (priority <= rule->priority && in_area(rule, asset, name) && shift_is_on(&rule->shift, utc_us))
            rules |= UINT32_C(1) << i;
    }
    return rules;
}

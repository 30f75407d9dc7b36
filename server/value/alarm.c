/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names of alarm kinds and states, and alarms that follow from a tag's limits alone, without an alarm service. */
#include "value/alarm.h"

#include <math.h>
#include <string.h>

#include "value/quality.h"

static const char *const kind_names[ALARM_KINDS] = { NULL, "LL", "L", "H", "HH", "ALM", "BAD", "LINK" };
static const char *const status_names[ALARM_STATUSES] = { "normal",  "active",  "unacknowledged", "acknowledged",  "returned",
                                                          "latched", "shelved", "suppressed",     "out_of_service" };

const char *alarm_kind_name(enum alarm_kind kind)
{
    return kind_names[kind];
}

enum alarm_kind alarm_kind_find(const char *name)
{
    for (int i = 1; i < ALARM_KINDS; i++)
        if (!strcmp(kind_names[i], name))
            return (enum alarm_kind)i;
    return ALARM_NONE;
}

const char *alarm_status_name(enum alarm_status status)
{
    return status_names[status];
}

enum alarm_status alarm_status_find(const char *name)
{
    int i = 0;
    while (i < ALARM_STATUSES && strcmp(status_names[i], name) != 0)
        i++;
    return (enum alarm_status)i;
}

bool alarm_status_is_annunciated(enum alarm_status status)
{
    return status != ALARM_NORMAL && status < ALARM_SHELVED;
}

bool alarm_status_is_cleared(enum alarm_status status)
{
    return status == ALARM_RETURNED || status == ALARM_LATCHED;
}

static bool is_outer(enum alarm_kind kind)
{
    return kind == ALARM_LL || kind == ALARM_HH;
}

static bool is_waiting(enum alarm_status status)
{
    return status == ALARM_UNACKNOWLEDGED || status == ALARM_RETURNED;
}

bool alarm_graver(const struct alarm_grade *a, const struct alarm_grade *b)
{
    if (alarm_status_is_cleared(a->status) != alarm_status_is_cleared(b->status))
        return alarm_status_is_cleared(b->status);
    if (a->priority != b->priority)
        return a->priority < b->priority;
    if (is_outer(a->kind) != is_outer(b->kind))
        return is_outer(a->kind);
    return is_waiting(a->status) && !is_waiting(b->status);
}

int alarm_priority(const struct plant_tag *tag, enum alarm_kind kind)
{
    int priority = tag->alarms.settings.priority ? tag->alarms.settings.priority : ALARM_PRIORITY_DEFAULT;
    priority += kind == ALARM_L || kind == ALARM_H;
    return kind == ALARM_BAD || priority > ALARM_PRIORITIES ? ALARM_PRIORITIES : priority;
}

bool alarm_reaches(double value, double limit, bool high)
{
    return high ? (float)value >= (float)limit : (float)value <= (float)limit;
}

enum alarm_kind alarm_beyond(const struct plant_tag *tag, const struct reading *reading)
{
    const double *limits = tag->alarms.limits, value = reading->value;
    if (quality_is_bad(reading->quality) || !isfinite(value))
        return ALARM_NONE;
    if (alarm_reaches(value, limits[LIMIT_HH], true))
        return ALARM_HH;
    if (alarm_reaches(value, limits[LIMIT_LL], false))
        return ALARM_LL;
    if (alarm_reaches(value, limits[LIMIT_H], true))
        return ALARM_H;
    return alarm_reaches(value, limits[LIMIT_L], false) ? ALARM_L : ALARM_NONE;
}

void alarm_by_limits(const struct plant *plant, struct snapshot *snapshot)
{
    for (size_t i = 0; i < snapshot->count; i++) {
        struct reading *reading = &snapshot->readings[i];
        reading->alarm = (uint8_t)alarm_beyond(&plant->tags[i], reading);
        reading->alarm_status = reading->alarm ? ALARM_ACTIVE : ALARM_NORMAL;
    }
}

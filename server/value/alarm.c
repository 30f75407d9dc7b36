/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names of alarms, and alarms by nothing but the limits of a tag. */
#include "value/alarm.h"

#include <math.h>
#include <string.h>

#include "value/quality.h"

static const char *const kind_names[ALARM_KINDS] = { NULL, "LL", "L", "H", "HH", "ALM", "BAD", "LINK" };
static const char *const word_names[ALARM_WORDS] = { "normal",  "active",  "unacknowledged", "acknowledged",  "returned",
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

const char *alarm_word_name(enum alarm_word word)
{
    return word_names[word];
}

enum alarm_word alarm_word_find(const char *name)
{
    int i = 0;
    while (i < ALARM_WORDS && strcmp(word_names[i], name) != 0)
        i++;
    return (enum alarm_word)i;
}

bool alarm_word_calls(enum alarm_word word)
{
    return word != ALARM_NORMAL && word < ALARM_SHELVED;
}

bool alarm_word_gone(enum alarm_word word)
{
    return word == ALARM_RETURNED || word == ALARM_LATCHED;
}

static bool is_outer(enum alarm_kind kind)
{
    return kind == ALARM_LL || kind == ALARM_HH;
}

static bool is_waiting(enum alarm_word word)
{
    return word == ALARM_UNACKNOWLEDGED || word == ALARM_RETURNED;
}

bool alarm_graver(const struct alarm_grade *a, const struct alarm_grade *b)
{
    if (alarm_word_gone(a->word) != alarm_word_gone(b->word))
        return alarm_word_gone(b->word);
    if (a->priority != b->priority)
        return a->priority < b->priority;
    if (is_outer(a->kind) != is_outer(b->kind))
        return is_outer(a->kind);
    return is_waiting(a->word) && !is_waiting(b->word);
}

int alarm_priority(const struct plant_tag *tag, enum alarm_kind kind)
{
    int priority = tag->alarming.priority ? tag->alarming.priority : ALARM_PRIORITY_DEFAULT;
    priority += kind == ALARM_L || kind == ALARM_H;
    return kind == ALARM_BAD || priority > ALARM_PRIORITIES ? ALARM_PRIORITIES : priority;
}

enum alarm_kind alarm_beyond(const struct plant_tag *tag, const struct reading *reading)
{
    const double *limits = tag->limits, value = reading->value;
    if (quality_is_bad(reading->quality) || !isfinite(value))
        return ALARM_NONE;
    if (value >= limits[LIMIT_HH]) /* false where there is none */
        return ALARM_HH;
    if (value <= limits[LIMIT_LL])
        return ALARM_LL;
    if (value >= limits[LIMIT_H])
        return ALARM_H;
    return value <= limits[LIMIT_L] ? ALARM_L : ALARM_NONE;
}

void alarm_by_limits(const struct plant *plant, struct snapshot *snapshot)
{
    for (size_t i = 0; i < snapshot->count; i++) {
        struct reading *reading = &snapshot->readings[i];
        reading->alarm = (uint8_t)alarm_beyond(&plant->tags[i], reading);
        reading->alarm_word = reading->alarm ? ALARM_ACTIVE : ALARM_NORMAL;
    }
}

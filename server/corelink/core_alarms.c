/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts alarms to JSON and back; an alarm is identified by its kind and the name of its tag or device. Times are also sent
   as ages, so that the daemons' machines need no common clock. */
#include "corelink/core_alarms.h"

#include <math.h>
#include <stdio.h>

#include "base/clock.h"
#include "base/mem.h"

static void add_alarm(void *arg, const struct alarm *alarm)
{
    const struct alarm_state *state = &alarm->state;
    json_t *one = json_pack("{s:s,s:s,s:b,s:b,s:b,s:i,s:b,s:b,s:I,s:I,s:I,s:s,s:s}", "name", alarm->name, "kind",
                            alarm_kind_name(alarm->kind), "active", state->active, "unacknowledged", state->unacknowledged, "latched",
                            state->latched, "aside", (int)state->aside, "there", alarm->acknowledged_there, "held", alarm->held, "raised",
                            (json_int_t)alarm->raised_utc_ns, "changed", (json_int_t)alarm->changed_utc_ns, "until",
                            (json_int_t)alarm->until.utc_ns, "who", alarm->who, "reason", alarm->reason);
    if (isfinite(alarm->value))
        json_object_set_new(one, "value", json_real(alarm->value));
    json_array_insert_new(arg, 0, one); /* the newest comes first */
}

json_t *core_alarms_message(struct alarm_service *service, uint64_t since, int64_t now_utc_ns, uint64_t *number)
{
    json_t *list = json_array();
    *number = alarm_service_changes(service, since, add_alarm, list);
    return json_pack("{s:s,s:b,s:I,s:o}", "type", "alarms", "whole", since == 0, "utc", (json_int_t)now_utc_ns, "list", list);
}

static void add_row(void *arg, const struct journal_entry *row)
{
    json_t *one = json_pack("{s:s,s:s,s:i,s:i,s:i,s:i,s:I,s:s,s:s}", "name", row->tag, "kind", alarm_kind_name(row->alarm.kind), "event",
                            (int)row->event, "before", (int)row->before, "after", (int)row->after, "priority", row->alarm.priority, "utc",
                            (json_int_t)row->utc_ns, "who", row->who, "reason", row->reason);
    if (isfinite(row->value))
        json_object_set_new(one, "value", json_real(row->value));
    if (isfinite(row->alarm.limit))
        json_object_set_new(one, "limit", json_real(row->alarm.limit));
    if (row->has_unit)
        json_object_set_new(one, "unit", json_string(row->unit));
    json_array_append_new(arg, one);
}

void core_alarms_add_rows(json_t *message, struct alarm_service *service, uint64_t *row)
{
    json_t *rows = json_array();
    *row = alarm_service_rows(service, *row, add_row, rows);
    json_object_set_new(message, "rows", rows);
}

static bool get_text(const json_t *o, const char *name, char *out, size_t size)
{
    const char *text = json_string_value(json_object_get(o, name));
    return text && (size_t)snprintf(out, size, "%s", text) < size;
}

static bool get_ns(const json_t *o, const char *name, int64_t *out)
{
    const json_t *value = json_object_get(o, name);
    *out = json_integer_value(value);
    return json_is_integer(value) && *out >= 0;
}

static bool is_told(const json_t *o, const char *name)
{
    return json_is_true(json_object_get(o, name));
}

static bool read_one(const json_t *one, int64_t core_utc_ns, int64_t now_mono_ns, struct alarm *out)
{
    const json_t *value = json_object_get(one, "value");
    const char *kind = json_string_value(json_object_get(one, "kind"));
    json_int_t aside = json_integer_value(json_object_get(one, "aside"));
    *out = (struct alarm){ .name = json_string_value(json_object_get(one, "name")),
                           .kind = kind ? alarm_kind_find(kind) : ALARM_NONE,
                           .value = value ? json_number_value(value) : NAN,
                           .acknowledged_there = is_told(one, "there"),
                           .held = is_told(one, "held"),
                           .state = { .active = is_told(one, "active"),
                                      .unacknowledged = is_told(one, "unacknowledged"),
                                      .latched = is_told(one, "latched"),
                                      .aside = (uint8_t)aside } };
    bool good = out->name && out->kind != ALARM_NONE && aside >= 0 && aside <= ALARM_ASIDE_ALL &&
                get_ns(one, "raised", &out->raised_utc_ns) && get_ns(one, "changed", &out->changed_utc_ns) &&
                get_ns(one, "until", &out->until.utc_ns) && get_text(one, "who", out->who, sizeof(out->who)) &&
                get_text(one, "reason", out->reason, sizeof(out->reason));
    if (good && out->until.utc_ns)
        out->until.mono_ns = now_mono_ns + (out->until.utc_ns - core_utc_ns);
    if (good)
        out->raised_mono_ns = out->raised_utc_ns ? now_mono_ns - (core_utc_ns - out->raised_utc_ns) : 0;
    return good;
}

static bool get_number(const json_t *o, const char *name, int least, int most, int *out)
{
    const json_t *value = json_object_get(o, name);
    json_int_t number = json_integer_value(value);
    *out = (int)number;
    return json_is_integer(value) && number >= least && number <= most;
}

static bool read_row(const json_t *one, struct journal_entry *out)
{
    const json_t *value = json_object_get(one, "value"), *limit = json_object_get(one, "limit");
    const char *kind = json_string_value(json_object_get(one, "kind"));
    int event, before, after;
    *out = (struct journal_entry){ .changed = true, .value = value ? json_number_value(value) : NAN };
    out->alarm.kind = kind ? alarm_kind_find(kind) : ALARM_NONE;
    out->alarm.limit = limit ? json_number_value(limit) : NAN;
    bool good = out->alarm.kind != ALARM_NONE && get_text(one, "name", out->tag, sizeof(out->tag)) &&
                get_text(one, "who", out->who, sizeof(out->who)) && get_text(one, "reason", out->reason, sizeof(out->reason)) &&
                get_ns(one, "utc", &out->utc_ns) && get_number(one, "event", 0, ALARM_EVENTS - 1, &event) &&
                get_number(one, "before", 0, ALARM_STATUSES - 1, &before) && get_number(one, "after", 0, ALARM_STATUSES - 1, &after) &&
                get_number(one, "priority", 1, ALARM_PRIORITIES, &out->alarm.priority);
    if (good) {
        /* earlier versions of the program do not send the alarm's unit */
        out->has_unit = get_text(one, "unit", out->unit, sizeof(out->unit));
        out->event = (enum alarm_event)event;
        out->before = (enum alarm_status)before;
        out->after = (enum alarm_status)after;
    }
    return good;
}

/* Copies the core's new alarm journal rows (`rows`) to this daemon's journal. Call it before the alarm states that result from
   these rows are stored in the same file. Returns NULL, or what is wrong with the rows (static text). */
static const char *take_rows(struct alarm_service *service, const json_t *rows)
{
    const json_t *one;
    size_t i;
    json_array_foreach(rows, i, one)
    {
        struct journal_entry row;
        if (!read_row(one, &row))
            return "the core's message has an invalid alarm event; do both nodes run the same version?";
        alarm_service_mirror_row(service, &row);
    }
    return NULL;
}

const char *core_alarms_take(struct alarm_service *service, const json_t *message)
{
    const json_t *list = json_object_get(message, "list");
    size_t count = json_array_size(list);
    int64_t utc_ns;
    if (!json_is_array(list) || !get_ns(message, "utc", &utc_ns))
        return "the core's message is not a list of alarms; do both nodes run the same version?";
    struct alarm *alarms = mem_array(count + 1, sizeof(*alarms));
    const char *why = NULL;
    for (size_t i = 0; i < count && !why; i++)
        if (!read_one(json_array_get(list, i), utc_ns, clock_mono_ns(), &alarms[i]))
            why = "the core's message has an invalid alarm; do both nodes run the same version?";
    if (!why)
        why = take_rows(service, json_object_get(message, "rows"));
    if (!why)
        why = alarm_service_mirror(service, alarms, count, json_is_true(json_object_get(message, "whole")));
    mem_free(alarms);
    return why;
}

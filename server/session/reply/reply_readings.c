/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds JSON texts about readings and their data sources. */
#include "session/reply/reply_impl.h"

#include "base/text/json_text.h"
#include "message/json_values.h"
#include "value/alarm.h"
#include "value/quality.h"

static json_t *age_ms(const struct reading *reading)
{
    return reading->age_ns == INT64_MAX ? json_null() : json_integer(reading->age_ns / 1000000);
}

static json_t *value_of(const struct reading *reading)
{
    return quality_is_bad(reading->quality) ? json_null() : reading_number(reading->value);
}

static json_t *alarm_of(const struct reading *reading)
{
    return string(alarm_kind_name((enum alarm_kind)reading->alarm));
}

/* Returns whether the reading can be sent as a bare value, because it has good quality and no alarm. */
static bool is_plain(const struct reading *reading)
{
    return reading->quality == QUALITY_GOOD && !reading->alarm;
}

static void add_alarm(const struct plant *plant, size_t tag, const struct reading *reading, json_t *row)
{
    if (!reading->alarm)
        return;
    json_array_append_new(row, json_integer(alarm_priority(&plant->tags[tag], (enum alarm_kind)reading->alarm)));
    json_array_append_new(row, string(alarm_status_name((enum alarm_status)reading->alarm_status)));
}

char *reply_tags_text(const struct plant *plant, const struct snapshot *snapshot, uint32_t *sent, bool all)
{
    json_t *values = json_array();
    int64_t oldest_ns = 0; /* age of the oldest of those readings that are sent as a bare value, that is, without quality and age */
    for (size_t i = 0; i < snapshot->count; i++) {
        const struct reading *r = &snapshot->readings[i];
        if (!all && sent[i] == r->changes)
            continue;
        sent[i] = r->changes;
        if (is_plain(r)) {
            oldest_ns = r->age_ns > oldest_ns ? r->age_ns : oldest_ns;
            json_array_append_new(values, json_pack("[I,o]", (json_int_t)i, value_of(r)));
        } else {
            json_t *row = json_pack("[I,o,o,o,o,o]", (json_int_t)i, value_of(r), string(quality_class(r->quality)),
                                    string(quality_name(r->quality)), age_ms(r), alarm_of(r));
            add_alarm(plant, i, r, row);
            json_array_append_new(values, row);
        }
    }
    json_t *object = json_pack("{s:s,s:I,s:I,s:o}", "type", "tags", "time_us", us(snapshot->taken_utc_ns), "age_ms",
                               (json_int_t)(oldest_ns / 1000000), "values", values);
    return json_text(object, READING_DIGITS);
}

/* Returns the names of what is not recorded. */
static json_t *unrecorded(unsigned which)
{
    static const char *const names[UNRECORDED_COUNT] = { "readings", "alarms", "actions", "lists" };
    json_t *list = json_array();
    for (int i = 0; i < UNRECORDED_COUNT; i++)
        if (which & 1u << i)
            json_array_append_new(list, json_string(names[i]));
    return list;
}

char *reply_status_text(const struct session_context *context, enum role role, int64_t now_utc_ns)
{
    json_t *links = json_array();
    for (size_t i = 0; i < context->plant->source_count; i++) {
        const struct plant_source *source = &context->plant->sources[i];
        json_t *link = json_pack("{s:o,s:b}", "source", string(source->id), "up", context->readings.links_up[i]);
        if (source->simulated)
            json_object_set_new(link, "simulated", json_true());
        json_array_append_new(links, link);
    }
    if (context->core.hand_on) /* adds one more source to the list on a renderer (daemon that draws for a core): the link to its core */
        json_array_append_new(links, json_pack("{s:s,s:b}", "source", "core", "up", context->core.up));
    json_t *status = json_pack("{s:s,s:o,s:I,s:b,s:b}", "type", "status", "links", links, "time_us", us(now_utc_ns), "live",
                               context->readings.live, "clock_set", context->readings.clock.set);
    if (context->readings.clock.error_s > 0)
        json_object_set_new(status, "clock_error_ms", json_integer(clock_state_error_ms(&context->readings.clock)));
    if (context->readings.clock.leap_s)
        json_object_set_new(status, "leap_s", json_integer(context->readings.clock.leap_s));
    if (role >= ROLE_OPERATOR && context->unrecorded)
        json_object_set_new(status, "unrecorded", unrecorded(context->unrecorded));
    if (role == ROLE_ENGINEER && context->standby)
        json_object_set(status, "standby", context->standby);
    return json_text(status, DIGITS);
}

/* Returns the age of the oldest reading that is not bad; JSON null if all are bad. */
static json_t *oldest_age_ms(const struct snapshot *snapshot)
{
    const struct reading *oldest = NULL;
    for (size_t i = 0; i < snapshot->count; i++) {
        const struct reading *reading = &snapshot->readings[i];
        if (!quality_is_bad(reading->quality) && (!oldest || reading->age_ns > oldest->age_ns))
            oldest = reading;
    }
    return oldest ? age_ms(oldest) : json_null();
}

char *reply_pong_text(const struct snapshot *snapshot, double t, int64_t now_utc_ns)
{
    return json_text(json_pack("{s:s,s:f,s:I,s:o}", "type", "pong", "t", t, "time_us", us(now_utc_ns), "oldest_age_ms",
                               oldest_age_ms(snapshot)),
                     EXACT_DIGITS);
}

char *reply_api_tags_text(const struct session_context *context, size_t first, size_t count)
{
    const struct plant *plant = context->plant;
    json_t *list = json_array();
    for (size_t i = first; i < plant->tag_count && i - first < count; i++) {
        const struct reading *r = &context->readings.snapshot->readings[i];
        json_t *object = reply_tag(plant, &plant->tags[i]);
        json_object_set_new(object, "value", value_of(r));
        json_object_set_new(object, "quality", string(quality_class(r->quality)));
        json_object_set_new(object, "quality_name", string(quality_name(r->quality)));
        json_object_set_new(object, "age_ms", age_ms(r));
        if (plant_tag_simulated(plant, (int)i))
            json_object_set_new(object, "simulated", json_true());
        json_array_append_new(list, object);
    }
    json_t *page = json_pack("{s:I,s:I,s:I,s:o}", "time_us", us(context->readings.snapshot->taken_utc_ns), "total",
                             (json_int_t)plant->tag_count, "first", (json_int_t)first, "tags", list);
    return json_text(page, READING_DIGITS);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes lists of alarms and rows of the alarm journal as JSON and CSV. */
#include "message/alarm_text.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "alarm/devices.h"
#include "base/clock.h"
#include "base/mem.h"
#include "base/text/json_text.h"
#include "base/text/timestamp.h"
#include "message/json_values.h"

enum { ROWS_DEFAULT = 1000, MAX_ROWS = 10000 };

/* largest age of a cached list of alarms: the list contains the present time */
static const int64_t CACHED_TEXT_MAX_AGE_NS = NS_PER_S / 10;

static const char *mode_name(enum alarm_mode mode)
{
    static const char *const names[] = { [ALARMS_DISPLAY] = "display", [ALARMS_MIRROR] = "mirror", [ALARMS_LOCAL] = "local" };
    return names[mode];
}

static json_t *instant(int64_t utc_ns)
{
    return utc_ns ? json_integer(utc_ns / 1000) : json_null();
}

/* --- messages to sessions ---------------------------------------------------------------------------------------------------- */

static void add_row(void *arg, const struct alarm *alarm)
{
    enum alarm_status word = alarm_status_of(alarm);
    json_t *of = alarm->tag < 0 ? string(alarm->name) : json_integer(alarm->tag);
    json_t *row = json_pack("[o,s,s]", of, alarm_kind_name(alarm->kind), alarm_status_name(word));
    json_array_append_new(arg, row);
    if (word == ALARM_NORMAL)
        return;
    json_t *rest = json_pack("[i,o,o,o,b,b]", alarm->priority, instant(alarm->raised_utc_ns), reading_number(alarm->value),
                             reading_number(alarm->limit), alarm->state.active, alarm->held);
    json_array_extend(row, rest);
    json_decref(rest);
    if (alarm->who[0] || alarm->reason[0] || alarm->until.utc_ns) {
        json_array_append_new(row, instant(alarm->until.utc_ns));
        json_array_append_new(row, string(alarm->who));
        json_array_append_new(row, string(alarm->reason));
    }
}

char *alarms_text(struct alarm_text_cache *cache, struct alarm_service *alarm_service, const struct plant *plant, int64_t now_utc_ns,
                  uint64_t *number_out)
{
    uint64_t since = *number_out;
    bool recent = cache && cache->text && llabs(now_utc_ns - cache->utc_ns) <= CACHED_TEXT_MAX_AGE_NS;
    if (recent && cache->since == since && cache->number == alarm_service_number(alarm_service)) {
        *number_out = cache->number;
        return mem_strdup(cache->text);
    }
    json_t *rows = json_array();
    *number_out = alarm_service_changes(alarm_service, since, add_row, rows);
    char *text = json_text(json_pack("{s:s,s:s,s:b,s:I,s:o}", "type", "alarms", "mode", mode_name(plant->alarms), "all", since == 0,
                                     "time_us", (json_int_t)(now_utc_ns / 1000), "alarms", rows),
                           READING_DIGITS);
    if (cache) {
        alarm_text_cache_finish(cache);
        *cache = (struct alarm_text_cache){ mem_strdup(text), since, *number_out, now_utc_ns };
    }
    return text;
}

void alarm_text_cache_finish(struct alarm_text_cache *cache)
{
    mem_free(cache->text);
    *cache = (struct alarm_text_cache){ 0 };
}

/* --- parsing queries -------------------------------------------------------------------------------------------------------- */

static bool take_count(const char *name, const char *text, int64_t low, int64_t high, int64_t *out, struct message_error *error)
{
    char *end;
    long long value = strtoll(text, &end, 10);
    if (end == text || *end || value < low || value > high) {
        message_fail(error, "bad_field", "%s: expected a number from %lld to %lld, found '%.60s'", name, (long long)low, (long long)high,
                     text);
        return false;
    }
    *out = value;
    return true;
}

static bool is_device(const struct plant *plant, const char *name)
{
    struct devices *devices = devices_create(plant);
    bool found = devices_find(devices, name) >= 0;
    devices_destroy(&devices);
    return found;
}

static bool take_tag(const struct plant *plant, const char *text, struct alarm_query *query, struct message_error *error)
{
    strncpy(query->tag, text, sizeof(query->tag) - 1);
    if (plant_find_tag(plant, text) >= 0 || is_device(plant, text))
        return true;
    message_refuse_with(error, "unknown_tag", "tag", REFUSAL_NO_TAG, "name=%.60s", text);
    return false;
}

static bool take(const struct plant *plant, bool journal, const char *arg, int64_t now_us, struct alarm_query *query,
                 struct message_error *error)
{
    size_t n = strcspn(arg, "=");
    const char *value = arg[n] ? arg + n + 1 : "";
    int64_t count;
#define IS(name) (n == strlen(name) && !memcmp(arg, name, n))
    if (IS("limit")) {
        bool good = take_count("limit", value, 1, MAX_ROWS, &count, error);
        query->limit = good ? (int)count : query->limit;
        return good;
    }
    if (IS("tag"))
        return take_tag(plant, value, query, error);
    if (IS("offset") && !journal)
        return take_count("offset", value, 0, INT64_MAX, &query->offset, error);
    if (IS("before") && journal)
        return take_count("before", value, 1, INT64_MAX, &query->before_id, error);
    if (IS("from") && journal)
        return message_take_time("from", value, now_us, &query->from_us, error);
    if (IS("to") && journal)
        return message_take_time("to", value, now_us, &query->to_us, error);
    if (IS("format") && (!strcmp(value, "csv") || !strcmp(value, "json"))) {
        query->csv = value[0] == 'c';
        return true;
    }
#undef IS
    message_fail(error, "unknown_field", "unknown argument '%.60s': expected limit, tag, format (json or csv)%s", arg,
                 journal ? ", from, to, before" : " or offset");
    return false;
}

bool alarm_query_parse(const struct plant *plant, bool journal, const char *const *args, size_t count, int64_t now_us,
                       struct alarm_query *query, struct message_error *error)
{
    *query = (struct alarm_query){ .limit = ROWS_DEFAULT, .from_us = INT64_MIN, .to_us = INT64_MAX, .before_id = INT64_MAX };
    for (size_t i = 0; i < count; i++)
        if (!take(plant, journal, args[i], now_us, query, error))
            return false;
    return true;
}

/* --- answers to queries ----------------------------------------------------------------------------------------------------- */

struct listing {
    const struct plant *plant;
    const struct alarm_query *query;
    int64_t passed, total;
    int count;
    json_t *rows;
    struct text csv;
};

static const char SPECIAL[] = ",\"\n\r"; /* characters that require quotes around a CSV cell that contains one */

static void add_csv_number(struct text *out, double value)
{
    /* adding 0.0 turns -0.0 into 0.0, so that no minus sign is sent */
    if (isfinite(value))
        text_add(out, fabs(value) < 1e9 ? "%.9g" : "%.15g", value + 0.0);
}

static void add_csv_alarm(struct listing *listing, const struct alarm *alarm)
{
    struct text *out = &listing->csv;
    char when[TIMESTAMP_BYTES] = "";
    timestamp_print(alarm->raised_utc_ns / 1000, when);
    text_add_cell(out, alarm->name, SPECIAL);
    text_add(out, ",%s,%s,%d,%s,", alarm_kind_name(alarm->kind), alarm_status_name(alarm_status_of(alarm)), alarm->priority, when);
    add_csv_number(out, alarm->value);
    text_add(out, ",");
    add_csv_number(out, alarm->limit);
    timestamp_print(alarm->until.utc_ns / 1000, when);
    text_add(out, ",%d,%s,", alarm->held, alarm->until.utc_ns ? when : "");
    text_add_cell(out, alarm->who, SPECIAL);
    text_add(out, ",");
    text_add_cell(out, alarm->reason, SPECIAL);
    text_add(out, "\n");
}

static json_t *alarm_object(const struct alarm *alarm)
{
    return json_pack("{s:o,s:s,s:s,s:i,s:o,s:o,s:o,s:o,s:b,s:b,s:o,s:o,s:o}", "tag", string(alarm->name), "kind",
                     alarm_kind_name(alarm->kind), "state", alarm_status_name(alarm_status_of(alarm)), "priority", alarm->priority,
                     "raised_us", instant(alarm->raised_utc_ns), "changed_us", instant(alarm->changed_utc_ns), "value",
                     reading_number(alarm->value), "limit", reading_number(alarm->limit), "active", alarm->state.active, "held",
                     alarm->held, "until_us", instant(alarm->until.utc_ns), "who", string(alarm->who), "reason", string(alarm->reason));
}

static void list(void *arg, const struct alarm *alarm)
{
    struct listing *listing = arg;
    const struct alarm_query *query = listing->query;
    if (query->tag[0] && strcmp(query->tag, alarm->name) != 0)
        return;
    listing->total++;
    if (listing->passed < query->offset) {
        listing->passed++;
        return;
    }
    if (listing->count == query->limit)
        return;
    listing->count++;
    if (query->csv)
        add_csv_alarm(listing, alarm);
    else
        json_array_append_new(listing->rows, alarm_object(alarm));
}

static json_t *counts(struct alarm_service *alarm_service)
{
    struct alarm_counts c;
    json_t *states = json_object();
    alarm_service_counts(alarm_service, &c);
    for (int i = 0; i < ALARM_STATUSES; i++)
        json_object_set_new(states, alarm_status_name((enum alarm_status)i), json_integer(c.statuses[i]));
    return json_pack("{s:i,s:i,s:i,s:i,s:o}", "active", c.active, "standing", c.standing, "chattering", c.chattering, "held", c.held,
                     "states", states);
}

char *alarms_api_text(struct alarm_service *alarm_service, const struct plant *plant, const struct alarm_query *query, int64_t now_utc_ns)
{
    struct listing listing = { .plant = plant, .query = query, .rows = json_array() };
    text_add(&listing.csv, "tag,kind,state,priority,raised,value,limit,held,until,who,reason\n");
    alarm_service_changes(alarm_service, 0, list, &listing);
    if (query->csv) {
        json_decref(listing.rows);
        return listing.csv.at;
    }
    text_finish(&listing.csv);
    int64_t next = query->offset + listing.count;
    return json_text(json_pack("{s:s,s:I,s:o,s:I,s:o,s:o}", "mode", mode_name(plant->alarms), "time_us", (json_int_t)(now_utc_ns / 1000),
                               "counts", counts(alarm_service), "total", (json_int_t)listing.total, "alarms", listing.rows, "next_offset",
                               next < listing.total ? json_integer(next) : json_null()),
                     READING_DIGITS);
}

/* --- the journal ------------------------------------------------------------------------------------------------------------ */

struct paging {
    const struct plant *plant;
    json_t *rows;
    struct text *csv; /* receives the journal rows as CSV; NULL: the rows are written as JSON */
    int64_t last_id;
    int count;
};

static void add_journal_csv(struct text *out, const struct journal_row *row)
{
    char when[TIMESTAMP_BYTES];
    timestamp_print(row->t_us, when);
    text_add(out, "%lld,%s,", (long long)row->id, when);
    text_add_cell(out, row->tag, SPECIAL);
    text_add(out, ",%s,%s,%s,%s,%d,", row->kind, row->event, row->before, row->after, row->priority);
    add_csv_number(out, row->limit);
    text_add(out, ",");
    add_csv_number(out, row->value);
    text_add(out, ",");
    text_add_cell(out, row->who, SPECIAL);
    text_add(out, ",");
    text_add_cell(out, row->reason, SPECIAL);
    text_add(out, ",");
    text_add_cell(out, row->unit ? row->unit : "", SPECIAL);
    text_add(out, "\n");
}

/* Returns a journal row with its limit and value converted to the tag's current unit, if the row's unit is known and convertible. */
static struct journal_row in_present_unit(const struct plant *plant, const struct journal_row *row)
{
    struct journal_row out = *row;
    int tag = plant_find_tag(plant, row->tag);
    const char *is = tag < 0 ? NULL : plant->tags[tag].unit;
    struct unit_change change;
    if (row->unit && is && units_compare(row->unit, is, &change) <= UNITS_CONVERT) {
        out.limit = unit_change_value(&change, row->limit);
        out.value = unit_change_value(&change, row->value);
        out.unit = is;
    }
    return out;
}

static void add_journal_row(void *arg, const struct journal_row *as_written)
{
    struct paging *paging = arg;
    const struct journal_row converted = in_present_unit(paging->plant, as_written), *row = &converted;
    paging->last_id = row->id;
    paging->count++;
    if (paging->csv)
        add_journal_csv(paging->csv, row);
    else
        json_array_append_new(paging->rows,
                              json_pack("{s:I,s:I,s:o,s:s,s:s,s:s,s:s,s:i,s:o,s:o,s:o,s:o,s:o}", "id", (json_int_t)row->id, "time_us",
                                        (json_int_t)row->t_us, "tag", string(row->tag), "kind", row->kind, "event", row->event, "before",
                                        row->before, "state", row->after, "priority", row->priority, "limit", reading_number(row->limit),
                                        "value", reading_number(row->value), "unit", row->unit ? string(row->unit) : json_null(), "who",
                                        string(row->who), "reason", string(row->reason)));
}

bool alarms_journal_text(struct log *log, const char *folder, const struct plant *plant, const struct alarm_query *query, struct text *out)
{
    struct paging paging = { .plant = plant, .rows = json_array(), .csv = query->csv ? out : NULL };
    const struct journal_query asked = { .from_us = query->from_us,
                                         .to_us = query->to_us,
                                         .before_id = query->before_id,
                                         .tag = query->tag[0] ? query->tag : NULL,
                                         .limit = query->limit };
    if (query->csv)
        text_add(out, "id,time,tag,kind,event,before,state,priority,limit,value,who,reason,unit\n");
    bool good = journal_read(log, folder, &asked, add_journal_row, &paging) == 0;
    if (!good)
        text_finish(out);
    if (!good || query->csv) {
        json_decref(paging.rows);
        return good;
    }
    char *text = json_text(json_pack("{s:o,s:o}", "rows", paging.rows, "next_before",
                                     paging.count == query->limit ? json_integer(paging.last_id) : json_null()),
                           READING_DIGITS);
    text_add(out, "%s", text);
    mem_free(text);
    return true;
}

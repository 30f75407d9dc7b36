/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses the arguments of history queries. */
#include <stdlib.h>
#include <string.h>

#include "service/history_query.h"

static bool has_tag(const struct history_query *query, int tag)
{
    int i = 0;
    while (i < query->tag_count && query->tags[i] != tag)
        i++;
    return i < query->tag_count;
}

static bool take_tags(const struct plant *plant, const char *list, struct history_query *query, struct message_error *error)
{
    char name[256];
    query->tag_count = 0;
    for (const char *at = list; *at;) {
        size_t n = strcspn(at, ",");
        if (n >= sizeof(name) || query->tag_count == HISTORY_QUERY_TAGS) {
            message_fail(error, "bad_field", "tags: expected at most %d names of at most %zu bytes", HISTORY_QUERY_TAGS, sizeof(name) - 1);
            return false;
        }
        memcpy(name, at, n);
        name[n] = 0;
        int tag = plant_find_tag(plant, name);
        if (tag < 0) {
            message_refuse_with(error, "unknown_tag", "tags", REFUSAL_NO_TAG, "name=%.60s", name);
            return false;
        }
        if (has_tag(query, tag)) {
            message_fail(error, "bad_field", "tags: '%.60s' is listed twice", name);
            return false;
        }
        query->tags[query->tag_count++] = tag;
        at += n + (at[n] == ',');
    }
    return true;
}

static bool take_points(const char *text, struct history_query *query, struct message_error *error)
{
    char *end;
    long points = strtol(text, &end, 10);
    if (end == text || *end || points < 2 || points > HISTORY_QUERY_POINTS) {
        message_fail(error, "bad_field", "points: expected a number from 2 to %d, found '%.60s'", HISTORY_QUERY_POINTS, text);
        return false;
    }
    query->max_points = (int)points;
    return true;
}

static bool take_format(const char *text, struct history_query *query, struct message_error *error)
{
    query->csv = !strcmp(text, "csv");
    if (query->csv || !strcmp(text, "json"))
        return true;
    message_fail(error, "bad_field", "format: expected json or csv, found '%.60s'", text);
    return false;
}

static bool take(const struct plant *plant, const char *arg, int64_t now_us, struct history_query *query, struct message_error *error)
{
    size_t n = strcspn(arg, "=");
    const char *value = arg[n] ? arg + n + 1 : "";
    if (n == 4 && !memcmp(arg, "tags", n))
        return take_tags(plant, value, query, error);
    if (n == 4 && !memcmp(arg, "from", n))
        return message_take_time("from", value, now_us, &query->from_us, error);
    if (n == 2 && !memcmp(arg, "to", n))
        return message_take_time("to", value, now_us, &query->to_us, error);
    if (n == 6 && !memcmp(arg, "points", n))
        return take_points(value, query, error);
    if (n == 6 && !memcmp(arg, "format", n))
        return take_format(value, query, error);
    message_fail(error, "unknown_field", "unknown argument '%.*s'; expected tags, from, to, points and format", n < 60 ? (int)n : 60, arg);
    return false;
}

bool history_query_parse(const struct plant *plant, const char *const *args, size_t count, int64_t now_us, struct history_query *query,
                         struct message_error *error)
{
    *query = (struct history_query){ .max_points = 1000, .from_us = INT64_MIN, .to_us = now_us };
    for (size_t i = 0; i < count; i++)
        if (!take(plant, args[i], now_us, query, error))
            return false;
    if (query->from_us == INT64_MIN)
        query->from_us = query->to_us - INT64_C(3600000000);
    if (query->tag_count == 0)
        message_fail(error, "bad_field", "tags: expected names of tags, separated by commas");
    else if (query->from_us >= query->to_us)
        message_refuse(error, "bad_field", "from", REFUSAL_INSTANTS);
    else
        return true;
    return false;
}

bool history_query_parse_gaps(const char *const *args, size_t count, int64_t now_us, struct history_query *query,
                              struct message_error *error)
{
    *query = (struct history_query){ .gaps = true, .from_us = INT64_MIN, .to_us = now_us };
    for (size_t i = 0; i < count; i++) {
        bool from = !strncmp(args[i], "from=", 5);
        if (!from && strncmp(args[i], "to=", 3) != 0) {
            message_fail(error, "unknown_field", "unknown argument '%.60s'; expected from and to", args[i]);
            return false;
        }
        if (!message_take_time(from ? "from" : "to", strchr(args[i], '=') + 1, now_us, from ? &query->from_us : &query->to_us, error))
            return false;
    }
    if (query->from_us == INT64_MIN)
        query->from_us = query->to_us - INT64_C(3600000000);
    if (query->from_us < query->to_us)
        return true;
    message_refuse(error, "bad_field", "from", REFUSAL_INSTANTS);
    return false;
}

bool history_query_parse_drift(const struct plant *plant, const char *const *args, size_t count, int64_t now_us,
                               struct history_query *query, struct message_error *error)
{
    *query = (struct history_query){ .drift = true, .group = -1, .tag = -1, .to_us = now_us };
    for (size_t i = 0; i < count; i++) {
        if (!strncmp(args[i], "to=", 3)) {
            if (!message_take_time("to", args[i] + 3, now_us, &query->to_us, error))
                return false;
        } else if (!strncmp(args[i], "group=", 6) && query->group < 0) {
            query->group = plant_find_group(plant, args[i] + 6);
        } else if (!strncmp(args[i], "tag=", 4) && query->group < 0) {
            query->tag = plant_find_tag(plant, args[i] + 4);
            query->group = query->tag >= 0 ? plant->tags[query->tag].group : -1;
        }
    }
    if (query->group < 0)
        message_fail(error, "bad_field", "expected group=ID of a group, or tag=NAME of one of its tags");
    return query->group >= 0;
}

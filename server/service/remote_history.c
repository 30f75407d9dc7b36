/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Queries the core for one tag at a time, so that each piece of an answer stays small, and joins the core's answers to one text. */
#include "service/remote_history.h"

#include <string.h>

#include "base/text/timestamp.h"
#include "history/series_text.h"

static void add_number(struct text *path, const char *name, int64_t number)
{
    struct text digits = { 0 };
    text_add(&digits, "%lld", (long long)number);
    core_history_add(path, name, digits.at);
    text_finish(&digits);
}

static void add_time(struct text *path, const char *name, int64_t t_us)
{
    char when[TIMESTAMP_BYTES];
    timestamp_print(t_us, when);
    core_history_add(path, name, when);
}

static bool get_series(struct core_history *core, const struct history_query *query, const char *tag, struct text *answer)
{
    struct text path = { 0 };
    text_add(&path, "/api/v1/history");
    core_history_add(&path, "tags", tag);
    add_time(&path, "from", query->from_us);
    add_time(&path, "to", query->to_us);
    add_number(&path, "points", query->max_points);
    core_history_add(&path, "format", query->csv ? "csv" : "json");
    bool good = core_history_get(core, path.at, answer);
    text_finish(&path);
    return good && answer->at;
}

bool remote_history_json(struct core_history *core, const struct history_query *query, const char *tag, bool first, bool last,
                         struct text *out)
{
    static const char LIST[] = "\"series\":[", END[] = "]}\n";
    struct text answer = { 0 };
    bool good = get_series(core, query, tag, &answer);
    const char *list = good ? strstr(answer.at, LIST) : NULL;
    size_t head = list ? (size_t)(list - answer.at) + strlen(LIST) : 0;
    good = list && answer.length >= head + strlen(END) && !strcmp(answer.at + answer.length - strlen(END), END);
    if (good) {
        text_add_bytes(out, first ? answer.at : ",", first ? head : 1);
        text_add_bytes(out, answer.at + head, answer.length - head - (last ? 0 : strlen(END)));
    }
    text_finish(&answer);
    return good;
}

bool remote_history_csv(struct core_history *core, const struct history_query *query, const char *tag, bool first, bool *buckets,
                        struct text *out)
{
    struct text answer = { 0 }, head = { 0 };
    series_text_csv_head(&head, true);
    bool good = get_series(core, query, tag, &answer), wide = good && !strncmp(answer.at, head.at, head.length);
    size_t columns = good ? strcspn(answer.at, "\n") + 1 : 0;
    good = good && columns <= answer.length;
    if (good && (first || wide != *buckets))
        text_add_bytes(out, answer.at, columns);
    if (good)
        text_add_bytes(out, answer.at + columns, answer.length - columns);
    *buckets = wide;
    text_finish(&head);
    text_finish(&answer);
    return good;
}

static void add_journal(struct text *path, const struct alarm_query *query)
{
    text_add(path, "/api/v1/alarms/journal");
    add_number(path, "limit", query->limit);
    core_history_add(path, "format", query->csv ? "csv" : "json");
    if (query->tag[0])
        core_history_add(path, "tag", query->tag);
    if (query->from_us != INT64_MIN)
        add_time(path, "from", query->from_us);
    if (query->to_us != INT64_MAX)
        add_time(path, "to", query->to_us);
    if (query->before_id != INT64_MAX)
        add_number(path, "before", query->before_id);
}

bool remote_history_whole(struct core_history *core, const struct plant *plant, const struct history_query *query, struct text *out)
{
    struct text path = { 0 };
    if (query->journal) {
        add_journal(&path, &query->alarms);
    } else if (query->drift) {
        text_add(&path, "/api/v1/drift");
        core_history_add(&path, query->tag >= 0 ? "tag" : "group",
                         query->tag >= 0 ? plant->tags[query->tag].name : plant->groups[query->group].id);
        add_time(&path, "to", query->to_us);
    } else {
        text_add(&path, "/api/v1/history/gaps");
        add_time(&path, "from", query->from_us);
        add_time(&path, "to", query->to_us);
    }
    bool good = core_history_get(core, path.at, out);
    text_finish(&path);
    return good;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A query on recorded history: series, recording gaps, drifting sensors, or the alarm journal. Pure. Call from any thread. */
#ifndef SERVICE_HISTORY_QUERY_H
#define SERVICE_HISTORY_QUERY_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "message/alarm_text.h"
#include "message/message.h"
#include "plant/plant.h"

enum { HISTORY_QUERY_TAGS = 64, HISTORY_QUERY_POINTS = 20000 };

struct history_query {
    uint64_t client;
    /* id of the account (client address) to which the query is charged; 0: the account of all queries without an address */
    uint64_t account;
    int tags[HISTORY_QUERY_TAGS]; /* indices into the plant's tags */
    int tag_count, max_points;
    int64_t from_us, to_us;
    bool csv;
    /* true: the query asks which sensors drifted in the week before to_us (service/drift_report.h), not for series of values */
    bool drift;
    /* index of the group or tag to judge, for drift queries: one of the two is set, the other is -1. In other queries both are -1 */
    int group, tag;
    bool gaps;      /* true: the query asks for the periods in which nothing was recorded, not for series of values */
    bool journal;   /* true: the query asks for rows of the alarm journal, filtered by `alarms`, not for series of values */
    struct alarm_query alarms;
};

/* Parses the percent-decoded arguments of a query for series of values, such as
   `tags=A,B&from=-8h&to=now&points=1000&format=csv`, into *query. Returns false with *error. Pure. */
bool history_query_parse(const struct plant *plant, const char *const *args, size_t count, int64_t now_us, struct history_query *query,
                         struct message_error *error);
/* Parses `from=-8h&to=now` into a query for periods in which nothing was recorded. Returns false with *error. Pure. */
bool history_query_parse_gaps(const char *const *args, size_t count, int64_t now_us, struct history_query *query,
                              struct message_error *error);
/* Parses `group=ID` or `tag=NAME`, and optionally `to=-1d`, into a query for drifting sensors. Returns false with *error. Pure. */
bool history_query_parse_drift(const struct plant *plant, const char *const *args, size_t count, int64_t now_us,
                               struct history_query *query, struct message_error *error);

#endif

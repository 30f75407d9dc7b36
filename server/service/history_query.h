/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is asked of recorded history: series, recording gaps, drifting sensors, or the alarm journal. Pure. Thread: any. */
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
    uint64_t account;             /* whose turn it takes: the client's address; 0: one for all such */
    int tags[HISTORY_QUERY_TAGS]; /* indices */
    int tag_count, max_points;
    int64_t from_us, to_us;
    bool csv;
    bool drift;   /* instead of series: which sensors drifted in the week before to_us (service/drift_report.h), */
    int group, tag; /* of this group, or of this tag alone; else -1 */
    bool gaps;    /* instead of series: when nothing was recorded */
    bool journal; /* instead of series: the alarm journal, as `alarms` says */
    struct alarm_query alarms;
};

/* Parses `tags=A,B&from=-8h&to=now&points=1000&format=csv`, decoded, into *query. Returns false with *error saying what is wrong. Pure. */
bool history_query_parse(const struct plant *plant, const char *const *args, size_t count, int64_t now_us, struct history_query *query,
                         struct message_error *error);
/* Parses `from=-8h&to=now` into a query for recording gaps. Returns false with *error saying what is wrong. Pure. */
bool history_query_parse_gaps(const char *const *args, size_t count, int64_t now_us, struct history_query *query,
                              struct message_error *error);
/* Parses `group=ID` or `tag=NAME`, and perhaps `to=-1d`, into a query for sensors that drifted. Likewise. */
bool history_query_parse_drift(const struct plant *plant, const char *const *args, size_t count, int64_t now_us,
                               struct history_query *query, struct message_error *error);

#endif
